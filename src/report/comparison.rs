//! The table "paper, here, why": each number that the paper prints, ours, and the reason for the difference.

use serde::Serialize;

use super::findings::{MapFindings, detect_error};
use super::text::{fixed, millimetres, p_value, percent};
use super::{ReportError, paper, text};
use crate::detect::{gamma_from_two_afc, required_gamma};
use crate::psychophysics::bridge::{
    Bridge, BridgeInclusion, Channel, ConditionBridge, Convention, ConventionFit, ObservedRate,
    Offset, Statistic,
};
use crate::psychophysics::{
    Analysis, Bounds, InclusionAnalysis, NoiseDecomposition, NoiseLevel, OpenBounds,
};

/// A number with its unit: in JSON `{"force_n": 1.6}`.
///
/// ```
/// use palpate::report::Value;
///
/// assert_eq!([Value::ForceN(1.6).text(), Value::Gamma(3.29).text()], ["1.600 N", "γ = 3.290"]);
/// ```
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
    pub place: &'static str,
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

/// All rows whose phantom the study holds. `people` are the answers of Table 1, `noise` the levels of §5, `bridge` sets them
/// against the signals. `level` is the normal force at x = 0 without inclusion, and `maps` is empty, unless they belong to the
/// paper's phantoms at the paper's depth.
///
/// # Errors
/// [`ReportError::Detect`] never for the paper's own numbers; it is passed on all the same.
///
/// Implements: REP-020.
pub fn table(
    level: Option<f64>,
    maps: &[MapFindings],
    people: &Analysis,
    noise: &NoiseDecomposition,
    bridge: Option<&Bridge>,
) -> Result<Vec<Comparison>, ReportError> {
    // The peaks of the paper's phantoms in the order of Table 1, each of its first map.
    let peaks = paper::INCLUSIONS.into_iter().filter_map(|name| {
        let map = maps.iter().find(|map| map.paper_phantom == Some(name))?;
        Some((name, map.peak_normal.force.abs()))
    });
    let peaks: Vec<_> = peaks.collect();
    let mut rows = Vec::new();
    rows.extend(level.map(force_level));
    rows.extend(typical_signal(&peaks));
    rows.extend(peak_signal(&peaks));
    rows.extend(display_requirement()?);
    rows.extend(noise_sources(&noise.levels));
    rows.extend(gamma_of_accuracy(people)?);
    if let Some((bridge, (condition, fit))) = bridge.and_then(|of| Some((of, of_paper(of)?))) {
        rows.extend(subjects_noise(bridge, condition, fit));
        rows.extend(playback_rates(bridge, condition, fit));
    }
    Ok(rows)
}

/// A row from what the paper prints and what that is as a number, and ours.
fn row(
    quantity: impl Into<String>,
    place: &'static str,
    (paper_text, paper): (impl Into<String>, Value),
    here: Value,
    why: impl Into<String>,
) -> Comparison {
    Comparison {
        quantity: quantity.into(),
        place,
        paper_text: paper_text.into(),
        paper,
        here,
        why: why.into(),
    }
}

/// A row of forces, N.
fn force(
    quantity: impl Into<String>,
    place: &'static str,
    (paper_text, paper): (&str, f64),
    here: f64,
    why: impl Into<String>,
) -> Comparison {
    let paper = (paper_text, Value::ForceN(paper));
    row(quantity, place, paper, Value::ForceN(here), why)
}

fn force_level(level: f64) -> Comparison {
    force(
        "Force level: normal force at 4 mm, x = 0, no inclusion",
        "§2",
        ("1.6 N, nominal", paper::FORCE_LEVEL),
        level,
        "The paper does not say which element it used. Six-node triangles do not lock at ν = 0.49, and their 1.48 N \
         hardly depends on the mesh. Elements that lock give more. The authors’ moduli are “roughly determined”, too.",
    )
}

/// The peak signal that comes nearest to the paper's "roughly 0.5N", for which it names no inclusion.
fn typical_signal(peaks: &[(&str, f64)]) -> Option<Comparison> {
    let distance = |peak: f64| (peak - paper::SIGNAL).abs();
    let nearest = peaks
        .iter()
        .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    let list = peaks
        .iter()
        .map(|(name, peak)| format!("{name} mm: {} N", fixed(peak, 3)));
    let list: Vec<_> = list.collect();
    let quantity = format!(
        "Signal F₁ − F₀: here the peak normal signal at {} mm",
        nearest.0
    );
    let why = format!(
        "The paper names no inclusion for its 0.5 N; shown is the nearest of our peaks at 4 mm ({}).",
        list.join(", ")
    );
    let paper = ("roughly 0.5 N", paper::SIGNAL);
    Some(force(quantity, "§2", paper, nearest.1, why))
}

fn peak_signal(peaks: &[(&str, f64)]) -> Option<Comparison> {
    let (_, peak) = peaks.iter().find(|(name, _)| *name == PRINTED)?;
    Some(force(
        "Peak signal of the 6.6 mm inclusion",
        "§5",
        ("340 mN", paper::PEAK_SIGNAL_6_6),
        *peak,
        "The peak of the normal signal at 4 mm. Elements that lock give more.",
    ))
}

/// The chain γ > 3.3, 0.15 N, 0.11 N of §2.
fn display_requirement() -> Result<[Comparison; 3], ReportError> {
    let gamma = required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)
        .map_err(|source| detect_error("the paper's error rates", source))?;
    let allowed = paper::SIGNAL / gamma;
    let remaining = |total: f64, source: f64| libm::sqrt(total * total - source * source);
    let rounded = remaining(paper::ALLOWED_NOISE, paper::HUMAN_NOISE);
    let with_table = remaining(allowed, paper::HUMAN_PERCEPTION);
    Ok([
        row(
            "γ for at most 5 % misses and 5 % false alarms",
            "§2, Figure 4",
            ("γ > 3.3", Value::Gamma(paper::REQUIRED_GAMMA)),
            Value::Gamma(gamma),
            "2Φ⁻¹(0.95) = 3.290; the paper rounds up.",
        ),
        force(
            "Noise allowed in all, 0.5 N/γ",
            "§2",
            ("0.15 N", paper::ALLOWED_NOISE),
            allowed,
            "The paper rounds.",
        ),
        force(
            "Noise allowed to the display, with 0.1 N of the hand",
            "§2",
            ("0.11 N", paper::DISPLAY_NOISE),
            remaining(allowed, paper::HUMAN_NOISE),
            format!(
                "From the rounded 0.15 N it is {} N. With the hand's 93 mN of Table 2 \
                 instead of 0.1 N it is {} N. The 140 mN of backdrive friction in Table 2 exceed it either way.",
                fixed(rounded, 4),
                fixed(with_table, 3)
            ),
        ),
    ])
}

/// The two sums of Table 2's sources that §5 prints.
fn noise_sources(levels: &[NoiseLevel]) -> impl Iterator<Item = Comparison> {
    let printed = [
        (
            "Noise of the playback of FEM data, from Table 2",
            ("170 mN", paper::PLAYBACK_NOISE),
            "Quantization, backdrive friction and human perception, added as variances; the paper rounds.",
        ),
        (
            "Noise of direct contact, from Table 2",
            ("220 mN", paper::DIRECT_CONTACT_NOISE),
            "Unmodelled contact forces and human perception, added as variances; the paper rounds.",
        ),
    ];
    printed.into_iter().filter_map(|(quantity, paper, why)| {
        let level = levels.iter().find(|of| of.printed == Some(paper.1))?;
        Some(force(quantity, "§5", paper, level.noise, why))
    })
}

/// The γ of the paper's accuracy of FEM playback.
fn gamma_of_accuracy(people: &Analysis) -> Result<Option<Comparison>, ReportError> {
    let here = gamma_from_two_afc(paper::ACCURACY_6_6)
        .map_err(|source| detect_error("the paper's accuracy", source))?;
    let playback = people.conditions.get(paper::FEM_PLAYBACK);
    let mut inclusions = playback.iter().flat_map(|condition| &condition.inclusions);
    let printed = inclusions.find(|of| of.name == PRINTED);
    Ok(printed.map(|InclusionAnalysis { pooled, .. }| {
        let counted = text::or(pooled.gamma.gamma, "no number", |gamma| fixed(gamma, 3));
        row(
            "γ at which 84 % of pairs are judged right",
            "§5, Figure 9",
            ("γ = 1.45", Value::Gamma(paper::GAMMA_OF_ACCURACY)),
            Value::Gamma(here),
            format!(
                "√2 Φ⁻¹(0.84); the paper read 1.45 off its Figure 9, where the curve is at 84.7 %. For the {} of {} of \
                 Table 1 it is {counted}.",
                pooled.correct, pooled.trials
            ),
        )
    }))
}

/// FEM playback with the paper's own convention: the peak of the normal force.
fn of_paper(bridge: &Bridge) -> Option<(&ConditionBridge, &ConventionFit)> {
    let condition = bridge.conditions.get(paper::FEM_PLAYBACK)?;
    let convention = Convention {
        statistic: Statistic::Peak,
        channel: Channel::Normal,
        offset: Offset::Kept,
    };
    let mut fits = condition.conventions.iter();
    Some((condition, fits.find(|fit| fit.convention == convention)?))
}

/// The noise that explains the answers to FEM playback at 6.6 mm.
///
/// Implements: REP-072.
fn subjects_noise(
    bridge: &Bridge,
    condition: &ConditionBridge,
    fit: &ConventionFit,
) -> Option<Comparison> {
    let index = bridge.inclusions.iter().position(|of| of.name == PRINTED)?;
    let of_inclusion = condition.noise_by_inclusion.get(index)?;
    let noise = of_inclusion.noise?;
    let range = match of_inclusion.clustered_bounds {
        Some(OpenBounds {
            lower: Some(lower),
            upper: Some(upper),
        }) => format!(
            " With the subjects as the sample its 95 % interval is {} to {} N.",
            fixed(lower, 3),
            fixed(upper, 3)
        ),
        _ => String::new(),
    };
    let verdict = match fit.is_rejected {
        true => "reject",
        false => "do not reject",
    };
    Some(force(
        "Noise of the subjects, peak signal at 6.6 mm over γ",
        "§5",
        ("235 mN", paper::SUBJECTS_NOISE),
        noise,
        format!(
            "Ours is {} N over {}, with our own peak and the γ of the answers counted in Table 1. The paper's peak over the true γ \
             of 84 % would be 242 mN.{range} Over the sweep of the maps, and with the answers of a subject taken as binomial, the \
             answers to all depths {verdict} the peak of the normal force as what the subjects felt (p = {}).",
            fixed(of_inclusion.signal, 3),
            fixed(of_inclusion.signal / noise, 3),
            p_value(fit.p_value)
        ),
    ))
}

/// Rates of FEM playback by the paper's own convention, the peak of the normal force, with one noise level for all.
///
/// Implements: REP-073.
fn playback_rates(
    bridge: &Bridge,
    condition: &ConditionBridge,
    fit: &ConventionFit,
) -> Vec<Comparison> {
    let Some(common) = &fit.common else {
        return Vec::new();
    };
    let rate = |((inclusion, observed), predicted): ((&BridgeInclusion, &ObservedRate), &f64)| {
        let mut why = format!(
            "Φ(γ/√2) with γ = peak normal signal/noise, one noise level of {} N fitted to all depths together.",
            fixed(common.noise, 3)
        );
        if let Some(Bounds { lower, upper }) = observed.clustered_bounds {
            why += &format!(
                " With the subjects as the sample the observed share is {} to {}.",
                percent(lower),
                percent(upper)
            );
        }
        if inclusion.peak_normal_at != 0.0 {
            why += &format!(
                " Here the peak lies off the inclusion, at x = {} mm.",
                millimetres(inclusion.peak_normal_at)
            );
        }
        let paper = Value::Probability(observed.rate);
        row(
            format!("Pairs judged right, FEM playback, {} mm", inclusion.name),
            "Table 1",
            (paper.text(), paper),
            Value::Probability(*predicted),
            why,
        )
    };
    let each = bridge.inclusions.iter().zip(&condition.observed);
    each.zip(&common.predicted).map(rate).collect()
}
