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
//!     Ok(model.solve(Pose { depth: 4e-3, lateral: 0.0 })?.force.normal)
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
pub mod finite;
pub mod mesh;
mod model;
mod ordering;
pub mod size;
#[cfg(test)]
mod tests;
mod triangle;
mod triangulate;
mod vtu;

use std::fmt;

use crate::refusal::Refusal;
pub use contact::{Contact, ContactState, Surface};
pub use field::{Field, FieldCheck};
pub use mesh::{Mesh, Region};
pub use model::{Model, PoseSolution, State};
pub use size::MESH_SIZE;

/// Below this det(I + ∇u) a compressed neighbourhood has lost four fifths of its area, and small-strain
/// elasticity is far outside its range.
///
/// Implements: REP-015.
pub const SMALL_STRAIN_LIMIT: f64 = 0.2;

/// Young's modulus over that of another material from which on a compact body is as good as rigid, while rounding leaves small residuals.
const STIFFEST: f64 = 5e3;

/// Which class of processors has the same bits of every force as this one.
///
/// Implements: CON-008, CON-010.
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
#[derive(Debug, Clone, PartialEq)]
pub enum FemError {
    /// The phantom is not valid, no sound mesh has the size that was asked for, double precision does not hold its stiffness, or the
    /// forces do not make a map.
    Refused(Box<Refusal>),
    /// The probe cannot stand there, or the mesh is too coarse for its contact.
    Pose(Box<Refusal>),
    /// A solution leaves forces out of balance.
    Residual {
        /// ‖f − K u‖ / ‖f‖, or at finite strain the largest force out of balance over those of the contact.
        residual: f64,
    },
    /// Contact did not converge.
    NoConvergence {
        /// The pose.
        pose: Pose,
        /// Newton iterations spent.
        iterations: usize,
    },
    /// Memory ran out.
    OutOfMemory,
    /// The caller of [`Model::map`] did not want the rest.
    Stopped,
}

impl fmt::Display for FemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FemError::Refused(refusal) | FemError::Pose(refusal) => refusal.fmt(f),
            FemError::Residual { residual } => {
                let (limit, stiffest) = (cholesky::RESIDUAL_LIMIT, STIFFEST);
                write!(
                    f,
                    "forces are out of balance by {residual:.2e} of the load, more than {limit:e}; if a material is more than {stiffest} times as stiff as another, make it {stiffest} times as stiff, which changes the force by less than 0.1 % unless the body is thin; else try a greater depth or another mesh size"
                )
            }
            FemError::NoConvergence { pose, iterations } => {
                let [depth, lateral] = [pose.depth, pose.lateral].map(|length| 1e3 * length);
                write!(
                    f,
                    "contact at depth {depth:.3} mm, lateral {lateral:.3} mm did not converge in {iterations} iterations; try smaller depths or another mesh size"
                )
            }
            FemError::OutOfMemory => f.write_str("out of memory"),
            FemError::Stopped => f.write_str("stopped"),
        }
    }
}

impl std::error::Error for FemError {}

impl From<Refusal> for FemError {
    fn from(refusal: Refusal) -> FemError {
        FemError::Refused(refusal.into())
    }
}
