//! From force maps to shares of right answers: what the paper could not compute in 1999.
//!
//! A *convention* says what of the force a subject uses: its peak or all of the sweep, which channel,
//! and with or without the mean over the sweep, which only an observer with an absolute memory of force
//! can use. Each gives a signal in newtons for each inclusion; with noise σ, γ = signal/σ and a share
//! Φ(γ/√2) of right answers.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | how the answer is put together |
//! | `answer.rs` | conventions, and all that is said of them |
//! | `signals.rs` | a convention's signal from two maps |
//! | `common.rs` | one noise level for all subjects |
//! | `subjects.rs` | a noise level for each |
//! | `weights.rs` | how much of the level may count, over sweeps of other widths |
//! | `verdict.rs` | what the numbers say |

mod answer;
mod common;
mod signals;
mod subjects;
#[cfg(test)]
mod tests;
mod verdict;
mod weights;

pub use answer::{
    Bridge, BridgeInclusion, Channel, CommonFit, ConditionBridge, Convention, ConventionFit,
    InclusionNoise, LapseFit, ObservedRate, Offset, Statistic, SubjectFit, Support, Verdict,
    WeightFit, WeightRange,
};
pub use signals::whole_sweep;

use super::choice::Count;
use super::conditions::sign_flip;
use super::dispersion::{Overdispersion, overall_dispersion};
use super::noise::noise_bounds;
use super::rates::{Rate, clustered};
use super::{Condition, PsychophysicsError, Table};
use crate::force_map::{ForceMap, SAME_POSITION};
use crate::refusal::Refusal;
use common::{Signals, common, common_with_lapse};
use signals::{Signal, mean};
use subjects::{by_subject, by_subject_with_lapse};
use verdict::verdict;
use weights::{STATISTICS, half_sweeps, weight_ranges};

/// The depth of the probe in the paper's experiments, m.
const PROBE_DEPTH: f64 = 4e-3;
/// The level at which a convention is rejected.
///
/// Implements: PSY-080.
const LEVEL: f64 = 0.05;

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
/// Implements: PSY-070, PSY-071, PSY-072, PSY-079, PSY-085.
pub fn bridge(
    table: &Table,
    reference: &ForceMap,
    inclusions: &[(&str, &ForceMap)],
) -> Result<Bridge, PsychophysicsError> {
    let columns = columns(table, inclusions)?;
    let map_error = |name: &str| {
        let name = name.to_string();
        move |refusal: Refusal| {
            let source = refusal.into();
            PsychophysicsError::Map { name, source }
        }
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
    let half_sweeps = half_sweeps(laterals);
    let ranges = conditions.len() * half_sweeps.len() * STATISTICS.len();
    Ok(Bridge {
        probe_depth,
        probe_depth_note,
        positions: laterals.len(),
        from: laterals[0],
        to: laterals[laterals.len() - 1],
        level: LEVEL,
        weight_ranges: ranges,
        inclusions: signals
            .iter()
            .map(|(name, s)| of_inclusion(name, s))
            .collect(),
        conditions: conditions
            .map(|condition| of_condition(condition, &columns, &signals, (&half_sweeps, ranges)))
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
    (half_sweeps, ranges): (&[f64], usize),
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
    let level = LEVEL / ranges as f64;
    let weights = weight_ranges(signals, &observations, half_sweeps, level)?;
    Ok(ConditionBridge {
        name: condition.name.clone(),
        observed,
        noise_by_inclusion,
        verdict: verdict(&conventions, &weights, ranges),
        conventions,
        weights,
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
