//! Force maps as JSON (`spec/force-map.md`).

use std::fmt;
use std::io;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize as DeriveDeserialize, Serialize};
use serde_json::Value;

use super::file::{ForceMapFileError, ForceMapFileProblem};
use super::{Certificate, ForceMap, ForceTable, Matrix, Source};
use crate::csv::{one_line, shortened};
use crate::phantom::Phantom;

/// What the key `schema` of a force map says.
///
/// Implements: MAP-020.
pub const SCHEMA: &str = "palpate-force-map";

/// The version of the schema that this program writes and reads.
///
/// Implements: MAP-020.
pub const SCHEMA_VERSION: u64 = 1;

const KEYS: [&str; 10] = [
    "schema",
    "schema_version",
    "program_version",
    "source",
    "phantom",
    "depths_m",
    "laterals_m",
    "normal_force_n",
    "lateral_force_n",
    "certificate",
];

/// The source as it stands in the file; the certificate stands beside it.
#[derive(Serialize, DeriveDeserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum SourceKey {
    FiniteElements {},
    Measured { file: String, note: String },
}

/// The file's keys, in the order in which they are written.
#[derive(Serialize)]
struct Written<'a> {
    schema: &'static str,
    schema_version: u64,
    program_version: &'a str,
    source: SourceKey,
    phantom: Option<&'a Phantom>,
    depths_m: &'a [f64],
    laterals_m: &'a [f64],
    normal_force_n: &'a Matrix,
    lateral_force_n: &'a Matrix,
    certificate: Option<&'a Certificate>,
}

impl ForceMap {
    /// This map as JSON, each row of a matrix on one line.
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n";
    /// let json = ForceMap::from_csv(text, "gel.csv", "", None)?.to_json();
    /// assert!(json.starts_with("{\n  \"schema\": \"palpate-force-map\",\n  \"schema_version\": 1,\n"));
    /// # Ok::<(), palpate::force_map::ForceMapFileError>(())
    /// ```
    ///
    /// Implements: MAP-020, MAP-021, MAP-022.
    pub fn to_json(&self) -> String {
        let source = match self.source() {
            Source::FiniteElements { .. } => SourceKey::FiniteElements {},
            Source::Measured { file, note } => SourceKey::Measured {
                file: file.clone(),
                note: note.clone(),
            },
        };
        let document = Written {
            schema: SCHEMA,
            schema_version: SCHEMA_VERSION,
            program_version: self.program_version(),
            source,
            phantom: self.phantom(),
            depths_m: self.depths(),
            laterals_m: self.laterals(),
            normal_force_n: self.normal_force(),
            lateral_force_n: self.lateral_force(),
            certificate: self.certificate(),
        };
        let mut text = Vec::new();
        let mut serializer =
            serde_json::Serializer::with_formatter(&mut text, RowPerLine::default());
        document
            .serialize(&mut serializer)
            .expect("strings and finite numbers go into memory without an error");
        text.push(b'\n');
        String::from_utf8(text).expect("serde_json writes UTF-8")
    }

    /// The map in `text`, the content of `file`, which is named in errors alone.
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,0.1,0\n";
    /// let map = ForceMap::from_csv(text, "gel.csv", "", None)?;
    /// // Every number comes back to the bit.
    /// assert_eq!(ForceMap::from_json(&map.to_json(), "map.json")?, map);
    /// # Ok::<(), palpate::force_map::ForceMapFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`ForceMapFileError`] if the text is not JSON, has another schema or a newer version, a
    /// missing, unknown or repeated key, or anything but a number in a number's place, or makes a
    /// map that [`ForceMap::new`] or [`ForceTable::new`] refuses.
    ///
    /// Implements: MAP-020, MAP-023, MAP-024, MAP-025, MAP-026, MAP-037.
    pub fn from_json(text: &str, file: &str) -> Result<ForceMap, ForceMapFileError> {
        let json_error = |error| json_problem(text, error);
        // The version first: a newer file may have keys that this program does not know.
        let header: Header = serde_json::from_str(text)
            .map_err(json_error)
            .map_err(|(line, problem)| problem.at(file, line))?;
        header.check().map_err(|problem| problem.at(file, None))?;
        let read: Read = serde_json::from_str(text)
            .map_err(json_error)
            .map_err(|(line, problem)| problem.at(file, line))?;
        read.into_map().map_err(|problem| problem.at(file, None))
    }
}

/// A serde_json error with its line and the text around it.
fn json_problem(text: &str, error: serde_json::Error) -> (Option<usize>, ForceMapFileProblem) {
    let (line, column) = (error.line(), error.column());
    let place = format!(" at line {line} column {column}");
    let message = error.to_string();
    let message = message.strip_suffix(&place).unwrap_or(&message);
    // It may quote a key with a line break.
    let message = one_line(message);
    let written = text.lines().nth(line.saturating_sub(1)).unwrap_or("");
    // Some 30 bytes to each side: a file without line breaks is one long line.
    let near: String = written
        .char_indices()
        .filter(|(at, _)| at.abs_diff(column) < 30)
        .map(|(_, c)| c)
        .collect();
    let excerpt = near.trim().into();
    let problem = ForceMapFileProblem::Json {
        column,
        message,
        excerpt,
    };
    ((line > 0).then_some(line), problem)
}

/// The two keys that say whether the rest can be read.
#[derive(DeriveDeserialize)]
struct Header {
    #[serde(default)]
    schema: Value,
    #[serde(default)]
    schema_version: Value,
}

impl Header {
    fn check(&self) -> Result<(), ForceMapFileProblem> {
        if self.schema != SCHEMA {
            return Err(ForceMapFileProblem::Schema {
                key: "schema",
                found: one_line(&shortened(&self.schema.to_string())),
                expected: format!("{SCHEMA:?}"),
            });
        }
        if self.schema_version != SCHEMA_VERSION {
            return Err(ForceMapFileProblem::Schema {
                key: "schema_version",
                found: one_line(&shortened(&self.schema_version.to_string())),
                expected: format!("{SCHEMA_VERSION}, which is what this program reads"),
            });
        }
        Ok(())
    }
}

/// The file's keys as they are found.
#[derive(Default)]
struct Read {
    program_version: Option<String>,
    source: Option<SourceKey>,
    phantom: Option<Option<Phantom>>,
    depths: Option<Vec<f64>>,
    laterals: Option<Vec<f64>>,
    normal_force: Option<Matrix>,
    lateral_force: Option<Matrix>,
    certificate: Option<Option<Certificate>>,
}

impl Read {
    fn into_map(self) -> Result<ForceMap, ForceMapFileProblem> {
        let forces = ForceTable::new(
            required("depths_m", self.depths)?,
            required("laterals_m", self.laterals)?,
            required("normal_force_n", self.normal_force)?,
            required("lateral_force_n", self.lateral_force)?,
        )?;
        let source = match (required("source", self.source)?, self.certificate.flatten()) {
            (SourceKey::FiniteElements {}, Some(certificate)) => {
                Source::FiniteElements { certificate }
            }
            (SourceKey::Measured { file, note }, None) => Source::Measured { file, note },
            (SourceKey::FiniteElements {}, None) => {
                let (found, expected) = ("missing", "one for a map from finite elements");
                return Err(ForceMapFileProblem::Key {
                    key: "certificate",
                    found,
                    expected,
                });
            }
            (SourceKey::Measured { .. }, Some(_)) => {
                let (found, expected) = ("there", "none for a measured map");
                return Err(ForceMapFileProblem::Key {
                    key: "certificate",
                    found,
                    expected,
                });
            }
        };
        let program_version = required("program_version", self.program_version)?;
        let map = ForceMap::by_version(program_version, source, self.phantom.flatten(), forces)?;
        Ok(map)
    }
}

fn required<T>(key: &'static str, value: Option<T>) -> Result<T, ForceMapFileProblem> {
    let (found, expected) = ("missing", "a value, as in spec/force-map.md");
    value.ok_or(ForceMapFileProblem::Key {
        key,
        found,
        expected,
    })
}

impl<'de> Deserialize<'de> for Read {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Read, D::Error> {
        deserializer.deserialize_map(ReadVisitor)
    }
}

/// By hand, since a derived visitor does not say in which key a value was wrong.
struct ReadVisitor;

impl<'de> Visitor<'de> for ReadVisitor {
    type Value = Read;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Read, A::Error> {
        let mut read = Read::default();
        let (mut schema, mut schema_version) = (None::<String>, None::<u64>);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "schema" => fill(&mut schema, &key, &mut map)?,
                "schema_version" => fill(&mut schema_version, &key, &mut map)?,
                "program_version" => fill(&mut read.program_version, &key, &mut map)?,
                "source" => fill(&mut read.source, &key, &mut map)?,
                "phantom" => fill(&mut read.phantom, &key, &mut map)?,
                "depths_m" => fill(&mut read.depths, &key, &mut map)?,
                "laterals_m" => fill(&mut read.laterals, &key, &mut map)?,
                "normal_force_n" => fill(&mut read.normal_force, &key, &mut map)?,
                "lateral_force_n" => fill(&mut read.lateral_force, &key, &mut map)?,
                "certificate" => fill(&mut read.certificate, &key, &mut map)?,
                _ => {
                    let (key, keys) = (shortened(&key), KEYS.join(", "));
                    let message = format!("unknown key {key:?}, expected one of {keys}");
                    return Err(de::Error::custom(message));
                }
            }
        }
        Ok(read)
    }
}

fn fill<'de, T: Deserialize<'de>, A: MapAccess<'de>>(
    slot: &mut Option<T>,
    key: &str,
    map: &mut A,
) -> Result<(), A::Error> {
    if slot.is_some() {
        return Err(de::Error::custom(format!(
            "{key} is there twice, expected once"
        )));
    }
    let named = |error| de::Error::custom(format!("{key}: {error}"));
    *slot = Some(map.next_value().map_err(named)?);
    Ok(())
}

impl Serialize for Matrix {
    /// As an array of rows.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.rows())
    }
}

impl<'de> Deserialize<'de> for Matrix {
    /// From an array of rows of one length.
    ///
    /// Implements: MAP-003, MAP-024.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Matrix, D::Error> {
        deserializer.deserialize_seq(MatrixVisitor)
    }
}

struct MatrixVisitor;

impl<'de> Visitor<'de> for MatrixVisitor {
    type Value = Matrix;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of rows of numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<Matrix, A::Error> {
        let mut values = Vec::new();
        let mut columns = None;
        for row in 0.. {
            let named = |error| de::Error::custom(format!("row {row}: {error}"));
            let Some(numbers) = rows.next_element::<Vec<f64>>().map_err(named)? else {
                break;
            };
            let columns = *columns.get_or_insert(numbers.len());
            if numbers.len() != columns {
                let found = numbers.len();
                return Err(de::Error::custom(format!(
                    "row {row} has {found} numbers, expected {columns} as in row 0"
                )));
            }
            values.extend(numbers);
        }
        let matrix = Matrix::new(columns.unwrap_or(0), values);
        matrix.ok_or_else(|| de::Error::custom("rows of different lengths"))
    }
}

/// Lays JSON out with one key a line, and one matrix row a line.
///
/// Implements: MAP-021.
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
