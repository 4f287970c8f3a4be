//! Simulated records and statistics. Every trial is a function of the generator and its number
//! alone.

use super::scan::Scan;
use super::{DetectError, Force, MatchedFilter, Statistic};
use crate::stats::error::{check_finite, check_length, check_not_negative};
use crate::stats::random::Generator;
use core::ops::{Range, RangeInclusive};

/// Records F_p = F + noise, and what the matched filter for F_0 against F_1 says about them.
#[derive(Debug, Clone, Copy)]
pub struct Simulation<'a> {
    filter: MatchedFilter<'a>,
    f0: Force<&'a [f64]>,
    noise_sd: Force<f64>,
    generator: Generator,
}

impl<'a> Simulation<'a> {
    /// A simulation of records of N samples a channel, with forces in N.
    ///
    /// # Errors
    /// As [`MatchedFilter::new`]; `f0` not of the template's length, or not finite.
    pub fn new(
        f0: Force<&'a [f64]>,
        template: Force<&'a [f64]>,
        noise_sd: Force<f64>,
        generator: Generator,
    ) -> Result<Self, DetectError> {
        let filter = MatchedFilter::new(template, noise_sd)?;
        f0.check("f0_x", "f0_y", filter.samples())?;
        Ok(Self {
            filter,
            f0,
            noise_sd,
            generator,
        })
    }

    /// The filter that judges the records.
    pub fn filter(&self) -> &MatchedFilter<'a> {
        &self.filter
    }

    /// y and θ of the record with number `trial` when the true force is `force` (F_0 under H = 0,
    /// F_1 under H = 1). Lateral samples take the trial's deviates 0 … N−1, normal ones N … 2N−1.
    /// `residual` (2N numbers, x then y) is left holding F_p − F_0.
    ///
    /// # Errors
    /// Lengths that differ; a force that is not finite.
    ///
    /// Implements: DET-113.
    pub fn trial(
        &self,
        trial: u64,
        force: Force<&[f64]>,
        residual: &mut [f64],
    ) -> Result<Statistic, DetectError> {
        let samples = self.filter.samples();
        check_length("force_x", samples, force.lateral.len())?;
        check_length("force_y", samples, force.normal.len())?;
        check_length("residual", 2 * samples, residual.len())?;
        let noise = noise(&self.generator, trial, self.noise_sd, residual);
        let forces = force.zip(self.f0).zip(noise).into_array();
        for ((force, f0), samples) in forces {
            for ((sample, force), f0) in samples.iter_mut().zip(force).zip(f0) {
                let observed = force + *sample;
                *sample = observed - f0;
            }
        }
        let (x, y) = residual.split_at(samples);
        self.filter.statistic(Force::new(x, y))
    }
}

/// Fills `samples` with the noise of a trial of N samples a channel: lateral ones, then normal ones.
fn noise<'a>(
    generator: &Generator,
    trial: u64,
    sd: Force<f64>,
    samples: &'a mut [f64],
) -> Force<&'a mut [f64]> {
    generator.normals(trial, 0, samples);
    let (x, y) = samples.split_at_mut(samples.len() / 2);
    Force::new(x, y).zip(sd).map(|(samples, sd)| {
        samples.iter_mut().for_each(|sample| *sample *= sd);
        samples
    })
}

/// θ drawn from its own law (8), N(±γ²/2, γ²), for the trials `first`, `first` + 1, …
///
/// # Errors
/// γ not finite or < 0, or γ² not representable.
///
/// Implements: DET-114.
pub fn draw_theta(
    generator: &Generator,
    gamma: f64,
    inclusion: bool,
    first: u64,
    theta: &mut [f64],
) -> Result<(), DetectError> {
    check_not_negative("gamma", gamma)?;
    let half = check_finite("gamma squared", 0.5 * gamma * gamma)?;
    let mean = if inclusion { half } else { -half };
    generator.normals(0, first, theta);
    for theta in theta {
        *theta = mean + gamma * *theta;
    }
    Ok(())
}

/// How many of the given trials of pure noise have Θ_max ≥ η over the candidate shifts: with
/// [`crate::stats::binomial::clopper_pearson`] the Monte Carlo value of the false-alarm rate and
/// its interval, beside the bound of [`super::position::MaximumLaw`]. `residual` is scratch of 2N
/// numbers.
///
/// # Errors
/// η not finite; no shifts; scratch of another length.
///
/// Implements: DET-115.
pub fn count_false_alarms(
    scan: &Scan<'_>,
    shifts: RangeInclusive<isize>,
    eta: f64,
    generator: &Generator,
    trials: Range<u64>,
    residual: &mut [f64],
) -> Result<u64, DetectError> {
    check_finite("eta", eta)?;
    check_length("residual", scan.samples().saturating_mul(2), residual.len())?;
    let mut alarms = 0;
    for trial in trials {
        let noise = noise(generator, trial, scan.noise_sd(), residual);
        let maximum = scan.maximum(noise.as_deref(), shifts.clone())?;
        alarms += u64::from(maximum.theta >= eta);
    }
    Ok(alarms)
}
