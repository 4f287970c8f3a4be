//! The binomial law, and intervals for a proportion: what counts of false alarms, misses and right
//! answers say.
//!
//! Point probabilities by C. Loader's saddle-point form (*Fast and accurate computation of binomial
//! probabilities*, 2000), whose terms do not cancel; tails by summing ratios from the point
//! outwards.

use super::error::{check_probability, in_range};
use super::normal;
use super::{Bounds, NumericError};

/// Pr(X = successes) for X ~ Binomial(trials, p).
///
/// # Errors
/// No trials; more successes than trials; p not strictly between 0 and 1.
///
/// Implements: DET-120.
pub fn probability(successes: u64, trials: u64, p: f64) -> Result<f64, NumericError> {
    check(successes, trials)?;
    check_probability("p", p)?;
    Ok(point(successes as f64, trials as f64, p, 1.0 - p))
}

/// Pr(X ≥ successes) for X ~ Binomial(trials, p). Takes about √trials steps.
///
/// # Errors
/// As [`probability`].
///
/// Implements: DET-120.
pub fn at_least(successes: u64, trials: u64, p: f64) -> Result<f64, NumericError> {
    check(successes, trials)?;
    check_probability("p", p)?;
    let (k, n) = (successes as f64, trials as f64);
    Ok(upper(k, n, p, 1.0 - p))
}

/// Pr(X ≤ successes) for X ~ Binomial(trials, p).
///
/// # Errors
/// As [`probability`].
///
/// Implements: DET-120.
pub fn at_most(successes: u64, trials: u64, p: f64) -> Result<f64, NumericError> {
    check(successes, trials)?;
    check_probability("p", p)?;
    let (k, n) = (successes as f64, trials as f64);
    Ok(upper(n - k, n, 1.0 - p, p))
}

/// The least number from `low` to `high` for which `holds`, which goes on holding above it; `high` + 1 if there is none.
///
/// # Errors
/// That of `holds`.
pub fn first(
    low: u64,
    high: u64,
    holds: impl Fn(u64) -> Result<bool, NumericError>,
) -> Result<u64, NumericError> {
    let (mut low, mut end) = (low, high.saturating_add(1));
    while low < end {
        let middle = low + (end - low) / 2;
        match holds(middle)? {
            true => end = middle,
            false => low = middle + 1,
        }
    }
    Ok(low)
}

/// The exact interval of Clopper and Pearson: it covers the true proportion with at least the
/// stated confidence.
///
/// # Errors
/// No trials; more successes than trials; a confidence not strictly between 0 and 1.
///
/// Implements: DET-121, DET-001.
pub fn clopper_pearson(
    successes: u64,
    trials: u64,
    confidence: f64,
) -> Result<Bounds, NumericError> {
    check(successes, trials)?;
    check_probability("confidence", confidence)?;
    let tail = 0.5 * (1.0 - confidence);
    let lower = if successes == 0 {
        0.0
    } else {
        least_p(|p| at_least(successes, trials, p), tail)?
    };
    let upper = if successes == trials {
        1.0
    } else {
        least_p(|p| at_most(successes, trials, p).map(|tail| -tail), -tail)?
    };
    Ok(Bounds { lower, upper })
}

/// The score interval of Wilson.
///
/// # Errors
/// As [`clopper_pearson`].
///
/// Implements: DET-121, DET-001.
pub fn wilson(successes: u64, trials: u64, confidence: f64) -> Result<Bounds, NumericError> {
    check(successes, trials)?;
    let tail = 0.5 * (1.0 - check_probability("confidence", confidence)?);
    let z = -normal::quantile_of("confidence", tail)?;
    let (k, n) = (successes as f64, trials as f64);
    let square = z * z;
    let half_width = z * libm::sqrt(k / n * (n - k) + 0.25 * square);
    let sum = k + 0.5 * square;
    // The ends are the roots of one quadratic; the smaller one comes from their product, k²/(n(n +
    // z²)), for it would cancel.
    let upper = (sum + half_width) / (n + square);
    let lower = k * (k / n) / (sum + half_width);
    Ok(Bounds {
        lower: if successes == 0 { 0.0 } else { lower },
        upper: if successes == trials { 1.0 } else { upper },
    })
}

fn check(successes: u64, trials: u64) -> Result<(), NumericError> {
    let is_right = (1..=1 << 53).contains(&trials);
    in_range(
        is_right,
        "trials",
        trials as f64,
        "at least 1 and at most 2^53",
    )?;
    if successes > trials {
        return Err(NumericError::Successes { successes, trials });
    }
    Ok(())
}

/// The p at which an increasing function of p reaches `value`, to the last bit: bisection over the
/// bits of p, so that small p keep their digits.
fn least_p(
    increasing: impl Fn(f64) -> Result<f64, NumericError>,
    value: f64,
) -> Result<f64, NumericError> {
    let is_above = |bits| Ok(increasing(f64::from_bits(bits))? > value);
    let above = first(1, 1.0_f64.to_bits() - 1, is_above)?;
    Ok(f64::from_bits(above - 1))
}

/// Pr(X ≥ k), with q = 1 − p: the smaller tail by summation, the larger as its complement.
fn upper(k: f64, n: f64, p: f64, q: f64) -> f64 {
    if k > n * p {
        outwards(k, n, p, q)
    } else {
        1.0 - outwards(n - k + 1.0, n, q, p)
    }
}

/// Pr(X ≥ k) for k above the mean: the terms fall off from k on, each the one before times
/// (n−j)/(j+1) · p/q. Both p and q = 1 − p are given, because the difference would lose the digits
/// of a small one.
fn outwards(k: f64, n: f64, p: f64, q: f64) -> f64 {
    if k > n {
        return 0.0;
    }
    let odds = p / q;
    let (mut term, mut sum, mut j) = (1.0, 1.0, k);
    while j < n && term > 1e-17 * sum {
        term *= (n - j) / (j + 1.0) * odds;
        sum += term;
        j += 1.0;
    }
    (point(k, n, p, q) * sum).min(1.0)
}

/// Loader's form of the point probability.
fn point(k: f64, n: f64, p: f64, q: f64) -> f64 {
    // The logarithm of what is near 1 from what is not.
    let log = |near: f64, far: f64| {
        if near > 0.5 {
            libm::log1p(-far)
        } else {
            libm::log(near)
        }
    };
    if k == 0.0 {
        return libm::exp(n * log(q, p));
    }
    if k == n {
        return libm::exp(n * log(p, q));
    }
    let exponent = stirling_error(n)
        - stirling_error(k)
        - stirling_error(n - k)
        - deviance(k, n * p)
        - deviance(n - k, n * q);
    libm::exp(exponent) * libm::sqrt(n / (core::f64::consts::TAU * k * (n - k)))
}

/// x ln(x/m) + m − x without cancellation.
pub(super) fn deviance(x: f64, m: f64) -> f64 {
    let difference = x - m;
    if difference.abs() < 0.1 * (x + m) {
        // With v = (x−m)/(x+m): (x−m)v + 2x Σ v^(2j+1)/(2j+1), j ≥ 1.
        let v = difference / (x + m);
        let mut sum = difference * v;
        let mut power = 2.0 * x * v;
        for odd in (3..1000).step_by(2) {
            power *= v * v;
            let next = sum + power / f64::from(odd);
            if next == sum {
                break;
            }
            sum = next;
        }
        return sum;
    }
    x * libm::log(x / m) - difference
}

/// ln n! less Stirling's formula: a table (mpmath, 50 digits) for whole n < 16 and the series beyond,
/// whose next term is below 1e-16.
pub(super) fn stirling_error(n: f64) -> f64 {
    const TABLE: [f64; 15] = [
        0.08106146679532726,
        0.0413406959554093,
        0.02767792568499834,
        0.020790672103765093,
        0.016644691189821193,
        0.013876128823070748,
        0.01189670994589177,
        0.010411265261972096,
        0.009255462182712733,
        0.00833056343336287,
        0.007573675487951841,
        0.00694284010720953,
        0.006408994188004207,
        0.0059513701127588475,
        0.005554733551962801,
    ];
    if n <= TABLE.len() as f64 {
        return TABLE[n as usize - 1];
    }
    let square = n * n;
    let mut series = 1.0 / 1188.0;
    for coefficient in [1.0 / 1680.0, 1.0 / 1260.0, 1.0 / 360.0, 1.0 / 12.0] {
        series = coefficient - series / square;
    }
    series / n
}

#[cfg(test)]
mod tests;
