//! Samples that are not independent: sensors with a low pass, values that were held or interpolated.

use super::DetectError;
use crate::stats::compensated;
use crate::stats::error::{check_length, check_samples, representable};
use crate::stats::tails::chi_square_tail;

/// The sum over the autocorrelation ends at this multiple of what it has come to.
const WINDOW: f64 = 5.0;
/// The variance of the correlation ρ of neighbours, before the record.
const VARIANCE: f64 = 0.1;

/// Σ xᵢ², and Σ xᵢ xᵢ₊ₖ / Σ xᵢ² of any lag k, 0 of a series of zeros.
fn autocorrelation(series: &[f64]) -> (f64, impl Fn(usize) -> f64) {
    let product = |lag: usize| {
        let later = series.get(lag..).unwrap_or_default();
        compensated::dot(series, later, 1.0).value()
    };
    let power = product(0);
    let of = move |lag| {
        if power > 0.0 {
            product(lag) / power
        } else {
            0.0
        }
    };
    (power, of)
}

/// The probability that `lags` autocorrelations of white noise are as large as those of the series, or larger, by the statistic of
/// Ljung and Box: n (n + 2) Σ ρ_k²/(n − k) is χ² with as many degrees of freedom, for a long series.
///
/// # Errors
/// No lags, or as many as there are samples; NaN, infinity, or squares that are not finite.
///
/// Implements: NUI-020.
pub fn ljung_box(series: &[f64], lags: usize) -> Result<f64, DetectError> {
    check_samples("series", series, series.len())?;
    let (power, of) = autocorrelation(series);
    representable("power", power)?;
    let samples = series.len() as f64;
    check_length("lags", lags.clamp(1, series.len().max(2) - 1), lags)?;
    let terms = (1..=lags).map(|lag| {
        let correlation = of(lag);
        correlation * correlation / (samples - lag as f64)
    });
    let sum: f64 = terms.sum();
    chi_square_tail(samples * (samples + 2.0) * sum, lags as f64)
}

/// θ_c: at most ln of the likelihood ratio of noise whose neighbours are correlated to white noise, from the sum of the products of
/// neighbours and the sum of all squares, both over the variance of the noise.
///
/// Implements: NUI-022.
pub fn theta_correlated(products: f64, squares: f64) -> f64 {
    let spread = 1.0 + VARIANCE * squares.max(0.0);
    0.5 * (VARIANCE * products * products / spread - libm::log(spread))
}

/// How many samples of a finite series count as one: τ = 1 + 2 Σ ρ_k over the lags k below 5 τ (Sokal), at least 1.
///
/// Implements: NUI-021.
pub fn correlation_length(series: &[f64]) -> f64 {
    let ((_, of), mut length) = (autocorrelation(series), 1.0);
    for lag in 1..series.len() {
        length += 2.0 * of(lag);
        if lag as f64 >= WINDOW * length {
            break;
        }
    }
    length.max(1.0)
}

#[cfg(test)]
mod tests;
