//! The answer at the position that the maps are for.

use super::cause::Cause;
use super::design::{Design, depth_error, difference, expected, squares};
use super::fit::{Fit, MISFIT_RATE};
use super::question::{Criterion, Question};
use super::{Record, refused};
use crate::detect::nuisance::{Nuisances, SubspaceDetector, SubspaceTest, Threshold};
use crate::detect::{Decision, DetectError, ErrorRates, map_threshold, posterior};
use crate::force_map::{ForceTable, Hypotheses};
use crate::refusal::Refusal;

/// The answer at the position that the maps are for.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Ĥ; none if the record cannot be judged.
    pub decision: Option<Decision>,
    /// Why not.
    pub causes: Vec<Cause>,
    /// T with its law, where there is one.
    pub test: SubspaceTest,
    /// The T that are of an inclusion.
    pub threshold: Threshold,
    /// Pr(H = 1 | record).
    pub posterior: f64,
    /// The rates of error are at most these.
    pub rates: ErrorRates,
    /// γ of all samples if nothing were unknown and the noise white.
    pub gamma_nominal: f64,
    /// How well the record fits.
    pub fit: Fit,
}

/// A θ from which on one of two hypotheses is a thousand times as likely as the other.
pub const MUCH_LIKELIER: f64 = 6.907_755_278_982_137;

/// Whether the answer is that there is no inclusion, or would be if the sensor had not been set to zero on the gel.
///
/// Implements: TRC-077.
pub fn is_none(decision: Option<Decision>, causes: &[Cause]) -> bool {
    decision == Some(Decision::NoInclusion) || causes == [Cause::Zeroed]
}

/// Whether T is too large for none, and too small for the inclusion.
///
/// Implements: TRC-075.
fn fits_neither(test: &SubspaceTest) -> Result<bool, DetectError> {
    let ErrorRates { false_alarm, miss } = test.rates(Threshold::At(test.t))?;
    Ok(f64::max(false_alarm, miss) < 0.5 * MISFIT_RATE)
}

impl Record {
    /// Whether `theta` of this record makes an inclusion much likelier than none, once the record is without its lateral forces, or with
    /// the other sign of what they have beside those of the map `without` inclusion, at `depth` (m).
    ///
    /// # Errors
    /// As [`Record::expected`].
    ///
    /// Implements: TRC-077.
    pub(crate) fn hides_inclusion(
        &self,
        without: &ForceTable,
        depth: f64,
        theta: impl Fn(&Record) -> Result<f64, Refusal>,
    ) -> Result<bool, Refusal> {
        if self.forces().lateral.is_empty() {
            return Ok(false);
        }
        let expected = self.expected(without, depth)?.lateral;
        let mut turned = self.clone();
        for (force, expected) in turned.forces.lateral.iter_mut().zip(expected) {
            *force = 2.0 * expected - *force;
        }
        let mut others = [turned, self.clone().normal_alone()].into_iter();
        // One that cannot be judged so says nothing.
        Ok(others.any(|other| theta(&other).is_ok_and(|theta| theta >= MUCH_LIKELIER)))
    }
}

impl Question<'_> {
    /// The parts of a design over the noise of a sample, and how well they fit.
    pub(crate) fn fitted(&self, design: &Design) -> Result<(Design, Fit), DetectError> {
        let noise_sd = match self.noise.sd {
            Some(sd) => sd,
            None => design.noise_sd()?,
        };
        let white = design.whitened(noise_sd);
        let fit = Fit::new(self, design, &white, noise_sd)?;
        Ok((white, fit))
    }

    /// Judges `record` for the inclusion of one map, where that map has it.
    ///
    /// # Errors
    /// Positions or a depth outside the maps; maps that do not differ at the samples but by what is unknown; whatever the
    /// detector refuses.
    ///
    /// Implements: TRC-008, TRC-077, CLI-049.
    pub fn judge(&self, hypotheses: Hypotheses<'_>, record: &Record) -> Result<Judgement, Refusal> {
        let mut found = self.judge_as_recorded(hypotheses, record)?;
        let theta = |other: &Record| Ok(self.judge_as_recorded(hypotheses, other)?.test.theta());
        if is_none(found.decision, &found.causes)
            && found.test.theta() < MUCH_LIKELIER
            && record.hides_inclusion(hypotheses.without(), self.depth, theta)?
        {
            found.decision = None;
            found.causes.push(Cause::Channels);
        }
        Ok(found)
    }

    /// As [`Question::judge`], of lateral forces that are what they are said to be.
    ///
    /// Implements: TRC-065, TRC-060, CLI-043.
    fn judge_as_recorded(
        &self,
        hypotheses: Hypotheses<'_>,
        record: &Record,
    ) -> Result<Judgement, Refusal> {
        let mut design = Design::new(self, hypotheses.without(), record)?;
        let f1 = expected(record, hypotheses.with(), self.depth)?;
        design.template = difference(&f1, &design.reference);
        let error = depth_error(self, hypotheses.with(), record)?;
        design.depth_errors.extend(error);
        let judged = || {
            let (white, fit) = self.fitted(&design)?;
            let (mut signals, mut template) = (white.signals(false), white.template.clone());
            let nuisances = Nuisances::new(&mut signals, template.len())?;
            let detector = SubspaceDetector::new(nuisances, &mut template)?;
            let statistic = detector.statistic(&mut white.residual.clone())?;
            let test = statistic.test(self.noise_level(), white.bias(&detector)?)?;
            let threshold = self.threshold(&test)?;
            let (mut decision, mut causes) = self.verdict(threshold.decide(test.t), &fit);
            if is_none(decision, &causes) && fits_neither(&test)? {
                decision = None;
                causes.insert(0, Cause::Misfit);
            }
            Ok(Judgement {
                decision,
                causes,
                test,
                threshold,
                posterior: posterior(test.theta(), self.prior_h1)?,
                rates: test.rates(threshold)?,
                gamma_nominal: libm::sqrt(squares(&white.template)),
                fit,
            })
        };
        judged().map_err(|error| refused(error).in_file(record.file()))
    }

    /// The T from which on the record is of an inclusion.
    ///
    /// Implements: TRC-065.
    fn threshold(&self, test: &SubspaceTest) -> Result<Threshold, DetectError> {
        Ok(match self.criterion {
            Criterion::MaximumAPosteriori => test.bayes_threshold(map_threshold(self.prior_h1)?)?,
            Criterion::NeymanPearsonMiss { max_miss } => {
                Threshold::At(test.miss_threshold(max_miss)?)
            }
            Criterion::NeymanPearsonFalseAlarm { max_false_alarm } => {
                Threshold::At(test.false_alarm_threshold(max_false_alarm)?)
            }
        })
    }
}
