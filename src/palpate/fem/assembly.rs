//! The global stiffness matrix over the free displacements, in elimination order.

use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::traits::pulp::{Arch, NullaryFnOnce};

use super::FemError;
use super::element::StiffnessRule;
use super::mesh::Mesh;
use super::ordering::dissection;
use crate::phantom::{Geometry, Phantom};
use crate::refusal::Refusal;

/// In place of the unknown of a displacement that is held.
pub(super) const HELD: u32 = u32::MAX;

/// Upper triangle of the stiffness matrix, N/m for the whole probe length. Its unknowns are the displacements that no wall or
/// floor holds: those below the surface in the order of elimination, then those at the surface from left to right.
///
/// Implements: FEM-006.
#[derive(Debug, Clone)]
pub struct StiffnessMatrix {
    /// The entries on and above the diagonal.
    pub upper: SparseColMat<u32, f64>,
    /// The unknown of each node's displacements along x and y, or [`HELD`].
    unknown: Vec<[u32; 2]>,
    /// The first unknown at the surface.
    pub first_surface_unknown: usize,
    /// The unknown of each displacement component of each node at the surface, x before y, or `None` if a wall holds it.
    pub surface: Vec<Option<usize>>,
    /// Reaction of floor and walls along x and y per displacement of each unknown: the sum of the
    /// held displacements' rows, N/m.
    pub reaction: [Vec<f64>; 2],
}

impl StiffnessMatrix {
    /// Assembles the stiffness of a meshed phantom.
    ///
    /// # Errors
    /// [`FemError::Refused`] if an element is turned inside out; [`FemError::OutOfMemory`].
    ///
    /// Implements: FEM-080, CON-004.
    pub fn assemble(mesh: &Mesh, phantom: &Phantom) -> Result<StiffnessMatrix, FemError> {
        let mut unknown = vec![[HELD; 2]; mesh.nodes.len()];
        let mut unknowns = 0;
        let mut number = |node: usize| {
            for direction in 0..2 {
                if !mesh.held[node][direction] {
                    unknown[node][direction] = unknowns;
                    unknowns += 1;
                }
            }
            unknowns as usize
        };
        let mut order = dissection(mesh);
        let interior = order.iter().copied().map(&mut number).last();
        order.extend(&mesh.surface);
        let all = mesh.surface.iter().copied().map(number).last();
        let free = |unknown: u32| (unknown != HELD).then_some(unknown as usize);
        let nodes = mesh.surface.iter();
        let pattern = pattern(mesh, &order, &unknown);
        let values = vec![0.0; pattern.row_idx().len()];
        let matrix = StiffnessMatrix {
            surface: nodes.flat_map(|&node| unknown[node].map(free)).collect(),
            upper: SparseColMat::new(pattern, values),
            unknown,
            first_surface_unknown: interior.unwrap_or(0),
            reaction: [0, 1].map(|_| vec![0.0; all.unwrap_or(0)]),
        };
        matrix.filled(mesh, phantom)
    }

    /// The stiffness of another phantom with this mesh.
    ///
    /// # Errors
    /// As [`StiffnessMatrix::assemble`].
    pub(super) fn filled(
        mut self,
        mesh: &Mesh,
        phantom: &Phantom,
    ) -> Result<StiffnessMatrix, FemError> {
        let (pattern, mut values) = self.upper.into_parts();
        let (starts, rows) = (pattern.col_ptr(), pattern.row_idx());
        values.fill(0.0);
        self.reaction.iter_mut().for_each(|of| of.fill(0.0));
        let rule = StiffnessRule::default();
        // From one metre to the probe's length; what is turned has its whole stiffness already.
        let length = match phantom.geometry() {
            Geometry::Plane => phantom.probe().length,
            Geometry::Axisymmetric => 1.0,
        };
        for (index, nodes) in mesh.elements().enumerate() {
            let positions = mesh.positions(nodes);
            let material = mesh.regions[index].material(phantom);
            let stiffness = rule.integrate(&positions, material, phantom.geometry());
            let stiffness = stiffness.map_err(|jacobian| folded(index, positions[0], jacobian))?;
            let row_of = |k: usize| self.unknown[nodes[k / 2] as usize][k % 2];
            for k in 0..2 * nodes.len() {
                let column = row_of(k);
                if column == HELD {
                    continue;
                }
                let start = starts[column as usize] as usize;
                let rows = &rows[start..starts[column as usize + 1] as usize];
                for l in 0..2 * nodes.len() {
                    let value = length * stiffness[(l, k)];
                    match row_of(l) {
                        HELD => self.reaction[l % 2][column as usize] += value,
                        row if row <= column => {
                            values[start + rows.partition_point(|&above| above < row)] += value;
                        }
                        _ => {}
                    }
                }
            }
        }
        self.upper = SparseColMat::new(pattern, values);
        Ok(self)
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.upper.ncols()
    }

    /// The unknown of displacement component `direction` of `node`, or `None` if it is held.
    pub fn unknown(&self, node: usize, direction: usize) -> Option<usize> {
        let unknown = self.unknown[node][direction];
        (unknown != HELD).then_some(unknown as usize)
    }

    /// Subtracts K u from the loads in `force`, N, for `B` × `L` displacement fields at once, one row for each unknown: there are
    /// loads from unknown `loaded` on, and what stands in the rows before it is not read. Returns ‖f − K u‖ / ‖f‖ of each;
    /// absolute, N, where there is no load.
    pub(super) fn residual<const L: usize, const B: usize>(
        &self,
        u: &[[[f64; L]; B]],
        force: &mut [[[f64; L]; B]],
        loaded: usize,
    ) -> [[f64; L]; B] {
        Arch::new().dispatch(Residual {
            matrix: &self.upper,
            u,
            force,
            loaded,
        })
    }
}

/// [`StiffnessMatrix::residual`], for the processor's vectors: a closure would be compiled without them.
struct Residual<'a, const L: usize, const B: usize> {
    matrix: &'a SparseColMat<u32, f64>,
    u: &'a [[[f64; L]; B]],
    force: &'a mut [[[f64; L]; B]],
    loaded: usize,
}

impl<const L: usize, const B: usize> NullaryFnOnce for Residual<'_, L, B> {
    type Output = [[f64; L]; B];

    #[inline(always)]
    fn call(self) -> [[f64; L]; B] {
        let (u, force) = (self.u, self.force);
        let loads = norms(&force[self.loaded..]);
        for j in 0..u.len() {
            let rows = self.matrix.row_idx_of_col(j);
            let entries = rows.zip(self.matrix.val_of_col(j));
            for block in 0..B {
                // Columns before this one have left its row alone.
                let mut left = match j < self.loaded {
                    true => [0.0; L],
                    false => force[j][block],
                };
                let at = u[j][block];
                for (i, &value) in entries.clone() {
                    for lane in 0..L {
                        left[lane] = value.mul_add(-u[i][block][lane], left[lane]);
                    }
                    if i != j {
                        for lane in 0..L {
                            let row = &mut force[i][block][lane];
                            *row = value.mul_add(-at[lane], *row);
                        }
                    }
                }
                force[j][block] = left;
            }
        }
        let mut relative = norms(force);
        for (left, load) in (relative.as_flattened_mut().iter_mut()).zip(loads.as_flattened()) {
            if *load != 0.0 {
                *left /= load;
            }
        }
        relative
    }
}

/// The refusal of an element whose map from its parent is folded near (x, y), m.
fn folded(element: usize, [x, y]: [f64; 2], jacobian: f64) -> Refusal {
    let [x, y] = [x, y].map(|metres| metres * 1e3);
    let found = format!(
        "element {element} near x = {x:.3} mm, y = {y:.3} mm has the Jacobian {jacobian:e}: the mesh cannot follow this phantom; try a finer mesh"
    );
    Refusal::state(found, "")
}

/// The rows on and above the diagonal of each column: unknowns of nodes that share an element, where the nodes are eliminated in
/// this order.
fn pattern(mesh: &Mesh, order: &[usize], unknown: &[[u32; 2]]) -> SymbolicSparseColMat<u32> {
    let mut places = vec![0; mesh.nodes.len()];
    for (place, &node) in order.iter().enumerate() {
        places[node] = place;
    }
    // Nodes have some six elements around them at the most.
    let none = |_| Vec::with_capacity(8);
    let mut around: Vec<Vec<u32>> = (0..mesh.nodes.len()).map(none).collect();
    for (element, nodes) in mesh.elements().enumerate() {
        nodes
            .iter()
            .for_each(|&node| around[node as usize].push(element as u32));
    }
    let is_free = |unknown: &u32| *unknown != HELD;
    let (mut starts, mut rows) = (vec![0], Vec::with_capacity(25 * mesh.nodes.len()));
    let mut before = Vec::new();
    for (place, &node) in order.iter().enumerate() {
        before.clear();
        for &element in &around[node] {
            let nodes = mesh.nodes_of(element).iter();
            let places = nodes.map(|&node| places[node as usize]);
            before.extend(places.filter(|other| *other <= place));
        }
        before.sort_unstable();
        before.dedup();
        for column in unknown[node].into_iter().filter(is_free) {
            let above = before.iter().flat_map(|&place| unknown[order[place]]);
            rows.extend(above.filter(|row| *row <= column));
            starts.push(rows.len() as u32);
        }
    }
    let size = starts.len() - 1;
    SymbolicSparseColMat::new_checked(size, size, starts, None, rows)
}

/// The size of each of `B` × `L` fields.
#[inline(always)]
fn norms<const L: usize, const B: usize>(fields: &[[[f64; L]; B]]) -> [[f64; L]; B] {
    let mut squares = [[0.0; L]; B];
    for row in fields {
        for (squares, values) in squares.iter_mut().zip(row) {
            for lane in 0..L {
                squares[lane] = values[lane].mul_add(values[lane], squares[lane]);
            }
        }
    }
    squares.map(|lanes| lanes.map(libm::sqrt))
}
