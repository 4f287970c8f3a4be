//! TOML: what serde reads from it, and trees of it that keep the digits of numbers.

use std::ops::Range;

use serde::de::value::{Error, MapDeserializer, SeqDeserializer};
use serde::de::{
    DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Unexpected, Visitor,
};
use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::{line_of, refusal};
use crate::refusal::{Refusal, shortened};

/// What serde reads from `text`, TOML, the content of `file`.
///
/// # Errors
/// What is wrong, with file, line and key.
pub fn from_toml<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, Refusal> {
    // What the parser has no place for, such as too deep a nesting, it found up to the end.
    let line = |span: Option<Range<usize>>| line_of(text, span.map_or(text.len(), |at| at.start));
    let document = toml::Deserializer::parse(text).map_err(|error| {
        let refusal = Refusal::state(error.message().replace(", expected ", "; give "), "");
        refusal.at(line(error.span())).in_file(file)
    })?;
    serde_path_to_error::deserialize(document).map_err(|error| {
        let refusal = refusal(error.path(), error.inner().message());
        refusal.at(line(error.inner().span())).in_file(file)
    })
}

/// A TOML text, in which serde reads numbers from their digits: see [`Node`].
pub(crate) struct Tree<'a> {
    text: &'a str,
    root: Spanned<DeValue<'a>>,
}

/// One step into a tree.
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

/// The steps to a key such as `layer[1].thickness_mm`.
fn steps(key: &str) -> impl Iterator<Item = Step<'_>> {
    key.split(['.', '['])
        .map(|part| match part.strip_suffix(']') {
            Some(index) => Step::Index(index.parse().unwrap_or(usize::MAX)),
            None => Step::Key(part),
        })
}

/// The value that is one step further in.
fn inner<'t, 'a>(value: &'t DeValue<'a>, step: &Step) -> Option<&'t Spanned<DeValue<'a>>> {
    match (value, step) {
        (DeValue::Table(table), Step::Key(key)) => table.get(*key),
        (DeValue::Array(items), Step::Index(index)) => items.get(*index),
        _ => None,
    }
}

impl<'a> Tree<'a> {
    /// # Errors
    /// A text that is not TOML, with the line.
    pub fn parse(text: &'a str) -> Result<Tree<'a>, Refusal> {
        let document = DeTable::parse(text).map_err(|error| {
            let at = error.span().map_or(text.len(), |span| span.start);
            let before = text.get(..at).unwrap_or(text);
            let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
            let message = error.message().replace(", expected ", "; give ");
            let message = format!("column {column}: not TOML: {message}");
            Refusal::state(message, "").at(line_of(text, at))
        })?;
        let span = document.span();
        let root = Spanned::new(span, DeValue::Table(document.into_inner()));
        Ok(Tree { text, root })
    }

    /// What serde reads.
    ///
    /// # Errors
    /// What is wrong, with line and key.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, Refusal> {
        serde_path_to_error::deserialize(Node(self.root.get_ref())).map_err(|error| {
            let refusal = refusal(error.path(), &error.inner().to_string());
            let steps = error.path().iter().filter_map(|segment| match segment {
                Segment::Seq { index } => Some(Step::Index(*index)),
                Segment::Map { key } => Some(Step::Key(key)),
                Segment::Enum { .. } | Segment::Unknown => None,
            });
            let value = self.innermost(steps);
            let written = value.and_then(|value| self.text.get(value.span()));
            let found = match written {
                Some(written) if !refusal.key.is_empty() => shortened(written),
                _ => refusal.found,
            };
            let line = value.map(|value| line_of(self.text, value.span().start));
            Refusal {
                line,
                found,
                ..refusal
            }
        })
    }

    /// A refusal of the value at its key, with its line.
    pub fn placed(&self, refusal: Refusal) -> Refusal {
        let value = self.innermost(steps(&refusal.key));
        let line = value.map(|value| line_of(self.text, value.span().start));
        Refusal { line, ..refusal }
    }

    /// The number at `key`.
    pub fn number(&self, key: &str) -> Option<f64> {
        let mut steps = steps(key);
        let value = steps.try_fold(&self.root, |value, step| inner(value.get_ref(), &step));
        match value?.get_ref() {
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        }
    }

    /// Makes a list of one table of a table at `key`.
    pub fn make_list(&mut self, key: &str) {
        if let DeValue::Table(root) = self.root.get_mut()
            && let Some(value) = root.get_mut(key)
            && value.get_ref().is_table()
        {
            let mut list = DeArray::new();
            list.push(value.clone());
            *value.get_mut() = DeValue::Array(list);
        }
    }

    /// Puts a value in the place of the one at `key`, or beside those of its table.
    ///
    /// # Errors
    /// There is no such table; `value` is no value of TOML.
    pub fn set(&mut self, key: &'a str, value: &'a str) -> Result<(), Refusal> {
        let not_toml = |_| Refusal::value(key, shortened(value), "a value of TOML");
        let value = DeValue::parse(value).map_err(not_toml)?;
        let (outer, name) = match key.rsplit_once('.') {
            Some((outer, name)) => (Some(outer), name),
            None => (None, key),
        };
        let mut table = Some(self.root.get_mut());
        for step in outer.into_iter().flat_map(steps) {
            let inner = match (table, step) {
                (Some(DeValue::Table(table)), Step::Key(key)) => table.get_mut(key),
                (Some(DeValue::Array(items)), Step::Index(index)) => items.get_mut(index),
                _ => None,
            };
            table = inner.map(Spanned::get_mut);
        }
        let Some(DeValue::Table(table)) = table else {
            return Err(Refusal::state(format!("{key} is unknown"), ""));
        };
        table.insert(Spanned::new(0..0, name.into()), value);
        // Not all spans are of it any more.
        self.text = "";
        Ok(())
    }

    /// The value to which `steps` lead, or the last one that is there on the way; none if that is the whole text.
    fn innermost<'s>(
        &self,
        steps: impl Iterator<Item = Step<'s>>,
    ) -> Option<&Spanned<DeValue<'a>>> {
        let values = steps.scan(&self.root, |value, step| {
            *value = inner(value.get_ref(), &step)?;
            Some(*value)
        });
        values.last()
    }
}

/// A value of a TOML text, for serde. A number comes as a newtype around the text that writes it, so that its type reads the digits
/// (see [`crate::decimal::Scaled`]), and no other type takes it.
#[derive(Clone, Copy)]
struct Node<'de>(&'de DeValue<'de>);

impl<'de> Node<'de> {
    fn of(value: &'de Spanned<DeValue<'de>>) -> Node<'de> {
        Node(value.get_ref())
    }
}

impl<'de> IntoDeserializer<'de> for Node<'de> {
    type Deserializer = Node<'de>;

    fn into_deserializer(self) -> Node<'de> {
        self
    }
}

impl<'de> Deserializer<'de> for Node<'de> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Integer(number) => {
                visitor.visit_newtype_struct(number.to_string().into_deserializer())
            }
            DeValue::Float(number) => {
                visitor.visit_newtype_struct(number.as_str().into_deserializer())
            }
            DeValue::Boolean(value) => visitor.visit_bool(*value),
            DeValue::Datetime(_) => Err(Error::invalid_type(Unexpected::Other("a date"), &visitor)),
            DeValue::Array(items) => {
                SeqDeserializer::new(items.iter().map(Node::of)).deserialize_any(visitor)
            }
            DeValue::Table(table) => {
                let entries = table.iter();
                let entries = entries.map(|(key, value)| (key.as_ref().as_ref(), Node::of(value)));
                MapDeserializer::<'_, _, Error>::new(entries).deserialize_any(visitor)
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            DeValue::String(text) => visitor.visit_enum((**text).into_deserializer()),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            DeValue::Array(items) if items.len() != length => {
                Err(Error::invalid_type(Unexpected::Seq, &visitor))
            }
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            // Serde would take the values of a list for those of a table.
            DeValue::Array(_) => Err(Error::invalid_type(Unexpected::Seq, &visitor)),
            _ => self.deserialize_any(visitor),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct newtype_struct seq
        tuple_struct map identifier ignored_any
    }
}
