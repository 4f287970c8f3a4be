//! The laws of quadratic statistics: chi-square, F and Student's t with a noncentrality, both tails of each with all its
//! digits.
//!
//! Each law is a mixture of central ones with Poisson weights, summed about its largest term (D. Benton, K. Krishnamoorthy,
//! *Computing discrete mixtures of continuous distributions*, Comput. Statist. Data Anal. 43, 2003). Only the tail beyond the
//! mean is summed, always from that end from which the tails of the central laws grow, so that nothing cancels; the other tail is
//! its complement.

use core::ops::RangeInclusive;

use super::NumericError;
use super::binomial::{deviance, stirling_error};
use super::error::{check_probability, in_range, representable};
use super::normal;
use super::tails::{BEYOND, beta_fraction, crossing, fraction, gamma_fraction, gamma_series};

/// Relative size of terms that change nothing any more, all together.
const NEGLIGIBLE: f64 = 1e-20;
/// The logarithm of a term for whose sake no f64 differs from 0, however many there are of it.
const NOTHING: f64 = -800.0;
/// Halvings that reach the smallest number above 0.
const ALL_BITS: u32 = 1140;

/// Both tails of a law at a point x.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Tails {
    /// Pr(X < x).
    pub lower: f64,
    /// Pr(X ≥ x).
    pub upper: f64,
}

impl Tails {
    fn of_lower(lower: f64) -> Tails {
        let upper = 1.0 - lower;
        Tails { lower, upper }
    }

    fn of_upper(upper: f64) -> Tails {
        let lower = 1.0 - upper;
        Tails { lower, upper }
    }
}

/// A tail of a given probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tail {
    /// Pr(X < x).
    Lower(f64),
    /// Pr(X ≥ x).
    Upper(f64),
}

/// The tails of X = Σ (Zᵢ + μᵢ)² over `degrees` standard normal Zᵢ, with Σ μᵢ² = `noncentrality`.
///
/// # Errors
/// x outside 0 … 10¹⁵², degrees of freedom (any real number) outside 0.1 … 2·10⁶, a noncentrality outside 0 … 10⁸.
///
/// Implements: DET-130, DET-134, DET-005.
pub fn chi_square(x: f64, degrees: f64, noncentrality: f64) -> Result<Tails, NumericError> {
    let x = check_not_negative(x)?;
    check_degrees("degrees", degrees)?;
    check_squares(noncentrality)?;
    let law = Central::Gamma { y: 0.5 * x };
    Ok(Mixture::of(law, 0.5 * degrees, 0.5 * noncentrality).tails())
}

/// The tails of (X/`numerator`)/(Y/`denominator`) for X as in [`chi_square`] and an independent central Y; the two are their
/// degrees of freedom.
///
/// # Errors
/// As [`chi_square`].
///
/// Implements: DET-130, DET-134, DET-005, PSY-030.
pub fn f_ratio(
    x: f64,
    numerator: f64,
    denominator: f64,
    noncentrality: f64,
) -> Result<Tails, NumericError> {
    let x = check_not_negative(x)?;
    check_degrees("numerator", numerator)?;
    check_degrees("denominator", denominator)?;
    check_squares(noncentrality)?;
    let law = Central::beta(0.5 * numerator * x, 0.5 * denominator);
    Ok(Mixture::of(law, 0.5 * numerator, 0.5 * noncentrality).tails())
}

/// The tails of (Z + `noncentrality`)/√(Y/`degrees`) for a standard normal Z and an independent central Y as in
/// [`chi_square`].
///
/// # Errors
/// x outside ±10¹⁵², degrees of freedom outside 0.1 … 2·10⁶, a noncentrality outside ±10⁴.
///
/// Implements: DET-130, DET-134, DET-005.
pub fn student(x: f64, degrees: f64, noncentrality: f64) -> Result<Tails, NumericError> {
    within(-1e152..=1e152, "x", x, "from -1e152 to 1e152")?;
    check_degrees("degrees", degrees)?;
    let range = "from -1e4 to 1e4";
    within(-1e4..=1e4, "noncentrality", noncentrality, range)?;
    if x >= 0.0 {
        return Ok(student_above(x, 0.5 * degrees, noncentrality));
    }
    // −T is such a ratio too.
    let Tails { lower, upper } = student_above(-x, 0.5 * degrees, -noncentrality);
    Ok(Tails {
        lower: upper,
        upper: lower,
    })
}

/// The x with that tail of the central chi-square law.
///
/// # Errors
/// A probability not strictly between 0 and 1; degrees of freedom as in [`chi_square`].
///
/// Implements: DET-136, DET-005.
pub fn chi_square_point(tail: Tail, degrees: f64) -> Result<f64, NumericError> {
    let (Tail::Lower(probability) | Tail::Upper(probability)) = tail;
    check_probability("probability", probability)?;
    crossing(ALL_BITS, |x| {
        let tails = chi_square(x, degrees, 0.0)?;
        Ok(match tail {
            Tail::Lower(probability) => tails.lower < probability,
            Tail::Upper(probability) => tails.upper > probability,
        })
    })
}

/// The x with Pr(T ≥ x) = `upper` for Student's central law; its lower tail has that probability at −x.
///
/// # Errors
/// A probability not strictly between 0 and 1; degrees of freedom as in [`student`]; an x beyond 10¹⁵⁰.
///
/// Implements: DET-136, DET-005, PSY-030.
pub fn student_point(upper: f64, degrees: f64) -> Result<f64, NumericError> {
    check_probability("upper", upper)?;
    let size = crossing(ALL_BITS, |x| {
        let tails = student(x, degrees, 0.0)?;
        Ok(if upper < 0.5 {
            tails.upper > upper
        } else {
            tails.lower < upper
        })
    })?;
    let size = if size < BEYOND { size } else { f64::INFINITY };
    representable("the point", if upper < 0.5 { size } else { -size })
}

/// [`student`] for x ≥ 0; c is half the degrees of freedom.
///
/// For δ ≥ 0 the weights and shapes of the mixture go in steps of one half: two mixtures in whole steps.
fn student_above(x: f64, c: f64, delta: f64) -> Tails {
    if delta < 0.0 {
        return Tails::of_upper(opposite_tail(x, c, -delta));
    }
    let whole = Mixture::of(Central::beta(0.5 * x * x, c), 0.5, 0.5 * delta * delta);
    let between = Mixture {
        shape: 1.0,
        offset: 0.5,
        ..whole
    };
    if whole.is_beyond_mean() {
        Tails::of_upper(0.5 * (whole.upper() + between.upper()))
    } else {
        let below_zero = normal::lower_tail(-delta);
        Tails::of_lower(below_zero + 0.5 * (whole.lower() + between.lower()))
    }
}

/// Pr(T ≥ x) for x ≥ 0 and the noncentrality −shift, where the mixture would alternate: the mean of Pr(Z ≥ x √(G/c) + shift) over
/// the gamma law of shape c for G.
///
/// By the trapezoidal rule in ln(G/c): the integrand is analytic and dies away on both sides, so that steps of at most 0.6 of its
/// width leave less than 10⁻¹⁵.
fn opposite_tail(x: f64, c: f64, shift: f64) -> f64 {
    let integrand = |u: f64| {
        let beyond = normal::lower_tail(-(x * libm::exp(0.5 * u) + shift));
        libm::exp(c * (u - libm::expm1(u))) * beyond
    };
    // Where it is about largest, with exp(−z²/2) in place of Pr(Z ≥ z): (c + x²/2) G/c + x shift/2 √(G/c) = c.
    let linear = 0.25 * x * shift;
    let rest = libm::hypot(c, x * libm::sqrt(0.5 * c));
    let middle = 2.0 * libm::log(c / (linear + libm::hypot(linear, rest)));
    let step = (0.6 / libm::sqrt(c)).min(0.2);
    let mut sum = integrand(middle);
    for direction in [-step, step] {
        let (mut u, mut term) = (middle, sum);
        while term > NEGLIGIBLE * sum {
            u += direction;
            term = integrand(u);
            sum += term;
        }
    }
    libm::exp(log_poisson(c, c)) * c * step * sum
}

/// A central law at one point, for each of its shapes b.
#[derive(Debug, Clone, Copy)]
enum Central {
    /// The gamma law of shape b and unit scale at y.
    Gamma { y: f64 },
    /// The beta law of shapes b and c at `share` = y/(c + y), with 1 − share beside it.
    Beta {
        y: f64,
        c: f64,
        share: f64,
        rest: f64,
    },
}

impl Central {
    fn beta(y: f64, c: f64) -> Central {
        let (share, rest) = (y / (c + y), c / (c + y));
        Central::Beta { y, c, share, rest }
    }

    /// (p, q): with g(b) the lower tail for b less that for b + 1, g(b + 1) = g(b) (p + q b)/(b + 1). The lower tail for b + 1 is at
    /// most (p + q b)/b times that for b, the upper tail at least as many times.
    fn growth(&self) -> (f64, f64) {
        match *self {
            Central::Gamma { y } => (y, 0.0),
            Central::Beta { c, share, .. } => (share * c, share),
        }
    }

    /// ln g(b).
    fn log_step(&self, b: f64) -> f64 {
        match *self {
            Central::Gamma { y } => log_poisson(b, y),
            Central::Beta { c, share, rest, .. } => {
                let sum = b + c;
                log_poisson(b, sum * share) + log_poisson(c, sum * rest) - log_poisson(sum, sum)
                    + libm::log(c / sum)
            }
        }
    }

    /// The lower tail over g(b).
    fn lower(&self, b: f64) -> f64 {
        match *self {
            Central::Gamma { y } => b * gamma_series(b, y),
            // Only for small y, for which 1 − share is no small difference.
            Central::Beta { y, c, share, .. } if b < y => beta_fraction(b, c, share),
            Central::Beta { y, c, share, rest } => {
                b * near_fraction(b, c, share, rest, c * ((b - y) / (c + y)))
            }
        }
    }

    /// The upper tail over g(b).
    fn upper(&self, b: f64) -> f64 {
        match *self {
            Central::Gamma { y } => b / gamma_fraction(b, y),
            Central::Beta { y, c, share, rest } => {
                b * near_fraction(c, b, rest, share, c * ((y - b) / (c + y)))
            }
        }
    }
}

/// I_x(a, b) B(a, b)/(xᵃ yᵇ) for y = 1 − x and the excess a − (a + b) x ≥ 0: every second convergent of [`beta_fraction`], which does
/// without small differences of x (A. DiDonato, A. Morris, ACM Trans. Math. Softw. 18, 1992).
fn near_fraction(a: f64, b: f64, x: f64, y: f64, excess: f64) -> f64 {
    let coefficients = |n: u32| {
        let n = f64::from(n);
        let middle = a + 2.0 * n - 1.0;
        let (first, second) = ((a + n - 1.0) / middle, (a + b + n - 1.0) / middle);
        let next = n * (b - n) * x;
        let denominator =
            n + next / middle + (a + n) / (middle + 2.0) * (excess + 1.0 + n * (1.0 + y));
        (first * second * next * x, denominator)
    };
    1.0 / fraction(a / (a + 1.0) * (excess + 1.0), coefficients)
}

/// Σⱼ w(offset + j) B(shape + j) over j = 0, 1, …, where w(r) = exp(−h) hʳ/Γ(r + 1) and B(b) is a tail of the central law.
#[derive(Debug, Clone, Copy)]
struct Mixture {
    law: Central,
    shape: f64,
    h: f64,
    offset: f64,
}

impl Mixture {
    /// With whole weights.
    fn of(law: Central, shape: f64, h: f64) -> Mixture {
        let offset = 0.0;
        Mixture {
            law,
            shape,
            h,
            offset,
        }
    }

    fn tails(&self) -> Tails {
        if self.is_beyond_mean() {
            Tails::of_upper(self.upper())
        } else {
            Tails::of_lower(self.lower())
        }
    }

    /// Whether the upper tail is to be summed: it is no large one, and the fractions converge.
    fn is_beyond_mean(&self) -> bool {
        let (Central::Gamma { y } | Central::Beta { y, .. }) = self.law;
        y >= (self.shape + self.h).max(1.5)
    }

    /// g(b) times this, over b + 1, is g(b + 1).
    fn growth(&self, b: f64) -> f64 {
        let (p, q) = self.law.growth();
        p + q * b
    }

    /// The most by which term j of a lower tail is multiplied to give term j + 1, and the least for an upper tail. It falls with j.
    fn ratio(&self, j: f64) -> f64 {
        let b = self.shape + j;
        self.h / (self.offset + j + 1.0) * (self.growth(b) / b)
    }

    /// The j at which that is 1: about the largest term.
    fn peak(&self) -> f64 {
        let (p, q) = self.law.growth();
        let linear = self.shape + 1.0 + self.offset - self.h * q;
        let constant = (1.0 + self.offset) * self.shape - self.h * (p + q * self.shape);
        let discriminant = linear * linear - 4.0 * constant;
        let root = 0.5 * (libm::sqrt(discriminant.max(0.0)) - linear);
        libm::floor(root).max(0.0)
    }

    /// ln [w(offset + j) g(shape + j)].
    fn log_scale(&self, j: f64) -> f64 {
        log_poisson(self.offset + j, self.h) + self.law.log_step(self.shape + j)
    }

    /// From large j down, for the lower tails grow so.
    fn lower(&self) -> f64 {
        let peak = self.peak();
        if self.log_scale(peak) < NOTHING {
            return 0.0;
        }
        let (mut j, mut bound) = (peak, self.ratio(peak));
        while bound > NEGLIGIBLE {
            j += 1.0;
            bound *= self.ratio(j);
        }
        let scale = libm::exp(0.5 * self.log_scale(j));
        // All in units of the weight and the step at the first j.
        let (mut weight, mut step, mut tail) = (1.0, 1.0, self.law.lower(self.shape + j));
        let (mut term, mut sum) = (tail, tail);
        while j > 0.0 && (j > peak || term > NEGLIGIBLE * sum) {
            let b = self.shape + j;
            weight *= (self.offset + j) / self.h;
            step *= b / self.growth(b - 1.0);
            tail += step;
            term = weight * tail;
            sum += term;
            j -= 1.0;
        }
        scale * sum * scale
    }

    /// From small j up, for the upper tails grow so.
    fn upper(&self) -> f64 {
        let peak = self.peak();
        if self.log_scale(peak) < NOTHING {
            return 0.0;
        }
        let (mut j, mut bound) = (peak, 1.0);
        while j > 0.0 && bound > NEGLIGIBLE {
            j -= 1.0;
            bound /= self.ratio(j);
        }
        let scale = libm::exp(0.5 * self.log_scale(j));
        let (mut weight, mut step, mut tail) = (1.0, 1.0, self.law.upper(self.shape + j));
        let (mut term, mut sum) = (tail, tail);
        while j < peak || term > NEGLIGIBLE * sum {
            let b = self.shape + j;
            tail += step;
            weight *= self.h / (self.offset + j + 1.0);
            step *= self.growth(b) / (b + 1.0);
            term = weight * tail;
            sum += term;
            j += 1.0;
        }
        scale * sum * scale
    }
}

/// ln [exp(−y) yᵇ/Γ(b + 1)] for b ≥ 0: C. Loader's form, whose terms do not cancel, where Stirling's formula is good.
fn log_poisson(b: f64, y: f64) -> f64 {
    if b == 0.0 {
        -y
    } else if b < 16.0 {
        b * libm::log(y) - y - libm::lgamma(b + 1.0)
    } else {
        -deviance(b, y) - stirling_error(b) - 0.5 * libm::log(core::f64::consts::TAU * b)
    }
}

fn check_not_negative(x: f64) -> Result<f64, NumericError> {
    // −0 is 0, of which there is a logarithm.
    within(0.0..=1e152, "x", x, "from 0 to 1e152").map(|x| x + 0.0)
}

fn check_degrees(what: &'static str, degrees: f64) -> Result<f64, NumericError> {
    within(0.1..=2e6, what, degrees, "from 0.1 to 2e6")
}

fn check_squares(noncentrality: f64) -> Result<f64, NumericError> {
    within(0.0..=1e8, "noncentrality", noncentrality, "from 0 to 1e8")
}

fn within(
    right: RangeInclusive<f64>,
    what: &'static str,
    value: f64,
    range: &'static str,
) -> Result<f64, NumericError> {
    in_range(right.contains(&value), what, value, range)
}

#[cfg(test)]
mod tests;
