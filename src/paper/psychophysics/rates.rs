//! Shares of right answers, with intervals, and the γ that they stand for.

use serde::Serialize;

use super::{Condition, Result};
use palpate::detect::gamma_from_two_afc;
pub use palpate::stats::Bounds;
use palpate::stats::binomial::{clopper_pearson, wilson};
use palpate::stats::noncentral::student_point;

/// The confidence of every interval in an analysis.
///
/// Implements: PSY-023.
pub const CONFIDENCE: f64 = 0.95;

/// Two ends of an interval, either of which may be missing: the data set no bound there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OpenBounds {
    /// Lower end.
    pub lower: Option<f64>,
    /// Upper end.
    pub upper: Option<f64>,
}

impl OpenBounds {
    /// The same with an increasing function applied to the ends.
    pub(super) fn map(self, function: impl Fn(f64) -> f64) -> OpenBounds {
        OpenBounds {
            lower: self.lower.map(&function),
            upper: self.upper.map(&function),
        }
    }
}

/// A share of right answers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// Right answers.
    pub correct: u64,
    /// Pairs judged.
    pub trials: u64,
    /// Their quotient.
    pub rate: f64,
    /// The exact interval, if every answer is independent with one probability.
    pub clopper_pearson: Bounds,
    /// The score interval under the same assumption.
    pub wilson: Bounds,
    /// γ with the image of the exact interval.
    pub gamma: GammaEstimate,
}

/// γ of a share of right answers, √2 Φ⁻¹(share), and of the ends of an interval for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaEstimate {
    /// 0 for half of the answers or fewer; `None` if all are right: no γ is large enough.
    pub gamma: Option<f64>,
    /// The interval: no lower bound above a share whose lower end is 1.
    #[serde(flatten)]
    pub bounds: OpenBounds,
}

impl GammaEstimate {
    /// The image of a share and of an interval for it: 0 below one half, `None` for 1.
    ///
    /// Implements: PSY-023.
    pub fn of(share: f64, bounds: Bounds) -> Result<GammaEstimate> {
        let gamma = |share: f64| match share {
            ..=0.5 => Ok(Some(0.0)),
            1.0.. => Ok(None),
            _ => gamma_from_two_afc(share).map(Some),
        };
        Ok(GammaEstimate {
            gamma: gamma(share)?,
            bounds: OpenBounds {
                lower: gamma(bounds.lower)?,
                upper: gamma(bounds.upper)?,
            },
        })
    }
}

impl Rate {
    /// The share of `correct` in `trials`.
    ///
    /// # Errors
    /// No trials, or more right answers than trials.
    ///
    /// Implements: PSY-023.
    pub fn new(correct: u64, trials: u64) -> Result<Rate> {
        let exact = clopper_pearson(correct, trials, CONFIDENCE)?;
        let rate = correct as f64 / trials as f64;
        Ok(Rate {
            correct,
            trials,
            rate,
            clopper_pearson: exact,
            wilson: wilson(correct, trials, CONFIDENCE)?,
            gamma: GammaEstimate::of(rate, exact)?,
        })
    }
}

/// The share of all subjects at the inclusion in `column`, and the same with the subjects as the sample.
///
/// # Errors
/// Never for counts that fit their trials.
pub fn pooled(condition: &Condition, column: usize) -> Result<(Rate, Option<Clustered>)> {
    let (correct, trials) = condition.pooled(column);
    let rate = Rate::new(correct, trials)?;
    let clustered = clustered(&condition.counts(column), &rate)?;
    Ok((rate, clustered))
}

/// An interval that lets subjects differ: their shares are the sample, not their answers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Clustered {
    /// The standard error of the pooled share.
    pub standard_error: f64,
    /// Student's interval, cut off at 0 and 1.
    pub bounds: Bounds,
    /// Its width over that of Clopper and Pearson's interval.
    pub width_ratio: f64,
    /// γ with the image of this interval.
    pub gamma: GammaEstimate,
}

/// The interval of the pooled share with the subjects as the sample: p̂ ± t(m−1) s with
/// s² = m/(m−1) Σ (kᵢ − p̂ nᵢ)²/(Σ nᵢ)². `None` for one subject, and where none differs from the
/// others, which says nothing of a next one.
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-023.
pub fn clustered(counts: &[(u32, u32)], pooled: &Rate) -> Result<Option<Clustered>> {
    let (correct, trials) = (u128::from(pooled.correct), u128::from(pooled.trials));
    let is_pooled = |&(k, n): &(u32, u32)| u128::from(k) * trials == correct * u128::from(n);
    // In whole numbers: a quotient is rounded, and what is left of it looks like a difference.
    if counts.len() < 2 || counts.iter().all(is_pooled) {
        return Ok(None);
    }
    let subjects = counts.len() as f64;
    let squares = counts.iter().map(|&(k, n)| {
        let excess = f64::from(k) - pooled.rate * f64::from(n);
        excess * excess
    });
    let spread = squares.sum::<f64>();
    let standard_error = libm::sqrt(subjects / (subjects - 1.0) * spread) / pooled.trials as f64;
    let reach = student_point(0.5 * (1.0 - CONFIDENCE), subjects - 1.0)? * standard_error;
    let bounds = Bounds {
        lower: (pooled.rate - reach).max(0.0),
        upper: (pooled.rate + reach).min(1.0),
    };
    let Bounds { lower, upper } = pooled.clopper_pearson;
    Ok(Some(Clustered {
        standard_error,
        bounds,
        width_ratio: (bounds.upper - bounds.lower) / (upper - lower),
        gamma: GammaEstimate::of(pooled.rate, bounds)?,
    }))
}

#[cfg(test)]
mod tests;
