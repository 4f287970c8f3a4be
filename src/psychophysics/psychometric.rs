//! How the share of right answers falls with the depth of the inclusion.

use serde::Serialize;

use super::rates::OpenBounds;

/// The psychometric function ½ + (½ − λ) Φ((m − d)/s) of the depth d that fits a condition best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Psychometric {
    /// m, the depth at which the share is half-way from ½ to 1 − λ, m.
    #[serde(rename = "midpoint_m")]
    pub midpoint: Parameter,
    /// s, the scale of depth over which it falls, m.
    #[serde(rename = "spread_m")]
    pub spread: Parameter,
    /// λ, the share of wrong answers to inclusions of any depth.
    pub lapse: Parameter,
    /// The shares at the inclusions.
    pub predicted: Vec<f64>,
    /// Twice the log-likelihood that a share of its own for each inclusion gains.
    pub deviance: f64,
    /// Inclusions less three.
    pub degrees: u32,
    /// Pr(X ≥ deviance) by the chi-square law, as if all subjects were alike; `None` without
    /// degrees of freedom.
    pub p_value: Option<f64>,
    /// Pr(X ≥ deviance per degree over the dispersion) by the F law.
    pub p_value_dispersed: Option<f64>,
}

/// A parameter with the ends of its profile likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// The most likely value.
    pub value: f64,
    /// As if all subjects were alike; an end that is missing is outside the range that was searched.
    pub bounds: OpenBounds,
    /// With the dispersion of the condition.
    pub dispersed_bounds: OpenBounds,
}
