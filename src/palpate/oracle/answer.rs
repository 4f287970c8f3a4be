//! What an op gives, or why it gives none.

use std::fmt::Display;

use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use crate::fem::FemError;
use crate::stats::NumericError;

/// What an op gives: values by name. A number that is not finite is a `null`.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer(Vec<(&'static str, Value)>);

impl Answer {
    /// Values by name.
    pub fn of<const N: usize>(values: [(&'static str, impl Into<Value>); N]) -> Answer {
        let values = values.into_iter();
        Answer(values.map(|(name, value)| (name, value.into())).collect())
    }

    /// This answer with one more value.
    pub fn with(mut self, name: &'static str, value: impl Into<Value>) -> Answer {
        self.0.push((name, value.into()));
        self
    }

    /// This answer, if all its numbers are finite.
    ///
    /// Implements: ORA-009, ORA-008.
    pub fn finite(self) -> Result<Answer, Refused> {
        fn is_finite(value: &Value) -> bool {
            match value {
                Value::Array(values) => values.iter().all(is_finite),
                value => !value.is_null(),
            }
        }
        match self.0.iter().find(|(_, value)| !is_finite(value)) {
            Some((name, _)) => Err(Refused::new(
                Code::Overflow,
                format_args!("{name} would be no finite number"),
            )),
            None => Ok(self),
        }
    }
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// The kind of a refusal.
///
/// Implements: ORA-008.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// The line is no JSON.
    BadJson,
    /// JSON, but no request.
    BadRequest,
    /// No such op.
    UnknownOp,
    /// An argument that is missing or is not what it must be.
    BadArgument,
    /// An argument outside the range of the op.
    OutOfRange,
    /// The answer is no finite number.
    Overflow,
    /// The solver found no answer.
    Failed,
}

/// Why a request got no answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// Its kind.
    pub code: Code,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Refused {
    /// A refusal of a kind. A message that quotes a whole line is cut.
    pub fn new(code: Code, message: impl Display) -> Refused {
        const MOST_CHARACTERS: usize = 1000;
        let mut message = message.to_string();
        if let Some((end, _)) = message.char_indices().nth(MOST_CHARACTERS) {
            message.truncate(end);
            message.push('…');
        }
        Refused { code, message }
    }

    /// An argument that is not what it must be.
    pub fn argument(message: impl Display) -> Refused {
        Refused::new(Code::BadArgument, message)
    }

    /// An argument outside the range of the op.
    pub fn range(message: impl Display) -> Refused {
        Refused::new(Code::OutOfRange, message)
    }
}

impl From<NumericError> for Refused {
    fn from(error: NumericError) -> Refused {
        let code = match error {
            NumericError::Empty { .. }
            | NumericError::LengthMismatch { .. }
            | NumericError::NotFinite { .. } => Code::BadArgument,
            NumericError::Overflow { .. } => Code::Overflow,
            _ => Code::OutOfRange,
        };
        Refused::new(code, error)
    }
}

impl From<FemError> for Refused {
    fn from(error: FemError) -> Refused {
        match error {
            FemError::Pose(_) => Refused::range(error),
            _ => Refused::new(Code::Failed, error),
        }
    }
}

/// Appends the line of answer to the request `id`, a JSON text or number.
pub fn write(id: &str, outcome: &Result<Answer, Refused>, out: &mut Vec<u8>) {
    let key = if outcome.is_ok() { "ok" } else { "error" };
    for part in ["{\"id\":", id, ",\"", key, "\":"] {
        out.extend_from_slice(part.as_bytes());
    }
    // Memory takes everything, and these types can all be written.
    let _ = match outcome {
        Ok(answer) => serde_json::to_writer(&mut *out, answer),
        Err(refused) => serde_json::to_writer(&mut *out, refused),
    };
    out.extend_from_slice(b"}\n");
}
