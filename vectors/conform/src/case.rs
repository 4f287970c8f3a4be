//! One case of the vectors.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::tolerance::Tolerance;

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// The JSON text of the arguments.
    Arguments(String),
    /// A whole line, as it stands.
    Line(String),
}

impl Question {
    /// Whether arguments are given, and not a line.
    pub fn is_arguments(&self) -> bool {
        matches!(self, Question::Arguments(_))
    }
}

/// What the answer must be.
#[derive(Debug, Clone, PartialEq)]
pub enum Expected {
    /// These values, each with how far it may be off.
    Values(Vec<(String, Value, Tolerance)>),
    /// A refusal, with the code that this project's oracle would give.
    Refusal(String),
}

impl Expected {
    /// Whether there is an answer, and no refusal.
    pub fn is_values(&self) -> bool {
        matches!(self, Expected::Values(_))
    }
}

/// The answer that a known bug would give.
#[derive(Debug, Clone, PartialEq)]
pub struct Wrong {
    /// The flag of the bug.
    pub flag: String,
    /// Its answer.
    pub values: Map<String, Value>,
}

/// A case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name, and the id of the request.
    pub id: String,
    /// What is special about it.
    pub comment: String,
    /// What is asked.
    pub question: Question,
    /// What the answer must be.
    pub expected: Expected,
    /// The bugs that this case can show.
    pub flags: Vec<String>,
    /// Answers of bugs.
    pub wrong: Vec<Wrong>,
}

impl Case {
    /// The line of the request, with its end.
    pub fn line(&self, op: &str) -> Vec<u8> {
        let text = match &self.question {
            Question::Line(line) => format!("{line}\n"),
            Question::Arguments(arguments) => {
                let (id, op) = (Value::from(&self.id[..]), Value::from(op));
                format!("{{\"id\":{id},\"op\":{op},\"args\":{arguments}}}\n")
            }
        };
        text.into_bytes()
    }
}

/// A case as it stands in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseText {
    pub id: String,
    pub comment: String,
    pub args: Option<Box<RawValue>>,
    pub line: Option<String>,
    pub ok: Option<Map<String, Value>>,
    pub bits: Option<Map<String, Value>>,
    pub error: Option<String>,
    #[serde(default)]
    pub tolerance: BTreeMap<String, ToleranceText>,
    #[serde(default)]
    pub flags: Vec<String>,
    #[serde(default)]
    pub wrong: Vec<WrongText>,
}

/// The answer of a bug as it stands in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrongText {
    pub flag: String,
    pub ok: Map<String, Value>,
}

/// A tolerance as it stands in a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ToleranceText {
    pub ulp: Option<f64>,
    pub absolute: Option<f64>,
    pub unit: Option<String>,
    pub relative: Option<f64>,
    pub exact: Option<bool>,
    pub reason: String,
}

impl ToleranceText {
    /// The tolerance, if there is just one, of a size that can be.
    pub fn tolerance(&self) -> Result<Tolerance, String> {
        let given = [
            self.ulp.map(Tolerance::Ulp),
            self.absolute.map(Tolerance::Absolute),
            self.relative.map(Tolerance::Relative),
            self.exact
                .and_then(|exact| exact.then_some(Tolerance::Exact)),
        ];
        let &[tolerance] = &given.into_iter().flatten().collect::<Vec<_>>()[..] else {
            return Err("expected one of ulp, absolute, relative, exact: true".into());
        };
        let size = match tolerance {
            Tolerance::Ulp(size) | Tolerance::Absolute(size) | Tolerance::Relative(size) => size,
            Tolerance::Exact => 0.0,
        };
        if !(0.0..f64::INFINITY).contains(&size) {
            return Err(format!("{size} is no tolerance, expected at least 0"));
        }
        if self.unit.is_none() && matches!(tolerance, Tolerance::Absolute(_)) {
            return Err("expected the unit of the absolute tolerance".into());
        }
        if self.reason.trim().is_empty() {
            return Err("expected a reason".into());
        }
        Ok(tolerance)
    }
}
