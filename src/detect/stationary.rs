//! Θ in stationary coloured noise, for records too long for a dense covariance: the noise of the
//! two channels is independent, and within a channel Cov(nᵢ, nⱼ) = ρ(|i − j|).
//!
//! Both functions whiten as `L⁻¹` does in [`super::coloured`], and give the same θ.

use super::coloured::{ColouredStatistic, Innovations, pivot};
use super::{DetectError, Force};
use crate::stats::compensated;
use crate::stats::error::{check_length, check_positive};

/// θ and γ by the recursion of Levinson and Durbin, for any autocovariance ρ(0) … ρ(N−1) (N², N
/// lags a channel). Time N²; `scratch` holds 2N numbers.
///
/// # Errors
/// Lengths that do not fit; NaN or infinity; an autocovariance that is not positive definite;
/// overflow.
///
/// Implements: DET-005, DET-007, DET-043, DET-044, DET-046.
pub fn theta_stationary(
    residual: Force<&[f64]>,
    template: Force<&[f64]>,
    autocovariance: Force<&[f64]>,
    scratch: &mut [f64],
) -> Result<ColouredStatistic, DetectError> {
    let samples = template.lateral.len();
    check_records(residual, template)?;
    autocovariance.check("autocovariance_x", "autocovariance_y", samples)?;
    check_length("scratch", 2 * samples, scratch.len())?;
    let mut innovations = Innovations::default();
    for (records, lags) in residual.zip(template).zip(autocovariance).into_array() {
        levinson(records, lags, scratch, &mut innovations)?;
    }
    innovations.statistic()
}

/// Length of the scratch that [`theta_banded`] needs for `lags` = m + 1 lags.
///
/// Implements: DET-046.
pub const fn banded_scratch(lags: usize) -> usize {
    lags.saturating_mul(lags.saturating_add(3))
}

/// θ and γ by a banded Cholesky factor that forgets what it has used, for an autocovariance that is
/// zero beyond its last lag: ρ(0) … ρ(m) (N², the same number of lags for both channels). Time N
/// m², memory m².
///
/// # Errors
/// As [`theta_stationary`]; more lags than samples.
///
/// Implements: DET-005, DET-007, DET-043, DET-045, DET-046.
pub fn theta_banded(
    residual: Force<&[f64]>,
    template: Force<&[f64]>,
    autocovariance: Force<&[f64]>,
    scratch: &mut [f64],
) -> Result<ColouredStatistic, DetectError> {
    check_records(residual, template)?;
    let lags = autocovariance.lateral.len();
    autocovariance.check("autocovariance_x", "autocovariance_y", lags)?;
    check_length("autocovariance_x", lags.min(template.lateral.len()), lags)?;
    check_length("scratch", banded_scratch(lags), scratch.len())?;
    let mut innovations = Innovations::default();
    for (records, lags) in residual.zip(template).zip(autocovariance).into_array() {
        scratch.fill(0.0);
        banded(records, lags, scratch, &mut innovations)?;
    }
    innovations.statistic()
}

fn check_records(residual: Force<&[f64]>, template: Force<&[f64]>) -> Result<(), DetectError> {
    let samples = template.lateral.len();
    template.check("template_x", "template_y", samples)?;
    residual.check("residual_x", "residual_y", samples)
}

/// One channel by Levinson and Durbin. The best prediction of sample i from those before it is Σ_j
/// w_j x_j with error variance v; the error over √v is the innovation.
fn levinson(
    (residual, template): (&[f64], &[f64]),
    autocovariance: &[f64],
    scratch: &mut [f64],
    innovations: &mut Innovations,
) -> Result<(), DetectError> {
    let samples = template.len();
    let (mut weights, mut next) = scratch.split_at_mut(samples);
    let power = check_positive("autocovariance[0]", autocovariance[0])?;
    let mut variance = power;
    for i in 0..samples {
        // As in `coloured::pivot`: less than this may be rounding alone.
        if variance.is_nan() || variance <= 4.0 * (samples as f64 + 2.0) * f64::EPSILON * power {
            return Err(DetectError::NotPositiveDefinite { pivot: i });
        }
        let deviation = libm::sqrt(variance);
        let innovation =
            |x: &[f64]| (x[i] - compensated::dot(&weights[..i], &x[..i], 1.0).value()) / deviation;
        innovations.add(innovation(template), innovation(residual));
        if i + 1 < samples {
            let lags = &autocovariance[1..=i + 1];
            let known = compensated::dot(&weights[..i], &lags[..i], 1.0).value();
            let reflection = (lags[i] - known) / variance;
            next[0] = reflection;
            for j in 1..=i {
                next[j] = weights[j - 1] - reflection * weights[i - j];
            }
            core::mem::swap(&mut weights, &mut next);
            variance *= (1.0 - reflection) * (1.0 + reflection);
        }
    }
    Ok(())
}

/// One channel by a Cholesky factor of m + 1 diagonals. Row i of L holds the columns i−m … i; the
/// last m + 1 rows are kept, and the last m whitened samples. Columns before 0 are zeros, which
/// `scratch` must hold at the start.
fn banded(
    (residual, template): (&[f64], &[f64]),
    autocovariance: &[f64],
    scratch: &mut [f64],
    innovations: &mut Innovations,
) -> Result<(), DetectError> {
    let lags = autocovariance.len();
    let band = lags - 1;
    let (rows, rest) = scratch.split_at_mut(lags * lags);
    let (row, rest) = rest.split_at_mut(lags);
    let (white_template, white_residual) = rest.split_at_mut(lags);
    for i in 0..template.len() {
        for column in band.saturating_sub(i)..band {
            // Column number `column` of this row is row j = i − band + column of L.
            let pivot_row = &rows[(i + column - band) % lags * lags..][..lags];
            let sum = compensated::dot(&row[..column], &pivot_row[band - column..band], 1.0);
            row[column] = (autocovariance[band - column] - sum.value()) / pivot_row[band];
        }
        row[..band.saturating_sub(i)].fill(0.0);
        let sum = compensated::dot(&row[..band], &row[..band], 1.0);
        row[band] = pivot(autocovariance[0], sum, template.len(), i)?;
        rows[i % lags * lags..][..lags].copy_from_slice(row);
        for (white, sample) in [
            (&mut *white_template, template[i]),
            (&mut *white_residual, residual[i]),
        ] {
            let known = compensated::dot(&row[..band], &white[..band], 1.0).value();
            white[band] = (sample - known) / row[band];
        }
        innovations.add(white_template[band], white_residual[band]);
        white_template.copy_within(1.., 0);
        white_residual.copy_within(1.., 0);
    }
    Ok(())
}
