//! What is known of a record, and what is asked of it.

use super::design::Unknown;
use crate::force::Force;

/// What the threshold must achieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Criterion {
    /// The fewest errors for the prior.
    Map,
    /// At most this rate of misses, with the fewest false alarms.
    NeymanPearsonMiss {
        /// The largest rate of misses.
        max_miss: f64,
    },
    /// At most this rate of false alarms, with the fewest misses.
    NeymanPearsonFalseAlarm {
        /// The largest rate of false alarms.
        max_false_alarm: f64,
    },
}

/// What is known of a record, and what is asked: does the gel under its sweep hold an inclusion?
#[derive(Debug, Clone, Copy)]
pub struct Question<'a> {
    /// Depth of the sweep, m.
    pub depth: f64,
    /// The true depth is within so much of it, m, unless it is unknown; 0 if it is exact.
    pub depth_tolerance: f64,
    /// What is not known of the sweep.
    pub unknown: &'a [Unknown],
    /// The noise on its forces.
    pub noise: Noise,
    /// What the threshold must achieve.
    pub criterion: Criterion,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
}

/// What is known of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of a sample of either force, N; none if it is to be estimated from the record.
    pub sd: Option<Force<f64>>,
    /// Which samples are independent.
    pub correlation: Correlation,
}

/// How far apart two samples are whose noise is independent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Correlation {
    /// The noise is white: any two.
    None,
    /// To be estimated from the record.
    OfRecord,
    /// So many samples count as one, as estimated from a blank sweep.
    Known(f64),
}

impl Question<'_> {
    pub(crate) fn is_unknown(&self, what: Unknown) -> bool {
        self.unknown.contains(&what)
    }
}
