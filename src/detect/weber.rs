//! Noise that grows with the force, as Weber's law has it for touch (paper §5): the exact
//! likelihood ratio of two heteroscedastic Gaussian hypotheses.

use super::error::{check_not_negative, check_positive, check_samples, representable};
use super::{Channels, DetectError};
use crate::stats::compensated::{self, DoubleDouble};

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
    fn check(self) -> Result<Self, DetectError> {
        check_positive("floor", self.floor)?;
        check_not_negative("fraction", self.fraction)?;
        Ok(self)
    }

    /// The standard deviation of a sample at a force, N.
    ///
    /// Implements: DET-080.
    pub fn sd(&self, force: f64) -> f64 {
        libm::hypot(self.floor, self.fraction * force)
    }
}

/// Mean and variance of Θ under either hypothesis. Θ is not normal; far tails need simulation, or
/// e^−η bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeberMoments {
    /// Mean under H = 0 and under H = 1.
    pub mean: [f64; 2],
    /// Variance under H = 0 and under H = 1.
    pub variance: [f64; 2],
}

/// Θ = Σ_c Σ_i ½[(F_p − F_0)²/v_0 − (F_p − F_1)²/v_1 + ln(v_0/v_1)] with v_h = floor² + (fraction
/// F_h)².
///
/// ```
/// use palpate::detect::Channels;
/// use palpate::detect::weber::{WeberNoise, theta_weber};
///
/// // One sample, at F_0: θ = ½[0 − (Δ/s_1)²] + ln(s_0/s_1), s = 1 at no force and 5 at 2 N.
/// let channels = |y| Channels { x: &[0.0][..], y };
/// let noise = WeberNoise { floor: 1.0, fraction: 6.0_f64.sqrt() };
/// let noise = Channels { x: noise, y: noise };
/// let theta = theta_weber(channels(&[0.0]), channels(&[0.0]), channels(&[2.0]), noise)?;
/// assert!((theta - (-0.5 * 0.16 - 5.0_f64.ln())).abs() < 1e-14);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// Empty or unequal lengths; NaN or infinity; floor ≤ 0 or fraction < 0; overflow.
///
/// Implements: DET-005, DET-007, DET-080, DET-081.
pub fn theta_weber(
    observed: Channels<&[f64]>,
    f0: Channels<&[f64]>,
    f1: Channels<&[f64]>,
    noise: Channels<WeberNoise>,
) -> Result<f64, DetectError> {
    check_samples("observed_x", observed.x, f0.x.len())?;
    check_samples("observed_y", observed.y, f0.x.len())?;
    check_hypotheses(f0, f1, noise)?;
    let theta = observed
        .zip(f0.zip(f1))
        .zip(noise)
        .map(|((observed, (f0, f1)), noise)| {
            compensated::sum(observed.len(), |i| {
                let (sd0, sd1) = (noise.sd(f0[i]), noise.sd(f1[i]));
                // Both quotients may be large and nearly equal: (z0 − z1)(z0 + z1) keeps the digits
                // of z0 − z1.
                let z0 = (observed[i] - f0[i]) / sd0;
                let z1 = (observed[i] - f1[i]) / sd1;
                let half = DoubleDouble::product(0.5 * (z0 - z1), z0 + z1);
                half.plus(DoubleDouble::new(log_ratio(sd0, sd1), 0.0))
            })
        });
    representable("theta", theta.x.plus(theta.y).value())
}

/// The exact mean and variance of Θ under both hypotheses.
///
/// # Errors
/// As [`theta_weber`].
///
/// Implements: DET-082.
pub fn weber_moments(
    f0: Channels<&[f64]>,
    f1: Channels<&[f64]>,
    noise: Channels<WeberNoise>,
) -> Result<WeberMoments, DetectError> {
    check_hypotheses(f0, f1, noise)?;
    let mut mean = [0.0; 2];
    let mut variance = [0.0; 2];
    for (f0, f1, noise) in [(f0.x, f1.x, noise.x), (f0.y, f1.y, noise.y)] {
        for (&f0, &f1) in f0.iter().zip(f1) {
            let (sd0, sd1) = (noise.sd(f0), noise.sd(f1));
            let ratio = (sd0 / sd1) * (sd0 / sd1);
            let (shift0, shift1) = ((f1 - f0) / sd0, (f1 - f0) / sd1);
            let logarithm = log_ratio(sd0, sd1);
            // Under H = 0, n ~ N(0, v0): ½[n²/v0 − (n − Δ)²/v1] is quadratic in n, and n and n² are
            // uncorrelated.
            mean[0] += 0.5 * ((1.0 - ratio) - shift1 * shift1) + logarithm;
            mean[1] += 0.5 * ((1.0 / ratio - 1.0) + shift0 * shift0) + logarithm;
            variance[0] += 0.5 * (1.0 - ratio) * (1.0 - ratio) + ratio * shift1 * shift1;
            variance[1] +=
                0.5 * (1.0 / ratio - 1.0) * (1.0 / ratio - 1.0) + shift0 * shift0 / ratio;
        }
    }
    for moment in mean.iter().chain(&variance) {
        representable("moment", *moment)?;
    }
    Ok(WeberMoments { mean, variance })
}

/// ln(a/b), accurate near 1.
fn log_ratio(a: f64, b: f64) -> f64 {
    libm::log1p((a - b) / b)
}

fn check_hypotheses(
    f0: Channels<&[f64]>,
    f1: Channels<&[f64]>,
    noise: Channels<WeberNoise>,
) -> Result<(), DetectError> {
    let samples = f0.x.len();
    check_samples("f0_x", f0.x, samples)?;
    check_samples("f0_y", f0.y, samples)?;
    check_samples("f1_x", f1.x, samples)?;
    check_samples("f1_y", f1.y, samples)?;
    noise.x.check()?;
    noise.y.check()?;
    Ok(())
}

#[cfg(test)]
mod tests;
