//! How the share of right answers falls with the depth of the inclusion.

use serde::Serialize;

use super::choice::{Count, Perceived, best_lapse, deviance, log_likelihood};
use super::dispersion::Overdispersion;
use super::rates::{CONFIDENCE, OpenBounds};
use super::search::{interval, largest, maximum};
use super::{Column, Condition, Result};
use palpate::stats::noncentral::student_point;
use palpate::stats::normal::{self, lower_tail};
use palpate::stats::tails::chi_square_tail;

/// The midpoint is searched this many spans of the depths beyond them.
const SPANS: f64 = 3.0;
/// The spread is searched from a hundredth of that span to ten of it.
const SPREADS: [f64; 2] = [0.01, 10.0];
/// Cells of the search for the spread, a factor of 1.3 wide.
const SPREAD_CELLS: u32 = 24;
/// Cells of the search for the midpoint between two depths, where a steep fall is, and so many spreads from either, where all answers
/// but those at this depth are alike.
const MIDPOINT_CELLS: u32 = 8;
const SPREADS_FROM_DEPTH: [f64; 2] = [4.0, 8.0];

/// The psychometric function ½ + (½ − λ) Φ((m − d)/s) of the depth d that fits a condition best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Psychometric {
    /// m, the depth at which the share is half-way from ½ to 1 − λ, m.
    pub midpoint_m: Parameter,
    /// s, the scale of depth over which it falls, m.
    pub spread_m: Parameter,
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

/// The function that fits the pooled counts of a condition best; `None` with fewer than three depths, if
/// all answers are right or all are wrong, or without a dispersion.
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-040, PSY-042.
pub fn psychometric(
    inclusions: &[Column],
    condition: &Condition,
    dispersion: Option<Overdispersion>,
) -> Result<Option<Psychometric>> {
    let depths: Vec<f64> = inclusions.iter().map(|inclusion| inclusion.depth).collect();
    let mut distinct = depths.clone();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let (Some(dispersion), &[first, _, .., last]) = (dispersion, &distinct[..]) else {
        return Ok(None);
    };
    let span = last - first;
    let beyond = [first - SPANS * span, last + SPANS * span];
    let model = Model {
        midpoints: [&beyond[..1], &distinct, &beyond[1..]].concat(),
        log_spreads: SPREADS.map(|share| libm::log(share * span)),
        counts: (0..depths.len())
            .map(|j| Count::pooled(condition, j))
            .collect(),
        depths,
    };
    model.fit(dispersion).map(Some)
}

/// Depths, counts, and where the parameters are searched.
struct Model {
    depths: Vec<f64>,
    counts: Vec<Count>,
    /// The ends of the search, and between them the depths.
    midpoints: Vec<f64>,
    log_spreads: [f64; 2],
}

impl Model {
    fn perceived(&self, midpoint: f64, log_spread: f64) -> Vec<Perceived> {
        let spread = libm::exp(log_spread);
        let at = |&depth: &f64| {
            let argument = (midpoint - depth) / spread;
            Perceived {
                share: lower_tail(argument),
                missed: lower_tail(-argument),
            }
        };
        self.depths.iter().map(at).collect()
    }

    /// The log-likelihood with the best lapse, or the given one.
    fn value(&self, midpoint: f64, log_spread: f64, lapse: Option<f64>) -> f64 {
        let perceived = self.perceived(midpoint, log_spread);
        let lapse = lapse.unwrap_or_else(|| best_lapse(&self.counts, &perceived));
        log_likelihood(&self.counts, &perceived, lapse)
    }

    /// The best midpoint for a spread.
    fn over_midpoints(&self, log_spread: f64, lapse: Option<f64>) -> (f64, f64) {
        let value = |m| self.value(m, log_spread, lapse);
        let away = SPREADS_FROM_DEPTH.map(|spreads| spreads * libm::exp(log_spread));
        let near = |pair: &[f64]| {
            let [a, b] = [pair[0], pair[1]];
            let mut all = vec![a];
            all.extend(away.iter().flat_map(|away| [a + away, b - away]));
            all.retain(|m| (a..b).contains(m));
            all
        };
        let mut ends: Vec<f64> = self.midpoints.windows(2).flat_map(near).collect();
        ends.extend(self.midpoints.last());
        ends.sort_by(f64::total_cmp);
        largest(value, &ends, MIDPOINT_CELLS)
    }

    /// The best spread for a midpoint.
    fn over_spreads(&self, midpoint: f64) -> f64 {
        let [low, high] = self.log_spreads;
        maximum(|s| self.value(midpoint, s, None), low, high, SPREAD_CELLS).1
    }

    /// The best spread, with the midpoint that belongs to it.
    fn over_both(&self, lapse: Option<f64>) -> (f64, f64) {
        let [low, high] = self.log_spreads;
        maximum(|s| self.over_midpoints(s, lapse).1, low, high, SPREAD_CELLS)
    }

    fn fit(&self, dispersion: Overdispersion) -> Result<Psychometric> {
        let (log_spread, top) = self.over_both(None);
        let (midpoint, _) = self.over_midpoints(log_spread, None);
        let perceived = self.perceived(midpoint, log_spread);
        let lapse = best_lapse(&self.counts, &perceived);
        let z = normal::quantile(0.5 + 0.5 * CONFIDENCE)?;
        let t = student_point(0.5 * (1.0 - CONFIDENCE), f64::from(dispersion.degrees))?;
        // Where the profile falls below these, a value is outside its interval.
        let floors = [top - 0.5 * z * z, top - 0.5 * dispersion.factor() * t * t];
        let parameter = |value: f64, profile: &dyn Fn(f64) -> f64, ends: [f64; 2]| {
            let [bounds, dispersed_bounds] =
                floors.map(|floor| interval(profile, floor, value, ends));
            Parameter {
                value,
                bounds,
                dispersed_bounds,
            }
        };
        let deviance = deviance(&self.counts, top);
        let degrees = self.counts.len() as u32 - 3;
        let of_spread = |s| self.over_midpoints(s, None).1;
        let ends = [0, self.midpoints.len() - 1].map(|at| self.midpoints[at]);
        let spread = parameter(log_spread, &of_spread, self.log_spreads);
        let mut lapse = parameter(lapse, &|lapse| self.over_both(Some(lapse)).1, [0.0, 0.5]);
        for bounds in [&mut lapse.bounds, &mut lapse.dispersed_bounds] {
            // No lapse is the end of the range, not a bound that is missing.
            bounds.lower = bounds.lower.or(Some(0.0));
        }
        Ok(Psychometric {
            midpoint_m: parameter(midpoint, &|m| self.over_spreads(m), ends),
            spread_m: spread.map(libm::exp),
            predicted: perceived.iter().map(|at| at.right(lapse.value)).collect(),
            lapse,
            deviance,
            degrees,
            p_value: match degrees {
                0 => None,
                _ => Some(chi_square_tail(deviance, f64::from(degrees))?),
            },
            p_value_dispersed: dispersion.p_value(deviance, degrees)?,
        })
    }
}

impl Parameter {
    /// The same with an increasing function applied to every number.
    fn map(self, function: impl Fn(f64) -> f64) -> Parameter {
        Parameter {
            value: function(self.value),
            bounds: self.bounds.map(&function),
            dispersed_bounds: self.dispersed_bounds.map(&function),
        }
    }
}

#[cfg(test)]
mod tests;
