//! Expected values: mpmath 1.4.1 at 40 digits from the definitions, and the paper's print.

use super::*;
use palpate_asserts::{assert_near, assert_ulps};

// Verifies: DET-100.
#[test]
fn budget_of_the_papers_example() {
    let budget = noise_budget(0.5, 0.05, 0.05, &[0.1]).unwrap();
    assert_ulps(budget.gamma, 3.2897072539029453, 4.0);
    assert_ulps(budget.total_allowed_n, 0.15198920797794224, 6.0);
    assert_ulps(budget.remaining_n, 0.1144583738385365, 12.0);
    // Nothing left, and nothing used.
    let exhausted = noise_budget(0.5, 0.05, 0.05, &[0.1, 0.12]).unwrap();
    assert_eq!(exhausted.remaining_n, 0.0);
    let untouched = noise_budget(0.5, 0.05, 0.05, &[]).unwrap();
    assert_ulps(untouched.remaining_n, untouched.total_allowed_n, 2.0);
}

// Verifies: DET-100.
#[test]
fn sources_of_table_2() {
    let total = |sources: &[f64]| noise_total(sources).unwrap();
    assert_ulps(
        total(&[0.02, 0.0005, 0.14, 0.093]),
        0.16926089329789087,
        4.0,
    );
    // The paper: FEM playback 170 mN, direct contact 220 mN.
    assert_near(total(&[0.0005, 0.14, 0.093]), 0.17, 0.005);
    assert_near(total(&[0.2, 0.093]), 0.22, 0.005);
    // Squares that would underflow.
    assert_ulps(total(&[3e-200, 4e-200]), 5e-200, 2.0);
}

// Verifies: DET-005, DET-008.
#[test]
fn budgets_without_an_answer_are_refused() {
    for p in [0.0, 1.0, f64::NAN, -0.1] {
        assert!(noise_budget(0.5, p, 0.05, &[]).is_err());
        assert!(noise_budget(0.5, 0.05, p, &[]).is_err());
    }
    assert!(noise_budget(0.5, 0.5, 0.5, &[]).is_err());
    assert!(noise_budget(0.5, 0.9, 0.5, &[]).is_err());
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(noise_budget(bad, 0.05, 0.05, &[]).is_err());
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(noise_budget(0.5, 0.05, 0.05, &[0.1, bad]).is_err());
        assert!(noise_total(&[bad]).is_err());
    }
    assert!(noise_total(&[]).is_err() && noise_total(&[0.0]).is_err());
    assert!(noise_total(&[1.7e308, 1.7e308]).is_err());
}
