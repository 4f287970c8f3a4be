//! Quantiles of a sample, each with an interval that needs no distribution.

use serde::{Deserialize, Serialize};

use super::indices::Estimate;
use palpate::stats::{NumericError, binomial};

/// The probabilities of a band's quantiles.
///
/// Implements: STU-043.
const PROBABILITIES: [f64; 3] = [0.025, 0.5, 0.975];
/// What each end of an interval of 95 % leaves out.
const LEFT_OUT: f64 = 0.025;

/// Where 95 % of the values lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// The quantile of 2.5 %.
    pub lower: Estimate,
    /// The median.
    pub median: Estimate,
    /// The quantile of 97.5 %.
    pub upper: Estimate,
}

/// The band of the values of a sample. The interval of a quantile lies between two of the values, chosen by the binomial distribution of
/// the number below it; the ends of the sample stand for an end that is beyond them.
///
/// ```
/// let band = palpate_paper::study::band((1..=1000).map(f64::from).collect())?.ok_or("values")?;
/// assert_eq!([band.lower, band.median, band.upper].map(|of| of.value), [25.5, 500.5, 975.5]);
/// assert!(band.median.lower < 475.0 && band.median.upper > 526.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NumericError`] for more values than a binomial distribution is computed for.
///
/// Implements: STU-043.
pub fn band(mut values: Vec<f64>) -> Result<Option<Band>, NumericError> {
    if values.is_empty() {
        return Ok(None);
    }
    values.sort_by(f64::total_cmp);
    let [lower, median, upper] = PROBABILITIES.map(|p| quantile(&values, p));
    Ok(Some(Band {
        lower: lower?,
        median: median?,
        upper: upper?,
    }))
}

/// A quantile of increasing values: linear between the values at (k − ½)/n.
fn quantile(values: &[f64], p: f64) -> Result<Estimate, NumericError> {
    let count = values.len();
    let last = count - 1;
    let place = (p * count as f64 - 0.5).clamp(0.0, last as f64);
    let below = place as usize;
    let share = place - below as f64;
    let next = values[(below + 1).min(last)];
    let trials = count as u64;
    // Of the order statistics x_(k), k from 1: x_(k) lies above the quantile with Pr(at most k − 1 below it).
    let mut lower = below;
    while lower > 0 && binomial::at_most(lower as u64, trials, p)? > LEFT_OUT {
        lower -= 1;
    }
    let mut upper = below;
    while upper < last && binomial::at_least(1 + upper as u64, trials, p)? > LEFT_OUT {
        upper += 1;
    }
    Ok(Estimate {
        value: values[below] + share * (next - values[below]),
        lower: values[lower],
        upper: values[upper],
    })
}
