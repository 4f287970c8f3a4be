//! The detector: the classes over the positions of some sweeps, and what they say of records.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::classes::{CLASSES, Class, Covariance, Disturbances, Part, SUPPORT_ALONE, SharedBy};
use super::evidence::{Evidence, Factors, Signal, WeightedClass, evidence};
use super::sweep::{Cleaned, PreparedSweep, prepared};
use super::{RobustAnswer, RobustQuestion, RobustSignal, RobustSweep, channels};
use crate::detect::{Decision, DetectError, ErrorRates, error_rates, map_threshold, posterior};
use crate::force::Force;
use crate::force_map::ForceTable;
use crate::refusal::Refusal;
use crate::stats::noncentral::chi_square;
use crate::trace::contact::wrong_level;
use crate::trace::{Cause, MUCH_LIKELIER, is_none, refused};

/// A record that fits a class and hypothesis is farther from its mean with this probability.
pub const MISFIT_RATE: f64 = 1e-5;
/// The largest magnitude of a force, N: fourth powers of such, and their sums, are far from overflow.
///
/// Implements: ROB-008.
const LARGEST: f64 = 1e20;
/// A sweep whose mean force is this share of the heaviest one's has a level of its own.
const HEAVY: f64 = 0.75;
/// A record allows a class with a posterior above this.
const ALLOWED: f64 = 0.01;

/// The detector for sweeps over the same positions.
pub struct RobustDetector<'a> {
    question: RobustQuestion<'a>,
    pub(super) sweeps: Vec<PreparedSweep>,
    classes: Vec<Class>,
    pub(super) weighted: Vec<WeightedClass>,
    pub(super) signals: Vec<Signal>,
    pub(super) shape: DMatrix<f64>,
    /// The amplitudes that count, of those of all modes of all sweeps.
    pub(super) counted: Vec<usize>,
    is_exchanged: bool,
}

impl<'a> RobustDetector<'a> {
    /// The detector for records over the positions of these `sweeps` over the gel of the map `without` inclusion, with `signals` that may
    /// be there.
    ///
    /// # Errors
    /// Samples outside the maps; too few samples; signals that are nothing at the samples.
    ///
    /// Implements: ROB-010, ROB-030, CLI-049.
    pub fn new(
        question: RobustQuestion<'a>,
        without: &ForceTable,
        sweeps: &[RobustSweep<'_>],
        signals: &[RobustSignal],
    ) -> Result<RobustDetector<'a>, Refusal> {
        question.check()?;
        let is_exchanged = is_exchanged(sweeps, signals);
        // Sweeps of a reference file are of one place, which is no other's.
        let place = |sweep: &RobustSweep<'_>| {
            let is_of = |other: &RobustSweep<'_>| other.record.file() == sweep.record.file();
            let first = sweeps.iter().position(is_of).filter(|_| sweep.is_reference);
            first.map_or(0, |first| 1 + first)
        };
        let places: Vec<usize> = sweeps.iter().map(place).collect();
        let prepare = |(sweep, place): (&RobustSweep<'_>, &usize)| {
            let of_place = sweeps.iter().zip(&places).filter(|(_, of)| *of == place);
            let extents = of_place.filter_map(|(sweep, _)| sweep.record.place());
            let extent = extents.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
            prepared(&question, without, sweep, extent)
        };
        let file = sweeps.first().map_or("", |sweep| sweep.record.file());
        let prepared = sweeps.iter().zip(&places).map(prepare);
        let sweeps = prepared.collect::<Result<Vec<_>, _>>()?;
        let disturbances: Vec<_> = (sweeps.iter())
            .map(|sweep| Disturbances::new(&sweep.modes, &sweep.undisturbed))
            .collect();
        let alone = (signals.len() == 1).then_some(&SUPPORT_ALONE);
        let all = CLASSES.iter().chain(alone);
        let (classes, mut weighted) = weighted(all, question.known, &disturbances, &places);
        let shape = |(sweep, place): (&Disturbances<'_>, &usize)| Covariance {
            vectors: Vec::new(),
            rest: sweep.shape() * f64::from(*place == 0),
        };
        let shapes: Vec<_> = disturbances.iter().zip(&places).map(shape).collect();
        let mut shape = joined(&shapes, |sweep| sweep);
        let mut signals: Vec<Signal> = signals.iter().map(|of| in_modes(of, &sweeps)).collect();
        let counts = sweeps.iter().flat_map(PreparedSweep::counted);
        let counted: Vec<usize> = counts
            .enumerate()
            .filter_map(|(at, is)| is.then_some(at))
            .collect();
        if counted.len() < shape.nrows() {
            (weighted, signals, shape) = of_rows(&counted, &weighted, &signals, &shape);
        }
        if signals.iter().all(|signal| signal.mean.amax() == 0.0) {
            return Err(refused(DetectError::NoSignal).in_file(file));
        }
        drop(disturbances);
        Ok(RobustDetector {
            question,
            sweeps,
            classes,
            weighted,
            signals,
            shape,
            counted,
            is_exchanged,
        })
    }

    /// Judges the forces of one record for each sweep.
    ///
    /// Implements: ROB-003, ROB-004, ROB-009, ROB-031, ROB-060.
    ///
    /// # Errors
    /// A record with lateral forces where the sweep has none, or the other way round; a force beyond 10²⁰ N, or that is not finite.
    pub fn judge(&self, records: &[Force<&[f64]>]) -> Result<RobustAnswer, Refusal> {
        self.check(records)?;
        let mut answer = RobustAnswer {
            posterior: self.question.prior_h1,
            ..RobustAnswer::default()
        };
        let cleaned = self.cleaned(records, &mut answer);
        if !answer.causes.is_empty() {
            // One for each sweep, or none.
            (answer.levels, answer.noise_sd, answer.glitches) = Default::default();
            return Ok(answer);
        }
        let level = self.level(&answer.levels);
        if let Some(cause) = self.wrong_level(&answer.levels) {
            answer.causes.push(cause);
            return Ok(answer);
        }
        let [record, noise] = self.reduced(&cleaned, level);
        let has_lateral = self.sweeps.iter().any(|sweep| sweep.has_lateral);
        let alone = match has_lateral {
            true => self.theta_of_normal([&record, &noise]),
            false => None,
        };
        let favours_one = alone.is_some_and(|theta| theta >= 0.0);
        // With a low prior the answer may be "no inclusion" though the record favours one.
        let may_be_none = !favours_one || self.question.prior_h1 < 0.5;
        let turned = (has_lateral && may_be_none).then(|| {
            let turned: Vec<Cleaned> = cleaned.iter().map(Cleaned::turned).collect();
            let [turned, _] = self.reduced(&turned, level);
            turned
        });
        let found = self.evidence(&record, turned.as_ref(), &noise);
        let Some((found, is_likelier_turned, factors)) = found else {
            answer.causes.push(Cause::Misfit);
            return Ok(answer);
        };
        let is_noisier = cleaned.iter().any(|of| of.is_noisier);
        self.conclude(&found, &factors, is_noisier, &mut answer)?;
        if has_lateral {
            answer.is_none_doubtful = favours_one || is_likelier_turned;
            // The prior contradicts no channel.
            let sure = libm::log(self.question.sure / (1.0 - self.question.sure));
            let favours_none = |theta: f64| theta <= -sure;
            let is_hidden = is_likelier_turned || favours_one && favours_none(answer.theta);
            let is_contradicted = match answer.decision {
                Some(Decision::Inclusion) => alone.is_some_and(favours_none),
                other => is_none(other, &answer.causes) && is_hidden,
            };
            if is_contradicted {
                answer.decision = None;
                answer.causes.push(Cause::Channels);
            }
        }
        answer.explanation = self.explanation(cleaned, level, [&record, &noise], &answer);
        if self.is_exchanged {
            answer.decision = None;
            answer.causes.insert(0, Cause::Exchanged);
        }
        Ok(answer)
    }

    /// Refuses other channels than those of the sweeps, and forces that are too large.
    ///
    /// Implements: ROB-005, ROB-008.
    fn check(&self, records: &[Force<&[f64]>]) -> Result<(), Refusal> {
        for (sweep, record) in self.sweeps.iter().zip(records) {
            let other = Refusal::state("the record has other channels than the sweep", "");
            other.when(sweep.has_lateral == record.lateral.is_empty())?;
            let mut forces = record.lateral.iter().chain(record.normal);
            // NaN is in no range.
            let wrong = forces.find(|force| !(-LARGEST..=LARGEST).contains(*force));
            if let Some(force) = wrong {
                let right = "at most 1e20 N in magnitude";
                return Err(Refusal::value("force", format!("{force:?}"), right));
            }
        }
        Ok(())
    }

    /// The records without glitches, of which `answer` gets level, noise and glitches, or the causes why they cannot be judged.
    ///
    /// Implements: ROB-001, ROB-002, ROB-007, ROB-011, ROB-081.
    fn cleaned(&self, records: &[Force<&[f64]>], answer: &mut RobustAnswer) -> Vec<Cleaned> {
        let pairs = || self.sweeps.iter().zip(records);
        let raw = pairs().map(|(sweep, record)| sweep.level(&self.question, record.normal));
        let mut each = self.each_cleaned(records, self.level(&raw.collect::<Vec<_>>()));
        let levels: Vec<f64> = each.iter().flatten().map(|of| of.level).collect();
        if levels.len() == each.len() && each.iter().flatten().any(|of| of.glitches > 0) {
            // A glitch is no part of the level that stands for all.
            each = self.each_cleaned(records, self.level(&levels));
        }
        let mut all = Vec::new();
        for ((sweep, record), cleaned) in pairs().zip(each) {
            let in_air = sweep.in_air(&self.question, record.normal, cleaned.as_ref().ok());
            answer.in_air.push(in_air);
            match cleaned {
                Ok(cleaned) if in_air == [0; 2] => {
                    let Force { lateral, normal } = cleaned
                        .noise
                        .as_ref()
                        .map(|noise| Some(libm::sqrt(noise.variance)));
                    let lateral = lateral.filter(|_| sweep.has_lateral);
                    answer.levels.push(cleaned.level);
                    answer.noise_sd.push(Force { lateral, normal });
                    answer.glitches.push(cleaned.glitches);
                    all.push(cleaned);
                }
                other => {
                    let cause = other.err().filter(|_| in_air == [0; 2]);
                    let cause = cause.unwrap_or(Cause::InAir);
                    if !answer.causes.contains(&cause) {
                        answer.causes.push(cause);
                    }
                }
            }
        }
        all
    }

    /// Each record without its glitches, or why it cannot be judged, by the level that stands for all.
    fn each_cleaned(&self, records: &[Force<&[f64]>], level: f64) -> Vec<Result<Cleaned, Cause>> {
        let pairs = self.sweeps.iter().zip(records);
        pairs
            .map(|(sweep, forces)| sweep.cleaned(&self.question, *forces, level))
            .collect()
    }

    /// The level of the sweep with the largest forces, which stands for all: that of a light one hides behind its offset.
    fn level(&self, levels: &[f64]) -> f64 {
        let weights = self.sweeps.iter().map(PreparedSweep::weight);
        let pairs = weights.zip(levels);
        let heaviest = pairs.max_by(|a, b| a.0.total_cmp(&b.0));
        heaviest.map_or(1.0, |(_, level)| *level)
    }

    /// What is wrong with the level of a sweep that is about as heavy as the heaviest: an offset hides that of a light one.
    ///
    /// Implements: ROB-003.
    fn wrong_level(&self, levels: &[f64]) -> Option<Cause> {
        let weights = || self.sweeps.iter().map(PreparedSweep::weight);
        let heaviest = weights().fold(f64::NEG_INFINITY, f64::max);
        let mut heavy = weights()
            .zip(levels)
            .filter(|(weight, _)| *weight >= HEAVY * heaviest);
        heavy.find_map(|(_, level)| wrong_level(*level))
    }

    /// The evidence of the record, and whether it would be much likelier as the record `turned`, with the other sign of its lateral forces.
    ///
    /// Implements: ROB-009.
    fn evidence(
        &self,
        record: &DVector<f64>,
        turned: Option<&DVector<f64>>,
        noise: &DVector<f64>,
    ) -> Option<(Evidence, bool, Factors)> {
        let (classes, signals, shape) = (&self.weighted, &self.signals, &self.shape);
        let Some(turned) = turned else {
            let ([found], factors) = evidence([record], noise, classes, signals, shape)?;
            return Some((found, false, factors));
        };
        let found = evidence([record, turned], noise, classes, signals, shape);
        let ([found, turned], factors) = found?;
        let is_likelier = turned.total() > found.total() + MUCH_LIKELIER;
        Some((found, is_likelier, factors))
    }

    /// The amplitudes of the records that count, and the variances of their noise.
    fn reduced(&self, cleaned: &[Cleaned], level: f64) -> [DVector<f64>; 2] {
        let pairs = self.sweeps.iter().zip(cleaned);
        let each: Vec<_> = pairs.map(|(sweep, of)| sweep.reduced(of, level)).collect();
        [0, 1].map(|at| {
            let all: Vec<f64> = each.iter().flat_map(|of| of[at].iter()).copied().collect();
            DVector::from_vec(all).select_rows(&self.counted)
        })
    }

    fn conclude(
        &self,
        found: &Evidence,
        factors: &[Cholesky<f64, Dyn>],
        is_noisier: bool,
        answer: &mut RobustAnswer,
    ) -> Result<(), Refusal> {
        let question = &self.question;
        let [none, any] = found.totals();
        answer.theta = any - none;
        answer.posterior = posterior(answer.theta, question.prior_h1).map_err(refused)?;
        answer.thetas = found.with.iter().map(|with| with - none).collect();
        let pairs = found.without.iter().zip(&found.by_class);
        let shares =
            pairs.map(|(without, with)| [libm::exp(without - none), libm::exp(with - any)]);
        answer.classes = self.classes.iter().copied().zip(shares).collect();
        answer.rates = self.rates(factors, answer)?;
        let degrees = self.counted.len() as f64 - 2.0 * self.sweeps.len() as f64;
        let tail = chi_square(found.distance, degrees, 0.0);
        if is_noisier || tail.map_err(refused)?.upper < MISFIT_RATE {
            answer.causes.push(Cause::Misfit);
            return Ok(());
        }
        answer.decision = if answer.posterior >= question.sure {
            Some(Decision::Inclusion)
        } else if answer.posterior > 1.0 - question.sure {
            answer.causes.push(Cause::TooWeak);
            None
        } else if question.is_zeroed {
            answer.causes.push(Cause::Zeroed);
            None
        } else {
            Some(Decision::NoInclusion)
        };
        Ok(())
    }

    /// θ by the normal forces alone, if they have a likelihood.
    ///
    /// Implements: ROB-009.
    fn theta_of_normal(&self, [record, noise]: [&DVector<f64>; 2]) -> Option<f64> {
        let modes = self.sweeps.iter().map(|sweep| sweep.modes.count());
        let is_normal = modes.flat_map(|count| (0..2 * count).map(move |mode| mode >= count));
        let is_normal: Vec<bool> = is_normal.collect();
        let rows = (0..self.counted.len()).filter(|&row| is_normal[self.counted[row]]);
        let rows: Vec<usize> = rows.collect();
        let (classes, signals, shape) = of_rows(&rows, &self.weighted, &self.signals, &self.shape);
        let [record, noise] = [record, noise].map(|of| of.select_rows(&rows));
        let ([found], _) = evidence([&record], &noise, &classes, &signals, &shape)?;
        let [none, any] = found.totals();
        Some(any - none)
    }

    /// γ of signal number `signal` beside each class, in white noise of a standard deviation, N: the signal-to-noise ratio if the
    /// class is the right one.
    ///
    /// Implements: ROB-045.
    pub fn gammas(&self, signal: usize, noise_sd: Force<f64>) -> Vec<(Class, f64)> {
        let variance = |sweep: &PreparedSweep| {
            let each = noise_sd
                .into_array()
                .map(|sd| vec![sd * sd; sweep.modes.count()]);
            each.concat()
        };
        let noise: Vec<f64> = self.sweeps.iter().flat_map(variance).collect();
        let noise = DVector::from_vec(noise).select_rows(&self.counted);
        let noise = DMatrix::from_diagonal(&noise);
        let signal = &self.signals[signal].mean;
        let gamma = |of: &WeightedClass| {
            // A class without a density has no record either.
            let factor = (&of.covariance + &noise).cholesky();
            factor.map_or(0.0, |factor| gamma(&factor, signal))
        };
        let gammas = self.weighted.iter().map(gamma);
        self.classes.iter().copied().zip(gammas).collect()
    }

    /// The signal with the largest posterior of the `answer`.
    pub(super) fn likeliest_signal(&self, answer: &RobustAnswer) -> Option<&Signal> {
        let log = |(signal, theta): &(&Signal, &f64)| signal.log_prior + *theta;
        let all = self.signals.iter().zip(&answer.thetas);
        let likeliest = all.max_by(|a, b| log(a).total_cmp(&log(b)));
        likeliest.map(|(signal, _)| signal)
    }

    /// The largest rates of the two wrong answers over the classes that the record allows, for its likeliest signal.
    ///
    /// Implements: ROB-046.
    fn rates(
        &self,
        factors: &[Cholesky<f64, Dyn>],
        answer: &RobustAnswer,
    ) -> Result<Option<ErrorRates>, Refusal> {
        let Some(signal) = self.likeliest_signal(answer) else {
            return Ok(None);
        };
        let odds = libm::log(self.question.sure / (1.0 - self.question.sure));
        let prior = map_threshold(self.question.prior_h1).map_err(refused)?;
        let mut largest = ErrorRates {
            false_alarm: 0.0,
            miss: 0.0,
        };
        for ((_, [without, with]), factor) in answer.classes.iter().zip(factors) {
            let gamma = gamma(factor, &signal.mean);
            let at = |eta: f64| error_rates(gamma, eta).map_err(refused);
            if *without > ALLOWED {
                largest.false_alarm = largest.false_alarm.max(at(prior + odds)?.false_alarm);
            }
            if *with > ALLOWED {
                largest.miss = largest.miss.max(at(prior - odds)?.miss);
            }
        }
        Ok(Some(largest))
    }
}

/// The classes, the signals and the covariance of their shape in some of their amplitudes.
fn of_rows(
    rows: &[usize],
    classes: &[WeightedClass],
    signals: &[Signal],
    shape: &DMatrix<f64>,
) -> (Vec<WeightedClass>, Vec<Signal>, DMatrix<f64>) {
    let cut = |of: &DMatrix<f64>| of.select_rows(rows).select_columns(rows);
    let classes = classes.iter().map(|class| WeightedClass {
        covariance: cut(&class.covariance),
        ..*class
    });
    let signals = signals.iter().map(|signal| Signal {
        mean: signal.mean.select_rows(rows),
        ..*signal
    });
    (classes.collect(), signals.collect(), cut(shape))
}

/// γ of a signal in noise of a factorised covariance.
fn gamma(factor: &Cholesky<f64, Dyn>, signal: &DVector<f64>) -> f64 {
    libm::sqrt(factor.solve(signal).dot(signal))
}

/// Whether the maps are exchanged: the forces with the inclusion are smaller, and no phantom says that the reference has none.
///
/// Implements: ROB-004.
fn is_exchanged(sweeps: &[RobustSweep<'_>], signals: &[RobustSignal]) -> bool {
    let normal = |of: &RobustSignal| -> f64 {
        let sweeps = of.of_sweeps.iter();
        sweeps.flat_map(|series| channels(series).normal).sum()
    };
    let is_measured = sweeps.iter().all(|sweep| sweep.changes.is_none());
    is_measured && signals.len() == 1 && normal(&signals[0]) < 0.0
}

/// The classes that count beside what is `known`, with their covariances in all sweeps.
///
/// Implements: ROB-022, ROB-030, ROB-033, ROB-050.
fn weighted<'c>(
    classes: impl Iterator<Item = &'c Class>,
    known: &[Part],
    disturbances: &[Disturbances<'_>],
    places: &[usize],
) -> (Vec<Class>, Vec<WeightedClass>) {
    let joined_of = |part: Part| {
        let sweeps: Vec<_> = disturbances.iter().map(|sweep| sweep.part(part)).collect();
        joined(&sweeps, |sweep| match part.shared_by() {
            SharedBy::None => sweep,
            SharedBy::Place => places[sweep],
            SharedBy::Gel => 0,
        })
    };
    let mut parts: BTreeMap<Part, DMatrix<f64>> = BTreeMap::new();
    let always: Vec<_> = disturbances.iter().map(Disturbances::always).collect();
    let always = joined(&always, |sweep| sweep);
    let class = |class: &Class| {
        let mut covariance = always.clone();
        for (part, size) in class.parts(known)? {
            let part = parts.entry(part).or_insert_with(|| joined_of(part));
            covariance += &*part * (size * size);
        }
        let weight = class.weight;
        Some((class.beside(known), WeightedClass { weight, covariance }))
    };
    classes.filter_map(class).unzip()
}

/// A signal in the modes of all sweeps.
fn in_modes(signal: &RobustSignal, sweeps: &[PreparedSweep]) -> Signal {
    let pairs = sweeps.iter().zip(&signal.of_sweeps);
    let modes = (pairs.clone()).map(|(sweep, series)| sweep.modes.of(channels(series)));
    let mean = modes.flat_map(|modes| modes.iter().copied().collect::<Vec<_>>());
    let sizes = pairs.map(|(_, series)| deviation(channels(series).normal));
    Signal {
        mean: DVector::from_vec(mean.collect()),
        size: sizes.fold(0.0, f64::max),
        amplitude_sd: signal.amplitude_sd,
        log_prior: libm::log(signal.prior),
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

/// The covariance of all sweeps: directions of the same number are one direction in sweeps of one group.
pub(super) fn joined(sweeps: &[Covariance], group: impl Fn(usize) -> usize) -> DMatrix<f64> {
    let whole = sweeps.iter().map(|of| of.rest.nrows()).sum();
    let mut covariance = DMatrix::zeros(whole, whole);
    let mut directions: BTreeMap<(usize, usize), DVector<f64>> = BTreeMap::new();
    let mut start = 0;
    for (sweep, of) in sweeps.iter().enumerate() {
        let length = of.rest.nrows();
        let mut own = covariance.view_mut((start, start), (length, length));
        own.copy_from(&of.rest);
        for (number, vector) in of.vectors.iter().enumerate() {
            let direction = directions.entry((group(sweep), number));
            let direction = direction.or_insert_with(|| DVector::zeros(whole));
            direction.rows_mut(start, length).add_assign(vector);
        }
        start += length;
    }
    for direction in directions.values() {
        covariance.ger(1.0, direction, direction, 1.0);
    }
    covariance
}
