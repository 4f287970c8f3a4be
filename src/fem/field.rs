//! What the gel does below the surface: displacement fields, and the checks on them.

use super::assembly::StiffnessMatrix;
use super::cholesky::Factor;
use super::element::{MOST_NODES, gradients, parent_gradients, sampling_rule};
use super::mesh::Mesh;

/// How many poses are checked at once: the factor is read from memory once for all of them.
pub(super) const BATCH: usize = 8;

/// Loads on the surface and displacements of it for up to [`BATCH`] poses, one column each.
#[derive(Debug, Clone)]
pub(super) struct Batch {
    displacements: Vec<[f64; BATCH]>,
    forces: Vec<[f64; BATCH]>,
}

/// Checks on the displacement field of one pose.
///
/// ```
#[doc = include_str!("coarse.example")]
/// use palpate::fem::FieldCheck;
///
/// let beside = model.solve(Pose { depth: 0.0, lateral: 0.0 })?;
/// let [touching, untouched] = model.checks(&[model.solve(pose)?, beside])[..] else { unreachable!() };
/// assert!(touching.residual < 1e-8 && touching.imbalance < 1e-8);
/// assert!(touching.min_det > 0.0 && touching.min_det < 1.0);
/// assert_eq!(untouched, FieldCheck::UNTOUCHED);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldCheck {
    /// ‖f − K u‖ / ‖f‖ over all unknowns; absolute, N, where there is no load.
    pub residual: f64,
    /// Surface force plus reaction of floor and walls, the larger component's magnitude, N.
    pub imbalance: f64,
    /// Smallest det(I + ∇u) over the sampling points: 1 undeformed, 0 where the small-strain model
    /// has squeezed the gel to nothing.
    pub min_det: f64,
}

impl FieldCheck {
    /// Of a phantom without load.
    pub const UNTOUCHED: FieldCheck = FieldCheck {
        residual: 0.0,
        imbalance: 0.0,
        min_det: 1.0,
    };
}

/// Displacements and their gradients in the whole phantom.
///
/// ```
#[doc = include_str!("coarse.example")]
/// use palpate::fem::Field;
///
/// let Field { displacements, gradients } = model.field(&model.solve(pose)?)?;
/// assert_eq!((displacements.len(), gradients.len()), (model.mesh().nodes.len(), model.mesh().regions.len()));
/// // Three points of each triangle; nothing moves on the floor.
/// assert!(gradients[0].len() == 3 && displacements[0] == [0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Displacement of each node, m.
    pub displacements: Vec<[f64; 2]>,
    /// `[i][j]` = ∂u_i/∂x_j at each sampling point of each element.
    pub gradients: Vec<Vec<[[f64; 2]; 2]>>,
}

/// Shape-function gradients at the sampling points of every element.
#[derive(Debug, Clone)]
pub(super) struct Samples {
    points: Vec<[[f64; 2]; MOST_NODES]>,
    points_per_element: usize,
    /// Rows of the two displacement components of each node of each element; fixed nodes point to the
    /// row behind the last unknown, which holds zeros.
    rows: Vec<[u32; 2]>,
    nodes_per_element: usize,
}

impl Samples {
    /// Precomputes the gradients.
    pub(super) fn new(mesh: &Mesh, matrix: &StiffnessMatrix) -> Samples {
        let rule = sampling_rule(mesh.element);
        let parents: Vec<_> = rule
            .iter()
            .map(|p| parent_gradients(mesh.element, p.at))
            .collect();
        let zeros = matrix.numbering.unknowns();
        let (mut points, mut rows) = (Vec::new(), Vec::new());
        for nodes in mesh.elements() {
            let positions = mesh.positions(nodes);
            points.extend(
                parents
                    .iter()
                    .map(|parent| gradients(parent, &positions).of_node),
            );
            rows.extend(nodes.iter().map(|&n| {
                [0, 1].map(|direction| {
                    matrix
                        .numbering
                        .unknown(n as usize, direction)
                        .unwrap_or(zeros) as u32
                })
            }));
        }
        let nodes_per_element = mesh.element.nodes();
        Samples {
            points,
            points_per_element: rule.len(),
            rows,
            nodes_per_element,
        }
    }

    /// ∂u_i/∂x_j at every sampling point, element by element, handed to `visit` with the point's number.
    fn visit<const W: usize>(
        &self,
        u: &[[f64; W]],
        mut visit: impl FnMut(usize, [[[f64; W]; 2]; 2]),
    ) {
        let elements = self.rows.chunks_exact(self.nodes_per_element);
        for (element, (rows, points)) in elements
            .zip(self.points.chunks_exact(self.points_per_element))
            .enumerate()
        {
            for (point, of_node) in points.iter().enumerate() {
                let mut gradient = [[[0.0; W]; 2]; 2];
                for (row, shape) in rows.iter().zip(of_node) {
                    for i in 0..2 {
                        let u = &u[row[i] as usize];
                        for j in 0..2 {
                            for w in 0..W {
                                gradient[i][j][w] += shape[j] * u[w];
                            }
                        }
                    }
                }
                visit(element * self.points_per_element + point, gradient);
            }
        }
    }

    /// Gradients of one field, given by its unknowns, m, at the sampling points of each element.
    pub(super) fn gradients(&self, unknowns: &[f64]) -> Vec<Vec<[[f64; 2]; 2]>> {
        // The row of zeros behind the unknowns stands for the fixed nodes.
        let u: Vec<[f64; 1]> = unknowns.iter().map(|&u| [u]).chain([[0.0]]).collect();
        let mut elements = vec![Vec::new(); self.points.len() / self.points_per_element];
        self.visit(&u, |point, g| {
            elements[point / self.points_per_element].push(g.map(|row| row.map(|[x]| x)));
        });
        elements
    }
}

/// det(I + ∇u).
pub(super) fn determinant(gradient: [[f64; 2]; 2]) -> f64 {
    (1.0 + gradient[0][0]) * (1.0 + gradient[1][1]) - gradient[0][1] * gradient[1][0]
}

impl Batch {
    /// An empty batch for a matrix of `unknowns` rows.
    pub(super) fn new(unknowns: usize) -> Batch {
        // One more row than unknowns: the zeros of the fixed nodes.
        Batch {
            displacements: vec![[0.0; BATCH]; unknowns + 1],
            forces: vec![[0.0; BATCH]; unknowns],
        }
    }

    /// Puts the surface displacements and loads of a pose into `column`; `first` is the first unknown on the
    /// surface, and below it no pose has a load.
    pub(super) fn set(
        &mut self,
        column: usize,
        first: usize,
        displacements: &[[f64; 2]],
        forces: &[(usize, [f64; 2])],
    ) {
        for row in &mut self.forces[first..] {
            row[column] = 0.0;
        }
        for (node, u) in displacements.iter().enumerate() {
            for direction in 0..2 {
                self.displacements[first + 2 * node + direction][column] = u[direction];
            }
        }
        for &(node, force) in forces {
            for direction in 0..2 {
                self.forces[first + 2 * node + direction][column] = force[direction];
            }
        }
    }

    /// Fills in the fields and checks each column.
    ///
    /// Implements: FEM-008, FEM-013.
    pub(super) fn check(
        &mut self,
        matrix: &StiffnessMatrix,
        factor: &Factor,
        samples: &Samples,
    ) -> [FieldCheck; BATCH] {
        let unknowns = self.forces.len();
        factor.extend_to_interior(&mut self.displacements[..unknowns]);
        let u = &self.displacements[..unknowns];
        let mut residual = self.forces.clone();
        matrix.subtract_product(u, &mut residual);
        let norms = |v: &[[f64; BATCH]]| {
            let mut squares = [0.0; BATCH];
            for row in v {
                for w in 0..BATCH {
                    squares[w] += row[w] * row[w];
                }
            }
            squares.map(libm::sqrt)
        };
        let (left, loads) = (norms(&residual), norms(&self.forces));
        let mut balance = [[0.0; BATCH]; 2];
        for direction in 0..2 {
            for (row, (u, reaction)) in u.iter().zip(&matrix.reaction[direction]).enumerate() {
                for w in 0..BATCH {
                    let load = if row % 2 == direction {
                        self.forces[row][w]
                    } else {
                        0.0
                    };
                    balance[direction][w] += load + reaction * u[w];
                }
            }
        }
        let mut min_det = [f64::INFINITY; BATCH];
        samples.visit(&self.displacements, |_, g| {
            for w in 0..BATCH {
                let det = determinant([[g[0][0][w], g[0][1][w]], [g[1][0][w], g[1][1][w]]]);
                min_det[w] = if det < min_det[w] { det } else { min_det[w] };
            }
        });
        core::array::from_fn(|w| FieldCheck {
            residual: if loads[w] == 0.0 {
                left[w]
            } else {
                left[w] / loads[w]
            },
            imbalance: balance[0][w].abs().max(balance[1][w].abs()),
            min_det: min_det[w],
        })
    }
}
