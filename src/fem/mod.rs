//! The force on the probe by 2D finite elements (paper §3.1; `spec/fem.md`).
//!
//! [`Model`] meshes a phantom, assembles its stiffness, factorises it once with the surface unknowns
//! last, and keeps the surface's compliance. A [`Pose`] of the probe is then a small contact problem.
//!
//! ```
//! use palpate::fem::{Contact, MeshOptions, Model, Pose};
//! use palpate::phantom::Phantom;
//!
//! let coarse = MeshOptions { size: 2e-3, ..MeshOptions::default() };
//! let force = |name| -> Result<f64, Box<dyn std::error::Error>> {
//!     let model = Model::new(&Phantom::builtin(name)?, &coarse, Contact::default())?;
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
pub(crate) mod dense;
pub mod element;
mod elimination;
mod field;
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
pub use dense::SquareMatrix;
pub use field::{Field, FieldCheck};
pub use mesh::{Element, Mesh};
pub use model::{Model, PoseSolution, solved_laterals};

/// Where the probe stands.
///
/// ```
#[doc = include_str!("coarse.example")]
/// use palpate::fem::FemError;
///
/// // Below the floor, or in the wall, no probe can stand.
/// assert!(matches!(model.solve(Pose { depth: 16e-3, ..pose }), Err(FemError::Pose(_))));
/// assert!(matches!(model.solve(Pose { lateral: 16e-3, ..pose }), Err(FemError::Pose(_))));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
///
/// ```
/// use palpate::fem::{Element, Mesh, MeshOptions};
/// use palpate::phantom::Phantom;
///
/// let coarse = MeshOptions { size: 2e-3, ..MeshOptions::default() };
/// let halved = MeshOptions { refinement: 2, ..coarse };
/// let phantom = Phantom::builtin("6.6")?;
/// let elements = |options| Mesh::new(&phantom, options).map(|mesh| mesh.regions.len());
/// // Four times as many, but for the one row between the coarse and the fine part.
/// assert!(elements(&halved)? > 3 * elements(&coarse)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
///
/// ```
/// use palpate::fem::{FemError, Mesh, MeshOptions};
/// use palpate::phantom::Phantom;
///
/// let options = MeshOptions { size: -1e-3, ..MeshOptions::default() };
/// let error = Mesh::new(&Phantom::builtin("none")?, &options).unwrap_err();
/// assert_eq!(error, FemError::MeshSize { size: -1e-3, refinement: 1 });
/// assert!(error.to_string().starts_with("mesh size -1 mm with refinement 1: expected a size above 0"));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
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
