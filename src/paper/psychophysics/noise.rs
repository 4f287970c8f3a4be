//! The noise levels of the paper's §5, recomputed.

use serde::Serialize;

use super::rates::{Clustered, GammaEstimate, OpenBounds, Rate, pooled};
use super::{AnswerTable, Result};
use palpate::detect::noise_budget::noise_total;

/// "The peak signal strength for this inclusion is 340mN" (§5, 6.6 mm), N.
pub const PEAK_SIGNAL: f64 = 0.340;
/// "the subjects are operating near γ = 1.45" (§5).
pub const PRINTED_GAMMA: f64 = 1.45;
/// "the noise estimate from the psychophysics experiments is 235mN" (§5), N.
pub const SUBJECTS_NOISE: f64 = 0.235;
/// "The noise estimate for the FEM playback … is 170mN" (§5), N.
pub const PLAYBACK_NOISE: f64 = 0.170;
/// "The noise estimate for the direct contact case … is 220mN" (§5), N.
pub const DIRECT_CONTACT_NOISE: f64 = 0.220;
/// Table 2, sensor, N.
pub const SENSOR: f64 = 0.020;
/// Table 2, actuation quantization, N.
pub const QUANTIZATION: f64 = 0.5e-3;
/// Table 2, actuation backdrive friction, N.
pub const BACKDRIVE_FRICTION: f64 = 0.140;
/// Table 2, unmodelled direct contact, N.
pub const UNMODELLED_CONTACT: f64 = 0.200;
/// Table 2, human perception, N.
pub const HUMAN_PERCEPTION: f64 = 0.093;
/// The paper's condition and inclusion: FEM data, 6.6 mm.
const PLAYBACK: (usize, usize) = (1, 2);

/// The noise levels of §5.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseDecomposition {
    /// Each level.
    pub levels: Vec<NoiseLevel>,
    /// Whether the noise that Table 2 explains is within the intervals of the noise that the answers
    /// show, in words: the paper calls it "reasonable given the confidence intervals".
    pub agreement: String,
}

/// One of the paper's noise levels beside ours.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseLevel {
    /// Where it comes from.
    pub name: String,
    /// The paper's number, N, if it prints one.
    pub printed_n: Option<f64>,
    /// Ours, N.
    pub noise_n: f64,
    /// The interval that follows from all answers together, N; `None` for sums of Table 2.
    pub pooled_bounds_n: Option<OpenBounds>,
    /// The interval with the subjects as the sample, N.
    pub clustered_bounds_n: Option<OpenBounds>,
    /// How it is computed, in words.
    pub formula: String,
    /// What that takes for granted.
    pub assumption: &'static str,
}

/// A signal over the γ of one inclusion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InclusionNoise {
    /// The signal, N.
    pub signal_n: f64,
    /// The noise, N; `None` if the answers set none: half or fewer right, or all right.
    pub noise_n: Option<f64>,
    /// From Clopper and Pearson's interval, N; an upper end that is missing is no bound.
    pub pooled_bounds_n: OpenBounds,
    /// With the subjects as the sample, N.
    pub clustered_bounds_n: Option<OpenBounds>,
}

impl InclusionNoise {
    /// The noise of a signal, N, from the share of all subjects, and from that with the subjects as the sample.
    pub fn new(signal: f64, pooled: &Rate, clustered: Option<Clustered>) -> InclusionNoise {
        let (noise, pooled_bounds) = noise_bounds(signal, pooled.gamma);
        InclusionNoise {
            signal_n: signal,
            noise_n: noise,
            pooled_bounds_n: pooled_bounds,
            clustered_bounds_n: clustered.map(|found| noise_bounds(signal, found.gamma).1),
        }
    }
}

/// Noise of a signal (N) with a γ: signal/γ, and the interval the other way round; a lower end is 0 where
/// γ has no bound, an upper end missing where γ may be 0.
///
/// Implements: PSY-060.
fn noise_bounds(signal: f64, gamma: GammaEstimate) -> (Option<f64>, OpenBounds) {
    let quotient = |gamma: Option<f64>| match gamma {
        None => Some(0.0),
        Some(0.0) => None,
        Some(gamma) => Some(signal / gamma),
    };
    let noise = quotient(gamma.gamma).filter(|&noise| noise > 0.0);
    let bounds = OpenBounds {
        lower: quotient(gamma.bounds.upper),
        upper: quotient(gamma.bounds.lower),
    };
    (noise, bounds)
}

/// Sums of Table 2: what for, the paper's number (N), the sources (N), and what the sum takes for granted.
pub const SUMS: [(&str, Option<f64>, &[f64], &str); 3] = [
    (
        "playback of FEM data",
        Some(PLAYBACK_NOISE),
        &[QUANTIZATION, BACKDRIVE_FRICTION, HUMAN_PERCEPTION],
        "the sources are independent, so that their variances add; the human perception of Jones (1998) holds for this hand and handle",
    ),
    (
        "direct contact",
        Some(DIRECT_CONTACT_NOISE),
        &[UNMODELLED_CONTACT, HUMAN_PERCEPTION],
        "the sources are independent, and the 200 mN of friction, hysteresis and nonlinearity, which the paper does not derive, are right",
    ),
    (
        "playback of measured data",
        None,
        &[SENSOR, QUANTIZATION, BACKDRIVE_FRICTION, HUMAN_PERCEPTION],
        "the sources are independent; the paper prints no such sum, and it would be as small as that of FEM data, although the answers are poorer",
    ),
];

/// The noise levels of §5 from Table 2 and from the answers to FEM playback at 6.6 mm.
///
/// # Errors
/// Never for the paper's own numbers.
///
/// Implements: PSY-061, ERR-008, ERR-009.
pub fn paper_noise_levels() -> Result<NoiseDecomposition> {
    let printed = NoiseLevel {
        name: "answers to FEM playback at 6.6 mm, as printed".into(),
        printed_n: Some(SUBJECTS_NOISE),
        noise_n: PEAK_SIGNAL / PRINTED_GAMMA,
        pooled_bounds_n: None,
        clustered_bounds_n: None,
        formula: format!("{} mN / {PRINTED_GAMMA}", millinewtons(PEAK_SIGNAL)),
        assumption: "γ is 1.45, as the paper read it off its Figure 9, where 84 % is 1.406",
    };
    let mut levels = vec![printed.clone(), from_answers()?];
    for (name, printed_sum, sources, assumption) in SUMS {
        let square = |&source| format!("{}²", millinewtons(source));
        let squares: Vec<String> = sources.iter().map(square).collect();
        levels.push(NoiseLevel {
            name: format!("{name}, from Table 2"),
            printed_n: printed_sum,
            noise_n: noise_total(sources)?,
            formula: format!("√({}) mN", squares.join(" + ")),
            assumption,
            ..printed.clone()
        });
    }
    Ok(NoiseDecomposition {
        agreement: agreement(&levels[1], levels[2].noise_n),
        levels,
    })
}

/// The peak signal of §5 over the γ of the 253 of 300.
fn from_answers() -> Result<NoiseLevel> {
    let table = AnswerTable::paper()?;
    let (rate, clustered) = pooled(&table.conditions()[PLAYBACK.0], PLAYBACK.1)?;
    let found = InclusionNoise::new(PEAK_SIGNAL, &rate, clustered);
    let peak = millinewtons(PEAK_SIGNAL);
    Ok(NoiseLevel {
        name: "answers to FEM playback at 6.6 mm".into(),
        printed_n: None,
        noise_n: found.noise_n.unwrap_or_default(),
        pooled_bounds_n: Some(found.pooled_bounds_n),
        clustered_bounds_n: found.clustered_bounds_n,
        formula: format!("{peak} mN / (√2 Φ⁻¹({}/{}))", rate.correct, rate.trials),
        assumption: "all subjects have one noise, and decide by the force at the one position of the peak",
    })
}

/// A source of Table 2 in mN: they have at most one decimal.
fn millinewtons(force: f64) -> f64 {
    libm::round(force * 1e4) / 10.0
}

/// Implements: PSY-061.
fn agreement(answers: &NoiseLevel, explained: f64) -> String {
    let said = |name: &str, bounds: Option<OpenBounds>| {
        let Some(OpenBounds { lower, upper }) = bounds else {
            return format!("{name}: no interval");
        };
        let (lower, greatest) = (lower.unwrap_or(0.0), upper.unwrap_or(f64::INFINITY));
        let is_inside = (lower..=greatest).contains(&explained);
        let side = if is_inside { "inside" } else { "outside" };
        let lower = 1e3 * lower;
        let upper = upper.map(|upper| format!("{:.0} mN", 1e3 * upper));
        let upper = upper.unwrap_or("no upper bound".into());
        format!("{side} the 95 % interval of {name} ({lower:.0} mN to {upper})")
    };
    let pooled = "all answers pooled, as the paper draws them";
    format!(
        "The paper calls the {:.0} mN that Table 2 explains \"reasonable given the confidence intervals\" of the noise in the answers, {:.0} mN. It lies {}, and {}.",
        explained * 1e3,
        answers.noise_n * 1e3,
        said(pooled, answers.pooled_bounds_n),
        said("the subjects as the sample", answers.clustered_bounds_n),
    )
}

#[cfg(test)]
mod tests;
