//! The order in which the interior's unknowns are eliminated: nested dissection by coordinates.
//!
//! A line of nodes that cuts the mesh in two is eliminated after both parts, so that they do not fill each other's
//! columns of the factor; each part is cut again (George 1973).

use super::element::CORNERS;
use super::mesh::Mesh;

/// Parts of at most so many elements are not cut: their fill is small in any order.
const SMALLEST_PART: usize = 8;

/// Where a node stands in the search.
const INTERIOR: u32 = 0;
const ORDERED: u32 = u32::MAX;

/// The nodes below the surface in the order of elimination.
///
/// Implements: FEM-006.
pub fn dissection(mesh: &Mesh) -> Vec<usize> {
    let centre = |nodes: &[u32]| {
        let corners = mesh.positions(&nodes[..CORNERS]);
        [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>())
    };
    let mut search = Search {
        mesh,
        centres: mesh.elements().map(centre).collect(),
        marks: vec![INTERIOR; mesh.nodes.len()],
        stamp: INTERIOR,
        order: Vec::new(),
    };
    for &node in &mesh.surface {
        search.marks[node] = ORDERED;
    }
    let mut elements: Vec<u32> = (0..mesh.regions.len() as u32).collect();
    search.dissect(&mut elements);
    search.order
}

struct Search<'a> {
    mesh: &'a Mesh,
    centres: Vec<[f64; 2]>,
    marks: Vec<u32>,
    stamp: u32,
    order: Vec<usize>,
}

impl Search<'_> {
    fn dissect(&mut self, elements: &mut [u32]) {
        if elements.len() <= SMALLEST_PART {
            let nodes = self.unordered(elements);
            self.order.extend(nodes);
            return;
        }
        let middle = elements.len() / 2;
        let [across_x, across_y] = [0, 1].map(|axis| {
            self.halve(elements, axis);
            self.separator(elements, middle)
        });
        let separator = if across_x.len() <= across_y.len() {
            self.halve(elements, 0);
            across_x
        } else {
            across_y
        };
        for &node in &separator {
            self.marks[node] = ORDERED;
        }
        let (before, behind) = elements.split_at_mut(middle);
        self.dissect(before);
        self.dissect(behind);
        self.order.extend(separator);
    }

    /// Puts the half of the elements with the smaller coordinate first.
    fn halve(&self, elements: &mut [u32], axis: usize) {
        let middle = elements.len() / 2;
        let at = |element: &u32| self.centres[*element as usize][axis];
        elements.select_nth_unstable_by(middle, |a, b| at(a).total_cmp(&at(b)).then(a.cmp(b)));
    }

    /// The nodes that elements before `middle` share with those behind, of those not yet ordered, ascending.
    fn separator(&mut self, elements: &[u32], middle: usize) -> Vec<usize> {
        self.stamp += 1;
        let nodes = |&element: &u32| self.mesh.nodes_of(element);
        for &node in elements[..middle].iter().flat_map(nodes) {
            let mark = &mut self.marks[node as usize];
            if *mark != ORDERED {
                *mark = self.stamp;
            }
        }
        let behind = elements[middle..].iter().flat_map(nodes);
        let behind = behind.map(|&node| node as usize);
        let is_marked = |&node: &usize| self.marks[node] == self.stamp;
        let mut shared: Vec<usize> = behind.filter(is_marked).collect();
        shared.sort_unstable();
        shared.dedup();
        shared
    }

    /// The nodes of some elements that are not yet ordered, each once; they are then.
    fn unordered(&mut self, elements: &[u32]) -> Vec<usize> {
        let nodes = elements.iter().flat_map(|&e| self.mesh.nodes_of(e));
        nodes
            .map(|&node| node as usize)
            .filter(|&node| std::mem::replace(&mut self.marks[node], ORDERED) != ORDERED)
            .collect()
    }
}
