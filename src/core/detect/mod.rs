//! Whether a recorded force holds an inclusion (paper §2).
//!
//! The observed force is F_0 (no inclusion, H = 0) or F_1 (inclusion, H = 1) plus Gaussian noise,
//! sampled i = 1 … N along the trajectory in two channels: x lateral, y normal. The *template* is Δ
//! = F_1 − F_0, the *residual* r = F_p − F_0, and Θ the log-likelihood ratio of the two hypotheses.
//!
//! | paper | here |
//! |---|---|
//! | (2)–(7): h, Y, b, γ, Θ | [`matched_filter`] |
//! | (8), (9), figures 4 and 9: thresholds, error rates, pair-wise tests | [`decision`] |
//!
//! Nothing here allocates; what needs memory takes it from the caller. `spec/detector.md` is
//! normative.
//!
//! ```
//! use palpate_core::force::Force;
//! use palpate_core::detect::{Decision, MatchedFilter, decide, error_rates, required_gamma};
//!
//! // At most 5 % false alarms and 5 % misses need γ = 3.29.
//! assert!((required_gamma(0.05, 0.05)? - 3.29).abs() < 1e-3);
//!
//! // A signal of three samples in the normal force, in noise of 0.125 N: γ = 3.
//! let template = Force { lateral: &[0.0; 3][..], normal: &[0.125, 0.25, 0.25] };
//! let filter = MatchedFilter::new(template, Force { lateral: 0.125, normal: 0.125 })?;
//! assert_eq!(filter.gamma(), 3.0);
//!
//! // The record without noise: θ = γ²/2, and at η = 0 it is an inclusion.
//! let theta = filter.statistic(template)?.theta;
//! assert_eq!(theta, 4.5);
//! assert_eq!(decide(theta, 0.0)?, Decision::Inclusion);
//! assert!((error_rates(3.0, 0.0)?.miss - 0.0668).abs() < 1e-4);
//! # Ok::<(), palpate_core::detect::DetectError>(())
//! ```

pub mod coloured;
pub mod decision;
pub mod matched_filter;
mod noise;
pub mod noise_budget;
pub mod nuisance;
pub mod scan;
pub mod sequential;

pub use decision::{
    Costs, Decision, ErrorRates, bayes_threshold, decide, error_rates, gamma_from_two_afc,
    map_threshold, neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold, posterior,
    required_gamma, roc_miss, two_afc,
};
pub use matched_filter::{MatchedFilter, Statistic, theta_of_record};

pub use crate::force::Force;
pub use crate::stats::NumericError as DetectError;
use crate::stats::error::check_samples;

impl Force<&[f64]> {
    /// Checks that both components have `length` samples, all of them finite; `x` and `y` are their names.
    ///
    /// # Errors
    /// No samples; another number of them; NaN or infinity.
    pub fn check(self, x: &'static str, y: &'static str, length: usize) -> Result<(), DetectError> {
        check_samples(x, self.lateral, length)?;
        check_samples(y, self.normal, length)
    }
}

#[cfg(test)]
mod tests;
