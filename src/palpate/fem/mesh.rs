//! The mesh of a phantom: triangles with six nodes, bent along the inclusions' edges.

use std::collections::HashMap;

use super::FemError;
use super::element::NODES;
use super::size::SizeField;
use super::triangle::Point;
use super::triangulate::Triangulation;
use crate::decimal::mm;
use crate::phantom::{Geometry, Material, Outline, Phantom, Support};
use crate::refusal::Refusal;

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
            Region::Layer(k) => &phantom.layers()[k].material,
            Region::Inclusion(k) => &phantom.inclusions()[k].material,
        }
    }
}

/// Nodes, elements and regions of one phantom.
///
/// Implements: FEM-014, FEM-002, FEM-004, CON-003.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Undeformed position of each node, m.
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of all elements, [`NODES`] each: corners counter-clockwise, then those in the middle of the edges 01, 12, 20.
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

/// What to do about a half that cannot be meshed: the angle is twice the smallest of a triangle.
const HALF: &str = "give a polygon's corner on the axis more than 50°, or try another mesh size";

/// The refusal of a half, where the whole would have elements across the axis.
fn of_half(error: FemError) -> FemError {
    match error {
        FemError::Refused(refusal) => Refusal {
            remedy: HALF.into(),
            ..*refusal
        }
        .into(),
        other => other,
    }
}

/// Most nodes that a mesh may have: its factor fills some 3 GB.
const MOST_NODES: f64 = 500_000.0;
/// Most nodes of its surface, which has a dense matrix: 0.8 GB.
const MOST_SURFACE_NODES: usize = 5_000;

impl Mesh {
    /// Meshes a valid phantom with the mesh size `size`, m: at [`MESH_SIZE`](super::MESH_SIZE) elements have the sizes of
    /// `spec/fem.md`, any other scales them all.
    ///
    /// # Errors
    /// [`FemError::Refused`] if the size is not positive and finite, if the mesh would have more than 500 000 nodes, or 5 000 on the
    /// surface, and if a triangle comes out too flat, of an axisymmetric phantom in its right half.
    ///
    /// Implements: FEM-017, FEM-037.
    pub fn new(phantom: &Phantom, size: f64) -> Result<Mesh, FemError> {
        let (field, _) = Mesh::forecast(phantom, size)?;
        let mut symmetric = phantom.is_symmetric();
        let mut triangles = Triangulation::new(phantom, &field, symmetric);
        // The axis may halve the corner of a polygon, which is then too sharp.
        if phantom.geometry() == Geometry::Axisymmetric {
            triangles = triangles.map_err(of_half);
        } else if symmetric && triangles.is_err() {
            symmetric = false;
            triangles = Triangulation::new(phantom, &field, symmetric);
        }
        let mut mesh = Mesh {
            symmetric,
            ..Mesh::default()
        };
        mesh.place(phantom, &triangles?);
        if symmetric {
            mesh.mirror(phantom);
        }
        mesh.find_borders(phantom);
        let nodes = mesh.surface.len();
        let asked = mm(size);
        let found = format!(
            "mesh size {asked} mm makes {nodes} nodes on the surface, allowed: at most {MOST_SURFACE_NODES}"
        );
        let remedy = "a larger size makes fewer";
        Refusal::state(found, remedy).when(nodes > MOST_SURFACE_NODES)?;
        Ok(mesh)
    }

    /// About how many nodes [`Mesh::new`] will make: known at once, where the mesh may take seconds and each pose a minute.
    ///
    /// # Errors
    /// [`FemError::Refused`] for the size, as [`Mesh::new`].
    ///
    /// Implements: FEM-036.
    pub fn expected_nodes(phantom: &Phantom, size: f64) -> Result<f64, FemError> {
        Ok(Mesh::forecast(phantom, size)?.1)
    }

    /// The sizes of the elements, and about how many nodes they make.
    fn forecast(phantom: &Phantom, size: f64) -> Result<(SizeField, f64), FemError> {
        let asked = format!("mesh size {} mm", size * 1e3);
        let wrong = Refusal::value(
            "mesh size",
            format!("{} mm", size * 1e3),
            "a finite number above 0",
        );
        wrong.when(!(size > 0.0 && size.is_finite()))?;
        let field = SizeField::new(phantom, size);
        let nodes = field.expected_nodes();
        if nodes <= MOST_NODES {
            return Ok((field, nodes));
        }
        let found = format!("{asked} makes about {nodes:.0} nodes, allowed: at most {MOST_NODES}");
        // No phantom has a larger length.
        let remedy = if SizeField::new(phantom, 1.0).expected_nodes() <= MOST_NODES {
            "a larger size makes fewer".into()
        } else {
            let layers = phantom.layers().iter().map(|layer| layer.thickness);
            let thinnest = mm(layers.fold(f64::INFINITY, f64::min));
            format!(
                "no size makes few enough: give a layer thicker than {thinnest} mm, or wider gaps"
            )
        };
        Err(Refusal::state(found, remedy).into())
    }

    /// Triangles with a node in the middle of each edge.
    fn place(&mut self, phantom: &Phantom, triangles: &Triangulation<'_>) {
        self.nodes = triangles.corners.iter().map(|&p| p.into()).collect();
        let levels = phantom.levels();
        let outlines: Vec<Outline> = phantom.inclusions().iter().map(|i| i.outline()).collect();
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
            let encloses = |outline: &Outline| outline.encloses(centre.into());
            let inclusion = outlines.iter().position(encloses);
            let layer = levels[1..].partition_point(|&level| level > centre.y);
            let region = inclusion.map_or(Region::Layer(layer), Region::Inclusion);
            self.regions.push(region);
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
                let node = self.connectivity[NODES * element + k] as usize;
                self.connectivity.push(images[node]);
            }
            self.regions.push(match self.regions[element] {
                Region::Inclusion(k) => Region::Inclusion(image_of[k]),
                layer => layer,
            });
        }
    }

    /// Implements: FEM-004.
    fn find_borders(&mut self, phantom: &Phantom) {
        let wall = 0.5 * phantom.well().width;
        let floor = phantom.levels()[phantom.layers().len()];
        // A support across x or y.
        let holds = |support: Support, at: bool, direction: usize, across: usize| {
            at && (support == Support::Fixed || support == Support::Sliding && direction == across)
        };
        let held = |&[x, y]: &[f64; 2]| {
            [0, 1].map(|direction| {
                holds(phantom.well().walls, x.abs() == wall, direction, 0)
                    || holds(phantom.well().floor, y == floor, direction, 1)
            })
        };
        self.held = self.nodes.iter().map(held).collect();
        let x = |node: usize| self.nodes[node][0];
        let is_on_top = |&node: &usize| self.nodes[node][1] == 0.0;
        self.surface = (0..self.nodes.len()).filter(is_on_top).collect();
        self.surface.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    }

    /// The nodes of one element.
    pub(super) fn nodes_of(&self, element: u32) -> &[u32] {
        &self.connectivity[element as usize * NODES..][..NODES]
    }

    /// The nodes of each element in turn.
    pub fn elements(&self) -> impl Iterator<Item = &[u32]> {
        self.connectivity.chunks_exact(NODES)
    }

    /// Undeformed positions of some nodes, m.
    pub fn positions(&self, nodes: &[u32]) -> Vec<[f64; 2]> {
        let position = |&node: &u32| self.nodes[node as usize];
        nodes.iter().map(position).collect()
    }
}
