//! Conventions, and all that is said of them.

use serde::Serialize;

use crate::psychophysics::noise::InclusionNoise;
use crate::psychophysics::rates::Bounds;

/// What of the sweep counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// The largest difference of force at one position, as in the paper's §5.
    Peak,
    /// The root mean square over the sweep, ‖F₁ − F₀‖ of equation (2).
    MatchedFilter,
}

impl Statistic {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Statistic::Peak => "peak",
            Statistic::MatchedFilter => "matched filter",
        }
    }
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
pub enum Mean {
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
    #[serde(rename = "offset")]
    pub mean: Mean,
}

impl Convention {
    /// All twelve.
    pub fn all() -> impl Iterator<Item = Convention> {
        (0..12).map(|k| Convention {
            statistic: [Statistic::Peak, Statistic::MatchedFilter][k / 6],
            channel: [Channel::Normal, Channel::Lateral, Channel::Both][k / 2 % 3],
            mean: [Mean::Kept, Mean::Removed][k % 2],
        })
    }

    /// Whether the uniform part of the normal force counts.
    pub fn uses_uniform_part(self) -> bool {
        self.channel != Channel::Lateral && self.mean == Mean::Kept
    }

    /// In words: "peak, normal force", "matched filter, both forces less their means".
    pub fn text(self) -> String {
        let statistic = self.statistic.text();
        let channel = match self.channel {
            Channel::Normal => "normal force",
            Channel::Lateral => "lateral force",
            Channel::Both => "both forces",
        };
        let mean = match (self.mean, self.channel) {
            (Mean::Kept, _) => "",
            (Mean::Removed, Channel::Both) => " less their means",
            (Mean::Removed, _) => " less its mean",
        };
        format!("{statistic}, {channel}{mean}")
    }
}

/// Force maps against counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bridge {
    /// The depth of the probe, m, at which forces are taken.
    pub probe_depth_m: f64,
    /// Why that is not the paper's 4 mm.
    pub probe_depth_note: Option<String>,
    /// Lateral positions of the sweep.
    pub positions: usize,
    /// The first of them, m.
    pub from_m: f64,
    /// The last, m.
    pub to_m: f64,
    /// The level at which a convention is rejected.
    pub level: f64,
    /// The number of ranges of the weight of the force's level, by which that is divided for each of them.
    pub weight_ranges: usize,
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
    pub peak_normal_n: f64,
    /// Where, m.
    pub peak_normal_at_m: f64,
    /// The mean difference of the normal force over the sweep, N.
    pub mean_normal_n: f64,
    /// The largest difference of the lateral force, N.
    pub peak_lateral_n: f64,
    /// Where, m.
    pub peak_lateral_at_m: f64,
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
    /// Which weights of the level of the normal force the counts leave, for each sweep and statistic.
    pub weights: Vec<WeightRange>,
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

/// One convention against the counts of one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConventionFit {
    /// What of the force is taken to count.
    #[serde(flatten)]
    pub convention: Convention,
    /// The same in words.
    pub name: String,
    /// The signal of each inclusion, N.
    pub signals_n: Vec<f64>,
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

impl ConventionFit {
    /// The fit by subject with the larger p-value.
    pub fn better_by_subject(&self) -> &SubjectFit {
        if self.by_subject_with_lapse.p_value > self.by_subject.p_value {
            &self.by_subject_with_lapse
        } else {
            &self.by_subject
        }
    }
}

/// One noise level for all subjects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CommonFit {
    /// The noise, N: of one position for a peak, of the filter's output otherwise.
    pub noise_n: f64,
    /// With the subjects as the sample, N; `None` for one subject or if none differs.
    pub noise_bounds_n: Option<Bounds>,
    /// The share of right answers at each inclusion.
    pub predicted: Vec<f64>,
    /// Twice the log-likelihood that a share of its own for each inclusion gains.
    pub deviance: f64,
    /// Its degrees of freedom.
    pub degrees: u32,
    /// Its p-value with the dispersion of the condition, by the F law.
    pub p_value_dispersed: Option<f64>,
    /// The p-value of Hotelling's T² of the subjects' shares against the predicted ones, which lets the
    /// shares of a subject be correlated; `None` with too few subjects or if none differs at an inclusion.
    pub p_value_clustered: Option<f64>,
    /// Akaike's criterion against a share of its own for each subject and inclusion.
    pub aic: f64,
}

/// One noise level for all subjects, and a share of lapses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LapseFit {
    /// The noise, N.
    pub noise_n: f64,
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
    pub noise_n: Vec<Option<f64>>,
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

/// The weights that the level of the normal force may have over one sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeightRange {
    /// Half of the sweep, m.
    pub half_sweep_m: f64,
    /// What of the sweep counts.
    pub statistic: Statistic,
    /// The smallest and the largest weight, on a grid of 0.05, that the corrected level does not reject.
    pub left: Bounds,
    /// φ: the deviance at the best weight over the one expected there, at least 1.
    pub dispersion: f64,
    /// The weight that fits best.
    pub best_weight: f64,
    /// The level counts as it is: weight 1; `None` without a level.
    pub whole_level: Option<WeightFit>,
    /// It does not count: weight 0; `None` if the normal force does not change along the sweep.
    pub no_level: Option<WeightFit>,
    /// The lateral force instead; `None` if there is none.
    pub lateral: Option<WeightFit>,
    /// Which of the last three has the largest deviance.
    pub fits_worst: Option<Convention>,
}

impl WeightRange {
    /// Whether the normal force with its whole level has the largest deviance.
    pub fn level_fits_worst(&self) -> bool {
        self.fits_worst.is_some_and(Convention::uses_uniform_part)
    }
}

/// A noise level for each subject, without lapses, where the mean of the force over the sweep counts by its weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeightFit {
    /// The weight.
    pub weight: f64,
    /// As in [`SubjectFit`].
    pub deviance: f64,
    /// As in [`SubjectFit`].
    pub expected_deviance: f64,
    /// Inclusions less one, for each subject.
    pub degrees: u32,
    /// As in [`SubjectFit`]: the answers of a subject are taken as binomial.
    pub p_value: f64,
    /// That of the deviance above the best weight's, with φ, by the F law; `None` without degrees of freedom for φ, and for the
    /// lateral force.
    pub p_value_dispersed: Option<f64>,
}

/// What the numbers say of the conventions, for one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The answer to the question which part of the force the subjects used.
    pub support: Favoured,
    /// The conventions that are not rejected.
    pub compatible: Vec<String>,
    /// Those that are.
    pub rejected: Vec<String>,
    /// What holds over sweeps of all widths, with the number of ranges and the dispersion counted; `None` where the maps are
    /// too narrow for it.
    pub survives: Option<String>,
    /// What holds over the sweep of the maps in sentences, with the numbers that they rest on.
    pub text: String,
}

/// Which explanation the counts support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Favoured {
    /// Only conventions with the mean of the normal force are not rejected.
    UniformPart,
    /// Only conventions without it are not: the change of the normal force along the sweep, or the
    /// lateral force.
    ChangeAlongSweep,
    /// Some of both fit.
    Undecided,
    /// None fits.
    None,
}
