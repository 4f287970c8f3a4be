//! Simulated records. Every trial is a function of the generator and its number alone.

use super::{DetectError, Force, MatchedFilter, Statistic};
use crate::stats::error::check_length;
use crate::stats::random::Generator;

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
        self.generator.normals(trial, 0, residual);
        let (x, y) = residual.split_at_mut(samples);
        let forces = force.zip(self.f0).zip(self.noise_sd);
        for (((force, f0), sd), samples) in forces.zip(Force::new(x, y)).into_array() {
            for ((sample, force), f0) in samples.iter_mut().zip(force).zip(f0) {
                let observed = force + *sample * sd;
                *sample = observed - f0;
            }
        }
        let (x, y) = residual.split_at(samples);
        self.filter.statistic(Force::new(x, y))
    }
}
