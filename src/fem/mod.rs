//! The force on the probe by 2D finite elements (paper §3.1; `spec/fem.md`).
//!
//! [`Model`] meshes a phantom, assembles its stiffness, factorises it once with the surface unknowns
//! last, and keeps the surface's compliance. A [`Pose`] of the probe is then a small contact problem.

pub mod assembly;
pub mod cholesky;
pub mod contact;
pub mod element;
pub mod field;
pub mod mesh;
mod outline;

use crate::phantom::Phantom;
use assembly::StiffnessMatrix;
use cholesky::{Factor, check_residual};
pub use contact::{Contact, ContactState, Surface};
use field::{BATCH, Batch, FieldCheck, Samples};
pub use mesh::{Element, Mesh};

/// Where the probe stands.
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
            size: 0.7e-3,
            refinement: 1,
            element: Element::T6,
        }
    }
}

/// What can go wrong between a phantom and a force.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FemError {
    /// The mesh would be empty or too large.
    #[error("mesh size {} mm with refinement {refinement}: expected a size that gives 2 to 2000 cells across the well", size * 1e3)]
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

/// The result at one pose.
#[derive(Debug, Clone)]
pub struct PoseSolution {
    /// The pose.
    pub pose: Pose,
    /// Force on the probe along +x, N.
    pub lateral_force: f64,
    /// Force on the probe out of the gel, N.
    pub normal_force: f64,
    /// Strain energy, J.
    pub energy: f64,
    /// Surface displacements and contact forces.
    pub contact: ContactState,
    /// Largest penetration of a surface node, m.
    pub penetration: f64,
    /// Checks of the whole field.
    pub check: FieldCheck,
}

/// A phantom, meshed and factorised.
#[derive(Debug, Clone)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// The stiffness matrix.
    pub matrix: StiffnessMatrix,
    /// Its factor.
    pub factor: Factor,
    /// The surface, ready for contact.
    pub surface: Surface,
    samples: Samples,
}

impl Model {
    /// Meshes and factorises a phantom.
    pub fn new(
        phantom: &Phantom,
        options: &MeshOptions,
        contact: Contact,
    ) -> Result<Model, FemError> {
        let mesh = Mesh::new(phantom, options)?;
        let matrix = StiffnessMatrix::assemble(&mesh, phantom)?;
        let factor = Factor::new(&matrix)?;
        let positions = mesh.nodes[mesh.surface()].to_vec();
        let surface = Surface::new(factor.surface_factor(), positions, phantom.probe, contact);
        let samples = Samples::new(&mesh, &matrix);
        Ok(Model {
            mesh,
            matrix,
            factor,
            surface,
            samples,
        })
    }
}
