//! The arguments of an op, by name.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::Refused;
use super::answer::Code;
use super::request::{Members, kind};
use crate::fem::Model;

/// Most entries of a list, and of all the lists of a matrix together.
///
/// Implements: ORA-011.
pub const MOST_ENTRIES: usize = 1_000_000;

/// Models that were made, each with the name of its phantom: at most one for each that is built in.
pub type Models = Vec<(String, Model)>;

/// The arguments of a request, and what earlier requests left for it.
#[derive(Debug)]
pub struct Arguments<'a> {
    members: Vec<(String, &'a str)>,
    /// What the op asked for.
    asked: Vec<&'static str>,
    /// Models that were made before.
    pub models: &'a mut Models,
}

impl<'a> Arguments<'a> {
    /// The arguments in a JSON text, none if there is no text.
    ///
    /// # Errors
    /// What stands there instead of an object; a key that is given twice.
    pub fn parse(text: Option<&'a str>, models: &'a mut Models) -> Result<Arguments<'a>, Refused> {
        let Members(members) = Members::parse("args", text.unwrap_or("{}"), Code::BadArgument)?;
        Ok(Arguments {
            members,
            asked: Vec::new(),
            models,
        })
    }

    /// Whether the op knows all the arguments: `known` are their names, with a space between them.
    ///
    /// Implements: ORA-008.
    pub fn check_known(&self, op: &str, known: &str) -> Result<(), Refused> {
        let knows = |name: &str| known.split(' ').any(|known| known == name);
        self.check(knows, || match known {
            "" => format!("{op} takes no arguments"),
            known => format!("{op} takes {}", known.replace(' ', ", ")),
        })
    }

    /// Whether the op had a use for all the arguments.
    pub fn check_used(&self, op: &str) -> Result<(), Refused> {
        let takes = || format!("here {op} takes {}", self.asked.join(", "));
        self.check(|name| self.asked.contains(&name), takes)
    }

    fn check(
        &self,
        right: impl Fn(&str) -> bool,
        takes: impl FnOnce() -> String,
    ) -> Result<(), Refused> {
        match self.members.iter().find(|(name, _)| !right(name)) {
            Some((name, _)) => Err(Refused::argument(format_args!(
                "unknown argument {name:?}: {}",
                takes()
            ))),
            None => Ok(()),
        }
    }

    /// The JSON text of an argument, which is of a kind; if not, `what` is said to be expected.
    fn text_of(&mut self, name: &'static str, of: &str, what: &str) -> Result<&'a str, Refused> {
        self.asked.push(name);
        match self.members.iter().find(|(key, _)| key == name) {
            Some((_, text)) if kind(text) == of => Ok(text),
            Some((_, text)) => Err(Refused::argument(format_args!(
                "{name} is {}, expected {what}",
                kind(text)
            ))),
            None => Err(Refused::argument(format_args!("{name} is missing"))),
        }
    }

    /// A finite number.
    ///
    /// # Errors
    /// As all the functions below: the argument is missing, or is something else.
    ///
    /// Implements: ORA-009.
    pub fn number(&mut self, name: &'static str) -> Result<f64, Refused> {
        read(name, self.text_of(name, "a number", "a number")?)
    }

    /// Finite numbers, each of a name.
    pub fn each<const N: usize>(&mut self, names: [&'static str; N]) -> Result<[f64; N], Refused> {
        let mut numbers = [0.0; N];
        for (number, name) in numbers.iter_mut().zip(names) {
            *number = self.number(name)?;
        }
        Ok(numbers)
    }

    /// A whole number from `least` to `most`, which is at most 2⁵³.
    pub fn whole(&mut self, name: &'static str, least: i64, most: i64) -> Result<i64, Refused> {
        let value = self.number(name)?;
        if value.trunc() != value {
            let wrong = format_args!("{name} is {value}, expected a whole number");
            return Err(Refused::argument(wrong));
        }
        if !(least as f64..=most as f64).contains(&value) {
            let wrong = format_args!("{name} is {value}, expected {least} to {most}");
            return Err(Refused::range(wrong));
        }
        Ok(value as i64) // whole, and between two of that type
    }

    /// A text.
    pub fn text(&mut self, name: &'static str) -> Result<String, Refused> {
        read(name, self.text_of(name, "a text", "a text")?)
    }

    /// The f32 whose bits are given, NaN and infinities included.
    ///
    /// Implements: ORA-009.
    pub fn bits(&mut self, name: &'static str) -> Result<f32, Refused> {
        let Bits(value) = read(name, self.text_of(name, "a text", "a text")?)?;
        Ok(value)
    }

    /// Finite numbers.
    pub fn numbers(&mut self, name: &'static str) -> Result<Vec<f64>, Refused> {
        self.list(name, "a list of numbers")
    }

    /// Rows of finite numbers, of any lengths.
    pub fn rows(&mut self, name: &'static str) -> Result<Vec<Vec<f64>>, Refused> {
        self.list(name, "a list of lists of numbers")
    }

    /// A list, which may be empty; `what` it should be.
    ///
    /// Implements: ORA-009, ORA-011.
    pub fn list<T: DeserializeOwned>(
        &mut self,
        name: &'static str,
        what: &str,
    ) -> Result<Vec<T>, Refused> {
        let text = self.text_of(name, "a list", what)?;
        // Each entry but the first of a list has a comma before it.
        let entries = text.bytes().filter(|byte| b",[".contains(byte)).count();
        if entries > MOST_ENTRIES && entries - text.matches("[]").count() > MOST_ENTRIES {
            let wrong = format_args!("{name} has more entries than {MOST_ENTRIES}");
            return Err(Refused::range(wrong));
        }
        read(name, text)
    }
}

/// The value in a JSON text.
fn read<T: DeserializeOwned>(name: &str, text: &str) -> Result<T, Refused> {
    serde_json::from_str(text).or_else(|_| {
        // Once more, for the place of the wrong entry.
        let mut reader = serde_json::Deserializer::from_str(text);
        serde_path_to_error::deserialize(&mut reader).map_err(|error| {
            let wrong = wrong_entry(&error.inner().to_string());
            let place = error.path().iter().map(ToString::to_string);
            let place: String = place.collect();
            Refused::argument(format_args!("{name}{place}{wrong}"))
        })
    })
}

/// What a reader of JSON says of a value, in the words of this protocol.
fn wrong_entry(message: &str) -> String {
    // Line and column within an argument help nobody.
    let message = message.split(" at line ").next().unwrap_or_default();
    match message.rsplit_once(", expected ") {
        Some((found, "f64")) => format!(": {found}, expected a finite number"),
        Some((found, "a sequence")) => format!(": {found}, expected a list"),
        Some((found, "a string")) => format!(": {found}, expected a text"),
        _ if message == "number out of range" => {
            " is beyond the largest f64, expected a finite number".into()
        }
        // A text of bits says what is wrong with it by itself.
        _ if message.starts_with("is ") => format!(" {message}"),
        _ => format!(": {message}"),
    }
}

/// The f32 whose bits are written as `0x` and eight hexadecimal digits.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "String")]
pub struct Bits(pub f32);

impl TryFrom<String> for Bits {
    type Error = String;

    fn try_from(text: String) -> Result<Bits, String> {
        let digits = text.strip_prefix("0x").filter(|digits| digits.len() == 8);
        let plain = digits.filter(|text| text.bytes().all(|byte| byte.is_ascii_hexdigit()));
        let bits = plain.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let expected = "expected the bits of an f32, such as \"0x3f800000\"";
        let bits = bits.ok_or_else(|| format!("is {text:?}, {expected}"))?;
        Ok(Bits(f32::from_bits(bits)))
    }
}

/// Refuses rows of another number or length than these; `words` say what is expected of the two.
pub fn check_rows<T>(
    name: &str,
    rows: &[Vec<T>],
    [height, width]: [usize; 2],
    words: [String; 2],
) -> Result<(), Refused> {
    if rows.len() != height {
        let wrong = format!("{name} has {} rows, expected {}", rows.len(), words[0]);
        return Err(Refused::argument(wrong));
    }
    match rows.iter().position(|row| row.len() != width) {
        Some(row) => Err(Refused::argument(format_args!(
            "{name}[{row}] has {} entries, expected {}",
            rows[row].len(),
            words[1]
        ))),
        None => Ok(()),
    }
}
