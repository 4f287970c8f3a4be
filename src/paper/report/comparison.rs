//! The table "paper, here, why": each number that the paper prints, ours, and the reason for the difference.

use serde::Serialize;

use super::maps::MapFindings;
use super::paper;
use super::text::{fixed, joined, millimetres, or, p_value, percent};
use crate::psychophysics::bridge::{
    Bridge, Channel, ConditionBridge, Convention, ConventionFit, Mean, Statistic,
};
use crate::psychophysics::{Analysis, NoiseDecomposition, OpenBounds, Rate};
use palpate::detect::{DetectError, gamma_from_two_afc, required_gamma};

/// A number with its unit: in JSON `{"force_n": 1.6}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Value {
    /// A force, N.
    ForceN(f64),
    /// A signal-to-noise ratio.
    Gamma(f64),
    /// A probability or a share.
    Probability(f64),
}

impl Value {
    /// The number with its unit, as a person reads it.
    pub fn text(self) -> String {
        match self {
            Value::ForceN(force) => format!("{} N", fixed(force, 3)),
            Value::Gamma(gamma) => format!("γ = {}", fixed(gamma, 3)),
            Value::Probability(share) => percent(share),
        }
    }
}

/// One number of the paper beside ours.
///
/// Implements: REP-020.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What is compared.
    pub quantity: String,
    /// Where the paper prints it.
    pub place: String,
    /// As the paper prints it.
    pub paper_text: String,
    /// The paper's number.
    pub paper: Value,
    /// Our number.
    pub here: Value,
    /// Why they differ, or what was assumed.
    pub why: String,
}

/// The inclusion for which the paper prints signal, rate and noise.
const PRINTED: &str = "6.6";

/// All rows whose phantom the run holds. `people` are the answers of Table 1, `noise` the levels of §5, `bridge` sets them
/// against the signals. `level` is the normal force at x = 0 without inclusion, and `maps` is empty, unless they belong to the
/// paper's phantoms at the paper's depth.
///
/// # Errors
/// The detector's refusal, which the paper's own numbers never meet.
///
/// Implements: REP-020.
pub fn table(
    level: Option<f64>,
    maps: &[MapFindings],
    people: &Analysis,
    noise: &NoiseDecomposition,
    bridge: Option<&Bridge>,
) -> Result<Vec<Comparison>, DetectError> {
    let playback = people.conditions.get(paper::FEM_PLAYBACK);
    let mut inclusions = playback.iter().flat_map(|of| &of.inclusions);
    let counted = inclusions.find(|of| of.name == PRINTED);
    let mut rows = forces(level, maps);
    rows.extend(required()?);
    rows.extend(table_2(noise));
    rows.push(accuracy(counted.map(|of| &of.pooled))?);
    rows.push(bridge.and_then(subjects));
    rows.extend(bridge.and_then(shares).unwrap_or_default());
    Ok(rows.into_iter().flatten().collect())
}

/// A row, if the run has our number.
fn row(
    quantity: impl Into<String>,
    place: &str,
    (paper_text, kind, paper): (impl Into<String>, fn(f64) -> Value, f64),
    here: Option<f64>,
    why: impl Into<String>,
) -> Option<Comparison> {
    Some(Comparison {
        quantity: quantity.into(),
        place: place.into(),
        paper_text: paper_text.into(),
        paper: kind(paper),
        here: kind(here?),
        why: why.into(),
    })
}

/// Forces and signals.
fn forces(level: Option<f64>, maps: &[MapFindings]) -> Vec<Option<Comparison>> {
    // The peaks of the paper's phantoms in the order of Table 1, each of its first map.
    let peaks = paper::INCLUSIONS.into_iter().filter_map(|name| {
        let map = maps.iter().find(|map| map.paper_phantom == Some(name))?;
        Some((name, map.peak_normal.force_n.abs()))
    });
    let peaks: Vec<_> = peaks.collect();
    let off = |peak: f64| (peak - paper::SIGNAL).abs();
    let nearest = peaks.iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
    let nearest_name = nearest.map_or("", |of| of.0);
    let all = peaks.iter();
    let all = all.map(|(name, peak)| format!("{name} mm: {} N", fixed(peak, 3)));
    let printed = peaks.iter().find(|(name, _)| *name == PRINTED);
    vec![
        row(
            "Force level: normal force at 4 mm, x = 0, no inclusion",
            "§2",
            ("1.6 N, nominal", Value::ForceN, paper::FORCE_LEVEL),
            level,
            "The paper does not say which element it used. Six-node triangles do not lock at ν = 0.49; how far their \
             force depends on the mesh, the bands in the table of certificates say. Elements that lock give more. The authors’ moduli are “roughly determined”, too.",
        ),
        row(
            format!("Signal F₁ − F₀: here the peak normal signal at {nearest_name} mm"),
            "§2",
            ("roughly 0.5 N", Value::ForceN, paper::SIGNAL),
            nearest.map(|of| of.1),
            format!(
                "The paper names no inclusion for its 0.5 N; shown is the nearest of our peaks at 4 mm ({}).",
                joined(all, ", ")
            ),
        ),
        row(
            "Peak signal of the 6.6 mm inclusion",
            "§5",
            ("340 mN", Value::ForceN, paper::PEAK_SIGNAL_6_6),
            printed.map(|of| of.1),
            "The peak of the normal signal at 4 mm. Elements that lock give more.",
        ),
    ]
}

/// What the error rates need, and what they leave to the noise.
fn required() -> Result<[Option<Comparison>; 3], DetectError> {
    let needed = required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)?;
    let allowed = paper::SIGNAL / needed;
    // What one source of noise leaves to the others of a total, N.
    let remaining = |total: f64, source: f64| libm::sqrt(total * total - source * source);
    let rounded = remaining(paper::ALLOWED_NOISE, paper::HUMAN_NOISE);
    let of_table_2 = remaining(allowed, paper::HUMAN_PERCEPTION);
    Ok([
        row(
            "γ for at most 5 % misses and 5 % false alarms",
            "§2, Figure 4",
            ("γ > 3.3", Value::Gamma, paper::REQUIRED_GAMMA),
            Some(needed),
            "2Φ⁻¹(0.95) = 3.290; the paper rounds up.",
        ),
        row(
            "Noise allowed in all, 0.5 N/γ",
            "§2",
            ("0.15 N", Value::ForceN, paper::ALLOWED_NOISE),
            Some(allowed),
            "The paper rounds.",
        ),
        row(
            "Noise allowed to the display, with 0.1 N of the hand",
            "§2",
            ("0.11 N", Value::ForceN, paper::DISPLAY_NOISE),
            Some(remaining(allowed, paper::HUMAN_NOISE)),
            format!(
                "From the rounded 0.15 N it is {} N. With the hand's 93 mN of Table 2 instead of 0.1 N it is {} N. The 140 mN of backdrive \
                 friction in Table 2 exceed it either way.",
                fixed(rounded, 4),
                fixed(of_table_2, 3)
            ),
        ),
    ])
}

/// The sums of Table 2.
fn table_2(noise: &NoiseDecomposition) -> [Option<Comparison>; 2] {
    let row = |of: &str, text: &str, printed: f64, sources: &str| {
        let level = noise.levels.iter().find(|of| of.printed_n == Some(printed));
        row(
            format!("Noise of {of}, from Table 2"),
            "§5",
            (text, Value::ForceN, printed),
            level.map(|level| level.noise_n),
            format!("{sources} and human perception, added as variances; the paper rounds."),
        )
    };
    let (fem, friction) = (paper::PLAYBACK_NOISE, "Quantization, backdrive friction");
    let (direct, contact) = (paper::DIRECT_CONTACT_NOISE, "Unmodelled contact forces");
    [
        row("the playback of FEM data", "170 mN", fem, friction),
        row("direct contact", "220 mN", direct, contact),
    ]
}

/// γ of the answers to FEM playback at 6.6 mm.
fn accuracy(counted: Option<&Rate>) -> Result<Option<Comparison>, DetectError> {
    let gamma = gamma_from_two_afc(paper::ACCURACY_6_6)?;
    let counted_gamma = counted.map(|of| {
        let (right, all) = (of.correct, of.trials);
        let gamma = or(of.gamma.gamma, "no number", |gamma| fixed(gamma, 3));
        format!(" For the {right} of {all} of Table 1 it is {gamma}.")
    });
    Ok(row(
        "γ at which 84 % of pairs are judged right",
        "§5, Figure 9",
        ("γ = 1.45", Value::Gamma, paper::GAMMA_OF_ACCURACY),
        counted.map(|_| gamma),
        format!(
            "√2 Φ⁻¹(0.84); the paper read 1.45 off its Figure 9, where the curve is at 84.7 %.{}",
            counted_gamma.unwrap_or_default()
        ),
    ))
}

/// What the answers say of the subjects' noise: at 6.6 mm, and of the fit to all depths.
fn subjects(bridge: &Bridge) -> Option<Comparison> {
    let (condition, fit) = of_paper(bridge)?;
    let index = bridge.inclusions.iter().position(|of| of.name == PRINTED)?;
    let of = condition.noise_by_inclusion.get(index)?;
    let noise = of.noise_n?;
    let interval = match of.clustered_bounds_n {
        Some(OpenBounds {
            lower: Some(lower),
            upper: Some(upper),
        }) => {
            let [lower, upper] = [lower, upper].map(|end| fixed(end, 3));
            format!(" With the subjects as the sample its 95 % interval is {lower} to {upper} N.")
        }
        _ => String::new(),
    };
    let not = if fit.is_rejected { "" } else { "do not " };
    let of_all = named(bridge);
    row(
        "Noise of the subjects, peak signal at 6.6 mm over γ",
        "§5",
        ("235 mN", Value::ForceN, paper::SUBJECTS_NOISE),
        Some(noise),
        format!(
            "Ours is {} N over {}, with our own peak and the γ of the answers counted in Table 1. The paper's peak over the true γ of 84 % \
             would be 242 mN.{interval} Over the sweep of the maps, and with the answers of a subject taken as binomial, the answers at \
             {of_all} mm {not}reject the peak of the normal force as what the subjects felt (p = {}).",
            fixed(of.signal_n, 3),
            fixed(of.signal_n / noise, 3),
            p_value(fit.p_value)
        ),
    )
}

/// The shares of right answers that the noise of the fit to all depths predicts.
fn shares(bridge: &Bridge) -> Option<Vec<Option<Comparison>>> {
    let (condition, fit) = of_paper(bridge)?;
    let common = fit.common.as_ref()?;
    let each = bridge.inclusions.iter().zip(&condition.observed);
    let rows = each.zip(&common.predicted).map(|((inclusion, observed), here)| {
        let interval = observed.clustered_bounds.map(|of| {
            let [lower, upper] = [of.lower, of.upper].map(percent);
            format!(" With the subjects as the sample the observed share is {lower} to {upper}.")
        });
        let off = match inclusion.peak_normal_at_m {
            0.0 => String::new(),
            x => format!(" Here the peak lies off the inclusion, at x = {} mm.", millimetres(x)),
        };
        row(
            format!("Pairs judged right, FEM playback, {} mm", inclusion.name),
            "Table 1",
            (percent(observed.rate), Value::Probability, observed.rate),
            Some(*here),
            format!(
                "Φ(γ/√2) with γ = peak normal signal/noise, one noise level of {} N fitted to the answers at {} mm together.{}{off}",
                fixed(common.noise_n, 3),
                named(bridge),
                interval.unwrap_or_default()
            ),
        )
    });
    Some(rows.collect())
}

/// The depths of the inclusions whose answers are fitted.
pub(super) fn named(bridge: &Bridge) -> String {
    joined(bridge.inclusions.iter().map(|of| of.name.clone()), ", ")
}

/// FEM playback with the paper's own convention: the peak of the normal force.
fn of_paper(bridge: &Bridge) -> Option<(&ConditionBridge, &ConventionFit)> {
    let condition = bridge.conditions.get(paper::FEM_PLAYBACK)?;
    let convention = Convention {
        statistic: Statistic::Peak,
        channel: Channel::Normal,
        mean: Mean::Kept,
    };
    let mut fits = condition.conventions.iter();
    Some((condition, fits.find(|fit| fit.convention == convention)?))
}
