//! The mesh of a phantom: triangles with six nodes, bent along the inclusions' edges, or quadrilaterals cut from them.

use std::collections::HashMap;

use super::size::{SizeField, on_unit_circle};
use super::triangulate::{Point, Triangulation};
use super::{FemError, MeshOptions};
use crate::phantom::{Material, Outline, Phantom, Support};

/// What an element is made of: an entry of the phantom's list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// A layer, from the top.
    Layer(usize),
    /// An inclusion.
    Inclusion(usize),
}

impl Region {
    /// Its material in a phantom that has it.
    pub fn material(self, phantom: &Phantom) -> &Material {
        match self {
            Region::Layer(k) => &phantom.layers[k].material,
            Region::Inclusion(k) => &phantom.inclusions[k].material,
        }
    }
}

/// A shape of element.
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
    pub fn name(self) -> &'static str {
        match self {
            Element::T6 => "t6",
            Element::Q4Full => "q4-full",
        }
    }

    /// Corners of one element: its first nodes.
    pub fn corners(self) -> usize {
        match self {
            Element::T6 => 3,
            Element::Q4Full => 4,
        }
    }

    /// Nodes of one element.
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
/// // The surface runs from wall to wall at y = 0, where the walls hold its ends.
/// let [first, .., last] = mesh.surface[..] else { unreachable!() };
/// assert_eq!([mesh.nodes[first], mesh.nodes[last]], [[-0.017, 0.0], [0.017, 0.0]]);
/// assert_eq!([mesh.held[first], mesh.held[mesh.surface[1]]], [[true; 2], [false; 2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: FEM-001, FEM-002, FEM-003, FEM-004, CON-003.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Undeformed position of each node, m.
    pub nodes: Vec<[f64; 2]>,
    /// The shape of every element.
    pub element: Element,
    /// Nodes of all elements, [`Element::nodes`] each: corners counter-clockwise, then (T6) the nodes in
    /// the middle of edges 01, 12, 20.
    pub connectivity: Vec<u32>,
    /// Region of each element.
    pub regions: Vec<Region>,
    /// The nodes at the outer surface from left to right, those on the walls included.
    pub surface: Vec<usize>,
    /// Which displacement components of each node, along x and y, the walls and the floor hold at zero.
    pub held: Vec<[bool; 2]>,
    /// Whether the mesh is its own mirror image in x, node by node.
    pub symmetric: bool,
}

/// Most nodes that a mesh may have: its factor fills some 3 GB.
const MOST_NODES: f64 = 500_000.0;

impl Mesh {
    /// Meshes a valid phantom.
    ///
    /// # Errors
    /// [`FemError::MeshSize`] if the size is not positive and finite, or the mesh would have more than 500 000
    /// nodes; [`FemError::Shape`] if a triangle comes out too flat.
    ///
    /// Implements: FEM-018.
    pub fn new(phantom: &Phantom, options: &MeshOptions) -> Result<Mesh, FemError> {
        let size = options.size;
        if !(size > 0.0 && size.is_finite()) {
            return Err(FemError::MeshSize { size });
        }
        let field = SizeField::new(phantom, size);
        let nodes = field.expected_nodes();
        if nodes > MOST_NODES {
            return Err(FemError::TooManyNodes { size, nodes });
        }
        let symmetric = phantom.is_symmetric();
        let triangles = Triangulation::new(phantom, &field, symmetric)?;
        let mut mesh = Mesh {
            nodes: Vec::new(),
            element: Element::T6,
            connectivity: Vec::new(),
            regions: Vec::new(),
            surface: Vec::new(),
            held: Vec::new(),
            symmetric,
        };
        mesh.place(phantom, &triangles);
        if symmetric {
            mesh.mirror(phantom);
        }
        if options.element == Element::Q4Full {
            mesh.cut_into_quadrilaterals();
        }
        mesh.find_borders(phantom);
        Ok(mesh)
    }

    /// Triangles with a node in the middle of each edge.
    fn place(&mut self, phantom: &Phantom, triangles: &Triangulation<'_>) {
        self.nodes = triangles
            .corners
            .iter()
            .map(|&corner| corner.into())
            .collect();
        let levels = phantom.levels();
        let outlines: Vec<Outline> = phantom.inclusions.iter().map(|i| i.outline()).collect();
        let on_lines = triangles.middles();
        let mut middles = HashMap::new();
        for corners in &triangles.triangles {
            self.connectivity.extend(corners.map(|k| k as u32));
            for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|k: usize| corners[k])) {
                let ends = [a.min(b), a.max(b)];
                let middle = *middles.entry(ends).or_insert_with(|| {
                    let chord = (triangles.corners[a] + triangles.corners[b]) / 2.0;
                    let middle = on_lines.get(&ends).unwrap_or(&chord);
                    self.nodes.push((*middle).into());
                    self.nodes.len() as u32 - 1
                });
                self.connectivity.push(middle);
            }
            let centre = corners.map(|k| triangles.corners[k]).iter().sum::<Point>() / 3.0;
            let inclusion = outlines
                .iter()
                .position(|outline| encloses(outline, centre));
            let layer = || levels[1..].partition_point(|&level| level > centre.y);
            self.regions
                .push(inclusion.map_or_else(|| Region::Layer(layer()), Region::Inclusion));
        }
    }

    /// Adds the left half.
    fn mirror(&mut self, phantom: &Phantom) {
        let mut images: Vec<u32> = Vec::new();
        for node in 0..self.nodes.len() {
            let [x, y] = self.nodes[node];
            let on_axis = x == 0.0;
            images.push(if on_axis { node } else { self.nodes.len() } as u32);
            if !on_axis {
                self.nodes.push([-x, y]);
            }
        }
        let image_of = phantom.mirror_images();
        for element in 0..self.regions.len() {
            for k in [0, 2, 1, 5, 4, 3] {
                let node = self.connectivity[6 * element + k] as usize;
                self.connectivity.push(images[node]);
            }
            self.regions.push(match self.regions[element] {
                Region::Inclusion(k) => Region::Inclusion(image_of[k]),
                layer => layer,
            });
        }
    }

    /// Cuts each triangle in three, from its edges' middles to its own.
    fn cut_into_quadrilaterals(&mut self) {
        let mut connectivity = Vec::new();
        for nodes in self.connectivity.chunks_exact(6) {
            let centre = self.nodes.len() as u32;
            // In an order that gives the mirror image, whose corners are 0, 2, 1, the same sum.
            let corners = [1, 2, 0].map(|k| Point::from(self.nodes[nodes[k] as usize]));
            self.nodes
                .push((corners.iter().sum::<Point>() / 3.0).into());
            for k in 0..3 {
                connectivity.extend([nodes[k], nodes[3 + k], centre, nodes[3 + (k + 2) % 3]]);
            }
        }
        self.connectivity = connectivity;
        self.regions = self
            .regions
            .iter()
            .flat_map(|&region| [region; 3])
            .collect();
        self.element = Element::Q4Full;
    }

    /// Implements: FEM-035.
    fn find_borders(&mut self, phantom: &Phantom) {
        let (wall, floor) = (
            0.5 * phantom.well.width,
            phantom.levels()[phantom.layers.len()],
        );
        // A support across x or y.
        let holds = |support: Support, at: bool, direction: usize, across: usize| {
            at && (support == Support::Fixed || support == Support::Sliding && direction == across)
        };
        let held = |&[x, y]: &[f64; 2]| {
            [0, 1].map(|direction| {
                holds(phantom.well.walls, x.abs() == wall, direction, 0)
                    || holds(phantom.well.floor, y == floor, direction, 1)
            })
        };
        self.held = self.nodes.iter().map(held).collect();
        let x = |node: usize| self.nodes[node][0];
        self.surface = (0..self.nodes.len())
            .filter(|&node| self.nodes[node][1] == 0.0)
            .collect();
        self.surface.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    }

    /// The nodes of one element.
    pub(super) fn nodes_of(&self, element: u32) -> &[u32] {
        let count = self.element.nodes();
        &self.connectivity[element as usize * count..][..count]
    }

    /// The nodes of each element in turn.
    pub fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.element.nodes())
    }

    /// Undeformed positions of some nodes, m.
    pub fn positions(&self, nodes: &[u32]) -> Vec<[f64; 2]> {
        nodes
            .iter()
            .map(|&node| self.nodes[node as usize])
            .collect()
    }
}

/// Whether an outline encloses a point that is not on it.
fn encloses(outline: &Outline, at: Point) -> bool {
    match outline {
        Outline::Ellipse {
            centre,
            radii,
            turn,
        } => on_unit_circle(centre, radii, turn, at).norm() < 1.0,
        Outline::Polygon(points) => {
            let next = points.iter().cycle().skip(1);
            let edges = points.iter().zip(next);
            let edges = edges.map(|(a, b)| (Point::from(*a), Point::from(*b)));
            let level = edges.filter(|(a, b)| (a.y > at.y) != (b.y > at.y));
            let right = level.filter(|(a, b)| ((b - a).perp(&(at - a)) > 0.0) == (b.y > a.y));
            right.count() % 2 == 1
        }
    }
}
