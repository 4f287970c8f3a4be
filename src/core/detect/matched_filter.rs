//! The matched filter and the sufficient statistic Θ in white noise, paper equations (2) to (7).

use super::noise::WhiteNoise;
use super::{DetectError, Force};
use crate::stats::compensated::{self, DoubleDouble};
use crate::stats::error::representable;

/// The filter h of equations (2) and (4), for a template Δ = F_1 − F_0 and independent noise of
/// constant standard deviation s in each channel.
///
/// It borrows the template and keeps its energy ΣΔ², so that each further record costs one pass.
///
/// ```
/// use palpate_core::force::Force;
/// use palpate_core::detect::MatchedFilter;
///
/// let template = Force { lateral: &[0.0; 3][..], normal: &[0.125, 0.25, 0.25] };
/// let filter = MatchedFilter::new(template, Force { lateral: 0.5, normal: 0.125 })?;
/// assert_eq!(filter.samples(), 3);
/// // γ² = Σ (Δ/s)² = 1 + 4 + 4 = b²/σ².
/// assert_eq!(filter.gamma(), 3.0);
/// assert!((filter.b().normal / filter.sigma().normal - 3.0).abs() < 1e-15);
/// // The middle between the hypotheses.
/// let halfway = Force { lateral: &[0.0; 3][..], normal: &[0.0625, 0.125, 0.125] };
/// assert_eq!(filter.statistic(halfway)?.theta, 0.0);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MatchedFilter<'a> {
    template: Force<&'a [f64]>,
    noise: Force<WhiteNoise>,
    /// ΣΔ² of each channel, in units of its scaled force squared.
    energy: Force<DoubleDouble>,
    gamma: f64,
}

/// What the filter says about one record.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistic {
    /// Y(0) of equation (5), N. A channel whose template is zero has 0.
    pub y: Force<f64>,
    /// θ of equation (7), the log-likelihood ratio.
    pub theta: f64,
    /// γ, the signal-to-noise ratio of the hypotheses.
    pub gamma: f64,
}

impl<'a> MatchedFilter<'a> {
    /// The filter for `template` (N samples a channel, N) in noise of standard deviation `noise_sd`
    /// a sample (N).
    ///
    /// # Errors
    /// Empty, unequal or non-finite templates; `noise_sd` not positive and finite; γ² beyond the
    /// largest number.
    ///
    /// Implements: DET-005, DET-013.
    pub fn new(template: Force<&'a [f64]>, noise_sd: Force<f64>) -> Result<Self, DetectError> {
        template.check("template_x", "template_y", template.lateral.len())?;
        let noise = WhiteNoise::new(noise_sd)?;
        let channels = template.zip(noise);
        let energy = channels.map(|(template, noise)| noise.dot(template, template));
        let gamma = noise.gamma(energy)?;
        Ok(Self {
            template,
            noise,
            energy,
            gamma,
        })
    }

    /// N, the number of samples in each channel.
    pub fn samples(&self) -> usize {
        self.template.lateral.len()
    }

    /// b_c = (Σ Δ_c²/N)^½, the root mean square of the template, N.
    ///
    /// Implements: DET-013.
    pub fn b(&self) -> Force<f64> {
        let samples = self.samples() as f64;
        let energies = self.energy.zip(self.noise);
        energies.map(|(energy, noise)| libm::sqrt(energy.value() / samples) / noise.factor)
    }

    /// σ_c = s_c/√N, the standard deviation of Y_c(0), N.
    ///
    /// Implements: DET-013.
    pub fn sigma(&self) -> Force<f64> {
        let root = libm::sqrt(self.samples() as f64);
        self.noise
            .map(|noise| noise.scaled_sd() / root / noise.factor)
    }

    /// γ = (Σ_c Σ_i Δ²/s²)^½, the signal-to-noise ratio.
    ///
    /// Implements: DET-013, DET-001.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// y(0) and θ of a residual r = F_p − F_0 (N samples a channel, N).
    ///
    /// # Errors
    /// Lengths other than the template's; NaN or infinity in the residual; overflow.
    ///
    /// Implements: DET-005, DET-015, DET-014, DET-001, CON-007.
    pub fn statistic(&self, residual: Force<&[f64]>) -> Result<Statistic, DetectError> {
        residual.check("residual_x", "residual_y", self.samples())?;
        let pairs = residual.zip(self.template).zip(self.noise);
        let cross = pairs.map(|((residual, template), noise)| noise.dot(residual, template));
        statistic(cross, self.energy, self.noise, self.samples(), self.gamma)
    }
}

/// y(0), θ and γ of a record F_p against the forces F_0 and F_1 that the hypotheses expect (N
/// samples a channel each, N), in noise of standard deviation `noise_sd` a sample. The differences
/// are not rounded.
///
/// ```
/// use palpate_core::force::Force;
/// use palpate_core::detect::theta_of_record;
///
/// let f0 = Force { lateral: &[0.25, 0.0, -0.25][..], normal: &[1.0, 1.0, 1.0] };
/// let f1 = Force { lateral: &[0.25, 0.0, -0.25][..], normal: &[1.125, 1.25, 1.25] };
/// let noise_sd = Force { lateral: 0.125, normal: 0.125 };
/// // What either hypothesis expects: ∓γ²/2.
/// assert_eq!(theta_of_record(f0, f0, f1, noise_sd)?.theta, -4.5);
/// assert_eq!(theta_of_record(f1, f0, f1, noise_sd)?.theta, 4.5);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
///
/// # Errors
/// Empty or unequal lengths; NaN or infinity; `noise_sd` not positive and finite; overflow.
///
/// Implements: DET-005, DET-015, DET-014, ERR-001.
pub fn theta_of_record(
    observed: Force<&[f64]>,
    f0: Force<&[f64]>,
    f1: Force<&[f64]>,
    noise_sd: Force<f64>,
) -> Result<Statistic, DetectError> {
    let samples = observed.lateral.len();
    observed.check("observed_x", "observed_y", samples)?;
    f0.check("f0_x", "f0_y", samples)?;
    f1.check("f1_x", "f1_y", samples)?;
    let noise = WhiteNoise::new(noise_sd)?;
    let forces = observed.zip(f0.zip(f1)).zip(noise);
    let sums = forces.map(|((observed, (f0, f1)), noise)| {
        let difference = |a: &[f64], b: &[f64], i: usize| {
            DoubleDouble::new(a[i] * noise.factor, -b[i] * noise.factor)
        };
        let template = |i| difference(f1, f0, i);
        let cross = compensated::sum(samples, |i| {
            product(difference(observed, f0, i), template(i))
        });
        let energy = compensated::sum(samples, |i| product(template(i), template(i)));
        (cross, energy)
    });
    let (cross, energy) = (sums.map(|(cross, _)| cross), sums.map(|(_, energy)| energy));
    statistic(cross, energy, noise, samples, noise.gamma(energy)?)
}

/// The product of two double-doubles, with a relative error of a few u².
fn product(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let main = DoubleDouble::product(a.high, b.high);
    DoubleDouble {
        high: main.high,
        low: main.low + (a.high * b.low + a.low * b.high),
    }
}

/// Equations (5) and (7) from Σ rΔ and ΣΔ².
fn statistic(
    cross: Force<DoubleDouble>,
    energy: Force<DoubleDouble>,
    noise: Force<WhiteNoise>,
    samples: usize,
    gamma: f64,
) -> Result<Statistic, DetectError> {
    let y = cross
        .zip(energy)
        .zip(noise)
        .map(|((cross, energy), noise)| {
            let energy = energy.value();
            let weight = libm::sqrt(energy * samples as f64);
            // The matched filter of a template of zeros is not defined, and its weight in θ is zero.
            if energy == 0.0 {
                0.0
            } else if weight == f64::INFINITY {
                // Refused: the quotient would be 0.
                f64::NAN
            } else {
                cross.value() / weight / noise.factor
            }
        });
    representable("y_x", y.lateral)?;
    representable("y_y", y.normal)?;
    let theta = noise.theta(cross, energy)?;
    Ok(Statistic { y, theta, gamma })
}
