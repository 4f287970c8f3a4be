//! What the gel does below the surface: displacement fields, and the checks on them.

use super::FemError;
use super::assembly::StiffnessMatrix;
use super::cholesky::Factor;
use super::element::{NODES, PerNode, SAMPLES, gradients, parent_gradients, revolved};
use super::mesh::Mesh;
use super::size::SizeField;
use crate::phantom::Geometry;

/// How many poses are checked at once: the factor is read from memory once for all of them.
pub(super) const BATCH: usize = 24;

/// Checks on the displacement field of one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldCheck {
    /// ‖f − K u‖ / ‖f‖ over all unknowns; absolute, N, where there is no load.
    pub residual: f64,
    /// Surface force plus reaction of floor and walls, the larger component's magnitude, N.
    pub imbalance: f64,
    /// Smallest det(I + ∇u) over the sampling points that are 1 mm and more from sharp corners: 1 undeformed, 0 where the small-strain model
    /// has squeezed the gel to nothing.
    pub min_det: f64,
}

/// Displacements and their gradients in the whole phantom.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Displacement of each node, m.
    pub displacements: Vec<[f64; 2]>,
    /// `[i][j]` = ∂u_i/∂x_j at each sampling point of each element.
    pub gradients: Vec<Vec<[[f64; 2]; 2]>>,
}

/// The shape functions' gradients at one sampling point of an element, with the unknowns of its nodes' two displacement
/// components: for one that is held, the row of zeros behind the last unknown.
#[derive(Debug, Clone)]
pub(super) struct SamplingPoint {
    shape: PerNode,
    /// N_a/x, 1/m, where the point is turned about the axis.
    hoop: Option<[f64; NODES]>,
    rows: [[u32; 2]; NODES],
    /// Whether it is too near to a sharp corner for its strain to mean anything.
    singular: bool,
}

/// The sampling points of all elements in turn.
pub(super) fn samples(
    mesh: &Mesh,
    matrix: &StiffnessMatrix,
    size: &SizeField,
    geometry: Geometry,
) -> Vec<SamplingPoint> {
    let zeros = matrix.unknowns();
    let mut samples = Vec::with_capacity(mesh.regions.len() * SAMPLES.len());
    for nodes in mesh.elements() {
        let positions = mesh.positions(nodes);
        let mut rows = [[zeros as u32; 2]; NODES];
        for (row, &node) in rows.iter_mut().zip(nodes) {
            let unknown = |direction| matrix.unknown(node as usize, direction).unwrap_or(zeros);
            *row = [unknown(0) as u32, unknown(1) as u32];
        }
        samples.extend(SAMPLES.map(|at| SamplingPoint {
            shape: gradients(&parent_gradients(at), &positions).of_node,
            hoop: (geometry == Geometry::Axisymmetric).then(|| revolved(at, &positions).1),
            rows,
            singular: size.singular(positions[0].into()),
        }));
    }
    samples
}

impl SamplingPoint {
    /// ∂u_i/∂x_j of `W` fields, given by their unknowns and a row of zeros.
    pub(super) fn gradient<const W: usize>(&self, u: &[[f64; W]]) -> [[[f64; W]; 2]; 2] {
        let mut gradient = [[[0.0; W]; 2]; 2];
        for (row, shape) in self.rows.iter().zip(self.shape.column_iter()) {
            for i in 0..2 {
                let u = &u[row[i] as usize];
                for j in 0..2 {
                    for w in 0..W {
                        gradient[i][j][w] += shape[j] * u[w];
                    }
                }
            }
        }
        gradient
    }

    /// The stretch of the circle on which the point is turned, in field `w`; 1 in plane strain.
    fn circle<const W: usize>(&self, u: &[[f64; W]], w: usize) -> f64 {
        let hoop = self.hoop.iter().flatten().zip(&self.rows);
        1.0 + hoop
            .map(|(of, row)| of * u[row[0] as usize][w])
            .sum::<f64>()
    }
}

/// det(I + ∇u) in the cross-section.
pub(super) fn determinant(gradient: [[f64; 2]; 2]) -> f64 {
    (1.0 + gradient[0][0]) * (1.0 + gradient[1][1]) - gradient[0][1] * gradient[1][0]
}

/// A vector at each node of the surface.
type AtSurface = Vec<[f64; 2]>;

/// Fills in and checks the fields of up to [`BATCH`] poses, given by displacements and loads of the nodes at the surface; below
/// it no pose has a load.
///
/// Implements: FEM-008, FEM-013.
pub(super) fn check(
    matrix: &StiffnessMatrix,
    factor: &Factor,
    samples: &[SamplingPoint],
    poses: &[(AtSurface, AtSurface)],
) -> Result<Vec<FieldCheck>, FemError> {
    let unknowns = matrix.unknowns();
    // One more row than unknowns: the zeros of what is held.
    let mut displacements = vec![[0.0; BATCH]; unknowns + 1];
    let mut forces = vec![[0.0; BATCH]; unknowns];
    for (w, (u, force)) in poses.iter().enumerate() {
        let components = u.as_flattened().iter().zip(force.as_flattened());
        for (place, (u, force)) in matrix.surface.iter().zip(components) {
            if let Some(unknown) = *place {
                displacements[unknown][w] = *u;
                forces[unknown][w] = *force;
            }
        }
    }
    factor.extend_to_interior(&mut displacements[..unknowns])?;
    let u = &displacements[..unknowns];
    let (_, residual) = matrix.residual(u, &forces);
    let mut balance = [[0.0; BATCH]; 2];
    for direction in 0..2 {
        for (u, reaction) in u.iter().zip(&matrix.reaction[direction]) {
            for w in 0..BATCH {
                balance[direction][w] += reaction * u[w];
            }
        }
        for unknown in matrix.surface.iter().skip(direction).step_by(2).flatten() {
            for w in 0..BATCH {
                balance[direction][w] += forces[*unknown][w];
            }
        }
    }
    let mut min_det = [f64::INFINITY; BATCH];
    for sample in samples.iter().filter(|sample| !sample.singular) {
        let [[xx, xy], [yx, yy]] = sample.gradient(&displacements);
        for w in 0..BATCH {
            let det =
                determinant([[xx[w], xy[w]], [yx[w], yy[w]]]) * sample.circle(&displacements, w);
            min_det[w] = if det < min_det[w] { det } else { min_det[w] };
        }
    }
    let check = |w: usize| FieldCheck {
        residual: residual[w],
        imbalance: balance[0][w].abs().max(balance[1][w].abs()),
        min_det: min_det[w],
    };
    Ok((0..poses.len()).map(check).collect())
}
