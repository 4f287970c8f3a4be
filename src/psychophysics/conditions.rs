//! Whether conditions differ, with the subject as block.

use serde::Serialize;

use super::rates::{Bounds, CONFIDENCE};
use super::{Condition, Inclusion, PsychophysicsError, Table};
use crate::stats::tails::student_quantile;

/// Most subjects whose exchanges of signs are all tried: a million.
const MOST_SUBJECTS: usize = 20;
/// Sums of differences this close, relative to the sum of their magnitudes, are the same sum but for rounding.
const SAME_SUM: f64 = 1e-12;

/// Two conditions, by the subjects who took part in both.
///
/// ```
/// use palpate::psychophysics::{Table, analyse};
///
/// let comparisons = analyse(&Table::paper()?)?.comparisons;
/// let (contact_fem, fem_measured) = (&comparisons[0], &comparisons[2]);
/// assert_eq!(contact_fem.first, "direct contact");
/// assert_eq!((fem_measured.first.as_str(), fem_measured.subjects), ("FEM data", 10));
/// // FEM data are felt as direct contact is, within chance; measured data are not.
/// assert!(contact_fem.p_value_holm > Some(0.05));
/// assert!(fem_measured.p_value_holm < Some(0.05));
/// # Ok::<(), palpate::psychophysics::PsychophysicsError>(())
/// ```
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
///
/// ```
/// use palpate::psychophysics::{Table, analyse};
///
/// let by_inclusion = &analyse(&Table::paper()?)?.comparisons[2].by_inclusion;
/// // FEM data less measured data at 6.6 mm: 253 and 229 of 300.
/// assert_eq!(by_inclusion[2].inclusion, "6.6");
/// assert!((by_inclusion[2].difference.mean - 24.0 / 300.0).abs() < 1e-12);
/// # Ok::<(), palpate::psychophysics::PsychophysicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InclusionDifference {
    /// The inclusion: untrusted text.
    pub inclusion: String,
    /// The difference.
    #[serde(flatten)]
    pub difference: Difference,
}

/// The rate of the first condition less that of the second, mean over subjects.
///
/// ```
/// use palpate::psychophysics::{Table, analyse};
///
/// let text = "subject,condition,trials,2.6\nA,gel,10,9\nB,gel,10,8\nA,air,10,5\nB,air,10,6\n";
/// let difference = analyse(&Table::from_csv(text, "mine.csv")?)?.comparisons[0].overall;
/// // +0.4 and +0.2: two of the four exchanges of signs lie as far from 0.
/// assert!((difference.mean - 0.3).abs() < 1e-15);
/// assert_eq!(difference.p_value, Some(0.5));
/// # Ok::<(), palpate::psychophysics::PsychophysicsError>(())
/// ```
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
/// Implements: PSY-050, PSY-051, PSY-052.
pub fn comparisons(table: &Table) -> Result<Vec<ConditionComparison>, PsychophysicsError> {
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
    inclusions: &[Inclusion],
    first: &Condition,
    second: &Condition,
) -> Result<Option<ConditionComparison>, PsychophysicsError> {
    // One row a subject in both, one column an inclusion.
    let mut differences: Vec<Vec<f64>> = Vec::new();
    for one in &first.subjects {
        let other = second.subjects.iter().find(|other| other.name == one.name);
        if let Some(other) = other {
            let share = |correct: u32, trials: u32| f64::from(correct) / f64::from(trials);
            let pairs = one.correct.iter().zip(&other.correct);
            let difference = |(&a, &b): (&u32, &u32)| share(a, one.trials) - share(b, other.trials);
            differences.push(pairs.map(difference).collect());
        }
    }
    if differences.is_empty() {
        return Ok(None);
    }
    let overall = differences
        .iter()
        .map(|row| row.iter().sum::<f64>() / inclusions.len() as f64);
    let column = |(column, inclusion): (usize, &Inclusion)| {
        let differences: Vec<f64> = differences.iter().map(|row| row[column]).collect();
        Ok(InclusionDifference {
            inclusion: inclusion.name.clone(),
            difference: difference(&differences)?,
        })
    };
    let by_inclusion = inclusions.iter().enumerate().map(column);
    Ok(Some(ConditionComparison {
        first: first.name.clone(),
        second: second.name.clone(),
        subjects: differences.len(),
        overall: difference(&overall.collect::<Vec<_>>())?,
        p_value_holm: None,
        by_inclusion: by_inclusion.collect::<Result<_, PsychophysicsError>>()?,
    }))
}

/// Implements: PSY-051.
fn difference(differences: &[f64]) -> Result<Difference, PsychophysicsError> {
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let squares = differences.iter().map(|d| (d - mean) * (d - mean));
    let spread = squares.sum::<f64>();
    let bounds = if differences.len() > 1 && spread > 0.0 {
        let error = libm::sqrt(spread / (count - 1.0) / count);
        let reach = student_quantile(CONFIDENCE, count - 1.0)? * error;
        let (lower, upper) = (mean - reach, mean + reach);
        Some(Bounds { lower, upper })
    } else {
        None
    };
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
/// Implements: PSY-052.
fn holm(p_values: &[Option<f64>]) -> Vec<Option<f64>> {
    let known = || {
        p_values
            .iter()
            .enumerate()
            .filter_map(|(at, p)| Some((at, (*p)?)))
    };
    let mut order: Vec<(usize, f64)> = known().collect();
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
