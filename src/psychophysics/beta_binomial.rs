//! Subjects whose probabilities of a right answer are themselves random: the beta-binomial law.

use serde::Serialize;

use super::rates::{Bounds, OpenBounds};

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
    /// The same for ρ; an upper end that is missing is not below 1.
    pub correlation_bounds: OpenBounds,
    /// Whether ρ = 0 fits best: the counts vary no more than a binomial.
    pub is_binomial: bool,
    /// Twice the gain of log-likelihood over ρ = 0.
    pub deviance_gain: f64,
    /// Its p-value: half of the χ²₁ tail, since ρ = 0 is the end of the range.
    pub p_value: f64,
}
