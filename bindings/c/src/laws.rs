//! The normal law, and those of quadratic statistics and proportions.
//!
//! Implements: CLB-010.

use palpate_core::stats::{Bounds, binomial, noncentral, normal};

use crate::Error;
use crate::memory::give;

/// Φ(x), the probability that a standard normal number is at most x. Refuses NaN.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_normal_cdf(x: f64, p: *mut f64) -> Error {
    unsafe { give(p, || Ok(normal::cdf(x)?)) }
}

/// Φ⁻¹(p) for 0 < p < 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_normal_quantile(p: f64, x: *mut f64) -> Error {
    unsafe { give(x, || Ok(normal::quantile(p)?)) }
}

/// The two tails of a law at x.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Tails {
    /// Pr(X < x).
    pub lower: f64,
    /// Pr(X ≥ x).
    pub upper: f64,
}

impl From<noncentral::Tails> for Tails {
    fn from(tails: noncentral::Tails) -> Tails {
        Tails {
            lower: tails.lower,
            upper: tails.upper,
        }
    }
}

/// Tails of noncentral chi-square at x, with `degrees` of freedom and noncentrality λ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_chi_square_tail(
    x: f64,
    degrees: f64,
    noncentrality: f64,
    tails: *mut Tails,
) -> Error {
    let found = || Ok(noncentral::chi_square(x, degrees, noncentrality)?.into());
    unsafe { give(tails, found) }
}

/// Tails of noncentral F at x, with two degrees of freedom and noncentrality λ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_f_tail(
    x: f64,
    numerator: f64,
    denominator: f64,
    noncentrality: f64,
    tails: *mut Tails,
) -> Error {
    let found = || Ok(noncentral::f_ratio(x, numerator, denominator, noncentrality)?.into());
    unsafe { give(tails, found) }
}

/// Tails of noncentral Student's t at x, with `degrees` of freedom and noncentrality δ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_student_tail(
    x: f64,
    degrees: f64,
    noncentrality: f64,
    tails: *mut Tails,
) -> Error {
    let found = || Ok(noncentral::student(x, degrees, noncentrality)?.into());
    unsafe { give(tails, found) }
}

/// An interval for a proportion.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Interval {
    /// Lower end, at least 0.
    pub lower: f64,
    /// Upper end, at most 1.
    pub upper: f64,
}

impl From<Bounds> for Interval {
    fn from(interval: Bounds) -> Interval {
        Interval {
            lower: interval.lower,
            upper: interval.upper,
        }
    }
}

/// The exact interval of Clopper and Pearson at 0 < `confidence` < 1. Takes about √trials steps for each of some 120 tails.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_clopper_pearson(
    successes: u64,
    trials: u64,
    confidence: f64,
    interval: *mut Interval,
) -> Error {
    let found = || Ok(binomial::clopper_pearson(successes, trials, confidence)?.into());
    unsafe { give(interval, found) }
}

/// Wilson's interval at 0 < `confidence` < 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_wilson(
    successes: u64,
    trials: u64,
    confidence: f64,
    interval: *mut Interval,
) -> Error {
    let found = || Ok(binomial::wilson(successes, trials, confidence)?.into());
    unsafe { give(interval, found) }
}
