//! Why a numerical question is refused.

use core::fmt;

/// Why a numerical question is refused. A refusal is never an answer: no error of the detector means "no inclusion".
///
/// Implements: DET-005.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NumericError {
    /// There is no sample at all.
    Empty {
        /// The name of the argument.
        what: &'static str,
    },
    /// Two arguments that belong together differ in length.
    LengthMismatch {
        /// The name of the argument.
        what: &'static str,
        /// The length it should have.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A sample is NaN or infinite.
    NotFinite {
        /// The name of the argument.
        what: &'static str,
        /// The first such sample.
        index: usize,
    },
    /// A number is outside the range in which the question has a finite answer, or is NaN.
    OutOfRange {
        /// The name of the argument.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The values that would be right.
        range: &'static str,
    },
    /// There are more successes than trials.
    Successes {
        /// The number of successes.
        successes: u64,
        /// The number of trials.
        trials: u64,
    },
    /// γ = 0: the hypotheses predict the same force, so no threshold keeps this promise.
    NoSignal,
    /// The covariance is not symmetric.
    NotSymmetric {
        /// Row of the first entry that differs from its mirror image.
        row: usize,
        /// Column of that entry.
        column: usize,
    },
    /// The covariance is not positive definite, or singular to working precision.
    NotPositiveDefinite {
        /// The order of the first leading block that fails, less one.
        pivot: usize,
    },
    /// The result exceeds the range of the numbers.
    Overflow {
        /// The name of the result.
        what: &'static str,
    },
}

impl fmt::Display for NumericError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty { what } => write!(f, "{what} has no samples; at least one is needed"),
            Self::LengthMismatch {
                what,
                expected,
                found,
            } => write!(
                f,
                "{what} has length {found}, but must have length {expected}"
            ),
            Self::NotFinite { what, index } => write!(
                f,
                "{what}[{index}] is NaN or infinite; every sample must be finite"
            ),
            Self::OutOfRange { what, value, range } => {
                write!(f, "{what} is {value}, but must be {range}")
            }
            Self::Successes { successes, trials } => {
                write!(f, "{successes} successes are more than the {trials} trials")
            }
            Self::NoSignal => {
                f.write_str("gamma is 0: without a signal no threshold bounds the false alarms")
            }
            Self::NotSymmetric { row, column } => write!(
                f,
                "the covariance is not symmetric: entries ({row}, {column}) and ({column}, {row}) differ"
            ),
            Self::NotPositiveDefinite { pivot } => {
                write!(f, "the covariance is not positive definite (pivot {pivot})")
            }
            Self::Overflow { what } => write!(f, "{what} is too large to represent"),
        }
    }
}

impl core::error::Error for NumericError {}

/// Checks that every sample is finite and that there are `length` of them.
pub fn check_samples(
    what: &'static str,
    samples: &[f64],
    length: usize,
) -> Result<(), NumericError> {
    if samples.is_empty() {
        return Err(NumericError::Empty { what });
    }
    check_length(what, length, samples.len())?;
    match samples.iter().position(|sample| !sample.is_finite()) {
        Some(index) => Err(NumericError::NotFinite { what, index }),
        None => Ok(()),
    }
}

/// Checks a length.
pub fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), NumericError> {
    let mismatch = NumericError::LengthMismatch {
        what,
        expected,
        found,
    };
    (expected == found).then_some(()).ok_or(mismatch)
}

/// Passes a finite number > 0.
pub fn check_positive(what: &'static str, value: f64) -> Result<f64, NumericError> {
    let is_right = value > 0.0 && value < f64::INFINITY;
    in_range(is_right, what, value, "finite and greater than 0")
}

/// Passes a finite number ≥ 0.
pub fn check_not_negative(what: &'static str, value: f64) -> Result<f64, NumericError> {
    let is_right = (0.0..f64::INFINITY).contains(&value);
    in_range(is_right, what, value, "finite and at least 0")
}

/// Passes a finite number.
pub fn check_finite(what: &'static str, value: f64) -> Result<f64, NumericError> {
    in_range(value.is_finite(), what, value, "finite")
}

/// Passes a probability strictly between 0 and 1.
pub fn check_probability(what: &'static str, value: f64) -> Result<f64, NumericError> {
    let is_right = value > 0.0 && value < 1.0;
    in_range(is_right, what, value, "strictly between 0 and 1")
}

/// Passes `value` if `is_right`, a condition that must be false for NaN.
pub fn in_range(
    is_right: bool,
    what: &'static str,
    value: f64,
    range: &'static str,
) -> Result<f64, NumericError> {
    let error = NumericError::OutOfRange { what, value, range };
    is_right.then_some(value).ok_or(error)
}

/// Passes a result that did not overflow.
///
/// Implements: DET-008.
pub fn representable(what: &'static str, value: f64) -> Result<f64, NumericError> {
    let error = NumericError::Overflow { what };
    value.is_finite().then_some(value).ok_or(error)
}
