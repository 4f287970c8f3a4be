//! Counts of right answers: an interval for their rate, and those of several subjects under several conditions, as in Table 1.

use serde::Serialize;

use super::{List, Refused, Rows, Whole, answer};
use crate::detect::gamma_from_two_afc;
use crate::stats::Bounds;
use crate::stats::binomial::{clopper_pearson, wilson};
use crate::stats::dispersion::dispersion;

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
        _ => return Err(Refused::word("method", method, "clopper_pearson or wilson")),
    };
    let [successes, trials] = [successes, trials].map(i64::unsigned_abs);
    interval(successes, trials, confidence).map_err(Refused::range)
}

/// The pooled right answers of each condition, their rate, γ from it, and how far the subjects differ from one binomial.
///
/// Implements: ORA-020.
pub fn analysis(
    counts: &Rows,
    Whole(trials): Whole<1, MOST_TRIALS>,
) -> Result<impl Serialize, Refused> {
    let subjects = counts.0.len();
    let conditions = counts.0.first().map_or(0, |List(row)| row.len());
    if conditions == 0 {
        let wrong = "correct is empty, but must have a row for each subject";
        return Err(Refused::argument(wrong));
    }
    let correct = counts.concat("correct", subjects, conditions)?;
    if let Some(wrong) = correct.iter().position(|&count| !is_count(count, trials)) {
        return Err(Refused::range(format_args!(
            "correct[{}][{}] is {}, but must be a whole number from 0 to {trials}",
            wrong / conditions,
            wrong % conditions,
            correct[wrong]
        )));
    }
    let (mut pooled, mut rates) = (Vec::new(), Vec::new());
    let (mut gamma, mut chi2) = (Vec::new(), Vec::new());
    for condition in 0..conditions {
        let column = correct.iter().skip(condition).step_by(conditions);
        // Whole numbers, at most 10⁹ each: exact in either type.
        let column: Vec<_> = column.map(|&count| (count as u32, trials as u32)).collect();
        let right: u64 = column.iter().map(|&(right, _)| u64::from(right)).sum();
        let rate = right as f64 / (subjects as f64 * trials as f64);
        pooled.push(right);
        rates.push(rate);
        gamma.push(gamma_from_two_afc(rate).map_err(|_| {
            let found = format_args!(
                "correct: the answers of condition {condition} are all right or all wrong; γ is not finite"
            );
            Refused::range(found)
        })?);
        // A single subject has the pooled rate.
        let dispersion = dispersion(&column)?;
        chi2.push(dispersion.map_or(0.0, |found| found.chi_square));
    }
    Ok(answer! { pooled, rate: rates, gamma, chi2, df: subjects - 1 })
}

fn is_count(count: f64, trials: i64) -> bool {
    count.trunc() == count && (0.0..=trials as f64).contains(&count)
}
