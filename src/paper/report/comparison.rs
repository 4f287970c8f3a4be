//! The table "paper, here, why": each number that the paper prints, ours, and the reason for the difference. Its words are in
//! the block `comparison` of `templates/report/words.txt`.

use askama::Template;
use serde::Serialize;

use super::maps::MapFindings;
use super::text::{fixed, percent};
use super::{paper, text};
use crate::psychophysics::bridge::{
    Bridge, BridgeInclusion, Channel, ConditionBridge, Convention, ConventionFit, ObservedRate,
    Offset, Statistic,
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

/// What the rows name; as text a line for each row with its words.
#[derive(Template)]
#[template(path = "report/words.txt", block = "comparison")]
struct Known<'a> {
    /// The peak normal signals at 4 mm by inclusion, N, and the one nearest to the paper's "roughly 0.5N".
    peaks: &'a [(&'static str, f64)],
    nearest: Option<&'a (&'static str, f64)>,
    /// The γ that the paper's error rates need.
    needed: f64,
    /// The answers to FEM playback at 6.6 mm.
    counted: Option<&'a Rate>,
    /// What they say of the subjects' noise: the fit to all depths, the peak signal and the noise there (N) with its interval.
    subjects: Option<(&'a ConventionFit, f64, f64, Option<OpenBounds>)>,
    /// Inclusion, observed share, noise of the common fit (N), predicted share.
    rates: Vec<(&'a BridgeInclusion, &'a ObservedRate, f64, f64)>,
}

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
    // The peaks of the paper's phantoms in the order of Table 1, each of its first map.
    let peaks = paper::INCLUSIONS.into_iter().filter_map(|name| {
        let map = maps.iter().find(|map| map.paper_phantom == Some(name))?;
        Some((name, map.peak_normal.force_n.abs()))
    });
    let peaks: Vec<_> = peaks.collect();
    let counted = people.conditions.get(paper::FEM_PLAYBACK);
    let mut counted = counted.iter().flat_map(|of| &of.inclusions);
    let counted = counted.find(|of| of.name == PRINTED).map(|of| &of.pooled);
    let playback = bridge.and_then(|bridge| Some((bridge, of_paper(bridge)?)));
    let subjects = playback.and_then(|(bridge, (condition, fit))| {
        let index = bridge.inclusions.iter().position(|of| of.name == PRINTED)?;
        let of = condition.noise_by_inclusion.get(index)?;
        Some((fit, of.signal_n, of.noise_n?, of.clustered_bounds_n))
    });
    let rates = playback.and_then(|(bridge, (condition, fit))| {
        let common = fit.common.as_ref()?;
        let noise = common.noise_n;
        let each = bridge.inclusions.iter().zip(&condition.observed);
        let each = each.zip(&common.predicted);
        Some(each.map(move |((inclusion, observed), share)| (inclusion, observed, noise, *share)))
    });
    let run = Known {
        nearest: peaks.iter().min_by(|a, b| {
            let distance = |peak: f64| (peak - paper::SIGNAL).abs();
            distance(a.1).total_cmp(&distance(b.1))
        }),
        peaks: &peaks,
        needed: required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)?,
        counted,
        subjects,
        rates: rates.into_iter().flatten().collect(),
    };
    // Writing to a String does not fail.
    let words = run.render().expect("lines of text and numbers");
    let rows = words.lines().zip(run.values(level, noise)?);
    Ok(rows.filter_map(|(words, of)| row(words, of)).collect())
}

/// What the numbers of a row are, the paper's, and ours if the run has it.
type Numbers = (fn(f64) -> Value, f64, Option<f64>);

impl Known<'_> {
    /// The numbers of each row.
    fn values(
        &self,
        level: Option<f64>,
        noise: &NoiseDecomposition,
    ) -> Result<Vec<Numbers>, DetectError> {
        let [force, gamma, share]: [fn(f64) -> Value; 3] =
            [Value::ForceN, Value::Gamma, Value::Probability];
        let allowed = paper::SIGNAL / self.needed;
        let of_accuracy = gamma_from_two_afc(paper::ACCURACY_6_6)?;
        let printed = self.peaks.iter().find(|(name, _)| *name == PRINTED);
        let noise_of = |printed: f64| {
            let level = noise.levels.iter().find(|of| of.printed_n == Some(printed));
            (force, printed, level.map(|level| level.noise_n))
        };
        let of_subjects = self.subjects.map(|(_, _, noise, _)| noise);
        let to_display = self.remaining(allowed, paper::HUMAN_NOISE);
        let mut values = vec![
            (force, paper::FORCE_LEVEL, level),
            (force, paper::SIGNAL, self.nearest.map(|of| of.1)),
            (force, paper::PEAK_SIGNAL_6_6, printed.map(|of| of.1)),
            (gamma, paper::REQUIRED_GAMMA, Some(self.needed)),
            (force, paper::ALLOWED_NOISE, Some(allowed)),
            (force, paper::DISPLAY_NOISE, Some(to_display)),
            noise_of(paper::PLAYBACK_NOISE),
            noise_of(paper::DIRECT_CONTACT_NOISE),
            (
                gamma,
                paper::GAMMA_OF_ACCURACY,
                self.counted.map(|_| of_accuracy),
            ),
            (force, paper::SUBJECTS_NOISE, of_subjects),
        ];
        let rates = self.rates.iter();
        values.extend(rates.map(|(_, observed, _, here)| (share, observed.rate, Some(*here))));
        Ok(values)
    }

    /// What one source of noise leaves to the others of a `total`, N.
    fn remaining(&self, total: f64, source: f64) -> f64 {
        libm::sqrt(total * total - source * source)
    }
}

/// A row from its line of words and its numbers, if the run has ours.
fn row(words: &str, (kind, paper, here): Numbers) -> Option<Comparison> {
    let mut parts = words.splitn(4, " | ").map(String::from);
    Some(Comparison {
        quantity: parts.next()?,
        place: parts.next()?,
        paper_text: parts.next()?,
        paper: kind(paper),
        here: kind(here?),
        why: parts.next()?,
    })
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
