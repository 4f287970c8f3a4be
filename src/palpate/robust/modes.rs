//! A record in few smooth modes, beyond which there is nothing of an inclusion, and the noise from what the modes leave.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::force::Force;

/// The finest smooth thing, over the radius of the probe: a mode for each so many radii of the sweep.
const MODE: f64 = 1.0 / 6.5;
/// The modes take at most this share of the samples, and this where the noise is stated.
const MOST_MODES: f64 = 0.4;
const MOST_MODES_BESIDE_NOISE: f64 = 0.75;
/// Corner frequencies of noise that is not white, in radians a sample, and its shares of white noise.
const CORNERS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
const WHITE_SHARES: [f64; 7] = [0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3];
/// By so much ln of the likelihood, coloured noise must explain more than white noise.
const COLOURED: f64 = 4.0;

/// An orthonormal basis of smooth functions at the samples of a sweep: 1, u and cos(πm(u + 1)/2), u from −1 to 1.
///
/// Implements: ROB-010.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Samples × modes.
    basis: DMatrix<f64>,
    /// u at the samples.
    pub u: Vec<f64>,
    /// The width of the sweep, m.
    pub width: f64,
}

/// The noise of one channel: its power at each mode, and at the highest frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// The variance of each mode, N².
    pub of_modes: Vec<f64>,
    /// The variance of a sample, N².
    pub variance: f64,
}

impl Spectrum {
    /// White noise of a variance, N².
    pub fn white(modes: &Modes, variance: f64) -> Spectrum {
        let of_modes = vec![variance; modes.count()];
        Spectrum { of_modes, variance }
    }
}

impl Modes {
    /// The modes over `positions` (m) of a sweep under a probe of `radius` (m), whose noise is to be estimated or stated.
    pub fn new(positions: &[f64], radius: f64, noise_is_stated: bool) -> Modes {
        let samples = positions.len();
        let (first, last) = (positions[0], positions[samples - 1]);
        let width = f64::max(last - first, f64::MIN_POSITIVE);
        let u: Vec<f64> = (positions.iter())
            .map(|x| (2.0 * (x - first) / width - 1.0).clamp(-1.0, 1.0))
            .collect();
        let wanted = libm::ceil(width / (radius * MODE));
        let most = match noise_is_stated {
            true => MOST_MODES_BESIDE_NOISE,
            false => MOST_MODES,
        };
        let count = wanted.min(most * samples as f64).max(3.0) as usize;
        let value = |sample: usize, mode: usize| match mode {
            0 => 1.0,
            1 => u[sample],
            _ => libm::cos(PI * (mode - 1) as f64 * 0.5 * (u[sample] + 1.0)),
        };
        let basis = DMatrix::from_fn(samples, count, value).qr().q();
        Modes { basis, u, width }
    }

    /// The number of modes.
    pub fn count(&self) -> usize {
        self.basis.ncols()
    }

    /// The number of samples.
    pub fn samples(&self) -> usize {
        self.basis.nrows()
    }

    /// The amplitudes of the modes in both channels, lateral first.
    pub fn of(&self, series: Force<&[f64]>) -> DVector<f64> {
        let channels = series.into_array();
        let amplitudes = channels.map(|channel| self.of_channel(channel));
        let amplitudes = amplitudes
            .iter()
            .flat_map(|channel| channel.iter().copied());
        DVector::from_iterator(2 * self.count(), amplitudes)
    }

    fn of_channel(&self, channel: &[f64]) -> DVector<f64> {
        self.basis.tr_mul(&DVector::from_column_slice(channel))
    }

    /// BᵀKB of a covariance K between samples.
    pub fn covariance(&self, between: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let samples = self.samples();
        let mut kernel = DMatrix::zeros(samples, samples);
        for i in 0..samples {
            for j in 0..=i {
                let value = between(i, j);
                kernel[(i, j)] = value;
                kernel[(j, i)] = value;
            }
        }
        self.basis.tr_mul(&(kernel * &self.basis))
    }

    /// The series of a channel with these amplitudes.
    pub fn series(&self, amplitudes: &DVector<f64>) -> DVector<f64> {
        &self.basis * amplitudes
    }

    /// What the modes leave of a channel.
    pub fn residual(&self, channel: &[f64]) -> Vec<f64> {
        let smooth = self.series(&self.of_channel(channel));
        channel.iter().zip(&smooth).map(|(f, s)| f - s).collect()
    }

    /// The share of a sample's own noise that the modes take, Σ B².
    pub fn leverage(&self, sample: usize) -> f64 {
        self.basis.row(sample).norm_squared()
    }

    /// The noise of a channel from its frequencies above those of the modes: white, or with a corner where that is much likelier and not
    /// excluded. `step` is the resolution of the sensor, N.
    ///
    /// Implements: ROB-011.
    pub fn noise(&self, channel: &[f64], step: f64, is_white: bool) -> Spectrum {
        let left = self.residual(channel);
        let (samples, first) = (self.samples(), self.count() + 1);
        let frequency = |mode: usize| PI * mode as f64 / samples as f64;
        let quarter = |of: usize| libm::cos(0.5 * frequency(of));
        let waves: Vec<f64> = (0..4 * samples).map(quarter).collect();
        let power = |mode: usize| {
            // cos(ω(n + ½)).
            let wave = |at: usize| waves[mode * (2 * at + 1) % waves.len()];
            let sum: f64 = left.iter().enumerate().map(|(at, r)| r * wave(at)).sum();
            2.0 * sum * sum / samples as f64
        };
        let powers: Vec<f64> = (first..samples).map(power).collect();
        let floor = step * step / 12.0;
        // ln of the likelihood, and σ², of noise with that shape.
        let fitted = |shape: &dyn Fn(f64) -> f64| {
            let shapes = (first..samples).map(|mode| shape(frequency(mode)));
            let pairs = powers.iter().zip(shapes);
            let (sum, logs) = pairs.fold((0.0, 0.0), |(sum, logs), (power, shape)| {
                (sum + power / shape, logs + libm::log(shape))
            });
            let count = powers.len() as f64;
            let variance = f64::max(sum / count, floor.max(f64::MIN_POSITIVE));
            let likelihood = -0.5 * (count * libm::log(variance) + logs + sum / variance);
            (likelihood, variance)
        };
        let (white, variance) = fitted(&|_| 1.0);
        let mut best = (white + COLOURED, variance, None);
        let corners = if is_white { &[][..] } else { &CORNERS };
        for &corner in corners {
            for share in WHITE_SHARES {
                let (likelihood, variance) = fitted(&|at| coloured(at, corner, share));
                if likelihood > best.0 {
                    best = (likelihood, variance, Some((corner, share)));
                }
            }
        }
        let (_, scale, shape) = best;
        let at = |mode: usize| match shape {
            None => scale,
            Some((corner, share)) => floor.max(scale * coloured(frequency(mode), corner, share)),
        };
        Spectrum {
            of_modes: (0..self.count()).map(at).collect(),
            variance: (1..samples).map(at).sum::<f64>() / (samples - 1) as f64,
        }
    }
}

/// The power of noise with a corner frequency and a share of white noise, over that at frequency 0.
fn coloured(frequency: f64, corner: f64, share: f64) -> f64 {
    let over = 2.0 * libm::sin(0.5 * frequency) / corner;
    (1.0 - share) / (1.0 + over * over) + share
}
