//! The matched filter and the sufficient statistic Θ in white noise, paper equations (2) to (7).

use super::error::{check_positive, check_samples, representable};
use super::{Channels, DetectError};
use crate::stats::compensated::{self, DoubleDouble};

/// The filter h of equations (2) and (4), for a template Δ = F_1 − F_0 and independent noise of
/// constant standard deviation s in each channel.
///
/// It borrows the template and keeps its energy ΣΔ², so that each further record costs one pass.
///
/// ```
/// use palpate::detect::{Channels, MatchedFilter};
///
/// let template = Channels { x: &[0.0; 3][..], y: &[0.125, 0.25, 0.25] };
/// let filter = MatchedFilter::new(template, Channels { x: 0.5, y: 0.125 })?;
/// assert_eq!(filter.samples(), 3);
/// // γ² = Σ (Δ/s)² = 1 + 4 + 4 = b²/σ².
/// assert_eq!(filter.gamma(), 3.0);
/// assert!((filter.b().y / filter.sigma().y - 3.0).abs() < 1e-15);
/// // The middle between the hypotheses.
/// let halfway = Channels { x: &[0.0; 3][..], y: &[0.0625, 0.125, 0.125] };
/// assert_eq!(filter.statistic(halfway)?.theta, 0.0);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MatchedFilter<'a> {
    template: Channels<&'a [f64]>,
    scale: Channels<Scale>,
    /// Σ (Δ/s)² of each channel, where s counts as the number in `Scale::noise_sd`.
    energy: Channels<DoubleDouble>,
    gamma: f64,
}

/// What the filter says about one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistic {
    /// Y(0) of equation (5), N. A channel whose template is zero has 0.
    pub y: Channels<f64>,
    /// θ of equation (7), the log-likelihood ratio.
    pub theta: f64,
}

/// What a record says, with the signal-to-noise ratio of the hypotheses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordStatistic {
    /// Y(0) of equation (5), N.
    pub y: Channels<f64>,
    /// θ of equation (7).
    pub theta: f64,
    /// γ.
    pub gamma: f64,
}

/// The noise of one channel with a power of two that brings it near 1: squares of forces are taken
/// in these units, where they neither overflow nor underflow unless Δ/s itself is absurd.
///
/// Implements: DET-016.
#[derive(Debug, Clone, Copy)]
struct Scale {
    /// A power of two, 1/N.
    factor: f64,
    /// s · factor.
    noise_sd: f64,
}

impl Scale {
    fn new(noise_sd: f64) -> Self {
        let factor = compensated::reciprocal_power_of_two(noise_sd);
        Self {
            factor,
            noise_sd: noise_sd * factor,
        }
    }

    /// Σ in units of the scaled force squared → in units of the noise variance.
    fn over_variance(self, sum: f64) -> f64 {
        sum / (self.noise_sd * self.noise_sd)
    }
}

impl<'a> MatchedFilter<'a> {
    /// The filter for `template` (N samples a channel, N) in noise of standard deviation `noise_sd`
    /// a sample (N).
    ///
    /// # Errors
    /// Empty, unequal or non-finite templates; `noise_sd` not positive and finite; γ² beyond the
    /// largest number.
    ///
    /// Implements: DET-005, DET-006, DET-007, DET-010, DET-013.
    pub fn new(
        template: Channels<&'a [f64]>,
        noise_sd: Channels<f64>,
    ) -> Result<Self, DetectError> {
        check_samples("template_x", template.x, template.x.len())?;
        check_samples("template_y", template.y, template.x.len())?;
        let scale = scales(noise_sd)?;
        let energy = template
            .zip(scale)
            .map(|(template, scale)| compensated::dot(template, template, scale.factor));
        let gamma = gamma(energy, scale)?;
        Ok(Self {
            template,
            scale,
            energy,
            gamma,
        })
    }

    /// N, the number of samples in each channel.
    pub fn samples(&self) -> usize {
        self.template.x.len()
    }

    /// b_c = (Σ Δ_c²/N)^½, the root mean square of the template, N.
    ///
    /// Implements: DET-010.
    pub fn b(&self) -> Channels<f64> {
        let samples = self.samples() as f64;
        self.energy
            .zip(self.scale)
            .map(|(energy, scale)| libm::sqrt(energy.value() / samples) / scale.factor)
    }

    /// σ_c = s_c/√N, the standard deviation of Y_c(0), N.
    ///
    /// Implements: DET-011.
    pub fn sigma(&self) -> Channels<f64> {
        let root = libm::sqrt(self.samples() as f64);
        self.scale.map(|scale| scale.noise_sd / root / scale.factor)
    }

    /// γ = (Σ_c Σ_i Δ²/s²)^½, the signal-to-noise ratio.
    ///
    /// Implements: DET-013, ACC-003.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// y(0) and θ of a residual r = F_p − F_0 (N samples a channel, N).
    ///
    /// # Errors
    /// Lengths other than the template's; NaN or infinity in the residual; overflow.
    ///
    /// Implements: DET-005, DET-012, DET-014, DET-015, ACC-003, ACC-004, CON-007.
    pub fn statistic(&self, residual: Channels<&[f64]>) -> Result<Statistic, DetectError> {
        check_samples("residual_x", residual.x, self.samples())?;
        check_samples("residual_y", residual.y, self.samples())?;
        let cross =
            residual
                .zip(self.template)
                .zip(self.scale)
                .map(|((residual, template), scale)| {
                    compensated::dot(residual, template, scale.factor)
                });
        statistic(cross, self.energy, self.scale, self.samples())
    }
}

/// y(0), θ and γ of a record F_p against the forces F_0 and F_1 that the hypotheses expect (N
/// samples a channel each, N), in noise of standard deviation `noise_sd` a sample. The differences
/// are not rounded.
///
/// ```
/// use palpate::detect::{Channels, theta_of_record};
///
/// let f0 = Channels { x: &[0.25, 0.0, -0.25][..], y: &[1.0, 1.0, 1.0] };
/// let f1 = Channels { x: &[0.25, 0.0, -0.25][..], y: &[1.125, 1.25, 1.25] };
/// let noise_sd = Channels { x: 0.125, y: 0.125 };
/// // What either hypothesis expects: ∓γ²/2.
/// assert_eq!(theta_of_record(f0, f0, f1, noise_sd)?.theta, -4.5);
/// assert_eq!(theta_of_record(f1, f0, f1, noise_sd)?.theta, 4.5);
/// # Ok::<(), palpate::detect::DetectError>(())
/// ```
///
/// # Errors
/// Empty or unequal lengths; NaN or infinity; `noise_sd` not positive and finite; overflow.
///
/// Implements: DET-005, DET-006, DET-007, DET-012, DET-014, DET-015, ERR-001.
pub fn theta_of_record(
    observed: Channels<&[f64]>,
    f0: Channels<&[f64]>,
    f1: Channels<&[f64]>,
    noise_sd: Channels<f64>,
) -> Result<RecordStatistic, DetectError> {
    let samples = observed.x.len();
    for (what, series) in [
        ("observed_x", observed.x),
        ("observed_y", observed.y),
        ("f0_x", f0.x),
        ("f0_y", f0.y),
        ("f1_x", f1.x),
        ("f1_y", f1.y),
    ] {
        check_samples(what, series, samples)?;
    }
    let scale = scales(noise_sd)?;
    let sums = observed
        .zip(f0.zip(f1))
        .zip(scale)
        .map(|((observed, (f0, f1)), scale)| {
            let difference =
                |a: f64, b: f64| DoubleDouble::difference(a * scale.factor, b * scale.factor);
            let energy = compensated::sum(samples, |i| {
                let template = difference(f1[i], f0[i]);
                product(template, template)
            });
            let cross = compensated::sum(samples, |i| {
                product(difference(observed[i], f0[i]), difference(f1[i], f0[i]))
            });
            (cross, energy)
        });
    let (cross, energy) = (sums.map(|(cross, _)| cross), sums.map(|(_, energy)| energy));
    let gamma = gamma(energy, scale)?;
    let Statistic { y, theta } = statistic(cross, energy, scale, samples)?;
    Ok(RecordStatistic { y, theta, gamma })
}

/// The product of two double-doubles, with a relative error of a few u².
fn product(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let main = DoubleDouble::product(a.high, b.high);
    DoubleDouble {
        high: main.high,
        low: main.low + (a.high * b.low + a.low * b.high),
    }
}

fn scales(noise_sd: Channels<f64>) -> Result<Channels<Scale>, DetectError> {
    Ok(Channels {
        x: Scale::new(check_positive("noise_sd_x", noise_sd.x)?),
        y: Scale::new(check_positive("noise_sd_y", noise_sd.y)?),
    })
}

fn gamma(energy: Channels<DoubleDouble>, scale: Channels<Scale>) -> Result<f64, DetectError> {
    let square = energy
        .zip(scale)
        .map(|(energy, scale)| scale.over_variance(energy.value()));
    representable("gamma", libm::sqrt(square.x + square.y))
}

/// Equations (5) and (7) from Σ rΔ and ΣΔ². With b/σ² (Y − b/2) = (Σ rΔ − ½ΣΔ²)/s², the weight 1/N
/// drops out, and the one subtraction that may cancel is done in twice the working precision.
fn statistic(
    cross: Channels<DoubleDouble>,
    energy: Channels<DoubleDouble>,
    scale: Channels<Scale>,
    samples: usize,
) -> Result<Statistic, DetectError> {
    let samples = samples as f64;
    let y = cross
        .zip(energy)
        .zip(scale)
        .map(|((cross, energy), scale)| {
            let energy = energy.value();
            // The matched filter of a template of zeros is not defined, and its weight in θ is
            // zero.
            if energy == 0.0 {
                0.0
            } else {
                cross.value() / libm::sqrt(energy * samples) / scale.factor
            }
        });
    let theta = cross
        .zip(energy)
        .zip(scale)
        .map(|((cross, energy), scale)| {
            scale.over_variance(cross.plus(energy.scaled(-0.5)).value())
        });
    representable("y_x", y.x)?;
    representable("y_y", y.y)?;
    Ok(Statistic {
        y,
        theta: representable("theta", theta.x + theta.y)?,
    })
}
