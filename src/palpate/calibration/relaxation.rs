//! How the force falls while the probe stands still.

use serde::Serialize;

use super::Curve;

/// What is left of a force t seconds after a step, over what it was: g(t), of one of these forms.
///
/// Implements: CAL-021.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Relaxation {
    /// g = 1: an elastic gel.
    None,
    /// A Prony series, g = 1 − Σ gᵢ (1 − e^(−t/τᵢ)), of so many terms.
    Prony(usize),
    /// A power law, g = (1 + t/τ)^(−β).
    PowerLaw,
}

/// The quadrature of the power law, over y = ln u of g = ∫ u^(β−1) e^(−u − u t/τ) du/Γ(β): its first point, distance and number of points.
const FIRST: f64 = -24.0;
const STEP: f64 = 0.4;
const POINTS: u32 = 70;

impl Relaxation {
    /// From none to the one with the most parameters.
    pub const ALL: [Relaxation; 5] = [
        Relaxation::None,
        Relaxation::PowerLaw,
        Relaxation::Prony(1),
        Relaxation::Prony(2),
        Relaxation::Prony(3),
    ];

    /// Where a fit to `seconds` of a curve begins.
    pub(super) fn start(self, seconds: f64) -> Vec<f64> {
        match self {
            Relaxation::None => Vec::new(),
            Relaxation::PowerLaw => vec![libm::log(0.05 * seconds), libm::log(0.2)],
            Relaxation::Prony(terms) => {
                let time = |term: usize| {
                    let share = (term as f64 + 0.5) / terms as f64;
                    vec![libm::log(seconds * libm::pow(0.01, 1.0 - share)), -1.5]
                };
                (0..terms).flat_map(time).collect()
            }
        }
    }

    /// Whether a curve shows its times: not shorter than between two samples, nor longer than three times the curve.
    pub(super) fn is_seen(self, parameters: &[f64], curve: &Curve) -> bool {
        let times = match self {
            Relaxation::PowerLaw => &parameters[..1],
            _ => parameters,
        };
        let mut times = times.iter().step_by(2).map(|time| libm::exp(*time));
        let recorded = curve.times().unwrap_or_default();
        let steps = recorded.windows(2).map(|pair| pair[1] - pair[0]);
        let least = steps.fold(f64::INFINITY, f64::min);
        let whole = recorded.last().unwrap_or(&0.0) - recorded.first().unwrap_or(&0.0);
        times.all(|time| (least..=3.0 * whole).contains(&time))
    }

    /// Weights and rates (1/s) of g = 1 − Σ w + Σ w e^(−r t), for fitted parameters: ln τ and, of a power law, ln β; of a Prony series
    /// after each ln τ the ln of its g over what never relaxes.
    pub fn terms(self, parameters: &[f64]) -> Vec<[f64; 2]> {
        match (self, parameters) {
            (Relaxation::PowerLaw, &[time, exponent]) => {
                let (rate, exponent) = (libm::exp(-time), libm::exp(exponent));
                let scale = STEP / libm::tgamma(exponent);
                let term = |point: u32| {
                    let y = FIRST + STEP * f64::from(point);
                    let weight = scale * libm::exp(exponent * y - libm::exp(y));
                    [weight, rate * libm::exp(y)]
                };
                (0..POINTS).map(term).collect()
            }
            _ => {
                let pairs = || parameters.chunks_exact(2);
                let all: f64 = pairs().map(|pair| libm::exp(pair[1])).sum();
                let term = |pair: &[f64]| [libm::exp(pair[1]) / (1.0 + all), libm::exp(-pair[0])];
                pairs().map(term).collect()
            }
        }
    }
}

/// The forces at `times` (s) of a gel whose elastic forces would be `elastic`, linear between the samples and 0 before: ∫ g(t − s) dF(s).
///
/// Implements: CAL-020.
pub fn relaxed(terms: &[[f64; 2]], times: &[f64], elastic: &[f64]) -> Vec<f64> {
    let rest = 1.0 - terms.iter().map(|term| term[0]).sum::<f64>();
    let mut forces: Vec<f64> = elastic.iter().map(|force| rest * force).collect();
    for [weight, rate] in terms {
        let mut kept = elastic[0];
        forces[0] += weight * kept;
        for sample in 1..times.len() {
            let x = rate * (times[sample] - times[sample - 1]);
            let mean = if x > 1e-9 { -libm::expm1(-x) / x } else { 1.0 };
            let grown = elastic[sample] - elastic[sample - 1];
            kept = libm::exp(-x) * kept + mean * grown;
            forces[sample] += weight * kept;
        }
    }
    forces
}
