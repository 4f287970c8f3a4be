//! Tails of the gamma, chi-square, F and Student laws, through the incomplete gamma and beta
//! functions: series where they converge fast, Lentz's evaluation of the continued fractions
//! elsewhere.

use super::NumericError;
use super::error::{check_not_negative, check_probability, in_range};

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
    check_parameter("shape", shape)?;
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

/// Pr(X ≥ x) for the F law.
///
/// # Errors
/// Degrees of freedom not in (0, 2·10⁶], x negative or not finite.
///
/// Implements: PSY-030.
pub fn f_tail(x: f64, numerator: f64, denominator: f64) -> Result<f64, NumericError> {
    check_not_negative("x", x)?;
    let sum = denominator + numerator * x;
    // Both shares from their own quotients: a difference from 1 would lose the small one.
    incomplete_beta(
        0.5 * denominator,
        0.5 * numerator,
        denominator / sum,
        numerator * x / sum,
    )
}

/// Pr(|T| ≥ |t|) for Student's law.
///
/// # Errors
/// Degrees of freedom not in (0, 2·10⁶], t not finite.
///
/// Implements: PSY-030.
pub fn student_two_sided(t: f64, degrees: f64) -> Result<f64, NumericError> {
    f_tail(t * t, 1.0, degrees)
}

/// The t that |T| stays below with probability `confidence`.
///
/// # Errors
/// A confidence not strictly between 0 and 1; as [`student_two_sided`].
///
/// Implements: PSY-030.
pub fn student_quantile(confidence: f64, degrees: f64) -> Result<f64, NumericError> {
    let outside = 1.0 - check_probability("confidence", confidence)?;
    // Enough for all the bits of a t above 2⁻¹¹.
    crossing(64, |t| Ok(student_two_sided(t, degrees)? > outside))
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
pub(crate) fn halved<E>(
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

/// I_x(a, b) with y = 1 − x given beside x.
fn incomplete_beta(a: f64, b: f64, x: f64, y: f64) -> Result<f64, NumericError> {
    check_parameter("half the degrees of freedom", a)?;
    check_parameter("half the degrees of freedom", b)?;
    if x <= 0.0 || y <= 0.0 {
        return Ok(if x <= 0.0 { 0.0 } else { 1.0 });
    }
    let logarithm = a * libm::log(x) + b * libm::log(y) + libm::lgamma(a + b)
        - libm::lgamma(a)
        - libm::lgamma(b);
    let front = libm::exp(logarithm);
    Ok(if x < (a + 1.0) / (a + b + 2.0) {
        front * beta_fraction(a, b, x) / a
    } else {
        1.0 - front * beta_fraction(b, a, y) / b
    })
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

fn check_parameter(what: &'static str, value: f64) -> Result<f64, NumericError> {
    let is_right = value > 0.0 && value <= LARGEST;
    in_range(is_right, what, value, "above 0 and at most 1e6")
}

#[cfg(test)]
mod tests;
