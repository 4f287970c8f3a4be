//! A recorded sweep against a bank: is there an inclusion, and where?

use super::Bank;
use super::axis::signal_at;
use super::detector::BankDetector;
use super::information::PlaceBound;
use super::place::PlacePosterior;
use super::rates::{CalibratedThreshold, false_alarm_bound, false_alarm_threshold};
use crate::detect::nuisance::{NoiseLevel, SubspaceTest};
use crate::detect::{Decision, DetectError, decide, map_threshold, posterior};
use crate::force::Force;
use crate::force_map::ForceMap;
use crate::refusal::Refusal;
use crate::text::extremes;
use crate::trace::contact::{is_narrow, radius};
use crate::trace::design::{Design, depth_error, difference, expected, squares};
use crate::trace::{Cause, Criterion, Fit, MUCH_LIKELIER, Question, Record, is_none, refused};

/// A search for the inclusion of a bank in records.
///
/// Implements: BNK-060.
#[derive(Debug, Clone, Copy)]
pub struct BankSearch<'a> {
    /// What is known of the record.
    pub question: Question<'a>,
    /// What may be there.
    pub bank: &'a Bank,
    /// The probability of each of the bank's maps, given an inclusion; none if all are equally probable.
    pub prior: Option<&'a [f64]>,
    /// How many records to simulate, and their seed, for the threshold for a rate of false alarms; none for the bound.
    pub simulations: Option<(u64, u64)>,
}

/// What a search says.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// Ĥ; none if the record cannot be judged.
    pub decision: Option<Decision>,
    /// Why not.
    pub causes: Vec<Cause>,
    /// The likeliest point of the bank, in the order of [`super::Parameter::ALL`].
    pub point: [f64; 4],
    /// T with its law there.
    pub test: SubspaceTest,
    /// Θ_max.
    pub theta_max: f64,
    /// ln of the likelihood ratio of an inclusion at any point.
    pub theta_mixture: f64,
    /// What decides.
    pub threshold: SearchThreshold,
    /// Pr(H = 1 | record), by the mixture.
    pub posterior: f64,
    /// Where it lies, and what it is, if there is one.
    pub place: PlacePosterior,
    /// How well that can be known, at the estimate.
    pub bound: PlaceBound,
    /// γ at the estimate of all samples if nothing were unknown and the noise white.
    pub gamma_nominal: f64,
    /// How well the record fits with the inclusion there.
    pub fit: Fit,
}

/// The threshold of a search, and what it promises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchThreshold {
    /// The threshold of Θ_max, or of the mixture.
    pub eta: f64,
    /// Whether the mixture is compared with η, and not Θ_max.
    pub by_mixture: bool,
    /// The threshold by simulation, if it was asked for.
    pub calibrated: Option<CalibratedThreshold>,
    /// The false-alarm rate is at most this.
    pub false_alarm_bound: f64,
    /// The miss rate for an inclusion at the likeliest point is at most this.
    pub miss_bound: f64,
}

impl BankSearch<'_> {
    /// Searches `record`.
    ///
    /// # Errors
    /// A depth other than the bank's; positions outside it; a prior of another length; maps that differ by what is unknown alone;
    /// whatever the detector refuses.
    ///
    /// Implements: TRC-077.
    pub fn locate(&self, record: &Record) -> Result<Location, Refusal> {
        let mut found = self.locate_as_recorded(record)?;
        let mut search = *self;
        search.question.criterion = Criterion::MaximumAPosteriori;
        let theta = |other: &Record| Ok(search.locate_as_recorded(other)?.theta_mixture);
        let (without, depth) = (self.bank.reference().table(), self.question.depth);
        if is_none(found.decision, &found.causes)
            && found.theta_mixture < MUCH_LIKELIER
            && record.hides_inclusion(without, depth, theta)?
        {
            found.decision = None;
            found.causes.push(Cause::Channels);
        }
        Ok(found)
    }

    /// As [`BankSearch::locate`], of lateral forces that are what they are said to be.
    ///
    /// Implements: BNK-060, BNK-033, BNK-034, TRC-075.
    fn locate_as_recorded(&self, record: &Record) -> Result<Location, Refusal> {
        let located = || {
            let (question, depth) = (&self.question, self.question.depth);
            if record.depths().is_none() {
                self.bank.check_depth(depth)?;
            }
            let mut design = Design::new(question, self.bank.reference().table(), record)?;
            let f0 = expected(record, self.bank.base(), depth)?;
            let signal = |map: &ForceMap| {
                let f1 = expected(record, map.table(), depth)?;
                Ok(difference(&f1, &f0))
            };
            let signals = self.bank.maps().iter().map(signal);
            let signals = signals.collect::<Result<Vec<_>, Refusal>>()?;
            let error = |map: &ForceMap| depth_error(question, map.table(), record);
            let errors = self.bank.maps().iter().map(error);
            let errors = errors.collect::<Result<Vec<_>, Refusal>>()?;
            // First where it probably lies, which does not depend on the level of the noise, so that its signal is not taken for noise.
            let noise_sd = question.noise.sd.unwrap_or(Force::new(1.0, 1.0));
            let mut white = design.whitened(noise_sd);
            let detector = self.detector(&white, &signals, noise_sd, NoiseLevel::Known)?;
            let statistic = detector.statistic(&mut white.residual).map_err(refused)?;
            let at = detector.place(&statistic).estimate;
            let sample = |map: usize, sample: usize| signals[map][sample];
            design.template = signal_at(self.bank.axes(), at, signals[0].len(), sample);
            let (mut white, fit) = question.fitted(&design).map_err(refused)?;
            let level = question.noise_level();
            // Nothing is over that of a force that is not there.
            let noise_sd = fit.noise_sd.map(|sd| sd.unwrap_or(1.0));
            let mut detector = self.detector(&white, &signals, noise_sd, level)?;
            for (point, error) in errors.iter().enumerate() {
                if let Some(error) = error {
                    let error = white.over_noise(error, noise_sd);
                    detector.add_bias(point, &error).map_err(refused)?;
                }
            }
            let mut found = self.judge(&detector, &mut white, fit)?;
            let radius = radius(self.bank.reference());
            let [first, last] = extremes(record.positions().iter().copied()).unwrap_or_default();
            if is_narrow(last - first, radius) {
                found.decision = None;
                found.causes.insert(0, Cause::Narrow);
            }
            Ok(found)
        };
        located().map_err(|refusal: Refusal| refusal.in_file(record.file()))
    }

    /// The detector of the `signals` of all maps, N, beside the nuisances of a record whose parts over `noise_sd` are
    /// `white`.
    fn detector(
        &self,
        white: &Design,
        signals: &[Vec<f64>],
        noise_sd: Force<f64>,
        level: NoiseLevel,
    ) -> Result<BankDetector, Refusal> {
        let template = |signal: &Vec<f64>| white.over_noise(signal, noise_sd);
        let uniform = vec![1.0 / signals.len() as f64; signals.len()];
        let detector = BankDetector::new(
            self.bank.axes(),
            signals.iter().flat_map(template).collect(),
            self.prior.unwrap_or(&uniform),
            white.signals(false),
            &white.depth_errors,
            level,
        );
        detector.map_err(refused)
    }

    /// Implements: BNK-034, BNK-063, BNK-064.
    fn judge(
        &self,
        detector: &BankDetector,
        white: &mut Design,
        fit: Fit,
    ) -> Result<Location, Refusal> {
        let judged = || {
            let statistic = detector.statistic(&mut white.residual)?;
            let likeliest = detector.likeliest(&statistic);
            let tests = detector.tests(&statistic)?;
            let test = detector.test(&statistic, likeliest);
            let test = test.ok_or(DetectError::NoSignal)??;
            let theta_mixture = detector.mixture(&statistic)?;
            let (eta, calibrated) = self.threshold(detector, &tests)?;
            let by_mixture = self.question.criterion == Criterion::MaximumAPosteriori;
            // θ of the likeliest point is of an inclusion from `least` on, whatever the others are.
            let (decisive, least) = if by_mixture {
                (theta_mixture, eta - libm::log(detector.prior()[likeliest]))
            } else {
                (statistic.theta[likeliest], eta)
            };
            let (decision, causes) = self.question.verdict(decide(decisive, eta)?, &fit);
            let place = detector.place(&statistic);
            Ok(Location {
                decision,
                causes,
                point: self.bank.point(likeliest),
                theta_max: statistic.theta[likeliest],
                theta_mixture,
                threshold: SearchThreshold {
                    eta,
                    by_mixture,
                    calibrated,
                    false_alarm_bound: false_alarm_bound(&tests, eta)?,
                    miss_bound: test.rates(test.bayes_threshold(least)?)?.miss,
                },
                posterior: posterior(theta_mixture, self.question.prior_h1)?,
                bound: detector.bound(place.estimate),
                place,
                gamma_nominal: libm::sqrt(squares(&white.template)),
                test,
                fit,
            })
        };
        judged().map_err(refused)
    }

    /// η, and how it was simulated, if it was.
    ///
    /// Implements: BNK-063, BNK-064.
    fn threshold(
        &self,
        detector: &BankDetector,
        tests: &[SubspaceTest],
    ) -> Result<(f64, Option<CalibratedThreshold>), DetectError> {
        let eta = match (self.question.criterion, self.simulations) {
            (Criterion::MaximumAPosteriori, _) => map_threshold(self.question.prior_h1),
            // The promise is for an inclusion anywhere: the lowest threshold keeps it.
            (Criterion::NeymanPearsonMiss { max_miss }, _) => {
                tests.iter().try_fold(f64::INFINITY, |lowest, &test| {
                    let t = test.miss_threshold(max_miss)?.max(test.least_theta_at());
                    Ok::<f64, DetectError>(lowest.min(SubspaceTest { t, ..test }.theta()))
                })
            }
            (Criterion::NeymanPearsonFalseAlarm { max_false_alarm }, None) => {
                false_alarm_threshold(tests, max_false_alarm)
            }
            (Criterion::NeymanPearsonFalseAlarm { max_false_alarm }, Some((number, seed))) => {
                let found = detector.calibrate(max_false_alarm, number, seed)?;
                return Ok((found.eta, Some(found)));
            }
        };
        Ok((eta?, None))
    }
}
