//! The force of a table: in the hull, at the nodes, on the borders, beyond.

use bolero::{Driver, TypeGenerator};
use palpate_core::servo::{Cell, blend};

use crate::cases::{Entry, Fraction, Grid, near};

/// A table and any place.
#[derive(Debug, Clone)]
struct Place<const AXES: usize, const NORMAL: bool> {
    grid: Grid<AXES, NORMAL>,
    depth: f32,
    lateral: f32,
}

impl<const AXES: usize, const NORMAL: bool> TypeGenerator for Place<AXES, NORMAL> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let grid = driver.produce()?;
        let depth = near(driver, Grid::<AXES, NORMAL>::DEPTHS)?;
        let lateral = near(driver, Grid::<AXES, NORMAL>::LATERALS)?;
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

/// Within the hull of the corners, in the rows from `$row` on to the next.
macro_rules! hull {
    ($name:ident, $axes:literal, $normal:literal, $row:literal) => {
        // Verifies: SRV-010.
        #[test]
        #[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(minisat))]
        fn $name() {
            harness!(Place<$axes, $normal>, |case| {
                type G = Grid<$axes, $normal>;
                let (low, high) = (G::DEPTHS[$row], G::DEPTHS[$row + 1]);
                let column = enclosing(&G::LATERALS, case.lateral);
                let in_row = low <= case.depth && case.depth <= high;
                if let (true, Some(column)) = (in_row, column) {
                    let value = G::component(case.grid.table().force(case.depth, case.lateral));
                    let at = |row: usize, column: usize| case.grid.values[row * 4 + column];
                    let (a, b) = (at($row, column), at($row, column + 1));
                    let (c, d) = (at($row + 1, column), at($row + 1, column + 1));
                    assert!(value >= a || value >= b || value >= c || value >= d);
                    assert!(value <= a || value <= b || value <= c || value <= d);
                }
                reached! {
                    "within the row": in_row && column.is_some(),
                    "elsewhere": !in_row || column.is_none(),
                }
            });
        }
    };
}
hull!(force_is_in_the_hull_map_lateral_0, 0, false, 0);
hull!(force_is_in_the_hull_map_lateral_1, 0, false, 1);
hull!(force_is_in_the_hull_map_normal_0, 0, true, 0);
hull!(force_is_in_the_hull_map_normal_1, 0, true, 1);
hull!(force_is_in_the_hull_narrow_lateral_0, 1, false, 0);
hull!(force_is_in_the_hull_narrow_lateral_1, 1, false, 1);
hull!(force_is_in_the_hull_narrow_normal_0, 1, true, 0);
hull!(force_is_in_the_hull_narrow_normal_1, 1, true, 1);
hull!(force_is_in_the_hull_exact_lateral_0, 2, false, 0);
hull!(force_is_in_the_hull_exact_lateral_1, 2, false, 1);
hull!(force_is_in_the_hull_exact_normal_0, 2, true, 0);
hull!(force_is_in_the_hull_exact_normal_1, 2, true, 1);

/// The table's entry at a node that is chosen by its number: one force, whichever it is.
macro_rules! nodes {
    ($name:ident, $axes:literal, $normal:literal) => {
        // Verifies: SRV-011.
        #[test]
        #[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(minisat))]
        fn $name() {
            harness!((Grid<$axes, $normal>, u8), |case| {
                type G = Grid<$axes, $normal>;
                let (grid, node) = case;
                let (row, column) = (usize::from(node % 4).min(2), usize::from(node / 64));
                let force = grid.table().force(G::DEPTHS[row], G::LATERALS[column]);
                assert!(G::component(force) == grid.values[row * 4 + column]);
                reached! {
                    "the first corner": row == 0 && column == 0,
                    "the last corner": row == 2 && column == 3,
                    "a node inside": row == 1 && column == 1,
                }
            });
        }
    };
}
nodes!(nodes_are_exact_map_lateral, 0, false);
nodes!(nodes_are_exact_map_normal, 0, true);
nodes!(nodes_are_exact_narrow_lateral, 1, false);
nodes!(nodes_are_exact_narrow_normal, 1, true);
nodes!(nodes_are_exact_exact_lateral, 2, false);
nodes!(nodes_are_exact_exact_normal, 2, true);

/// Whether the cells on both sides of each border give the same force at a fraction along it.
fn agree_on_borders<const AXES: usize, const NORMAL: bool>(
    grid: &Grid<AXES, NORMAL>,
    fraction: f32,
) {
    let table = grid.table();
    let cell = |index, fraction| Cell { index, fraction };
    let along = |index| cell(index, fraction);
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
}

/// At a border both cells blend to the node there, so that they blend along it between equal forces.
// Verifies: SRV-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(minisat))]
fn adjoining_cells_meet_in_the_nodes_of_their_border() {
    harness!((Entry, Entry, Entry), |case| {
        let &(Entry(before), Entry(node), Entry(after)) = case;
        assert!(blend(before, node, 1.0) == node && blend(node, after, 0.0) == node);
        reached! {
            "a force": node != 0.0,
            "a force between larger ones": before > node && node < after,
        }
    });
}

// No Kani proof: two symbolic products, which must be found to be the same, end in no solver. That above is their lemma.
// Verifies: SRV-011.
#[cfg(not(kani))]
#[test]
fn adjoining_cells_agree_at_any_fraction() {
    harness!((Grid<0, true>, Fraction), |case| {
        let (grid, Fraction(fraction)) = case;
        agree_on_borders(grid, *fraction);
        reached! {
            "within the table": (0.0..=1.0).contains(fraction),
            "continued": !(0.0..=1.0).contains(fraction),
        }
    });
}

/// Bounded, and zero above the surface.
macro_rules! bounded {
    ($name:ident, $axes:literal, $normal:literal) => {
        // Verifies: SRV-013, SRV-014.
        #[test]
        #[cfg_attr(kani, kani::proof, kani::unwind(14), kani::solver(minisat))]
        fn $name() {
            harness!(Place<$axes, $normal>, |case| {
                type G = Grid<$axes, $normal>;
                let value = G::component(case.grid.table().force(case.depth, case.lateral));
                // 9 times the most that a table may hold, and 10⁻⁵ of it.
                assert!(value.abs() <= 900.009);
                if case.depth < 0.0 {
                    assert!(value == 0.0);
                }
                reached! {
                    "above the surface": case.depth < 0.0,
                    "below the table": case.depth > G::DEPTHS[2],
                    "not finite": !case.depth.is_finite() || !case.lateral.is_finite(),
                }
            });
        }
    };
}
bounded!(force_of_a_table_is_bounded_map_lateral, 0, false);
bounded!(force_of_a_table_is_bounded_map_normal, 0, true);
bounded!(force_of_a_table_is_bounded_narrow_lateral, 1, false);
bounded!(force_of_a_table_is_bounded_narrow_normal, 1, true);
bounded!(force_of_a_table_is_bounded_exact_lateral, 2, false);
bounded!(force_of_a_table_is_bounded_exact_normal, 2, true);

/// The largest entry of a table by magnitude.
fn largest(values: &[f32; 12]) -> f32 {
    values.iter().map(|value| value.abs()).fold(0.0, f32::max)
}

// No Kani proof: what relates products of the entries ends in no solver; Gappa has it.
macro_rules! beyond {
    ($name:ident, $axes:literal, $normal:literal) => {
        // Verifies: SRV-012, SRV-013.
        #[cfg(not(kani))]
        #[test]
        fn $name() {
            harness!(Place<$axes, $normal>, |case| {
                type G = Grid<$axes, $normal>;
                let table = case.grid.table();
                let force = table.force(case.depth, case.lateral);
                let bound = 9.0 * largest(&case.grid.values) * 1.000_01;
                assert!(G::component(force).abs() <= bound);

                let beyond = |knots: &[f32], position: f32| {
                    let end = knots[knots.len() - 1];
                    let width = end - knots[knots.len() - 2];
                    position > (end + width) * 1.000_001
                };
                let deep = beyond(&G::DEPTHS, case.depth);
                let right = beyond(&G::LATERALS, case.lateral);
                let left = case.lateral < 2.000_001 * G::LATERALS[0] - G::LATERALS[1];
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
    };
}
beyond! { beyond_one_cell_the_force_is_constant_and_nine_times_an_entry_at_most_map, 0, true }
beyond! { beyond_one_cell_the_force_is_constant_and_nine_times_an_entry_at_most_narrow, 1, false }
beyond! { beyond_one_cell_the_force_is_constant_and_nine_times_an_entry_at_most_exact, 2, true }

// No Kani proof, for the same reason; Gappa bounds the distance for real numbers.
macro_rules! bilinear {
    ($name:ident, $axes:literal, $normal:literal) => {
        // Verifies: SRV-010, SRV-012.
        #[cfg(not(kani))]
        #[test]
        fn $name() {
            harness!(Place<$axes, $normal>, |case| {
                type G = Grid<$axes, $normal>;
                let table = case.grid.table();
                let depth = table.depths().locate(case.depth);
                let lateral = table.laterals().locate(case.lateral);
                let (s, t) = (f64::from(depth.fraction), f64::from(lateral.fraction));
                let first = depth.index * 4 + lateral.index;
                let at = |index: usize| f64::from(case.grid.values[index]);
                let upper = (1.0 - t) * at(first) + t * at(first + 1);
                let lower = (1.0 - t) * at(first + 4) + t * at(first + 5);
                let exact = (1.0 - s) * upper + s * lower;
                let found = f64::from(G::component(table.force(case.depth, case.lateral)));
                // Each of two blends rounds 1 − t, two products and a sum: 3 units of 2⁻²⁴ on each of
                // the terms, whose magnitudes add up to 9 entries at most. And subnormal products.
                let largest = f64::from(largest(&case.grid.values));
                let bound = 6.01 / 16_777_216.0 * 9.0 * largest + 1e-43;
                assert!(case.depth < 0.0 || (found - exact).abs() <= bound);
                let inside = |t: f64| 0.0 < t && t < 1.0;
                let beyond = |t: f64| -1.0 < t && t < 0.0 || 1.0 < t && t < 2.0;
                let below = case.depth > 0.0;
                reached! {
                    "within a cell": below && inside(s) && inside(t),
                    "continued": below && (beyond(s) || beyond(t)),
                }
            });
        }
    };
}
bilinear!(force_is_near_the_bilinear_form_map, 0, true);
bilinear!(force_is_near_the_bilinear_form_narrow, 1, false);
bilinear!(force_is_near_the_bilinear_form_exact, 2, true);
