//! What a computed force map says about its own quality.

use serde::{Deserialize, Serialize};

use super::table::check_number;
use super::{Matrix, SAME_POSITION};
use crate::refusal::Refusal;

/// The evidence that comes with a map from finite elements. Plain data; [`super::ForceMap::new`]
/// checks it.
///
/// Implements: MAP-006.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// The largest relative residual ‖Ku − f‖/‖f‖ of the linear solves.
    pub worst_relative_residual: f64,
    /// The largest difference, N, between the force on the probe and the reaction of floor and walls.
    #[serde(rename = "worst_force_balance_n")]
    pub worst_force_balance: f64,
    /// The largest depth, m, of a surface node inside the probe.
    #[serde(rename = "largest_penetration_m")]
    pub largest_penetration: f64,
    /// The number of Newton iterations over all poses.
    pub newton_iterations: usize,
    /// The size H of the mesh, m, as asked for.
    #[serde(rename = "mesh_size_m")]
    pub mesh_size: f64,
    /// The number of nodes.
    pub nodes: usize,
    /// The number of elements.
    pub elements: usize,
    /// The name of the element, as on the command line.
    pub element: String,
    /// The name of the contact law, as on the command line.
    pub contact: String,
    /// The name of the material's law at finite strain; `None` at small strain.
    ///
    /// Implements: FIN-008.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// The class of processors that has the same bits of every force.
    ///
    /// Implements: CON-010.
    pub arithmetic: String,
    /// The smallest entry of `min_det` with its pose.
    pub smallest_det: SmallestDet,
    /// The smallest det(I + ∇u) in the mesh at every pose; depths × lateral positions. Near 0 the
    /// small-strain model is at its limit, and below 0 the gel is inside out.
    pub min_det: Matrix,
    /// How far each force may be from that of an infinitely fine mesh; `None` where it was not estimated.
    ///
    /// Implements: MAP-006.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretization: Option<Discretization>,
}

/// Bands of the discretisation around the forces of a map, from three meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Discretization {
    /// Nodes of the meshes, the published one's first.
    pub nodes: [usize; 3],
    /// Half the band around each normal force, N; depths × lateral positions.
    #[serde(rename = "normal_force_band_n")]
    pub normal_force_band: Matrix,
    /// Half the band around each lateral force, N.
    #[serde(rename = "lateral_force_band_n")]
    pub lateral_force_band: Matrix,
}

impl Discretization {
    /// Whether the bands are finite, at least 0, and of the `shape` of the forces.
    ///
    /// Implements: MAP-006, MAP-002.
    pub(super) fn check(&self, shape: [usize; 2]) -> Result<(), Refusal> {
        let (normal, lateral) = (&self.normal_force_band, &self.lateral_force_band);
        for (channel, band) in [("normal", normal), ("lateral", lateral)] {
            let key = format!("certificate.discretization.{channel}_force_band_n");
            band.check(&key, shape, 0.0)?;
        }
        Ok(())
    }

    /// The largest half band of a normal and of a lateral force, N.
    pub fn largest(&self) -> [f64; 2] {
        [&self.normal_force_band, &self.lateral_force_band]
            .map(|bands| bands.values().iter().copied().fold(0.0, f64::max))
    }
}

/// The smallest det(I + ∇u) of a map, and where.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmallestDet {
    /// det(I + ∇u).
    pub det: f64,
    /// Depth of the probe, m.
    #[serde(rename = "depth_m")]
    pub depth: f64,
    /// Lateral position of the probe, m.
    #[serde(rename = "lateral_m")]
    pub lateral: f64,
}

impl SmallestDet {
    /// The smallest entry of `min_det` (depths × lateral positions); of equals the one nearest to
    /// x = 0, then the first. `None` if the matrix is empty or holds a NaN.
    pub fn of(min_det: &Matrix, depths: &[f64], laterals: &[f64]) -> Option<SmallestDet> {
        if min_det.values().iter().any(|det| det.is_nan()) {
            return None;
        }
        let poses = min_det.entries().filter_map(|(row, column, det)| {
            let (&depth, &lateral) = (depths.get(row)?, laterals.get(column)?);
            Some(SmallestDet {
                det,
                depth,
                lateral,
            })
        });
        poses.min_by(|a, b| {
            let order = a.det.total_cmp(&b.det);
            order.then(a.lateral.abs().total_cmp(&b.lateral.abs()))
        })
    }
}

impl Certificate {
    /// Whether every number is finite and possible, and the matrices belong to these axes (m).
    ///
    /// Implements: MAP-006, MAP-002.
    pub(super) fn check(&self, depths: &[f64], laterals: &[f64]) -> Result<(), Refusal> {
        for (key, value) in [
            ("worst_relative_residual", self.worst_relative_residual),
            ("worst_force_balance_n", self.worst_force_balance),
            ("largest_penetration_m", self.largest_penetration),
            ("mesh_size_m", self.mesh_size),
        ] {
            check_number(format_args!("certificate.{key}"), value, 0.0)?;
        }
        let shape = [depths.len(), laterals.len()];
        let least = f64::NEG_INFINITY;
        self.min_det.check("certificate.min_det", shape, least)?;
        if let Some(bands) = &self.discretization {
            bands.check(shape)?;
        }
        let stated = self.smallest_det;
        let dets = self.min_det.values().iter().copied();
        let least = dets.fold(f64::INFINITY, f64::min);
        let index = |axis: &[f64], value: f64| {
            let is_there = |position: &f64| (position - value).abs() <= SAME_POSITION;
            axis.iter().position(is_there)
        };
        let pose = index(depths, stated.depth).zip(index(laterals, stated.lateral));
        let there = pose.map(|(row, column)| self.min_det.row(row)[column]);
        if stated.det == least && there == Some(least) {
            return Ok(());
        }
        let (det, depth, lateral) = (stated.det, stated.depth, stated.lateral);
        let found = format!("{det} at depth {depth} m, lateral {lateral} m");
        let expected = format!("the smallest entry of min_det, {least}, and its pose");
        Err(Refusal::value("certificate.smallest_det", found, expected))
    }

    /// This certificate with some of the columns of its matrices, in any order.
    ///
    /// Implements: MAP-052.
    pub(super) fn at_columns(&self, columns: &[usize]) -> Certificate {
        let bands = |bands: &Discretization| Discretization {
            nodes: bands.nodes,
            normal_force_band: bands.normal_force_band.at_columns(columns),
            lateral_force_band: bands.lateral_force_band.at_columns(columns),
        };
        Certificate {
            min_det: self.min_det.at_columns(columns),
            discretization: self.discretization.as_ref().map(bands),
            ..self.clone()
        }
    }
}
