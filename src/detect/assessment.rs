//! All that a record says, in one call: what `palpate detect` prints.

use super::DetectError;
use super::decision::{Decision, ErrorRates, decide, error_rates, posterior};
use super::matched_filter::Statistic;

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

#[cfg(test)]
mod tests;
