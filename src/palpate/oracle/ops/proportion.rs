//! Intervals for a proportion.

use super::{Answer, Arguments, Refused};
use crate::stats::binomial::{clopper_pearson, wilson};

/// Most trials: the exact interval takes about √trials steps for each of some 120 tails.
pub const MOST_TRIALS: i64 = 1_000_000_000;

/// The interval of Clopper and Pearson or of Wilson.
///
/// Implements: ORA-011.
pub fn interval(arguments: &mut Arguments) -> Result<Answer, Refused> {
    let successes = arguments.whole("successes", 0, MOST_TRIALS)?.unsigned_abs();
    let trials = arguments.whole("trials", 1, MOST_TRIALS)?.unsigned_abs();
    let confidence = arguments.number("confidence")?;
    let method = arguments.text("method")?;
    let interval = match &method[..] {
        "clopper_pearson" => clopper_pearson(successes, trials, confidence),
        "wilson" => wilson(successes, trials, confidence),
        _ => {
            let wrong = format_args!("method is {method:?}, expected clopper_pearson or wilson");
            return Err(Refused::range(wrong));
        }
    };
    let interval = interval.map_err(Refused::range)?;
    Ok(Answer::of([
        ("lower", interval.lower),
        ("upper", interval.upper),
    ]))
}
