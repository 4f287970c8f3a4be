//! Why a request got no answer.

use std::fmt::Display;

use crate::fem::FemError;
use crate::psychophysics::PsychophysicsError;
use crate::stats::NumericError;

/// The kind of a refusal.
///
/// Implements: ORA-008.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

impl Code {
    /// As it stands in an answer.
    pub fn name(self) -> &'static str {
        match self {
            Code::BadJson => "bad_json",
            Code::BadRequest => "bad_request",
            Code::UnknownOp => "unknown_op",
            Code::BadArgument => "bad_argument",
            Code::OutOfRange => "out_of_range",
            Code::Overflow => "overflow",
            Code::Failed => "failed",
        }
    }
}

/// Why a request got no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Its kind.
    pub code: Code,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Refusal {
    /// A refusal of a kind. A message that quotes a whole line is cut.
    pub fn new(code: Code, message: impl Into<String>) -> Refusal {
        const MOST_CHARACTERS: usize = 1000;
        let mut message = message.into();
        if let Some((end, _)) = message.char_indices().nth(MOST_CHARACTERS) {
            message.truncate(end);
            message.push('…');
        }
        Refusal { code, message }
    }

    /// An argument that is not what it must be.
    pub fn argument(name: &str, wrong: impl Display) -> Refusal {
        Refusal::new(Code::BadArgument, format!("{name} {wrong}"))
    }

    /// An argument outside the range of the op.
    pub fn range(name: &str, wrong: impl Display) -> Refusal {
        Refusal::new(Code::OutOfRange, format!("{name} {wrong}"))
    }

    /// Appends the line of the answer for the request `id`, a JSON text or number.
    pub fn write(&self, id: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(b"{\"id\":");
        out.extend_from_slice(id.as_bytes());
        out.extend_from_slice(b",\"error\":{\"code\":\"");
        out.extend_from_slice(self.code.name().as_bytes());
        out.extend_from_slice(b"\",\"message\":");
        out.extend_from_slice(
            serde_json::Value::from(&self.message[..])
                .to_string()
                .as_bytes(),
        );
        out.extend_from_slice(b"}}\n");
    }
}

impl From<NumericError> for Refusal {
    fn from(error: NumericError) -> Refusal {
        let code = match error {
            NumericError::Empty { .. }
            | NumericError::LengthMismatch { .. }
            | NumericError::NotFinite { .. } => Code::BadArgument,
            NumericError::Overflow { .. } => Code::Overflow,
            _ => Code::OutOfRange,
        };
        Refusal::new(code, error.to_string())
    }
}

impl From<PsychophysicsError> for Refusal {
    fn from(error: PsychophysicsError) -> Refusal {
        Refusal::new(Code::OutOfRange, error.to_string())
    }
}

impl From<FemError> for Refusal {
    fn from(error: FemError) -> Refusal {
        let code = match error {
            FemError::Pose(_) => Code::OutOfRange,
            _ => Code::Failed,
        };
        Refusal::new(code, error.to_string())
    }
}
