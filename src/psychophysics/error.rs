//! Why an analysis was refused.

use crate::detect::DetectError;
use crate::psychophysics::TableError;
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
pub enum PsychophysicsError {
    /// Counts that fit no trials.
    #[error("{0}")]
    Proportion(#[from] ProportionError),
    /// Table 1 itself.
    #[error("{0}")]
    Table(#[from] TableError),
    /// A probability outside (0, 1).
    #[error("{0}")]
    Normal(#[from] NormalError),
    /// A number outside the range of a law.
    #[error("{0}")]
    Tail(#[from] TailError),
    /// A γ or a share that the detector refuses.
    #[error("{0}")]
    Detect(#[from] DetectError),
    /// Maps that cannot be compared.
    #[error("{name}: {source}")]
    Map {
        /// The inclusion.
        name: String,
        /// What is wrong with its map.
        source: Box<Refusal>,
    },
    /// An inclusion that the table does not hold.
    #[error("inclusion {name:?} is no column of the table, expected one of {expected}")]
    NoSuchInclusion {
        /// The inclusion.
        name: String,
        /// The columns.
        expected: String,
    },
    /// A map for the same inclusion twice.
    #[error("inclusion {name:?} has two maps, expected one")]
    Repeated {
        /// The inclusion.
        name: String,
    },
    /// Too few maps to compare depths.
    #[error("{found} inclusions with a map, expected at least two")]
    TooFewMaps {
        /// How many there are.
        found: usize,
    },
}
