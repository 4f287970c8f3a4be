//! Intervals for a proportion.

use super::{Refused, Whole, arguments};
use crate::stats::Bounds;
use crate::stats::binomial::{clopper_pearson, wilson};

/// Most trials: the exact interval takes about √trials steps for each of some 120 tails.
pub const MOST_TRIALS: i64 = 1_000_000_000;

arguments! {
    Proportion {
        successes: Whole<0, MOST_TRIALS>,
        trials: Whole<1, MOST_TRIALS>,
        confidence: f64,
        method: String,
    }
}

/// The interval of Clopper and Pearson or of Wilson.
///
/// Implements: ORA-011.
pub fn interval(arguments: Proportion) -> Result<Bounds, Refused> {
    let method = match &arguments.method[..] {
        "clopper_pearson" => clopper_pearson,
        "wilson" => wilson,
        other => {
            let wrong = format_args!("method is {other:?}; it must be clopper_pearson or wilson");
            return Err(Refused::range(wrong));
        }
    };
    let [successes, trials] = [arguments.successes.0, arguments.trials.0].map(i64::unsigned_abs);
    method(successes, trials, arguments.confidence).map_err(Refused::range)
}
