//! Code verification of the finite elements (`spec/verification.md`): each check compares with a closed form, or with
//! a law that the exact solution obeys. Calculation verification: how good the forces of the paper's poses are.
//!
//! | file | content |
//! |---|---|
//! | `patch.rs` | linear and quadratic fields, rigid motions |
//! | `manufactured.rs` | waves in a bent square, and locking |
//! | `cylinder.rs` | Lamé's cylinder, and locking |
//! | `inclusion.rs` | a disc in a far field |
//! | `layer.rs` | a bonded layer, and a strip between plates |
//! | `hertz.rs` | line contact |
//! | `energy.rs` | forces as slopes of the energy |
//! | `full_contact.rs` | contact without condensation, and mirror symmetry |
//! | `paper.rs` | the certificates of the paper's poses, and reference values |
//! | `problem.rs`, `convergence.rs`, `skyline.rs` | what they share: boundary-value problems, orders, elimination |
//! | `reference.py` | the stored errors, by scikit-fem |

mod convergence;
mod cylinder;
mod eigenvalues;
mod energy;
mod full_contact;
mod hertz;
mod inclusion;
mod layer;
mod manufactured;
mod paper;
mod patch;
mod problem;
mod skyline;

use super::{Check, Figure};

/// What a check gives: its figures, or why it cannot be carried out.
type Figures = Result<Vec<Figure>, String>;

/// The checks of this part. Sines and the like are `libm`'s in all of them.
///
/// Implements: EVD-045, EVD-047.
pub const CHECKS: &[Check] = &[
    patch::LINEAR,
    patch::QUADRATIC,
    patch::RIGID,
    manufactured::TRIANGLES,
    manufactured::LOCKING,
    cylinder::LAME,
    cylinder::LOCKING,
    inclusion::DISC,
    layer::BONDED,
    layer::STRIP,
    hertz::HERTZ,
    energy::SLOPES,
    full_contact::DEFORMED_NORMAL,
    full_contact::VERTICAL_GAP,
    full_contact::MIRROR,
    paper::REFERENCE,
    paper::CERTIFICATES,
];

/// The text of an error.
fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// The largest of `values`, at least 0; NaN if there is one among them, which `f64::max` would lose.
///
/// Implements: EVD-046.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    values.into_iter().fold(0.0, larger)
}

/// The least of `values`; NaN if there is one among them, infinite if there is none.
///
/// Implements: EVD-046.
fn least(values: impl IntoIterator<Item = f64>) -> f64 {
    let smaller = |a: f64, b: f64| if a.is_nan() || a < b { a } else { b };
    values.into_iter().fold(f64::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: EVD-046.
    #[test]
    fn no_nan_is_lost() {
        assert_eq!(largest([1.0, 3.0, 2.0]), 3.0);
        assert_eq!(least([2.0, 1.0, 3.0]), 1.0);
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(values).is_nan() && least(values).is_nan());
        }
        assert!(!Figure::told("", least([])).passes());
    }

    // Verifies: EVD-047.
    #[test]
    fn no_figure_depends_on_the_system_s_mathematical_library() {
        let sources = [
            include_str!("convergence.rs"),
            include_str!("cylinder.rs"),
            include_str!("energy.rs"),
            include_str!("full_contact.rs"),
            include_str!("hertz.rs"),
            include_str!("inclusion.rs"),
            include_str!("layer.rs"),
            include_str!("manufactured.rs"),
            include_str!("paper.rs"),
            include_str!("patch.rs"),
            include_str!("problem.rs"),
            include_str!("skyline.rs"),
        ];
        for function in [
            "sin", "cos", "tan", "sin_cos", "atan2", "sinh", "cosh", "tanh", "exp", "ln", "log2",
            "log10", "powf", "cbrt", "hypot", "norm", "mul_add",
        ] {
            let call = format!(".{function}(");
            assert!(
                !sources.iter().any(|source| source.contains(&call)),
                "{call}"
            );
        }
    }
}
