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
    Favoured, LapseFit, Mean, ObservedRate, Statistic, SubjectFit, Verdict, WeightFit, WeightRange,
};

use std::collections::BTreeMap;

use super::choice::Count;
use super::conditions::sign_flip;
use super::dispersion::Overdispersion;
use super::noise::InclusionNoise;
use super::rates::pooled;
use super::{AnswerTable, Condition, Result};
use common::{Signals, common, common_with_lapse};
use palpate::force_map::{ForceMap, SAME_POSITION, peak};
use palpate::refusal::Refusal;
use signals::{Signal, sweep};
use subjects::{by_subject, by_subject_with_lapse};
use verdict::verdict;
use weights::{STATISTICS, half_sweeps, weight_ranges};

/// The depth of the probe in the paper's experiments, m.
const PROBE_DEPTH: f64 = 4e-3;
/// The level at which a convention is rejected.
///
/// Implements: PSY-080.
pub const LEVEL: f64 = 0.05;

/// The counts of one condition at the inclusions that have a map.
#[derive(Debug, Clone, PartialEq)]
struct Observations {
    /// All subjects together.
    pooled: Vec<Count>,
    /// Each subject.
    subjects: Vec<Vec<Count>>,
    /// How much the subjects differ, over all inclusions of the table.
    dispersion: Option<Overdispersion>,
}

impl Observations {
    fn new(condition: &Condition, columns: &[usize]) -> Result<Observations> {
        let inclusions = condition.subjects.first().map_or(0, |s| s.correct.len());
        let subjects = condition.subjects.iter().map(|subject| {
            let count = |&j: &usize| Count::new(subject.correct[j].into(), subject.trials.into());
            columns.iter().map(count).collect()
        });
        Ok(Observations {
            pooled: columns
                .iter()
                .map(|&j| Count::pooled(condition, j))
                .collect(),
            subjects: subjects.collect(),
            dispersion: Overdispersion::new(condition, inclusions)?,
        })
    }
}

/// Maps of some inclusions of `table`, each with the name of its column, against its counts; over the part of the sweep within
/// `half_sweep`, m, of x = 0, if that is given.
///
/// # Errors
/// A name that is no column or comes twice, fewer than two maps or positions within the sweep, and a map over other poses than the
/// reference.
///
/// Implements: PSY-070, PSY-079, PSY-085, CLI-081.
pub fn bridge(
    table: &AnswerTable,
    reference: &ForceMap,
    inclusions: &[(&str, &ForceMap)],
    half_sweep: Option<f64>,
) -> Result<Bridge> {
    let (columns, signals) = signals(table, reference, inclusions, half_sweep)?;
    let (probe_depth, is_paper_depth) = probe_depth(reference.table().depths());
    let laterals = &signals[0].laterals;
    let half_sweeps = half_sweeps(laterals);
    let conditions = table.conditions().iter();
    let ranges = conditions.len() * half_sweeps.len() * STATISTICS.len();
    let conditions = conditions
        .map(|condition| of_condition(condition, &columns, &signals, (&half_sweeps, ranges)));
    let of_inclusion = |(&column, signal): (&usize, &Signal)| {
        signal.of_inclusion(table.inclusions()[column].name.clone())
    };
    Ok(Bridge {
        probe_depth_m: probe_depth,
        probe_depth_note: (!is_paper_depth).then(|| {
            format!(
                "the maps hold no depth of 4 mm, which the subjects could reach: forces are taken at their deepest, {} mm",
                probe_depth * 1e3
            )
        }),
        positions: laterals.len(),
        from_m: laterals[0],
        to_m: laterals[laterals.len() - 1],
        level: LEVEL,
        weight_ranges: ranges,
        inclusions: columns.iter().zip(&signals).map(of_inclusion).collect(),
        conditions: conditions.collect::<Result<_, _>>()?,
    })
}

/// The p-value of each convention, in the order of [`Convention::all`], for the counts of the condition with a number: as
/// [`bridge`], without all that is said beside.
///
/// # Errors
/// As [`bridge`]; a condition that the table does not have, and a convention whose signal is 0 at all inclusions.
///
/// Implements: STU-031.
pub fn p_values(
    table: &AnswerTable,
    condition: usize,
    reference: &ForceMap,
    inclusions: &[(&str, &ForceMap)],
) -> Result<Vec<f64>> {
    let (columns, signals) = signals(table, reference, inclusions, None)?;
    let missing = || Refusal::state(format!("condition {condition} is not in the table"), "");
    let condition = table.conditions().get(condition).ok_or_else(missing)?;
    let observed = Observations::new(condition, &columns)?;
    let p_value = |convention: Convention| {
        let none = || Refusal::state(format!("no signal by the {}", convention.text()), "");
        let signals = Signals::new(&signals, |signal| signal.strength(convention));
        let (_, _, p_value) = by_subjects(&signals.ok_or_else(none)?, &observed)?;
        Ok(p_value)
    };
    Convention::all().map(p_value).collect()
}

/// A noise level for each subject, without lapses and with, and the larger p-value of the two.
fn by_subjects(
    signals: &Signals,
    observed: &Observations,
) -> Result<(SubjectFit, SubjectFit, f64)> {
    let plain = by_subject(signals, observed)?;
    let with_lapse = by_subject_with_lapse(signals, observed, &plain)?;
    let p_value = plain.p_value.max(with_lapse.p_value);
    Ok((plain, with_lapse, p_value))
}

/// The columns that the maps belong to, in the order of the table, and the signal of each.
fn signals(
    table: &AnswerTable,
    reference: &ForceMap,
    inclusions: &[(&str, &ForceMap)],
    half_sweep: Option<f64>,
) -> Result<(Vec<usize>, Vec<Signal>)> {
    let known: Vec<&str> = table.inclusions().iter().map(|of| &of.name[..]).collect();
    let mut maps = BTreeMap::new();
    for &(name, map) in inclusions {
        let Some(column) = known.iter().position(|known| *known == name) else {
            let found = format!("inclusion {name:?} is no column of the table");
            let expected = format!("give one of {}", known.join(", "));
            return Err(Refusal::state(found, expected));
        };
        if maps.insert(column, map).is_some() {
            let found = format!("inclusion {name:?} has two maps");
            return Err(Refusal::state(found, "give one"));
        }
    }
    if maps.len() < 2 {
        let found = format!("inclusions with a map: {}", maps.len());
        return Err(Refusal::state(found, "give at least two"));
    }
    let reference = sweep(reference, half_sweep).map_err(|error| error.in_file("reference"))?;
    let (depth, _) = probe_depth(reference.table().depths());
    let signal = |(column, map)| {
        let signal = sweep(map, half_sweep).and_then(|map| Signal::new(&reference, &map, depth));
        let of_map = |error: Refusal| error.in_file(format!("inclusion {}", known[column]));
        Ok((column, signal.map_err(of_map)?))
    };
    maps.into_iter().map(signal).collect()
}

/// The depth of the probe, m, at which forces are taken, and whether it is the paper's 4 mm; else the deepest.
///
/// Implements: REP-002.
pub fn probe_depth(depths: &[f64]) -> (f64, bool) {
    let paper = |depth: &&f64| (**depth - PROBE_DEPTH).abs() <= SAME_POSITION;
    match depths.iter().find(paper) {
        Some(&depth) => (depth, true),
        None => (depths.iter().copied().fold(0.0, f64::max), false),
    }
}

fn of_condition(
    condition: &Condition,
    columns: &[usize],
    signals: &[Signal],
    (half_sweeps, ranges): (&[f64], usize),
) -> Result<ConditionBridge> {
    let observations = Observations::new(condition, columns)?;
    let (mut observed, mut noise_by_inclusion) = (Vec::new(), Vec::new());
    for (&column, signal) in columns.iter().zip(signals) {
        let (pooled, clustered) = pooled(condition, column)?;
        let (peak, _) = peak(&signal.laterals, &signal.forces.normal);
        noise_by_inclusion.push(InclusionNoise::new(peak.abs(), &pooled, clustered));
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
fn fits(signals: &[Signal], observed: &Observations) -> Result<Vec<ConventionFit>> {
    let mut fits: Vec<ConventionFit> = Vec::new();
    for convention in Convention::all() {
        let Some(signals) = Signals::new(signals, |signal| signal.strength(convention)) else {
            continue;
        };
        let fit = match fits.iter().find(|fit| fit.signals_n == signals.0) {
            // As with the mean of a lateral force, which is 0: nothing to compute again.
            Some(same) => ConventionFit {
                convention,
                name: convention.text(),
                ..same.clone()
            },
            None => fit(convention, signals, observed)?,
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
    let [one, other] = [one, other].map(|fit| &fit.by_subject_with_lapse.deviance_by_subject);
    let differences = one.iter().zip(other).map(|(one, other)| one - other);
    sign_flip(&differences.collect::<Vec<_>>())
}

fn fit(convention: Convention, signals: Signals, observed: &Observations) -> Result<ConventionFit> {
    let (by_subject, by_subject_with_lapse, p_value) = by_subjects(&signals, observed)?;
    Ok(ConventionFit {
        convention,
        name: convention.text(),
        common: common(&signals, observed)?,
        common_with_lapse: common_with_lapse(&signals, observed)?,
        signals_n: signals.0,
        by_subject,
        by_subject_with_lapse,
        worse_than_best_p: None,
        p_value,
        is_rejected: p_value < LEVEL,
    })
}
