//! A recorded sweep against a bank: is there an inclusion, and where?

use super::Bank;
use super::axis::weights;
use super::detector::BankDetector;
use super::information::PlaceBound;
use super::place::PlacePosterior;
use super::rates::{CalibratedThreshold, false_alarm_bound, false_alarm_threshold};
use crate::detect::nuisance::{NoiseLevel, SubspaceTest};
use crate::detect::{Decision, DetectError, map_threshold, posterior};
use crate::force::Force;
use crate::force_map::{ForceMap, SAME_POSITION};
use crate::refusal::Refusal;
use crate::trace::design::{Design, Series, blocked, difference, squares, stacked, whitened};
use crate::trace::{Cause, Criterion, Fit, Question, Record, refused};

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
    /// Why not, the likeliest cause first.
    pub causes: Vec<Cause>,
    /// The likeliest point of the bank, in the order of [`super::Parameter::ALL`].
    pub point: [f64; 4],
    /// T with its law there.
    pub test: SubspaceTest,
    /// Θ_max.
    pub theta_max: f64,
    /// ln of the likelihood ratio of an inclusion at any point.
    pub theta_mixture: f64,
    /// The threshold of Θ_max, or of the mixture.
    pub eta: f64,
    /// Whether the mixture is compared with η, and not Θ_max.
    pub by_mixture: bool,
    /// The threshold by simulation, if it was asked for.
    pub calibrated: Option<CalibratedThreshold>,
    /// Pr(H = 1 | record), by the mixture.
    pub posterior: f64,
    /// The false-alarm rate is at most this.
    pub false_alarm_bound: f64,
    /// The miss rate for an inclusion at the likeliest point is at most this.
    pub miss_bound: f64,
    /// Where it lies, and what it is, if there is one.
    pub place: PlacePosterior,
    /// How well that can be known, at the estimate.
    pub bound: PlaceBound,
    /// γ at the estimate of all samples if nothing were unknown and the noise white.
    pub gamma_nominal: f64,
    /// How well the record fits with the inclusion there.
    pub fit: Fit,
}

/// What decides, by the criterion.
struct Decided {
    statistic: f64,
    eta: f64,
    /// θ of the likeliest point is of an inclusion from here on, whatever the others are.
    least: f64,
    calibrated: Option<CalibratedThreshold>,
}

impl BankSearch<'_> {
    /// Searches `record`.
    ///
    /// # Errors
    /// A depth other than the bank's; positions outside it; a prior of another length; maps that differ by what is unknown alone;
    /// whatever the detector refuses.
    ///
    /// Implements: BNK-060, BNK-033, BNK-034.
    pub fn locate(&self, record: &Record) -> Result<Location, Refusal> {
        let located = || {
            let (question, depth) = (&self.question, self.bank.depth());
            if (depth - question.depth).abs() > SAME_POSITION {
                let found = format!("{} m", question.depth);
                let expected = format!("{depth} m, for which the bank is");
                return Err(Refusal::value("depth of the sweep", found, expected));
            }
            let mut design = Design::new(question, self.bank.reference().table(), record)?;
            let signal = |map: &ForceMap| {
                let f1 = record.expected(map.table(), depth)?;
                Ok(difference(f1.as_deref(), design.reference.as_deref()))
            };
            let signals = self.bank.maps().iter().map(signal);
            let signals = signals.collect::<Result<Vec<Series>, Refusal>>()?;
            // First where it probably lies, which does not depend on the level of the noise, so that its signal is not taken for noise.
            let noise_sd = question.noise.sd.unwrap_or(Force::new(1.0, 1.0));
            let white = design.whitened(noise_sd);
            let detector = self.detector(&white, &signals, noise_sd, 1, NoiseLevel::Known)?;
            let statistic = detector.statistic(&mut stacked(&white.residual));
            let place = detector.place(&statistic.map_err(refused)?);
            design.template = self.between(&signals, place.estimate);
            let (white, fit, blocks) = question.fitted(&design).map_err(refused)?;
            let level = question.noise_level(&fit);
            let detector = self.detector(&blocks, &signals, fit.noise_sd, fit.block, level)?;
            let mut residual = stacked(&blocks.residual);
            self.judge(&detector, &mut residual, &white, fit)
        };
        located().map_err(|refusal: Refusal| refusal.in_file(record.file()))
    }

    /// The signal at the parameters `at`, N, between those of the maps.
    fn between(&self, signals: &[Series], at: [f64; 4]) -> Series {
        let mut sum = signals[0].as_deref().map(|signal| vec![0.0; signal.len()]);
        for (map, weight) in weights(self.bank.axes(), at) {
            sum = sum.zip(signals[map].as_deref()).map(|(mut sum, signal)| {
                let pairs = sum.iter_mut().zip(signal);
                pairs.for_each(|(sum, signal)| *sum += weight * signal);
                sum
            });
        }
        sum
    }

    /// The detector of the `signals` of all maps, N, beside the nuisances of a record whose parts over `noise_sd` and in blocks are
    /// `white`.
    fn detector(
        &self,
        white: &Design,
        signals: &[Series],
        noise_sd: Force<f64>,
        block: usize,
        level: NoiseLevel,
    ) -> Result<BankDetector, Refusal> {
        let template = |signal| stacked(&blocked(&whitened(signal, noise_sd), block));
        let uniform = vec![1.0 / signals.len() as f64; signals.len()];
        let deviations: Vec<_> = white.depth_errors.iter().map(stacked).collect();
        let detector = BankDetector::new(
            self.bank.axes(),
            signals.iter().flat_map(template).collect(),
            self.prior.unwrap_or(&uniform),
            white.signals(false),
            &deviations,
            level,
        );
        detector.map_err(refused)
    }

    /// Implements: BNK-034, BNK-063, BNK-064.
    fn judge(
        &self,
        detector: &BankDetector,
        residual: &mut [f64],
        white: &Design,
        fit: Fit,
    ) -> Result<Location, Refusal> {
        let judged = || {
            let statistic = detector.statistic(residual)?;
            let likeliest = detector.likeliest(&statistic);
            let tests = detector
                .points()
                .filter_map(|point| detector.test(&statistic, point));
            let tests = tests.collect::<Result<Vec<_>, _>>()?;
            let test = detector.test(&statistic, likeliest);
            let test = test.ok_or(DetectError::NoSignal)??;
            let mixture = detector.mixture(&statistic)?;
            let decided = self.decided(detector, &tests, [test.theta(), mixture], likeliest)?;
            let causes = fit.causes(&test)?;
            let decision = if decided.statistic >= decided.eta {
                Decision::Inclusion
            } else {
                Decision::NoInclusion
            };
            let place = detector.place(&statistic);
            Ok(Location {
                decision: causes.is_empty().then_some(decision),
                causes,
                point: self.bank.point(likeliest),
                theta_max: test.theta(),
                theta_mixture: mixture,
                eta: decided.eta,
                by_mixture: self.question.criterion == Criterion::Map,
                calibrated: decided.calibrated,
                posterior: posterior(mixture, self.question.prior_h1)?,
                false_alarm_bound: false_alarm_bound(&tests, decided.eta)?,
                miss_bound: test.rates(test.bayes_threshold(decided.least)?)?.miss,
                bound: detector.bound(place.estimate),
                place,
                gamma_nominal: libm::sqrt(squares(&stacked(&white.template))),
                test,
                fit,
            })
        };
        judged().map_err(refused)
    }

    /// Implements: BNK-063, BNK-064.
    fn decided(
        &self,
        detector: &BankDetector,
        tests: &[SubspaceTest],
        [theta_max, mixture]: [f64; 2],
        likeliest: usize,
    ) -> Result<Decided, DetectError> {
        let by_largest = |eta, calibrated| Decided {
            statistic: theta_max,
            eta,
            least: eta,
            calibrated,
        };
        Ok(match (self.question.criterion, self.simulations) {
            (Criterion::Map, _) => {
                let eta = map_threshold(self.question.prior_h1)?;
                Decided {
                    statistic: mixture,
                    eta,
                    least: eta - libm::log(detector.prior()[likeliest]),
                    calibrated: None,
                }
            }
            // The promise is for an inclusion anywhere: the lowest threshold keeps it.
            (Criterion::NeymanPearsonMiss { max_miss }, _) => {
                let eta = tests.iter().try_fold(f64::INFINITY, |lowest, &test| {
                    let t = test.miss_threshold(max_miss)?.max(test.least_theta_at());
                    Ok::<f64, DetectError>(lowest.min(SubspaceTest { t, ..test }.theta()))
                });
                by_largest(eta?, None)
            }
            (Criterion::NeymanPearsonFalseAlarm { max_false_alarm }, None) => {
                by_largest(false_alarm_threshold(tests, max_false_alarm)?, None)
            }
            (Criterion::NeymanPearsonFalseAlarm { max_false_alarm }, Some((number, seed))) => {
                let found = detector.calibrate(max_false_alarm, number, seed)?;
                by_largest(found.eta, Some(found))
            }
        })
    }
}
