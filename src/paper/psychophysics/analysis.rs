//! Everything that a table of counts says by itself.

use serde::Serialize;

use super::beta_binomial::{BetaBinomial, beta_binomial};
use super::conditions::{ConditionComparison, comparisons};
use super::dispersion::Overdispersion;
use super::psychometric::{Psychometric, psychometric};
use super::rates::{CONFIDENCE, Clustered, Rate, pooled};
use super::{AnswerTable, Column, Condition, Result, Subject};
use palpate::stats::dispersion::{Dispersion, dispersion};

/// The analysis of a table of counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// The confidence of every interval.
    pub confidence: f64,
    /// The conditions in the order of the table.
    pub conditions: Vec<ConditionAnalysis>,
    /// Each pair of conditions with subjects in common.
    pub comparisons: Vec<ConditionComparison>,
}

/// One condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionAnalysis {
    /// Its name: untrusted text.
    pub name: String,
    /// All subjects together, at each inclusion.
    pub inclusions: Vec<InclusionAnalysis>,
    /// Each subject alone.
    pub subjects: Vec<SubjectAnalysis>,
    /// φ, χ² per degree of freedom over all inclusions; `None` where no inclusion has a χ².
    pub dispersion: Option<f64>,
    /// The degrees of freedom of φ.
    pub dispersion_degrees: u32,
    /// The share over depth; `None` with fewer than three inclusions, or if no depth differs.
    pub psychometric: Option<Psychometric>,
}

/// All subjects at one inclusion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InclusionAnalysis {
    /// Its name: untrusted text.
    pub name: String,
    /// The depth of its top, m.
    pub depth_m: f64,
    /// All answers as one sample: the paper's way.
    pub pooled: Rate,
    /// The subjects as the sample; `None` for one subject or if none differs.
    pub clustered: Option<Clustered>,
    /// Whether the subjects differ more than chance allows; `None` for one subject, or if all answers
    /// are right or all wrong.
    pub dispersion: Option<Dispersion>,
    /// The law of subjects who differ; `None` as above.
    pub beta_binomial: Option<BetaBinomial>,
}

/// One subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SubjectAnalysis {
    /// The name: untrusted text.
    pub name: String,
    /// The share at each inclusion.
    pub rates: Vec<Rate>,
}

/// The analysis of a table.
///
/// # Errors
/// Never for counts that fit their trials, as an [`AnswerTable`] holds them.
pub fn analyse(table: &AnswerTable) -> Result<Analysis> {
    let conditions = table.conditions().iter();
    let conditions = conditions.map(|condition| analyse_condition(table, condition));
    Ok(Analysis {
        confidence: CONFIDENCE,
        conditions: conditions.collect::<Result<_>>()?,
        comparisons: comparisons(table)?,
    })
}

fn analyse_condition(table: &AnswerTable, condition: &Condition) -> Result<ConditionAnalysis> {
    let inclusion = |(column, inclusion): (usize, &Column)| {
        let counts = condition.counts(column);
        let (pooled, clustered) = pooled(condition, column)?;
        Ok(InclusionAnalysis {
            name: inclusion.name.clone(),
            depth_m: inclusion.depth,
            pooled,
            clustered,
            dispersion: dispersion(&counts)?,
            beta_binomial: beta_binomial(&counts)?,
        })
    };
    let inclusions = table.inclusions().iter().enumerate().map(inclusion);
    let subject = |subject: &Subject| {
        let rate = |&correct| Rate::new(u64::from(correct), u64::from(subject.trials));
        Ok(SubjectAnalysis {
            name: subject.name.clone(),
            rates: subject.correct.iter().map(rate).collect::<Result<_, _>>()?,
        })
    };
    let subjects = condition.subjects.iter().map(subject);
    let dispersion = Overdispersion::new(condition, table.inclusions().len())?;
    Ok(ConditionAnalysis {
        name: condition.name.clone(),
        inclusions: inclusions.collect::<Result<_>>()?,
        subjects: subjects.collect::<Result<_>>()?,
        dispersion: dispersion.map(|found| found.ratio),
        dispersion_degrees: dispersion.map_or(0, |found| found.degrees),
        psychometric: psychometric(table.inclusions(), condition, dispersion)?,
    })
}
