//! The order in which the interior's unknowns are eliminated: nested dissection of the lattice.
//!
//! A line of nodes that cuts the lattice in two is eliminated after both halves, so that they do not
//! fill each other's columns of the factor; each half is cut again (George 1973). On a lattice the
//! lines are at hand, and the factor has fewer entries than with an approximate-minimum-degree order.

use core::cmp::Ordering;

use super::mesh::Mesh;

/// A node at its place in the lattice, in half cells of the coarse part.
#[derive(Debug, Clone, Copy)]
struct Site {
    node: usize,
    /// From the left wall; a fraction where the fine part has nodes between.
    column: f64,
    row: usize,
}

/// Pieces of at most so many nodes are not cut: their fill is small in any order.
const SMALLEST_PIECE: usize = 40;

/// Orders the nodes for which `wanted` holds.
///
/// Implements: FEM-006.
pub fn nested_dissection(mesh: &Mesh, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
    let columns = (mesh.rows[0].len() - 1) as f64;
    let mut sites = Vec::with_capacity(mesh.nodes.len());
    for (row, nodes) in mesh.rows.iter().enumerate() {
        let last = (nodes.len() - 1) as f64;
        for node in nodes.clone().filter(|&node| wanted(node)) {
            // On a coarse line the product is a multiple of the divisor: exact.
            let column = (node - nodes.start) as f64 * columns / last;
            sites.push(Site { node, column, row });
        }
    }
    let mut order = Vec::with_capacity(sites.len());
    dissect(sites, &mut order);
    order
}

fn dissect(sites: Vec<Site>, order: &mut Vec<usize>) {
    let Some(line) = middle_line(&sites) else {
        order.extend(sites.iter().map(|site| site.node));
        return;
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
    dissect(before, order);
    dissect(behind, order);
    order.extend(on.iter().map(|site| site.node));
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

/// The line in the middle of a piece, across its longer extent; `None` if the piece is small or no line
/// has nodes on both its sides.
fn middle_line(sites: &[Site]) -> Option<Line> {
    if sites.len() <= SMALLEST_PIECE {
        return None;
    }
    let rows = extent(sites.iter().map(|site| site.row as f64));
    let columns = extent(sites.iter().map(|site| site.column));
    let across = |[first, last]: [f64; 2]| {
        // Lines between cells are the even ones.
        let line = 2.0 * libm::round((first + last) / 4.0);
        (first < line && line < last).then_some(line)
    };
    let column = across(columns).map(Line::Column);
    let row = across(rows).map(|line| Line::Row(line as usize));
    if rows[1] - rows[0] > columns[1] - columns[0] {
        row.or(column)
    } else {
        column.or(row)
    }
}

/// The smallest and the largest value.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}
