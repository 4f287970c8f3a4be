//! The mesh: mirror-symmetric in x, fine along the surface and at the walls, with the disc's edge
//! curved. One lattice serves every phantom; without inclusion its disc is filled with gel.

use core::ops::Range;

use super::outline::{Cells, Outline, QUARTERS, half_way};
use super::{FemError, MeshOptions};
use crate::phantom::Phantom;

/// Which material an element is made of.
///
/// ```
/// use palpate::fem::mesh::Region;
/// use palpate::fem::{Mesh, MeshOptions};
/// use palpate::phantom::Phantom;
///
/// // The disc has its place in every mesh, also where it is filled with gel.
/// let options = MeshOptions { size: 2e-3, ..MeshOptions::default() };
/// let mesh = Mesh::new(&Phantom::builtin("none")?, &options)?;
/// assert!(mesh.regions.contains(&Region::Disc) && mesh.regions.contains(&Region::Skin));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Region {
    /// The gel.
    Gel,
    /// The rubber skin.
    Skin,
    /// The disc, if the phantom has one; gel otherwise.
    Disc,
}

/// A shape of element.
///
/// ```
/// use palpate::fem::Element;
///
/// let locking = Element::Q4Full;
/// assert_eq!((locking.name(), locking.corners(), locking.nodes()), ("q4-full", 4, 4));
/// assert_eq!((Element::T6.corners(), Element::T6.nodes()), (3, 6));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Element {
    /// Isoparametric triangle with 6 nodes: the default.
    #[default]
    T6,
    /// Fully integrated 4-node quadrilateral. It locks at ν = 0.49, so that forces come out some per cent
    /// high, and is kept because the paper's authors plausibly ran it.
    Q4Full,
}

impl Element {
    /// The name on the command line and in files.
    ///
    /// ```
    /// assert_eq!(palpate::fem::Element::default().name(), "t6");
    /// ```
    pub fn name(self) -> &'static str {
        match self {
            Element::T6 => "t6",
            Element::Q4Full => "q4-full",
        }
    }

    /// Corners of one element: its first nodes.
    ///
    /// ```
    /// assert_eq!(palpate::fem::Element::T6.corners(), 3);
    /// ```
    pub fn corners(self) -> usize {
        match self {
            Element::T6 => 3,
            Element::Q4Full => 4,
        }
    }

    /// Nodes of one element.
    ///
    /// ```
    /// assert_eq!(palpate::fem::Element::T6.nodes(), 6);
    /// ```
    pub fn nodes(self) -> usize {
        match self {
            Element::T6 => 6,
            Element::Q4Full => 4,
        }
    }
}

/// Nodes, elements and regions of one phantom.
///
/// ```
/// use palpate::fem::{Mesh, MeshOptions};
/// use palpate::phantom::Phantom;
///
/// let options = MeshOptions { size: 2e-3, ..MeshOptions::default() };
/// let mesh = Mesh::new(&Phantom::builtin("6.6")?, &options)?;
/// assert_eq!(mesh.elements().count(), mesh.regions.len());
/// // The surface is free from wall to wall, at y = 0; the first node lies on the floor.
/// let free = mesh.free();
/// assert!(mesh.surface().all(|node| free[node] && mesh.nodes[node][1] == 0.0));
/// assert!(!free[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: FEM-001, FEM-002, FEM-003, CON-003.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Undeformed position of each node, m, in rows from the floor to the surface, each from left to right.
    pub nodes: Vec<[f64; 2]>,
    /// The nodes of each row; the first and the last of a row lie on the walls.
    pub rows: Vec<Range<usize>>,
    /// The shape of every element.
    pub element: Element,
    /// Nodes of all elements, [`Element::nodes`] each: corners counter-clockwise, then (T6) the nodes in
    /// the middle of edges 01, 12, 20.
    pub connectivity: Vec<u32>,
    /// Region of each element.
    pub regions: Vec<Region>,
}

/// Most nodes that a mesh may have: its factor fills some 3 GB.
const MOST_NODES: f64 = 500_000.0;

impl Mesh {
    /// Meshes a valid phantom.
    ///
    /// ```
    /// use palpate::fem::{FemError, Mesh, MeshOptions};
    /// use palpate::phantom::Phantom;
    ///
    /// let phantom = Phantom::builtin("none")?;
    /// let micrometre = MeshOptions { size: 1e-6, ..MeshOptions::default() };
    /// assert!(matches!(Mesh::new(&phantom, &micrometre), Err(FemError::MeshSize { .. })));
    /// let mesh = Mesh::new(&phantom, &MeshOptions { size: 2e-3, ..micrometre })?;
    /// assert_eq!(mesh.connectivity.len(), 6 * mesh.regions.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::MeshSize`] if the size is not positive and finite, or the mesh would have more than 500 000
    /// nodes.
    pub fn new(phantom: &Phantom, options: &MeshOptions) -> Result<Mesh, FemError> {
        Mesh::with_quarters(phantom, options, QUARTERS)
    }

    /// As [`Mesh::new`], with `quarters`/4 of the cells along each line of the lattice.
    ///
    /// Implements: FEM-024, FEM-018.
    pub(super) fn with_quarters(
        phantom: &Phantom,
        options: &MeshOptions,
        quarters: usize,
    ) -> Result<Mesh, FemError> {
        let refused = FemError::MeshSize {
            size: options.size,
            refinement: options.refinement,
        };
        let finest = options.size / options.refinement as f64;
        // Nodes stand at half the cells' distance. Written so that a NaN is refused; counts are made only
        // behind this, since they could overflow.
        let least_nodes = 4.0 * phantom.gel.width / finest * phantom.total_height() / finest;
        if !(options.refinement > 0
            && options.size > 0.0
            && options.size.is_finite()
            && least_nodes <= 4.0 * MOST_NODES)
        {
            return Err(refused);
        }
        let outline = Outline::new(phantom, options, quarters);
        if outline.cells.nodes() as f64 > MOST_NODES {
            return Err(refused);
        }
        let mut mesh = Mesh {
            nodes: Vec::new(),
            rows: Vec::new(),
            element: options.element,
            connectivity: Vec::new(),
            regions: Vec::new(),
        };
        mesh.place_nodes(&outline);
        mesh.connect(&outline.cells);
        Ok(mesh)
    }

    fn place_nodes(&mut self, outline: &Outline) {
        let Cells { split, .. } = outline.cells;
        let half = outline.cells.half_columns();
        let top = outline.cells.coarse_rows();
        for row in 0..=2 * top {
            self.push_row((0..=2 * half).map(|column| coarse_point(outline, column, row)));
        }
        let meeting = |k: usize| meeting_point(outline, k, half, top);
        self.push_row((0..=(split + 1) * half).map(meeting));
        for row in 0..=2 * outline.cells.skin {
            self.push_row((0..=2 * split * half).map(|column| fine_point(outline, column, row)));
        }
    }

    /// Adds a row given from the axis to the right wall; the left half is the mirror image to the bit.
    fn push_row(&mut self, right: impl Iterator<Item = [f64; 2]>) {
        let right: Vec<_> = right.collect();
        let start = self.nodes.len();
        self.nodes
            .extend(right.iter().skip(1).rev().map(|&[x, y]| [-x, y]));
        self.nodes.extend(right);
        self.rows.push(start..self.nodes.len());
    }

    fn connect(&mut self, cells: &Cells) {
        let half = cells.half_columns();
        let disc_rows = cells.disc_rows();
        for j in 0..cells.coarse_rows() {
            for i in 0..2 * half {
                let in_disc =
                    disc_rows.contains(&j) && (half - cells.disc..half + cells.disc).contains(&i);
                let region = if in_disc { Region::Disc } else { Region::Gel };
                // Diagonals point to the disc's centre, so that no corner of its bent square is left
                // with a flat triangle.
                let rising = (i >= half) == (j >= cells.below + cells.disc);
                self.push_cell(2 * i, 2 * j, rising, region);
            }
        }
        let meeting = 2 * cells.coarse_rows();
        for i in 0..2 * half {
            match cells.split {
                2 => self.push_meeting_cell(i, meeting),
                _ => self.push_cell(2 * i, meeting, i >= half, Region::Gel),
            }
        }
        for j in 0..cells.skin {
            for i in 0..2 * half * cells.split {
                let rising = i >= half * cells.split;
                self.push_cell(2 * i, meeting + 2 + 2 * j, rising, Region::Skin);
            }
        }
    }

    /// The elements of the cell whose lower left corner is node `column` of row `row`; all three rows of
    /// nodes have the same columns.
    fn push_cell(&mut self, column: usize, row: usize, rising: bool, region: Region) {
        let at = |c: usize, r: usize| (self.rows[row + r].start + column + c) as u32;
        match self.element {
            Element::T6 => {
                let corners = [[0, 0], [2, 0], [2, 2], [0, 2]];
                let triangles = if rising {
                    [[0, 1, 2], [0, 2, 3]]
                } else {
                    [[0, 1, 3], [1, 2, 3]]
                };
                for triangle in triangles {
                    let [a, b, c] = triangle.map(|k: usize| corners[k]);
                    let middle =
                        |p: [usize; 2], q: [usize; 2]| at((p[0] + q[0]) / 2, (p[1] + q[1]) / 2);
                    let [na, nb, nc] = [a, b, c].map(|p| at(p[0], p[1]));
                    self.connectivity.extend([
                        na,
                        nb,
                        nc,
                        middle(a, b),
                        middle(b, c),
                        middle(c, a),
                    ]);
                    self.regions.push(region);
                }
            }
            Element::Q4Full => {
                for [c, r] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                    let quad = [at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)];
                    self.connectivity.extend(quad);
                    self.regions.push(region);
                }
            }
        }
    }

    /// The three triangles in which coarse cell `i` meets two fine ones.
    fn push_meeting_cell(&mut self, i: usize, row: usize) {
        let [bottom, middle, top] = [2, 3, 4].map(|per_cell| {
            let row = row + per_cell - 2;
            move |k: usize, rows: &[Range<usize>]| (rows[row].start + per_cell * i + k) as u32
        });
        let (b, m, t) = (
            |k| bottom(k, &self.rows),
            |k| middle(k, &self.rows),
            |k| top(k, &self.rows),
        );
        let triangles = [
            [b(0), b(2), t(2), b(1), m(2), m(1)],
            [b(0), t(2), t(0), m(1), t(1), m(0)],
            [b(2), t(4), t(2), m(3), t(3), m(2)],
        ];
        self.connectivity.extend(triangles.as_flattened());
        self.regions.extend([Region::Gel; 3]);
    }

    /// The nodes of each element.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// assert!(model.mesh().elements().all(|nodes| nodes.len() == 6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.element.nodes())
    }

    /// Positions of an element's nodes, m.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let mesh = model.mesh();
    /// let [first, last] = [0, mesh.nodes.len() - 1];
    /// // From the lower left corner to the upper right one.
    /// let corners = mesh.positions(&[first as u32, last as u32]);
    /// assert_eq!(corners, [[-17e-3, -phantom.total_height()], [17e-3, 0.0]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn positions(&self, nodes: &[u32]) -> Vec<[f64; 2]> {
        nodes
            .iter()
            .map(|&node| self.nodes[node as usize])
            .collect()
    }

    /// Whether each node is free: not on the floor nor on a wall.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let (mesh, free) = (model.mesh(), model.mesh().free());
    /// let on_floor = mesh.rows[0].clone();
    /// assert!(on_floor.clone().all(|node| !free[node]) && free[on_floor.end + 1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-004.
    pub fn free(&self) -> Vec<bool> {
        let mut free = vec![true; self.nodes.len()];
        free[self.rows[0].clone()].fill(false);
        for row in &self.rows {
            free[row.start] = false;
            free[row.end - 1] = false;
        }
        free
    }

    /// An element that has no mirror image, or has a node without one; `None` if there is none. Nodes of a row
    /// are mirror images from its ends inwards, to the bit, and an element's is one of the same region.
    ///
    /// Implements: FEM-029.
    pub(super) fn without_mirror_image(&self) -> Option<usize> {
        let mut images = vec![None; self.nodes.len()];
        for row in &self.rows {
            for (node, image) in row.clone().zip(row.clone().rev()) {
                let ([x, y], [image_x, image_y]) = (self.nodes[node], self.nodes[image]);
                if x == -image_x && y == image_y {
                    images[node] = Some(image as u32);
                }
            }
        }
        // Nodes in ascending order, so that the same element looks the same wherever it begins.
        let sorted = |nodes: &mut dyn Iterator<Item = Option<u32>>, region| {
            let mut key = [Some(0); 6];
            for (place, node) in key.iter_mut().zip(nodes) {
                *place = node;
            }
            key.sort_unstable();
            (key, region as u8)
        };
        let elements = || self.elements().zip(&self.regions);
        let mut all: Vec<_> = elements()
            .map(|(nodes, &region)| sorted(&mut nodes.iter().map(|&node| Some(node)), region))
            .collect();
        all.sort_unstable();
        elements().position(|(nodes, &region)| {
            let image = sorted(&mut nodes.iter().map(|&node| images[node as usize]), region);
            all.binary_search(&image).is_err()
        })
    }

    /// The free nodes of the outer surface, from left to right.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let mesh = model.mesh();
    /// let top: Vec<f64> = mesh.surface().map(|node| mesh.nodes[node][0]).collect();
    /// assert!(top.is_sorted() && top[0] == -top[top.len() - 1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn surface(&self) -> Range<usize> {
        let last = &self.rows[self.rows.len() - 1];
        last.start + 1..last.end - 1
    }
}

/// A node of the coarse part, `column` half cells from the axis and `row` half cells above the floor.
fn coarse_point(outline: &Outline, column: usize, row: usize) -> [f64; 2] {
    let (i, j) = (column / 2, row / 2);
    match (column % 2, row % 2) {
        (0, 0) => outline.coarse(i, j),
        (1, 0) => outline.coarse_middle([i, j], [i + 1, j]),
        (0, _) => outline.coarse_middle([i, j], [i, j + 1]),
        _ if j >= outline.cells.below + outline.cells.disc => {
            outline.coarse_middle([i, j], [i + 1, j + 1])
        }
        _ => outline.coarse_middle([i, j + 1], [i + 1, j]),
    }
}

/// Node `k` from the axis of the row of nodes half-way between the coarse and the fine part.
fn meeting_point(outline: &Outline, k: usize, half: usize, top: usize) -> [f64; 2] {
    let split = outline.cells.split;
    let (i, within) = (k / (split + 1), k % (split + 1));
    let fine = |line: usize| outline.fine(line, 0);
    match (within, split) {
        (0, _) => half_way(outline.coarse(i, top), fine(split * i)),
        // Where two fine cells meet a coarse one, its two slanted edges lead to their common corner.
        (1, 2) => half_way(outline.coarse(i, top), fine(2 * i + 1)),
        (_, 2) => half_way(outline.coarse(i + 1, top), fine(2 * i + 1)),
        _ => half_way(outline.coarse(i, top), fine((i + 1).min(half))),
    }
}

/// A node of the fine part, `column` half fine cells from the axis, `row` half cells above its bottom.
fn fine_point(outline: &Outline, column: usize, row: usize) -> [f64; 2] {
    let (i, j) = (column / 2, row / 2);
    half_way(
        outline.fine(i, j),
        outline.fine(i + column % 2, j + row % 2),
    )
}
