//! Expected values: mpmath 1.4.1 at 40 digits: the definition with log-gamma, sums of it, and
//! bisection on those sums.

use super::*;
use palpate_asserts::{assert_near, numbers_of};

// Verifies: DET-120.
#[test]
fn probabilities_and_tails() {
    for [k, n, p, point, at_least_k, at_most_k] in numbers_of("tables/binomial.txt", "tails") {
        let (k, n) = (k as u64, n as u64);
        // The exponent of a point is below 10 in size, of a few roundings; a tail adds up to 10⁴
        // terms.
        assert_near(probability(k, n, p).unwrap(), point, 1e-14 * point);
        assert_near(at_least(k, n, p).unwrap(), at_least_k, 1e-12 * at_least_k);
        assert_near(at_most(k, n, p).unwrap(), at_most_k, 1e-12 * at_most_k);
    }
}

// Verifies: DET-121.
#[test]
fn intervals_of_clopper_and_pearson_and_of_wilson() {
    for [k, n, confidence, expected @ ..] in numbers_of::<7>("tables/binomial.txt", "intervals") {
        let exact = clopper_pearson(k as u64, n as u64, confidence).unwrap();
        let score = wilson(k as u64, n as u64, confidence).unwrap();
        let found = [exact.lower, exact.upper, score.lower, score.upper];
        for (found, expected) in found.into_iter().zip(expected) {
            // A tail's relative error of 1e-13, and 1 − confidence, which is rounded: up to 1e-13
            // of itself at 0.999.
            assert_near(found, expected, 4e-13 * expected);
        }
    }
}

// Verifies: DET-005.
#[test]
fn impossible_counts_are_refused() {
    let (what, range) = ("trials", "at least 1 and at most 2^53");
    let value = 0.0;
    let outside = NumericError::OutOfRange { what, value, range };
    assert_eq!(clopper_pearson(0, 0, 0.9), Err(outside));
    let (successes, trials) = (3, 2);
    let more = NumericError::Successes { successes, trials };
    assert_eq!(wilson(3, 2, 0.9), Err(more));
    // Up to 2⁵³ every count is a number of its own.
    let most = 1 << 53;
    assert!(wilson(1, most, 0.9).is_ok() && wilson(1, most + 1, 0.9).is_err());
    assert!(at_least(0, u64::MAX, 0.5).is_err());
    for bad in [0.0, 1.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(clopper_pearson(1, 2, bad).is_err() && wilson(1, 2, bad).is_err());
        assert!(at_least(1, 2, bad).is_err() && at_most(1, 2, bad).is_err());
        assert!(probability(1, 2, bad).is_err());
    }
}
