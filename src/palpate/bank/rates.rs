//! Rates of error of the largest θ of many points.

use super::detector::BankDetector;
use crate::detect::DetectError;
use crate::detect::nuisance::{NoiseLevel, SubspaceTest, dot};
use crate::stats::Bounds;
use crate::stats::binomial::clopper_pearson;
use crate::stats::error::{check_finite, check_probability, check_samples, in_range};
use crate::stats::normal;
use crate::stats::random::{Generator, uniform};
use crate::stats::tails::halved;

/// The confidence of the interval of a calibrated threshold.
///
/// Implements: BNK-053.
pub const CONFIDENCE: f64 = 0.99;

/// The stream of the records that judge a threshold, whatever the seed of those that set it: no bank has so many deviations.
///
/// Implements: BNK-054.
const JUDGING: u64 = u64::MAX;

/// A threshold of Θ_max that simulated records without inclusion set.
///
/// Implements: BNK-053.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibratedThreshold {
    /// The threshold η.
    pub eta: f64,
    /// The rate of false alarms at η lies in it with [`CONFIDENCE`].
    pub false_alarm: Bounds,
    /// Records that were simulated for each sign of each deviation, and without.
    pub simulations: u64,
}

/// A rate by importance sampling.
///
/// Implements: BNK-054.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RareRate {
    /// The estimate, without bias.
    pub rate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Σ of the rates of the points: an upper bound.
    pub union: f64,
}

/// Σ_k Pr(θ_k ≥ η | H = 0), at most 1: an upper bound on the rate of false alarms of Θ_max.
///
/// # Errors
/// η not finite.
///
/// Implements: BNK-051, ERR-006.
pub fn false_alarm_bound(tests: &[SubspaceTest], eta: f64) -> Result<f64, DetectError> {
    let sum = tests.iter().try_fold(0.0, |sum, test| {
        let rates = test.rates(test.bayes_threshold(eta)?)?;
        Ok::<f64, DetectError>(sum + rates.false_alarm)
    });
    Ok(f64::min(sum?, 1.0))
}

/// The least threshold η, to 10 digits, at which that bound is at most `max_false_alarm`.
///
/// # Errors
/// A rate that is not strictly between 0 and 1; no test.
///
/// Implements: BNK-051.
pub fn false_alarm_threshold(
    tests: &[SubspaceTest],
    max_false_alarm: f64,
) -> Result<f64, DetectError> {
    check_probability("max_false_alarm", max_false_alarm)?;
    let count = tests.len() as f64;
    in_range(count > 0.0, "number of tests", count, "above 0")?;
    let (mut low, mut high) = (-1.0, 1.0);
    while false_alarm_bound(tests, low)? <= max_false_alarm {
        low *= 2.0;
    }
    while false_alarm_bound(tests, high)? > max_false_alarm {
        high *= 2.0;
    }
    let is_too_low = |eta| Ok::<_, DetectError>(false_alarm_bound(tests, eta)? > max_false_alarm);
    let [_, least] = halved(60, [low, high], is_too_low)?;
    Ok(least)
}

impl BankDetector {
    /// Θ_max of record `trial` of white noise of standard deviation 1, with `mean` added.
    ///
    /// # Errors
    /// As [`BankDetector::statistic`].
    ///
    /// Implements: BNK-053.
    pub fn simulated_maximum(
        &self,
        mean: &[f64],
        generator: Generator,
        trial: u64,
    ) -> Result<f64, DetectError> {
        let mut record = vec![0.0; self.samples()];
        generator.normals(trial, 0, &mut record);
        check_samples("mean", mean, record.len())?;
        record.iter_mut().zip(mean).for_each(|(r, mean)| *r += mean);
        let statistic = self.statistic(&mut record)?;
        Ok(statistic.theta[self.likeliest(&statistic)])
    }

    /// The threshold of Θ_max for a rate of false alarms, from so many simulated records: of those without deviation and with each
    /// deviation, in either direction, the largest.
    ///
    /// # Errors
    /// A rate that is not strictly between 0 and 1, or at which fewer than 10 of the records exceed the threshold; as
    /// [`BankDetector::statistic`].
    ///
    /// Implements: BNK-053.
    pub fn calibrate(
        &self,
        max_false_alarm: f64,
        simulations: u64,
        seed: u64,
    ) -> Result<CalibratedThreshold, DetectError> {
        check_probability("max_false_alarm", max_false_alarm)?;
        let above = libm::floor(max_false_alarm * (simulations as f64 + 1.0));
        let enough = "enough for 10 records above the threshold";
        in_range(above >= 10.0, "simulations", simulations as f64, enough)?;
        let mut means = vec![vec![0.0; self.samples()]];
        for deviation in &self.deviations {
            means.push(deviation.iter().map(|d| -d).collect());
            means.push(deviation.clone());
        }
        let mut eta = f64::NEG_INFINITY;
        for (stream, mean) in (0..).zip(&means) {
            let generator = Generator::new(seed, stream);
            let maxima =
                (0..simulations).map(|trial| self.simulated_maximum(mean, generator, trial));
            let mut maxima = maxima.collect::<Result<Vec<_>, _>>()?;
            maxima.sort_by(|a, b| b.total_cmp(a));
            eta = eta.max(maxima[above as usize - 1]);
        }
        Ok(CalibratedThreshold {
            eta: check_finite("eta", eta)?,
            // The rate above the threshold, the k-th largest of n, follows Beta(k, n + 1 − k), within the interval of k of n.
            false_alarm: clopper_pearson(above as u64, simulations, CONFIDENCE)?,
            simulations,
        })
    }

    /// The share of so many simulated records with an inclusion of the parameters `at` whose Θ_max is at least η, between bounds of
    /// [`CONFIDENCE`].
    ///
    /// # Errors
    /// No simulations; as [`BankDetector::statistic`].
    ///
    /// Implements: BNK-054.
    pub fn power(
        &self,
        eta: f64,
        at: [f64; 4],
        simulations: u64,
        seed: u64,
    ) -> Result<Bounds, DetectError> {
        let (signal, generator) = (self.template_at(at), Generator::new(seed, JUDGING));
        let mut found = 0;
        for trial in 0..simulations {
            found += u64::from(self.simulated_maximum(&signal, generator, trial)? >= eta);
        }
        clopper_pearson(found, simulations, CONFIDENCE)
    }

    /// The rate of Θ_max ≥ η without inclusion, however small, where the level of the noise is known: records are drawn under the condition
    /// that one point exceeds η, and each counts for the share of that point among those that do (A. B. Owen, Y. Maximov, M. Chertkov,
    /// *Importance sampling the union of rare events*, Electron. J. Stat. 13, 2019).
    ///
    /// # Errors
    /// An unknown level of the noise; η not finite; no samples.
    ///
    /// Implements: BNK-054.
    pub fn rare_false_alarms(
        &self,
        eta: f64,
        simulations: u64,
        seed: u64,
    ) -> Result<RareRate, DetectError> {
        check_finite("eta", eta)?;
        let is_known = f64::from(self.level == NoiseLevel::Known);
        let known = "1: a known level of the noise";
        in_range(is_known > 0.0, "known level", is_known, known)?;
        let number = simulations as f64;
        in_range(simulations > 1, "simulations", number, "2 at least")?;
        let events = self.events(eta)?;
        let union = events.last().map_or(0.0, |last| last.up_to);
        let generator = Generator::new(seed, JUDGING);
        let (mut sum, mut squares) = (0.0, 0.0);
        for trial in 0..simulations {
            let share = 1.0 / self.exceeding(&events, eta, generator, trial)? as f64;
            sum += share;
            squares += share * share;
        }
        let mean = sum / number;
        let variance = (squares / number - mean * mean).max(0.0);
        Ok(RareRate {
            rate: union * mean,
            standard_error: union * libm::sqrt(variance / (number - 1.0)),
            union,
        })
    }

    /// The points with a signal, and how rarely each exceeds η without inclusion.
    fn events(&self, eta: f64) -> Result<Vec<Event>, DetectError> {
        let mut up_to = 0.0;
        let mut events = Vec::new();
        for point in self.points() {
            let gamma = self.gamma()[point];
            let rate = normal::upper_tail(eta / gamma + 0.5 * gamma)?;
            up_to += rate;
            events.push(Event { point, rate, up_to });
        }
        Ok(events)
    }

    /// How many points exceed η in record `trial`, drawn under the condition that one does, which is chosen by its rate.
    fn exceeding(
        &self,
        events: &[Event],
        eta: f64,
        generator: Generator,
        trial: u64,
    ) -> Result<usize, DetectError> {
        // A counter that no normal deviate has.
        let [of_point, of_tail, ..] = generator.words([0, trial, 2, 0]).map(uniform);
        let union = events[events.len() - 1].up_to;
        let chosen = events.partition_point(|event| event.up_to < of_point * union);
        let Event { point, rate, .. } = events[chosen.min(events.len() - 1)];
        let gamma = self.gamma()[point];
        let t = -normal::quantile(f64::max(of_tail * rate, f64::MIN_POSITIVE))?;
        let mut record = vec![0.0; self.samples()];
        generator.normals(trial, 0, &mut record);
        let template = self.template(point);
        let change = (t - dot(template, &record) / gamma) / gamma;
        for (sample, template) in record.iter_mut().zip(template) {
            *sample += change * template;
        }
        let theta = self.statistic(&mut record)?.theta;
        // The chosen one exceeds it, whatever rounding says.
        let exceeds = |event: &&Event| event.point == point || theta[event.point] >= eta;
        Ok(events.iter().filter(exceeds).count())
    }
}

/// A point whose θ may exceed a threshold.
struct Event {
    point: usize,
    /// How often it does without inclusion.
    rate: f64,
    /// The sum of the rates up to this point.
    up_to: f64,
}
