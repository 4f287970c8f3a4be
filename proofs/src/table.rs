//! The force of a table: in the hull, at the nodes, on the borders, beyond.

use bolero::generator::bolero_generator;
use bolero::{Driver, TypeGenerator};
use palpate::force::Force;
use palpate::servo::Cell;

use crate::cases::{Fraction, Grid, Position};

/// A table and any place.
#[derive(Debug, Clone)]
struct Place {
    grid: Grid,
    depth: f32,
    lateral: f32,
}

impl TypeGenerator for Place {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let grid = driver.produce()?;
        let (Position(depth), Position(lateral)) = driver.produce()?;
        // As often below the surface as above.
        let below = driver.produce()?;
        Some(Place {
            grid,
            depth: if below { depth.abs() } else { depth },
            lateral,
        })
    }
}

/// The cell whose ends enclose a position, found from the last cell backwards.
fn enclosing(knots: &[f32], position: f32) -> Option<usize> {
    let mut found = None;
    for cell in 0..knots.len() - 1 {
        if knots[cell] <= position && position <= knots[cell + 1] {
            found = Some(cell);
        }
    }
    found
}

fn component(force: Force<f32>, normal: bool) -> f32 {
    if normal { force.normal } else { force.lateral }
}

// Verifies: SRV-010.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(cadical))]
fn force_is_in_the_hull() {
    harness!(Place, |case| {
        let grid = &case.grid;
        let row = enclosing(&grid.depths, case.depth);
        let column = enclosing(&grid.laterals, case.lateral);
        let inside = row.is_some() && column.is_some();
        if let (Some(row), Some(column)) = (row, column) {
            let force = grid.table().force(case.depth, case.lateral);
            let at = |row: usize, column: usize| grid.forces[row * 4 + column];
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            for normal in [false, true] {
                let value = component(force, normal);
                let corner = |force| component(force, normal);
                let (a, b, c, d) = (corner(a), corner(b), corner(c), corner(d));
                assert!(value >= a || value >= b || value >= c || value >= d);
                assert!(value <= a || value <= b || value <= c || value <= d);
            }
        }
        reached! {
            "within the table": inside,
            "in the last row": row == Some(1) && column.is_some(),
            "in the last column": row.is_some() && column == Some(2),
        }
    });
}

/// A table and one of its nodes.
#[derive(Debug, Clone, bolero_generator::TypeGenerator)]
struct Node {
    grid: Grid,
    #[generator(0..3)]
    row: usize,
    #[generator(0..4)]
    column: usize,
}

// Verifies: SRV-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(cadical))]
fn nodes_are_exact() {
    harness!(Node, |case| {
        let &Node { row, column, .. } = case;
        let (depth, lateral) = (case.grid.depths[row], case.grid.laterals[column]);
        let force = case.grid.table().force(depth, lateral);
        assert!(force == case.grid.forces[row * 4 + column]);
        reached! {
            "the surface": row == 0,
            "the last corner": row == 2 && column == 3,
            "a node within": row == 1 && (column == 1 || column == 2),
        }
    });
}

/// A table, and a fraction along its borders.
#[derive(Debug, Clone, bolero_generator::TypeGenerator)]
struct Border {
    grid: Grid,
    along: Fraction,
}

// Verifies: SRV-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(cadical))]
fn adjoining_cells_agree_on_their_border() {
    harness!(Border, |case| {
        let table = case.grid.table();
        let cell = |index, fraction| Cell { index, fraction };
        let Fraction(fraction) = case.along;
        let along = |index| cell(index, fraction);
        // Every border has its own step, with indices that are constants to a solver.
        for column in 0..3 {
            let before = table.force_in(cell(0, 1.0), along(column));
            assert!(before == table.force_in(cell(1, 0.0), along(column)));
        }
        for row in 0..2 {
            for border in 0..2 {
                let before = table.force_in(along(row), cell(border, 1.0));
                assert!(before == table.force_in(along(row), cell(border + 1, 0.0)));
            }
        }
        reached! {
            "within the table": (0.0..=1.0).contains(&fraction),
            "continued": !(0.0..=1.0).contains(&fraction),
        }
    });
}

// Verifies: SRV-013, SRV-014.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(cadical))]
fn force_of_a_table_is_bounded() {
    harness!(Place, |case| {
        let force = case.grid.table().force(case.depth, case.lateral);
        for value in [force.lateral, force.normal] {
            // 9 times the most that a table may hold, and 10⁻⁵ of it.
            assert!(value.abs() <= 900.009);
        }
        if case.depth < 0.0 {
            assert!(force == Force::ZERO);
        }
        reached! {
            "above the surface": case.depth < 0.0,
            "below the table": case.depth > case.grid.depths[2],
            "not finite": !case.depth.is_finite() || !case.lateral.is_finite(),
        }
    });
}

/// The largest entry of a table by magnitude.
fn largest(grid: &Grid) -> f32 {
    let forces = grid.forces.iter().flat_map(|force| force.into_array());
    forces.map(f32::abs).fold(0.0, f32::max)
}

// No Kani proof: what relates products of the entries ends in no solver; Gappa has it.
// Verifies: SRV-012, SRV-013.
#[cfg(not(kani))]
#[test]
fn beyond_one_cell_the_force_is_constant_and_nine_times_an_entry_at_most() {
    harness!(Place, |case| {
        let (grid, table) = (&case.grid, case.grid.table());
        let force = table.force(case.depth, case.lateral);
        let bound = 9.0 * largest(grid) * 1.000_01;
        assert!(force.lateral.abs() <= bound && force.normal.abs() <= bound);

        let beyond = |knots: &[f32], position: f32| {
            let end = knots[knots.len() - 1];
            let width = end - knots[knots.len() - 2];
            position > (end + width) * 1.000_001
        };
        let deep = beyond(&grid.depths, case.depth);
        let right = beyond(&grid.laterals, case.lateral);
        let left = case.lateral < 2.000_001 * grid.laterals[0] - grid.laterals[1];
        let cell = |index, fraction| Cell { index, fraction };
        if deep && (right || left) {
            let side = if left { cell(0, -1.0) } else { cell(2, 2.0) };
            assert!(force == table.force_in(cell(1, 2.0), side));
        }
        reached! {
            "deep and to the right": deep && right,
            "deep and to the left": deep && left,
        }
    });
}

// No Kani proof, for the same reason; Gappa bounds the distance for real numbers.
// Verifies: SRV-010, SRV-012.
#[cfg(not(kani))]
#[test]
fn force_is_near_the_bilinear_form() {
    harness!(Place, |case| {
        let (grid, table) = (&case.grid, case.grid.table());
        let depth = table.depths().locate(case.depth);
        let lateral = table.laterals().locate(case.lateral);
        let force = table.force(case.depth, case.lateral);
        let (s, t) = (f64::from(depth.fraction), f64::from(lateral.fraction));
        let first = depth.index * 4 + lateral.index;
        for normal in [false, true] {
            let at = |index: usize| f64::from(component(grid.forces[index], normal));
            let upper = (1.0 - t) * at(first) + t * at(first + 1);
            let lower = (1.0 - t) * at(first + 4) + t * at(first + 5);
            let exact = (1.0 - s) * upper + s * lower;
            let found = f64::from(component(force, normal));
            // Each of two blends rounds 1 − t, two products and a sum: 3 units of 2⁻²⁴ on each of
            // the terms, whose magnitudes add up to 9 entries at most. And subnormal products.
            let bound = 6.01 / 16_777_216.0 * 9.0 * f64::from(largest(grid)) + 1e-43;
            assert!(case.depth < 0.0 || (found - exact).abs() <= bound);
        }
        let inside = |t: f64| 0.0 < t && t < 1.0;
        let beyond = |t: f64| -1.0 < t && t < 0.0 || 1.0 < t && t < 2.0;
        let below = case.depth > 0.0;
        reached! {
            "within a cell": below && inside(s) && inside(t),
            "continued": below && (beyond(s) || beyond(t)),
        }
    });
}
