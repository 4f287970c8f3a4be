//! Expected values: mpmath 1.4.1 at 40 digits: the definition with log-gamma, sums of it, and
//! bisection on those sums.

use super::*;
use palpate_asserts::{assert_near, numbers};

/// Successes, trials and p; the probability of as many, of at least and of at most as many.
const TAILS: &str = "
0 10 0.3 0.028247524900000005 1.0 0.028247524900000005
10 10 0.3 5.9048999999999975e-06 5.9048999999999975e-06 1.0
3 10 0.3 0.266827932 0.6172172135999999 0.6496107184000001
253 300 0.8 0.00976182053838223 0.032805678472087464 0.9769561420662948
30 1000 0.05 0.0005578706372646084 0.9992808027197848 0.0012770679174798358
5 1000000 1e-05 0.03783289646749406 0.9707478794209629 0.06708501704653115
500500 1000000 0.5 0.0004839415296951451 0.15889734568165276 0.8415865958480424
";

// Verifies: DET-120.
#[test]
fn probabilities_and_tails() {
    for [k, n, p, point, at_least_k, at_most_k] in numbers(TAILS) {
        let (k, n) = (k as u64, n as u64);
        // The exponent of a point is below 10 in size, of a few roundings; a tail adds up to 10⁴
        // terms.
        assert_near(probability(k, n, p).unwrap(), point, 1e-14 * point);
        assert_near(at_least(k, n, p).unwrap(), at_least_k, 1e-12 * at_least_k);
        assert_near(at_most(k, n, p).unwrap(), at_most_k, 1e-12 * at_most_k);
    }
}

/// Successes, trials and confidence; the ends of the exact interval and of that of Wilson.
const INTERVALS: &str = "
0 30 0.95 0.0 0.11570330822202779 0.0 0.11351339317396873
30 30 0.95 0.8842966917779722 1.0 0.8864866068260313 1.0
253 300 0.95 0.7971688875873384 0.8825596521730839 0.7978919765479306 0.8800931832112143
15 30 0.99 0.26484683198381537 0.7351531680161847 0.2872156912398668 0.7127843087601332
1 1000000 0.999 5.001250415572358e-10 9.99863251031123e-06 7.843673338910837e-08 1.2748990547455939e-05
1 1 0.5 0.25 1.0 0.6873152559174167 1.0
";

// Verifies: DET-121.
#[test]
fn intervals_of_clopper_and_pearson_and_of_wilson() {
    for [k, n, confidence, expected @ ..] in numbers::<7>(INTERVALS) {
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
