//! Expected values: mpmath 1.4.1 at 50 digits, ½ erfc(−x/√2), exp(−x²/2)/√(2π), and Halley's
//! iteration on the former, for the exact binary64 argument, rounded once.

use super::*;
use palpate_asserts::{assert_ulps, numbers_of};

// Verifies: DET-001.
#[test]
fn distribution_is_within_four_ulps_from_the_far_tail_to_one() {
    for [x, expected] in numbers_of("tables/normal.txt", "distribution") {
        assert_ulps(cdf(x).unwrap(), expected, 4.0);
        assert_ulps(upper_tail(-x).unwrap(), expected, 4.0);
    }
}

// Verifies: DET-001.
#[test]
fn distribution_reaches_its_limits_without_nan() {
    for x in [-f64::MAX, -1e3, -40.1, -39.0] {
        assert_eq!((cdf(x), upper_tail(x)), (Ok(0.0), Ok(1.0)));
        assert_eq!((upper_tail(-x), cdf(-x)), (Ok(0.0), Ok(1.0)));
    }
    assert_eq!(lower_tail(f64::NEG_INFINITY), 0.0);
    assert_eq!(lower_tail(f64::INFINITY), 1.0);
}

// Verifies: DET-001.
#[test]
fn density_is_within_four_ulps() {
    for [x, expected] in numbers_of("tables/normal.txt", "density") {
        assert_ulps(density(x).unwrap(), expected, 4.0);
    }
    assert_eq!(density(1e200), Ok(0.0));
}

// Verifies: DET-001.
#[test]
fn quantile_is_within_four_ulps_for_every_kind_of_probability() {
    for [p, expected] in numbers_of("tables/normal.txt", "quantile") {
        assert_ulps(quantile(p).unwrap(), expected, 4.0);
    }
}

// Verifies: DET-001.
#[test]
fn quantile_is_within_six_ulps_for_the_smallest_probabilities() {
    for [p, expected] in numbers_of("tables/normal.txt", "quantile of the smallest") {
        assert_ulps(quantile(p).unwrap(), expected, 6.0);
    }
}

// Verifies: DET-001.
#[test]
fn quantile_never_decreases_between_neighbours_at_its_seams() {
    for seam in [
        1e-306,
        0.075,
        0.5 - 0.425,
        0.5 + 0.425,
        1.388_794_386_496_402e-11,
    ] {
        let mut p: f64 = seam;
        for _ in 0..200 {
            p = p.next_down();
        }
        // Both sides are off by 4 ulps at most, so a step down larger than that is a seam.
        let mut largest = quantile(p).unwrap();
        for _ in 0..400 {
            p = p.next_up();
            let x = quantile(p).unwrap();
            let holds = x >= largest - 8.0 * f64::EPSILON * x.abs();
            assert!(holds, "a step down at p = {p:e}");
            largest = largest.max(x);
        }
    }
}

// Verifies: DET-005.
#[test]
fn values_outside_the_domain_are_refused() {
    let refused = |what, value, range| Err(NumericError::OutOfRange { what, value, range });
    for p in [0.0, 1.0, -0.1, 1.1, f64::INFINITY, f64::NEG_INFINITY, -0.0] {
        assert_eq!(quantile(p), refused("p", p, "strictly between 0 and 1"));
    }
    assert!(quantile(f64::NAN).is_err());
    for x in [f64::INFINITY, f64::NEG_INFINITY] {
        for found in [cdf(x), upper_tail(x), density(x)] {
            assert_eq!(found, refused("x", x, "finite"));
        }
    }
    assert!(cdf(f64::NAN).is_err() && upper_tail(f64::NAN).is_err() && density(f64::NAN).is_err());
}
