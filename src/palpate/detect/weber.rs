//! Noise that grows with the force, as Weber's law has it for touch (paper §5): the exact
//! likelihood ratio of two heteroscedastic Gaussian hypotheses.

use super::{DetectError, Force};
use crate::stats::compensated::{self, DoubleDouble};
use crate::stats::error::{check_not_negative, check_positive, representable};

/// The variance of one sample is floor² + (fraction · F)², where F is the force that the hypothesis
/// expects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeberNoise {
    /// The standard deviation at force 0, N.
    pub floor: f64,
    /// The Weber fraction: what a force adds to the standard deviation, in parts of itself.
    pub fraction: f64,
}

impl WeberNoise {
    /// The standard deviation of a sample at a force, N.
    ///
    /// Implements: DET-080.
    pub fn sd(&self, force: f64) -> f64 {
        libm::hypot(self.floor, self.fraction * force)
    }
}

/// Θ = Σ_c Σ_i ½[(F_p − F_0)²/v_0 − (F_p − F_1)²/v_1 + ln(v_0/v_1)] with v_h = floor² + (fraction
/// F_h)².
///
/// # Errors
/// Empty or unequal lengths; NaN or infinity; floor ≤ 0 or fraction < 0; overflow.
///
/// Implements: DET-005, DET-080.
pub fn theta_weber(
    observed: Force<&[f64]>,
    f0: Force<&[f64]>,
    f1: Force<&[f64]>,
    noise: Force<WeberNoise>,
) -> Result<f64, DetectError> {
    let samples = f0.lateral.len();
    observed.check("observed_x", "observed_y", samples)?;
    f0.check("f0_x", "f0_y", samples)?;
    f1.check("f1_x", "f1_y", samples)?;
    for noise in noise.into_array() {
        check_positive("floor", noise.floor)?;
        check_not_negative("fraction", noise.fraction)?;
    }
    let forces = observed.zip(f0.zip(f1)).zip(noise);
    let theta = forces.map(|((observed, (f0, f1)), noise)| {
        compensated::sum(samples, |i| {
            let (sd0, sd1) = (noise.sd(f0[i]), noise.sd(f1[i]));
            // Both quotients may be large and nearly equal, where the difference of their squares would lose more digits.
            let z0 = (observed[i] - f0[i]) / sd0;
            let z1 = (observed[i] - f1[i]) / sd1;
            let half = DoubleDouble::product(0.5 * (z0 - z1), z0 + z1);
            // ln(sd0/sd1), accurate near 1.
            half.plus(DoubleDouble::new(libm::log1p((sd0 - sd1) / sd1), 0.0))
        })
    });
    representable("theta", theta.lateral.plus(theta.normal).value())
}

#[cfg(test)]
mod tests;
