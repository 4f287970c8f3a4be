//! Whether a record fits either hypothesis.

use super::cause::Cause;
use super::contact::{in_air, level, wrong_gain};
use super::design::{Design, squares, whitened};
use super::question::{Correlation, Noise, Question, Unknown};
use super::{Trace, refused};
use crate::detect::DetectError;
use crate::detect::correlation::{correlation_length, ljung_box, theta_correlated};
use crate::detect::nuisance::Nuisances;
use crate::force::Force;
use crate::refusal::Refusal;
use crate::stats::error::check_positive;
use crate::stats::noncentral::{Tail, chi_square_point};

/// A record that fits is refused with at most this probability, by each of its checks.
pub const MISFIT_RATE: f64 = 1e-6;
/// A blank sweep whose autocorrelations are less probable than this in white noise is taken for coloured.
const WHITENESS: f64 = 1e-3;
/// θ of correlated noise from which a record is taken for coloured: ln 100.
const CORRELATED: f64 = 4.605_170_185_988_092;
/// Lags of the test for white noise, at most a fifth of the samples.
const LAGS: usize = 20;
/// Least samples of a blank sweep.
const LEAST_BLANK: usize = 100;
/// What an unknown level of noise may be off by from the one that is stated.
const STATED_WITHIN: f64 = 2.0;

/// How well a record fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Standard deviation of the noise that the fit is judged by, N; none of a force that the record does not have.
    pub noise_sd: Force<Option<f64>>,
    /// The residual chi-square: Σ of the squares that neither hypothesis explains, over the variance of the noise.
    pub chi_square: f64,
    /// The range of the residual chi-square of a record that fits, but for the probability [`MISFIT_RATE`]; none if the noise is not stated.
    pub limits: Option<[f64; 2]>,
    /// Degrees of freedom of the squares.
    pub degrees: f64,
    /// The probability of such autocorrelations in white noise, of the worse channel; none if the noise is stated to be white.
    pub whiteness: Option<f64>,
    /// ln of the likelihood ratio of noise whose neighbours are correlated to white noise; none if the noise is stated to be white.
    pub theta_correlated: Option<f64>,
    /// Σ F f/Σ f² of the normal forces; none if the sensor was set to zero on the gel.
    pub level: Option<f64>,
    /// Samples in air at the start and at the end of the file.
    pub in_air: [usize; 2],
}

impl Fit {
    /// How well `white`, the parts of `design` over their noise, fits; `noise_sd` are the standard deviations of the forces.
    ///
    /// Implements: TRC-070, TRC-016, TRC-017.
    pub fn new(
        question: &Question<'_>,
        design: &Design,
        white: &Design,
        noise_sd: Force<f64>,
    ) -> Result<Fit, DetectError> {
        let (left, explained) = white.unexplained()?;
        let degrees = left.len() as f64 - explained.get() as f64;
        let chi_square = squares(&left);
        let tested =
            (question.noise.correlation != Correlation::None).then(|| white.channels(&left));
        let lags = LAGS.min(white.samples / 5);
        let whiteness = tested.map(|noise| whiteness(noise, lags)).transpose()?;
        // Over the noise that the record itself has. The fit of smooth columns lowers the products by one each.
        let scale = if chi_square > 0.0 {
            degrees / chi_square
        } else {
            0.0
        };
        let products = |noise| scale * neighbours(noise) + explained.get() as f64;
        let theta_correlated = tested.map(|noise| theta_correlated(products(noise), degrees));
        let within = if question.is_unknown(Unknown::Variance) {
            STATED_WITHIN * STATED_WITHIN
        } else {
            1.0
        };
        let limits = question.noise.sd.map(|_| limits(degrees, within));
        let normal = |part: &[f64]| -> Vec<f64> {
            let white = whitened(part, design.samples, noise_sd);
            let normal = design.channels(&white).normal.iter();
            normal.map(|of| noise_sd.normal * of).collect()
        };
        let expected = normal(&design.reference);
        let residual = normal(&design.residual);
        let forces: Vec<f64> = residual.iter().zip(&expected).map(|(r, f)| r + f).collect();
        let touches = !question.is_zeroed;
        let mut ends = match touches {
            true => in_air(&forces, &expected, noise_sd.normal * noise_sd.normal),
            false => [0; 2],
        };
        if design.is_reversed {
            ends.reverse();
        }
        let lateral = white.has_lateral().then_some(noise_sd.lateral);
        Ok(Fit {
            noise_sd: Force::new(lateral, Some(noise_sd.normal)),
            chi_square,
            limits: limits.transpose()?,
            degrees,
            whiteness,
            theta_correlated,
            level: touches.then(|| level(&forces, &expected)),
            in_air: ends,
        })
    }

    /// Whether the record has as much noise as was stated, if it was.
    pub fn noise_is_right(&self) -> bool {
        self.limits
            .is_none_or(|[low, high]| (low..=high).contains(&self.chi_square))
    }

    /// Why the record cannot be judged; none if it can.
    ///
    /// Implements: TRC-070, TRC-075, TRC-016, TRC-017.
    pub fn causes(&self) -> Vec<Cause> {
        let is_coloured = self.whiteness.is_some_and(|p| p < MISFIT_RATE)
            || self
                .theta_correlated
                .is_some_and(|theta| theta >= CORRELATED);
        let level = self.level.and_then(wrong_gain);
        let checks = [
            (self.in_air != [0; 2], Cause::InAir),
            (!self.noise_is_right(), Cause::Misfit),
            (is_coloured, Cause::Coloured),
        ];
        let causes = checks.into_iter().filter(|(is_so, _)| *is_so);
        level
            .into_iter()
            .chain(causes.map(|(_, cause)| cause))
            .collect()
    }
}

impl Noise {
    /// The noise of a blank sweep, whose forces are an offset and a drift.
    ///
    /// # Errors
    /// Too few samples; a channel without noise.
    ///
    /// Implements: TRC-076.
    pub fn of_blank(blank: &Trace) -> Result<Noise, Refusal> {
        let samples = blank.samples.len();
        let expected = format!("give at least {LEAST_BLANK}, to estimate the noise");
        let few = Refusal::state(format!("{samples} samples"), expected).in_file(&*blank.file);
        few.when(samples < LEAST_BLANK)?;
        let missing = Refusal::state(
            "a blank sweep without lateral forces",
            "state the noise (--noise-sd-n)",
        );
        missing.in_file(&*blank.file).when(!blank.has.lateral)?;
        let told = || {
            let step = 2.0 / (samples - 1) as f64;
            let line = (0..samples).map(|sample| step * sample as f64 - 1.0);
            let mut lines: Vec<f64> = vec![1.0; samples];
            lines.extend(line);
            let lines = Nuisances::new(&mut lines, samples)?;
            let column = |channel: usize| {
                let samples = blank.samples.iter();
                samples.map(|(_, sample)| sample[channel]).collect()
            };
            let mut left: Force<Vec<f64>> = Force {
                lateral: column(2),
                normal: column(1),
            };
            let root = libm::sqrt(samples as f64 - 2.0);
            let channels = Force::new(&mut left.lateral, &mut left.normal);
            let length = channels.map(|channel| lines.project(channel));
            let sd = Force::new(length.lateral? / root, length.normal? / root);
            check_positive("noise_sd_lateral_n", sd.lateral)?;
            check_positive("noise_sd_normal_n", sd.normal)?;
            let left = left.as_deref();
            let correlation = if whiteness(left, LAGS)? < WHITENESS {
                let lengths = left.map(correlation_length);
                Correlation::Known(lengths.lateral.max(lengths.normal))
            } else {
                // The record's own may be another.
                Correlation::OfRecord
            };
            Ok(Noise {
                sd: Some(sd),
                correlation,
            })
        };
        told().map_err(|error| refused(error).in_file(&*blank.file))
    }
}

/// The sum of the products of neighbours in all channels.
fn neighbours(noise: Force<&[f64]>) -> f64 {
    let pairs = noise.into_array().into_iter().flat_map(|of| of.windows(2));
    pairs.map(|pair| pair[0] * pair[1]).sum()
}

/// The smallest probability of white noise having such autocorrelations, of the channels that are there; 1 without lags.
fn whiteness(noise: Force<&[f64]>, lags: usize) -> Result<f64, DetectError> {
    if lags == 0 {
        return Ok(1.0);
    }
    let channels = noise.into_array().into_iter();
    let mut there = channels.filter(|channel| !channel.is_empty());
    there.try_fold(1.0, |least: f64, channel| {
        Ok(least.min(ljung_box(channel, lags)?))
    })
}

/// The range of χ² with `degrees` of freedom, but for the probability [`MISFIT_RATE`]; the variance may be off by the factor
/// `within`.
fn limits(degrees: f64, within: f64) -> Result<[f64; 2], DetectError> {
    let point = |tail| chi_square_point(tail, degrees.max(1.0));
    let [low, high] = [Tail::Lower, Tail::Upper].map(|tail| point(tail(0.5 * MISFIT_RATE)));
    Ok([low? / within, high? * within])
}
