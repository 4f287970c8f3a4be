//! Intervals for a proportion.

use super::{Refused, Whole};
use crate::stats::Bounds;
use crate::stats::binomial::{clopper_pearson, wilson};

/// Most trials: the exact interval takes about √trials steps for each of some 120 tails.
pub const MOST_TRIALS: i64 = 1_000_000_000;

/// The interval of Clopper and Pearson or of Wilson.
///
/// Implements: ORA-011.
pub fn interval(
    Whole(successes): Whole<0, MOST_TRIALS>,
    Whole(trials): Whole<1, MOST_TRIALS>,
    confidence: f64,
    method: &str,
) -> Result<Bounds, Refused> {
    let interval = match method {
        "clopper_pearson" => clopper_pearson,
        "wilson" => wilson,
        _ => {
            let wrong = format_args!("method is {method:?}; it must be clopper_pearson or wilson");
            return Err(Refused::range(wrong));
        }
    };
    let [successes, trials] = [successes, trials].map(i64::unsigned_abs);
    interval(successes, trials, confidence).map_err(Refused::range)
}
