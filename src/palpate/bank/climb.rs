//! The most likely place between the nodes of a bank's cells, by the method of Levenberg and Marquardt.

use nalgebra::{DMatrix, DVector};

use super::axis::BankAxis;
use super::detector::{BankDetector, BankStatistic};
use crate::detect::nuisance::dot;

/// Steps to the most likely place, at most, and how little a step may gain for the last one to be it.
const STEPS: usize = 50;
const GAIN: f64 = 1e-10;
/// Half the distance over which the slope of a signal is a difference, over that of two nodes.
const NEAR: f64 = 0.01;
/// What is added to the curvature along each axis, over it, until a step leads upwards.
const DAMPINGS: [f64; 9] = [0.0, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e6];

/// (Pδ)ᵀz − |Pδ|²/2 over the parameters of a bank.
struct Hill<'a> {
    detector: &'a BankDetector,
    /// Pz.
    left: &'a [f64],
    axes: &'a [BankAxis; 4],
    /// The distance of two nodes on each axis.
    step: [f64; 4],
}

/// A place and its height.
#[derive(Clone, Copy)]
struct Point {
    height: f64,
    at: [f64; 4],
}

impl BankDetector {
    /// The place of the largest (Pδ)ᵀz − |Pδ|²/2 next to `start`, a node of the largest.
    ///
    /// Implements: BNK-042.
    pub(super) fn most_likely(&self, statistic: &BankStatistic, start: [f64; 4]) -> [f64; 4] {
        let axes = &self.cells().axes;
        let step = [0, 1, 2, 3].map(|axis: usize| {
            let [from, to] = axes[axis].ends(axes[axis].cell(start[axis]));
            (to - from) / axes[axis].nodes as f64
        });
        let hill = Hill {
            detector: self,
            left: &statistic.left,
            axes,
            step,
        };
        let mut best = hill.point(start);
        for _ in 0..STEPS {
            let Some(higher) = hill.climb(best) else {
                break;
            };
            let gain = higher.height - best.height;
            best = higher;
            if gain < GAIN {
                break;
            }
        }
        best.at
    }
}

impl Hill<'_> {
    fn point(&self, at: [f64; 4]) -> Point {
        let template = self.detector.template_at(at);
        let height = dot(&template, self.left) - 0.5 * dot(&template, &template);
        Point { height, at }
    }

    /// The place beside another, by so many steps along an axis.
    fn beside(&self, point: Point, axis: usize, by: f64) -> [f64; 4] {
        let mut at = point.at;
        at[axis] += by * self.step[axis];
        at
    }

    /// Whether one may move along an axis: at whose end it still rises outwards stays there.
    fn is_free(&self, point: Point, axis: usize) -> bool {
        let (points, x) = (&self.axes[axis].points, point.at[axis]);
        let rises = |by: f64| self.point(self.beside(point, axis, by)).height > point.height;
        let is_first = x <= points[0] && !rises(0.1);
        let is_last = x >= points[points.len() - 1] && !rises(-0.1);
        self.axes[axis].is_free() && !is_first && !is_last
    }

    /// A higher point within the bank: with J the slopes of Pδ along the free axes, a step (JᵀJ + λ diag JᵀJ)⁻¹ Jᵀ(Pz − Pδ) with the
    /// least λ that leads upwards.
    fn climb(&self, from: Point) -> Option<Point> {
        let free: Vec<usize> = (0..4).filter(|&axis| self.is_free(from, axis)).collect();
        let slope = |axis: usize| -> Vec<f64> {
            let [before, after] =
                [-NEAR, NEAR].map(|by| self.detector.template_at(self.beside(from, axis, by)));
            let pairs = after.iter().zip(&before);
            pairs.map(|(a, b)| (a - b) / (2.0 * NEAR)).collect()
        };
        let slopes: Vec<Vec<f64>> = free.iter().map(|&axis| slope(axis)).collect();
        let template = self.detector.template_at(from.at);
        let rest = self
            .left
            .iter()
            .zip(&template)
            .map(|(z, signal)| z - signal);
        let rest: Vec<f64> = rest.collect();
        let rise = DVector::from_iterator(free.len(), slopes.iter().map(|of| dot(of, &rest)));
        let bend = |i: usize, j: usize| dot(&slopes[i], &slopes[j]);
        let bend = DMatrix::from_fn(free.len(), free.len(), bend);
        DAMPINGS.into_iter().find_map(|damping| {
            let mut damped = bend.clone();
            damped.set_diagonal(&((1.0 + damping) * bend.diagonal()));
            let moves = damped.cholesky()?.solve(&rise);
            let mut at = from.at;
            for (&axis, by) in free.iter().zip(&moves) {
                let points = &self.axes[axis].points;
                let to = at[axis] + by * self.step[axis];
                at[axis] = to.clamp(points[0], points[points.len() - 1]);
            }
            let next = self.point(at);
            (next.height > from.height).then_some(next)
        })
    }
}
