//! Inclusions that may lie at several depths: one template a depth, each with its θ_m against "no
//! inclusion" (paper §5).

use super::DetectError;
use crate::stats::compensated::{self, DoubleDouble};
use crate::stats::error::{check_not_negative, check_samples, in_range, representable};

/// The likelihood ratio of "an inclusion at some depth", ln Σ π_m exp(θ_m), for a prior π_m over
/// the depths given an inclusion.
///
/// # Errors
/// Empty or unequal lengths; θ not finite; priors that are negative or do not add up to 1 within
/// 10⁻⁹.
///
/// Implements: DET-070.
pub fn mixture_theta(theta: &[f64], prior: &[f64]) -> Result<f64, DetectError> {
    check_samples("theta", theta, theta.len())?;
    check_samples("prior", prior, theta.len())?;
    let sum_of = |term: &dyn Fn(usize) -> f64| {
        compensated::sum(theta.len(), |m| DoubleDouble::new(term(m), 0.0)).value()
    };
    for &prior in prior {
        check_not_negative("prior", prior)?;
    }
    let whole = sum_of(&|m| prior[m]);
    in_range((whole - 1.0).abs() <= 1e-9, "sum of prior", whole, "1")?;
    let likely = theta.iter().zip(prior).filter(|(_, prior)| **prior > 0.0);
    let largest = likely.fold(f64::NEG_INFINITY, |largest, (&theta, _)| largest.max(theta));
    // Every exponent is at most 0, and one of them is 0: no overflow, and no logarithm of 0. A depth that cannot be may have any
    // θ, and exp of that may overflow.
    let sum = sum_of(&|m| match prior[m] {
        0.0 => 0.0,
        prior => prior * libm::exp(theta[m] - largest),
    });
    representable("theta", largest + libm::log(sum))
}

#[cfg(test)]
mod tests;
