//! The record judged at the position that the maps are for.

use super::{Record, refused};
use crate::detect::assessment::{Assessment, assess};
use crate::detect::{
    DetectError, map_threshold, neyman_pearson_false_alarm_threshold,
    neyman_pearson_miss_threshold, theta_of_record,
};
use crate::force::Force;
use crate::force_map::Hypotheses;
use crate::refusal::Refusal;

/// What the threshold shall achieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Criterion {
    /// The fewest errors for the prior.
    Map,
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

impl Criterion {
    /// η at a known position, where the signal-to-noise ratio is γ.
    ///
    /// # Errors
    /// A prior or rate not strictly between 0 and 1; γ = 0 with a rate of false alarms; overflow.
    pub fn threshold(self, gamma: f64, prior_h1: f64) -> Result<f64, DetectError> {
        match self {
            Criterion::Map => map_threshold(prior_h1),
            Criterion::NeymanPearsonMiss { max_miss } => {
                neyman_pearson_miss_threshold(gamma, max_miss)
            }
            Criterion::NeymanPearsonFalseAlarm { max_false_alarm } => {
                neyman_pearson_false_alarm_threshold(gamma, max_false_alarm)
            }
        }
    }
}

/// What is asked of a record: does the gel under its sweep hold the inclusion?
#[derive(Debug, Clone, Copy)]
pub struct Question<'a> {
    /// The forces that are expected without and with it.
    pub hypotheses: Hypotheses<'a>,
    /// Depth of the sweep, m.
    pub depth: f64,
    /// Standard deviation of the white noise on a sample of either force, N.
    pub noise_sd: Force<f64>,
    /// What the threshold shall achieve.
    pub criterion: Criterion,
    /// Pr(H = 1) before the sweep.
    pub prior_h1: f64,
}

/// The answer at the position that the maps are for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// The threshold.
    pub eta: f64,
    /// What the detector says at it.
    pub assessment: Assessment,
    /// How far the record is from either hypothesis.
    pub misfit: Misfit,
}

impl Question<'_> {
    /// Judges `record` for an inclusion at x = 0 of the maps.
    ///
    /// # Errors
    /// Positions or a depth outside the maps; maps that do not differ at the samples; whatever the detector refuses.
    ///
    /// Implements: TRC-008, CLI-043, CLI-049.
    pub fn judge(&self, record: &Record) -> Result<Judgement, Refusal> {
        let f0 = record.expected(self.hypotheses.without(), self.depth)?;
        let f1 = record.expected(self.hypotheses.with(), self.depth)?;
        let judged = || {
            let (observed, f0, f1) = (record.forces(), f0.as_deref(), f1.as_deref());
            let statistic = theta_of_record(observed, f0, f1, self.noise_sd)?;
            if statistic.gamma == 0.0 {
                return Err(DetectError::NoSignal);
            }
            let eta = self.criterion.threshold(statistic.gamma, self.prior_h1)?;
            let residual = residual(record, f0);
            Ok(Judgement {
                eta,
                assessment: assess(statistic, self.prior_h1, eta)?,
                misfit: Misfit::of(residual.as_deref(), self.noise_sd, statistic.theta)?,
            })
        };
        judged().map_err(|error| refused(error).in_file(record.file()))
    }
}

/// What is left of a record without the forces `f0`, N.
pub(super) fn residual(record: &Record, f0: Force<&[f64]>) -> Force<Vec<f64>> {
    record.forces().zip(f0).map(|(observed, f0)| {
        let difference = std::iter::zip(observed, f0).map(|(observed, f0)| observed - f0);
        difference.collect()
    })
}

/// How far a record is from the nearer of the two hypotheses.
///
/// ```
/// use palpate::force::Force;
/// use palpate::trace::Misfit;
///
/// let noise_sd = Force { lateral: 0.25, normal: 0.25 };
/// let misfit = |force: f64| Misfit::of(Force::new(&[0.0], &[force]), noise_sd, 0.0);
/// // 2 s from the map, and 20 s.
/// assert_eq!((misfit(0.5)?.chi_square, misfit(0.5)?.is_too_large()), (4.0, false));
/// assert_eq!((misfit(5.0)?.chi_square, misfit(5.0)?.is_too_large()), (400.0, true));
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// The smaller Σ (F_p − F_h)²/s² over both channels: χ² with two degrees of freedom a sample.
    pub chi_square: f64,
    /// What a record that fits exceeds with probability 10⁻⁶ at most.
    pub limit: f64,
}

impl Misfit {
    /// The misfit of a record whose `residual` is left without inclusion (N) and whose θ is `theta`.
    ///
    /// # Errors
    /// A sum that overflows.
    ///
    /// Implements: TRC-050, TRC-051.
    pub fn of(
        residual: Force<&[f64]>,
        noise_sd: Force<f64>,
        theta: f64,
    ) -> Result<Misfit, DetectError> {
        let n = (residual.lateral.len() + residual.normal.len()) as f64;
        let sums = residual.zip(noise_sd).map(|(residual, noise_sd)| {
            let standardised = residual.iter().map(|residual| residual / noise_sd);
            standardised.map(|value| value * value).sum::<f64>()
        });
        // Σ (r − Δ)²/s² = Σ r²/s² − 2θ.
        let chi_square = sums.lateral + sums.normal - 2.0 * theta.max(0.0);
        if !chi_square.is_finite() {
            let what = "chi_square";
            return Err(DetectError::Overflow { what });
        }
        let t = libm::log(1e6);
        Ok(Misfit {
            // Rounding may leave a little below 0 of a record without noise.
            chi_square: chi_square.max(0.0),
            limit: n + 2.0 * libm::sqrt(n * t) + 2.0 * t,
        })
    }

    /// Does the record fit neither hypothesis?
    pub fn is_too_large(&self) -> bool {
        self.chi_square > self.limit
    }
}
