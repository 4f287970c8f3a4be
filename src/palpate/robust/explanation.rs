//! What a record would be like under either hypothesis, once the likeliest disturbances are fitted to it.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::RobustAnswer;
use super::detector::RobustDetector;
use super::evidence::SHAPE;
use super::sweep::Cleaned;
use crate::force::Force;

/// Records beside what both hypotheses expect of them, a series for each sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// The records without their glitches, N.
    pub records: Vec<Force<Vec<f64>>>,
    /// What is expected without and with an inclusion, in the likeliest class of each, N.
    pub expected: [Vec<Force<Vec<f64>>>; 2],
    /// The signal of the likeliest inclusion over that of its map.
    pub amplitude: f64,
}

/// What is expected of a record in modes, and (E + R)⁻¹(y − m).
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    pub mean: DVector<f64>,
    pub weights: DVector<f64>,
}

/// The mean of what is normal about `mean` with `covariance`, E, given a `record` of it in `noise` of these variances:
/// m + E (E + R)⁻¹ (y − m). None if E + R is not positive definite.
///
/// Implements: ROB-044.
pub fn fitted(
    record: &DVector<f64>,
    noise: &DVector<f64>,
    mean: &DVector<f64>,
    covariance: &DMatrix<f64>,
) -> Option<Fitted> {
    let whole = covariance + DMatrix::from_diagonal(noise);
    let weights = Cholesky::new(whole)?.solve(&(record - mean));
    let mean = mean + covariance * &weights;
    Some(Fitted { mean, weights })
}

impl RobustDetector<'_> {
    /// What both hypotheses expect of the records that `cleaned` holds, at this `level`, by the likeliest classes and inclusion of the
    /// `answer`; none where they were not compared.
    ///
    /// Implements: ROB-044.
    pub(super) fn explanation(
        &self,
        cleaned: Vec<Cleaned>,
        level: f64,
        [record, noise]: [&DVector<f64>; 2],
        answer: &RobustAnswer,
    ) -> Option<Explanation> {
        let [without, with] = [0, 1].map(|hypothesis| {
            let likeliest = answer.likeliest_class(hypothesis)?;
            Some(&self.weighted[likeliest].covariance)
        });
        let signal = self.likeliest_signal(answer)?;
        let none = DVector::zeros(record.len());
        let without = fitted(record, noise, &none, without?)?;
        let share = SHAPE * signal.size;
        let variance = signal.amplitude_sd * signal.amplitude_sd;
        let mut covariance = with? + &self.shape * (share * share);
        covariance.ger(variance, &signal.mean, &signal.mean, 1.0);
        let with = fitted(record, noise, &signal.mean, &covariance)?;
        let of_sweeps = |counted: &DVector<f64>| {
            let all = self.sweeps.iter().map(|sweep| 2 * sweep.modes.count());
            let mut mean = DVector::zeros(all.sum());
            let pairs = self.counted.iter().zip(counted.iter());
            pairs.for_each(|(at, value)| mean[*at] = *value);
            let mut start = 0;
            let forces = self.sweeps.iter().map(|sweep| {
                let of = mean.rows(start, 2 * sweep.modes.count()).into_owned();
                start += of.len();
                sweep.expected(&of, level)
            });
            forces.collect()
        };
        Some(Explanation {
            records: cleaned.into_iter().map(|of| of.forces).collect(),
            expected: [&without, &with].map(|of| of_sweeps(&of.mean)),
            amplitude: 1.0 + variance * signal.mean.dot(&with.weights),
        })
    }
}
