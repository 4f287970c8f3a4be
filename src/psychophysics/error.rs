//! Why an analysis was refused.

use crate::detect::DetectError;
use crate::refusal::Refusal;
use crate::stats::binomial::ProportionError;
use crate::stats::normal::NormalError;
use crate::stats::tails::TailError;

/// Why an analysis was refused.
///
/// ```
/// use palpate::psychophysics::{PsychophysicsError, Rate};
///
/// assert!(matches!(Rate::new(31, 30), Err(PsychophysicsError::Proportion(_))));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(transparent)]
pub enum PsychophysicsError {
    /// Counts that fit no trials.
    Proportion(#[from] ProportionError),
    /// A probability outside (0, 1).
    Normal(#[from] NormalError),
    /// A number outside the range of a law.
    Tail(#[from] TailError),
    /// A γ or a share that the detector refuses.
    Detect(#[from] DetectError),
    /// A table that cannot be read, or maps that do not fit it.
    Refused(#[from] Refusal),
}

/// What an analysis found, or why it was refused.
pub type Result<T, E = PsychophysicsError> = core::result::Result<T, E>;
