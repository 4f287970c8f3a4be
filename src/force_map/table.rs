//! Forces on a grid of poses: two axes and two matrices (paper §4).

use super::InvalidForceMap;

/// Two positions closer than this, m, are the same position.
///
/// Axes come from decimal text and from sums of steps, which differ in the last bits; no stage of a
/// probe resolves a nanometre.
///
/// Implements: MAP-004.
pub const SAME_POSITION: f64 = 1e-9;

/// The largest lateral force at x = 0, N, that counts as the zero that symmetry demands: what
/// rounding leaves of a force of some newtons.
///
/// Implements: MAP-010.
pub const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// A dense matrix, row-major. Rows belong to depths, columns to lateral positions.
///
/// ```
/// use palpate::force_map::Matrix;
///
/// let matrix = Matrix::from_fn(2, 3, |row, column| (10 * row + column) as f64);
/// assert_eq!((matrix.row_count(), matrix.column_count()), (2, 3));
/// assert_eq!(matrix.row(1), [10.0, 11.0, 12.0]);
/// assert_eq!(matrix.rows().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 10.0]);
/// assert_eq!(matrix.entries().last(), Some((1, 2, 12.0)));
/// assert_eq!(Matrix::new(3, matrix.values().to_vec()), Some(matrix));
/// assert_eq!(Matrix::new(3, vec![1.0, 2.0]), None);
/// ```
///
/// Implements: MAP-001.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix {
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// The matrix of `columns` columns whose rows follow one another in `values`; `None` if the last
    /// row is not full.
    pub fn new(columns: usize, values: Vec<f64>) -> Option<Matrix> {
        let full = if columns == 0 {
            values.is_empty()
        } else {
            values.len().is_multiple_of(columns)
        };
        full.then_some(Matrix { columns, values })
    }

    /// The `rows` × `columns` matrix with `entry(row, column)` in each place.
    pub fn from_fn(
        rows: usize,
        columns: usize,
        mut entry: impl FnMut(usize, usize) -> f64,
    ) -> Matrix {
        let mut values = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            values.extend((0..columns).map(|column| entry(row, column)));
        }
        Matrix { columns, values }
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.values.len().checked_div(self.columns).unwrap_or(0)
    }

    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.columns
    }

    /// The rows, from the first on.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns.max(1))
    }

    /// Row `row`. Panics if there is none.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..][..self.columns]
    }

    /// All entries, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Row, column and value of every entry, row by row.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let columns = self.columns.max(1);
        let place = move |(at, value): (usize, &f64)| (at / columns, at % columns, *value);
        self.values.iter().enumerate().map(place)
    }
}

/// The normal and lateral force on the probe at every pose of a grid, N.
///
/// Both axes increase, every number is finite, and both matrices have one row for each depth and one
/// column for each lateral position.
///
/// ```
/// use palpate::force_map::{ForceTable, Matrix};
///
/// // N = 1000 d, and no lateral force.
/// let depths = vec![0.001, 0.004];
/// let normal = Matrix::from_fn(2, 3, |row, _| 1000.0 * [0.001, 0.004][row]);
/// let lateral = Matrix::from_fn(2, 3, |_, _| 0.0);
/// let table = ForceTable::new(depths, vec![0.0, 0.002, 0.004], normal, lateral)?;
/// assert_eq!((table.depths().len(), table.laterals().len()), (2, 3));
/// assert_eq!(table.normal_force().row(1), [4.0; 3]);
/// assert_eq!(table.lateral_force().values(), [0.0; 6]);
/// // Of a depth that is there; against itself there is no signal.
/// assert_eq!(table.row(0.004)?.normal_force, [4.0; 3]);
/// assert!(table.row(0.003).is_err());
/// assert_eq!(table.minus(&table)?.normal_force().values(), [0.0; 6]);
/// assert_eq!(table.mirrored()?.laterals(), [-0.004, -0.002, 0.0, 0.002, 0.004]);
/// // What is written can be read.
/// assert_eq!(ForceTable::from_csv(&table.to_csv(), "table.csv")?, table);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    depths: Vec<f64>,
    laterals: Vec<f64>,
    normal_force: Matrix,
    lateral_force: Matrix,
}

/// The forces at one depth, over the lateral positions.
///
/// ```
/// use palpate::force_map::{ForceCurve, ForceTable};
///
/// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n4,2,1.25,-0.1\n";
/// let table = ForceTable::from_csv(text, "gel.csv")?;
/// let ForceCurve { laterals, normal_force, lateral_force } = table.row(0.004)?;
/// assert_eq!((laterals, normal_force), (&[0.0, 0.002][..], &[1.5, 1.25][..]));
/// assert_eq!(lateral_force, [0.0, -0.1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceCurve<'a> {
    /// Lateral positions of the probe, m.
    pub laterals: &'a [f64],
    /// Normal force at each of them, N.
    pub normal_force: &'a [f64],
    /// Lateral force at each of them, N.
    pub lateral_force: &'a [f64],
}

impl ForceTable {
    /// A table over `depths` (m, rows) and `laterals` (m, columns); forces in N.
    ///
    /// # Errors
    /// [`InvalidForceMap`] if an axis is empty, not finite or does not increase, a depth is negative,
    /// a matrix has another shape than the axes, or a force is not finite.
    ///
    /// Implements: MAP-001, MAP-002, MAP-003, MAP-004, MAP-005, CON-007.
    pub fn new(
        mut depths: Vec<f64>,
        mut laterals: Vec<f64>,
        normal_force: Matrix,
        lateral_force: Matrix,
    ) -> Result<ForceTable, InvalidForceMap> {
        // −0 and 0 are one position; adding 0 leaves one way to write it.
        for position in depths.iter_mut().chain(&mut laterals) {
            *position += 0.0;
        }
        check_axis("depths_m", &depths)?;
        check_axis("laterals_m", &laterals)?;
        if depths[0] < 0.0 {
            return Err(InvalidForceMap::NegativeDepth { value: depths[0] });
        }
        let table = ForceTable {
            depths,
            laterals,
            normal_force,
            lateral_force,
        };
        table.check_matrix("normal_force_n", &table.normal_force)?;
        table.check_matrix("lateral_force_n", &table.lateral_force)?;
        Ok(table)
    }

    /// Depths of the rows, m, increasing.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// Lateral positions of the columns, m, increasing.
    pub fn laterals(&self) -> &[f64] {
        &self.laterals
    }

    /// Normal forces, N, positive where they push the probe up; depths × lateral positions.
    pub fn normal_force(&self) -> &Matrix {
        &self.normal_force
    }

    /// Lateral forces on the probe along +x, N; depths × lateral positions.
    pub fn lateral_force(&self) -> &Matrix {
        &self.lateral_force
    }

    /// The forces at a stored depth (m).
    ///
    /// # Errors
    /// [`InvalidForceMap::NoSuchDepth`] if no stored depth lies within [`SAME_POSITION`] of `depth`.
    ///
    /// Implements: MAP-012, MAP-015.
    pub fn row(&self, depth: f64) -> Result<ForceCurve<'_>, InvalidForceMap> {
        let stored = |&stored: &f64| (stored - depth).abs() <= SAME_POSITION;
        let Some(row) = self.depths.iter().position(stored) else {
            let stored = self.depths.clone();
            return Err(InvalidForceMap::NoSuchDepth { depth, stored });
        };
        Ok(ForceCurve {
            laterals: &self.laterals,
            normal_force: self.normal_force.row(row),
            lateral_force: self.lateral_force.row(row),
        })
    }

    /// This table minus `reference`, pose by pose: with the map of a phantom and the map of the
    /// empty one, the signal F₁ − F₀ of the paper's §2.
    ///
    /// # Errors
    /// [`InvalidForceMap::AxesDiffer`] if the two are not over the same poses;
    /// [`InvalidForceMap::Force`] if a difference is not finite.
    ///
    /// Implements: MAP-011, MAP-014.
    pub fn minus(&self, reference: &ForceTable) -> Result<ForceTable, InvalidForceMap> {
        check_same_axis("depths_m", &self.depths, &reference.depths)?;
        check_same_axis("laterals_m", &self.laterals, &reference.laterals)?;
        let difference = |a: &Matrix, b: &Matrix| Matrix {
            columns: a.columns,
            values: a.values.iter().zip(&b.values).map(|(a, b)| a - b).collect(),
        };
        ForceTable::new(
            self.depths.clone(),
            self.laterals.clone(),
            difference(&self.normal_force, &reference.normal_force),
            difference(&self.lateral_force, &reference.lateral_force),
        )
    }

    /// This table over x ≥ 0, extended to x < 0 by symmetry: the normal force is even in x, the
    /// lateral force odd. The lateral positions become −xₙ … 0 … xₙ.
    ///
    /// # Errors
    /// [`InvalidForceMap::NotFromZero`] if the first lateral position is not 0;
    /// [`InvalidForceMap::NotSymmetric`] if a lateral force at x = 0, which symmetry makes zero, is
    /// more than [`SYMMETRY_TOLERANCE`].
    ///
    /// Implements: MAP-009, MAP-010.
    pub fn mirrored(&self) -> Result<ForceTable, InvalidForceMap> {
        if self.laterals[0] != 0.0 {
            let first = self.laterals[0];
            return Err(InvalidForceMap::NotFromZero { first });
        }
        for (&depth, forces) in self.depths.iter().zip(self.lateral_force.rows()) {
            if forces[0].abs() > SYMMETRY_TOLERANCE {
                let force = forces[0];
                return Err(InvalidForceMap::NotSymmetric { depth, force });
            }
        }
        let negative = self.laterals[1..].iter().rev().map(|x| -x);
        let laterals = negative
            .chain([0.0])
            .chain(self.laterals[1..].iter().copied());
        ForceTable::new(
            self.depths.clone(),
            laterals.collect(),
            self.normal_force.mirrored(|force| force, |force| force),
            // Subtracted from zero, since the negative of +0 would be −0.
            self.lateral_force.mirrored(|force| 0.0 - force, |_| 0.0),
        )
    }

    /// The column of each of `laterals` (m).
    pub(super) fn columns_at(&self, laterals: &[f64]) -> Result<Vec<usize>, InvalidForceMap> {
        let column = |&lateral: &f64| {
            let stored = |&stored: &f64| (stored - lateral).abs() <= SAME_POSITION;
            let column = self.laterals.iter().position(stored);
            column.ok_or_else(|| InvalidForceMap::NoSuchLateral {
                lateral,
                stored: self.laterals.clone(),
            })
        };
        laterals.iter().map(column).collect()
    }

    /// This table with some of its columns.
    pub(super) fn at_columns(&self, columns: &[usize]) -> Result<ForceTable, InvalidForceMap> {
        ForceTable::new(
            self.depths.clone(),
            columns
                .iter()
                .map(|&column| self.laterals[column])
                .collect(),
            self.normal_force.at_columns(columns),
            self.lateral_force.at_columns(columns),
        )
    }

    fn check_matrix(&self, key: &'static str, matrix: &Matrix) -> Result<(), InvalidForceMap> {
        let expected = [self.depths.len(), self.laterals.len()];
        let found = [matrix.row_count(), matrix.column_count()];
        if found != expected {
            return Err(InvalidForceMap::Shape {
                key,
                found,
                expected,
            });
        }
        match matrix.entries().find(|(_, _, value)| !value.is_finite()) {
            Some((row, column, value)) => Err(InvalidForceMap::Force {
                key,
                row,
                column,
                value,
            }),
            None => Ok(()),
        }
    }
}

impl Matrix {
    /// This matrix with some of its columns.
    pub(super) fn at_columns(&self, columns: &[usize]) -> Matrix {
        Matrix::from_fn(self.row_count(), columns.len(), |row, column| {
            self.row(row)[columns[column]]
        })
    }

    /// Columns 0 … n over x ≥ 0 to columns −n … n: `at_negative` of the value at |x|, and `at_zero`
    /// of the first column.
    pub(super) fn mirrored(
        &self,
        at_negative: impl Fn(f64) -> f64,
        at_zero: impl Fn(f64) -> f64,
    ) -> Matrix {
        let last = self.columns.saturating_sub(1);
        Matrix::from_fn(self.row_count(), 2 * last + 1, |row, column| {
            let value = self.row(row)[column.abs_diff(last)];
            match column.cmp(&last) {
                std::cmp::Ordering::Less => at_negative(value),
                std::cmp::Ordering::Equal => at_zero(value),
                std::cmp::Ordering::Greater => value,
            }
        })
    }
}

fn check_axis(key: &'static str, axis: &[f64]) -> Result<(), InvalidForceMap> {
    if axis.is_empty() {
        return Err(InvalidForceMap::EmptyAxis { key });
    }
    if let Some(index) = axis.iter().position(|position| !position.is_finite()) {
        let value = axis[index];
        return Err(InvalidForceMap::AxisNotFinite { key, index, value });
    }
    for (index, pair) in axis.windows(2).enumerate() {
        // Halves, since the difference of two finite numbers may overflow.
        if pair[1] / 2.0 - pair[0] / 2.0 <= SAME_POSITION / 2.0 {
            let (previous, value) = (pair[0], pair[1]);
            let index = index + 1;
            return Err(InvalidForceMap::AxisOrder {
                key,
                index,
                previous,
                value,
            });
        }
    }
    Ok(())
}

fn check_same_axis(key: &'static str, ours: &[f64], theirs: &[f64]) -> Result<(), InvalidForceMap> {
    for index in 0..ours.len().max(theirs.len()) {
        match (ours.get(index).copied(), theirs.get(index).copied()) {
            (Some(a), Some(b)) if (a - b).abs() <= SAME_POSITION => {}
            (ours, theirs) => {
                return Err(InvalidForceMap::AxesDiffer {
                    key,
                    index,
                    ours,
                    theirs,
                });
            }
        }
    }
    Ok(())
}
