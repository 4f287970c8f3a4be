//! All that a record says, in one call: what `palpate detect` prints.

use super::decision::{Decision, ErrorRates, decide, error_rates, posterior};
use super::matched_filter::Statistic;
use super::position::MaximumLaw;
use super::scan::{Scan, ScanMaximum};
use super::{DetectError, Force};

/// A record judged at a known position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assessment {
    /// y(0), θ and γ.
    pub statistic: Statistic,
    /// Ĥ at the threshold.
    pub decision: Decision,
    /// Pr(H = 1 | θ).
    pub posterior: f64,
    /// The rates of error of the test at this threshold.
    pub rates: ErrorRates,
}

/// Judges the statistic of a record at threshold η and with the prior Pr(H = 1).
///
/// ```
/// use palpate::detect::assessment::assess;
/// use palpate::detect::{Decision, theta_of_record};
/// use palpate::force::Force;
///
/// let f0 = Force { lateral: &[0.0; 3][..], normal: &[1.0; 3] };
/// let f1 = Force { lateral: &[0.0; 3][..], normal: &[1.125, 1.25, 1.25] };
/// let observed = Force { lateral: &[0.01, -0.02, 0.0][..], normal: &[1.11, 1.28, 1.21] };
/// let noise_sd = Force { lateral: 0.125, normal: 0.125 };
/// let assessment = assess(theta_of_record(observed, f0, f1, noise_sd)?, 0.5, 0.0)?;
/// assert_eq!(assessment.decision, Decision::Inclusion);
/// assert_eq!(assessment.statistic.gamma, 3.0);
/// assert!(assessment.posterior > 0.98);
/// assert!((assessment.rates.false_alarm - 0.0668).abs() < 1e-4);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// Whatever any step refuses: there is a decision only if every number that leads to it is sound.
///
/// Implements: DET-009, DET-031.
pub fn assess(statistic: Statistic, prior_h1: f64, eta: f64) -> Result<Assessment, DetectError> {
    Ok(Assessment {
        statistic,
        decision: decide(statistic.theta, eta)?,
        posterior: posterior(statistic.theta, prior_h1)?,
        rates: error_rates(statistic.gamma, eta)?,
    })
}

/// A record judged at an unknown position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanAssessment {
    /// Θ_max and its shift.
    pub maximum: ScanMaximum,
    /// Ĥ at the threshold.
    pub decision: Decision,
    /// An upper bound on the false-alarm rate of the scan at this threshold.
    pub false_alarm_bound: f64,
    /// An upper bound on the miss rate for an inclusion at the shift that was found.
    pub miss_bound: f64,
}

/// Judges a residual F_p − F_0 by Θ_max over the shifts of a law, at threshold η.
///
/// # Errors
/// As [`assess`].
///
/// Implements: DET-009, DET-053, DET-057, DET-059.
pub fn assess_scan(
    scan: &Scan<'_>,
    law: &MaximumLaw<'_>,
    residual: Force<&[f64]>,
    eta: f64,
) -> Result<ScanAssessment, DetectError> {
    let maximum = scan.maximum(residual, law.shifts())?;
    Ok(ScanAssessment {
        maximum,
        decision: decide(maximum.theta, eta)?,
        false_alarm_bound: law.false_alarm_bound(eta)?,
        miss_bound: error_rates(maximum.gamma, eta)?.miss,
    })
}

#[cfg(test)]
mod tests;
