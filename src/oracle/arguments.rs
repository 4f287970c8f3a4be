//! The arguments of an op, by name.

use std::cell::Cell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};

use super::ops::Op;
use super::request::{Members, kind};
use super::{Code, Refusal};

/// Most entries of a list, and of all the lists of a matrix together.
///
/// Implements: ORA-011.
pub const MOST_ENTRIES: usize = 1_000_000;

/// The arguments of a request.
#[derive(Debug)]
pub struct Arguments<'a> {
    members: Vec<(String, &'a str)>,
    /// What the op asked for.
    asked: Vec<&'static str>,
}

impl<'a> Arguments<'a> {
    /// The arguments in a JSON text, none if there is no text.
    ///
    /// # Errors
    /// What stands there instead of an object; a key that is given twice.
    pub fn parse(text: Option<&'a str>) -> Result<Arguments<'a>, Refusal> {
        let Members(members) = Members::parse("args", text.unwrap_or("{}"), Code::BadArgument)?;
        let asked = Vec::new();
        Ok(Arguments { members, asked })
    }

    /// Whether the op knows all the arguments.
    ///
    /// Implements: ORA-005.
    pub(super) fn check_known(&self, op: &Op) -> Result<(), Refusal> {
        self.check(
            |name| op.arguments.split(' ').any(|known| known == name),
            || {
                let known = op.arguments.replace(' ', ", ");
                let none = if known.is_empty() { "no arguments" } else { "" };
                format!("{} takes {none}{known}", op.name)
            },
        )
    }

    /// Whether the op had a use for all the arguments.
    pub(super) fn check_used(&self, op: &Op) -> Result<(), Refusal> {
        self.check(
            |name| self.asked.contains(&name),
            || format!("here {} takes {}", op.name, self.asked.join(", ")),
        )
    }

    fn check(
        &self,
        right: impl Fn(&str) -> bool,
        takes: impl FnOnce() -> String,
    ) -> Result<(), Refusal> {
        match self.members.iter().find(|(name, _)| !right(name)) {
            Some((name, _)) => Err(Refusal::new(
                Code::BadArgument,
                format!("unknown argument {name:?}: {}", takes()),
            )),
            None => Ok(()),
        }
    }

    fn text_of(&mut self, name: &'static str) -> Result<&'a str, Refusal> {
        self.asked.push(name);
        match self.members.iter().find(|(key, _)| key == name) {
            Some((_, text)) => Ok(text),
            None => Err(Refusal::argument(name, "is missing")),
        }
    }

    /// A finite number.
    ///
    /// # Errors
    /// As all the functions below: the argument is missing, or is something else.
    ///
    /// Implements: ORA-009.
    pub fn number(&mut self, name: &'static str) -> Result<f64, Refusal> {
        let text = self.text_of(name)?;
        if kind(text) != "a number" {
            return Err(expected(name, "a number", text));
        }
        serde_json::from_str(text).map_err(|_| {
            Refusal::argument(name, "is beyond the largest f64, expected a finite number")
        })
    }

    /// A whole number from `least` to `most`, which is at most 2⁵³.
    pub fn whole(&mut self, name: &'static str, least: i64, most: i64) -> Result<i64, Refusal> {
        let value = self.number(name)?;
        if value.trunc() != value {
            return Err(Refusal::argument(
                name,
                format_args!("is {value}, expected a whole number"),
            ));
        }
        if !(least as f64..=most as f64).contains(&value) {
            return Err(Refusal::range(
                name,
                format_args!("is {value}, expected {least} to {most}"),
            ));
        }
        Ok(value as i64) // whole, and between two of that type
    }

    /// A text.
    pub fn text(&mut self, name: &'static str) -> Result<String, Refusal> {
        let text = self.text_of(name)?;
        serde_json::from_str(text).map_err(|_| expected(name, "a text", text))
    }

    /// A list of finite numbers, which may be empty.
    ///
    /// Implements: ORA-009, ORA-011.
    pub fn numbers(&mut self, name: &'static str) -> Result<Vec<f64>, Refusal> {
        let text = self.text_of(name)?;
        list(name, text, "a list of numbers", |reader| {
            List {
                entry: Number,
                room: &Room::new(),
            }
            .deserialize(reader)
        })
    }

    /// Rows of finite numbers, which may be empty and of any lengths.
    pub fn rows(&mut self, name: &'static str) -> Result<Vec<Vec<f64>>, Refusal> {
        let text = self.text_of(name)?;
        list(name, text, "a list of lists of numbers", |reader| {
            let room = &Room::new();
            let entry = List {
                entry: Number,
                room,
            };
            List { entry, room }.deserialize(reader)
        })
    }

    /// Rows of texts, which may be empty and of any lengths.
    pub fn rows_of_texts(&mut self, name: &'static str) -> Result<Vec<Vec<String>>, Refusal> {
        let text = self.text_of(name)?;
        list(name, text, "a list of lists of texts", |reader| {
            let room = &Room::new();
            let entry = List { entry: Text, room };
            List { entry, room }.deserialize(reader)
        })
    }

    /// The f32 whose bits are given, NaN and infinities included.
    ///
    /// Implements: ORA-023.
    pub fn bits(&mut self, name: &'static str) -> Result<f32, Refusal> {
        let text = self.text(name)?;
        parse_bits(&text).ok_or_else(|| Refusal::argument(name, not_bits(&text)))
    }
}

/// The f32 whose bits are `0x` and eight hexadecimal digits.
pub fn parse_bits(text: &str) -> Option<f32> {
    let digits = text.strip_prefix("0x")?;
    let plain = digits.len() == 8 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let bits = u32::from_str_radix(digits, 16).ok()?;
    plain.then_some(f32::from_bits(bits))
}

/// What is wrong with a text that is no bits.
pub fn not_bits(text: &str) -> String {
    format!("is {text:?}, expected the bits of an f32, such as \"0x3f800000\"")
}

fn expected(name: &str, what: &str, text: &str) -> Refusal {
    Refusal::argument(name, format_args!("is {}, expected {what}", kind(text)))
}

/// Reads a list with a reader of JSON; the message of an error begins with the place in the list.
fn list<T>(
    name: &str,
    text: &str,
    what: &str,
    read: impl FnOnce(
        &mut serde_json::Deserializer<serde_json::de::StrRead<'_>>,
    ) -> serde_json::Result<T>,
) -> Result<T, Refusal> {
    if kind(text) != "a list" {
        return Err(expected(name, what, text));
    }
    read(&mut serde_json::Deserializer::from_str(text)).map_err(|error| {
        let message = error.to_string();
        // Line and column within an argument help nobody.
        let message = message.split(" at line ").next().unwrap_or_default();
        let code = if message.contains(TOO_MANY) {
            Code::OutOfRange
        } else {
            Code::BadArgument
        };
        let gap = if message.starts_with('[') { "" } else { " " };
        Refusal::new(code, format!("{name}{gap}{message}"))
    })
}

const TOO_MANY: &str = "has more entries than";

/// How many entries there may still be.
struct Room(Cell<usize>);

impl Room {
    fn new() -> Room {
        Room(Cell::new(MOST_ENTRIES))
    }
}

/// Reads a list whose entries `entry` reads, with the place of the first wrong one.
#[derive(Clone, Copy)]
struct List<'a, E> {
    entry: E,
    room: &'a Room,
}

impl<'de, E: DeserializeSeed<'de> + Copy> DeserializeSeed<'de> for List<'_, E> {
    type Value = Vec<E::Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de, E: DeserializeSeed<'de> + Copy> Visitor<'de> for List<'_, E> {
    type Value = Vec<E::Value>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Self::Value, A::Error> {
        let mut list = Vec::new();
        loop {
            match entries.next_element_seed(self.entry) {
                Ok(Some(entry)) => list.push(entry),
                Ok(None) => return Ok(list),
                Err(error) => {
                    let message = error.to_string();
                    let gap = if message.starts_with('[') { "" } else { ": " };
                    return Err(A::Error::custom(format_args!(
                        "[{}]{gap}{message}",
                        list.len()
                    )));
                }
            }
            match self.room.0.get().checked_sub(1) {
                Some(left) => self.room.0.set(left),
                None => return Err(A::Error::custom(format_args!("{TOO_MANY} {MOST_ENTRIES}"))),
            }
        }
    }
}

/// Reads a finite number.
#[derive(Clone, Copy)]
struct Number;

impl<'de> DeserializeSeed<'de> for Number {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<f64, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Visitor<'_> for Number {
    type Value = f64;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a finite number")
    }

    fn visit_f64<E>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }

    fn visit_u64<E>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64) // the nearest
    }

    fn visit_i64<E>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64) // the nearest
    }
}

/// Reads a text.
#[derive(Clone, Copy)]
struct Text;

impl<'de> DeserializeSeed<'de> for Text {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<String, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Visitor<'_> for Text {
    type Value = String;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a text")
    }

    fn visit_str<E>(self, value: &str) -> Result<String, E> {
        Ok(value.into())
    }
}
