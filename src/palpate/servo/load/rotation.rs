//! What a table gives out on a closed path because its forces have no potential, and its largest force.

use crate::force::Force;
use crate::servo::Table;

/// A cell of a table between two depths and two lateral positions.
struct Cell {
    /// m.
    height: f64,
    /// m.
    width: f64,
    /// The largest work, J, around any part of the cell, in the one sense and in the other.
    work: [f64; 2],
}

impl Cell {
    /// The force on the hand is (F_x, −F_n) along (x, d): by Stokes the work around a part is the integral of
    /// ∂F_x/∂d + ∂F_n/∂x, which is linear in the cell and has its extremes at the corners.
    fn new(depths: [f32; 2], laterals: [f32; 2], forces: [[Force<f32>; 2]; 2]) -> Cell {
        let difference = |a: f32, b: f32| f64::from(b) - f64::from(a);
        let [height, width] = [depths, laterals].map(|[a, b]| difference(a, b));
        let [above, below] = forces;
        let by_depth = [0, 1].map(|k| difference(above[k].lateral, below[k].lateral) / height);
        let by_lateral = forces.map(|[a, b]| difference(a.normal, b.normal) / width);
        let mut work = [0.0f64; 2];
        for a in by_depth {
            for b in by_lateral {
                let around = (a + b) * height * width;
                work = [work[0].max(around), work[1].max(-around)];
            }
        }
        Cell {
            height,
            width,
            work,
        }
    }
}

/// The friction, N, that takes what any closed path gains between the sides of the table, from the surface to the end of the
/// cells by which it is continued; where the force jumps at the surface, by as much more.
///
/// A path is made of loops that do not cross themselves. One within a box of the size w × h is 2 (w + h) long at least, along the two
/// axes, and gains no more than the work around the cells of the box in its sense.
///
/// Implements: SRV-053.
pub fn rotation(table: &Table) -> f64 {
    let (depths, laterals) = (table.depths().knots(), table.laterals().knots());
    let row = |row: usize| {
        let ends = [row, row + 1].map(|k| continued(depths, k));
        let cell = |sides: &[f32]| {
            let sides = [sides[0], sides[1]];
            let forces = ends.map(|depth| sides.map(|lateral| table.continued(depth, lateral)));
            Cell::new(ends, sides, forces)
        };
        laterals.windows(2).map(cell).collect()
    };
    let rows: Vec<Vec<Cell>> = (1..=depths.len()).map(row).collect();
    let first = table.forces().iter().take(laterals.len());
    let jump = first.map(|force| libm::hypot(force.lateral.into(), force.normal.into()));
    worst(&rows, 0).max(worst(&rows, 1)) + jump.fold(0.0, f64::max)
}

/// The largest work over way of all boxes, by Dinkelbach's method: the box that is worst for one ratio has a larger one, until
/// none has.
fn worst(rows: &[Vec<Cell>], sense: usize) -> f64 {
    let mut ratio = 0.0;
    loop {
        let (work, way) = worst_box(rows, sense, ratio);
        // A hair more than the ratio is rounding.
        if work <= ratio * way * (1.0 + 1e-12) {
            return ratio;
        }
        ratio = work / way;
    }
}

/// Work and way of the box in which work − ratio · way is largest, by Kadane's method along each group of rows.
fn worst_box(rows: &[Vec<Cell>], sense: usize, ratio: f64) -> (f64, f64) {
    let excess = |(work, way): (f64, f64)| work - ratio * way;
    let mut worst = (0.0, 0.0);
    for first in 0..rows.len() {
        let mut work = vec![0.0; rows[first].len()];
        let mut height = 0.0;
        for row in &rows[first..] {
            height += row[0].height;
            let mut run = (0.0, 0.0);
            for (work, cell) in work.iter_mut().zip(row) {
                *work += cell.work[sense];
                if excess(run) < 0.0 {
                    run = (0.0, 0.0);
                }
                run = (run.0 + *work, run.1 + 2.0 * cell.width);
                let found = (run.0, run.1 + 2.0 * height);
                if excess(found) > excess(worst) {
                    worst = found;
                }
            }
        }
    }
    worst
}

/// The largest component of any force of a table and of its continued cells, N.
pub(super) fn largest_component(table: &Table) -> f64 {
    let (depths, laterals) = (table.depths().knots(), table.laterals().knots());
    let mut largest = 0.0f64;
    for row in 1..=depths.len() + 1 {
        for column in 0..=laterals.len() + 1 {
            let force = table.continued(continued(depths, row), continued(laterals, column));
            for component in [force.lateral, force.normal] {
                largest = f64::from(component.abs()).max(largest);
            }
        }
    }
    largest
}

/// The knots with one more on each side, as far away as the next: 0 is the one in front.
fn continued(knots: &[f32], index: usize) -> f32 {
    let knot = |index: usize| knots.get(index).copied().unwrap_or_default();
    let mirrored = |end: f32, inner: f32| 2.0 * end - inner;
    match index {
        0 => mirrored(knot(0), knot(1)),
        _ if index > knots.len() => {
            let last = knots.len().saturating_sub(1);
            mirrored(knot(last), knot(last.saturating_sub(1)))
        }
        _ => knot(index - 1),
    }
}
