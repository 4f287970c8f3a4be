//! The forces along a sweep at constant depth, between the poses of a map too (paper §4: "simple
//! linear interpolation of the forces").

use super::{ForceTable, InvalidForceMap, Matrix, SAME_POSITION};

/// The forces along a sweep, one of each for every position asked for.
///
/// ```
/// use palpate::force_map::{ForceTable, Sweep};
///
/// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n4,2,1,-0.25\n";
/// let table = ForceTable::from_csv(text, "gel.csv")?;
/// let Sweep { lateral_force, normal_force } = table.sweep(0.004, &[0.002, 0.001])?;
/// assert_eq!((normal_force, lateral_force), (vec![1.0, 1.25], vec![-0.25, -0.125]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Lateral forces on the probe along +x, N.
    pub lateral_force: Vec<f64>,
    /// Normal forces, N, positive where they push the probe up.
    pub normal_force: Vec<f64>,
}

/// A place on an axis: weight `1 − fraction` on entry `index`, `fraction` on the next.
#[derive(Clone, Copy)]
struct Place {
    index: usize,
    fraction: f64,
}

impl Place {
    /// The place of `position` on `axis`, or `None` if it is more than [`SAME_POSITION`] outside.
    fn find(axis: &[f64], position: f64) -> Option<Place> {
        let last = axis.len() - 1; // a table's axes are never empty
        // The first entry that is the position or lies beyond it.
        let next = axis.partition_point(|&entry| entry < position - SAME_POSITION);
        let at = |index| Place {
            index,
            fraction: 0.0,
        };
        match next {
            _ if !position.is_finite() || next > last => None,
            _ if axis[next] <= position + SAME_POSITION => Some(at(next)),
            0 => None,
            _ => Some(Place {
                index: next - 1,
                fraction: (position - axis[next - 1]) / (axis[next] - axis[next - 1]),
            }),
        }
    }

    /// The linear interpolation of `value` at this place; an entry itself to the bit.
    fn value(self, value: impl Fn(usize) -> f64) -> f64 {
        if self.fraction == 0.0 {
            return value(self.index);
        }
        // Weights that add up to 1: forces of any size cannot overflow.
        (1.0 - self.fraction) * value(self.index) + self.fraction * value(self.index + 1)
    }
}

impl ForceTable {
    /// The forces at `depth` (m) and each of `positions` (m, in any order): linear in the depth
    /// between two rows, then linear in the position between two columns. A row within
    /// [`SAME_POSITION`] of the depth, and a column within it of a position, count to the bit.
    ///
    /// ```
    /// use palpate::force_map::{ForceTable, Matrix};
    ///
    /// // Half-way in depth and half-way in position: the mean of the four.
    /// let matrix = || Matrix::new(2, vec![0.0, 1.0, 2.0, 5.0]).ok_or("two rows of two");
    /// let table = ForceTable::new(vec![0.0, 0.002], vec![0.0, 0.004], matrix()?, matrix()?)?;
    /// assert_eq!(table.sweep(0.001, &[0.002])?.normal_force, [2.0]);
    /// assert!(table.sweep(0.003, &[0.002]).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidForceMap::OutsideDepths`], [`InvalidForceMap::OutsideLaterals`]: nothing is
    /// extrapolated.
    ///
    /// Implements: TRC-021, TRC-022, TRC-023, TRC-024.
    pub fn sweep(&self, depth: f64, positions: &[f64]) -> Result<Sweep, InvalidForceMap> {
        let (depths, laterals) = (self.depths(), self.laterals());
        let row = Place::find(depths, depth).ok_or(InvalidForceMap::OutsideDepths {
            depth,
            first: depths[0],
            last: depths[depths.len() - 1],
        })?;
        let mut sweep = Sweep {
            lateral_force: Vec::with_capacity(positions.len()),
            normal_force: Vec::with_capacity(positions.len()),
        };
        let force = |matrix: &Matrix, column: Place| {
            column.value(|column| row.value(|row| matrix.row(row)[column]))
        };
        for &lateral in positions {
            let column =
                Place::find(laterals, lateral).ok_or(InvalidForceMap::OutsideLaterals {
                    lateral,
                    first: laterals[0],
                    last: laterals[laterals.len() - 1],
                })?;
            sweep
                .lateral_force
                .push(force(self.lateral_force(), column));
            sweep.normal_force.push(force(self.normal_force(), column));
        }
        Ok(sweep)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces bilinear in depth and position, so that interpolation must reproduce them.
    fn table() -> ForceTable {
        let (depths, laterals) = (vec![0.0, 0.001, 0.004], vec![-0.002, 0.0, 0.0005, 0.003]);
        let matrix = |force: fn(f64, f64) -> f64| {
            Matrix::from_fn(3, 4, |row, column| force(depths[row], laterals[column]))
        };
        let (normal, lateral) = (matrix(normal), matrix(lateral));
        ForceTable::new(depths, laterals, normal, lateral).unwrap()
    }

    fn normal(depth: f64, x: f64) -> f64 {
        0.1 + 300.0 * depth + 20.0 * x + 5e4 * depth * x
    }

    fn lateral(depth: f64, x: f64) -> f64 {
        -40.0 * x + 7e4 * depth * x
    }

    // Verifies: TRC-022, TRC-023.
    #[test]
    fn between_poses_forces_are_bilinear() {
        let positions = [0.0021, -0.0013, 0.0002, 0.0, 0.003];
        for depth in [0.0005, 0.0017, 0.0039] {
            let found = table().sweep(depth, &positions).unwrap();
            for (i, &x) in positions.iter().enumerate() {
                assert!((found.normal_force[i] - normal(depth, x)).abs() < 1e-14);
                assert!((found.lateral_force[i] - lateral(depth, x)).abs() < 1e-14);
            }
        }
    }

    // Verifies: TRC-021, TRC-023.
    #[test]
    fn at_poses_forces_are_those_of_the_map_to_the_bit() {
        let table = table();
        // Half a nanometre off, on either side, is the same position.
        for off in [-5e-10, 0.0, 5e-10] {
            let positions: Vec<f64> = table.laterals().iter().map(|x| x + off).collect();
            for (row, &depth) in table.depths().iter().enumerate() {
                let found = table.sweep(depth + off, &positions).unwrap();
                assert_eq!(found.normal_force, table.normal_force().row(row));
                assert_eq!(found.lateral_force, table.lateral_force().row(row));
            }
        }
    }

    // Verifies: TRC-024.
    #[test]
    fn nothing_is_extrapolated() {
        for depth in [-2e-9, 0.004 + 2e-9, f64::NAN, f64::INFINITY] {
            let error = table().sweep(depth, &[0.0]).unwrap_err();
            assert!(matches!(error, InvalidForceMap::OutsideDepths { .. }));
        }
        for x in [-0.002 - 2e-9, 0.003 + 2e-9, f64::NAN, f64::NEG_INFINITY] {
            let error = table().sweep(0.001, &[0.0, x]).unwrap_err();
            assert!(matches!(error, InvalidForceMap::OutsideLaterals { .. }));
        }
        let error = table().sweep(0.005, &[0.0]).unwrap_err();
        let expected = "depth 0.005 m is outside the map, expected 0 to 0.004 m";
        assert_eq!(error.to_string(), expected);
    }
}
