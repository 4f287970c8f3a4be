//! The order in which the interior's unknowns are eliminated: nested dissection of the lattice.
//!
//! A line of nodes that cuts the lattice in two is eliminated after both halves, so that they do not
//! fill each other's columns of the factor; each half is cut again (George 1973). On a lattice the
//! lines are at hand, and the factor has fewer entries than with an approximate-minimum-degree order.
//! The first line is the axis: the halves beside it are mirror images, and only the right one is cut.

use core::cmp::Ordering;
use core::ops::Range;

use super::mesh::Mesh;

/// A node at its place in the lattice, in half cells of the coarse part.
#[derive(Debug, Clone, Copy)]
struct Site {
    node: usize,
    /// From the axis; a fraction where the fine part has nodes between.
    column: f64,
    row: usize,
}

/// Pieces of at most so many nodes are not cut: their fill is small in any order.
const SMALLEST_PIECE: usize = 8;

/// Nodes that are eliminated together: a line, or a piece that is not cut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Piece {
    /// Where they stand in the order.
    pub places: Range<usize>,
    /// How many pieces this line separates. They come before it, each behind its own.
    pub children: usize,
}

/// The nodes right of the axis, without walls, floor and outer surface, in the order of elimination.
///
/// Implements: FEM-006.
#[derive(Debug, Clone, Default)]
pub struct Dissection {
    /// The nodes.
    pub order: Vec<usize>,
    /// What is eliminated together, children first.
    pub pieces: Vec<Piece>,
}

impl Dissection {
    /// Dissects the right half of a mesh.
    pub fn new(mesh: &Mesh) -> Dissection {
        let columns = ((mesh.rows[0].len() - 1) / 2) as f64;
        let mut sites = Vec::with_capacity(mesh.nodes.len() / 2);
        let rows = mesh.rows.iter().enumerate();
        for (row, nodes) in rows.take(mesh.rows.len() - 1).skip(1) {
            let half = (nodes.len() - 1) / 2;
            let axis = nodes.start + half;
            for node in axis + 1..nodes.end - 1 {
                // On a coarse line the product is a multiple of the divisor: exact.
                let column = (node - axis) as f64 * columns / half as f64;
                sites.push(Site { node, column, row });
            }
        }
        let mut dissection = Dissection::default();
        dissection.dissect(sites);
        dissection
    }

    fn dissect(&mut self, sites: Vec<Site>) {
        let Some(line) = middle_line(&sites) else {
            return self.push(&sites, 0);
        };
        let part = |side: Ordering| -> Vec<Site> {
            sites
                .iter()
                .copied()
                .filter(|site| line.side_of(site) == side)
                .collect()
        };
        let (before, behind, on) = (
            part(Ordering::Less),
            part(Ordering::Greater),
            part(Ordering::Equal),
        );
        drop(sites);
        self.dissect(before);
        self.dissect(behind);
        self.push(&on, 2);
    }

    fn push(&mut self, sites: &[Site], children: usize) {
        let start = self.order.len();
        self.order.extend(sites.iter().map(|site| site.node));
        let places = start..self.order.len();
        self.pieces.push(Piece { places, children });
    }
}

/// A line of corners and midside nodes across the lattice.
#[derive(Debug, Clone, Copy)]
enum Line {
    Column(f64),
    Row(usize),
}

impl Line {
    fn side_of(self, site: &Site) -> Ordering {
        match self {
            Line::Column(column) => site.column.total_cmp(&column),
            Line::Row(row) => site.row.cmp(&row),
        }
    }
}

/// The line with as many nodes on one side as on the other, the shorter of column and row; `None` if the piece is
/// small or no line has nodes on both its sides.
fn middle_line(sites: &[Site]) -> Option<Line> {
    if sites.len() <= SMALLEST_PIECE {
        return None;
    }
    let column = middle(sites.iter().map(|site| site.column)).map(Line::Column);
    let row = middle(sites.iter().map(|site| site.row as f64)).map(|row| Line::Row(row as usize));
    let nodes = |line: &Line| {
        let on = |site: &&Site| line.side_of(site) == Ordering::Equal;
        sites.iter().filter(on).count()
    };
    [column, row].into_iter().flatten().min_by_key(nodes)
}

/// The line between cells, an even number, nearest to the median of `coordinates` that has some of them on both
/// its sides.
fn middle(coordinates: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = coordinates.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let median = sorted[sorted.len() / 2];
    let line = 2.0 * libm::round(median / 2.0);
    [line, line - 2.0, line + 2.0]
        .into_iter()
        .find(|&line| first < line && line < last)
}
