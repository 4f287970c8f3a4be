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
    /// Samples × frequencies above those of the modes: cos(ω(n + ½)).
    waves: DMatrix<f64>,
    /// White noise, then those that are not.
    shapes: Vec<NoiseShape>,
}

/// The power of noise over the frequencies above those of the modes, but for its size.
#[derive(Debug, Clone)]
struct NoiseShape {
    /// Its corner frequency and share of white noise; none of white noise.
    corner: Option<(f64, f64)>,
    powers: Vec<f64>,
    /// Σ of their logarithms.
    logs: f64,
}

impl NoiseShape {
    fn new(corner: Option<(f64, f64)>, frequencies: &[f64]) -> NoiseShape {
        let power = |&at: &f64| corner.map_or(1.0, |(corner, share)| coloured(at, corner, share));
        let powers: Vec<f64> = frequencies.iter().map(power).collect();
        let logs = powers.iter().map(|power| libm::log(*power)).sum();
        NoiseShape {
            corner,
            powers,
            logs,
        }
    }

    /// ln of the likelihood of powers, and σ², in noise of this shape with at least the power `floor`.
    fn fitted(&self, powers: &[f64], floor: f64) -> [f64; 2] {
        let pairs = powers.iter().zip(&self.powers);
        let sum: f64 = pairs.map(|(power, shape)| power / shape).sum();
        let count = powers.len() as f64;
        let variance = f64::max(sum / count, floor.max(f64::MIN_POSITIVE));
        let likelihood = -0.5 * (count * libm::log(variance) + self.logs + sum / variance);
        [likelihood, variance]
    }
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
    /// Noise that has the same power, N², at each mode, and this variance of a sample, N².
    pub fn even(modes: &Modes, power: f64, variance: f64) -> Spectrum {
        let of_modes = vec![power; modes.count()];
        Spectrum { of_modes, variance }
    }
}

impl Modes {
    /// The modes over `positions` (m) of a sweep under a probe of `radius` (m), whose noise is to be estimated or stated.
    pub fn new(positions: &[f64], radius: f64, noise_is_stated: bool) -> Modes {
        let samples = positions.len();
        let (first, last) = (positions[0], positions[samples - 1]);
        let width = f64::max(last - first, f64::MIN_POSITIVE);
        let u = along(positions, [first, last]);
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
        let (above, quarters) = (count + 1..samples.max(count + 1), 4 * samples);
        let quarter = |of: usize| libm::cos(0.5 * PI * of as f64 / samples as f64);
        let quarters: Vec<f64> = (0..quarters).map(quarter).collect();
        let wave = |sample: usize, mode: usize| {
            quarters[(above.start + mode) * (2 * sample + 1) % quarters.len()]
        };
        let waves = DMatrix::from_fn(samples, above.len(), wave);
        let frequencies: Vec<f64> = above.map(|mode| frequency(mode, samples)).collect();
        let corners = CORNERS
            .iter()
            .flat_map(|corner| WHITE_SHARES.map(|share| (*corner, share)));
        let shapes = std::iter::once(None).chain(corners.map(Some));
        Modes {
            basis,
            u,
            width,
            waves,
            shapes: shapes.map(|of| NoiseShape::new(of, &frequencies)).collect(),
        }
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

    /// The covariance of the modes of errors, each of one sample and common to both channels, of these standard deviations.
    pub fn of_errors(&self, sd: Force<&[f64]>) -> DMatrix<f64> {
        let scaled = |sd: &[f64]| {
            let of = |mode, sample: usize| sd[sample] * self.basis[(sample, mode)];
            DMatrix::from_fn(self.count(), self.samples(), of)
        };
        let [lateral, normal] = sd.map(scaled).into_array();
        let (count, samples) = lateral.shape();
        let mut both = DMatrix::zeros(2 * count, samples);
        both.rows_mut(0, count).copy_from(&lateral);
        both.rows_mut(count, count).copy_from(&normal);
        &both * both.transpose()
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
        let left = DVector::from_vec(self.residual(channel));
        let samples = self.samples();
        let power = |sum: &f64| 2.0 * sum * sum / samples as f64;
        let powers: Vec<f64> = self.waves.tr_mul(&left).iter().map(power).collect();
        let floor = step * step / 12.0;
        let shapes = if is_white {
            &self.shapes[..1]
        } else {
            &self.shapes
        };
        let (mut best, mut most) = ((0.0, None), f64::NEG_INFINITY);
        for shape in shapes {
            let [likelihood, variance] = shape.fitted(&powers, floor);
            let beside = if shape.corner.is_none() {
                COLOURED
            } else {
                0.0
            };
            if likelihood + beside > most {
                (best, most) = ((variance, shape.corner), likelihood + beside);
            }
        }
        let (scale, shape) = best;
        let at = |mode: usize| match shape {
            None => scale,
            Some((corner, share)) => {
                floor.max(scale * coloured(frequency(mode, samples), corner, share))
            }
        };
        Spectrum {
            of_modes: (0..self.count()).map(at).collect(),
            variance: (1..samples).map(at).sum::<f64>() / (samples - 1) as f64,
        }
    }
}

/// From −1 to 1 between two positions, m.
pub fn along(positions: &[f64], [first, last]: [f64; 2]) -> Vec<f64> {
    let width = f64::max(last - first, f64::MIN_POSITIVE);
    let at = |x: &f64| (2.0 * (x - first) / width - 1.0).clamp(-1.0, 1.0);
    positions.iter().map(at).collect()
}

/// The frequency of a mode of so many samples, in radians a sample.
fn frequency(mode: usize, samples: usize) -> f64 {
    PI * mode as f64 / samples as f64
}

/// The power of noise with a corner frequency and a share of white noise, over that at frequency 0.
fn coloured(frequency: f64, corner: f64, share: f64) -> f64 {
    let over = 2.0 * libm::sin(0.5 * frequency) / corner;
    (1.0 - share) / (1.0 + over * over) + share
}
