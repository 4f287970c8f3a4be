//! One case of the vectors.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::tolerance::{Condition, Tolerance};
use super::verdict::Class;

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// The arguments.
    Arguments(Map<String, Value>),
    /// A whole line, as it stands.
    Line(String),
}

/// A value of an answer, and how far it may be off.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Its key.
    pub key: String,
    /// The value.
    pub value: Value,
    /// How far it may be off in exact work.
    pub tolerance: Tolerance,
    /// What each unit roundoff adds.
    pub condition: Condition,
}

/// What the answer must be.
#[derive(Debug, Clone, PartialEq)]
pub enum Expected {
    /// These values.
    Values(Vec<Wanted>),
    /// A refusal.
    Refusal {
        /// What a program does wrong that answers.
        class: Class,
        /// The answer of a program that reads the request as it is meant, where it can be.
        lenient: Map<String, Value>,
    },
}

/// The answer that a known bug would give.
#[derive(Debug, Clone, PartialEq)]
pub struct BugAnswer {
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
    /// The largest unit roundoff of a precision that can answer it; of any, if there is none.
    pub roundoff: Option<f64>,
    /// The bugs that this case can show.
    pub flags: Vec<String>,
    /// Answers of bugs.
    pub wrong: Vec<BugAnswer>,
}

impl Case {
    /// The line of the request, with its end: no spaces, and the keys in the order of their names.
    ///
    /// Implements: ORA-057.
    pub fn line(&self, op: &str) -> String {
        match &self.question {
            Question::Line(line) => format!("{line}\n"),
            Question::Arguments(args) => {
                serde_json::json!({"id": self.id, "op": op, "args": args}).to_string() + "\n"
            }
        }
    }
}

/// A case as it stands in a file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CaseText {
    pub id: String,
    pub comment: String,
    pub args: Option<Map<String, Value>>,
    pub line: Option<String>,
    pub ok: Option<Map<String, Value>>,
    pub bits: Option<Map<String, Value>>,
    pub error: Option<String>,
    #[serde(default)]
    pub lenient: Map<String, Value>,
    #[serde(default)]
    pub tolerance: BTreeMap<String, ToleranceText>,
    #[serde(default)]
    pub condition: BTreeMap<String, Condition>,
    pub roundoff: Option<f64>,
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
