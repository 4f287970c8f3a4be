//! Whether a record fits either hypothesis, and if not, what is probably the cause.

use std::fmt;

use serde::Serialize;

use super::design::{Design, Unknown, channels, squares};
use super::judge::{Correlation, Noise, Question};
use super::{Trace, refused};
use crate::detect::DetectError;
use crate::detect::correlation::{correlation_length, ljung_box};
use crate::detect::nuisance::{Nuisances, SubspaceTest};
use crate::force::Force;
use crate::refusal::Refusal;
use crate::stats::error::check_positive;
use crate::stats::noncentral::{Tail, chi_square_point};

/// A record that fits is refused with at most this probability, by each of its checks.
pub const MISFIT_RATE: f64 = 1e-6;
/// A channel whose autocorrelations are less probable than this in white noise is taken for coloured.
pub const WHITENESS: f64 = 1e-3;
/// Lags of the test for white noise, at most a fifth of the samples.
const LAGS: usize = 20;
/// A block holds so many lengths of the correlation.
const BLOCK: f64 = 5.0;
/// Degrees of freedom below which the blocks tell too little of their own noise.
const LEAST_DEGREES: f64 = 4.0;
/// Least samples of a blank sweep.
const LEAST_BLANK: usize = 100;
/// What an unknown level of noise may be off by from the one that is stated.
const STATED_WITHIN: f64 = 2.0;
/// The forces of a record are between −0.4 and 2.5 times those of the reference, or no gel that the maps are for made them. A
/// record that was set to zero at its start is near 0.
const LEVEL: [f64; 2] = [-0.4, 2.5];
/// From here on, or below its inverse, another unit is likelier than anything else.
const UNIT: f64 = 100.0;

/// How well a record fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Standard deviation of the noise that the fit is judged by, N.
    pub noise_sd: Force<f64>,
    /// The residual chi-square: Σ of the squares that neither hypothesis explains, over the variance of the noise.
    pub chi_square: f64,
    /// The range of the residual chi-square of a record that fits, but for the probability [`MISFIT_RATE`]; none if the noise is not stated.
    pub limits: Option<[f64; 2]>,
    /// Degrees of freedom of the squares, if all samples were independent.
    pub degrees: f64,
    /// The probability of such autocorrelations in white noise, of the worse channel.
    pub whiteness: f64,
    /// Samples that are taken together.
    pub block: usize,
    /// The effective number of independent samples, of both channels.
    pub effective_samples: f64,
    /// Σ F_p F_0 / Σ F_0², both over the noise; none if the noise hides it.
    pub level: Option<f64>,
    /// The blocks should be longer, and would be too few.
    is_short: bool,
}

/// Why a record cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The forces have the other sign.
    Sign,
    /// The forces are in another unit.
    ForceUnit,
    /// The forces are too large for this gel at this depth.
    Level,
    /// The noise was stated in another unit.
    NoiseUnit,
    /// There is more noise than was stated, or what the maps do not hold.
    Misfit,
    /// There is less noise than was stated.
    NoiseTooSmall,
    /// The noise is so correlated that too few independent samples remain.
    TooFewSamples,
    /// The signal is there with the other sign.
    Opposite,
    /// The sensor was at the end of its range.
    Saturated,
    /// Too many samples are far from those beside them.
    Glitches,
    /// The forces are too small for this gel at this depth.
    NoContact,
    /// The sweep is too short to show an inclusion.
    Narrow,
    /// The map with the inclusion has the smaller forces.
    Exchanged,
    /// Some disturbance explains the record as well as an inclusion does.
    TooWeak,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Cause::Sign => "the forces have the other sign than those of the maps",
            Cause::ForceUnit => "the forces are in another unit than the header says, such as mN",
            Cause::Level => "the forces are too large for the maps' gel at this depth",
            Cause::NoiseUnit => "the noise is in another unit than N, such as mN",
            Cause::Misfit => "there is more noise than was stated, or a force that the maps do not hold: another offset, drift, gain or depth than is taken as known, or other maps",
            Cause::NoiseTooSmall => "there is less noise than was stated, or the record was smoothed",
            Cause::TooFewSamples => "the noise is so correlated that too few independent samples remain",
            Cause::Saturated => "the sensor was at the end of its range: many samples have its largest or least force",
            Cause::Glitches => "too many samples are far from those beside them",
            Cause::NoContact => "the forces are too small for the maps' gel at this depth: the probe does not touch, or the sensor was set to zero on the gel",
            Cause::Narrow => "the sweep is shorter than half the radius of the probe: the positions may be in another unit, such as m",
            Cause::Exchanged => "the map with the inclusion has smaller forces than the reference: the maps may be exchanged",
            Cause::TooWeak => "the record is too weak to tell an inclusion from what else may bend it",
            Cause::Opposite => "the signal is there with the other sign: the maps may be swapped",
        })
    }
}

/// The causes why a record cannot be judged, in words.
pub fn reasons(causes: &[Cause]) -> String {
    let causes: Vec<_> = causes.iter().map(Cause::to_string).collect();
    causes.join("; ")
}

impl Fit {
    /// How well `white`, the parts of `record` over the standard deviations `noise_sd`, fits.
    ///
    /// Implements: TRC-070, TRC-072.
    pub fn new(
        question: &Question<'_>,
        white: &Design,
        noise_sd: Force<f64>,
    ) -> Result<Fit, DetectError> {
        let (left, explained) = white.unexplained()?;
        let samples = white.samples() as f64;
        let degrees = 2.0 * samples - explained as f64;
        let chi_square = squares(&left);
        let lags = LAGS.min(white.samples() / 5);
        let (whiteness, found) = dependence(channels(&left), lags)?;
        let length = match question.noise.correlation {
            Correlation::Known(length) => length,
            Correlation::OfRecord if whiteness < WHITENESS => {
                // What was fitted has taken its share of the slow noise with it.
                let taken = 0.5 * explained as f64 * found / samples;
                found / (1.0 - taken.min(0.5))
            }
            Correlation::None | Correlation::OfRecord => 1.0,
        };
        let wanted = if length > 1.0 {
            libm::ceil(BLOCK * length)
        } else {
            1.0
        };
        let most = libm::floor(2.0 * samples / (explained as f64 + LEAST_DEGREES)).max(1.0);
        let effective_samples = 2.0 * samples / length;
        let is_exact = !question.is_unknown(Unknown::Variance) && wanted == 1.0;
        let within = if is_exact {
            1.0
        } else {
            STATED_WITHIN * STATED_WITHIN
        };
        let free = effective_samples - explained as f64;
        let limits = question
            .noise
            .sd
            .map(|_| limits(free, within))
            .transpose()?;
        Ok(Fit {
            noise_sd,
            chi_square,
            limits: limits.map(|limits| limits.map(|limit| limit * degrees)),
            degrees,
            whiteness,
            block: wanted.min(most) as usize,
            is_short: wanted > most,
            effective_samples,
            level: white.level(),
        })
    }

    /// Whether the record has as much noise as was stated, if it was.
    pub fn noise_is_right(&self) -> bool {
        self.limits
            .is_none_or(|[low, high]| (low..=high).contains(&self.chi_square))
    }

    /// Why the record cannot be judged, the likeliest cause first; none if it can.
    ///
    /// Implements: TRC-070, TRC-075.
    pub fn causes(&self, test: &SubspaceTest) -> Result<Vec<Cause>, DetectError> {
        let level = self.level.unwrap_or(1.0);
        let excess = libm::sqrt(self.chi_square / self.degrees);
        let is_small = self.limits.is_some_and(|[low, _]| self.chi_square < low);
        let is_far = !(1.0 / UNIT..UNIT).contains(&excess);
        let wrong = !self.noise_is_right();
        let checks = [
            (level < LEVEL[0], Cause::Sign),
            (level > UNIT, Cause::ForceUnit),
            (level > LEVEL[1], Cause::Level),
            (wrong && is_far, Cause::NoiseUnit),
            (is_small, Cause::NoiseTooSmall),
            (wrong && !is_small, Cause::Misfit),
            (test.opposite()? < MISFIT_RATE, Cause::Opposite),
            (self.is_short, Cause::TooFewSamples),
        ];
        let causes = checks.into_iter().filter(|(is_so, _)| *is_so);
        Ok(causes.map(|(_, cause)| cause).collect())
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
            let mut left: Force<Vec<f64>> = Force::new(column(1), column(2));
            let root = libm::sqrt(samples as f64 - 2.0);
            let channels = Force::new(&mut left.lateral, &mut left.normal);
            let sd = channels.map(|channel| lines.project(channel) / root);
            check_positive("noise_sd_lateral_n", sd.lateral)?;
            check_positive("noise_sd_normal_n", sd.normal)?;
            let (whiteness, length) = dependence(left.as_deref(), LAGS)?;
            let correlation = if whiteness < WHITENESS {
                Correlation::Known(length)
            } else {
                Correlation::None
            };
            Ok(Noise {
                sd: Some(sd),
                correlation,
            })
        };
        told().map_err(|error| refused(error).in_file(&*blank.file))
    }
}

/// The smaller probability of white noise having such autocorrelations, 1 without lags, and the longer correlation of both channels.
fn dependence(noise: Force<&[f64]>, lags: usize) -> Result<(f64, f64), DetectError> {
    let (mut whiteness, mut length) = (1.0_f64, 1.0_f64);
    for channel in noise.into_array() {
        if lags > 0 {
            whiteness = whiteness.min(ljung_box(channel, lags)?);
        }
        length = length.max(correlation_length(channel));
    }
    Ok((whiteness, length))
}

/// The range of the mean square of white noise of variance 1 with `degrees` of freedom, but for the probability [`MISFIT_RATE`]; the
/// variance may be off by the factor `within`.
fn limits(degrees: f64, within: f64) -> Result<[f64; 2], DetectError> {
    let degrees = degrees.max(1.0);
    let point = |tail| Ok(chi_square_point(tail, degrees)? / degrees);
    let [low, high] = [Tail::Lower, Tail::Upper].map(|tail| point(tail(0.5 * MISFIT_RATE)));
    Ok([low? / within, high? * within])
}
