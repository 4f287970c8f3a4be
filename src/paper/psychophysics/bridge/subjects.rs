//! A noise level for each subject.
//!
//! Nearly all answers to the shallow inclusions are right, where a deviance does not follow the chi-square law:
//! its mean is below its degrees of freedom. Its mean and variance under the fit are summed over all possible
//! counts instead, less what the fitted noise takes away, and the gamma law with both gives the p-value.

use super::common::{Signals, is_inside};
use super::{Observations, SubjectFit};
use crate::psychophysics::Result;
use crate::psychophysics::choice::{Count, Perceived, deviance, log_likelihood};
use crate::psychophysics::search::maximum;
use palpate::stats::{binomial, tails::gamma_tail};

/// The largest share of lapses that is searched: that of guesses.
const LARGEST_LAPSE: f64 = 0.5;
/// Cells of the search for it.
const CELLS: u32 = 10;

/// This many times the largest 1/σ of the search, every difference above 0 is perceived, to the last bit.
const SURE: f64 = 1e6;

/// The noise of each subject that fits best without lapses.
///
/// Implements: PSY-073, PSY-076.
pub fn by_subject(signals: &Signals, observed: &Observations) -> Result<SubjectFit> {
    assemble(signals, observed, 0.0, 0)
}

/// The same with the share of lapses, one for all, that fits best; `without` is the fit without.
///
/// Implements: PSY-073, PSY-076.
pub fn by_subject_with_lapse(
    signals: &Signals,
    observed: &Observations,
    without: &SubjectFit,
) -> Result<SubjectFit> {
    let profile = |lapse: f64| {
        let best = |counts: &Vec<Count>| signals.best(counts, Some(lapse)).1;
        observed.subjects.iter().map(best).sum::<f64>()
    };
    let (lapse, _) = maximum(profile, 0.0, LARGEST_LAPSE, CELLS);
    let with = assemble(signals, observed, lapse, 1)?;
    // The search for the lapse is coarser than the fit without: it must not lose to it.
    if with.deviance < without.deviance {
        return Ok(with);
    }
    let aic = without.aic + 2.0;
    let same = without.clone();
    Ok(SubjectFit { aic, ..same })
}

fn assemble(
    signals: &Signals,
    observed: &Observations,
    lapse: f64,
    fitted_lapses: u32,
) -> Result<SubjectFit> {
    let range = signals.range();
    let (mut noise, mut deviances) = (Vec::new(), Vec::new());
    let mut predicted = vec![Count::default(); signals.0.len()];
    let mut moments = Moments::default();
    for counts in &observed.subjects {
        let (log, _) = signals.best(counts, Some(lapse));
        let is_fitted = is_inside(range, log);
        let (sensitivity, noise_n) = match log > 0.5 * (range[0] + range[1]) {
            _ if is_fitted => (libm::exp(log), Some(1.0 / libm::exp(log))),
            true => (libm::exp(range[1]) * SURE, Some(0.0)),
            false => (0.0, None),
        };
        noise.push(noise_n);
        let perceived = signals.perceived(sensitivity);
        for ((sum, count), at) in predicted.iter_mut().zip(counts).zip(&perceived) {
            sum.right += count.trials() * at.right(lapse);
            sum.wrong += count.trials() * at.wrong(lapse);
        }
        deviances.push(deviance(counts, log_likelihood(counts, &perceived, lapse)));
        let slopes = signals.slopes(sensitivity);
        moments.add(counts, &perceived, &slopes, lapse, is_fitted)?;
    }
    let deviance: f64 = deviances.iter().sum();
    let lapses = f64::from(fitted_lapses);
    // Less what further fitted parameters take away, as in the chi-square law.
    moments.mean = (moments.mean - lapses).max(0.0);
    moments.variance = (moments.variance - 2.0 * lapses).max(0.0);
    let parameters = observed.subjects.len() as f64 + lapses;
    Ok(SubjectFit {
        noise_n: noise,
        lapse,
        predicted: predicted.iter().map(|of| of.right / of.trials()).collect(),
        deviance,
        expected_deviance: moments.mean,
        deviance_sd: libm::sqrt(moments.variance),
        p_value: moments.tail(deviance)?,
        aic: deviance + 2.0 * parameters,
        deviance_by_subject: deviances,
    })
}

/// The mean and variance of a deviance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Moments {
    mean: f64,
    variance: f64,
}

impl Moments {
    /// Adds a subject's deviance under its fit. With D the deviance from the fitted probabilities and U the score
    /// of ln(1/σ) with information I, the fitted noise lowers D by Q = U²/I to first order; D and U are sums over
    /// independent counts, so that Var Q = 2 + Σ κ₄(u)/I² and Cov(D, Q) = Σ Cov(d, u²)/I.
    ///
    /// Implements: PSY-076.
    fn add(
        &mut self,
        counts: &[Count],
        perceived: &[Perceived],
        slopes: &[f64],
        lapse: f64,
        is_fitted: bool,
    ) -> Result<()> {
        let (mut information, mut fourth, mut with_square) = (0.0, 0.0, 0.0);
        for ((count, at), slope) in counts.iter().zip(perceived).zip(slopes) {
            let slope = (1.0 - 2.0 * lapse) * slope;
            let [d, dd, uu, uuuu, duu] = expectations(count.trials(), *at, lapse, slope)?;
            self.mean += d;
            self.variance += dd - d * d;
            information += uu;
            fourth += uuuu - 3.0 * uu * uu;
            with_square += duu - d * uu;
        }
        if is_fitted && information > 0.0 {
            self.mean -= 1.0;
            self.variance += 2.0 + fourth / (information * information);
            self.variance -= 2.0 * with_square / information;
        }
        Ok(())
    }

    /// Pr(X ≥ deviance) by the gamma law.
    fn tail(self, deviance: f64) -> Result<f64> {
        if self.mean == 0.0 || self.variance == 0.0 {
            return Ok(1.0);
        }
        let scale = self.variance / self.mean;
        Ok(gamma_tail(self.mean / scale, deviance / scale)?)
    }
}

/// E d, E d², E u², E u⁴ and E du² over the possible counts at one inclusion, d their deviance and u their score.
fn expectations(trials: f64, perceived: Perceived, lapse: f64, slope: f64) -> Result<[f64; 5]> {
    let (right, wrong) = (perceived.right(lapse), perceived.wrong(lapse));
    let mut sums = [0.0; 5];
    if wrong == 0.0 {
        // Every answer is right, and no count has a deviance.
        return Ok(sums);
    }
    let (log_right, log_wrong) = (libm::log(right), libm::log(wrong));
    for errors in 0..=trials as u64 {
        // By the wrong answers, whose probability keeps its digits where it is small.
        let weight = binomial::probability(errors, trials as u64, wrong)?;
        let count = Count::new(trials - errors as f64, trials);
        let log_likelihood = count.right * log_right + count.wrong * log_wrong;
        let d = 2.0 * (count.saturated() - log_likelihood);
        let u = slope * (count.right / right - count.wrong / wrong);
        let terms = [d, d * d, u * u, u * u * (u * u), d * (u * u)];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += weight * term;
        }
    }
    Ok(sums)
}
