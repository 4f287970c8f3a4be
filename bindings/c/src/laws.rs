//! The normal law, and those of quadratic statistics and proportions.
//!
//! Implements: CLB-010.

pub use palpate_core::stats::Bounds;
pub use palpate_core::stats::noncentral::Tails;
use palpate_core::stats::{binomial, noncentral, normal};

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

/// Tails of noncentral chi-square at x, with `degrees` of freedom and noncentrality λ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_chi_square_tail(
    x: f64,
    degrees: f64,
    noncentrality: f64,
    tails: *mut Tails,
) -> Error {
    let found = || Ok(noncentral::chi_square(x, degrees, noncentrality)?);
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
    let found = || {
        Ok(noncentral::f_ratio(
            x,
            numerator,
            denominator,
            noncentrality,
        )?)
    };
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
    let found = || Ok(noncentral::student(x, degrees, noncentrality)?);
    unsafe { give(tails, found) }
}

/// The exact interval of Clopper and Pearson at 0 < `confidence` < 1. Takes about √trials steps for each of some 120 tails.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_clopper_pearson(
    successes: u64,
    trials: u64,
    confidence: f64,
    interval: *mut Bounds,
) -> Error {
    let found = || Ok(binomial::clopper_pearson(successes, trials, confidence)?);
    unsafe { give(interval, found) }
}

/// Wilson's interval at 0 < `confidence` < 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_wilson(
    successes: u64,
    trials: u64,
    confidence: f64,
    interval: *mut Bounds,
) -> Error {
    let found = || Ok(binomial::wilson(successes, trials, confidence)?);
    unsafe { give(interval, found) }
}
