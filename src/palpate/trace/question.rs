//! What is known of a record, and asked of it.

use std::fmt;

use serde::Serialize;

use super::{Cause, Fit};
use crate::detect::Decision;
use crate::detect::nuisance::NoiseLevel;
use crate::force::Force;

/// What the threshold must achieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Criterion {
    /// The fewest errors for the prior.
    MaximumAPosteriori,
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
    /// Depth of the sweep, m, where the samples have none of their own.
    pub depth: f64,
    /// The true depth is within so much of it, or of all depths of the samples alike, m, unless it is unknown; 0 if it is exact.
    pub depth_tolerance: f64,
    /// Whether the sensor was set to zero on the gel, so that its forces say nothing of contact.
    pub is_zeroed: bool,
    /// What is not known of the sweep.
    pub unknown: &'a [Unknown],
    /// The noise on its forces.
    pub noise: Noise,
    /// What the threshold must achieve.
    pub criterion: Criterion,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
}

/// The fewest samples of a record whose noise is estimated.
///
/// Implements: TRC-068, ROB-003.
pub const LEAST_SAMPLES: usize = 20;

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

/// What may be unknown of a sweep.
///
/// Implements: TRC-060.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Unknown {
    /// A constant force in each channel.
    Offset,
    /// A force in each channel that grows with the sample, from one end of the record to the other.
    Drift,
    /// The stiffness of the whole gel: the forces without inclusion times any number.
    Gain,
    /// The depth of the sweep, to first order about the one that is stated.
    Depth,
    /// The standard deviation of the noise.
    Variance,
}

impl Unknown {
    /// All of them.
    pub const ALL: [Unknown; 5] = {
        use Unknown::{Depth, Drift, Gain, Offset, Variance};
        [Offset, Drift, Gain, Depth, Variance]
    };
}

/// Its name on the command line and in JSON.
impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// Names with commas, or "nothing".
pub fn in_words(unknown: &[Unknown]) -> String {
    let names: Vec<_> = unknown.iter().map(Unknown::to_string).collect();
    match names[..] {
        [] => "nothing".into(),
        _ => names.join(", "),
    }
}

impl Question<'_> {
    pub(crate) fn is_unknown(&self, what: Unknown) -> bool {
        self.unknown.contains(&what)
    }

    /// Whether the depth is known, but not exactly.
    ///
    /// Implements: TRC-064.
    pub fn has_depth_tolerance(&self) -> bool {
        self.depth_tolerance > 0.0 && !self.is_unknown(Unknown::Depth)
    }

    /// The decision of a record that fits so, or why it cannot be judged.
    ///
    /// Implements: TRC-075, TRC-016.
    pub(crate) fn verdict(&self, decision: Decision, fit: &Fit) -> (Option<Decision>, Vec<Cause>) {
        let mut causes = fit.causes();
        if causes.is_empty() && self.is_zeroed && decision == Decision::NoInclusion {
            causes.push(Cause::Zeroed);
        }
        (causes.is_empty().then_some(decision), causes)
    }

    pub(crate) fn noise_level(&self) -> NoiseLevel {
        if self.is_unknown(Unknown::Variance) {
            NoiseLevel::Unknown
        } else {
            NoiseLevel::Known
        }
    }
}
