//! Expected values: the same mixtures at 380 digits (`vectors/generator/quadratic.py`), and closed forms.

use proptest::prelude::*;

use super::*;
use crate::stats::tails::chi_square_tail;
use palpate_asserts::{assert_near, numbers_of};

/// DET-134: how far a tail may be off, for the sum of the degrees of freedom and λ or δ².
fn allowed(tail: f64, sum: f64) -> f64 {
    1e-12 * (1.0 + libm::sqrt(sum) / 100.0) * tail.max(1e-300)
}

#[track_caller]
fn assert_tails(found: Tails, expected: [f64; 2], sum: f64) {
    for (found, expected) in [found.lower, found.upper].into_iter().zip(expected) {
        assert_near(found, expected, allowed(expected, sum));
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn chi_square_tails() {
    for [x, degrees, lambda, lower, upper] in numbers_of("tables/noncentral.txt", "chi-square") {
        let found = chi_square(x, degrees, lambda).unwrap();
        assert_tails(found, [lower, upper], degrees + lambda);
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn f_tails() {
    for [x, numerator, denominator, lambda, lower, upper] in
        numbers_of("tables/noncentral.txt", "F")
    {
        let found = f_ratio(x, numerator, denominator, lambda).unwrap();
        assert_tails(found, [lower, upper], numerator + denominator + lambda);
    }
}

// Verifies: DET-130, DET-134.
#[test]
fn student_tails() {
    for [x, degrees, delta, lower, upper] in numbers_of("tables/noncentral.txt", "Student") {
        let found = student(x, degrees, delta).unwrap();
        assert_tails(found, [lower, upper], degrees + delta * delta);
    }
}

// Verifies: DET-130. The older function goes through another series, with less accuracy.
#[test]
fn without_noncentrality_the_chi_square_law_is_central() {
    for degrees in [0.3, 1.0, 4.0, 9.5, 20.0] {
        for x in [0.2, 1.0, 3.5, 8.0, 40.0] {
            let found = chi_square(x, degrees, 0.0).unwrap().upper;
            let expected = chi_square_tail(x, degrees).unwrap();
            assert_near(found / expected, 1.0, 1e-12);
        }
    }
}

// Verifies: DET-134. At the ends of the ranges a tail is 0 or 1, or a power.
#[test]
fn ends_of_the_ranges() {
    let (none, all) = ([0.0, 1.0], [1.0, 0.0]);
    for degrees in [0.1, 2e6] {
        for lambda in [0.0, 5e-324, 1e-200, 1.0, 1e8] {
            let sum = degrees + lambda;
            let tails = |x| chi_square(x, degrees, lambda).unwrap();
            assert_eq!([tails(0.0).lower, tails(0.0).upper], none);
            assert_tails(tails(1e152), all, sum);
            for denominator in [0.1, 2e6] {
                let tails = |x| f_ratio(x, degrees, denominator, lambda).unwrap();
                assert_eq!([tails(0.0).lower, tails(0.0).upper], none);
                for x in [1e-300, 1e152] {
                    let Tails { lower, upper } = tails(x);
                    assert!(lower >= 0.0 && upper >= 0.0 && lower + upper == 1.0);
                }
            }
        }
        for delta in [0.0, 1e-300, -1e-300, 1.0, -1.0, 1e4, -1e4] {
            for x in [0.0, -0.0, 1e-300, -1e-300, 1e152, -1e152] {
                let Tails { lower, upper } = student(x, degrees, delta).unwrap();
                assert!(lower >= 0.0 && upper >= 0.0 && lower + upper == 1.0);
            }
            let at_zero = [normal::lower_tail(-delta), normal::lower_tail(delta)];
            assert_tails(student(0.0, degrees, delta).unwrap(), at_zero, degrees);
        }
    }
}

// Verifies: DET-136.
#[test]
fn points_of_the_chi_square_law() {
    for [degrees, p, lower_point, upper_point] in
        numbers_of("tables/noncentral.txt", "points of chi-square")
    {
        for (tail, expected) in [(Tail::Lower(p), lower_point), (Tail::Upper(p), upper_point)] {
            let found = chi_square_point(tail, degrees).unwrap();
            assert_near(found / expected, 1.0, 1e-12);
        }
    }
    // Below every normal number.
    let least = chi_square_point(Tail::Lower(1e-300), 0.1).unwrap();
    assert!(least > 0.0 && least < f64::MIN_POSITIVE);
}

// Verifies: DET-136.
#[test]
fn points_of_students_law() {
    for [degrees, upper, expected] in numbers_of("tables/noncentral.txt", "points of Student") {
        let found = student_point(upper, degrees).unwrap();
        // Next to ½ a tail is known to 2⁻⁵⁴.
        assert_near(found, expected, 1e-12 * expected.abs() + 1e-15);
    }
    assert!(student_point(0.5, 3.0).unwrap().abs() < 1e-15);
    let beyond = student_point(1e-300, 0.1);
    assert_eq!(beyond, Err(NumericError::Overflow { what: "the point" }));
}

// Of 30 degrees of freedom and less, and of more, another series is summed.
// Verifies: DET-005.
#[test]
fn a_zero_has_no_sign() {
    for degrees in [3.0, 30.0, 40.0] {
        for x in [0.0, -0.0] {
            let all = [chi_square(x, degrees, 0.5), f_ratio(x, degrees, 37.0, 0.5)];
            let none = Tails {
                lower: 0.0,
                upper: 1.0,
            };
            assert_eq!(all.map(Result::unwrap), [none; 2], "{x:?} {degrees}");
        }
    }
}

// Verifies: DET-005.
#[test]
fn what_has_no_answer_is_refused() {
    let nan = f64::NAN;
    let refused = |name: &str, found: Result<Tails, NumericError>| {
        let named = |error| matches!(error, NumericError::OutOfRange { what, .. } if what == name);
        assert!(found.is_err_and(named), "{name}: {found:?}");
    };
    for x in [-1.0, -5e-324, 1.1e152, f64::INFINITY, nan] {
        refused("x", chi_square(x, 3.0, 1.0));
        refused("x", f_ratio(x, 3.0, 3.0, 1.0));
    }
    for x in [-1.1e152, 1.1e152, f64::NEG_INFINITY, nan] {
        refused("x", student(x, 3.0, 1.0));
    }
    for degrees in [0.0, 0.09, -3.0, 2000001.0, f64::INFINITY, nan] {
        refused("degrees", chi_square(1.0, degrees, 1.0));
        refused("numerator", f_ratio(1.0, degrees, 3.0, 1.0));
        refused("denominator", f_ratio(1.0, 3.0, degrees, 1.0));
        refused("degrees", student(1.0, degrees, 1.0));
        assert!(chi_square_point(Tail::Lower(0.5), degrees).is_err());
        assert!(student_point(0.5, degrees).is_err());
    }
    for lambda in [-5e-324, 1.001e8, f64::INFINITY, nan] {
        refused("noncentrality", chi_square(1.0, 3.0, lambda));
        refused("noncentrality", f_ratio(1.0, 3.0, 3.0, lambda));
    }
    for delta in [-10000.1, 10000.1, f64::INFINITY, nan] {
        refused("noncentrality", student(1.0, 3.0, delta));
    }
    for p in [0.0, 1.0, -0.1, nan] {
        for found in [
            chi_square_point(Tail::Lower(p), 3.0),
            chi_square_point(Tail::Upper(p), 3.0),
            student_point(p, 3.0),
        ] {
            assert!(matches!(found, Err(NumericError::OutOfRange { .. })), "{p}");
        }
    }
}

/// Numbers of any size between 10^low and 10^high.
fn sizes(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(libm::exp10)
}

/// δ² of any size, or none.
fn squares() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), sizes(-6.0, 5.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    // Verifies: DET-134. Slack for monotony: twice DET-134.
    #[test]
    fn tails_add_up_and_are_monotone(
        degrees in sizes(-1.0, 4.0),
        denominator in sizes(-1.0, 4.0),
        lambda in squares(),
        more in 1.0..2.0,
        place in sizes(-3.0, 1.0),
    ) {
        let x = place * (degrees + lambda);
        let ratio = place * (1.0 + lambda / degrees);
        let sum = degrees + denominator + 2.0 * lambda;
        for (here, beyond, moved) in [
            (
                chi_square(x, degrees, lambda),
                chi_square(more * x, degrees, lambda),
                chi_square(x, degrees, more * lambda),
            ),
            (
                f_ratio(ratio, degrees, denominator, lambda),
                f_ratio(more * ratio, degrees, denominator, lambda),
                f_ratio(ratio, degrees, denominator, more * lambda),
            ),
            (
                student(place - 1.0, denominator, libm::sqrt(lambda)),
                student(more * place - 1.0, denominator, libm::sqrt(lambda)),
                student(place - 1.0, denominator, libm::sqrt(more * lambda)),
            ),
        ] {
            let (here, beyond, moved) = (here.unwrap(), beyond.unwrap(), moved.unwrap());
            prop_assert!((here.lower + here.upper - 1.0).abs() <= f64::EPSILON);
            let above = |large: f64, small: f64| large >= small - 2.0 * allowed(large, sum);
            prop_assert!(above(beyond.lower, here.lower) && above(here.upper, beyond.upper));
            prop_assert!(above(here.lower, moved.lower) && above(moved.upper, here.upper));
        }
    }

    // Verifies: DET-130. T² is F with 1 numerator degree; the signs of δ and t are one route through mixtures and one
    // through an integral.
    #[test]
    fn the_square_of_t_is_f(
        t in sizes(-2.0, 2.5),
        degrees in sizes(-1.0, 5.0),
        delta in 0.0..30.0,
    ) {
        let two_sided = f_ratio(t * t, 1.0, degrees, delta * delta).unwrap();
        let (same, other) = (
            student(t, degrees, delta).unwrap(),
            student(t, degrees, -delta).unwrap(),
        );
        let sum = degrees + delta * delta;
        let upper = same.upper + other.upper;
        // t² and δ² are rounded, which moves the logarithm of a tail by no more than 2⁻⁵² times itself and the degrees' root.
        let slack = 8.0 * allowed(upper, sum);
        prop_assert!((upper - two_sided.upper).abs() <= slack, "{upper:e} {two_sided:?}");
        let lower = same.lower - other.upper;
        prop_assert!((lower - two_sided.lower).abs() <= allowed(1.0, sum), "{lower:e}");
    }

    // Verifies: DET-130. With one degree X is (Z + δ)².
    #[test]
    fn one_degree_is_a_normal_deviate(root in 0.0..20.0_f64, delta in 0.0..20.0_f64) {
        let found = chi_square(root * root, 1.0, delta * delta).unwrap();
        let upper = normal::lower_tail(delta - root) + normal::lower_tail(-root - delta);
        let slack = 8.0 * allowed(upper, 1.0 + delta * delta);
        prop_assert!((found.upper - upper).abs() <= slack, "{found:?} {upper:e}");
    }
}
