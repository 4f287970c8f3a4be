//! Whether conditions differ, with the subject as block.

use serde::Serialize;

use super::rates::Bounds;

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
    pub by_inclusion: Vec<Difference>,
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
