//! γ of the matched filter, with both channels and with each alone.

use serde::Serialize;

use palpate::detect::{DetectError, MatchedFilter};
use palpate::force::Force;

/// γ with both channels and with each alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GammaByChannel {
    /// Both.
    pub both: f64,
    /// The normal force alone.
    pub normal: f64,
    /// The lateral force alone.
    pub lateral: f64,
}

/// γ of lateral and normal forces in noise of the same standard deviation.
pub(super) fn gamma(lateral: &[f64], normal: &[f64], noise_sd: f64) -> Result<f64, DetectError> {
    let template = Force { lateral, normal };
    let noise_sd = Force::new(noise_sd, noise_sd);
    MatchedFilter::new(template, noise_sd).map(|filter| filter.gamma())
}
