//! Where an inclusion lies, and how large and hard it is, if there is one: the posterior between the points of a bank.

use std::sync::OnceLock;

use super::axis::{BankAxis, BankCell, PRIOR, SIGNAL};
use super::detector::{BankDetector, BankStatistic};
use crate::detect::DetectError;
use crate::detect::nuisance::dot;
use crate::stats::Bounds;
use crate::stats::error::check_probability;

/// The fewest nodes of a cell along an axis, and the most.
const NODES: [usize; 2] = [5, 20];
/// The nodes of a cell, at most: fewer along the axis that has most until they are.
const ALL_NODES: usize = 20_000;
/// Cells whose posterior density is less than e to the minus this of the largest do not count.
const NEGLIGIBLE: f64 = 40.0;
/// Steps of Newton's method to the most likely place.
const STEPS: usize = 8;

/// The cells of a bank.
#[derive(Debug, Clone)]
pub(super) struct Places {
    axes: [BankAxis; 4],
    cells: Vec<BankCell>,
    corners: Vec<Vec<usize>>,
    /// How far (Pδ)ᵀz − |Pδ|²/2 may rise within a cell above that of its corners: a quarter of the squared distance between its corners'
    /// signals, twice what a parabola does.
    rise: Vec<f64>,
    /// What does not depend on the record, of each cell that was wanted.
    nodes: Vec<OnceLock<Nodes>>,
}

/// The nodes of a cell.
#[derive(Debug, Clone)]
struct Nodes {
    /// |Pδ|².
    energy: Vec<f64>,
    /// The prior.
    prior: Vec<f64>,
}

/// The posterior of an inclusion's parameters, given that there is one: uniform before the record between the first and the last point of
/// each axis, or linear between the prior's points.
///
/// Implements: BNK-040.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacePosterior {
    /// The most likely parameters, in the order of [`super::Parameter::ALL`], m and Pa.
    pub estimate: [f64; 4],
    axes: [BankAxis; 4],
    /// The cells that count, and the probability of each of their nodes, cell by cell.
    cells: Vec<[usize; 4]>,
    mass: Vec<f64>,
}

impl Places {
    pub fn new(points: &[Vec<f64>; 4], templates: &[f64], samples: usize) -> Places {
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
        let mut cells = vec![[0; 4]];
        for axis in 0..4 {
            let along = |cell| {
                cells.iter().map(move |&at: &[usize; 4]| {
                    let mut at = at;
                    at[axis] = cell;
                    at
                })
            };
            cells = (0..axes[axis].cells()).flat_map(along).collect();
        }
        let cell = |at| BankCell::new(&axes, at, SIGNAL);
        let cells: Vec<BankCell> = cells.into_iter().map(cell).collect();
        let corners: Vec<Vec<usize>> = cells.iter().map(|cell| cell.corners(&axes)).collect();
        let rise = corners.iter().map(|corners| {
            let from = template(corners[0]);
            let distances = corners.iter().map(|&to| distance(from, template(to)));
            0.25 * distances.fold(0.0, f64::max)
        });
        Places {
            rise: rise.collect(),
            nodes: cells.iter().map(|_| OnceLock::new()).collect(),
            axes,
            cells,
            corners,
        }
    }

    pub fn axes(&self) -> &[BankAxis; 4] {
        &self.axes
    }
}

/// |a − b|².
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b) * (a - b)).sum()
}

impl BankDetector {
    /// Where the inclusion of a record lies, if it has one.
    ///
    /// Implements: BNK-040, BNK-042.
    pub fn place(&self, statistic: &BankStatistic) -> PlacePosterior {
        let places = self.places();
        let (along, squares) = (&statistic.along, statistic.squares);
        let gain = |point: usize| along[point] - 0.5 * self.gamma()[point] * self.gamma()[point];
        // Where the prior of all corners is 0 it is so of the whole cell.
        let top = |corners: &Vec<usize>| {
            let can_be = corners.iter().any(|&corner| self.prior()[corner] > 0.0);
            let gains = corners.iter().map(|&corner| gain(corner));
            can_be.then(|| gains.fold(f64::MIN, f64::max))
        };
        let tops: Vec<Option<f64>> = places.corners.iter().map(top).collect();
        let highest = tops.iter().flatten().copied().fold(f64::MIN, f64::max);
        let least = self.theta(highest, squares) - NEGLIGIBLE;
        let (mut nodes, mut spare) = (Vec::new(), Vec::new());
        let (mut cells, mut mass, mut prior) = (Vec::new(), Vec::new(), Vec::new());
        let mut best = (f64::MIN, [0.0; 4]);
        for (number, cell) in places.cells.iter().enumerate() {
            let Some(top) = tops[number] else {
                continue;
            };
            // No signal explains more than the whole record.
            let most = top + places.rise[number];
            if self.theta(most.min(0.5 * squares), squares) < least {
                continue;
            }
            cell.interpolate(|point| along[point], &mut nodes, &mut spare);
            let of_cell = places.nodes[number].get_or_init(|| self.nodes(cell));
            for (at, (node, energy)) in nodes.iter_mut().zip(&of_cell.energy).enumerate() {
                *node -= 0.5 * energy;
                if *node > best.0 {
                    best = (*node, place_of(&places.axes, cell.at, at));
                }
                *node = self.theta(*node, squares);
            }
            cells.push(cell.at);
            mass.append(&mut nodes);
            prior.extend_from_slice(&of_cell.prior);
        }
        let mut place = PlacePosterior {
            estimate: self.climb(statistic, best.1),
            axes: places.axes.clone(),
            cells,
            mass,
        };
        self.weigh(&mut place, prior);
        place
    }

    /// The energy and the prior at the nodes of a cell.
    fn nodes(&self, cell: &BankCell) -> Nodes {
        let axes = self.places().axes();
        let (mut nodes, mut spare) = (Vec::new(), Vec::new());
        let mut energy = vec![0.0; axes.iter().map(|axis| axis.nodes).product()];
        for sample in 0..self.samples() {
            cell.interpolate(|point| self.template(point)[sample], &mut nodes, &mut spare);
            let pairs = energy.iter_mut().zip(&nodes);
            pairs.for_each(|(energy, value)| *energy += value * value);
        }
        let linear = BankCell::new(axes, cell.at, PRIOR);
        linear.interpolate(|point| self.prior()[point], &mut nodes, &mut spare);
        let sizes = axes.iter().zip(&cell.at).map(|(axis, &at)| axis.size(at));
        let size: f64 = sizes.product();
        Nodes {
            energy,
            prior: nodes.iter().map(|node| size * node).collect(),
        }
    }

    /// Makes probabilities of θ.
    ///
    /// Implements: BNK-040.
    fn weigh(&self, place: &mut PlacePosterior, prior: Vec<f64>) {
        let highest = place.mass.iter().copied().fold(f64::MIN, f64::max);
        for (mass, prior) in place.mass.iter_mut().zip(prior) {
            let below = *mass - highest;
            *mass = match below > -NEGLIGIBLE {
                true => prior * libm::exp(below),
                false => 0.0,
            };
        }
        let whole: f64 = place.mass.iter().sum();
        place.mass.iter_mut().for_each(|mass| *mass /= whole);
    }

    /// The place of the largest (Pδ)ᵀz − |Pδ|²/2 next to `start`, a node of the largest, by Newton's method with differences.
    ///
    /// Implements: BNK-042.
    fn climb(&self, statistic: &BankStatistic, start: [f64; 4]) -> [f64; 4] {
        let axes = self.places().axes();
        let step = [0, 1, 2, 3].map(|axis: usize| {
            let [from, to] = axes[axis].ends(axes[axis].cell(start[axis]));
            (to - from) / axes[axis].nodes as f64
        });
        let gain = |at: [f64; 4]| {
            let template = self.template_at(at);
            dot(&template, &statistic.left) - 0.5 * dot(&template, &template)
        };
        let mut best = (gain(start), start);
        for _ in 0..STEPS {
            let moved = |moves: &[(usize, f64)]| {
                let mut at = best.1;
                moves
                    .iter()
                    .for_each(|&(axis, by)| at[axis] += by * step[axis]);
                gain(at)
            };
            // An axis at whose end it still rises outwards stays there.
            let rises = |axis: usize, by: f64| moved(&[(axis, by)]) > best.0;
            let is_free = |&axis: &usize| {
                let (points, x) = (&axes[axis].points, best.1[axis]);
                let is_first = x <= points[0] && !rises(axis, 0.1);
                let is_last = x >= points[points.len() - 1] && !rises(axis, -0.1);
                axes[axis].is_free() && !is_first && !is_last
            };
            let free: Vec<usize> = (0..4).filter(is_free).collect();
            let mut slope = vec![0.0; free.len()];
            let mut bend = vec![vec![0.0; free.len()]; free.len()];
            for (i, &a) in free.iter().enumerate() {
                let [before, after] = [-1.0, 1.0].map(|by| moved(&[(a, by)]));
                slope[i] = 0.5 * (after - before);
                bend[i][i] = 2.0 * best.0 - before - after;
                for (j, &b) in free.iter().enumerate().take(i) {
                    let corner = |one, other| moved(&[(a, one), (b, other)]);
                    let same = corner(1.0, 1.0) + corner(-1.0, -1.0);
                    let mixed = 0.25 * (corner(1.0, -1.0) + corner(-1.0, 1.0) - same);
                    (bend[i][j], bend[j][i]) = (mixed, mixed);
                }
            }
            // Where it is no peak, along each axis by itself.
            let moves = solution(bend, &slope);
            let moves = moves.unwrap_or_else(|| slope.iter().map(|s| s.signum()).collect());
            // Back half-way while it does not rise.
            let shares = [1.0, 0.5, 0.25].map(|share| {
                let mut next = best.1;
                for (&axis, by) in free.iter().zip(&moves) {
                    let points = &axes[axis].points;
                    let to = next[axis] + share * by * step[axis];
                    next[axis] = to.clamp(points[0], points[points.len() - 1]);
                }
                next
            });
            let mut found = shares.into_iter().map(|next| (gain(next), next));
            match found.find(|next| next.0 > best.0) {
                Some(next) => best = next,
                None => break,
            }
        }
        best.1
    }
}

/// x of A x = b by elimination; `None` unless A is positive definite.
fn solution(mut a: Vec<Vec<f64>>, b: &[f64]) -> Option<Vec<f64>> {
    let (mut b, number) = (b.to_vec(), b.len());
    for column in 0..number {
        let pivot = a[column].clone();
        if pivot[column] <= 0.0 || pivot[column].is_nan() {
            return None;
        }
        for row in column + 1..number {
            let share = a[row][column] / pivot[column];
            a[row]
                .iter_mut()
                .zip(&pivot)
                .for_each(|(a, p)| *a -= share * p);
            b[row] -= share * b[column];
        }
    }
    for row in (0..number).rev() {
        let known: f64 = (row + 1..number)
            .map(|other| a[row][other] * b[other])
            .sum();
        b[row] = (b[row] - known) / a[row][row];
    }
    Some(b)
}

/// The parameters of node `at` of a cell.
fn place_of(axes: &[BankAxis; 4], cell: [usize; 4], mut at: usize) -> [f64; 4] {
    [0, 1, 2, 3].map(|axis: usize| {
        let nodes = axes[axis].nodes;
        let node = at % nodes;
        at /= nodes;
        axes[axis].node(cell[axis], node)
    })
}

impl PlacePosterior {
    /// The number of nodes of a cell.
    fn per_cell(&self) -> usize {
        self.axes.iter().map(|axis| axis.nodes).product()
    }

    /// The parameters of each node that counts, and its probability.
    ///
    /// Implements: BNK-040.
    pub fn nodes(&self) -> impl Iterator<Item = ([f64; 4], f64)> {
        let cells = self
            .cells
            .iter()
            .zip(self.mass.chunks_exact(self.per_cell()));
        cells.flat_map(move |(&cell, mass)| {
            let nodes = mass.iter().enumerate();
            nodes.map(move |(at, &mass)| (place_of(&self.axes, cell, at), mass))
        })
    }

    /// The mean of the posterior: of all estimates that with the least mean square error over what the prior says.
    ///
    /// Implements: BNK-042.
    pub fn mean(&self) -> [f64; 4] {
        let mut mean = [0.0; 4];
        for (at, mass) in self.nodes() {
            for (mean, at) in mean.iter_mut().zip(at) {
                *mean += mass * at;
            }
        }
        mean
    }

    /// The probability of each part between neighbouring nodes' borders along one axis: their upper borders, increasing, and the
    /// probability up to there.
    fn cumulated(&self, axis: usize) -> Vec<[f64; 2]> {
        let along = &self.axes[axis];
        let mut parts = vec![0.0; along.cells() * along.nodes];
        let stride: usize = self.axes[..axis].iter().map(|axis| axis.nodes).product();
        for (cell, mass) in self
            .cells
            .iter()
            .zip(self.mass.chunks_exact(self.per_cell()))
        {
            for (at, mass) in mass.iter().enumerate() {
                parts[cell[axis] * along.nodes + at / stride % along.nodes] += mass;
            }
        }
        let mut sum = 0.0;
        let part = |(part, mass): (usize, f64)| {
            let [from, to] = along.ends(part / along.nodes);
            let share = (part % along.nodes + 1) as f64 / along.nodes as f64;
            sum += mass;
            [from + share * (to - from), sum]
        };
        parts.into_iter().enumerate().map(part).collect()
    }

    /// The probability that the parameter of one axis is at most `x`.
    ///
    /// Implements: BNK-042.
    pub fn at_most(&self, axis: usize, x: f64) -> f64 {
        let mut before = [self.axes[axis].points[0], 0.0];
        for part in self.cumulated(axis) {
            if x < part[0] {
                let share = (x - before[0]) / (part[0] - before[0]);
                return before[1] + share.max(0.0) * (part[1] - before[1]);
            }
            before = part;
        }
        1.0
    }

    /// Bounds on the parameter of one axis, each of which it is beyond with half of 1 − `level`.
    ///
    /// # Errors
    /// A level that is not strictly between 0 and 1.
    ///
    /// Implements: BNK-042.
    pub fn interval(&self, axis: usize, level: f64) -> Result<Bounds, DetectError> {
        check_probability("level", level)?;
        let parts = self.cumulated(axis);
        let point = |p: f64| {
            let mut before = [self.axes[axis].points[0], 0.0];
            for &part in &parts {
                if part[1] >= p {
                    let share = (p - before[1]) / (part[1] - before[1]);
                    return before[0] + share * (part[0] - before[0]);
                }
                before = part;
            }
            before[0]
        };
        let tail = 0.5 * (1.0 - level);
        let [lower, upper] = [tail, 1.0 - tail].map(point);
        Ok(Bounds { lower, upper })
    }

    /// The probability of the places that are more likely than `at`: `at` is in the credible region of a level if this is less.
    ///
    /// Implements: BNK-042.
    pub fn more_likely(&self, at: [f64; 4]) -> f64 {
        let cell = [0, 1, 2, 3].map(|axis: usize| self.axes[axis].cell(at[axis]));
        let mut stride = 1;
        let mut node = 0;
        for (axis, (&cell, x)) in self.axes.iter().zip(cell.iter().zip(at)) {
            let [from, to] = axis.ends(cell);
            let share = if axis.is_free() {
                (x - from) / (to - from)
            } else {
                0.0
            };
            let last = axis.nodes - 1;
            node += stride * ((share * axis.nodes as f64) as usize).min(last);
            stride *= axis.nodes;
        }
        let number = self.cells.iter().position(|of| *of == cell);
        let own = number.map_or(0.0, |number| self.mass[number * self.per_cell() + node]);
        let more = self.mass.iter().filter(|mass| **mass > own);
        more.sum()
    }
}
