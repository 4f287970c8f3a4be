//! Force maps as JSON (`spec/force-map.md`).

use std::io;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Certificate, ForceMap, ForceTable, Matrix, Measurement, Source};
use crate::force::Force;
use crate::phantom::Phantom;
use crate::refusal::{Refusal, shortened};

/// What the key `schema` of a force map says.
///
/// Implements: MAP-020.
pub const SCHEMA: &str = "palpate-force-map";

/// The version of the schema that this program writes and reads.
///
/// Implements: MAP-020.
pub const SCHEMA_VERSION: u64 = 1;

/// The source as it stands in the file; the certificate stands beside it.
#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum SourceKey {
    FiniteElements {},
    Measured(Measurement),
}

/// The file's keys, in the order in which they are written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    schema: String,
    schema_version: u64,
    program_version: String,
    source: SourceKey,
    phantom: Option<Phantom>,
    depths_m: Vec<f64>,
    laterals_m: Vec<f64>,
    normal_force_n: Matrix,
    lateral_force_n: Matrix,
    certificate: Option<Certificate>,
}

/// The two keys that say whether the rest can be read.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    schema: Value,
    #[serde(default)]
    schema_version: Value,
}

impl ForceMap {
    /// This map as JSON, each row of a matrix on one line.
    ///
    /// Implements: MAP-020, MAP-022.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// The map in `text`, the content of `file`, which is named in errors alone.
    ///
    /// # Errors
    /// The text is not JSON, has another schema or a newer version, a missing, unknown or repeated key, or anything but a number
    /// in a number's place, or makes a map that [`ForceMap::new`] or [`ForceTable::new`] refuses; with the file, and the line
    /// where there is one.
    ///
    /// Implements: MAP-020, MAP-024, MAP-002, MAP-026, MAP-037.
    pub fn from_json(text: &str, file: &str) -> Result<ForceMap, Refusal> {
        read(text).map_err(|refusal| refusal.in_file(file))
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

impl From<ForceMap> for Document {
    fn from(map: ForceMap) -> Document {
        let (source, certificate) = match map.source {
            Source::FiniteElements { certificate } => {
                (SourceKey::FiniteElements {}, Some(certificate))
            }
            Source::Measured(measurement) => (SourceKey::Measured(measurement), None),
        };
        Document {
            schema: SCHEMA.into(),
            schema_version: SCHEMA_VERSION,
            program_version: map.program_version,
            source,
            phantom: map.phantom,
            depths_m: map.table.depths().into(),
            laterals_m: map.table.laterals().into(),
            normal_force_n: map.table.forces().normal.clone(),
            lateral_force_n: map.table.forces().lateral.clone(),
            certificate,
        }
    }
}

impl TryFrom<Document> for ForceMap {
    type Error = Refusal;

    fn try_from(document: Document) -> Result<ForceMap, Refusal> {
        let source = match (document.source, document.certificate) {
            (SourceKey::FiniteElements {}, Some(certificate)) => {
                Source::FiniteElements { certificate }
            }
            (SourceKey::Measured(measurement), None) => Source::Measured(measurement),
            (SourceKey::FiniteElements {}, None) => {
                let expected = "one for a map from finite elements";
                return Err(Refusal::state("certificate is missing", expected));
            }
            (SourceKey::Measured(_), Some(_)) => {
                let expected = "none for a measured map";
                return Err(Refusal::state("certificate is there", expected));
            }
        };
        let forces = Force::new(document.lateral_force_n, document.normal_force_n);
        let map = ForceMap {
            program_version: document.program_version,
            source,
            phantom: document.phantom,
            table: ForceTable::new(document.depths_m, document.laterals_m, forces)?,
        };
        map.checked()
    }
}

fn read(text: &str) -> Result<ForceMap, Refusal> {
    check_schema(text, SCHEMA, SCHEMA_VERSION)?;
    parse::<Document>(text)?.try_into()
}

/// Whether a document has the schema and the version that this program reads. They come first: a newer file may have keys that
/// this program does not know.
pub fn check_schema(text: &str, schema: &str, version: u64) -> Result<(), Refusal> {
    let header: Header = parse(text)?;
    let refused = |key, found: Value, expected| {
        let found = shortened(&found.to_string());
        Err(Refusal::value(key, found, expected))
    };
    if header.schema != schema {
        return refused("schema", header.schema, format!("{schema:?}"));
    }
    if header.schema_version != version {
        let expected = format!("{version}, which is what this program reads");
        return refused("schema_version", header.schema_version, expected);
    }
    Ok(())
}

/// What `text` says, or the line, the column and the key where it is wrong, with the text around that place.
pub fn parse<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    let mut json = serde_json::Deserializer::from_str(text);
    let document = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let key = match error.path().to_string() {
            path if path == "." => String::new(),
            path => path + ": ",
        };
        (key, error.into_inner())
    });
    let read = document.and_then(|read| match json.end() {
        Ok(()) => Ok(read),
        Err(error) => Err((String::new(), error)),
    });
    read.map_err(|(key, error)| {
        let (line, column) = (error.line(), error.column());
        let place = format!(" at line {line} column {column}");
        let message = error.to_string();
        let message = message.strip_suffix(&place).unwrap_or(&message);
        let written = text.lines().nth(line.saturating_sub(1)).unwrap_or("");
        // Some 30 bytes to each side: a file without line breaks is one long line.
        let near = written.char_indices();
        let near = near.filter(|(at, _)| at.abs_diff(column) < 30);
        let near: String = near.map(|(_, c)| c).collect();
        let found = format!("column {column}: {key}{message}, in {:?}", near.trim());
        let refusal = Refusal::state(found, "");
        match line {
            0 => refusal,
            line => refusal.at(line),
        }
    })
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
