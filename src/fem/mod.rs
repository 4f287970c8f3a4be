//! The force on the probe by 2D finite elements (paper §3.1; `spec/fem.md`).
//!
//! [`Model`] meshes a phantom, assembles its stiffness, factorises it once with the surface unknowns
//! last, and keeps the surface's compliance. A [`Pose`] of the probe is then a small contact problem.

pub mod assembly;
pub mod certify;
pub mod cholesky;
pub mod contact;
pub mod element;
mod elimination;
pub mod field;
mod front;
pub mod mesh;
mod model;
mod ordering;
mod outline;
#[cfg(test)]
mod tests;
mod vtu;

use crate::force_map::InvalidForceMap;
use crate::phantom::{InvalidPhantom, PoseError};
pub use contact::{Contact, ContactState, Surface};
pub use field::{Field, FieldCheck};
pub use mesh::{Element, Mesh};
pub use model::{Model, PoseSolution, solved_laterals};

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

/// How fine the mesh is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshOptions {
    /// Target distance between the corners of the triangles along the surface, m.
    pub size: f64,
    /// Factor on every count of cells: 2 halves each cell.
    pub refinement: usize,
    /// The shape of every element.
    pub element: Element,
}

impl Default for MeshOptions {
    fn default() -> Self {
        MeshOptions {
            size: 0.5e-3,
            refinement: 1,
            element: Element::T6,
        }
    }
}

/// What can go wrong between a phantom and a force.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FemError {
    /// The phantom is not valid.
    #[error(transparent)]
    Phantom(#[from] InvalidPhantom),
    /// The probe cannot stand there.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The forces do not make a map: its axes are not valid, or the forces are not symmetric.
    #[error(transparent)]
    Map(#[from] InvalidForceMap),
    /// The mesh would be empty or too large.
    #[error("mesh size {} mm with refinement {refinement}: expected a size above 0 and at most 500000 nodes", size * 1e3)]
    MeshSize {
        /// Wanted size, m.
        size: f64,
        /// Wanted refinement.
        refinement: usize,
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
    /// The mesh is not its own mirror image.
    #[error("element {element} near x = {:.3} mm, y = {:.3} mm has no mirror image: the solver needs a mesh that is mirror-symmetric in x", at[0] * 1e3, at[1] * 1e3)]
    Asymmetric {
        /// Number of the element.
        element: usize,
        /// Position of its first node, m.
        at: [f64; 2],
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
