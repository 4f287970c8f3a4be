//! How much noise a display may add: the paper's example after figure 4, and Table 2.

use super::DetectError;
use super::decision::required_gamma;
use crate::stats::error::{check_not_negative, check_positive, check_samples, representable};

/// A noise budget. All standard deviations in N.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NoiseBudget {
    /// The signal-to-noise ratio that the error rates need.
    pub gamma: f64,
    /// What all the noise together may be, signal/γ.
    pub total_allowed_n: f64,
    /// What further sources may add, 0 if the given ones exhaust the budget.
    pub remaining_n: f64,
}

/// The budget for a signal of `signal` N at given error rates, when the independent `sources`
/// (standard deviations, N) are there already.
///
/// # Errors
/// Rates not strictly between 0 and 1, or that add up to 1 or more, where any noise will do; a
/// signal not positive and finite; a source negative or not finite; overflow.
///
/// Implements: DET-100, ERR-005.
pub fn noise_budget(
    signal: f64,
    max_false_alarm: f64,
    max_miss: f64,
    sources: &[f64],
) -> Result<NoiseBudget, DetectError> {
    check_positive("signal", signal)?;
    let gamma = required_gamma(max_false_alarm, max_miss)?;
    // γ = 0 would allow any noise: infinity, which is refused.
    let total_allowed = representable("total_allowed", signal / gamma)?;
    let used = root_sum_square(sources)?;
    let remaining = if used < total_allowed {
        // (T − u)(T + u) instead of T² − u²: no cancellation beyond that of T − u, and no overflow
        // of squares.
        let sum = representable("total_allowed", total_allowed + used)?;
        libm::sqrt(total_allowed - used) * libm::sqrt(sum)
    } else {
        0.0
    };
    Ok(NoiseBudget {
        gamma,
        total_allowed_n: total_allowed,
        remaining_n: remaining,
    })
}

/// (Σ s²)^½ of independent sources (standard deviations, N).
///
/// # Errors
/// No source; a source negative or not finite; all of them 0; overflow.
///
/// Implements: DET-100.
pub fn noise_total(sources: &[f64]) -> Result<f64, DetectError> {
    check_samples("sources", sources, sources.len())?;
    check_positive("total", root_sum_square(sources)?)
}

/// (Σ s²)^½ without overflow or underflow of squares.
fn root_sum_square(sources: &[f64]) -> Result<f64, DetectError> {
    let mut total = 0.0;
    for &source in sources {
        total = libm::hypot(total, check_not_negative("source", source)?);
    }
    representable("total", total)
}

#[cfg(test)]
mod tests;
