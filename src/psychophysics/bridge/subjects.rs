//! A noise level for each subject.
//!
//! Nearly all answers to the shallow inclusions are right, where a deviance does not follow the chi-square law:
//! its mean is below its degrees of freedom. Its mean and variance under the fit are summed over all possible
//! counts instead, less what the fitted noise takes away, and the gamma law with both gives the p-value.

use super::common::{Signals, is_inside};
use super::{Observations, SubjectFit};
use crate::psychophysics::PsychophysicsError;
use crate::psychophysics::choice::{Count, Perceived, log_likelihood};
use crate::psychophysics::search::{golden, maximum};
use crate::stats::{binomial, tails::gamma_tail};

/// The largest share of lapses that is searched.
const LARGEST_LAPSE: f64 = 0.25;
/// Cells of the search for it.
const CELLS: u32 = 5;
/// How far ln(1/σ) of a subject may lie from that without lapses.
const LAPSE_RANGE: [f64; 2] = [-0.1, 2.0];

/// This many times the largest 1/σ of the search, every difference above 0 is perceived, to the last bit.
const SURE: f64 = 1e6;

/// The noise of each subject that fits best without lapses.
///
/// Implements: PSY-077, PSY-078.
pub fn by_subject(
    signals: &Signals,
    observed: &Observations,
) -> Result<SubjectFit, PsychophysicsError> {
    assemble(signals, observed, 0.0, 0)
}

/// The same with the share of lapses, one for all, that fits best.
///
/// Implements: PSY-077, PSY-078.
pub fn by_subject_with_lapse(
    signals: &Signals,
    observed: &Observations,
) -> Result<SubjectFit, PsychophysicsError> {
    let without: Vec<f64> = observed
        .subjects
        .iter()
        .map(|counts| signals.best(counts, Some(0.0)).0)
        .collect();
    let profile = |lapse: f64| {
        let subjects = observed.subjects.iter().zip(&without);
        let best = |(counts, from): (&Vec<Count>, &f64)| {
            let value =
                |log: f64| log_likelihood(counts, &signals.perceived(libm::exp(log)), lapse);
            golden(&value, from + LAPSE_RANGE[0], from + LAPSE_RANGE[1]).1
        };
        subjects.map(best).sum::<f64>()
    };
    let (lapse, _) = maximum(profile, 0.0, LARGEST_LAPSE, CELLS);
    let with = assemble(signals, observed, lapse, 1)?;
    let without = assemble(signals, observed, 0.0, 0)?;
    // The search for the lapse is coarser than the fit without: it must not lose to it.
    Ok(if with.deviance < without.deviance {
        with
    } else {
        let mut none = without;
        none.aic += 2.0;
        none
    })
}

fn assemble(
    signals: &Signals,
    observed: &Observations,
    lapse: f64,
    fitted_lapses: u32,
) -> Result<SubjectFit, PsychophysicsError> {
    let range = signals.range();
    let (mut noise, mut deviances) = (Vec::new(), Vec::new());
    let mut predicted = vec![
        Count {
            right: 0.0,
            wrong: 0.0
        };
        signals.0.len()
    ];
    let mut moments = Moments::default();
    for counts in &observed.subjects {
        let (log, _) = signals.best(counts, Some(lapse));
        let is_fitted = is_inside(range, log);
        let sensitivity = if is_fitted {
            libm::exp(log)
        } else if log > 0.5 * (range[0] + range[1]) {
            libm::exp(range[1]) * SURE
        } else {
            0.0
        };
        noise.push(if is_fitted {
            Some(1.0 / sensitivity)
        } else {
            (sensitivity > 0.0).then_some(0.0)
        });
        let perceived = signals.perceived(sensitivity);
        for ((sum, count), at) in predicted.iter_mut().zip(counts).zip(&perceived) {
            let trials = count.right + count.wrong;
            sum.right += trials * at.right(lapse);
            sum.wrong += trials * at.wrong(lapse);
        }
        let saturated: f64 = counts.iter().map(|count| count.saturated()).sum();
        let value = log_likelihood(counts, &perceived, lapse);
        deviances.push(2.0 * (saturated - value).max(0.0));
        let slopes = signals.slopes(sensitivity);
        moments.add(counts, &perceived, &slopes, lapse, is_fitted)?;
    }
    let deviance: f64 = deviances.iter().sum();
    let moments = moments.less_fitted(fitted_lapses);
    let share = |sum: &Count| sum.right / (sum.right + sum.wrong);
    let parameters = observed.subjects.len() as f64 + f64::from(fitted_lapses);
    Ok(SubjectFit {
        noise,
        lapse,
        predicted: predicted.iter().map(share).collect(),
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
    /// Implements: PSY-078.
    fn add(
        &mut self,
        counts: &[Count],
        perceived: &[Perceived],
        slopes: &[f64],
        lapse: f64,
        is_fitted: bool,
    ) -> Result<(), PsychophysicsError> {
        let (mut information, mut fourth, mut with_square) = (0.0, 0.0, 0.0);
        for ((count, at), slope) in counts.iter().zip(perceived).zip(slopes) {
            let slope = (1.0 - 2.0 * lapse) * slope;
            let of_count = CountMoments::new(count.right + count.wrong, *at, lapse, slope)?;
            self.mean += of_count.mean;
            self.variance += of_count.variance;
            information += of_count.score_square;
            fourth += of_count.score_fourth - 3.0 * of_count.score_square * of_count.score_square;
            with_square += of_count.deviance_with_square;
        }
        if is_fitted && information > 0.0 {
            self.mean -= 1.0;
            self.variance += 2.0 + fourth / (information * information);
            self.variance -= 2.0 * with_square / information;
        }
        Ok(())
    }

    /// Less what further fitted parameters take away, as in the chi-square law; never below 0.
    fn less_fitted(self, parameters: u32) -> Moments {
        let parameters = f64::from(parameters);
        Moments {
            mean: (self.mean - parameters).max(0.0),
            variance: (self.variance - 2.0 * parameters).max(0.0),
        }
    }

    /// Pr(X ≥ deviance) by the gamma law.
    fn tail(self, deviance: f64) -> Result<f64, PsychophysicsError> {
        if self.mean == 0.0 || self.variance == 0.0 {
            return Ok(1.0);
        }
        let scale = self.variance / self.mean;
        Ok(gamma_tail(self.mean / scale, deviance / scale)?)
    }
}

/// Expectations over the possible counts at one inclusion, d their deviance and u their score.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct CountMoments {
    /// E d.
    mean: f64,
    /// Var d.
    variance: f64,
    /// E u².
    score_square: f64,
    /// E u⁴.
    score_fourth: f64,
    /// Cov(d, u²).
    deviance_with_square: f64,
}

impl CountMoments {
    fn new(
        trials: f64,
        perceived: Perceived,
        lapse: f64,
        slope: f64,
    ) -> Result<CountMoments, PsychophysicsError> {
        let (right, wrong) = (perceived.right(lapse), perceived.wrong(lapse));
        let mut sums = [0.0; 5];
        if wrong == 0.0 {
            // Every answer is right, and no count has a deviance.
            return Ok(CountMoments::default());
        }
        for errors in 0..=trials as u64 {
            // By the wrong answers, whose probability keeps its digits where it is small.
            let weight = binomial::probability(errors, trials as u64, wrong)?;
            let errors = errors as f64;
            let count = Count {
                right: trials - errors,
                wrong: errors,
            };
            let deviance = 2.0 * (count.saturated() - perceived.log_likelihood(count, lapse));
            let score = slope * (count.right / right - count.wrong / wrong);
            let square = score * score;
            let terms = [
                deviance,
                deviance * deviance,
                square,
                square * square,
                deviance * square,
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += weight * term;
            }
        }
        let [mean, mean_square, score_square, score_fourth, product] = sums;
        Ok(CountMoments {
            mean,
            variance: mean_square - mean * mean,
            score_square,
            score_fourth,
            deviance_with_square: product - mean * score_square,
        })
    }
}
