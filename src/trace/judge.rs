//! The record judged at the position that the maps are for.

use super::{Record, refused};
use crate::detect::assessment::{Assessment, assess};
use crate::detect::{
    DetectError, map_threshold, neyman_pearson_false_alarm_threshold,
    neyman_pearson_miss_threshold, theta_of_record,
};
use crate::force::Force;
use crate::force_map::ForceTable;
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

/// η and the assessment of `record` for an inclusion at x = 0 of the maps, swept at `depth` (m), in
/// white noise of standard deviation `noise_sd` a sample (N).
///
/// # Errors
/// Maps on different axes; positions or a depth outside them; maps that do not differ at the
/// samples; whatever the detector refuses.
///
/// Implements: TRC-008, TRC-020, CLI-043, CLI-049.
pub fn judge(
    record: &Record,
    reference: &ForceTable,
    inclusion: &ForceTable,
    depth: f64,
    noise_sd: Force<f64>,
    criterion: Criterion,
    prior_h1: f64,
) -> Result<(f64, Assessment), Refusal> {
    let judged = || {
        // Only for its refusal of axes that differ.
        inclusion.minus(reference)?;
        let f0 = record.expected(reference, depth)?;
        let f1 = record.expected(inclusion, depth)?;
        let (observed, f0, f1) = (record.forces(), f0.as_deref(), f1.as_deref());
        let assessed = || {
            let gamma = theta_of_record(observed, f0, f1, noise_sd)?.gamma;
            if gamma == 0.0 {
                return Err(DetectError::NoSignal);
            }
            let eta = criterion.threshold(gamma, prior_h1)?;
            let assessment = assess(observed, f0, f1, noise_sd, prior_h1, eta)?;
            Ok((eta, assessment))
        };
        assessed().map_err(refused)
    };
    judged().map_err(|refusal: Refusal| refusal.in_file(record.file()))
}

/// How far a record is from the nearer of the two hypotheses.
///
/// ```
/// use palpate::force::Force;
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::trace::{Misfit, Trace};
///
/// let matrix = |force| Matrix::from_fn(1, 2, |_, _| force);
/// let map = ForceTable::new(vec![0.004], vec![0.0, 0.004], Force::new(matrix(0.0), matrix(1.5)))?;
/// let noise_sd = Force { lateral: 0.25, normal: 0.25 };
/// let misfit = |force: f64| {
///     let text = format!("position_mm,lateral_force_n,normal_force_n\n2,0,{force}\n");
///     let record = Trace::from_csv(&text, "sweep.csv")?.record(None)?;
///     Misfit::of(&record, &map, 0.004, noise_sd, 0.0)
/// };
/// // 2 s from the map, and 20 s.
/// assert_eq!((misfit(2.0)?.chi_square, misfit(2.0)?.is_too_large()), (4.0, false));
/// assert_eq!((misfit(6.5)?.chi_square, misfit(6.5)?.is_too_large()), (400.0, true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// The smaller Σ (F_p − F_h)²/s² over both channels: χ² with two degrees of freedom a sample.
    pub chi_square: f64,
    /// What a record that fits exceeds with probability 10⁻⁶ at most.
    pub limit: f64,
}

impl Misfit {
    /// The misfit of `record`, swept at `depth` (m), whose θ against the map `reference` is `theta`.
    ///
    /// # Errors
    /// As [`Record::expected`]; a sum that overflows.
    ///
    /// Implements: TRC-050, TRC-051.
    pub fn of(
        record: &Record,
        reference: &ForceTable,
        depth: f64,
        noise_sd: Force<f64>,
        theta: f64,
    ) -> Result<Misfit, Refusal> {
        let f0 = record.expected(reference, depth)?;
        let sums = record.forces().zip(f0.as_deref()).zip(noise_sd);
        let sums = sums.map(|((observed, f0), noise_sd)| {
            let terms = std::iter::zip(observed, f0).map(|(observed, f0)| {
                let standardised = (observed - f0) / noise_sd;
                standardised * standardised
            });
            terms.sum::<f64>()
        });
        // Σ (r − Δ)²/s² = Σ r²/s² − 2θ.
        let chi_square = sums.lateral + sums.normal - 2.0 * theta.max(0.0);
        if !chi_square.is_finite() {
            let what = "chi_square";
            return Err(refused(DetectError::Overflow { what }).in_file(record.file()));
        }
        let n = 2.0 * record.positions().len() as f64;
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
