//! The detector: the classes over the positions of some sweeps, and what they say of records.

use nalgebra::{DMatrix, DVector};

use super::classes::{CLASSES, Class, Covariance, Disturbances, Part, SUPPORT_ALONE};
use super::evidence::{Evidence, Signal, evidence, log_sum};
use super::gates::wrong_level;
use super::sweep::{PreparedSweep, prepared};
use super::{RobustAnswer, RobustQuestion, RobustSignal, RobustSweep};
use crate::detect::{Decision, DetectError, posterior};
use crate::force::Force;
use crate::force_map::ForceTable;
use crate::refusal::Refusal;
use crate::stats::noncentral::chi_square;
use crate::trace::design::channels;
use crate::trace::{Cause, refused};

/// A record that fits a class and hypothesis is farther from its mean with this probability.
const MISFIT_RATE: f64 = 1e-5;

/// The detector for sweeps over the same positions.
pub struct RobustDetector {
    sweeps: Vec<PreparedSweep>,
    classes: Vec<(&'static str, f64, DMatrix<f64>)>,
    signals: Vec<Signal>,
    shape: DMatrix<f64>,
}

impl RobustDetector {
    /// The detector for records over the positions of these `sweeps` over the gel of the map `without` inclusion, with `signals` that may
    /// be there.
    ///
    /// # Errors
    /// Samples outside the maps; too few samples; signals that are nothing at the samples.
    ///
    /// Implements: ROB-010, ROB-022, ROB-030, CLI-049.
    pub fn new(
        question: &RobustQuestion<'_>,
        without: &ForceTable,
        sweeps: &[RobustSweep<'_>],
        signals: &[RobustSignal],
    ) -> Result<RobustDetector, Refusal> {
        question.check()?;
        let prepare = |sweep: &RobustSweep<'_>| prepared(question, without, sweep);
        let sweeps = sweeps.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
        let disturbances: Vec<_> = (sweeps.iter())
            .map(|sweep| Disturbances::new(&sweep.modes, &sweep.undisturbed))
            .collect();
        let part = |part: &Part| {
            let sweeps: Vec<_> = disturbances.iter().map(|sweep| sweep.part(*part)).collect();
            joined(&sweeps, part.is_shared())
        };
        let parts: Vec<_> = Part::ALL.iter().map(part).collect();
        let always: Vec<_> = disturbances.iter().map(Disturbances::always).collect();
        let always = joined(&always, false);
        let class = |class: &Class| {
            let mut covariance = always.clone();
            for (part, size) in class.parts(question.known)? {
                let at = Part::ALL.iter().position(|of| *of == part)?;
                covariance += &parts[at] * (size * size);
            }
            Some((class.name, class.weight, covariance))
        };
        let alone = (signals.len() == 1).then_some(&SUPPORT_ALONE);
        let classes = CLASSES.iter().chain(alone).filter_map(class).collect();
        let shapes: Vec<_> = (disturbances.iter())
            .map(|sweep| Covariance {
                vectors: Vec::new(),
                rest: Some(sweep.shape()),
            })
            .collect();
        let shape = joined(&shapes, false);
        let signal = |signal: &RobustSignal| {
            let pairs = sweeps.iter().zip(&signal.of_sweeps);
            let modes = (pairs.clone()).map(|(sweep, series)| sweep.modes.of(channels(series)));
            let mean = modes.flat_map(|modes| modes.iter().copied().collect::<Vec<_>>());
            let mean = DVector::from_vec(mean.collect());
            let sizes = pairs.map(|(_, series)| deviation(channels(series).normal));
            let size = sizes.fold(0.0, f64::max);
            Signal {
                mean,
                size,
                log_prior: libm::log(signal.prior),
            }
        };
        let signals: Vec<Signal> = signals.iter().map(signal).collect();
        if signals.iter().all(|signal| signal.mean.amax() == 0.0) {
            return Err(refused(DetectError::NoSignal));
        }
        Ok(RobustDetector {
            sweeps,
            classes,
            signals,
            shape,
        })
    }

    /// Judges the forces of one record for each sweep.
    ///
    /// Implements: ROB-001, ROB-002, ROB-003, ROB-031, ROB-040, ROB-060.
    pub fn judge(
        &self,
        question: &RobustQuestion<'_>,
        records: &[Force<&[f64]>],
    ) -> Result<RobustAnswer, Refusal> {
        let mut answer = RobustAnswer {
            decision: None,
            causes: Vec::new(),
            theta: 0.0,
            posterior: question.prior_h1,
            thetas: Vec::new(),
            classes: Vec::new(),
            levels: Vec::new(),
            noise_sd: Vec::new(),
            glitches: Vec::new(),
        };
        let mut cleaned = Vec::new();
        for (sweep, forces) in self.sweeps.iter().zip(records) {
            match sweep.cleaned(question, *forces) {
                Ok(found) => {
                    answer.levels.push(found.level);
                    answer
                        .noise_sd
                        .push(found.noise.as_ref().map(|noise| libm::sqrt(noise.variance)));
                    answer.glitches.push(found.glitches);
                    cleaned.push(found);
                }
                Err(cause) => answer.causes.push(cause),
            }
        }
        if !answer.causes.is_empty() {
            return Ok(answer);
        }
        // A light sweep has no level of its own beside an offset: that of the heaviest stands for all.
        let weights = self.sweeps.iter().map(PreparedSweep::weight);
        let heaviest = weights
            .zip(&answer.levels)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let level = heaviest.map_or(1.0, |(_, level)| *level);
        if let Some(cause) = wrong_level(level) {
            answer.causes.push(cause);
            return Ok(answer);
        }
        let (mut record, mut noise) = (Vec::new(), Vec::new());
        for (sweep, cleaned) in self.sweeps.iter().zip(&cleaned) {
            let [amplitudes, variances] = sweep.reduced(cleaned, level);
            record.extend(amplitudes.iter());
            noise.extend(variances.iter());
        }
        let (record, noise) = (DVector::from_vec(record), DVector::from_vec(noise));
        let weighted: Vec<_> = self
            .classes
            .iter()
            .map(|(_, weight, of)| (*weight, of.clone()))
            .collect();
        let found = evidence(&record, &noise, &weighted, &self.signals, &self.shape);
        let Some(found) = found else {
            answer.causes.push(Cause::Misfit);
            return Ok(answer);
        };
        self.conclude(question, &found, record.len(), &mut answer)?;
        Ok(answer)
    }

    fn conclude(
        &self,
        question: &RobustQuestion<'_>,
        found: &Evidence,
        modes: usize,
        answer: &mut RobustAnswer,
    ) -> Result<(), Refusal> {
        let sum = |logs: &[f64]| logs.iter().copied().fold(f64::NEG_INFINITY, log_sum);
        let (none, any) = (sum(&found.without), sum(&found.by_class));
        answer.theta = any - none;
        answer.posterior = posterior(answer.theta, question.prior_h1).map_err(refused)?;
        answer.thetas = found.with.iter().map(|with| with - none).collect();
        let pairs = found.without.iter().zip(&found.by_class);
        let shares =
            pairs.map(|(without, with)| [libm::exp(without - none), libm::exp(with - any)]);
        answer.classes = self
            .classes
            .iter()
            .map(|(name, ..)| *name)
            .zip(shares)
            .collect();
        let degrees = modes as f64 - 2.0 * self.sweeps.len() as f64;
        let tail = chi_square(found.distance, degrees, 0.0);
        if tail.map_err(refused)?.upper < MISFIT_RATE {
            answer.causes.push(Cause::Misfit);
            return Ok(());
        }
        answer.decision = if answer.posterior >= question.sure {
            Some(Decision::Inclusion)
        } else if answer.posterior <= 1.0 - question.sure && !question.is_tared {
            Some(Decision::NoInclusion)
        } else {
            answer.causes.push(Cause::TooWeak);
            None
        };
        Ok(())
    }
}

/// The root mean square about the mean.
fn deviation(series: &[f64]) -> f64 {
    let count = series.len() as f64;
    let mean = series.iter().sum::<f64>() / count;
    libm::sqrt(
        series
            .iter()
            .map(|value| (value - mean) * (value - mean))
            .sum::<f64>()
            / count,
    )
}

/// The covariance of all sweeps: directions of the same number are one direction if the part `is_shared`.
pub(super) fn joined(sweeps: &[Covariance], is_shared: bool) -> DMatrix<f64> {
    let lengths: Vec<usize> = (sweeps.iter())
        .map(|of| {
            of.vectors
                .first()
                .map_or(of.rest.as_ref().map_or(0, DMatrix::nrows), DVector::len)
        })
        .collect();
    let whole = lengths.iter().sum();
    let mut covariance = DMatrix::zeros(whole, whole);
    let mut shared: Vec<DVector<f64>> = Vec::new();
    let mut start = 0;
    for (of, length) in sweeps.iter().zip(lengths) {
        if let Some(rest) = &of.rest {
            covariance
                .view_mut((start, start), (length, length))
                .copy_from(rest);
        }
        for (number, vector) in of.vectors.iter().enumerate() {
            let mut embedded = DVector::zeros(whole);
            embedded.rows_mut(start, length).copy_from(vector);
            match shared.get_mut(number).filter(|_| is_shared) {
                Some(direction) => *direction += embedded,
                None => shared.push(embedded),
            }
        }
        start += length;
    }
    for direction in shared {
        covariance.ger(1.0, &direction, &direction, 1.0);
    }
    covariance
}
