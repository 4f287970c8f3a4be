//! The force on the probe by 2D finite elements (paper §3.1; `spec/fem.md`).
//!
//! [`Model`] meshes a phantom, assembles its stiffness, factorises it once with the surface unknowns
//! last, and keeps the surface's compliance. A [`Pose`] of the probe is then a small contact problem.
//!
//! ```
//! use palpate::fem::{Contact, Model, Pose};
//! use palpate::phantom::Phantom;
//!
//! let force = |name| -> Result<f64, Box<dyn std::error::Error>> {
//!     let model = Model::new(&Phantom::builtin(name)?, 2e-3, Contact::default())?;
//!     Ok(model.solve(Pose { depth: 4e-3, lateral: 0.0 })?.normal_force)
//! };
//! // The inclusion under 6.6 mm of gel pushes back with some 0.3 N more.
//! let signal = force("6.6")? - force("none")?;
//! assert!(signal > 0.25 && signal < 0.4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod assembly;
pub mod certify;
pub mod cholesky;
mod contact;
pub mod element;
mod field;
pub mod mesh;
mod model;
mod ordering;
pub mod size;
#[cfg(test)]
mod tests;
mod triangulate;
mod vtu;

use crate::refusal::Refusal;
pub use contact::{Contact, ContactState, Surface};
pub use field::{Field, FieldCheck};
pub use mesh::{Mesh, Region};
pub use model::{Model, PoseSolution};
pub use size::MESH_SIZE;

/// Which class of processors has the same bits of every force as this one.
///
/// Implements: CON-008, CON-009, CON-010.
pub fn arithmetic() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        return "x86-64 with AVX2 and FMA";
    }
    "other"
}

/// Where the probe stands.
///
/// Implements: CON-003.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Depth of the probe's lowest point below the undeformed surface, m.
    pub depth: f64,
    /// Lateral position of the probe's axis, m.
    pub lateral: f64,
}

/// What can go wrong between a phantom and a force.
///
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FemError {
    /// The phantom is not valid, or the forces do not make a map: its axes are not valid, or the forces are not symmetric.
    #[error(transparent)]
    Refused(Box<Refusal>),
    /// The probe cannot stand there.
    #[error(transparent)]
    Pose(Box<Refusal>),
    /// The mesh size is no length.
    #[error("mesh size {} mm, expected a finite number above 0", size * 1e3)]
    MeshSize {
        /// Wanted size, m.
        size: f64,
    },
    /// The mesh would be too large.
    #[error("mesh size {} mm makes about {nodes:.0} nodes, allowed: at most 500000; a larger size makes fewer", size * 1e3)]
    TooManyNodes {
        /// Wanted size, m.
        size: f64,
        /// About how many nodes that makes.
        nodes: f64,
    },
    /// A triangle came out too flat, or two lines cross.
    #[error(
        "a triangle near x = {:.3} mm, y = {:.3} mm has an angle of {angle:.1}°, expected at least {}°: the mesh cannot follow this phantom; try another mesh size",
        at[0] * 1e3, at[1] * 1e3, triangulate::SMALLEST_ANGLE
    )]
    Shape {
        /// One of its corners, m.
        at: [f64; 2],
        /// Its smallest angle, degrees; 0 where lines cross.
        angle: f64,
    },
    /// An element is turned inside out.
    #[error("element {element} near x = {:.3} mm, y = {:.3} mm has the Jacobian {jacobian:e}: the mesh cannot follow this phantom; try a finer mesh", at[0] * 1e3, at[1] * 1e3)]
    Degenerate {
        /// Number of the element.
        element: usize,
        /// Position of its first node, m.
        at: [f64; 2],
        /// The Jacobian that is not positive.
        jacobian: f64,
    },
    /// The stiffness matrix cannot be factorised.
    #[error(
        "the stiffness matrix is not positive definite in double precision: moduli or sizes differ by too many orders of magnitude"
    )]
    NotPositiveDefinite,
    /// A linear solve left too much.
    #[error(
        "a linear solve left the relative residual {residual:e}, more than {:e}",
        cholesky::RESIDUAL_LIMIT
    )]
    Residual {
        /// ‖f − K u‖ / ‖f‖.
        residual: f64,
    },
    /// Contact did not converge.
    #[error("contact at depth {} mm, lateral {} mm did not converge in {iterations} iterations", pose.depth * 1e3, pose.lateral * 1e3)]
    NoConvergence {
        /// The pose.
        pose: Pose,
        /// Newton iterations spent.
        iterations: usize,
    },
    /// Memory ran out.
    #[error("out of memory")]
    OutOfMemory,
}

impl From<Refusal> for FemError {
    fn from(refusal: Refusal) -> FemError {
        FemError::Refused(refusal.into())
    }
}
