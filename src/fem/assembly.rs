//! The global stiffness matrix over the free displacements, in elimination order.

use super::FemError;
use super::element::{Stiffness, StiffnessRule};
use super::mesh::{Mesh, Region};
use super::ordering::{Dissection, Piece};
use crate::phantom::{Material, Phantom};

/// Place of a node that is bonded to the floor or a wall.
const FIXED: u32 = u32::MAX;

/// Where each node's displacements stand among the unknowns: the interior right of the axis, in the order
/// of its nested dissection; its mirror image in the same order; the axis, from the floor up; and the
/// nodes of the outer surface last, from left to right.
///
/// ```
#[doc = include_str!("coarse.example")]
/// let numbering = &model.matrix().numbering;
/// let free = model.mesh().free().iter().filter(|free| **free).count();
/// assert_eq!(numbering.unknowns(), 2 * free);
/// assert_eq!(numbering.unknown(0, 1), None); // a corner of the floor
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: FEM-006.
#[derive(Debug, Clone)]
pub struct Numbering {
    /// Place of each node, or [`FIXED`].
    place: Vec<u32>,
    /// Pieces of the right interior that are eliminated together; places as in the right half.
    pub(super) pieces: Vec<Piece>,
    /// Number of free interior nodes right of the axis.
    pub(super) right: usize,
    /// Number of free interior nodes on the axis.
    pub(super) axis: usize,
    /// Number of free nodes on the surface, of which the middle one lies on the axis.
    surface: usize,
}

impl Numbering {
    fn new(mesh: &Mesh) -> Numbering {
        let Dissection { order, pieces } = Dissection::new(mesh);
        let right = order.len();
        let mut place = vec![FIXED; mesh.nodes.len()];
        for (k, &node) in order.iter().enumerate() {
            place[node] = k as u32;
        }
        let interior = &mesh.rows[1..mesh.rows.len() - 1];
        for (k, row) in interior.iter().enumerate() {
            let nodes = row.start + 1..row.end - 1;
            let mirrored = nodes.clone().rev();
            for (node, image) in nodes.zip(mirrored).take((row.len() - 3) / 2) {
                place[node] = place[image] + right as u32;
            }
            place[row.start + (row.len() - 1) / 2] = (2 * right + k) as u32;
        }
        let axis = interior.len();
        for (k, node) in mesh.surface().enumerate() {
            place[node] = (2 * right + axis + k) as u32;
        }
        Numbering {
            place,
            pieces,
            right,
            axis,
            surface: mesh.surface().len(),
        }
    }

    /// The unknown of displacement component `direction` of `node`, or `None` if the node is fixed.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let numbering = &model.matrix().numbering;
    /// let last = model.mesh().surface().end - 1;
    /// // The surface comes last, from left to right, x before y.
    /// assert_eq!(numbering.unknown(last, 0), Some(numbering.unknowns() - 2));
    /// assert_eq!(numbering.unknown(last, 1), Some(numbering.unknowns() - 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unknown(&self, node: usize, direction: usize) -> Option<usize> {
        match self.place[node] {
            FIXED => None,
            place => Some(2 * place as usize + direction),
        }
    }

    /// Number of unknowns.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let matrix = model.matrix();
    /// assert_eq!(matrix.numbering.unknowns() + 1, matrix.column_starts.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unknowns(&self) -> usize {
        2 * (2 * self.right + self.axis + self.surface)
    }

    /// The first unknown on the surface; the two of surface node k are `first + 2k` and `first + 2k + 1`.
    pub(super) fn first_surface_unknown(&self) -> usize {
        2 * (2 * self.right + self.axis)
    }

    /// Free nodes of the right half, axis included: those right of the axis in their order, the axis, the
    /// surface from the axis to the wall.
    pub(super) fn half_nodes(&self) -> usize {
        self.right + self.axis + self.surface.div_ceil(2)
    }

    /// Places of node `half` of the right half and of its mirror image; the same on the axis.
    pub(super) fn pair(&self, half: usize) -> [usize; 2] {
        let below = self.right + self.axis;
        if half < self.right {
            [half, self.right + half]
        } else if half < below {
            [self.right + half; 2]
        } else {
            let middle = self.right + below + self.surface / 2;
            [middle + (half - below), middle - (half - below)]
        }
    }

    /// The node of the right half at a place, or `None` left of the axis.
    pub(super) fn half_at(&self, place: usize) -> Option<usize> {
        let (below, first) = (self.right + self.axis, 2 * self.right + self.axis);
        if place < self.right {
            Some(place)
        } else if place < first {
            (place >= 2 * self.right).then(|| place - self.right)
        } else {
            (place - first)
                .checked_sub(self.surface / 2)
                .map(|k| below + k)
        }
    }
}

/// Upper triangle of the stiffness matrix, compressed by columns, N/m for the whole probe length.
///
/// ```
/// use palpate::fem::assembly::StiffnessMatrix;
/// use palpate::fem::{Mesh, MeshOptions};
/// use palpate::phantom::Phantom;
///
/// let phantom = Phantom::builtin("6.6")?;
/// let mesh = Mesh::new(&phantom, &MeshOptions { size: 2e-3, ..MeshOptions::default() })?;
/// let matrix = StiffnessMatrix::assemble(&mesh, &phantom)?;
/// for unknown in 0..matrix.numbering.unknowns() {
///     let (rows, values) = matrix.column(unknown);
///     assert_eq!(rows.last(), Some(&(unknown as u32)));
///     assert!(values[values.len() - 1] > 0.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct StiffnessMatrix {
    /// Where the displacements stand.
    pub numbering: Numbering,
    /// Start of each column in `row_indices` and `values`; one more than there are columns.
    pub column_starts: Vec<u32>,
    /// Row of each entry, ascending in a column, the diagonal last.
    pub row_indices: Vec<u32>,
    /// The entries.
    pub values: Vec<f64>,
    /// Reaction of floor and walls along x and y per displacement of each unknown: the sum of the
    /// fixed nodes' rows, N/m.
    pub reaction: [Vec<f64>; 2],
}

/// Nodes that share an element with each node, itself included, ascending.
fn neighbours(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); mesh.nodes.len()];
    for nodes in mesh.elements() {
        for &a in nodes {
            neighbours[a as usize].extend_from_slice(nodes);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}

/// Material of a region.
///
/// ```
/// use palpate::fem::assembly::material_of;
/// use palpate::fem::mesh::Region;
/// use palpate::phantom::Phantom;
///
/// let [with, without] = [Phantom::builtin("6.6")?, Phantom::builtin("none")?];
/// assert_eq!(material_of(&with, Region::Disc).youngs_modulus, 1.2e6);
/// assert_eq!(material_of(&without, Region::Disc), without.gel.material);
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
pub fn material_of(phantom: &Phantom, region: Region) -> Material {
    match (region, &phantom.inclusion) {
        (Region::Skin, _) => phantom.skin.material,
        (Region::Disc, Some(inclusion)) => inclusion.material,
        (Region::Disc, None) | (Region::Gel, _) => phantom.gel.material,
    }
}

impl StiffnessMatrix {
    /// Assembles the stiffness of a meshed phantom.
    ///
    /// ```
    /// use palpate::fem::assembly::StiffnessMatrix;
    /// use palpate::fem::{FemError, Mesh, MeshOptions};
    /// use palpate::phantom::Phantom;
    ///
    /// let phantom = Phantom::builtin("6.6")?;
    /// let mut mesh = Mesh::new(&phantom, &MeshOptions { size: 2e-3, ..MeshOptions::default() })?;
    /// assert!(StiffnessMatrix::assemble(&mesh, &phantom).is_ok());
    /// mesh.nodes[0][0] -= 1e-6;
    /// let refused = StiffnessMatrix::assemble(&mesh, &phantom);
    /// assert!(matches!(refused, Err(FemError::Asymmetric { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::Asymmetric`] if the mesh is not its own mirror image, which the numbering and the factor rely
    /// on; [`FemError::Degenerate`] if an element is turned inside out.
    ///
    /// Implements: FEM-081, CON-005.
    pub fn assemble(mesh: &Mesh, phantom: &Phantom) -> Result<StiffnessMatrix, FemError> {
        if let Some(element) = mesh.without_mirror_image() {
            let first = mesh.connectivity[element * mesh.element.nodes()];
            return Err(FemError::Asymmetric {
                element,
                at: mesh.nodes[first as usize],
            });
        }
        let neighbours = neighbours(mesh);
        let numbering = Numbering::new(mesh);
        let mut matrix = StiffnessMatrix::pattern(numbering, &neighbours);
        let rule = StiffnessRule::new(mesh.element);
        for (index, nodes) in mesh.elements().enumerate() {
            let positions = mesh.positions(nodes);
            let material = material_of(phantom, mesh.regions[index]);
            let stiffness =
                rule.integrate(&positions, &material)
                    .map_err(|jacobian| FemError::Degenerate {
                        element: index,
                        at: positions[0],
                        jacobian,
                    })?;
            matrix.add(nodes, &stiffness, phantom.probe.length);
        }
        Ok(matrix)
    }

    /// An empty matrix with an entry wherever two free nodes share an element.
    fn pattern(numbering: Numbering, neighbours: &[Vec<u32>]) -> StiffnessMatrix {
        let nodes = numbering.unknowns() / 2;
        let mut node_at = vec![0usize; nodes];
        for (node, &place) in numbering.place.iter().enumerate() {
            if place != FIXED {
                node_at[place as usize] = node;
            }
        }
        let (mut column_starts, mut row_indices) = (vec![0u32], Vec::new());
        let mut places = Vec::new();
        for (k, &node) in node_at.iter().enumerate() {
            places.clear();
            places.extend(
                neighbours[node]
                    .iter()
                    .map(|&n| numbering.place[n as usize])
                    .filter(|&p| p < k as u32),
            );
            places.sort_unstable();
            let diagonal = 2 * k as u32;
            for last in [diagonal, diagonal + 1] {
                row_indices.extend(places.iter().flat_map(|&p| [2 * p, 2 * p + 1]));
                row_indices.extend(diagonal..=last);
                column_starts.push(row_indices.len() as u32);
            }
        }
        let values = vec![0.0; row_indices.len()];
        let reaction = [vec![0.0; 2 * nodes], vec![0.0; 2 * nodes]];
        StiffnessMatrix {
            numbering,
            column_starts,
            row_indices,
            values,
            reaction,
        }
    }

    /// Adds one element's stiffness, scaled from one metre to the probe's length.
    fn add(&mut self, nodes: &[u32], stiffness: &Stiffness, length: f64) {
        let unknown = |k: usize| self.numbering.unknown(nodes[k / 2] as usize, k % 2);
        for column in 0..2 * nodes.len() {
            let Some(j) = unknown(column) else { continue };
            for (row, entries) in stiffness.iter().enumerate().take(2 * nodes.len()) {
                let value = length * entries[column];
                match unknown(row) {
                    None => self.reaction[row % 2][j] += value,
                    Some(i) if i <= j => {
                        let (start, end) = (
                            self.column_starts[j] as usize,
                            self.column_starts[j + 1] as usize,
                        );
                        // The pattern was made from the same elements: the entry is there.
                        if let Ok(at) = self.row_indices[start..end].binary_search(&(i as u32)) {
                            self.values[start + at] += value;
                        }
                    }
                    Some(_) => {}
                }
            }
        }
    }

    /// Entries of column `j`: rows and values, the diagonal last.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let (rows, values) = model.matrix().column(40);
    /// assert!(rows.is_sorted() && rows.last() == Some(&40) && rows.len() == values.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn column(&self, j: usize) -> (&[u32], &[f64]) {
        let range = self.column_starts[j] as usize..self.column_starts[j + 1] as usize;
        (&self.row_indices[range.clone()], &self.values[range])
    }

    /// `out −= K x` for `W` vectors at once, one row of `W` numbers per unknown.
    pub(super) fn subtract_product<const W: usize>(&self, x: &[[f64; W]], out: &mut [[f64; W]]) {
        for j in 0..x.len() {
            let (rows, values) = self.column(j);
            let last = rows.len() - 1;
            let mut sum = x[j].map(|x| values[last] * x);
            for (&i, &value) in rows[..last].iter().zip(values) {
                for w in 0..W {
                    sum[w] += value * x[i as usize][w];
                    out[i as usize][w] -= value * x[j][w];
                }
            }
            for w in 0..W {
                out[j][w] -= sum[w];
            }
        }
    }
}
