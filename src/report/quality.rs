//! The certificates of the maps in short, and what a reader must be warned of.

use serde::Serialize;

use super::text::millimetres;
use crate::force_map::{Discretization, ForceMap};

/// Below this det(I + ∇u) a compressed neighbourhood has lost four fifths of its area, and small-strain
/// elasticity is far outside its range.
///
/// Implements: REP-015.
pub const SMALL_STRAIN_LIMIT: f64 = 0.2;

/// The certificate of a computed map, in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quality {
    /// The largest relative residual of the linear solves.
    pub worst_relative_residual: f64,
    /// The largest difference between the force on the probe and the reaction of the well, N.
    #[serde(rename = "worst_force_balance_n")]
    pub worst_force_balance: f64,
    /// The largest half band of the discretisation around a normal force, N, where it was estimated.
    #[serde(rename = "largest_normal_band_n")]
    pub largest_normal_band: Option<f64>,
    /// The same of the lateral forces, N.
    #[serde(rename = "largest_lateral_band_n")]
    pub largest_lateral_band: Option<f64>,
    /// The largest depth of a surface node inside the probe, m.
    #[serde(rename = "largest_penetration_m")]
    pub largest_penetration: f64,
    /// The smallest det(I + ∇u) of all poses.
    pub smallest_det: f64,
    /// The depth of that pose, m.
    #[serde(rename = "smallest_det_depth_m")]
    pub smallest_det_depth: f64,
    /// The lateral position of that pose, m.
    #[serde(rename = "smallest_det_lateral_m")]
    pub smallest_det_lateral: f64,
    /// The size of the mesh, m.
    #[serde(rename = "mesh_size_m")]
    pub mesh_size: f64,
    /// The number of nodes.
    pub nodes: usize,
    /// The element's name.
    pub element: String,
    /// The contact law's name.
    pub contact: String,
    /// The version of the program that computed the map.
    pub program_version: String,
}

pub(super) fn quality(map: &ForceMap) -> Option<Quality> {
    let certificate = map.certificate()?;
    let smallest = certificate.smallest_det;
    let bands = certificate
        .discretization
        .as_ref()
        .map(Discretization::largest);
    Some(Quality {
        worst_relative_residual: certificate.worst_relative_residual,
        worst_force_balance: certificate.worst_force_balance,
        largest_normal_band: bands.map(|[normal, _]| normal),
        largest_lateral_band: bands.map(|[_, lateral]| lateral),
        largest_penetration: certificate.largest_penetration,
        smallest_det: smallest.det,
        smallest_det_depth: smallest.depth,
        smallest_det_lateral: smallest.lateral,
        mesh_size: certificate.mesh_size,
        nodes: certificate.nodes,
        element: certificate.element.clone(),
        contact: certificate.contact.clone(),
        program_version: map.program_version().into(),
    })
}

/// Implements: REP-014, REP-015.
pub(super) fn warnings(quality: Option<&Quality>, gamma: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(quality) = quality.filter(|quality| quality.smallest_det < SMALL_STRAIN_LIMIT) {
        warnings.push(format!(
            "Small strain is at its limit: det(I + ∇u) falls to {:.3} at depth {} mm, x = {} mm (below {SMALL_STRAIN_LIMIT}); forces near that pose are the linear model's, not a real gel's.",
            quality.smallest_det,
            millimetres(quality.smallest_det_depth),
            millimetres(quality.smallest_det_lateral),
        ));
    }
    if gamma == 0.0 {
        warnings.push(
            "No signal: the forces equal the reference's, so nothing can be detected.".into(),
        );
    }
    warnings
}
