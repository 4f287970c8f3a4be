//! Subjects whose probabilities of a right answer are themselves random: the beta-binomial law.
//!
//! Subject i is right with probability πᵢ, drawn from a beta law with mean p and correlation
//! ρ = 1/(α + β + 1). With θ = ρ/(1 − ρ) the log-likelihood of k right answers in n is, but for a constant,
//!
//! Σ_{r<k} ln(p + rθ) + Σ_{r<n−k} ln(1 − p + rθ) − Σ_{r<n} ln(1 + rθ),
//!
//! which is the binomial one at θ = 0: no gamma functions that cancel there. In p it is concave.

use serde::Serialize;

use super::Result;
use super::rates::{Bounds, CONFIDENCE, OpenBounds};
use super::search::{change, crossing, interval, maximum};
use palpate::stats::normal;
use palpate::stats::tails::chi_square_tail;

/// The largest ρ that is searched.
const LARGEST_CORRELATION: f64 = 0.9999;
/// Cells of the search for ρ, equal in √ρ.
const CELLS: u32 = 12;

/// The beta-binomial law that fits the subjects best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BetaBinomial {
    /// The mean probability of a right answer.
    pub rate: f64,
    /// Where the profile likelihood of the mean is within half a χ²₁ quantile of its top.
    pub rate_bounds: Bounds,
    /// ρ, the correlation of two answers of one subject: 0 if all subjects are alike, 1 if each is
    /// always right or always wrong.
    pub correlation: f64,
    /// The same for ρ, where 0 is an end of the range; an upper end that is missing is not below 1.
    pub correlation_bounds: OpenBounds,
    /// Whether ρ = 0 fits best: the counts vary no more than a binomial.
    pub is_binomial: bool,
    /// Twice the gain of log-likelihood over ρ = 0.
    pub deviance_gain: f64,
    /// Its p-value: half of the χ²₁ tail, since ρ = 0 is the end of the range.
    pub p_value: f64,
}

/// The law that fits the counts (right answers, pairs) best; `None` for one subject, or if all answers are
/// right or all wrong.
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-032.
pub fn beta_binomial(counts: &[(u32, u32)]) -> Result<Option<BetaBinomial>> {
    let likelihood = Likelihood::new(counts);
    if counts.len() < 2 || likelihood.right.is_empty() || likelihood.wrong.is_empty() {
        return Ok(None);
    }
    let of_correlation = |rho| likelihood.value(likelihood.best_rate(rho), rho);
    let binomial = of_correlation(0.0);
    let (correlation, top) = best_correlation(of_correlation);
    let rate = likelihood.best_rate(correlation);
    let deviance_gain = 2.0 * (top - binomial).max(0.0);
    let z = normal::quantile(0.5 + 0.5 * CONFIDENCE)?;
    let floor = top - 0.5 * z * z;
    let at_rate = |p| best_correlation(|rho| likelihood.value(p, rho)).1 - floor;
    let range = [0.0, LARGEST_CORRELATION];
    let mut correlation_bounds = interval(of_correlation, floor, correlation, range);
    // No correlation is the end of the range, not a bound that is missing.
    correlation_bounds.lower = correlation_bounds.lower.or(Some(0.0));
    Ok(Some(BetaBinomial {
        rate,
        rate_bounds: Bounds {
            lower: crossing(at_rate, rate, 0.0),
            upper: crossing(at_rate, rate, 1.0),
        },
        correlation,
        correlation_bounds,
        is_binomial: correlation == 0.0,
        deviance_gain,
        p_value: if deviance_gain > 0.0 {
            0.5 * chi_square_tail(deviance_gain, 1.0)?
        } else {
            1.0
        },
    }))
}

/// The ρ with the largest log-likelihood, and that.
fn best_correlation(log_likelihood: impl Fn(f64) -> f64) -> (f64, f64) {
    let of_root = |root: f64| log_likelihood(root * root);
    let (root, value) = maximum(of_root, 0.0, libm::sqrt(LARGEST_CORRELATION), CELLS);
    (root * root, value)
}

/// How many subjects have more than r right answers, wrong answers and pairs, for r = 0, 1, …
struct Likelihood {
    right: Vec<f64>,
    wrong: Vec<f64>,
    trials: Vec<f64>,
}

impl Likelihood {
    fn new(counts: &[(u32, u32)]) -> Likelihood {
        let more_than = |part: fn(&(u32, u32)) -> u32| {
            let largest = counts.iter().map(part).max().unwrap_or(0);
            let above = |r| counts.iter().filter(|count| part(count) > r).count() as f64;
            (0..largest).map(above).collect()
        };
        Likelihood {
            right: more_than(|&(k, _)| k),
            wrong: more_than(|&(k, n)| n - k),
            trials: more_than(|&(_, n)| n),
        }
    }

    /// The log-likelihood but for a constant.
    fn value(&self, rate: f64, correlation: f64) -> f64 {
        let sum = |weights, first| sum(weights, first, correlation, |w, p| w * libm::log(p));
        sum(&self.right, rate) + sum(&self.wrong, 1.0 - rate) - sum(&self.trials, 1.0)
    }

    /// The mean with the largest likelihood for a given ρ: the derivative falls from +∞ to −∞.
    fn best_rate(&self, correlation: f64) -> f64 {
        let slope = |weights, first| sum(weights, first, correlation, |w, p| w / p);
        let rises = |rate: f64| slope(&self.right, rate) > slope(&self.wrong, 1.0 - rate);
        change(rises, 0.0, 1.0)
    }
}

/// Σ term(weightᵣ, first + rθ).
fn sum(weights: &[f64], first: f64, correlation: f64, term: impl Fn(f64, f64) -> f64) -> f64 {
    let theta = correlation / (1.0 - correlation);
    let weights = weights.iter().enumerate();
    weights
        .map(|(r, &weight)| term(weight, first + r as f64 * theta))
        .sum()
}

#[cfg(test)]
mod tests;
