//! JSON: documents with a schema, and their layout.

use std::{fmt, io};

use serde::de::{DeserializeOwned, Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

use super::refusal;
use crate::refusal::{Refusal, shortened};

/// The two keys that say whether the rest can be read.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    schema: Value,
    #[serde(default)]
    schema_version: Value,
}

/// The members of an object with any keys, none of which is there twice.
#[derive(Default)]
pub(crate) struct Members(pub Map<String, Value>);

impl<'de> Deserialize<'de> for Members {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Members, D::Error> {
        from.deserialize_map(Members::default())
    }
}

impl<'de> Visitor<'de> for Members {
    type Value = Members;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut access: A) -> Result<Members, A::Error> {
        while let Some((key, value)) = access.next_entry::<String, Value>()? {
            let twice = format!("duplicate field `{key}`");
            if self.0.insert(key, value).is_some() {
                return Err(A::Error::custom(twice));
            }
        }
        Ok(self)
    }
}

/// A document as JSON, each row of a matrix on one line.
pub fn to_json(document: &impl Serialize) -> String {
    let mut text = Vec::new();
    let mut serializer = serde_json::Serializer::with_formatter(&mut text, RowPerLine::default());
    let written = document.serialize(&mut serializer);
    written.expect("strings and finite numbers go into memory without an error");
    text.push(b'\n');
    String::from_utf8(text).expect("serde_json writes UTF-8")
}

/// Whether a document has the schema and the version that this program reads. They come first: a newer file may have keys that
/// this program does not know.
pub fn check_schema(text: &str, schema: &str, version: u64) -> Result<(), Refusal> {
    let header: Header = from_json(text)?;
    let found = shortened(&header.schema.to_string());
    Refusal::value("schema", found, format!("{schema:?}")).when(header.schema != schema)?;
    let found = shortened(&header.schema_version.to_string());
    let expected = format!("{version}, which is what this program reads");
    Refusal::value("schema_version", found, expected).when(header.schema_version != version)
}

/// What serde reads from `text`, JSON.
///
/// # Errors
/// What is wrong, with line, column and key, and the text around that place.
pub fn from_json<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    let mut json = serde_json::Deserializer::from_str(text);
    let read = serde_path_to_error::deserialize(&mut json);
    let read = read.map_err(|error| {
        let refusal = refusal(error.path(), &message(error.inner()));
        placed(refusal, error.inner(), text)
    })?;
    let end = json.end();
    end.map_err(|error| placed(Refusal::state(message(&error), ""), &error, text))?;
    Ok(read)
}

/// What serde_json says, without the place.
pub(crate) fn message(error: &serde_json::Error) -> String {
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = error.to_string();
    message.strip_suffix(&place).unwrap_or(&message).into()
}

/// The same refusal with the place of serde_json's error in `text`.
fn placed(refusal: Refusal, error: &serde_json::Error, text: &str) -> Refusal {
    let (line, column) = (error.line(), error.column());
    let written = text.lines().nth(line.saturating_sub(1)).unwrap_or("");
    // Some 30 bytes to each side: a file without line breaks is one long line.
    let near = written.char_indices();
    let near = near.filter(|(at, _)| at.abs_diff(column) < 30);
    let near: String = near.map(|(_, c)| c).collect();
    let mut refusal = refusal.of_part(&format!("column {column}"));
    let end = match refusal.remedy.is_empty() {
        true => &mut refusal.found,
        false => &mut refusal.remedy,
    };
    *end += &format!(", in {:?}", near.trim());
    refusal.line = (line > 0).then_some(line);
    refusal
}

/// Lays JSON out with one key a line, and one matrix row a line.
///
/// Implements: MAP-020.
#[derive(Default)]
struct RowPerLine {
    /// Open objects and outer arrays, two spaces each.
    indent: usize,
    /// Open arrays.
    arrays: usize,
    /// Whether a row was closed, and its matrix not yet.
    after_row: bool,
}

impl RowPerLine {
    fn new_line<W: ?Sized + io::Write>(&self, writer: &mut W) -> io::Result<()> {
        write!(writer, "\n{:1$}", "", 2 * self.indent)
    }
}

impl serde_json::ser::Formatter for RowPerLine {
    fn begin_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.indent += 1;
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.indent -= 1;
        self.new_line(writer)?;
        writer.write_all(b"}")
    }

    fn begin_object_key<W: ?Sized + io::Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        if !first {
            writer.write_all(b",")?;
        }
        self.new_line(writer)
    }

    fn begin_object_value<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn begin_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.arrays > 0 {
            self.new_line(writer)?;
        }
        self.after_row = false;
        self.arrays += 1;
        self.indent += 1;
        writer.write_all(b"[")
    }

    fn end_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.arrays -= 1;
        self.indent -= 1;
        if self.after_row {
            self.new_line(writer)?;
        }
        self.after_row = self.arrays > 0;
        writer.write_all(b"]")
    }
}

#[cfg(test)]
mod tests {
    use super::to_json;

    // Verifies: MAP-020.
    #[test]
    fn a_document_ends_its_last_line() {
        assert_eq!(
            to_json(&[[1.5, 2.0], [3.0, 4.0]]),
            "[\n  [1.5,2.0],\n  [3.0,4.0]\n]\n"
        );
    }
}
