//! The detector that takes a record row by row: whatever a row holds.

use bolero::{Driver, TypeGenerator};
use palpate_core::detect::sequential::{Sequential, memory};

/// Two rows with one signal and no nuisance: no rotation, whose square root Kani does not know.
#[derive(Debug, Clone)]
pub struct Rows([Row; 2]);

#[derive(Debug, Clone)]
struct Row {
    residual: f64,
    signal: f64,
}

impl TypeGenerator for Rows {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        const ODD: [f64; 6] = [f64::NAN, f64::INFINITY, 0.0, 1e80, -1e80, 1.1e80];
        let number = |driver: &mut D| match driver.gen_variant(4, 0)? {
            1 => Some(ODD[driver.gen_variant(ODD.len(), 0)?]),
            _ => driver.produce::<f64>(),
        };
        let mut row = || {
            Some(Row {
                residual: number(driver)?,
                signal: number(driver)?,
            })
        };
        Some(Rows([row()?, row()?]))
    }
}

/// Above the sum of two products of numbers up to 10⁸⁰, which is below 2²⁶⁶.
const BOUND: f64 = f64::from_bits((1023 + 534) << 52);

// Verifies: SEQ-005, SEQ-006.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical), kani::unwind(10))]
fn a_row_is_refused_or_leaves_finite_numbers() {
    harness!(Rows, |case| {
        let mut found = Sequential::new([0.0; memory(1, 0)], 1, 0).unwrap();
        let (mut refused, mut missing) = (0, 0);
        let state = |found: &Sequential<[f64; memory(1, 0)]>| {
            let evidence = found.evidence().next().unwrap();
            (evidence, found.residual(), found.rows(), found.missing())
        };
        for Row { residual, signal } in &case.0 {
            let before = state(&found);
            let result = found.push(*residual, &[], &[*signal]);
            let after = state(&found);
            let is_small = |number: f64| (-1e80..=1e80).contains(&number);
            if !is_small(*signal) || !(is_small(*residual) || residual.is_nan()) {
                refused += 1;
                assert!(result.is_err() && after == before);
            } else if residual.is_nan() {
                missing += 1;
                assert!(result.is_ok() && after == (before.0, before.1, before.2, before.3 + 1));
            } else {
                let (evidence, squares, rows, _) = after;
                assert!(result.is_ok() && rows == before.2 + 1);
                assert!((-BOUND..BOUND).contains(&evidence.along));
                for square in [evidence.gamma_squared, squares] {
                    assert!((0.0..BOUND).contains(&square));
                }
            }
        }
        reached! {
            "a row is refused": refused > 0,
            "a residual is missing": missing > 0,
            "both rows are taken": refused == 0 && missing == 0,
            "the largest signal": case.0[0].signal == 1e80,
        }
    });
}
