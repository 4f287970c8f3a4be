//! The most likely place between the nodes of a bank's cells, by Newton's method with differences.

use nalgebra::{DMatrix, DVector};

use super::axis::BankAxis;
use super::detector::{BankDetector, BankStatistic};
use crate::detect::nuisance::dot;

/// Steps of Newton's method to the most likely place.
const STEPS: usize = 8;

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
            match hill.climb(best) {
                Some(higher) => best = higher,
                None => break,
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

    /// The height beside a point, by so many steps along these axes.
    fn beside(&self, point: Point, moves: &[(usize, f64)]) -> f64 {
        let mut at = point.at;
        for &(axis, by) in moves {
            at[axis] += by * self.step[axis];
        }
        self.point(at).height
    }

    /// Whether one may move along an axis: at whose end it still rises outwards stays there.
    fn is_free(&self, point: Point, axis: usize) -> bool {
        let (points, x) = (&self.axes[axis].points, point.at[axis]);
        let rises = |by: f64| self.beside(point, &[(axis, by)]) > point.height;
        let is_first = x <= points[0] && !rises(0.1);
        let is_last = x >= points[points.len() - 1] && !rises(-0.1);
        self.axes[axis].is_free() && !is_first && !is_last
    }

    /// A higher point by one step of Newton's method, or a half or a quarter of it.
    fn climb(&self, from: Point) -> Option<Point> {
        let free: Vec<usize> = (0..4).filter(|&axis| self.is_free(from, axis)).collect();
        let moves = self.newton(from, &free);
        let points = [1.0, 0.5, 0.25].map(|share| {
            let mut next = from.at;
            for (&axis, by) in free.iter().zip(&moves) {
                let points = &self.axes[axis].points;
                let to = next[axis] + share * by * self.step[axis];
                next[axis] = to.clamp(points[0], points[points.len() - 1]);
            }
            next
        });
        let mut points = points.into_iter().map(|at| self.point(at));
        points.find(|point| point.height > from.height)
    }

    /// The step to the top of the parabola through the points beside, along the free axes; where that has no top, one step upwards along
    /// each.
    fn newton(&self, from: Point, free: &[usize]) -> Vec<f64> {
        let number = free.len();
        let mut slope = DVector::zeros(number);
        let mut bend = DMatrix::zeros(number, number);
        for (i, &a) in free.iter().enumerate() {
            let [before, after] = [-1.0, 1.0].map(|by| self.beside(from, &[(a, by)]));
            slope[i] = 0.5 * (after - before);
            bend[(i, i)] = 2.0 * from.height - before - after;
            for (j, &b) in free.iter().enumerate().take(i) {
                let corner = |one, other| self.beside(from, &[(a, one), (b, other)]);
                let same = corner(1.0, 1.0) + corner(-1.0, -1.0);
                // The lower triangle alone is read.
                bend[(i, j)] = 0.25 * (corner(1.0, -1.0) + corner(-1.0, 1.0) - same);
            }
        }
        let moves = match bend.cholesky() {
            Some(factor) => factor.solve(&slope),
            None => slope.map(f64::signum),
        };
        moves.as_slice().to_vec()
    }
}
