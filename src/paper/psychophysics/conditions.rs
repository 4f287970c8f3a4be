//! Whether conditions differ, with the subject as block.

use std::ops::Range;

use serde::Serialize;

use super::rates::{Bounds, CONFIDENCE};
use super::{AnswerTable, Column, Condition, Result, Subject};
use palpate::stats::noncentral::student_point;

/// Most subjects whose exchanges of signs are all tried: a million.
const MOST_SUBJECTS: usize = 20;
/// Sums of differences this close, relative to the sum of their magnitudes, are the same sum but for rounding.
const SAME_SUM: f64 = 1e-12;

/// Two conditions, by the subjects who took part in both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionComparison {
    /// The first condition.
    pub first: String,
    /// The second.
    pub second: String,
    /// The subjects in both.
    pub subjects: usize,
    /// The mean over the inclusions.
    pub overall: Difference,
    /// The p-value of `overall` after Holm's correction for the number of comparisons.
    pub p_value_holm: Option<f64>,
    /// Each inclusion alone, without correction.
    pub by_inclusion: Vec<InclusionDifference>,
}

/// The difference at one inclusion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InclusionDifference {
    /// The inclusion: untrusted text.
    pub inclusion: String,
    /// The difference.
    #[serde(flatten)]
    pub difference: Difference,
}

/// The rate of the first condition less that of the second, mean over subjects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// The mean difference.
    pub mean: f64,
    /// Student's interval, subjects as the sample; `None` if it has no width.
    pub bounds: Option<Bounds>,
    /// The share of all 2^m exchanges of signs with a mean as far from 0: exact if, without a
    /// difference, each subject's could as well have the other sign. `None` beyond 20 subjects.
    pub p_value: Option<f64>,
}

/// Each pair of conditions that have subjects in common.
///
/// # Errors
/// Never for counts that fit their trials.
///
/// Implements: PSY-050.
pub fn comparisons(table: &AnswerTable) -> Result<Vec<ConditionComparison>> {
    let conditions = table.conditions();
    let mut found = Vec::new();
    for (at, first) in conditions.iter().enumerate() {
        for second in &conditions[at + 1..] {
            found.extend(compare(table.inclusions(), first, second)?);
        }
    }
    let p_values: Vec<Option<f64>> = found.iter().map(|found| found.overall.p_value).collect();
    for (found, p_value) in found.iter_mut().zip(holm(&p_values)) {
        found.p_value_holm = p_value;
    }
    Ok(found)
}

/// `None` without a subject in both.
fn compare(
    inclusions: &[Column],
    first: &Condition,
    second: &Condition,
) -> Result<Option<ConditionComparison>> {
    let in_both = first.subjects.iter().filter_map(|one| {
        let mut others = second.subjects.iter();
        Some([one, others.find(|other| other.name == one.name)?])
    });
    let in_both: Vec<[&Subject; 2]> = in_both.collect();
    if in_both.is_empty() {
        return Ok(None);
    }
    // One row a subject in both, one column an inclusion.
    let row = |[one, other]: &[&Subject; 2]| {
        let pairs = one.shares().zip(other.shares());
        pairs.map(|(a, b)| a - b).collect()
    };
    let differences: Vec<Vec<f64>> = in_both.iter().map(row).collect();
    let overall = differences
        .iter()
        .map(|row| row.iter().sum::<f64>() / inclusions.len() as f64);
    let column = |(column, inclusion): (usize, &Column)| {
        let differences: Vec<f64> = differences.iter().map(|row| row[column]).collect();
        let do_vary = do_vary(&in_both, column..column + 1);
        Ok(InclusionDifference {
            inclusion: inclusion.name.clone(),
            difference: difference(&differences, do_vary)?,
        })
    };
    let by_inclusion = inclusions.iter().enumerate().map(column);
    Ok(Some(ConditionComparison {
        first: first.name.clone(),
        second: second.name.clone(),
        subjects: differences.len(),
        overall: difference(
            &overall.collect::<Vec<_>>(),
            do_vary(&in_both, 0..inclusions.len()),
        )?,
        p_value_holm: None,
        by_inclusion: by_inclusion.collect::<Result<_>>()?,
    }))
}

/// Whether the difference between two conditions in the share of right answers to some inclusions is another for one subject than for
/// another; in whole numbers, since differences of quotients are rounded.
///
/// Implements: PSY-050.
fn do_vary(in_both: &[[&Subject; 2]], columns: Range<usize>) -> bool {
    let fraction = |of: &[&Subject; 2]| {
        let right = |of: &Subject| -> i128 {
            let counts = of.correct[columns.clone()].iter();
            counts.map(|&k| i128::from(k)).sum()
        };
        let [own_right, other_right] = of.map(right);
        let [trials, other_trials] = of.map(|of| i128::from(of.trials));
        let numerator = own_right * other_trials - other_right * trials;
        (numerator, trials * other_trials)
    };
    let fractions: Vec<_> = in_both.iter().map(fraction).collect();
    let mut pairs = fractions.windows(2);
    pairs.any(|of| of[0].0 * of[1].1 != of[1].0 * of[0].1)
}

/// The mean of the differences of several subjects, with an interval if they vary.
///
/// Implements: PSY-050.
fn difference(differences: &[f64], do_vary: bool) -> Result<Difference> {
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let squares = differences.iter().map(|d| (d - mean) * (d - mean));
    let spread = squares.sum::<f64>();
    let mut bounds = None;
    if do_vary {
        let error = libm::sqrt(spread / (count - 1.0) / count);
        let reach = student_point(0.5 * (1.0 - CONFIDENCE), count - 1.0)? * error;
        let (lower, upper) = (mean - reach, mean + reach);
        bounds = Some(Bounds { lower, upper });
    }
    Ok(Difference {
        mean,
        bounds,
        p_value: sign_flip(differences),
    })
}

/// The share of the 2^m ways to give signs to the differences whose sum is at least as far from 0 as that of
/// the differences themselves; `None` beyond 20 differences.
///
/// Implements: PSY-050.
pub fn sign_flip(differences: &[f64]) -> Option<f64> {
    if differences.len() > MOST_SUBJECTS {
        return None;
    }
    let mut sums = vec![0.0];
    for difference in differences {
        let minus: Vec<f64> = sums.iter().map(|sum| sum - difference).collect();
        for sum in &mut sums {
            *sum += difference;
        }
        sums.extend(minus);
    }
    // The first sum has every difference with its own sign.
    let magnitudes: f64 = differences.iter().map(|d| d.abs()).sum();
    let observed = sums[0].abs() - SAME_SUM * magnitudes;
    let as_far = sums.iter().filter(|sum| sum.abs() >= observed).count();
    Some(as_far as f64 / sums.len() as f64)
}

/// Holm's correction: the k-th smallest of n p-values times n − k + 1, made increasing, at most 1.
///
/// Implements: PSY-050.
fn holm(p_values: &[Option<f64>]) -> Vec<Option<f64>> {
    let known = p_values.iter().enumerate();
    let mut order: Vec<(usize, f64)> = known.filter_map(|(at, p)| Some((at, (*p)?))).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut corrected = vec![None; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, &(at, p)) in order.iter().enumerate() {
        largest = largest.max(p * (order.len() - rank) as f64).min(1.0);
        corrected[at] = Some(largest);
    }
    corrected
}

#[cfg(test)]
mod tests;
