//! Why an analysis was refused.

use crate::refusal::Refusal;
use crate::stats::NumericError;

/// Why an analysis was refused.
///
/// ```
/// use palpate::psychophysics::{PsychophysicsError, Rate};
///
/// assert!(matches!(Rate::new(31, 30), Err(PsychophysicsError::Numeric(_))));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(transparent)]
pub enum PsychophysicsError {
    /// A number outside the range of a law, or counts that fit no trials.
    Numeric(#[from] NumericError),
    /// A table that cannot be read, or maps that do not fit it.
    Refused(#[from] Refusal),
}

/// What an analysis found, or why it was refused.
pub type Result<T, E = PsychophysicsError> = core::result::Result<T, E>;
