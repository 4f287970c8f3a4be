//! The ideal observer of the paper's theory: knows both force maps and his own noise, and takes the
//! sample of the pair with the larger Θ.

use super::{Felt, Interval};
use crate::detect::{Channels, DetectError, theta_of_record};
use crate::force_map::ForceTable;
use crate::refusal::Refusal;
use crate::stats::random::Generator;

/// The stream of the generator that the observer's noise is drawn from.
const STREAM: u64 = 0x0B5E;

/// Knows what to expect.
///
/// ```
/// use palpate::detect::Channels;
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::psychophysics::{Felt, IdealObserver, Interval};
///
/// let map = |force: f64| {
///     let matrix = |force| Matrix::from_fn(2, 2, |_, _| force);
///     ForceTable::new(vec![0.0, 0.004], vec![0.0, 0.01], matrix(force), matrix(0.0))
/// };
/// let felt = |force: f64| Felt {
///     depths: vec![0.004; 2],
///     laterals: vec![0.0, 0.005],
///     forces: Channels { x: vec![0.0; 2], y: vec![force; 2] },
///     ..Felt::default()
/// };
/// let (reference, inclusion) = (map(1.5)?, map(1.75)?);
/// let observer =
///     IdealObserver { reference: &reference, inclusion: &inclusion, noise_sd: 0.025, seed: 1 };
/// // Two samples with Δ/s = 10: γ² = 200, and hardly ever a wrong answer.
/// let (_, gamma) = observer.theta(&felt(1.5), 0)?;
/// assert!((gamma - 200.0_f64.sqrt()).abs() < 1e-9);
/// assert_eq!(observer.choose(&felt(1.5), &felt(1.75), 0)?, Interval::Second);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct IdealObserver<'a> {
    /// Forces without inclusion, F_0.
    pub reference: &'a ForceTable,
    /// Forces with the inclusion, F_1.
    pub inclusion: &'a ForceTable,
    /// Standard deviation of the noise on each sample of each channel, N.
    pub noise_sd: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// Why the observer can not decide.
///
/// ```
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::psychophysics::{Felt, IdealObserver, ObserverError};
///
/// let matrix = || Matrix::from_fn(2, 2, |_, _| 1.5);
/// let map = ForceTable::new(vec![0.0, 0.004], vec![0.0, 0.01], matrix(), matrix())?;
/// let observer = IdealObserver { reference: &map, inclusion: &map, noise_sd: 0.1, seed: 1 };
/// // Nothing was felt.
/// assert!(matches!(observer.theta(&Felt::default(), 0), Err(ObserverError::Detect(_))));
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ObserverError {
    /// The maps give no force where the hand was.
    #[error("{0}")]
    Map(#[from] Refusal),
    /// The detector refuses the record.
    #[error("{0}")]
    Detect(#[from] DetectError),
}

impl IdealObserver<'_> {
    /// θ of one sample felt with noise, and γ of the way that the hand took; `draw` tells the noises
    /// apart.
    ///
    /// # Errors
    /// [`ObserverError`].
    ///
    /// Implements: PSY-011.
    pub fn theta(&self, felt: &Felt, draw: u64) -> Result<(f64, f64), ObserverError> {
        let expected = |table: &ForceTable| {
            let mut forces = Channels {
                x: Vec::with_capacity(felt.depths.len()),
                y: Vec::with_capacity(felt.depths.len()),
            };
            for (&depth, &lateral) in felt.depths.iter().zip(&felt.laterals) {
                // Nothing is played above the surface.
                let force = table.force(depth.max(0.0), lateral)?;
                forces.x.push(force.x);
                forces.y.push(force.y);
            }
            Ok::<_, Refusal>(forces)
        };
        let (f0, f1) = (expected(self.reference)?, expected(self.inclusion)?);
        let noisy = |forces: &[f64], channel| {
            let generator = Generator::new(self.seed, STREAM + channel);
            let mut noise = vec![0.0; forces.len()];
            generator.normals(draw, 0, &mut noise);
            for (noise, force) in noise.iter_mut().zip(forces) {
                *noise = force + self.noise_sd * *noise;
            }
            noise
        };
        let observed = Channels {
            x: noisy(&felt.forces.x, 0),
            y: noisy(&felt.forces.y, 1),
        };
        let noise_sd = Channels {
            x: self.noise_sd,
            y: self.noise_sd,
        };
        let statistic = theta_of_record(
            Channels {
                x: &observed.x,
                y: &observed.y,
            },
            Channels { x: &f0.x, y: &f0.y },
            Channels { x: &f1.x, y: &f1.y },
            noise_sd,
        )?;
        Ok((statistic.theta, statistic.gamma))
    }

    /// Which of two samples has the inclusion, by the larger θ.
    ///
    /// # Errors
    /// [`ObserverError`].
    ///
    /// Implements: PSY-012, PSY-013.
    pub fn choose(
        &self,
        first: &Felt,
        second: &Felt,
        pair: u64,
    ) -> Result<Interval, ObserverError> {
        let (of_first, _) = self.theta(first, 2 * pair)?;
        let (of_second, _) = self.theta(second, 2 * pair + 1)?;
        Ok(if of_first >= of_second {
            Interval::First
        } else {
            Interval::Second
        })
    }
}
