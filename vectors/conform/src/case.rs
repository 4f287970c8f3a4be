//! One case of the vectors.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::outcome::Class;
use super::tolerance::{Condition, Difference, Limit, Tolerance, compare};

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// The arguments of the op.
    Arguments(Map<String, Value>),
    /// A whole line, sent as it stands.
    Line(String),
}

/// An expected value, and how far the answer may be off.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Its key.
    pub key: String,
    /// The value.
    pub value: Value,
    /// How far the answer may be off in exact arithmetic.
    pub tolerance: Tolerance,
    /// What each unit roundoff adds.
    pub condition: Condition,
}

impl Wanted {
    /// Compares an answer with the wanted value, or with another one in its place, in a working precision.
    ///
    /// # Errors
    /// The first difference; a key that the answer does not have is one.
    pub(super) fn compare(
        &self,
        value: &Value,
        answer: &Map<String, Value>,
        unit_roundoff: f64,
    ) -> Result<(), Difference> {
        let limit = Limit {
            tolerance: self.tolerance,
            times: 1.0,
            condition: &self.condition,
            unit_roundoff,
        };
        match answer.get(&self.key) {
            Some(found) => compare(&self.key, value, found, limit),
            None => Err(Difference {
                place: self.key.clone(),
                text: "is missing in the answer".into(),
                class: Class::Protocol,
            }),
        }
    }
}

/// What the answer must be.
#[derive(Debug, Clone, PartialEq)]
pub enum Expected {
    /// These values.
    Values(Vec<Wanted>),
    /// A refusal.
    Refusal {
        /// The class of an answer that is no refusal.
        class: Class,
        /// The answer of a program that understands a malformed request, where that is possible.
        lenient: Map<String, Value>,
    },
}

impl Expected {
    /// Whether values are expected, not a refusal.
    pub fn is_number(&self) -> bool {
        matches!(self, Expected::Values(_))
    }

    /// The expected values; none if a refusal is expected.
    pub fn values(&self) -> &[Wanted] {
        match self {
            Expected::Values(values) => values,
            Expected::Refusal { .. } => &[],
        }
    }
}

/// The answer that a known bug gives.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BugAnswer {
    /// The flag of the bug.
    pub flag: String,
    /// Its answer.
    #[serde(rename = "ok")]
    pub values: Map<String, Value>,
}

/// A bug that cases can show.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bug {
    /// What is wrong.
    pub bug: String,
    /// Where to look.
    pub notes: String,
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
    /// The largest unit roundoff of a precision that can answer it; none if every precision can.
    pub roundoff: Option<f64>,
    /// The bugs that this case can show.
    pub flags: Vec<String>,
    /// The answers that bugs give.
    pub wrong: Vec<BugAnswer>,
}

impl Case {
    /// The line of the request, with its end: no spaces, and the keys in alphabetical order.
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

/// The cases of one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// The op that is asked; empty for whole lines that every program must refuse.
    pub op: String,
    /// The bugs that its cases can show, by their flags.
    pub flags: BTreeMap<String, Bug>,
    /// The cases.
    pub cases: Vec<Case>,
}
