//! The paper's rule between and beyond the poses of a table: "simple linear interpolation of the
//! forces is used when the operation is within the bounds of the data and linear extrapolation is
//! used outside these bounds" (paper §4; `spec/interpolation.md`).

use super::{ForceTable, InvalidForceMap, Matrix};

/// A force on the probe, N.
///
/// ```
/// use palpate::force_map::{ForceTable, Matrix, ProbeForce};
///
/// let matrix = |force: f64| Matrix::from_fn(2, 2, |row, _| force * row as f64);
/// let table = ForceTable::new(vec![0.0, 0.004], vec![0.0, 0.01], matrix(1.5), matrix(-0.25))?;
/// assert_eq!(table.force(0.004, 0.01)?, ProbeForce { lateral: -0.25, normal: 1.5 });
/// # Ok::<(), palpate::force_map::InvalidForceMap>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeForce {
    /// Along +x.
    pub lateral: f64,
    /// Positive where it pushes the probe up.
    pub normal: f64,
}

/// A cell of an axis, and where a position lies in it or beyond it.
struct Cell {
    index: usize,
    fraction: f64,
}

impl Cell {
    /// The cell of `position` (m) on an axis of at least two entries; `None` if it is wider than the
    /// largest number, so that no fraction has a meaning.
    fn find(axis: &[f64], position: f64) -> Option<Cell> {
        let passed = axis.partition_point(|&entry| entry <= position);
        let index = passed.saturating_sub(1).min(axis.len() - 2);
        let (start, end) = (axis[index], axis[index + 1]);
        let width = end - start;
        let fraction = (position - start) / width;
        width.is_finite().then_some(Cell { index, fraction })
    }

    /// (1 − t) a + t b, which is a at t = 0 and b at t = 1 to the bit.
    fn blend(&self, a: f64, b: f64) -> f64 {
        (1.0 - self.fraction) * a + self.fraction * b
    }
}

impl ForceTable {
    /// The force at a pose (m) by the bilinear form of its cell; outside the table, by that of the
    /// nearest border cell, continued.
    ///
    /// ```
    /// use palpate::force_map::{ForceTable, Matrix};
    ///
    /// // Bilinear forces, d·x in units of the cell, inside and beyond it.
    /// let matrix = || Matrix::from_fn(2, 2, |row, column| (row * column) as f64);
    /// let table = ForceTable::new(vec![0.0, 0.5], vec![0.0, 0.5], matrix(), matrix())?;
    /// assert_eq!(table.force(0.25, 0.25)?.normal, 0.25);
    /// assert_eq!(table.force(1.0, 1.0)?.normal, 4.0);
    /// # Ok::<(), palpate::force_map::InvalidForceMap>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidForceMap::PoseNotFinite`], [`InvalidForceMap::SinglePosition`],
    /// [`InvalidForceMap::ForceTooLarge`].
    ///
    /// Implements: MAP-060, MAP-061, MAP-062.
    pub fn force(&self, depth: f64, lateral: f64) -> Result<ProbeForce, InvalidForceMap> {
        for (key, value) in [("depth", depth), ("lateral position", lateral)] {
            if !value.is_finite() {
                return Err(InvalidForceMap::PoseNotFinite { key, value });
            }
        }
        for (key, axis) in [("depths_m", self.depths()), ("laterals_m", self.laterals())] {
            if axis.len() < 2 {
                return Err(InvalidForceMap::SinglePosition { key });
            }
        }
        let value = |matrix: &Matrix| {
            interpolate(self.depths(), self.laterals(), matrix, depth, lateral)
                .ok_or(InvalidForceMap::ForceTooLarge { depth, lateral })
        };
        Ok(ProbeForce {
            lateral: value(self.lateral_force())?,
            normal: value(self.normal_force())?,
        })
    }
}

/// The entry of `matrix` at a pose (m), by the bilinear form of its cell; outside the axes (m, at
/// least two entries each, increasing; as many as the matrix has rows and columns), by that of the
/// nearest border cell, continued. `None` if it is beyond the range of f64.
///
/// Implements: MAP-060, MAP-062.
pub(crate) fn interpolate(
    depths: &[f64],
    laterals: &[f64],
    matrix: &Matrix,
    depth: f64,
    lateral: f64,
) -> Option<f64> {
    let row = Cell::find(depths, depth)?;
    let column = Cell::find(laterals, lateral)?;
    let along = |entries: &[f64]| column.blend(entries[column.index], entries[column.index + 1]);
    let value = row.blend(
        along(matrix.row(row.index)),
        along(matrix.row(row.index + 1)),
    );
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bilinear forces on axes of uneven steps, all exact in binary.
    fn table() -> ForceTable {
        let (depths, laterals) = (vec![0.0, 0.5, 2.0], vec![-1.0, 0.25, 1.0]);
        let normal = |d: f64, x: f64| 3.0 + 2.0 * d - x + 4.0 * d * x;
        let lateral = |d: f64, x: f64| -normal(x, d);
        let matrix = |force: &dyn Fn(f64, f64) -> f64| {
            Matrix::from_fn(3, 3, |row, column| force(depths[row], laterals[column]))
        };
        let (normal, lateral) = (matrix(&normal), matrix(&lateral));
        ForceTable::new(depths.clone(), laterals.clone(), normal, lateral).unwrap()
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
                assert!(
                    (force.normal - expected).abs() <= tolerance,
                    "{depth} {lateral}"
                );
                let expected = -(3.0 + 2.0 * lateral - depth + 4.0 * depth * lateral);
                assert!(
                    (force.lateral - expected).abs() <= tolerance,
                    "{depth} {lateral}"
                );
            }
        }
    }

    // Verifies: MAP-060.
    #[test]
    fn outside_the_border_cell_is_continued_not_the_whole_table() {
        let matrix = || Matrix::new(3, vec![0.0, 1.0, 5.0, 0.0, 1.0, 5.0]).unwrap();
        let axes = (vec![0.0, 1.0], vec![0.0, 1.0, 2.0]);
        let table = ForceTable::new(axes.0, axes.1, matrix(), matrix()).unwrap();
        for (lateral, expected) in [(-1.0, -1.0), (0.5, 0.5), (1.5, 3.0), (2.0, 5.0), (3.0, 9.0)] {
            assert_eq!(table.force(0.5, lateral).unwrap().normal, expected);
        }
    }

    // Verifies: MAP-061, MAP-062.
    #[test]
    fn poses_and_tables_without_an_answer_are_refused() {
        let table = table();
        let refused = |depth, lateral| table.force(depth, lateral).unwrap_err().to_string();
        assert!(refused(f64::NAN, 0.0).starts_with("depth = NaN"));
        assert!(refused(0.0, f64::INFINITY).starts_with("lateral position = inf"));
        assert!(refused(1e200, 1e200).contains("beyond"));
        // A cell whose width is infinite would make every fraction 0.
        let matrix = || Matrix::new(2, vec![1.0, 2.0, 3.0, 4.0]).unwrap();
        let wide = vec![-1e308, 1e308];
        let wide = ForceTable::new(vec![0.0, 1.0], wide, matrix(), matrix()).unwrap();
        assert!(wide.force(0.0, 1e307).is_err());
        let one = || Matrix::new(2, vec![1.0, 2.0]).unwrap();
        let single = ForceTable::new(vec![0.0], vec![0.0, 1.0], one(), one()).unwrap();
        let error = single.force(0.0, 0.0).unwrap_err().to_string();
        assert!(error.starts_with("depths_m has a single entry"), "{error}");
        let column = || Matrix::new(1, vec![1.0, 2.0]).unwrap();
        let single = ForceTable::new(vec![0.0, 1.0], vec![0.0], column(), column()).unwrap();
        let error = single.force(0.0, 0.0).unwrap_err().to_string();
        assert!(
            error.starts_with("laterals_m has a single entry"),
            "{error}"
        );
    }
}
