//! Where an inclusion lies, and how large and hard it is, if there is one: the posterior between the points of a bank.

use super::axis::{BankAxis, BankCell, PRIOR, places};
use super::cells::Nodes;
use super::detector::{BankDetector, BankStatistic};
use crate::detect::DetectError;
use crate::force_map::SAME_POSITION;
use crate::robust::PlaceInterval;
use crate::stats::Bounds;
use crate::stats::error::check_probability;
use crate::stats::normal;

/// Cells whose posterior density is less than e to the minus this of the largest do not count.
const NEGLIGIBLE: f64 = 40.0;

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

impl BankDetector {
    /// Where the inclusion of a record lies, if it has one.
    ///
    /// Implements: BNK-040, BNK-042.
    pub fn place(&self, statistic: &BankStatistic) -> PlacePosterior {
        let bank = self.cells();
        let (along, squares) = (&statistic.along, statistic.squares);
        let tops = self.tops(statistic);
        let highest = tops.iter().flatten().copied().fold(f64::MIN, f64::max);
        let least = self.theta(highest, squares) - NEGLIGIBLE;
        let (mut nodes, mut spare) = (Vec::new(), Vec::new());
        let (mut cells, mut mass, mut prior) = (Vec::new(), Vec::new(), Vec::new());
        let mut best = (f64::MIN, [0.0; 4]);
        for (number, cell) in bank.cells.iter().enumerate() {
            // No signal explains more than the whole record.
            let most = tops[number].map(|top| (top + bank.rise[number]).min(0.5 * squares));
            if most.is_none_or(|most| self.theta(most, squares) < least) {
                continue;
            }
            cell.interpolate(|point| along[point], &mut nodes, &mut spare);
            let of_cell = bank.nodes[number].get_or_init(|| self.nodes(cell));
            for (at, (node, energy)) in nodes.iter_mut().zip(&of_cell.energy).enumerate() {
                *node -= 0.5 * energy;
                if *node > best.0 {
                    best = (*node, place_of(&bank.axes, cell.at, at));
                }
                *node = self.theta(*node, squares);
            }
            cells.push(cell.at);
            mass.append(&mut nodes);
            prior.extend_from_slice(&of_cell.prior);
        }
        to_probabilities(&mut mass, &prior);
        PlacePosterior {
            estimate: self.most_likely(statistic, best.1),
            axes: bank.axes.clone(),
            cells,
            mass,
        }
    }

    /// For each cell, the largest (Pδ)ᵀz − |Pδ|²/2 of its corners; none where the prior of all corners is 0, and so that of the whole cell.
    fn tops(&self, statistic: &BankStatistic) -> Vec<Option<f64>> {
        let gain = |point: usize| {
            let gamma = self.gamma()[point];
            statistic.along[point] - 0.5 * gamma * gamma
        };
        let top = |corners: &Vec<usize>| {
            let can_be = corners.iter().any(|&corner| self.prior()[corner] > 0.0);
            let gains = corners.iter().map(|&corner| gain(corner));
            can_be.then(|| gains.fold(f64::MIN, f64::max))
        };
        self.cells().corners.iter().map(top).collect()
    }

    /// The energy and the prior at the nodes of a cell.
    fn nodes(&self, cell: &BankCell) -> Nodes {
        let axes = &self.cells().axes;
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
}

/// Makes probabilities of θ, with the prior of each.
///
/// Implements: BNK-040.
fn to_probabilities(theta: &mut [f64], prior: &[f64]) {
    let highest = theta.iter().copied().fold(f64::MIN, f64::max);
    for (mass, prior) in theta.iter_mut().zip(prior) {
        let below = *mass - highest;
        *mass = if below > -NEGLIGIBLE {
            prior * libm::exp(below)
        } else {
            0.0
        };
    }
    let whole: f64 = theta.iter().sum();
    theta.iter_mut().for_each(|mass| *mass /= whole);
}

/// The parameters of node `at` of a cell.
fn place_of(axes: &[BankAxis; 4], cell: [usize; 4], at: usize) -> [f64; 4] {
    let nodes = places(at, axes.each_ref().map(|axis| axis.nodes));
    [0, 1, 2, 3].map(|axis: usize| axes[axis].node(cell[axis], nodes[axis]))
}

/// The other coordinate of the line between two points where coordinate `known` is `value`; that of the first point before it.
fn between(ends: &[[f64; 2]], known: usize, value: f64) -> f64 {
    let (from, to, other) = (ends[0], ends[1], 1 - known);
    let share = (value - from[known]) / (to[known] - from[known]);
    from[other] + share.max(0.0) * (to[other] - from[other])
}

/// The bounds of [`PlacePosterior::interval`], by the borders of parts along its axis.
fn bounds(parts: &[[f64; 2]], level: f64) -> Result<Bounds, DetectError> {
    check_probability("level", level)?;
    let point = |p: f64| {
        let around = parts.windows(2).find(|ends| ends[1][1] >= p);
        around.map_or(parts[parts.len() - 1][0], |ends| between(ends, 1, p))
    };
    let tail = 0.5 * (1.0 - level);
    let [lower, upper] = [tail, 1.0 - tail].map(point);
    Ok(Bounds { lower, upper })
}

impl PlacePosterior {
    /// The number of nodes of a cell.
    fn per_cell(&self) -> usize {
        self.axes.iter().map(|axis| axis.nodes).product()
    }

    /// The cells that count, each with the probabilities of its nodes.
    fn by_cell(&self) -> impl Iterator<Item = ([usize; 4], &[f64])> {
        let mass = self.mass.chunks_exact(self.per_cell());
        self.cells.iter().copied().zip(mass)
    }

    /// The parameters of each node that counts, and its probability.
    ///
    /// Implements: BNK-040.
    pub fn nodes(&self) -> impl Iterator<Item = ([f64; 4], f64)> {
        self.by_cell().flat_map(move |(cell, mass)| {
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

    /// The borders of neighbouring nodes' parts along one axis, increasing, each with the probability up to there.
    fn cumulated(&self, axis: usize) -> Vec<[f64; 2]> {
        let along = &self.axes[axis];
        let mut parts = vec![0.0; along.cells() * along.nodes];
        let stride: usize = self.axes[..axis].iter().map(|axis| axis.nodes).product();
        for (cell, mass) in self.by_cell() {
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
        let first = [along.points[0], 0.0];
        let parts = parts.into_iter().enumerate().map(part);
        std::iter::once(first).chain(parts).collect()
    }

    /// The probability that the parameter of one axis is at most `x`.
    ///
    /// Implements: BNK-042.
    pub fn at_most(&self, axis: usize, x: f64) -> f64 {
        let parts = self.cumulated(axis);
        let mut ends = parts.windows(2);
        let around = ends.find(|ends| x < ends[1][0]);
        around.map_or(1.0, |ends| between(ends, 0, x))
    }

    /// Bounds on the parameter of one axis, each of which it is beyond with half of 1 − `level`.
    ///
    /// # Errors
    /// A level that is not strictly between 0 and 1.
    ///
    /// Implements: BNK-042.
    pub fn interval(&self, axis: usize, level: f64) -> Result<Bounds, DetectError> {
        bounds(&self.cumulated(axis), level)
    }

    /// The estimate and the ends of the interval to show, which hold it. An end is missing where the bank's own is not excluded: it is the
    /// estimate, or its density is that of a place which the ratio of likelihoods keeps at this level. The tails of
    /// [`PlacePosterior::interval`] would leave out an inclusion that lies at an end of the bank.
    ///
    /// # Errors
    /// As [`PlacePosterior::interval`].
    ///
    /// Implements: CLI-153.
    pub fn ends(&self, axis: usize, level: f64) -> Result<PlaceInterval, DetectError> {
        let (estimate, parts) = (self.estimate[axis], self.cumulated(axis));
        let Bounds { lower, upper } = bounds(&parts, level)?;
        let density = |ends: &[[f64; 2]]| (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0]);
        let densities: Vec<f64> = parts.windows(2).map(density).collect();
        let largest = densities.iter().copied().fold(0.0, f64::max);
        let z = normal::quantile(0.5 + 0.5 * level)?;
        let kept = largest * libm::exp(-0.5 * z * z);
        let is_excluded = |end: [f64; 2], density: f64| {
            (end[0] - estimate).abs() > SAME_POSITION && density < kept
        };
        let last = densities.len() - 1;
        Ok(PlaceInterval {
            estimate,
            lower: is_excluded(parts[0], densities[0]).then_some(lower.min(estimate)),
            upper: is_excluded(parts[last + 1], densities[last]).then_some(upper.max(estimate)),
        })
    }
}
