//! Tails of the gamma and chi-square laws, through the incomplete gamma function: a series where it converges fast, Lentz's
//! evaluation of a continued fraction elsewhere. [`super::noncentral`] has the laws with all digits, and those of ratios.

use super::NumericError;
use super::error::{check_not_negative, in_range};

/// Parameters up to which the tails are tested.
const LARGEST: f64 = 1e6;
/// Terms of a series or fraction; the slowest, near the mean of a law with parameter 10⁶, needs
/// about 6 times the root of it.
const MOST_TERMS: u32 = 20_000;
/// Relative size of a term that changes nothing any more.
const NEGLIGIBLE: f64 = 1e-17;
/// Where the search for a number ends.
pub(super) const BEYOND: f64 = 1e150;
/// In place of a zero denominator (Lentz).
const TINY: f64 = 1e-300;

/// Pr(X ≥ x) for a gamma law of the given shape and unit scale: the regularised upper incomplete
/// gamma function Q(shape, x).
///
/// # Errors
/// A shape not in (0, 10⁶], x negative or not finite.
///
/// Implements: PSY-030.
pub fn gamma_tail(shape: f64, x: f64) -> Result<f64, NumericError> {
    let is_right = shape > 0.0 && shape <= LARGEST;
    in_range(is_right, "shape", shape, "above 0 and at most 1e6")?;
    check_not_negative("x", x)?;
    if x == 0.0 {
        return Ok(1.0);
    }
    let front = libm::exp(shape * libm::log(x) - x - libm::lgamma(shape));
    Ok(if x < shape + 1.0 {
        1.0 - front * gamma_series(shape, x)
    } else {
        front / gamma_fraction(shape, x)
    })
}

/// P(shape, x) = front Σ xⁿ/(shape (shape+1) … (shape+n)): the sum.
pub(super) fn gamma_series(shape: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut n) = (1.0 / shape, 1.0 / shape, shape);
    for _ in 0..MOST_TERMS {
        n += 1.0;
        term *= x / n;
        sum += term;
        if term < NEGLIGIBLE * sum {
            break;
        }
    }
    sum
}

/// Q(shape, x) = front over the continued fraction: the fraction, for x ≥ shape that are not small.
pub(super) fn gamma_fraction(shape: f64, x: f64) -> f64 {
    let coefficients = |n: u32| {
        let n = f64::from(n);
        (-n * (n - shape), x + 2.0 * n + 1.0 - shape)
    };
    fraction(x + 1.0 - shape, coefficients)
}

/// Pr(X ≥ x) for the chi-square law.
///
/// # Errors
/// As [`gamma_tail`], for half the degrees of freedom.
///
/// Implements: PSY-030.
pub fn chi_square_tail(x: f64, degrees: f64) -> Result<f64, NumericError> {
    gamma_tail(0.5 * degrees, 0.5 * x)
}

/// The least number ≥ 0 for which a condition fails that holds for all smaller ones: to the last bit, if the halvings suffice.
pub(super) fn crossing(
    halvings: u32,
    holds: impl Fn(f64) -> Result<bool, NumericError>,
) -> Result<f64, NumericError> {
    let (mut low, mut high) = (0.0, 1.0);
    while high < BEYOND && holds(high)? {
        (low, high) = (high, 2.0 * high);
    }
    Ok(halved(halvings, [low, high], holds)?[1])
}

/// The ends of an interval after so many halvings, at most: a condition holds at the first, as far as it was asked there, and fails
/// at the second.
pub fn halved<E>(
    halvings: u32,
    [mut yes, mut no]: [f64; 2],
    holds: impl Fn(f64) -> Result<bool, E>,
) -> Result<[f64; 2], E> {
    for _ in 0..halvings {
        let middle = 0.5 * (yes + no);
        if middle == yes || middle == no {
            break;
        }
        *(if holds(middle)? { &mut yes } else { &mut no }) = middle;
    }
    Ok([yes, no])
}

/// The continued fraction of the incomplete beta function: I_x(a, b) = front · fraction/a.
pub(super) fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let coefficients = |n: u32| {
        let m = f64::from(n / 2);
        let ends = (a + 2.0 * m - 1.0) * (a + 2.0 * m);
        let numerator = if n.is_multiple_of(2) {
            m * (b - m) * x / ends
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    };
    1.0 / fraction(1.0, coefficients)
}

/// b₀ + a₁/(b₁ + a₂/(b₂ + …)) with (aₙ, bₙ) from `coefficients`, by Lentz's method.
pub(super) fn fraction(b0: f64, coefficients: impl Fn(u32) -> (f64, f64)) -> f64 {
    let nonzero = |value: f64| if value == 0.0 { TINY } else { value };
    let mut value = nonzero(b0);
    let (mut upper, mut lower) = (value, 0.0);
    for n in 1..=MOST_TERMS {
        let (a, b) = coefficients(n);
        lower = 1.0 / nonzero(b + a * lower);
        upper = nonzero(b + a / upper);
        let factor = upper * lower;
        value *= factor;
        if (factor - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests;
