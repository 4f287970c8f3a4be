//! Code verification of the finite elements (`spec/fem.md`): each check compares with a closed form, or with
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
//! | `problem.rs`, `convergence.rs` | what they share: boundary-value problems, elimination, orders |
//! | `reference.py` | the stored errors, by scikit-fem |

mod convergence;
mod cylinder;
mod energy;
mod full_contact;
mod hertz;
mod inclusion;
mod layer;
mod manufactured;
mod paper;
mod patch;
mod problem;

use super::{Check, Figure, Measured};
use palpate::fem::Contact;

/// The checks of this part. Sines and the like are `libm`'s in all of them.
pub const CHECKS: &[Check] = checks! {
    "fem.linear_patch" ["FEM-050"] => patch::linear,
        "A linear displacement prescribed along the border is found inside to rounding, with its gradient and stress, on a \
         distorted mesh of straight or curved triangles.",
        "Rounding: the condition of the matrix (10³) times 1.1e-16, stresses multiplied by λ/μ = 49 once more. Fixed in \
         0.1.0.";
    "fem.quadratic_patch" ["FEM-050"] => patch::quadratic,
        "A quadratic displacement is found to rounding by straight triangles; curved ones, which cannot hold it, are seen to \
         miss it.",
        "Rounding, as of the linear patch. That the curved mesh misses the field by 1e-3 at least only shows that the check \
         can fail. Fixed in 0.1.0.";
    "fem.rigid_modes" ["FEM-050"] => patch::rigid,
        "An element and a mesh without supports have three motions without energy, the rigid ones, and no other.",
        "Zeros: 10² roundings of the largest eigenvalue. Others: μ/(λ + 2μ) times (element size/mesh size)². Fixed in 0.1.0.";
    "fem.manufactured_t6" ["FEM-050", "FEM-062"] => manufactured::triangles,
        "On four bent meshes t6 converges to a manufactured solution with the orders 3 (displacement) and 2 (gradient), at ν = \
         0.3 and 0.49, with the errors that scikit-fem has on the same meshes.",
        "Orders: theory (3 and 2) less 0.1. Errors: within 0.1 % of those that scikit-fem computed on the same meshes. Fixed \
         in 0.1.0.";
    "fem.manufactured_locking" ["FEM-050"] => manufactured::locking,
        "From ν = 0.3 to 0.4999 the gradient keeps an order of at least 1 on a field that is almost free of divergence.",
        "Order: the theory's of every ν (Babuška and Suri, 1992). Error: FEM-050. Fixed in 0.1.0.";
    "fem.cylinder" ["FEM-050", "FEM-062"] => cylinder::pressed,
        "A cylinder under internal pressure at ν = 0.49 converges to Lamé's displacement and stress, with the errors that \
         scikit-fem has on the same five meshes.",
        "Orders: theory (displacement 3, less 0.1; stress 1, the order for every ν). Errors: within 0.1 % of scikit-fem's. \
         Fixed in 0.2.0.";
    "fem.cylinder_locking" ["FEM-050"] => cylinder::locking,
        "On MacNeal's and Harder's cylinder the triangles do not lock from ν = 0.3 to 0.4999.",
        "FEM-050 states the limit: 4 % on MacNeal's and Harder's standard mesh, a tenth of it up to ν = 0.49. Fixed in 0.1.0.";
    "fem.disc" ["FEM-050", "FEM-062"] => inclusion::disc,
        "A stiff disc in a far field, with the moduli of gel and inclusion, converges to the exact field, and the stress in it \
         to Eshelby's uniform one.",
        "Orders: theory (displacement 3, less 0.1; stress 1, the order for every ν). Errors: within 0.1 % of stored ones, our \
         own. Fixed in 0.2.0.";
    "fem.bonded_layer" ["FEM-050", "FEM-062"] => layer::bonded,
        "A layer bonded to a rigid base under a wave of pressure, short or long against its thickness, converges to the closed \
         form.",
        "Orders: theory (3 less 0.1 and 1; at ν = 0.4999, 2 and 1). Errors: within 0.1 % of stored ones, our own. Closed form: \
         rounding. Fixed in 0.2.0.";
    "fem.thin_strip" ["FEM-050"] => layer::thin,
        "The force on a thin strip between rigid bonded plates tends to the lubrication limit, 1 − tanh(2)/2 of a wide \
         strip's.",
        "The edges leave c/s + c₂/s² + c₃/s³ at the slenderness s; extrapolation removes two terms, and the third is 1.3e-4 \
         c₃, c₃ up to 4. Fixed in 0.1.0.";
    "fem.hertz" ["FEM-050"] => hertz::line_contact,
        "Load and half-width of the probe's contact with a thick layer obey Hertz, with both contact laws.",
        "Each load: pressure misplaced by one spacing of the points at the edge, and the terms that Hertz leaves out. Mean: \
         the 0.3 % of FEM-021, and those terms. Fixed in 0.2.0.";
    "fem.energy_slopes" ["FEM-059", "FEM-012"] => energy::slopes,
        "Over whole maps the normal force is the slope of the strain energy in the depth, the lateral force its negative slope \
         in x, and their cross slopes agree, within the error of central differences.",
        "Third differences bound the error of the central ones. Kinks: the share of poses at which an edge of contact passes a \
         point, and three standard deviations. Fixed in 0.1.0.";
    "fem.condensed_contact" ["FEM-060"] => || full_contact::compare("2.6", Contact::DeformedNormal),
        "Contact solved on the condensed surface equals Newton's method on all unknowns at once, and poses at x and −x that \
         are solved each by itself agree.",
        "FEM-060 and FEM-060 state the limits, 1e-9 N and 1e-12 m: the contact iteration stops at steps below 1e-13 m. Fixed \
         in 0.1.0.";
    "fem.condensed_vertical_contact" ["FEM-060"] => || full_contact::compare("6.6", Contact::VerticalGap),
        "The same with the contact law of vertical gaps.",
        "As of fem.condensed_contact. Fixed in 0.1.0.";
    "fem.mirror_symmetry" ["FEM-060", "FEM-014"] => full_contact::mirror,
        "A map of 8 depths and 21 lateral positions is mirror-symmetric in x to the bit.",
        "None: the same bits, counted. Fixed in 0.1.0.";
    "fem.reference_forces" ["FEM-020"] => paper::reference,
        "The normal force at a depth of 4 mm, x = 0, is 1.48 N without inclusion and 0.31 N more with the 6.6 mm one, as an \
         independent program found.",
        "Half a unit of the last digit that an independent program printed, 1.48 N and 0.31 N. Fixed in 0.1.0.";
    "fem.certificates" ["FEM-008", "FEM-009", "FEM-014", "FEM-013", "FEM-026"] => paper::certificates,
        "At 15 poses of each of the paper's five phantoms the linear solves leave less than their limit, no contact \
         point of the surface is inside the probe, and the forces are mirror-symmetric; the bands say how far the forces may be from those \
         of an infinitely fine mesh.",
        "FEM-008 and FEM-009 state the limits of residual and penetration. Bands are told. Fixed in 0.1.0.";
};

/// The largest of `values`, at least 0; NaN if there is one among them, which `f64::max` would lose.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    values.into_iter().fold(0.0, larger)
}

/// The least of `values`; NaN if there is one among them, infinite if there is none.
fn least(values: impl IntoIterator<Item = f64>) -> f64 {
    let smaller = |a: f64, b: f64| if a.is_nan() || a < b { a } else { b };
    values.into_iter().fold(f64::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_nan_is_lost() {
        assert_eq!(largest([1.0, 3.0, 2.0]), 3.0);
        assert_eq!(least([2.0, 1.0, 3.0]), 1.0);
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(values).is_nan() && least(values).is_nan());
        }
        assert!(!Figure::told("", least([])).passes());
    }
}
