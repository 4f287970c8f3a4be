//! Inclusions that may lie at several depths: one template a depth, each with its θ_m against "no
//! inclusion" (paper §5).

use super::DetectError;
use super::decision::error_rates;
use super::error::{check_finite, check_not_negative, check_samples, representable};
use crate::stats::compensated::{self, DoubleDouble};

/// The likelihood ratio of "an inclusion at some depth", ln Σ π_m exp(θ_m), for a prior π_m over
/// the depths given an inclusion.
///
/// ```
/// use palpate::detect::mixture::mixture_theta;
///
/// // ln(½ e^0 + ½ e^ln 3) = ln 2.
/// let theta = mixture_theta(&[0.0, 3.0_f64.ln()], &[0.5, 0.5])?;
/// assert!((theta - 2.0_f64.ln()).abs() < 1e-15);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// Empty or unequal lengths; θ not finite; priors that are negative or do not add up to 1 within
/// 10⁻⁹.
///
/// Implements: DET-070.
pub fn mixture_theta(theta: &[f64], prior: &[f64]) -> Result<f64, DetectError> {
    check_bank(theta, prior)?;
    let largest = largest_likely(theta, prior);
    // Every exponent is at most 0, and one of them is 0: no overflow, and no logarithm of 0.
    let sum = compensated::sum(theta.len(), |m| {
        // A depth that cannot be may have any θ, and exp of that may overflow.
        let term = if prior[m] == 0.0 {
            0.0
        } else {
            prior[m] * libm::exp(theta[m] - largest)
        };
        DoubleDouble::new(term, 0.0)
    });
    representable("theta", largest + libm::log(sum.value()))
}

/// The posterior of every depth given an inclusion, π_m exp(θ_m)/Σ, into `posterior`.
///
/// # Errors
/// As [`mixture_theta`]; `posterior` of another length.
///
/// Implements: DET-071.
pub fn depth_posterior(
    theta: &[f64],
    prior: &[f64],
    posterior: &mut [f64],
) -> Result<(), DetectError> {
    let total = mixture_theta(theta, prior)?;
    if posterior.len() != theta.len() {
        let (expected, found) = (theta.len(), posterior.len());
        return Err(DetectError::LengthMismatch {
            what: "posterior",
            expected,
            found,
        });
    }
    for ((posterior, theta), prior) in posterior.iter_mut().zip(theta).zip(prior) {
        *posterior = if *prior == 0.0 {
            0.0
        } else {
            (prior * libm::exp(theta - total)).min(1.0)
        };
    }
    Ok(())
}

/// The generalised likelihood ratio: the first depth whose θ_m is largest, and that θ_m.
///
/// # Errors
/// No depths; θ not finite.
///
/// Implements: DET-072.
pub fn generalised_theta(theta: &[f64]) -> Result<(usize, f64), DetectError> {
    check_samples("theta", theta, theta.len())?;
    let first = (0, theta[0]);
    Ok(theta.iter().copied().enumerate().fold(
        first,
        |best, next| {
            if next.1 > best.1 { next } else { best }
        },
    ))
}

/// An upper bound on the false alarms of the mixture at threshold η: min(1, e^−η), because the mean
/// of a likelihood ratio is 1 under H = 0 (Markov).
///
/// # Errors
/// η not finite.
///
/// Implements: DET-073.
pub fn mixture_false_alarm_bound(eta: f64) -> Result<f64, DetectError> {
    check_finite("eta", eta)?;
    Ok(if eta > 0.0 { libm::exp(-eta) } else { 1.0 })
}

/// An upper bound on the false alarms of the generalised likelihood ratio at η, min(1, Σ Φ(−(η +
/// γ_m²/2)/γ_m)).
///
/// # Errors
/// No depths; γ_m negative or not finite; η not finite.
///
/// Implements: DET-074.
pub fn generalised_false_alarm_bound(gamma: &[f64], eta: f64) -> Result<f64, DetectError> {
    check_samples("gamma", gamma, gamma.len())?;
    check_finite("eta", eta)?;
    let mut sum = 0.0;
    for &gamma in gamma {
        check_not_negative("gamma", gamma)?;
        sum += error_rates(gamma, eta)?.false_alarm;
    }
    Ok((sum * (1.0 + 1e-9)).min(1.0))
}

fn check_bank(theta: &[f64], prior: &[f64]) -> Result<(), DetectError> {
    check_samples("theta", theta, theta.len())?;
    check_samples("prior", prior, theta.len())?;
    for &prior in prior {
        check_not_negative("prior", prior)?;
    }
    let value = compensated::sum(prior.len(), |m| DoubleDouble::new(prior[m], 0.0)).value();
    if (value - 1.0).abs() > 1e-9 {
        return Err(DetectError::OutOfRange {
            what: "sum of prior",
            value,
            range: "1",
        });
    }
    Ok(())
}

/// The largest θ_m of those with a prior above 0.
fn largest_likely(theta: &[f64], prior: &[f64]) -> f64 {
    theta
        .iter()
        .zip(prior)
        .filter(|(_, prior)| **prior > 0.0)
        .fold(f64::NEG_INFINITY, |largest, (&theta, _)| largest.max(theta))
}

#[cfg(test)]
mod tests;
