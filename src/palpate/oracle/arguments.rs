//! What the arguments of an op are made of, and how they are read.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::answer::Refused;
use crate::file::message;

/// Most entries of a list, and of all the lists of a matrix together.
///
/// Implements: ORA-011.
pub const MOST_ENTRIES: usize = 1_000_000;

/// How the message of an argument begins that is of the right kind, but outside its range.
const OUT_OF_RANGE: &str = "out of range: ";

/// The value of an expression of some arguments, which `$text` must give: a JSON object of just these, each once, and of the `$tag` that has
/// chosen them.
macro_rules! with_arguments {
    ($text:expr, $([$tag:ident])? { $($name:ident: $type:ty),* } => $value:expr) => {{
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Arguments {
            $(#[allow(dead_code)] $tag: serde::de::IgnoredAny,)?
            $($name: $type),*
        }
        let Arguments { $($name,)* .. } = $crate::oracle::arguments::arguments_of($text)?;
        $value
    }};
}
pub(super) use with_arguments;

/// Reads a JSON object; serde by itself would also take a list of its values.
pub fn object<'a, T: Deserialize<'a>>(text: &'a str) -> serde_json::Result<T> {
    if text.trim_ascii_start().starts_with('{') {
        serde_json::from_str(text)
    } else {
        Err(de::Error::custom("not an object"))
    }
}

/// Reads the arguments of an op.
///
/// # Errors
/// The argument, and in a list the entry, that is wrong.
///
/// Implements: ORA-008, ORA-009.
pub fn arguments_of<'a, T: Deserialize<'a>>(text: &'a str) -> Result<T, Refused> {
    object(text).map_err(|error| {
        // Once more, for the place of what is wrong.
        let mut reader = serde_json::Deserializer::from_str(text);
        let located = serde_path_to_error::deserialize::<_, T>(&mut reader).err();
        let place = located.map_or("args".into(), |located| located.path().to_string());
        let place = if place == "." { "args".into() } else { place };
        let message = message(&error);
        match message.strip_prefix(OUT_OF_RANGE) {
            Some(wrong) => Refused::range(format_args!("{place}: {wrong}")),
            None if message == "number out of range" => {
                Refused::argument(format_args!("{place} is beyond the largest f64"))
            }
            None => Refused::argument(format_args!("{place}: {message}")),
        }
    })
}

/// Numbers, texts of bits, or lists of them: at most [`MOST_ENTRIES`] in all.
///
/// Implements: ORA-009, ORA-011.
#[derive(Debug)]
pub struct List<T>(pub Vec<T>);

/// What may stand in a [`List`].
pub trait Entry {
    /// How many entries it has itself.
    fn entries(&self) -> usize {
        0
    }
}

impl Entry for f64 {}
impl Entry for Bits {}
impl<T> Entry for List<T> {
    fn entries(&self) -> usize {
        self.0.len()
    }
}

impl<'de, T: Deserialize<'de> + Entry> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<List<T>, D::Error> {
        deserializer.deserialize_seq(ListVisitor(PhantomData))
    }
}

struct ListVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Entry> Visitor<'de> for ListVisitor<T> {
    type Value = List<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<List<T>, A::Error> {
        let mut list = Vec::new();
        let mut entries = 0;
        while let Some(entry) = sequence.next_element::<T>()? {
            entries += 1 + entry.entries();
            if entries > MOST_ENTRIES {
                let wrong = format_args!("{OUT_OF_RANGE}more than {MOST_ENTRIES} entries");
                return Err(de::Error::custom(wrong));
            }
            list.push(entry);
        }
        Ok(List(list))
    }
}

/// Rows of finite numbers, of any lengths.
pub type Rows = List<List<f64>>;

impl<T: Clone> List<List<T>> {
    /// The entries, row by row.
    ///
    /// # Errors
    /// The argument `name` has another number of rows, or a row of another length.
    pub fn concat(&self, name: &str, height: usize, width: usize) -> Result<Vec<T>, Refused> {
        let List(rows) = self;
        if rows.len() != height {
            let wrong = format_args!("{name} has {} rows, but must have {height}", rows.len());
            return Err(Refused::argument(wrong));
        }
        let wrong = rows.iter().map(Entry::entries).enumerate();
        if let Some((row, length)) = wrong.into_iter().find(|&(_, length)| length != width) {
            let wrong = format_args!("{name}[{row}] has {length} entries, but must have {width}");
            return Err(Refused::argument(wrong));
        }
        Ok(rows.iter().flat_map(|List(row)| row).cloned().collect())
    }
}

/// A whole number from `LEAST` to `MOST`, which are at most 2⁵³; it may be written with a point.
#[derive(Debug, Clone, Copy)]
pub struct Whole<const LEAST: i64, const MOST: i64>(pub i64);

impl<'de, const LEAST: i64, const MOST: i64> Deserialize<'de> for Whole<LEAST, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)?;
        if value.trunc() != value {
            let wrong = format_args!("{value} is not a whole number");
            return Err(de::Error::custom(wrong));
        }
        if !(LEAST as f64..=MOST as f64).contains(&value) {
            let wrong = format_args!("{OUT_OF_RANGE}{value} is not from {LEAST} to {MOST}");
            return Err(de::Error::custom(wrong));
        }
        Ok(Whole(value as i64)) // whole, and between two of that type
    }
}

/// The f32 whose bits are written as `0x` and eight hexadecimal digits, NaN and infinities included.
///
/// Implements: ORA-009.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "String")]
pub struct Bits(pub f32);

impl TryFrom<String> for Bits {
    type Error = String;

    fn try_from(text: String) -> Result<Bits, String> {
        let digits = text.strip_prefix("0x").filter(|digits| digits.len() == 8);
        let plain = digits.filter(|text| text.bytes().all(|byte| byte.is_ascii_hexdigit()));
        let bits = plain.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let bits = bits
            .ok_or_else(|| format!("{text:?} is not the bits of an f32, such as \"0x3f800000\""))?;
        Ok(Bits(f32::from_bits(bits)))
    }
}
