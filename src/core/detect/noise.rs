//! White noise, and what sums over a record amount to in it.

use super::{DetectError, Force};
use crate::stats::compensated::{self, DoubleDouble};
use crate::stats::error::{check_positive, representable};

/// White noise of one channel, with a power of two that brings it near 1: squares of forces are taken in these units, where they
/// neither overflow nor underflow unless Δ/s itself is absurd.
///
/// Implements: DET-016.
#[derive(Debug, Clone, Copy)]
pub(super) struct WhiteNoise {
    /// The standard deviation s of a sample, N.
    pub sd: f64,
    /// A power of two, 1/N.
    pub factor: f64,
}

impl WhiteNoise {
    /// Noise of standard deviation `sd` a sample (N), if that is finite and above 0.
    pub fn new(sd: Force<f64>) -> Result<Force<WhiteNoise>, DetectError> {
        check_positive("noise_sd_x", sd.lateral)?;
        check_positive("noise_sd_y", sd.normal)?;
        let factor = compensated::reciprocal_power_of_two;
        Ok(sd.map(|sd| WhiteNoise {
            sd,
            factor: factor(sd),
        }))
    }

    /// s in units of the scaled force.
    pub fn scaled_sd(self) -> f64 {
        self.sd * self.factor
    }

    /// Σ ab in units of the scaled force squared.
    pub fn dot(self, a: &[f64], b: &[f64]) -> DoubleDouble {
        compensated::dot(a, b, self.factor)
    }

    fn over_variance(self, sum: f64) -> f64 {
        sum / (self.scaled_sd() * self.scaled_sd())
    }
}

impl Force<WhiteNoise> {
    /// Σ_c Σ ab/s² from Σ ab of each channel.
    pub(super) fn total(self, sums: Force<DoubleDouble>) -> f64 {
        let [x, y] = self.zip(sums).into_array();
        x.0.over_variance(x.1.value()) + y.0.over_variance(y.1.value())
    }

    /// γ from ΣΔ² of each channel.
    pub(super) fn gamma(self, energy: Force<DoubleDouble>) -> Result<f64, DetectError> {
        representable("gamma", libm::sqrt(self.total(energy)))
    }

    /// θ from Σ rΔ and ΣΔ² of each channel, equation (7). With b/σ² (Y − b/2) = (Σ rΔ − ½ΣΔ²)/s², the weight 1/N drops out, and
    /// the one subtraction that may cancel is done in twice the working precision.
    pub(super) fn theta(
        self,
        cross: Force<DoubleDouble>,
        energy: Force<DoubleDouble>,
    ) -> Result<f64, DetectError> {
        let channels = cross.zip(energy);
        let difference = channels.map(|(cross, energy)| cross.plus(energy.scaled(-0.5)));
        representable("theta", self.total(difference))
    }
}
