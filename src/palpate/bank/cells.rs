//! The cells between the points of a bank, with as many nodes as the signals need.

use std::sync::OnceLock;

use super::axis::{BankAxis, BankCell, SIGNAL, places};

/// The fewest nodes of a cell along an axis, and the most.
const NODES: [usize; 2] = [5, 20];
/// The nodes of a cell, at most: fewer along the axis that has most until they are.
const ALL_NODES: usize = 20_000;

/// The cells of a bank.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub axes: [BankAxis; 4],
    pub cells: Vec<BankCell>,
    pub corners: Vec<Vec<usize>>,
    /// How far (Pδ)ᵀz − |Pδ|²/2 may rise within a cell above that of its corners: a quarter of the squared distance between its corners'
    /// signals, twice what a parabola does.
    pub rise: Vec<f64>,
    /// What does not depend on the record, of each cell that was wanted.
    pub nodes: Vec<OnceLock<Nodes>>,
}

/// The nodes of a cell.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// |Pδ|².
    pub energy: Vec<f64>,
    /// The prior.
    pub prior: Vec<f64>,
}

impl Cells {
    pub fn new(points: &[Vec<f64>; 4], templates: &[f64], samples: usize) -> Cells {
        let template = |point: usize| &templates[point * samples..][..samples];
        let mut axes = points.each_ref().map(|points| BankAxis::new(points));
        let mut stride = 1;
        for axis in &mut axes {
            let number = axis.points.len();
            let all = templates.len() / samples;
            let pairs = (0..all).filter(|point| point / stride % number + 1 < number);
            let distances = pairs.map(|point| distance(template(point), template(point + stride)));
            // Two nodes for each standard deviation that a record can tell apart.
            let farthest = libm::sqrt(distances.fold(0.0, f64::max));
            if axis.is_free() {
                axis.nodes = (libm::ceil(2.0 * farthest) as usize).clamp(NODES[0], NODES[1]);
            }
            stride *= number;
        }
        while axes.iter().map(|axis| axis.nodes).product::<usize>() > ALL_NODES {
            if let Some(most) = axes.iter_mut().max_by_key(|axis| axis.nodes) {
                most.nodes -= 1;
            }
        }
        let lengths = axes.each_ref().map(BankAxis::cells);
        let cell = |number| BankCell::new(&axes, places(number, lengths), SIGNAL);
        let cells: Vec<BankCell> = (0..lengths.iter().product()).map(cell).collect();
        let corners: Vec<Vec<usize>> = cells.iter().map(|cell| cell.corners(&axes)).collect();
        let rise = corners.iter().map(|corners| {
            let from = template(corners[0]);
            let distances = corners.iter().map(|&to| distance(from, template(to)));
            0.25 * distances.fold(0.0, f64::max)
        });
        Cells {
            rise: rise.collect(),
            nodes: cells.iter().map(|_| OnceLock::new()).collect(),
            axes,
            cells,
            corners,
        }
    }
}

/// |a − b|².
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b) * (a - b)).sum()
}
