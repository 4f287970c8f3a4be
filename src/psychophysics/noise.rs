//! The noise levels of the paper's §5, recomputed.

use serde::Serialize;

use super::PsychophysicsError;
use super::rates::OpenBounds;

/// One of the paper's noise levels beside ours.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseLevel {
    /// Where it comes from.
    pub name: &'static str,
    /// The paper's number, N, if it prints one.
    #[serde(rename = "printed_n")]
    pub printed: Option<f64>,
    /// Ours, N.
    #[serde(rename = "noise_n")]
    pub noise: f64,
    /// The interval that follows from all answers together, N; `None` for sums of Table 2.
    #[serde(rename = "pooled_bounds_n")]
    pub pooled_bounds: Option<OpenBounds>,
    /// The interval with the subjects as the sample, N.
    #[serde(rename = "clustered_bounds_n")]
    pub clustered_bounds: Option<OpenBounds>,
    /// How it is computed, in words.
    pub formula: String,
    /// What that takes for granted.
    pub assumption: &'static str,
}

/// The noise levels of §5 from Table 2 and from the answers to FEM playback at 6.6 mm.
///
/// # Errors
/// Never for the paper's own numbers.
pub fn paper_noise_levels() -> Result<Vec<NoiseLevel>, PsychophysicsError> {
    todo!("comes with the next commits")
}
