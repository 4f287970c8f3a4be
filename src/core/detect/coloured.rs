//! Θ in coloured noise of any covariance over both channels: K = LLᵀ, whitened by L⁻¹ (paper, end
//! of §2).

use super::DetectError;
use crate::stats::compensated::{self, DoubleDouble};
use crate::stats::error::{check_length, check_not_negative, check_samples, representable};

/// What a record in coloured noise says.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ColouredStatistic {
    /// θ, the log-likelihood ratio.
    pub theta: f64,
    /// γ = (ΔᵀK⁻¹Δ)^½.
    pub gamma: f64,
}

/// ln of the densities of a record in coloured noise, without their factor (2π)^(−n/2), alone and with a signal whose amplitude is
/// normal with mean 1.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColouredEvidence {
    /// Without the signal.
    pub without: f64,
    /// With it.
    pub with: f64,
    /// The square of the Mahalanobis distance of the record, without the signal.
    pub distance_without: f64,
    /// The same with it.
    pub distance_with: f64,
}

impl ColouredEvidence {
    /// The evidence by what whitening leaves: ln of the determinant of L, the `energy` of the record and of the signal and their product, and
    /// the standard deviation of the amplitude.
    ///
    /// Implements: DET-048.
    pub fn of_white(log_det: f64, energy: [f64; 2], cross: f64, amplitude_sd: f64) -> Self {
        let [record, signal] = energy;
        // With the record less the signal, z, and the determinant's factor 1 + a²|L⁻¹Δ|².
        let (left, along) = (record - 2.0 * cross + signal, cross - signal);
        let variance = amplitude_sd * amplitude_sd;
        let grown = 1.0 + variance * signal;
        let distance_with = left - variance * along * along / grown;
        // A record that is the signal alone leaves 0, but for rounding.
        let distance_with = if distance_with < 0.0 {
            0.0
        } else {
            distance_with
        };
        ColouredEvidence {
            without: -0.5 * record - log_det,
            with: -log_det - 0.5 * (distance_with + libm::log(grown)),
            distance_without: record,
            distance_with,
        }
    }
}

/// Length of the scratch that [`theta_coloured`] and [`evidence_coloured`] need for a covariance of `order` rows.
///
/// Implements: DET-046.
pub const fn coloured_scratch(order: usize) -> usize {
    order.saturating_mul(order).saturating_add(2 * order)
}

/// θ = ΔᵀK⁻¹(r − Δ/2) and γ for one residual and one template, each the N lateral samples and then
/// the N normal ones (N), and a covariance K of 2N rows (N²), row by row.
///
/// ```
/// use palpate_core::detect::coloured::{coloured_scratch, theta_coloured};
///
/// // One sample of each channel, with noise that the channels share: K⁻¹Δ = (4, −2)/3.
/// let (template, covariance) = ([1.0, 0.0], [1.0, 0.5, 0.5, 1.0]);
/// let mut scratch = [0.0; coloured_scratch(2)];
/// let statistic = theta_coloured(&[1.0, 1.0], &template, &covariance, &mut scratch)?;
/// // The other channel tells of the noise in this one, and raises γ² from 1 to 4/3.
/// assert!((statistic.gamma - (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
/// assert!((statistic.theta - (4.0 / 3.0 - 2.0 / 3.0 - 2.0 / 3.0)).abs() < 1e-15);
/// # Ok::<(), palpate_core::detect::DetectError>(())
/// ```
///
/// # Errors
/// Lengths that do not fit; NaN or infinity; a covariance that is not symmetric, or not positive
/// definite to working precision; overflow.
///
/// Implements: DET-005, DET-040, DET-041, DET-043, DET-046.
pub fn theta_coloured(
    residual: &[f64],
    template: &[f64],
    covariance: &[f64],
    scratch: &mut [f64],
) -> Result<ColouredStatistic, DetectError> {
    let [_, residual, template] = whitened(residual, template, covariance, scratch)?;
    let energy = compensated::dot(template, template, 1.0);
    let cross = compensated::dot(residual, template, 1.0);
    Ok(ColouredStatistic {
        theta: representable("theta", cross.plus(energy.scaled(-0.5)).value())?,
        gamma: representable("gamma", libm::sqrt(energy.value()))?,
    })
}

/// The evidence of a record for a signal of uncertain amplitude in one class of disturbance. The arguments are those of
/// [`theta_coloured`], with a covariance that holds the disturbance, the noise and what is uncertain of the signal's shape, and the
/// standard deviation of the amplitude.
///
/// # Errors
/// As [`theta_coloured`]; an `amplitude_sd` below 0.
///
/// Implements: DET-005, DET-046, DET-048.
pub fn evidence_coloured(
    residual: &[f64],
    template: &[f64],
    covariance: &[f64],
    amplitude_sd: f64,
    scratch: &mut [f64],
) -> Result<ColouredEvidence, DetectError> {
    check_not_negative("amplitude_sd", amplitude_sd)?;
    let [factor, residual, template] = whitened(residual, template, covariance, scratch)?;
    let diagonal = factor.iter().step_by(template.len() + 1);
    let log_det = diagonal.map(|root| libm::log(*root)).sum();
    let dot = |a: &[f64], b: &[f64]| compensated::dot(a, b, 1.0).value();
    let energy = [dot(residual, residual), dot(template, template)];
    let cross = dot(residual, template);
    let found = ColouredEvidence::of_white(log_det, energy, cross, amplitude_sd);
    representable("without", found.without)?;
    representable("with", found.with)?;
    Ok(found)
}

/// L of the covariance, L⁻¹ of the residual and of the template, in `scratch`.
fn whitened<'a>(
    residual: &[f64],
    template: &[f64],
    covariance: &[f64],
    scratch: &'a mut [f64],
) -> Result<[&'a [f64]; 3], DetectError> {
    let order = template.len();
    check_samples("template", template, order)?;
    check_samples("residual", residual, order)?;
    check_length("scratch", coloured_scratch(order), scratch.len())?;
    let (factor, vectors) = scratch.split_at_mut(order * order);
    factorise(covariance, order, factor)?;
    let (white_template, white_residual) = vectors.split_at_mut(order);
    whiten(factor, template, white_template);
    whiten(factor, residual, white_residual);
    Ok([factor, white_residual, white_template])
}

/// The Cholesky factor L of a covariance K = LLᵀ of `order` rows, row by row; what lies above the diagonal is not used.
///
/// Implements: DET-041, DET-043.
fn factorise(covariance: &[f64], order: usize, factor: &mut [f64]) -> Result<(), DetectError> {
    check_samples("covariance", covariance, factor.len())?;
    check_symmetric(covariance, order)?;
    factor.copy_from_slice(covariance);
    for row in 0..order {
        let (above, current) = factor.split_at_mut(row * order);
        for column in 0..row {
            let pivot_row = &above[column * order..][..order];
            let sum = compensated::dot(&current[..column], &pivot_row[..column], 1.0).value();
            current[column] = (current[column] - sum) / pivot_row[column];
        }
        let sum = compensated::dot(&current[..row], &current[..row], 1.0);
        current[row] = pivot(current[row], sum, order, row)?;
    }
    Ok(())
}

/// L⁻¹v, whose noise is white with standard deviation 1.
///
/// Implements: DET-040.
fn whiten(factor: &[f64], vector: &[f64], white: &mut [f64]) {
    for (row, sample) in vector.iter().enumerate() {
        let factor = &factor[row * vector.len()..][..=row];
        let known = compensated::dot(&factor[..row], &white[..row], 1.0).value();
        white[row] = (sample - known) / factor[row];
    }
}

/// The root of the pivot `diagonal` − `sum`.
///
/// Rounding alone can turn a singular matrix into one with pivots of about order·u of the diagonal,
/// so a pivot that small is no evidence of a positive one.
fn pivot(diagonal: f64, sum: DoubleDouble, order: usize, row: usize) -> Result<f64, DetectError> {
    let pivot = DoubleDouble::new(diagonal, 0.0).plus(sum.scaled(-1.0));
    let pivot = pivot.value();
    let doubt = 4.0 * (order as f64 + 2.0) * f64::EPSILON * diagonal;
    let is_sound = pivot > doubt && pivot.is_finite();
    let error = DetectError::NotPositiveDefinite { pivot: row };
    is_sound.then(|| libm::sqrt(pivot)).ok_or(error)
}

/// Checks that a covariance of `order` rows, row by row, is symmetric to rounding.
///
/// # Errors
/// Another number of entries; an entry below the diagonal that differs from its mirror image.
///
/// Implements: DET-043.
pub fn check_symmetric(covariance: &[f64], order: usize) -> Result<(), DetectError> {
    check_length("covariance", order.saturating_mul(order), covariance.len())?;
    /// Asymmetry that rounding explains, relative to the two standard deviations.
    const TOLERANCE: f64 = 1e-12;
    let entry = |row: usize, column: usize| covariance[row * order + column];
    // The root of each variance, because their product may underflow.
    let sd = |row| libm::sqrt(entry(row, row).abs());
    for row in 0..order {
        for column in 0..row {
            let difference = entry(row, column) - entry(column, row);
            if difference.abs() > TOLERANCE * (sd(row) * sd(column)) {
                return Err(DetectError::NotSymmetric { row, column });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
