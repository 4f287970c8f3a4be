//! What the detector assumes, in a run and in a study.

use palpate::detect::{DetectError, required_gamma};
use palpate::stats::error::in_range;
use serde::{Deserialize, Serialize};

use crate::psychophysics::noise::SUBJECTS_NOISE;

/// What the detector assumes, with the paper's numbers as the default.
///
/// Implements: REP-001.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The false-alarm rate α that is allowed.
    pub max_false_alarm: f64,
    /// The miss rate β that is allowed.
    pub max_miss: f64,
    /// The prior Pr(H = 1).
    pub prior_h1: f64,
    /// Standard deviation of the noise of one sample, the same in both channels, N.
    pub noise_sd_n: f64,
}

impl Settings {
    /// The γ that keeps both error rates.
    ///
    /// # Errors
    /// Rates that are not strictly between 0 and 1, or that add up to 1 or more, so that no γ is needed.
    ///
    /// Implements: REP-004, STU-011.
    pub fn required_gamma(&self) -> Result<f64, DetectError> {
        let gamma = required_gamma(self.max_false_alarm, self.max_miss)?;
        let range = "less than 1 - max_false_alarm";
        in_range(gamma > 0.0, "max_miss", self.max_miss, range)?;
        Ok(gamma)
    }
}

impl Default for Settings {
    /// The rates of §2 of the paper, and the noise that §5 estimates for its subjects.
    fn default() -> Self {
        Settings {
            max_false_alarm: 0.05,
            max_miss: 0.05,
            prior_h1: 0.5,
            noise_sd_n: SUBJECTS_NOISE,
        }
    }
}
