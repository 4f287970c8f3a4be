//! What a computed force map says about its own quality.

use serde::{Deserialize, Serialize};

use super::{InvalidForceMap, Matrix, SAME_POSITION};

/// The evidence that comes with a map from finite elements. Plain data; [`super::ForceMap::new`]
/// checks it.
///
/// ```
/// use palpate::force_map::{Certificate, ForceMap, ForceTable, Matrix, SmallestDet, Source};
/// use palpate::phantom::Phantom;
///
/// let matrix = |value| Matrix::from_fn(1, 1, |_, _| value);
/// let certificate = Certificate {
///     worst_relative_residual: 1e-14,
///     worst_force_balance: 1e-12,
///     largest_penetration: 0.0,
///     newton_iterations: 12,
///     mesh_size: 0.00075,
///     nodes: 4000,
///     elements: 2000,
///     element: "t6".into(),
///     contact: "deformed".into(),
///     arithmetic: "other".into(),
///     smallest_det: SmallestDet { det: 0.7, depth: 0.004, lateral: 0.0 },
///     min_det: matrix(0.6),
///     discretization: None,
/// };
/// // The smallest determinant that it names is not that of its matrix.
/// let forces = ForceTable::new(vec![0.004], vec![0.0], matrix(1.5), matrix(0.0))?;
/// let map = ForceMap::new(
///     Source::FiniteElements { certificate },
///     Some(Phantom::builtin("6.6")?),
///     forces,
/// );
/// assert!(map.unwrap_err().to_string().starts_with("certificate.smallest_det = 0.7"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    /// Implements: MAP-050.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretization: Option<Discretization>,
}

/// Bands of the discretisation around the forces of a map, from three meshes.
///
/// ```
/// use palpate::force_map::{Discretization, Matrix};
///
/// let bands = Discretization {
///     nodes: [4000, 1000, 250],
///     normal_force_band: Matrix::from_fn(1, 3, |_, column| [0.001, 0.003, 0.002][column]),
///     lateral_force_band: Matrix::from_fn(1, 3, |_, _| 0.0005),
/// };
/// assert_eq!(bands.largest(), [0.003, 0.0005]);
/// ```
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
    /// The largest half band of a normal and of a lateral force, N.
    pub fn largest(&self) -> [f64; 2] {
        [&self.normal_force_band, &self.lateral_force_band]
            .map(|bands| bands.values().iter().copied().fold(0.0, f64::max))
    }

    /// Implements: MAP-051.
    fn check(&self, expected: [usize; 2]) -> Result<(), InvalidForceMap> {
        for (key, bands) in [
            (
                "certificate.discretization.normal_force_band_n",
                &self.normal_force_band,
            ),
            (
                "certificate.discretization.lateral_force_band_n",
                &self.lateral_force_band,
            ),
        ] {
            check_shape(key, bands, expected)?;
            let wrong = |(_, _, band): &(usize, usize, f64)| !(band.is_finite() && *band >= 0.0);
            if let Some((row, column, value)) = bands.entries().find(wrong) {
                return Err(InvalidForceMap::Band {
                    key,
                    row,
                    column,
                    value,
                });
            }
        }
        Ok(())
    }

    fn map(&self, change: impl Fn(&Matrix) -> Matrix) -> Discretization {
        Discretization {
            nodes: self.nodes,
            normal_force_band: change(&self.normal_force_band),
            lateral_force_band: change(&self.lateral_force_band),
        }
    }
}

fn check_shape(
    key: &'static str,
    matrix: &Matrix,
    expected: [usize; 2],
) -> Result<(), InvalidForceMap> {
    let found = [matrix.row_count(), matrix.column_count()];
    if found == expected {
        Ok(())
    } else {
        Err(InvalidForceMap::Shape {
            key,
            found,
            expected,
        })
    }
}

/// The smallest det(I + ∇u) of a map, and where.
///
/// ```
/// use palpate::force_map::{Matrix, SmallestDet};
///
/// let min_det = Matrix::from_fn(1, 3, |_, column| [0.6, 0.7, 0.6][column]);
/// let smallest = SmallestDet::of(&min_det, &[0.004], &[0.0, 0.002, 0.004]);
/// // Of the two that are equal the one nearest to x = 0.
/// assert_eq!(smallest, Some(SmallestDet { det: 0.6, depth: 0.004, lateral: 0.0 }));
/// ```
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
    /// Whether every number is finite and possible, and `min_det` belongs to these axes (m).
    ///
    /// Implements: MAP-006, MAP-007.
    pub(super) fn check(&self, depths: &[f64], laterals: &[f64]) -> Result<(), InvalidForceMap> {
        not_negative("worst_relative_residual", self.worst_relative_residual)?;
        not_negative("worst_force_balance_n", self.worst_force_balance)?;
        not_negative("largest_penetration_m", self.largest_penetration)?;
        not_negative("mesh_size_m", self.mesh_size)?;
        let key = "certificate.min_det";
        let expected = [depths.len(), laterals.len()];
        check_shape(key, &self.min_det, expected)?;
        if let Some(discretization) = &self.discretization {
            discretization.check(expected)?;
        }
        if let Some((row, column, value)) =
            self.min_det.entries().find(|(_, _, det)| !det.is_finite())
        {
            return Err(InvalidForceMap::Force {
                key,
                row,
                column,
                value,
            });
        }
        self.check_smallest(depths, laterals)
    }

    fn check_smallest(&self, depths: &[f64], laterals: &[f64]) -> Result<(), InvalidForceMap> {
        let stated = self.smallest_det;
        let least = self
            .min_det
            .values()
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let index = |axis: &[f64], value: f64| {
            axis.iter()
                .position(|position| (position - value).abs() <= SAME_POSITION)
        };
        let there = index(depths, stated.depth)
            .zip(index(laterals, stated.lateral))
            .map(|(row, column)| self.min_det.row(row)[column]);
        if stated.det == least && there == Some(least) {
            Ok(())
        } else {
            Err(InvalidForceMap::SmallestDet { stated, least })
        }
    }

    /// This certificate for the map with some of its columns, at lateral positions `laterals` (m).
    ///
    /// Implements: MAP-052.
    pub(super) fn at_columns(
        &self,
        columns: &[usize],
        depths: &[f64],
        laterals: &[f64],
    ) -> Result<Certificate, InvalidForceMap> {
        let min_det = self.min_det.at_columns(columns);
        let Some(smallest_det) = SmallestDet::of(&min_det, depths, laterals) else {
            return Err(InvalidForceMap::EmptyAxis { key: "laterals_m" });
        };
        Ok(Certificate {
            min_det,
            smallest_det,
            discretization: (self.discretization.as_ref())
                .map(|bands| bands.map(|matrix| matrix.at_columns(columns))),
            ..self.clone()
        })
    }

    /// This certificate for the map that symmetry extends to x < 0.
    ///
    /// Implements: MAP-052.
    pub(super) fn mirrored(&self) -> Certificate {
        Certificate {
            min_det: self.min_det.mirrored(|det| det, |det| det),
            discretization: (self.discretization.as_ref())
                .map(|bands| bands.map(|matrix| matrix.mirrored(|band| band, |band| band))),
            ..self.clone()
        }
    }
}

fn not_negative(key: &'static str, value: f64) -> Result<(), InvalidForceMap> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(InvalidForceMap::Certificate { key, value })
    }
}
