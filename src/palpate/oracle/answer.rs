//! What an op gives, or why it gives none.

use crate::refusal::one_line;
use std::fmt::Display;
use std::io;

use serde::{Deserialize, Serialize};
use serde_json::Serializer;
use serde_json::ser::Formatter;

use crate::fem::FemError;
use crate::stats::NumericError;

/// An answer: values by name.
macro_rules! answer {
    ($($name:ident $(: $value:expr)?),* $(,)?) => {{
        #[derive(serde::Serialize)]
        struct Answer<$($name),*> { $($name: $name),* }
        Answer { $($name $(: $value)?),* }
    }};
}
pub(super) use answer;

/// The JSON text of an answer.
///
/// # Errors
/// [`Code::Overflow`] if a number is not finite.
///
/// Implements: ORA-009, ORA-008.
pub fn json(answer: impl Serialize) -> Result<Vec<u8>, Refused> {
    /// Refuses `null`, as which a number that is not finite would be written.
    struct Finite;
    impl Formatter for Finite {
        fn write_null<W: ?Sized + io::Write>(&mut self, _: &mut W) -> io::Result<()> {
            Err(io::ErrorKind::InvalidData.into())
        }
    }
    let mut text = Vec::new();
    match answer.serialize(&mut Serializer::with_formatter(&mut text, Finite)) {
        Ok(()) => Ok(text),
        Err(_) => {
            // The text ends before the number, so its last key is the number's.
            let text = String::from_utf8_lossy(&text);
            let name = text.rsplit('"').nth(1).unwrap_or_default();
            let wrong = format_args!("{name} would not be a finite number");
            Err(Refused::new(Code::Overflow, wrong))
        }
    }
}

/// The kind of a refusal.
///
/// Implements: ORA-008.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// The line is not JSON.
    BadJson,
    /// JSON, but not a request.
    BadRequest,
    /// No such op.
    UnknownOp,
    /// An argument that is missing or of the wrong kind.
    BadArgument,
    /// An argument outside the range of the op.
    OutOfRange,
    /// The answer is not a finite number.
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
        let mut message = one_line(&message.to_string());
        if let Some((end, _)) = message.char_indices().nth(MOST_CHARACTERS) {
            message.truncate(end);
            message.push('…');
        }
        Refused { code, message }
    }

    /// An argument that is missing or of the wrong kind.
    pub fn argument(message: impl Display) -> Refused {
        Refused::new(Code::BadArgument, message)
    }

    /// An argument outside the range of the op.
    pub fn range(message: impl Display) -> Refused {
        Refused::new(Code::OutOfRange, message)
    }

    /// A `word` as the argument `name` that is none of the `right` ones.
    pub fn word(name: &str, word: &str, right: &str) -> Refused {
        Refused::range(format_args!("{name} is {word:?}; it must be {right}"))
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

/// Appends the line that answers the request `id`, a JSON text or number: the JSON text of the answer, or the refusal.
pub fn write(id: &str, outcome: Result<Vec<u8>, Refused>, out: &mut Vec<u8>) {
    let (key, value) = match outcome {
        Ok(answer) => ("ok", answer),
        // Two texts can always be written.
        Err(refused) => ("error", serde_json::to_vec(&refused).unwrap_or_default()),
    };
    for part in ["{\"id\":", id, ",\"", key, "\":"] {
        out.extend_from_slice(part.as_bytes());
    }
    out.extend_from_slice(&value);
    out.extend_from_slice(b"}\n");
}
