//! Signals between the points of a bank: on each axis the polynomial through the four nearest points.

use std::ops::Range;

use crate::force_map::Stencil;

/// The points whose polynomial stands for a signal, at most.
///
/// Implements: BNK-030.
pub(super) const SIGNAL: usize = 4;
/// Those for a prior.
pub(super) const PRIOR: usize = 2;

/// The places with the number `number` on four axes of so many places each, the first of which varies fastest.
pub(super) fn places(mut number: usize, lengths: [usize; 4]) -> [usize; 4] {
    lengths.map(|length| {
        let place = number % length;
        number /= length;
        place
    })
}

/// The point with the number `number` of the grid over `axes`, in the order of a bank's maps.
pub(super) fn point(axes: [&[f64]; 4], number: usize) -> [f64; 4] {
    let at = places(number, axes.map(<[f64]>::len));
    [0, 1, 2, 3].map(|axis: usize| axes[axis][at[axis]])
}

/// One axis of a bank.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BankAxis {
    /// Its points, increasing; one at least.
    pub points: Vec<f64>,
    /// Nodes in each cell between two points; 1 of an axis with one point.
    pub nodes: usize,
}

impl BankAxis {
    /// An axis with one node in a cell.
    pub fn new(points: &[f64]) -> BankAxis {
        BankAxis {
            points: points.to_vec(),
            nodes: 1,
        }
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        (self.points.len() - 1).max(1)
    }

    /// Whether there is anything between its points.
    pub fn is_free(&self) -> bool {
        self.points.len() > 1
    }

    /// Both ends of a cell.
    pub fn ends(&self, cell: usize) -> [f64; 2] {
        let last = self.points.len() - 1;
        [self.points[cell], self.points[(cell + 1).min(last)]]
    }

    /// The size of a cell, 1 of an axis with one point.
    pub fn size(&self, cell: usize) -> f64 {
        let [from, to] = self.ends(cell);
        if self.is_free() { to - from } else { 1.0 }
    }

    /// The cell of `x`, or the nearest.
    pub fn cell(&self, x: f64) -> usize {
        let next = self.points.partition_point(|&point| point <= x);
        next.saturating_sub(1).min(self.cells() - 1)
    }

    /// The middle of part `node` of a cell.
    pub fn node(&self, cell: usize, node: usize) -> f64 {
        let [from, to] = self.ends(cell);
        from + (node as f64 + 0.5) / self.nodes as f64 * (to - from)
    }

    /// At most `most` points around a cell, with the weights of Lagrange's polynomial at `x`.
    pub fn stencil(&self, cell: usize, x: f64, most: usize) -> Stencil {
        Stencil::around(&self.points, cell, x, most)
    }

    /// The stencils of all nodes of a cell.
    fn stencils(&self, cell: usize, most: usize) -> Vec<Stencil> {
        let nodes = 0..self.nodes;
        nodes
            .map(|node| self.stencil(cell, self.node(cell, node), most))
            .collect()
    }
}

/// The numbers of the maps at neighbouring points of each axis, those of the first axis first.
fn maps(axes: &[BankAxis; 4], along: [Range<usize>; 4]) -> Vec<usize> {
    let mut maps = vec![0];
    let mut stride = 1;
    for (axis, points) in axes.iter().zip(along) {
        let at = |point: usize| maps.iter().map(move |map| map + stride * point);
        maps = points.flat_map(at).collect();
        stride *= axis.points.len();
    }
    maps
}

/// A signal at the parameters `at`, between those of the maps: `value` gives a sample of a map.
pub(super) fn signal_at(
    axes: &[Vec<f64>; 4],
    at: [f64; 4],
    samples: usize,
    value: impl Fn(usize, usize) -> f64,
) -> Vec<f64> {
    let axes = axes.each_ref().map(|points| BankAxis::new(points));
    let cell = BankCell::around(&axes, at);
    let (mut nodes, mut spare) = (Vec::new(), Vec::new());
    let sample = |sample: usize| {
        cell.interpolate(|map| value(map, sample), &mut nodes, &mut spare);
        nodes[0]
    };
    (0..samples).map(sample).collect()
}

/// A cell of the bank, ready to interpolate in.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BankCell {
    /// Its number on each axis.
    pub at: [usize; 4],
    /// The maps around it, those of the first axis first.
    maps: Vec<usize>,
    /// For each axis, the stencils of its nodes.
    stencils: [Vec<Stencil>; 4],
}

impl BankCell {
    /// The cell with the numbers `at`, for interpolation between at most `most` points along an axis.
    pub fn new(axes: &[BankAxis; 4], at: [usize; 4], most: usize) -> BankCell {
        let stencils = [0, 1, 2, 3].map(|axis: usize| axes[axis].stencils(at[axis], most));
        BankCell::of(axes, at, stencils)
    }

    /// The cell of the parameters `at`, with a single node there.
    fn around(axes: &[BankAxis; 4], at: [f64; 4]) -> BankCell {
        let cell = [0, 1, 2, 3].map(|axis: usize| axes[axis].cell(at[axis]));
        let stencil = |axis: usize| axes[axis].stencil(cell[axis], at[axis], SIGNAL);
        BankCell::of(axes, cell, [0, 1, 2, 3].map(|axis| vec![stencil(axis)]))
    }

    fn of(axes: &[BankAxis; 4], at: [usize; 4], stencils: [Vec<Stencil>; 4]) -> BankCell {
        let along = stencils.each_ref().map(|stencils| {
            let Stencil { first, weights } = &stencils[0];
            *first..first + weights.len()
        });
        let maps = maps(axes, along);
        BankCell { at, maps, stencils }
    }

    /// The numbers of the maps at its corners.
    pub fn corners(&self, axes: &[BankAxis; 4]) -> Vec<usize> {
        let ends = |axis: usize| {
            let cell = self.at[axis];
            cell..cell + 1 + usize::from(axes[axis].is_free())
        };
        maps(axes, [0, 1, 2, 3].map(ends))
    }

    /// The values at all nodes, those of the first axis first, from the `value` of each map around. `spare` is memory.
    ///
    /// Implements: BNK-030.
    pub fn interpolate(
        &self,
        value: impl Fn(usize) -> f64,
        nodes: &mut Vec<f64>,
        spare: &mut Vec<f64>,
    ) {
        nodes.clear();
        nodes.extend(self.maps.iter().map(|&map| value(map)));
        let mut inner = 1;
        for stencils in &self.stencils {
            let points = stencils[0].weights.len();
            if points == 1 {
                continue;
            }
            spare.clear();
            for block in nodes.chunks_exact(inner * points) {
                for stencil in stencils {
                    for at in 0..inner {
                        let along = block[at..].iter().step_by(inner);
                        let terms = stencil.weights.iter().zip(along);
                        spare.push(terms.map(|(weight, value)| weight * value).sum());
                    }
                }
            }
            std::mem::swap(nodes, spare);
            inner *= stencils.len();
        }
    }
}
