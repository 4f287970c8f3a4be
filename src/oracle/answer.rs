//! What an op gives.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Code, Refusal};

/// One value of an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(u64),
    /// A whole number of either sign.
    Integer(i64),
    /// A text.
    Text(String),
    /// Numbers.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Wholes(Vec<u64>),
    /// Texts.
    Texts(Vec<&'static str>),
    /// Rows of numbers.
    Rows(Vec<Vec<f64>>),
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Value::Number(value) => value.serialize(serializer),
            Value::Whole(value) => value.serialize(serializer),
            Value::Integer(value) => value.serialize(serializer),
            Value::Text(value) => value.serialize(serializer),
            Value::Numbers(value) => value.serialize(serializer),
            Value::Wholes(value) => value.serialize(serializer),
            Value::Texts(value) => value.serialize(serializer),
            Value::Rows(value) => value.serialize(serializer),
        }
    }
}

macro_rules! values {
    ($($from:ty => $variant:ident),* $(,)?) => {$(
        impl From<$from> for Value {
            fn from(value: $from) -> Value {
                Value::$variant(value.into())
            }
        }
    )*};
}
values!(
    f64 => Number, u64 => Whole, u16 => Whole, u8 => Whole, i16 => Integer, String => Text, &str => Text,
    Vec<f64> => Numbers, Vec<u64> => Wholes, Vec<&'static str> => Texts, Vec<Vec<f64>> => Rows,
);

impl From<usize> for Value {
    fn from(value: usize) -> Value {
        Value::Whole(value as u64) // no machine has larger ones
    }
}

/// What an op gives: values by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer(Vec<(&'static str, Value)>);

impl Answer {
    /// This answer with one more value.
    pub fn with(mut self, name: &'static str, value: impl Into<Value>) -> Answer {
        self.0.push((name, value.into()));
        self
    }

    /// This answer, if all its numbers are finite.
    ///
    /// Implements: ORA-010, ORA-022.
    pub(super) fn finite(self) -> Result<Answer, Refusal> {
        let finite = |value: &Value| match value {
            Value::Number(value) => value.is_finite(),
            Value::Numbers(values) => values.iter().all(|value| value.is_finite()),
            Value::Rows(rows) => rows.iter().flatten().all(|value| value.is_finite()),
            _ => true,
        };
        match self.0.iter().find(|(_, value)| !finite(value)) {
            Some((name, _)) => Err(Refusal::new(
                Code::Overflow,
                format!("{name} would be no finite number"),
            )),
            None => Ok(self),
        }
    }

    /// Appends the line of the answer to the request `id`, a JSON text or number.
    pub(super) fn write(&self, id: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(b"{\"id\":");
        out.extend_from_slice(id.as_bytes());
        out.extend_from_slice(b",\"ok\":");
        // Neither memory nor these types can fail to be written.
        let _ = serde_json::to_writer(&mut *out, self);
        out.extend_from_slice(b"}\n");
    }
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
