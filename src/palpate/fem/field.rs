//! What the gel does below the surface: displacement fields, and the checks on them.

use faer::traits::pulp::{Arch, NullaryFnOnce};

use super::FemError;
use super::assembly::StiffnessMatrix;
use super::cholesky::Factor;
use super::element::{NODES, PerNode, SAMPLES, gradients, parent_gradients, revolved};
use super::mesh::Mesh;
use super::size::SizeField;
use crate::phantom::Geometry;

/// How many poses are checked at once: the factor is read from memory once for all of them.
pub(super) const BATCH: usize = BLOCKS * LANES;
/// Their fields stand in blocks of so many lanes, which one or two registers of the processor hold.
const BLOCKS: usize = 3;
const LANES: usize = 8;

/// Checks on the displacement field of one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldCheck {
    /// ‖f − K u‖ / ‖f‖ over all unknowns; absolute, N, where there is no load.
    pub residual: f64,
    /// Surface force plus reaction of floor and walls, the larger component's magnitude, N.
    pub imbalance: f64,
    /// Smallest det(I + ∇u) over the elements that are not near to a sharp corner (in the paper's gel within 1 mm): 1 undeformed, 0 where
    /// the small-strain model has squeezed the gel to nothing.
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
    // A phantom that is all corner is judged as a whole.
    if samples.iter().all(|sample| sample.singular) {
        samples
            .iter_mut()
            .for_each(|sample| sample.singular = false);
    }
    samples
}

impl SamplingPoint {
    /// ∂u_i/∂x_j of `L` fields beside each other; `u` gives them at an unknown, and zeros behind the last one.
    #[inline(always)]
    pub(super) fn gradient<'a, const L: usize>(
        &self,
        u: impl Fn(usize) -> &'a [f64; L],
    ) -> [[[f64; L]; 2]; 2] {
        let mut gradient = [[[0.0; L]; 2]; 2];
        for (row, shape) in self.rows.iter().zip(self.shape.column_iter()) {
            for i in 0..2 {
                let u = u(row[i] as usize);
                for j in 0..2 {
                    for lane in 0..L {
                        gradient[i][j][lane] = shape[j].mul_add(u[lane], gradient[i][j][lane]);
                    }
                }
            }
        }
        gradient
    }

    /// The stretch of the circle on which the point is turned, in `L` fields; 1 in plane strain.
    #[inline(always)]
    fn circle<'a, const L: usize>(&self, u: impl Fn(usize) -> &'a [f64; L]) -> [f64; L] {
        let mut stretch = [0.0; L];
        for (of, row) in self.hoop.iter().flatten().zip(&self.rows) {
            let u = u(row[0] as usize);
            for lane in 0..L {
                stretch[lane] += of * u[lane];
            }
        }
        stretch.map(|stretch| 1.0 + stretch)
    }
}

/// det(I + ∇u) in the cross-section.
#[inline(always)]
pub(super) fn determinant(gradient: [[f64; 2]; 2]) -> f64 {
    (1.0 + gradient[0][0]) * (1.0 + gradient[1][1]) - gradient[0][1] * gradient[1][0]
}

/// A vector at each node of the surface.
type AtSurface = Vec<[f64; 2]>;

/// A number for each of [`BATCH`] fields.
type Row = [[f64; LANES]; BLOCKS];

/// What checks the fields of a model, with its memory.
pub(super) struct Checker<'a> {
    matrix: &'a StiffnessMatrix,
    factor: &'a Factor,
    samples: &'a [SamplingPoint],
    /// One more row than unknowns: the zeros of what is held.
    displacements: Vec<Row>,
    forces: Vec<Row>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(
        matrix: &'a StiffnessMatrix,
        factor: &'a Factor,
        samples: &'a [SamplingPoint],
    ) -> Checker<'a> {
        let row = [[0.0; LANES]; BLOCKS];
        Checker {
            matrix,
            factor,
            samples,
            displacements: vec![row; matrix.unknowns() + 1],
            forces: vec![row; matrix.unknowns()],
        }
    }

    /// Fills in and checks the fields of up to [`BATCH`] poses, given by displacements and loads of the nodes at the surface; below
    /// it no pose has a load.
    ///
    /// Implements: FEM-008, FEM-013.
    pub(super) fn check(
        &mut self,
        poses: &[(AtSurface, AtSurface)],
    ) -> Result<Vec<FieldCheck>, FemError> {
        let (matrix, unknowns) = (self.matrix, self.matrix.unknowns());
        let loaded = matrix.first_surface_unknown;
        self.forces[loaded..].fill([[0.0; LANES]; BLOCKS]);
        for (w, (u, force)) in poses.iter().enumerate() {
            let (block, lane) = (w / LANES, w % LANES);
            let components = u.as_flattened().iter().zip(force.as_flattened());
            for (place, (u, force)) in matrix.surface.iter().zip(components) {
                if let Some(unknown) = *place {
                    self.displacements[unknown][block][lane] = *u;
                    self.forces[unknown][block][lane] = *force;
                }
            }
        }
        let (u, _) = self.displacements.split_at_mut(unknowns);
        self.factor.extend_to_interior(u)?;
        let balance = [0, 1].map(|direction| balance(matrix, direction, u, &self.forces));
        let residual = matrix.residual(u, &mut self.forces, loaded);
        let min_det = Arch::new().dispatch(Smallest {
            samples: self.samples,
            displacements: &self.displacements,
        });
        let check = |w: usize| {
            let of = |row: &Row| row[w / LANES][w % LANES];
            FieldCheck {
                residual: of(&residual),
                imbalance: of(&balance[0]).abs().max(of(&balance[1]).abs()),
                min_det: of(&min_det),
            }
        };
        Ok((0..poses.len()).map(check).collect())
    }
}

/// The sum along `direction`, N, of the loads of each field and of what the held nodes bear at the displacements `u`.
fn balance(matrix: &StiffnessMatrix, direction: usize, u: &[Row], loads: &[Row]) -> Row {
    let mut balance = [[0.0; LANES]; BLOCKS];
    let mut add = |scale: f64, row: &Row| {
        for (sum, value) in (balance.as_flattened_mut().iter_mut()).zip(row.as_flattened()) {
            *sum += scale * value;
        }
    };
    let held = u.iter().zip(&matrix.reaction[direction]);
    for (u, &reaction) in held.filter(|(_, reaction)| **reaction != 0.0) {
        add(reaction, u);
    }
    for unknown in matrix.surface.iter().skip(direction).step_by(2).flatten() {
        add(1.0, &loads[*unknown]);
    }
    balance
}

/// The smallest det(I + ∇u) of each field, away from sharp corners.
struct Smallest<'a> {
    samples: &'a [SamplingPoint],
    displacements: &'a [Row],
}

impl NullaryFnOnce for Smallest<'_> {
    type Output = Row;

    #[inline(always)]
    fn call(self) -> Row {
        let mut smallest = [[f64::INFINITY; LANES]; BLOCKS];
        for sample in self.samples.iter().filter(|sample| !sample.singular) {
            for (block, smallest) in smallest.iter_mut().enumerate() {
                let u = |row: usize| &self.displacements[row][block];
                let [[xx, xy], [yx, yy]] = sample.gradient(u);
                let circle = sample.circle(u);
                for lane in 0..LANES {
                    let gradient = [[xx[lane], xy[lane]], [yx[lane], yy[lane]]];
                    let det = determinant(gradient) * circle[lane];
                    smallest[lane] = if det < smallest[lane] {
                        det
                    } else {
                        smallest[lane]
                    };
                }
            }
        }
        smallest
    }
}
