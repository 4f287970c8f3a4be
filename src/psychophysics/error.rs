//! Why an analysis was refused.

use crate::force_map::InvalidForceMap;
use crate::psychophysics::TableError;
use crate::stats::NumericError;

/// Why an analysis was refused.
///
/// ```
/// use palpate::psychophysics::{PsychophysicsError, Rate};
///
/// assert!(matches!(Rate::new(31, 30), Err(PsychophysicsError::Numeric(_))));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PsychophysicsError {
    /// A number outside the range of a law, or counts that fit no trials.
    #[error("{0}")]
    Numeric(#[from] NumericError),
    /// Table 1 itself.
    #[error("{0}")]
    Table(#[from] TableError),
    /// Maps that cannot be compared.
    #[error("{name}: {source}")]
    Map {
        /// The inclusion.
        name: String,
        /// What is wrong with its map.
        source: InvalidForceMap,
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
