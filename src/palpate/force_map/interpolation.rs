//! Forces between the poses of a table, and beyond them (paper §4; `spec/force-map.md`, `spec/trace.md`).

use super::{ForceTable, Matrix, SAME_POSITION};
use crate::decimal::mm;
use crate::force::Force;
use crate::refusal::Refusal;

/// Where a position lies on an axis: between two entries, or at one that then stands twice.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub entries: [usize; 2],
    /// Weight of the second entry; the first has the rest.
    pub fraction: f64,
}

impl Place {
    /// The place of `position` (m) on an increasing axis of at least two entries, whose border cells are continued. `None` where it has
    /// no meaning.
    fn continued(axis: &[f64], position: f64) -> Option<Place> {
        let next = axis.partition_point(|&entry| entry <= position);
        Place::before(axis, next.clamp(1, axis.len() - 1), position)
    }

    /// The place of `position` (m) on an increasing axis: within [`SAME_POSITION`] of an entry that entry, and `None` beyond the ends.
    pub fn within(axis: &[f64], position: f64) -> Option<Place> {
        // The first entry that is the position or lies beyond it.
        let next = axis.partition_point(|&entry| entry < position - SAME_POSITION);
        if *axis.get(next)? <= position + SAME_POSITION {
            let (entries, fraction) = ([next; 2], 0.0);
            return Some(Place { entries, fraction });
        }
        Place::before(axis, next, position)
    }

    /// The place in the cell before entry `next`. `None` if there is none, or it is wider than the largest number, so that no fraction
    /// has a meaning.
    fn before(axis: &[f64], next: usize, position: f64) -> Option<Place> {
        let index = next.checked_sub(1)?;
        let (start, end) = (axis[index], axis[next]);
        let (entries, fraction) = ([index, next], (position - start) / (end - start));
        let place = Place { entries, fraction };
        (end - start).is_finite().then_some(place)
    }

    /// (1 − t) a + t b of the values at the two entries: a at t = 0 and b at t = 1 to the bit.
    fn blend(self, value: impl Fn(usize) -> f64) -> f64 {
        let [a, b] = self.entries.map(value);
        (1.0 - self.fraction) * a + self.fraction * b
    }
}

/// Neighbouring points of an axis, with their weights.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stencil {
    pub first: usize,
    pub weights: Vec<f64>,
}

impl Stencil {
    /// At most `most` `points` around a cell, with the weights of Lagrange's polynomial at `x`.
    ///
    /// Implements: BNK-030, MAP-090.
    pub fn around(points: &[f64], cell: usize, x: f64, most: usize) -> Stencil {
        let number = points.len().min(most);
        let first = cell.saturating_sub(most / 2 - 1);
        let first = first.min(points.len() - number);
        let points = &points[first..first + number];
        let weight = |own: usize| {
            let others = (0..number).filter(|&other| other != own);
            let factor = |other: usize| (x - points[other]) / (points[own] - points[other]);
            others.map(factor).product()
        };
        Stencil {
            first,
            weights: (0..number).map(weight).collect(),
        }
    }

    /// The rows that stand for a `depth` (m), within [`SAME_POSITION`] of one that row alone, and none above a row at 0. `None` beyond the
    /// ends.
    ///
    /// Implements: MAP-090.
    pub fn of_rows(depths: &[f64], depth: f64) -> Option<Stencil> {
        if depth < *depths.first()? - SAME_POSITION && depth > shallowest(depths) {
            let (first, weights) = (0, Vec::new());
            return Some(Stencil { first, weights });
        }
        let Place { entries, .. } = Place::within(depths, depth)?;
        if entries[0] == entries[1] {
            let (first, weights) = (entries[0], vec![1.0]);
            return Some(Stencil { first, weights });
        }
        Some(Stencil::around(depths, entries[0], depth, ROWS))
    }

    /// Σ of the weights times the values of the points.
    pub fn blend(&self, value: impl Fn(usize) -> f64) -> f64 {
        let values = (self.first..).map(value);
        self.weights
            .iter()
            .zip(values)
            .map(|(w, value)| w * value)
            .sum()
    }
}

/// The least depth of which rows tell the forces, m: there is none above a row at 0, where there is no force.
///
/// Implements: MAP-090.
pub(crate) fn shallowest(depths: &[f64]) -> f64 {
    match depths[0] {
        0.0 => f64::NEG_INFINITY,
        first => first,
    }
}

/// The rows whose polynomial stands for the forces between them, at most.
///
/// Implements: MAP-090, MAP-091.
const ROWS: usize = 4;

impl ForceTable {
    /// The force on the probe at a pose (m), N, by the bilinear form of its cell; outside the table, by that of the
    /// nearest border cell, continued.
    ///
    /// # Errors
    /// A pose that is not finite; an axis with a single entry; a force beyond the range of f64; as [`ForceTable::both`].
    ///
    /// Implements: MAP-060, MAP-061.
    pub fn force(&self, depth: f64, lateral: f64) -> Result<Force<f64>, Refusal> {
        for (key, value) in [("depth", depth), ("lateral position", lateral)] {
            if !value.is_finite() {
                return Err(Refusal::value(key, value, "a finite number of metres"));
            }
        }
        for (key, axis) in [("depths_m", self.depths()), ("laterals_m", self.laterals())] {
            if axis.len() < 2 {
                let found = format!("{key} has a single entry");
                return Err(Refusal::state(
                    found,
                    "give at least two to interpolate between",
                ));
            }
        }
        let value = |matrix: &Matrix| {
            let value = interpolate(self.depths(), self.laterals(), matrix, depth, lateral);
            value.ok_or_else(|| {
                let pose = format!("the depth {depth} m, {lateral} m lateral");
                let found = format!("the force at {pose}, is beyond the range of numbers");
                Refusal::state(found, "")
            })
        };
        let Force { lateral, normal } = self.both()?.map(value);
        Ok(Force::new(lateral?, normal?))
    }

    /// The forces on the probe at `depth` (m) and each of `positions` (m, in any order), N, no lateral ones if the table has none: linear
    /// in the depth between two rows, then linear in the position between two columns. A row within
    /// [`SAME_POSITION`] of the depth, and a column within it of a position, count to the bit.
    ///
    /// # Errors
    /// A depth or position outside the table: nothing is extrapolated.
    ///
    /// Implements: TRC-021, TRC-024.
    pub fn sweep(&self, depth: f64, positions: &[f64]) -> Result<Force<Vec<f64>>, Refusal> {
        let row = placed("depth", self.depths(), depth, Place::within)?;
        let columns = self.columns(positions)?;
        let along = |matrix: &Matrix| {
            let force =
                |column: &Place| column.blend(|column| row.blend(|row| matrix.row(row)[column]));
            columns.iter().map(force).collect()
        };
        Ok(Force {
            lateral: self.lateral().map_or(Vec::new(), along),
            normal: along(self.normal()),
        })
    }

    /// The forces on the probe along a path, at each of `positions` (m) at its own of `depths` (m), N: on the polynomial through the four
    /// nearest rows, linear in the position between two columns. The rest is as in [`ForceTable::sweep`].
    ///
    /// # Errors
    /// As [`ForceTable::sweep`].
    ///
    /// Implements: MAP-090, TRC-024.
    pub fn path(&self, depths: &[f64], positions: &[f64]) -> Result<Force<Vec<f64>>, Refusal> {
        let row = |&depth: &f64| placed("depth", self.depths(), depth, Stencil::of_rows);
        let rows = depths.iter().map(row).collect::<Result<Vec<_>, _>>()?;
        let columns = self.columns(positions)?;
        let along = |matrix: &Matrix| {
            let places = columns.iter().zip(&rows);
            let force = |(column, rows): (&Place, &Stencil)| {
                column.blend(|column| rows.blend(|row| matrix.row(row)[column]))
            };
            places.map(force).collect()
        };
        Ok(Force {
            lateral: self.lateral().map_or(Vec::new(), along),
            normal: along(self.normal()),
        })
    }

    /// The places of `positions` between the columns.
    fn columns(&self, positions: &[f64]) -> Result<Vec<Place>, Refusal> {
        let column = |&x: &f64| placed("lateral position", self.laterals(), x, Place::within);
        positions.iter().map(column).collect()
    }
}

/// The place of a position (m) on an axis.
///
/// # Errors
/// It has none.
fn placed<P>(
    name: &str,
    axis: &[f64],
    position: f64,
    find: impl Fn(&[f64], f64) -> Option<P>,
) -> Result<P, Refusal> {
    find(axis, position).ok_or_else(|| {
        let [position, first, last] = [position, axis[0], axis[axis.len() - 1]].map(mm);
        let map = format!("the map, which has {first} to {last} mm");
        Refusal::state(format!("{name} {position} mm is outside {map}"), "")
    })
}

/// The entry of `matrix` at a pose (m), by the bilinear form of its cell; outside the axes (m, at
/// least two entries each, increasing; as many as the matrix has rows and columns), by that of the
/// nearest border cell, continued. `None` if it is beyond the range of f64.
///
/// Implements: MAP-060, MAP-061.
pub fn interpolate(
    depths: &[f64],
    laterals: &[f64],
    matrix: &Matrix,
    depth: f64,
    lateral: f64,
) -> Option<f64> {
    let row = Place::continued(depths, depth)?;
    let column = Place::continued(laterals, lateral)?;
    let value = row.blend(|row| column.blend(|column| matrix.row(row)[column]));
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force_map::tests::table_of;
    use palpate_asserts::{assert_error, assert_near};

    /// Bilinear forces on axes of uneven steps, all exact in binary.
    fn table() -> ForceTable {
        let normal = |d: f64, x: f64| 3.0 + 2.0 * d - x + 4.0 * d * x;
        let force = |d, x| [-normal(x, d), normal(d, x)];
        table_of(&[0.0, 0.5, 2.0], &[-1.0, 0.25, 1.0], force)
    }

    // Verifies: MAP-060.
    #[test]
    fn a_bilinear_force_is_continued_without_end() {
        // Weights add up to at most 87 · 85, on forces up to 15 N, with some 6 roundings.
        let tolerance = 87.0 * 85.0 * 15.0 * 6.0 * f64::EPSILON / 2.0;
        let table = table();
        for depth in [-2.0, 0.0, 0.125, 0.5, 1.25, 2.0, 64.0] {
            for lateral in [-32.0, -1.0, -0.375, 0.25, 0.625, 1.0, 4.0] {
                let force = table.force(depth, lateral).unwrap();
                let expected = 3.0 + 2.0 * depth - lateral + 4.0 * depth * lateral;
                assert_near(force.normal, expected, tolerance);
                let expected = -(3.0 + 2.0 * lateral - depth + 4.0 * depth * lateral);
                assert_near(force.lateral, expected, tolerance);
            }
        }
    }

    // Verifies: MAP-060.
    #[test]
    fn outside_the_border_cell_is_continued_not_the_whole_table() {
        // 0, 1 and 5 N.
        let force = |_, x: f64| [0.0, x + 1.5 * x * (x - 1.0)];
        let table = table_of(&[0.0, 1.0], &[0.0, 1.0, 2.0], force);
        for (lateral, expected) in [(-1.0, -1.0), (0.5, 0.5), (1.5, 3.0), (2.0, 5.0), (3.0, 9.0)] {
            assert_eq!(table.force(0.5, lateral).unwrap().normal, expected);
        }
    }

    // Verifies: MAP-061.
    #[test]
    fn poses_and_tables_without_an_answer_are_refused() {
        let table = table();
        let refused = |depth, lateral| table.force(depth, lateral).unwrap_err().to_string();
        assert!(refused(f64::NAN, 0.0).starts_with("depth = NaN"));
        assert!(refused(0.0, f64::INFINITY).starts_with("lateral position = inf"));
        assert!(refused(1e200, 1e200).contains("beyond"));
        // A cell whose width is infinite would make every fraction 0.
        let table = |depths: &[f64], laterals: &[f64]| table_of(depths, laterals, |d, _| [d, 1.0]);
        let wide = table(&[0.0, 1.0], &[-1e308, 1e308]);
        assert!(wide.force(0.0, 1e307).is_err());
        for (single, axis) in [
            (table(&[0.0], &[0.0, 1.0]), "depths_m"),
            (table(&[0.0, 1.0], &[0.0]), "laterals_m"),
        ] {
            let error = single.force(0.0, 0.0).unwrap_err().to_string();
            let expected = format!("{axis} has a single entry");
            assert!(error.starts_with(&expected), "{error}");
        }
    }

    /// Forces bilinear in depth and position, so that interpolation must reproduce them.
    fn poses() -> ForceTable {
        let laterals = [-0.002, 0.0, 0.0005, 0.003];
        table_of(&[0.0, 0.001, 0.004], &laterals, |d, x| {
            [lateral(d, x), normal(d, x)]
        })
    }

    fn normal(depth: f64, x: f64) -> f64 {
        0.1 + 300.0 * depth + 20.0 * x + 5e4 * depth * x
    }

    fn lateral(depth: f64, x: f64) -> f64 {
        -40.0 * x + 7e4 * depth * x
    }

    // Verifies: TRC-021.
    #[test]
    fn between_poses_forces_are_bilinear() {
        let positions = [0.0021, -0.0013, 0.0002, 0.0, 0.003];
        for depth in [0.0005, 0.0017, 0.0039] {
            let found = poses().sweep(depth, &positions).unwrap();
            for (i, &x) in positions.iter().enumerate() {
                assert!((found.normal[i] - normal(depth, x)).abs() < 1e-14);
                assert!((found.lateral[i] - lateral(depth, x)).abs() < 1e-14);
            }
        }
    }

    // Verifies: TRC-021.
    #[test]
    fn at_poses_forces_are_those_of_the_map_to_the_bit() {
        let table = poses();
        // Half a nanometre off, on either side, is the same position.
        for off in [-5e-10, 0.0, 5e-10] {
            let positions: Vec<f64> = table.laterals().iter().map(|x| x + off).collect();
            for (row, &depth) in table.depths().iter().enumerate() {
                let found = table.sweep(depth + off, &positions).unwrap();
                assert_eq!(found.normal, table.normal().row(row));
                assert_eq!(found.lateral, table.lateral().unwrap().row(row));
            }
        }
    }

    // Verifies: TRC-024.
    #[test]
    fn nothing_is_extrapolated() {
        for depth in [-2e-9, 0.004 + 2e-9, f64::NAN, f64::INFINITY] {
            let error = poses().sweep(depth, &[0.0]).unwrap_err().to_string();
            assert!(error.starts_with(&format!("depth {} mm is outside the map", mm(depth))));
        }
        for x in [-0.002 - 2e-9, 0.003 + 2e-9, f64::NAN, f64::NEG_INFINITY] {
            let error = poses().sweep(0.001, &[0.0, x]).unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("lateral position {} mm is outside the map", mm(x)))
            );
        }
        assert_error(
            poses().sweep(0.005, &[0.0]),
            "depth 5.0 mm is outside the map, which has 0.0 to 4.0 mm",
        );
    }
}
