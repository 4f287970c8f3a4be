//! The table "paper, here, why": each number that the paper prints, ours, and the reason for the difference.

use serde::Serialize;

use super::findings::{Calibration, MapFindings, detect_error};
use super::text::{fixed, millimetres, percent};
use super::{ReportError, paper};
use crate::detect::{gamma_from_two_afc, required_gamma, two_afc};

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
    pub place: &'static str,
    /// As the paper prints it.
    pub paper_text: String,
    /// The paper's number.
    pub paper: Value,
    /// Our number.
    pub here: Value,
    /// Why they differ, or what was assumed.
    pub why: String,
    /// Whether ours was fitted to the paper's, so that their agreement says nothing.
    pub is_calibration: bool,
}

/// The share of right answers in pairs at one inclusion: predicted from the peak signal and one noise level,
/// and what Table 1 counts.
///
/// Implements: REP-022.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairwiseFinding {
    /// Which of the paper's phantoms.
    pub phantom: &'static str,
    /// Our peak normal signal, N.
    #[serde(rename = "peak_signal_n")]
    pub peak_signal: f64,
    /// Where that peak lies, m.
    #[serde(rename = "peak_lateral_m")]
    pub peak_lateral: f64,
    /// Peak signal over calibrated noise.
    pub gamma: f64,
    /// Φ(γ/√2).
    pub predicted: f64,
    /// What the subjects did, in the order of Table 1.
    pub observed: [Observed; 3],
    /// Whether the noise was fitted to this row.
    pub is_calibration: bool,
}

/// The pooled right answers of one experiment at one inclusion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Observed {
    /// What Table 1 calls the experiment.
    pub experiment: &'static str,
    /// Right answers of all subjects.
    pub correct: u32,
    /// Pairs judged by all subjects.
    pub trials: u32,
}

impl Observed {
    /// Right answers over pairs.
    pub fn share(self) -> f64 {
        f64::from(self.correct) / f64::from(self.trials)
    }
}

/// The paper's phantoms of `maps` in the order of Table 1, with their first map.
fn paper_maps(maps: &[MapFindings]) -> impl Iterator<Item = (usize, &'static str, &MapFindings)> {
    let columns = paper::INCLUSIONS.into_iter().enumerate();
    columns.filter_map(|(column, name)| {
        let map = maps.iter().find(|map| map.paper_phantom == Some(name))?;
        Some((column, name, map))
    })
}

/// Table 1 against Φ(γ/√2), for the paper's phantoms that the study holds.
///
/// # Errors
/// [`ReportError::Detect`] if a signal over the noise overflows.
///
/// Implements: REP-021, REP-022.
pub fn pairwise(
    maps: &[MapFindings],
    calibration: Option<Calibration>,
) -> Result<Vec<PairwiseFinding>, ReportError> {
    let Some(Calibration { noise, .. }) = calibration else {
        return Ok(Vec::new());
    };
    let row = |(column, phantom, map): (usize, &'static str, &MapFindings)| {
        let peak_signal = map.peak_normal.force.abs();
        let gamma = peak_signal / noise;
        Ok(PairwiseFinding {
            phantom,
            peak_signal,
            peak_lateral: map.peak_normal.lateral,
            gamma,
            predicted: two_afc(gamma).map_err(|source| detect_error("pairs", source))?,
            observed: paper::EXPERIMENTS.map(|experiment| Observed {
                experiment: experiment.name,
                correct: experiment.pooled(column),
                trials: experiment.trials(),
            }),
            is_calibration: phantom == "6.6",
        })
    };
    paper_maps(maps).map(row).collect()
}

/// All rows whose phantom the study holds. `level` is the normal force at x = 0 without inclusion, and `maps`
/// is empty, unless they belong to the paper's phantoms at the paper's depth.
///
/// # Errors
/// [`ReportError::Detect`] never for the paper's own numbers; it is passed on all the same.
///
/// Implements: REP-020.
pub fn table(
    level: Option<f64>,
    maps: &[MapFindings],
    calibration: Option<Calibration>,
    pairwise: &[PairwiseFinding],
) -> Result<Vec<Comparison>, ReportError> {
    let mut rows = Vec::new();
    rows.extend(level.map(force_level));
    rows.extend(typical_signal(maps));
    rows.extend(calibration.map(peak_signal));
    rows.extend(display_requirement()?);
    rows.extend(noise_sources());
    rows.push(gamma_of_accuracy()?);
    rows.extend(calibration.map(subjects_noise));
    rows.extend(pairwise.iter().map(playback_rate));
    Ok(rows)
}

fn row(
    quantity: &str,
    place: &'static str,
    paper: (&str, Value),
    here: Value,
    why: impl Into<String>,
) -> Comparison {
    Comparison {
        quantity: quantity.into(),
        place,
        paper_text: paper.0.into(),
        paper: paper.1,
        here,
        why: why.into(),
        is_calibration: false,
    }
}

fn force_level(level: f64) -> Comparison {
    row(
        "Force level: normal force at 4 mm, x = 0, no inclusion",
        "§2",
        ("1.6 N, nominal", Value::ForceN(paper::FORCE_LEVEL)),
        Value::ForceN(level),
        "The paper does not say which element it used. Six-node triangles do not lock at ν = 0.49, and their 1.48 N \
         hardly depends on the mesh. Fully integrated four-node quads (--element q4-full) lock, the more the coarser \
         the mesh: about 1.51 N at 0.7 mm, 1.57 N at 2 mm. The authors plausibly ran such a mesh; their moduli are \
         “roughly determined”, too.",
    )
}

/// The peak signal that comes nearest to the paper's "roughly 0.5N", for which it names no inclusion.
fn typical_signal(maps: &[MapFindings]) -> Option<Comparison> {
    let peaks: Vec<_> = paper_maps(maps)
        .map(|(_, name, map)| (name, map.peak_normal.force.abs()))
        .collect();
    let distance = |peak: f64| (peak - paper::SIGNAL).abs();
    let nearest = peaks
        .iter()
        .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    let list: Vec<_> = peaks
        .iter()
        .map(|(name, peak)| format!("{name} mm: {} N", fixed(*peak, 3)))
        .collect();
    Some(row(
        &format!(
            "Signal F₁ − F₀: here the peak normal signal at {} mm",
            nearest.0
        ),
        "§2",
        ("roughly 0.5 N", Value::ForceN(paper::SIGNAL)),
        Value::ForceN(nearest.1),
        format!(
            "The paper names no inclusion for its 0.5 N; shown is the nearest of our peaks at 4 mm ({}).",
            list.join(", ")
        ),
    ))
}

fn peak_signal(calibration: Calibration) -> Comparison {
    row(
        "Peak signal of the 6.6 mm inclusion",
        "§5",
        ("340 mN", Value::ForceN(paper::PEAK_SIGNAL_6_6)),
        Value::ForceN(calibration.peak_signal),
        "The peak of the normal signal at 4 mm. Four-node quads that lock give more, the coarser the mesh: about \
         0.32 N at 0.7 mm, 0.34 N at 1.2 mm, 0.36 N at 2 mm.",
    )
}

/// The chain γ > 3.3, 0.15 N, 0.11 N of §2.
fn display_requirement() -> Result<[Comparison; 3], ReportError> {
    let gamma = required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)
        .map_err(|source| detect_error("the paper's error rates", source))?;
    let allowed = paper::SIGNAL / gamma;
    let remaining = |total: f64, source: f64| libm::sqrt(total * total - source * source);
    let rounded = remaining(paper::ALLOWED_NOISE, paper::HUMAN_NOISE);
    let display = remaining(allowed, paper::HUMAN_NOISE);
    let with_table = remaining(allowed, paper::HUMAN_PERCEPTION);
    Ok([
        row(
            "γ for at most 5 % misses and 5 % false alarms",
            "§2, Figure 4",
            ("γ > 3.3", Value::Gamma(paper::REQUIRED_GAMMA)),
            Value::Gamma(gamma),
            "2Φ⁻¹(0.95) = 3.290; the paper rounds up.",
        ),
        row(
            "Noise allowed in all, 0.5 N/γ",
            "§2",
            ("0.15 N", Value::ForceN(paper::ALLOWED_NOISE)),
            Value::ForceN(allowed),
            "The paper rounds.",
        ),
        row(
            "Noise allowed to the display, with 0.1 N of the hand",
            "§2",
            ("0.11 N", Value::ForceN(paper::DISPLAY_NOISE)),
            Value::ForceN(display),
            format!(
                "From the rounded 0.15 N it is {} N. With the hand's 93 mN of Table 2 \
                 instead of 0.1 N it is {} N. The 140 mN of backdrive friction in Table 2 exceed it either way.",
                fixed(rounded, 4),
                fixed(with_table, 3)
            ),
        ),
    ])
}

/// The two sums of Table 2's sources in §5.
fn noise_sources() -> [Comparison; 2] {
    let total = |sources: &[f64]| libm::sqrt(sources.iter().map(|s| s * s).sum());
    [
        row(
            "Noise of the playback of FEM data, from Table 2",
            "§5",
            ("170 mN", Value::ForceN(paper::PLAYBACK_NOISE)),
            Value::ForceN(total(&[
                paper::QUANTIZATION,
                paper::BACKDRIVE_FRICTION,
                paper::HUMAN_PERCEPTION,
            ])),
            "Quantization, backdrive friction and human perception, added as variances; the paper rounds.",
        ),
        row(
            "Noise of direct contact, from Table 2",
            "§5",
            ("220 mN", Value::ForceN(paper::DIRECT_CONTACT_NOISE)),
            Value::ForceN(total(&[paper::UNMODELLED_CONTACT, paper::HUMAN_PERCEPTION])),
            "Unmodelled contact forces and human perception, added as variances; the paper rounds.",
        ),
    ]
}

fn gamma_of_accuracy() -> Result<Comparison, ReportError> {
    let from_share = |share| {
        gamma_from_two_afc(share).map_err(|source| detect_error("the paper's accuracy", source))
    };
    let playback = &paper::EXPERIMENTS[paper::FEM_PLAYBACK];
    let counted = f64::from(playback.pooled(2)) / f64::from(playback.trials());
    Ok(row(
        "γ at which 84 % of pairs are judged right",
        "§5, Figure 9",
        ("γ = 1.45", Value::Gamma(paper::GAMMA_OF_ACCURACY)),
        Value::Gamma(from_share(paper::ACCURACY_6_6)?),
        format!(
            "√2 Φ⁻¹(0.84); the paper read 1.45 off its Figure 9, where the curve is at 84.7 %. For the {} of {} of \
             Table 1 it is {}.",
            playback.pooled(2),
            playback.trials(),
            fixed(from_share(counted)?, 3)
        ),
    ))
}

fn subjects_noise(calibration: Calibration) -> Comparison {
    row(
        "Noise of the subjects, peak signal at 6.6 mm over γ",
        "§5",
        ("235 mN", Value::ForceN(paper::SUBJECTS_NOISE)),
        Value::ForceN(calibration.noise),
        format!(
            "Ours is {} N/{}, with our own peak and the γ of 253 in 300. The paper's peak over the true γ of 84 % \
             would be 242 mN.",
            fixed(calibration.peak_signal, 3),
            fixed(calibration.gamma, 3)
        ),
    )
}

fn playback_rate(pairwise: &PairwiseFinding) -> Comparison {
    let observed = pairwise.observed[paper::FEM_PLAYBACK];
    let printed = format!(
        "{} ({} of {})",
        percent(observed.share()),
        observed.correct,
        observed.trials
    );
    let mut why = String::from(if pairwise.is_calibration {
        "Calibration: the one noise level is fitted to this very row, so their agreement says nothing."
    } else {
        "Φ(γ/√2) with γ = peak signal/noise, the noise fitted at 6.6 mm alone. The subjects differ more than chance \
         allows (χ²/df mostly 2 to 5), and they swept freely over the gel instead of reading one peak."
    });
    if pairwise.peak_lateral != 0.0 {
        why += &format!(
            " Here the peak lies off the inclusion, at x = {} mm.",
            millimetres(pairwise.peak_lateral)
        );
    }
    Comparison {
        is_calibration: pairwise.is_calibration,
        ..row(
            &format!("Pairs judged right, FEM playback, {} mm", pairwise.phantom),
            "Table 1",
            (&printed, Value::Probability(observed.share())),
            Value::Probability(pairwise.predicted),
            why,
        )
    }
}
