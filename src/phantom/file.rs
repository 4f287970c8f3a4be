//! Phantom files: TOML, in mm and kPa (`spec/phantom.md`).

use std::fmt;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::decimal::parse_scaled;
use super::{Gel, Inclusion, InvalidPhantom, Material, Phantom, Probe, Quantity, Skin};
use crate::csv::one_line;

/// A number in a phantom file: where it stands, without the unit, and what it measures.
type Field = (&'static str, Quantity);

const GEL: [Field; 4] = [
    ("gel.width", Quantity::Length),
    ("gel.height", Quantity::Length),
    ("gel.youngs_modulus", Quantity::Modulus),
    ("gel.poisson_ratio", Quantity::Ratio),
];
const SKIN: [Field; 3] = [
    ("skin.thickness", Quantity::Length),
    ("skin.youngs_modulus", Quantity::Modulus),
    ("skin.poisson_ratio", Quantity::Ratio),
];
const INCLUSION: [Field; 4] = [
    ("inclusion.diameter", Quantity::Length),
    ("inclusion.depth", Quantity::Length),
    ("inclusion.youngs_modulus", Quantity::Modulus),
    ("inclusion.poisson_ratio", Quantity::Ratio),
];
const PROBE: [Field; 2] = [
    ("probe.radius", Quantity::Length),
    ("probe.length", Quantity::Length),
];
const TOP_LEVEL: [&str; 5] = ["name", "gel", "skin", "inclusion", "probe"];

/// Why a phantom file is refused: one line that begins with the file.
///
/// ```
/// use palpate::phantom::Phantom;
///
/// let text = Phantom::builtin("none")?.to_toml()?.replace("radius_mm = 6.5", "radius_mm = 17.0");
/// let error = Phantom::from_toml(&text, "wide.toml").unwrap_err();
/// assert_eq!(error.line, Some(15));
/// assert!(error.to_string().starts_with("wide.toml:15: probe.radius_mm = 17.0, allowed: "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: PHA-022, PHA-023, PHA-024, PHA-025, PHA-026.
#[derive(Debug, Clone, PartialEq)]
pub struct PhantomFileError {
    /// The file, as its reader named it.
    pub file: String,
    /// The line, from 1, where there is one.
    pub line: Option<usize>,
    /// What is wrong there.
    pub problem: PhantomFileProblem,
}

impl fmt::Display for PhantomFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.problem),
            None => write!(f, "{}: {}", self.file, self.problem),
        }
    }
}

impl std::error::Error for PhantomFileError {}

/// What is wrong with a phantom file.
///
/// ```
/// use palpate::phantom::{Phantom, PhantomFileProblem};
///
/// let error = Phantom::from_toml("name = 3", "mine.toml").unwrap_err();
/// assert!(matches!(error.problem, PhantomFileProblem::WrongType { key, .. } if key == "name"));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhantomFileProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(String),
    /// The text is not TOML.
    #[error("column {column}: not TOML: {message}")]
    Syntax {
        /// Column, from 1, in characters.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// A key that a phantom does not have.
    #[error("unknown key {key:?}, allowed: {allowed}")]
    UnknownKey {
        /// The key with its table.
        key: String,
        /// The keys of that table.
        allowed: String,
    },
    /// A key is not there.
    #[error("{key} is missing, expected {expected}")]
    MissingKey {
        /// The key with its table.
        key: String,
        /// What its value would be.
        expected: &'static str,
    },
    /// A value of another type.
    #[error("{key} = {found}, expected {expected}")]
    WrongType {
        /// The key with its table.
        key: String,
        /// The value.
        found: String,
        /// What it would be.
        expected: &'static str,
    },
    /// The values make no phantom.
    #[error(transparent)]
    Invalid(#[from] InvalidPhantom),
}

impl Phantom {
    /// Reads the phantom file at `path`.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let path = std::env::temp_dir().join(format!("phantom-{}.toml", std::process::id()));
    /// std::fs::write(&path, Phantom::builtin("4.6")?.to_toml()?)?;
    /// assert_eq!(Phantom::read(&path)?, Phantom::builtin("4.6")?);
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Phantom::from_toml`]; [`PhantomFileProblem::Read`] if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Phantom, PhantomFileError> {
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Phantom::from_toml(&text, &file),
            Err(error) => Err(PhantomFileError {
                file,
                line: None,
                problem: PhantomFileProblem::Read(error.to_string()),
            }),
        }
    }

    /// The phantom in `text`, the content of `file`, which is named in errors alone.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let text = r#"
    /// name = "soft, without inclusion"
    /// gel = { width_mm = 34, height_mm = 15, youngs_modulus_kpa = 2.5, poisson_ratio = 0.49 }
    /// skin = { thickness_mm = 0.5, youngs_modulus_kpa = 180, poisson_ratio = 0.49 }
    /// probe = { radius_mm = 6.5, length_mm = 30 }
    /// "#;
    /// let phantom = Phantom::from_toml(text, "soft.toml")?;
    /// assert_eq!((phantom.gel.width, phantom.gel.material.youngs_modulus), (0.034, 2500.0));
    /// # Ok::<(), palpate::phantom::PhantomFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`PhantomFileError`] if the text is not TOML, has an unknown key, lacks one, has a value of
    /// another type, or makes a phantom that [`Phantom::validate`] refuses.
    ///
    /// Implements: PHA-020, PHA-021, PHA-022, PHA-023, PHA-024, PHA-025, PHA-026, PHA-028.
    pub fn from_toml(text: &str, file: &str) -> Result<Phantom, PhantomFileError> {
        let mut reader = Reader {
            text,
            file,
            lines: Vec::new(),
        };
        let document = match DeTable::parse(text) {
            Ok(document) => document.into_inner(),
            Err(error) => return Err(reader.syntax_error(&error)),
        };
        let phantom = reader.phantom(&document)?;
        match phantom.validate() {
            Ok(()) => Ok(phantom),
            Err(invalid) => {
                let line = reader.line_of(invalid.key());
                Err(reader.error(line, invalid.into()))
            }
        }
    }

    /// This phantom as the text of a phantom file.
    ///
    /// # Errors
    /// [`InvalidPhantom`] if [`Phantom::validate`] refuses it, so that what is written can be read.
    ///
    /// Implements: PHA-021, PHA-027.
    pub fn to_toml(&self) -> Result<String, InvalidPhantom> {
        self.validate()?;
        let Phantom {
            name,
            gel,
            skin,
            inclusion,
            probe,
        } = self;
        let name = toml::Value::String(name.clone());
        let mut text = format!("name = {name}\n");
        let elastic = |material: &Material| (material.youngs_modulus, material.poisson_ratio);
        let (modulus, ratio) = elastic(&gel.material);
        write_table(
            &mut text,
            "gel",
            &GEL,
            &[gel.width, gel.height, modulus, ratio],
        );
        let (modulus, ratio) = elastic(&skin.material);
        write_table(&mut text, "skin", &SKIN, &[skin.thickness, modulus, ratio]);
        if let Some(disc) = inclusion {
            let (modulus, ratio) = elastic(&disc.material);
            let values = [disc.diameter, disc.depth, modulus, ratio];
            write_table(&mut text, "inclusion", &INCLUSION, &values);
        }
        write_table(&mut text, "probe", &PROBE, &[probe.radius, probe.length]);
        Ok(text)
    }
}

fn write_table(text: &mut String, table: &str, fields: &[Field], values: &[f64]) {
    text.push_str(&format!("\n[{table}]\n"));
    for (&field, &value) in fields.iter().zip(values) {
        let value = field.1.in_file_unit(value);
        text.push_str(&format!("{} = {value}\n", key_in_table(field)));
    }
}

/// The key of a field within its table, with the unit: `width_mm` of `gel.width`.
fn key_in_table((path, quantity): Field) -> String {
    let key = path.split_once('.').map_or(path, |(_, key)| key);
    format!("{key}{}", quantity.suffix())
}

/// Reads one file's tables, and remembers the line of every value for errors found later.
struct Reader<'a> {
    text: &'a str,
    file: &'a str,
    lines: Vec<(&'static str, usize)>,
}

impl Reader<'_> {
    fn phantom(&mut self, document: &DeTable<'_>) -> Result<Phantom, PhantomFileError> {
        self.refuse_unknown(document, "", &TOP_LEVEL.map(String::from))?;
        let name = self.name(document)?;
        let [width, height, modulus, ratio] = self.table(document, "gel", GEL)?;
        let gel = Gel {
            width,
            height,
            material: material(modulus, ratio),
        };
        let [thickness, modulus, ratio] = self.table(document, "skin", SKIN)?;
        let skin = Skin {
            thickness,
            material: material(modulus, ratio),
        };
        let inclusion = if document.contains_key("inclusion") {
            let [diameter, depth, modulus, ratio] = self.table(document, "inclusion", INCLUSION)?;
            Some(Inclusion {
                diameter,
                depth,
                material: material(modulus, ratio),
            })
        } else {
            None
        };
        let [radius, length] = self.table(document, "probe", PROBE)?;
        let probe = Probe { radius, length };
        Ok(Phantom {
            name,
            gel,
            skin,
            inclusion,
            probe,
        })
    }

    fn name(&mut self, document: &DeTable<'_>) -> Result<String, PhantomFileError> {
        let expected = "a string";
        let Some(value) = document.get("name") else {
            let key = "name".into();
            return Err(self.error(None, PhantomFileProblem::MissingKey { key, expected }));
        };
        let line = self.line(value.span().start);
        self.lines.push(("name", line));
        match value.get_ref() {
            DeValue::String(name) => Ok(name.to_string()),
            other => Err(self.wrong_type("name".into(), line, other, expected)),
        }
    }

    /// The numbers of table `name`, SI, in the order of `fields`.
    fn table<const N: usize>(
        &mut self,
        document: &DeTable<'_>,
        name: &str,
        fields: [Field; N],
    ) -> Result<[f64; N], PhantomFileError> {
        let Some(value) = document.get(name) else {
            let (key, expected) = (name.into(), "a table");
            return Err(self.error(None, PhantomFileProblem::MissingKey { key, expected }));
        };
        let line = self.line(value.span().start);
        let DeValue::Table(table) = value.get_ref() else {
            return Err(self.wrong_type(name.into(), line, value.get_ref(), "a table"));
        };
        let keys = fields.map(key_in_table);
        self.refuse_unknown(table, name, &keys)?;
        let mut values = [0.0; N];
        for ((field, key), number) in fields.into_iter().zip(&keys).zip(&mut values) {
            let path = format!("{name}.{key}");
            let Some(value) = table.get(key.as_str()) else {
                let problem = PhantomFileProblem::MissingKey {
                    key: path,
                    expected: "a number",
                };
                return Err(self.error(Some(line), problem));
            };
            *number = self.number(field, path, value)?;
        }
        Ok(values)
    }

    fn number(
        &mut self,
        (path, quantity): Field,
        key: String,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<f64, PhantomFileError> {
        let line = self.line(value.span().start);
        self.lines.push((path, line));
        let decimal = match value.get_ref() {
            DeValue::Float(float) => Some(float.as_str()),
            DeValue::Integer(integer) if integer.radix() == 10 => Some(integer.as_str()),
            _ => None,
        };
        decimal
            .and_then(|decimal| parse_scaled(decimal, quantity.power_to_si()))
            .ok_or_else(|| self.wrong_type(key, line, value.get_ref(), "a finite decimal number"))
    }

    fn refuse_unknown(
        &self,
        table: &DeTable<'_>,
        name: &str,
        allowed: &[String],
    ) -> Result<(), PhantomFileError> {
        // The first in the file, not in the alphabet.
        let unknown = table
            .keys()
            .filter(|key| !allowed.iter().any(|a| a == key.get_ref()));
        let Some(first) = unknown.min_by_key(|key| key.span().start) else {
            return Ok(());
        };
        let key = match name {
            "" => first.get_ref().to_string(),
            _ => format!("{name}.{}", first.get_ref()),
        };
        let allowed = allowed.join(", ");
        let line = self.line(first.span().start);
        Err(self.error(Some(line), PhantomFileProblem::UnknownKey { key, allowed }))
    }

    fn wrong_type(
        &self,
        key: String,
        line: usize,
        found: &DeValue<'_>,
        expected: &'static str,
    ) -> PhantomFileError {
        let found = match found {
            DeValue::String(text) => format!("{:?}", text.chars().take(40).collect::<String>()),
            DeValue::Integer(integer) => integer.to_string(),
            DeValue::Float(float) => float.to_string(),
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Datetime(_) => "a date".into(),
            DeValue::Array(_) => "an array".into(),
            DeValue::Table(_) => "a table".into(),
        };
        self.error(
            Some(line),
            PhantomFileProblem::WrongType {
                key,
                found,
                expected,
            },
        )
    }

    fn syntax_error(&self, error: &toml::de::Error) -> PhantomFileError {
        let at = error.span().map_or(self.text.len(), |span| span.start);
        let before = self.text.get(..at).unwrap_or(self.text);
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let message = one_line(error.message());
        self.error(
            Some(self.line(at)),
            PhantomFileProblem::Syntax { column, message },
        )
    }

    fn error(&self, line: Option<usize>, problem: PhantomFileProblem) -> PhantomFileError {
        PhantomFileError {
            file: self.file.into(),
            line,
            problem,
        }
    }

    /// The line, from 1, of the byte at `at`.
    fn line(&self, at: usize) -> usize {
        let before = self.text.as_bytes().iter().take(at);
        before.filter(|&&byte| byte == b'\n').count() + 1
    }

    fn line_of(&self, path: &str) -> Option<usize> {
        self.lines
            .iter()
            .find(|(known, _)| *known == path)
            .map(|&(_, line)| line)
    }
}

fn material(youngs_modulus: f64, poisson_ratio: f64) -> Material {
    Material {
        youngs_modulus,
        poisson_ratio,
    }
}
