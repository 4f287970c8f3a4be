//! Expected values: mpmath at 40 digits (`src/paper/psychophysics/reference.py`), and closed forms.

use super::*;
use crate::stats::noncentral::{f_ratio, student, student_point};
use palpate_asserts::{assert_near, numbers_of};

/// Asserts |found/expected − 1| ≤ `tolerance`.
#[track_caller]
fn assert_relative(found: Result<f64, NumericError>, expected: f64, tolerance: f64) {
    let found = found.unwrap();
    assert_near(found / expected, 1.0, tolerance);
}

/// For parameters up to 20 (`tests/tables/tails.txt`).
const SMALL: f64 = 2e-13;

fn f_tail(x: f64, numerator: f64, denominator: f64) -> Result<f64, NumericError> {
    f_ratio(x, numerator, denominator, 0.0).map(|tails| tails.upper)
}

// Verifies: PSY-030.
#[test]
fn tails_of_the_gamma_law() {
    for [shape, x, expected, tolerance] in numbers_of("tables/tails.txt", "gamma") {
        assert_relative(gamma_tail(shape, x), expected, tolerance);
    }
    assert_eq!(gamma_tail(3.0, 0.0), Ok(1.0));
}

// Verifies: PSY-030, DET-130.
#[test]
fn closed_forms() {
    for x in [0.1, 1.0, 5.0, 40.0] {
        // Chi-square with 2 degrees of freedom is exponential; with 4 it is (1 + x/2) exp(−x/2).
        assert_relative(chi_square_tail(x, 2.0), (-0.5 * x).exp(), SMALL);
        assert_relative(
            chi_square_tail(x, 4.0),
            (1.0 + 0.5 * x) * (-0.5 * x).exp(),
            SMALL,
        );
        // F with 2 and n degrees of freedom: (1 + 2x/n)^(−n/2).
        assert_relative(
            f_tail(x, 2.0, 7.0),
            (1.0 + 2.0 * x / 7.0_f64).powf(-3.5),
            SMALL,
        );
        // Student's law with 1 degree of freedom is Cauchy's.
        let cauchy = core::f64::consts::FRAC_2_PI * (1.0 / x).atan();
        let upper = student(x, 1.0, 0.0).map(|tails| tails.upper);
        assert_relative(upper, 0.5 * cauchy, SMALL);
    }
}

// Verifies: PSY-030, DET-130.
#[test]
fn tails_of_the_f_law() {
    for [x, numerator, denominator, expected, tolerance] in numbers_of("tables/tails.txt", "F") {
        assert_relative(f_tail(x, numerator, denominator), expected, tolerance);
    }
}

// Verifies: PSY-030.
#[test]
fn quantiles_of_students_law() {
    for [confidence, degrees, expected, tolerance] in
        numbers_of("tables/tails.txt", "points of Student")
    {
        let found = student_point(0.5 * (1.0 - confidence), degrees);
        assert_relative(found, expected, tolerance);
    }
}

// Verifies: PSY-030.
#[test]
fn what_has_no_answer_is_refused() {
    let refused = |found: Result<f64, NumericError>, name: &str| {
        let named = |error| matches!(error, NumericError::OutOfRange { what, .. } if what == name);
        assert!(found.is_err_and(named), "{name}: {found:?}");
    };
    for (shape, x) in [(0.0, 1.0), (-1.0, 1.0), (2e6, 1.0), (f64::NAN, 1.0)] {
        refused(gamma_tail(shape, x), "shape");
    }
    for x in [-1.0, f64::NAN, f64::INFINITY] {
        refused(gamma_tail(1.0, x), "x");
    }
}
