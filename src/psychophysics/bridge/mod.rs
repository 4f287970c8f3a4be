//! From force maps to shares of right answers: what the paper could not compute in 1999.
//!
//! A *convention* says what of the force a subject uses: its peak or all of the sweep, which channel,
//! and with or without the mean over the sweep, which only an observer with an absolute memory of force
//! can use. Each gives a signal in newtons for each inclusion; with noise σ, γ = signal/σ and a share
//! Φ(γ/√2) of right answers.

//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the answer, and how it is put together |
//! | `signals.rs` | a convention's signal from two maps |
//! | `common.rs` | one noise level for all subjects |
//! | `subjects.rs` | a noise level for each |
//! | `verdict.rs` | what the numbers say |

mod common;
mod signals;
mod subjects;
#[cfg(test)]
mod tests;
mod verdict;

use serde::Serialize;

use super::choice::Count;
use super::conditions::sign_flip;
use super::dispersion::{Overdispersion, overall_dispersion};
use super::noise::noise_bounds;
use super::rates::{Bounds, OpenBounds, Rate, clustered};
use super::{Condition, PsychophysicsError, Table};
use crate::force_map::{ForceMap, SAME_POSITION};
use common::{Signals, common, common_with_lapse};
pub use signals::whole_sweep;
use signals::{Signal, mean};
use subjects::{by_subject, by_subject_with_lapse};
use verdict::verdict;

/// The depth of the probe in the paper's experiments, m.
const PROBE_DEPTH: f64 = 4e-3;
/// The level at which a convention is rejected.
///
/// Implements: PSY-080.
const LEVEL: f64 = 0.05;

/// What of the sweep counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// The largest difference of force at one position, as in the paper's §5.
    Peak,
    /// The root mean square over the sweep, ‖F₁ − F₀‖ of equation (2).
    MatchedFilter,
}

/// Which force counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// The normal force alone.
    Normal,
    /// The lateral force alone.
    Lateral,
    /// Both, with the same noise.
    Both,
}

/// Whether the uniform part of the force counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Offset {
    /// The force as it is.
    Kept,
    /// Less its mean over the sweep.
    Removed,
}

/// What of the force a subject uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Convention {
    /// What of the sweep counts.
    pub statistic: Statistic,
    /// Which force counts.
    pub channel: Channel,
    /// Whether its mean counts.
    pub offset: Offset,
}

impl Convention {
    /// All twelve.
    pub fn all() -> impl Iterator<Item = Convention> {
        let of_statistic = |statistic| {
            [Channel::Normal, Channel::Lateral, Channel::Both]
                .into_iter()
                .flat_map(move |channel| {
                    [Offset::Kept, Offset::Removed].map(|offset| Convention {
                        statistic,
                        channel,
                        offset,
                    })
                })
        };
        [Statistic::Peak, Statistic::MatchedFilter]
            .into_iter()
            .flat_map(of_statistic)
    }

    /// Whether the uniform part of the normal force counts.
    pub fn uses_uniform_part(self) -> bool {
        self.channel != Channel::Lateral && self.offset == Offset::Kept
    }

    /// In words: "peak, normal force", "matched filter, both forces less their means".
    pub fn text(self) -> String {
        let statistic = match self.statistic {
            Statistic::Peak => "peak",
            Statistic::MatchedFilter => "matched filter",
        };
        let channel = match self.channel {
            Channel::Normal => "normal force",
            Channel::Lateral => "lateral force",
            Channel::Both => "both forces",
        };
        let offset = match (self.offset, self.channel) {
            (Offset::Kept, _) => "",
            (Offset::Removed, Channel::Both) => " less their means",
            (Offset::Removed, _) => " less its mean",
        };
        format!("{statistic}, {channel}{offset}")
    }
}

/// Force maps against counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bridge {
    /// The depth of the probe, m, at which forces are taken.
    #[serde(rename = "probe_depth_m")]
    pub probe_depth: f64,
    /// Why that is not the paper's 4 mm.
    pub probe_depth_note: Option<String>,
    /// Lateral positions of the sweep.
    pub positions: usize,
    /// The first of them, m.
    #[serde(rename = "from_m")]
    pub from: f64,
    /// The last, m.
    #[serde(rename = "to_m")]
    pub to: f64,
    /// The level at which a convention is rejected.
    pub level: f64,
    /// The inclusions that have a map, in the order of the table.
    pub inclusions: Vec<BridgeInclusion>,
    /// Each condition of the table against each convention.
    pub conditions: Vec<ConditionBridge>,
}

/// An inclusion with a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BridgeInclusion {
    /// Its name: untrusted text.
    pub name: String,
    /// The largest difference of the normal force, N, with its sign.
    #[serde(rename = "peak_normal_n")]
    pub peak_normal: f64,
    /// Where, m.
    #[serde(rename = "peak_normal_at_m")]
    pub peak_normal_at: f64,
    /// The mean difference of the normal force over the sweep, N.
    #[serde(rename = "mean_normal_n")]
    pub mean_normal: f64,
    /// The largest difference of the lateral force, N.
    #[serde(rename = "peak_lateral_n")]
    pub peak_lateral: f64,
    /// Where, m.
    #[serde(rename = "peak_lateral_at_m")]
    pub peak_lateral_at: f64,
}

/// One condition against all conventions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionBridge {
    /// Its name: untrusted text.
    pub name: String,
    /// The counts of all subjects at each inclusion, as observed.
    pub observed: Vec<ObservedRate>,
    /// Noise as the paper infers it, from the peak normal force at each inclusion alone.
    pub noise_by_inclusion: Vec<InclusionNoise>,
    /// The twelve conventions.
    pub conventions: Vec<ConventionFit>,
    /// What the numbers say.
    pub verdict: Verdict,
}

/// An observed share with honest intervals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ObservedRate {
    /// Right answers over pairs.
    pub rate: f64,
    /// Clopper and Pearson's interval.
    pub pooled_bounds: Bounds,
    /// With the subjects as the sample; `None` for one subject or if none differs.
    pub clustered_bounds: Option<Bounds>,
}

/// Peak normal force over the γ of one inclusion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InclusionNoise {
    /// The signal, N.
    #[serde(rename = "signal_n")]
    pub signal: f64,
    /// The noise, N; `None` if the answers set none: half or fewer right, or all right.
    #[serde(rename = "noise_n")]
    pub noise: Option<f64>,
    /// From Clopper and Pearson's interval, N; an upper end that is missing is no bound.
    #[serde(rename = "pooled_bounds_n")]
    pub pooled_bounds: OpenBounds,
    /// With the subjects as the sample, N.
    #[serde(rename = "clustered_bounds_n")]
    pub clustered_bounds: Option<OpenBounds>,
}

/// One convention against the counts of one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConventionFit {
    /// What of the force is taken to count.
    #[serde(flatten)]
    pub convention: Convention,
    /// The same in words.
    pub name: String,
    /// The signal of each inclusion, N.
    #[serde(rename = "signals_n")]
    pub signals: Vec<f64>,
    /// One noise level for all subjects; `None` if no noise level is likelier than all others.
    pub common: Option<CommonFit>,
    /// One noise level for all subjects, and answers that miss what was felt.
    pub common_with_lapse: Option<LapseFit>,
    /// A noise level for each subject.
    pub by_subject: SubjectFit,
    /// A noise level for each subject, and one share of lapses.
    pub by_subject_with_lapse: SubjectFit,
    /// Whether the subjects fit this convention worse than the best one of the condition, each with its own
    /// noise and one share of lapses: the share of all exchanges of signs of the subjects' differences of deviance
    /// with a sum as far from 0. `None` beyond 20 subjects.
    pub worse_than_best_p: Option<f64>,
    /// The larger p-value of the two fits by subject.
    pub p_value: f64,
    /// Whether that is below the level.
    pub is_rejected: bool,
}

/// One noise level for all subjects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CommonFit {
    /// The noise, N: of one position for a peak, of the filter's output otherwise.
    #[serde(rename = "noise_n")]
    pub noise: f64,
    /// With the subjects as the sample, N; `None` for one subject.
    #[serde(rename = "noise_bounds_n")]
    pub noise_bounds: Option<Bounds>,
    /// The share of right answers at each inclusion.
    pub predicted: Vec<f64>,
    /// Twice the log-likelihood that a share of its own for each inclusion gains.
    pub deviance: f64,
    /// Its degrees of freedom.
    pub degrees: u32,
    /// Its p-value with the dispersion of the condition, by the F law.
    pub p_value_dispersed: Option<f64>,
    /// The p-value of Hotelling's T² of the subjects' shares against the predicted ones, which lets the
    /// shares of a subject be correlated; `None` with too few subjects.
    pub p_value_clustered: Option<f64>,
    /// Akaike's criterion against a share of its own for each subject and inclusion.
    pub aic: f64,
}

/// One noise level for all subjects, and a share of lapses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LapseFit {
    /// The noise, N.
    #[serde(rename = "noise_n")]
    pub noise: f64,
    /// λ: right answers are ½ + (½ − λ)(2Φ(γ/√2) − 1).
    pub lapse: f64,
    /// The share of right answers at each inclusion.
    pub predicted: Vec<f64>,
    /// As in [`CommonFit`].
    pub deviance: f64,
    /// Its degrees of freedom.
    pub degrees: u32,
    /// Its p-value with the dispersion of the condition; `None` without degrees of freedom.
    pub p_value_dispersed: Option<f64>,
    /// Akaike's criterion.
    pub aic: f64,
}

/// A noise level for each subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SubjectFit {
    /// The noise of each subject, N: 0 for one who was never wrong; `None` for one who did not do better
    /// than guessing.
    #[serde(rename = "noise_n")]
    pub noise: Vec<Option<f64>>,
    /// λ, the same for all subjects; 0 if it was not fitted.
    pub lapse: f64,
    /// The mean share of right answers at each inclusion, over the pairs of all subjects.
    pub predicted: Vec<f64>,
    /// Twice the log-likelihood that a share of its own for each subject and inclusion gains.
    pub deviance: f64,
    /// The part of each subject in it.
    pub deviance_by_subject: Vec<f64>,
    /// The mean of that deviance if the fit is the truth: below the degrees of freedom where nearly all
    /// answers are right.
    pub expected_deviance: f64,
    /// Its standard deviation.
    pub deviance_sd: f64,
    /// Pr(X ≥ deviance) by the gamma law with this mean and standard deviation; 1 if no deviance is
    /// possible.
    pub p_value: f64,
    /// Akaike's criterion.
    pub aic: f64,
}

/// What the numbers say of the conventions, for one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The answer to the question which part of the force the subjects used.
    pub support: Support,
    /// The conventions that are not rejected.
    pub compatible: Vec<String>,
    /// Those that are.
    pub rejected: Vec<String>,
    /// The same in sentences, with the numbers that they rest on.
    pub text: String,
}

/// Which explanation the counts support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// Only conventions with the mean of the normal force fit.
    UniformPart,
    /// Only conventions without it fit: the change of the normal force along the sweep, or the lateral
    /// force.
    ChangeAlongSweep,
    /// Some of both fit.
    Undecided,
    /// None fits.
    None,
}

/// The counts of one condition at the inclusions that have a map.
#[derive(Debug, Clone, PartialEq)]
struct Observations {
    /// All subjects together.
    pooled: Vec<Count>,
    /// Each subject.
    subjects: Vec<Vec<Count>>,
    /// How much the subjects differ.
    dispersion: Option<Overdispersion>,
}

impl Observations {
    fn new(condition: &Condition, columns: &[usize]) -> Result<Observations, PsychophysicsError> {
        let pooled = |&column: &usize| {
            let (correct, trials) = condition.pooled(column);
            Count::new(correct as f64, trials as f64)
        };
        let inclusions = condition.subjects.first().map_or(0, |s| s.correct.len());
        Ok(Observations {
            pooled: columns.iter().map(pooled).collect(),
            subjects: condition
                .subjects
                .iter()
                .map(|subject| {
                    let count = |&column: &usize| {
                        Count::new(
                            f64::from(subject.correct[column]),
                            f64::from(subject.trials),
                        )
                    };
                    columns.iter().map(count).collect()
                })
                .collect(),
            dispersion: overall_dispersion(condition, inclusions)?.map(Overdispersion::from),
        })
    }

    /// Twice the log-likelihood that a share of its own for each inclusion gains.
    fn deviance(&self, log_likelihood: f64) -> f64 {
        let saturated: f64 = self.pooled.iter().map(|count| count.saturated()).sum();
        2.0 * (saturated - log_likelihood).max(0.0)
    }

    /// Twice the log-likelihood that a share of its own for each subject and inclusion gains.
    fn deviance_of_subjects(&self, log_likelihood: f64) -> f64 {
        let counts = self.subjects.iter().flatten();
        let saturated: f64 = counts.map(|count| count.saturated()).sum();
        2.0 * (saturated - log_likelihood).max(0.0)
    }
}

/// Maps of some inclusions of `table`, each with the name of its column, against its counts.
///
/// # Errors
/// [`PsychophysicsError`] for a name that is no column or comes twice, fewer than two maps, and a map over
/// other poses than the reference.
///
/// Implements: PSY-070, PSY-071, PSY-072, PSY-079.
pub fn bridge(
    table: &Table,
    reference: &ForceMap,
    inclusions: &[(&str, &ForceMap)],
) -> Result<Bridge, PsychophysicsError> {
    let columns = columns(table, inclusions)?;
    let map_error = |name: &str| {
        let name = name.to_string();
        move |source| PsychophysicsError::Map { name, source }
    };
    let whole_reference = whole_sweep(reference).map_err(map_error("reference"))?;
    let (probe_depth, probe_depth_note) = probe_depth(reference.depths());
    let mut signals = Vec::new();
    for &(column, map) in &columns {
        let name = &table.inclusions()[column].name;
        let signal = whole_sweep(map)
            .and_then(|map| Signal::new(&whole_reference, &map, probe_depth))
            .map_err(map_error(name))?;
        signals.push((name.as_str(), signal));
    }
    let columns: Vec<usize> = columns.iter().map(|&(column, _)| column).collect();
    let conditions = table.conditions().iter();
    let laterals = whole_reference.laterals();
    Ok(Bridge {
        probe_depth,
        probe_depth_note,
        positions: laterals.len(),
        from: laterals[0],
        to: laterals[laterals.len() - 1],
        level: LEVEL,
        inclusions: signals
            .iter()
            .map(|(name, s)| of_inclusion(name, s))
            .collect(),
        conditions: conditions
            .map(|condition| of_condition(condition, &columns, &signals))
            .collect::<Result<_, _>>()?,
    })
}

/// Each map with the column that it belongs to, in the order of the table.
fn columns<'a>(
    table: &Table,
    inclusions: &[(&str, &'a ForceMap)],
) -> Result<Vec<(usize, &'a ForceMap)>, PsychophysicsError> {
    let known = table.inclusions();
    let mut columns: Vec<(usize, &ForceMap)> = Vec::new();
    for &(name, map) in inclusions {
        let column = known.iter().position(|inclusion| inclusion.name == name);
        let column = column.ok_or_else(|| PsychophysicsError::NoSuchInclusion {
            name: name.into(),
            expected: known
                .iter()
                .map(|i| i.name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        })?;
        if columns.iter().any(|&(other, _)| other == column) {
            return Err(PsychophysicsError::Repeated { name: name.into() });
        }
        columns.push((column, map));
    }
    if columns.len() < 2 {
        return Err(PsychophysicsError::TooFewMaps {
            found: columns.len(),
        });
    }
    columns.sort_by_key(|&(column, _)| column);
    Ok(columns)
}

/// The paper's depth if the maps hold it, or else the deepest with a note.
fn probe_depth(depths: &[f64]) -> (f64, Option<String>) {
    let paper = |depth: &f64| (depth - PROBE_DEPTH).abs() <= SAME_POSITION;
    if let Some(&depth) = depths.iter().find(|depth| paper(depth)) {
        return (depth, None);
    }
    let deepest = depths.iter().copied().fold(0.0, f64::max);
    let note = format!(
        "the maps hold no depth of 4 mm, which the subjects could reach: forces are taken at their deepest, {} mm",
        deepest * 1e3
    );
    (deepest, Some(note))
}

fn of_inclusion(name: &str, signal: &Signal) -> BridgeInclusion {
    let normal = signal.peak(&signal.normal);
    let lateral = signal.peak(&signal.lateral);
    BridgeInclusion {
        name: name.into(),
        peak_normal: normal.force,
        peak_normal_at: normal.at,
        mean_normal: mean(&signal.normal),
        peak_lateral: lateral.force,
        peak_lateral_at: lateral.at,
    }
}

fn of_condition(
    condition: &Condition,
    columns: &[usize],
    signals: &[(&str, Signal)],
) -> Result<ConditionBridge, PsychophysicsError> {
    let observations = Observations::new(condition, columns)?;
    let (mut observed, mut noise_by_inclusion) = (Vec::new(), Vec::new());
    for (&column, (_, signal)) in columns.iter().zip(signals) {
        let (correct, trials) = condition.pooled(column);
        let pooled = Rate::new(correct, trials)?;
        let clustered = clustered(&condition.counts(column), &pooled)?;
        let peak = signal.peak(&signal.normal).force.abs();
        let (noise, pooled_bounds) = noise_bounds(peak, pooled.gamma);
        noise_by_inclusion.push(InclusionNoise {
            signal: peak,
            noise,
            pooled_bounds,
            clustered_bounds: clustered.map(|found| noise_bounds(peak, found.gamma).1),
        });
        observed.push(ObservedRate {
            rate: pooled.rate,
            pooled_bounds: pooled.clopper_pearson,
            clustered_bounds: clustered.map(|found| found.bounds),
        });
    }
    let conventions = fits(signals, &observations)?;
    Ok(ConditionBridge {
        name: condition.name.clone(),
        observed,
        noise_by_inclusion,
        verdict: verdict(&conventions),
        conventions,
    })
}

/// Every convention with a signal, against the counts.
fn fits(
    signals: &[(&str, Signal)],
    observed: &Observations,
) -> Result<Vec<ConventionFit>, PsychophysicsError> {
    let mut fits: Vec<ConventionFit> = Vec::new();
    for convention in Convention::all() {
        let strengths = signals
            .iter()
            .map(|(_, signal)| signal.strength(convention));
        let strengths: Vec<f64> = strengths.collect();
        if strengths.iter().all(|&strength| strength == 0.0) {
            continue;
        }
        let fit = match fits.iter().find(|fit| fit.signals == strengths) {
            // As with the mean of a lateral force, which is 0: nothing to compute again.
            Some(same) => ConventionFit {
                convention,
                name: convention.text(),
                ..same.clone()
            },
            None => fit(convention, strengths, observed)?,
        };
        fits.push(fit);
    }
    let deviance = |fit: &ConventionFit| fit.by_subject_with_lapse.deviance;
    let best = fits
        .iter()
        .min_by(|a, b| deviance(a).total_cmp(&deviance(b)));
    if let Some(best) = best.cloned() {
        for fit in &mut fits {
            fit.worse_than_best_p = told_apart(fit, &best);
        }
    }
    Ok(fits)
}

/// The p-value of two conventions' deviances being as different as they are, subjects as blocks.
///
/// Implements: PSY-079.
fn told_apart(one: &ConventionFit, other: &ConventionFit) -> Option<f64> {
    let deviances = |fit: &ConventionFit| fit.by_subject_with_lapse.deviance_by_subject.clone();
    let pairs = deviances(one).into_iter().zip(deviances(other));
    sign_flip(&pairs.map(|(one, other)| one - other).collect::<Vec<_>>())
}

fn fit(
    convention: Convention,
    strengths: Vec<f64>,
    observed: &Observations,
) -> Result<ConventionFit, PsychophysicsError> {
    let signals = Signals(strengths);
    let alone = by_subject(&signals, observed)?;
    let with_lapse = by_subject_with_lapse(&signals, observed)?;
    let p_value = alone.p_value.max(with_lapse.p_value);
    Ok(ConventionFit {
        convention,
        name: convention.text(),
        common: common(&signals, observed)?,
        common_with_lapse: common_with_lapse(&signals, observed)?,
        signals: signals.0,
        by_subject: alone,
        by_subject_with_lapse: with_lapse,
        worse_than_best_p: None,
        p_value,
        is_rejected: p_value < LEVEL,
    })
}
