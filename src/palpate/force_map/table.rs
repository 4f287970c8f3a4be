//! Forces on a grid of poses: two axes and two matrices (paper §4).

use std::cmp::Ordering;
use std::fmt::Display;

use serde::{Deserialize, Serialize, Serializer};

use crate::decimal::mm;
use crate::force::Force;
use crate::refusal::Refusal;

/// Two positions closer than this, m, are the same position.
///
/// Axes come from decimal text and from sums of steps, which differ in the last bits; no stage of a
/// probe resolves a nanometre.
///
/// Implements: MAP-002.
pub const SAME_POSITION: f64 = 1e-9;

/// The largest lateral force at x = 0, N, that counts as the zero that symmetry demands: what
/// rounding leaves of a force of some newtons.
///
/// Implements: MAP-009.
pub const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// A dense matrix, row-major. Rows belong to depths, columns to lateral positions.
///
/// Implements: MAP-001.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(try_from = "Vec<Vec<f64>>")]
pub struct Matrix {
    columns: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// The matrix of `columns` columns whose rows follow one another in `values`; `None` if the last
    /// row is not full.
    pub fn new(columns: usize, values: Vec<f64>) -> Option<Matrix> {
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let full = rows * columns == values.len();
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

    /// This matrix with some of its columns, in any order.
    pub(super) fn at_columns(&self, columns: &[usize]) -> Matrix {
        Matrix::from_fn(self.row_count(), columns.len(), |row, column| {
            self.row(row)[columns[column]]
        })
    }

    /// Refuses this matrix under `key` if it has not the `shape` of the axes, or an entry that is not finite or below `least`.
    pub(super) fn check(&self, key: &str, shape: [usize; 2], least: f64) -> Result<(), Refusal> {
        let [rows, columns] = [self.row_count(), self.column_count()];
        let found = format!("{key} has {rows} rows and {columns} columns");
        let expected = format!("give {} rows (one a depth)", shape[0]);
        let expected = format!(
            "{expected} and {} columns (one a lateral position)",
            shape[1]
        );
        Refusal::state(found, expected).when(shape != [rows, columns])?;
        self.entries().try_for_each(|(row, column, value)| {
            check_number(format_args!("{key}[{row}][{column}]"), value, least)
        })
    }
}

/// Refuses a number that is not finite or below `least`, which is 0 or −∞.
pub(super) fn check_number(key: impl Display, value: f64, least: f64) -> Result<(), Refusal> {
    if value.is_finite() && value >= least {
        return Ok(());
    }
    let expected = match least {
        0.0 => "a finite number, at least 0",
        _ => "a finite number",
    };
    Err(Refusal::value(key.to_string(), value, expected))
}

impl Serialize for Matrix {
    /// As an array of rows.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.rows())
    }
}

impl TryFrom<Vec<Vec<f64>>> for Matrix {
    type Error = String;

    /// From rows of one length.
    ///
    /// Implements: MAP-002, MAP-024.
    fn try_from(rows: Vec<Vec<f64>>) -> Result<Matrix, String> {
        let columns = rows.first().map_or(0, Vec::len);
        if let Some(row) = rows.iter().position(|row| row.len() != columns) {
            let found = format!("row {row} has {} numbers", rows[row].len());
            return Err(format!("{found}; give {columns}, as in row 0"));
        }
        let values = rows.concat();
        Ok(Matrix { columns, values })
    }
}

/// The normal and lateral force on the probe at every pose of a grid, N; of a sensor of one axis the normal force alone.
///
/// Both axes increase, every number is finite, and each matrix has one row for each depth and one
/// column for each lateral position.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    depths: Vec<f64>,
    laterals: Vec<f64>,
    normal: Matrix,
    lateral: Option<Matrix>,
}

impl ForceTable {
    /// A table over `depths` (m, rows) and `laterals` (m, columns); forces in N.
    ///
    /// # Errors
    /// [`Refusal`] if an axis is empty, not finite or does not increase, a depth is negative, a matrix has another shape than the
    /// axes, or a force is not finite. Keys are those of the JSON file; rows and columns count from 0.
    ///
    /// Implements: MAP-001, MAP-002, MAP-026, CON-007.
    pub fn new(
        depths: Vec<f64>,
        laterals: Vec<f64>,
        forces: Force<Matrix>,
    ) -> Result<ForceTable, Refusal> {
        ForceTable::of_channels(depths, laterals, forces.normal, Some(forces.lateral))
    }

    /// As [`ForceTable::new`], of normal forces and, where they were measured, lateral ones.
    ///
    /// ```
    /// use palpate::force_map::{ForceTable, Matrix};
    ///
    /// let normal = Matrix::from_fn(1, 2, |_, column| 1.5 + 0.25 * column as f64);
    /// let table = ForceTable::of_channels(vec![0.004], vec![0.0, 0.002], normal, None)?;
    /// assert_eq!((table.normal().row(0), table.lateral()), (&[1.5, 1.75][..], None));
    /// assert!(table.both().is_err());
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// As [`ForceTable::new`].
    ///
    /// Implements: MAP-083.
    pub fn of_channels(
        mut depths: Vec<f64>,
        mut laterals: Vec<f64>,
        normal: Matrix,
        lateral: Option<Matrix>,
    ) -> Result<ForceTable, Refusal> {
        // −0 and 0 are one position; adding 0 leaves one way to write it.
        for position in depths.iter_mut().chain(&mut laterals) {
            *position += 0.0;
        }
        check_axes(&depths, &laterals)?;
        let shape = [depths.len(), laterals.len()];
        normal.check("normal_force_n", shape, f64::NEG_INFINITY)?;
        if let Some(lateral) = &lateral {
            lateral.check("lateral_force_n", shape, f64::NEG_INFINITY)?;
        }
        Ok(ForceTable {
            depths,
            laterals,
            normal,
            lateral,
        })
    }

    /// Depths of the rows, m, increasing.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// Lateral positions of the columns, m, increasing.
    pub fn laterals(&self) -> &[f64] {
        &self.laterals
    }

    /// The normal forces, N: depths × lateral positions.
    pub fn normal(&self) -> &Matrix {
        &self.normal
    }

    /// The lateral forces, N: depths × lateral positions; none if they were not measured.
    pub fn lateral(&self) -> Option<&Matrix> {
        self.lateral.as_ref()
    }

    /// The table without lateral forces.
    pub(crate) fn of_normal(&self) -> ForceTable {
        ForceTable {
            lateral: None,
            ..self.clone()
        }
    }

    /// Both forces, N, for what needs both.
    ///
    /// # Errors
    /// The table has no lateral forces.
    ///
    /// Implements: MAP-084.
    pub fn both(&self) -> Result<Force<&Matrix>, Refusal> {
        let found = "the map has no lateral forces, which are needed here";
        let missing = || Refusal::state(found, "give a map with both forces");
        let lateral = self.lateral().ok_or_else(missing)?;
        Ok(Force::new(lateral, &self.normal))
    }

    /// Both forces at a stored depth (m), one at each lateral position, N.
    ///
    /// # Errors
    /// No stored depth lies within [`SAME_POSITION`] of `depth`; as [`ForceTable::both`].
    ///
    /// Implements: MAP-012.
    pub fn row(&self, depth: f64) -> Result<Force<&[f64]>, Refusal> {
        let row = place_of("depth", &self.depths, depth)?;
        Ok(self.both()?.map(|force| force.row(row)))
    }

    /// The rows at stored `depths` (m), which increase.
    ///
    /// # Errors
    /// As [`ForceTable::row`].
    pub(crate) fn at_depths(&self, depths: &[f64]) -> Result<ForceTable, Refusal> {
        let rows = depths.iter().map(|&depth| self.row(depth));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let matrix = |of: fn(&Force<&[f64]>) -> Vec<f64>| Matrix {
            columns: self.laterals.len(),
            values: rows.iter().flat_map(of).collect(),
        };
        let lateral = matrix(|row| row.lateral.to_vec());
        let forces = Force::new(lateral, matrix(|row| row.normal.to_vec()));
        ForceTable::new(depths.to_vec(), self.laterals.clone(), forces)
    }

    /// This table minus `reference`, pose by pose: with the map of a phantom and the map of the
    /// empty one, the signal F₁ − F₀ of the paper's §2. Of the normal force alone if either has no other.
    ///
    /// # Errors
    /// The two are not over the same poses; a difference is not finite.
    ///
    /// Implements: MAP-011.
    pub fn minus(&self, reference: &ForceTable) -> Result<ForceTable, Refusal> {
        check_same_poses(self, reference)?;
        let difference = |(a, b): (&Matrix, &Matrix)| Matrix {
            columns: a.columns,
            values: a.values.iter().zip(&b.values).map(|(a, b)| a - b).collect(),
        };
        let lateral = self.lateral().zip(reference.lateral()).map(difference);
        let normal = difference((&self.normal, &reference.normal));
        ForceTable::of_channels(self.depths.clone(), self.laterals.clone(), normal, lateral)
    }

    /// This table over x ≥ 0, extended to x < 0 by symmetry: the normal force is even in x, the
    /// lateral force odd. The lateral positions become −xₙ … 0 … xₙ.
    ///
    /// # Errors
    /// The first lateral position is not 0; a lateral force at x = 0, which symmetry makes zero, is
    /// more than [`SYMMETRY_TOLERANCE`].
    ///
    /// Implements: MAP-009.
    pub fn mirrored(&self) -> Result<ForceTable, Refusal> {
        let first = self.laterals[0];
        let expected = "0 in a map to be extended by symmetry";
        Refusal::value("laterals_m[0]", first, expected).when(first != 0.0)?;
        let at_zero = self.lateral().into_iter().flat_map(Matrix::rows);
        for (depth, forces) in self.depths.iter().zip(at_zero) {
            let force = forces[0];
            let found = format!("lateral force {force} N at depth {depth} m, x = 0");
            let expected =
                format!("give at most {SYMMETRY_TOLERANCE:e} N, or negative positions too");
            Refusal::state(found, expected).when(force.abs() > SYMMETRY_TOLERANCE)?;
        }
        let columns = self.mirror_columns();
        let zero = self.laterals.len() - 1;
        let odd = |values: &[f64]| -> Vec<f64> {
            let odd = |(at, &column): (usize, &usize)| match at.cmp(&zero) {
                // Subtracted from zero, since the negative of +0 would be −0.
                Ordering::Less => 0.0 - values[column],
                Ordering::Equal => 0.0,
                Ordering::Greater => values[column],
            };
            columns.iter().enumerate().map(odd).collect()
        };
        Ok(ForceTable {
            depths: self.depths.clone(),
            laterals: odd(&self.laterals),
            normal: self.normal.at_columns(&columns),
            lateral: self.lateral().map(|lateral| Matrix {
                columns: columns.len(),
                values: lateral.rows().flat_map(odd).collect(),
            }),
        })
    }

    /// The table of the mirror image, whose `columns` are those of this one from the last to the first.
    pub(super) fn mirror_image(&self, columns: &[usize]) -> ForceTable {
        let mut lateral = self.lateral().map(|force| force.at_columns(columns));
        let values = lateral.iter_mut().flat_map(|force| &mut force.values);
        values.for_each(|force| *force = 0.0 - *force);
        ForceTable {
            depths: self.depths.clone(),
            laterals: self.laterals.iter().rev().map(|x| 0.0 - x).collect(),
            normal: self.normal.at_columns(columns),
            lateral,
        }
    }

    /// The column at |x| for each lateral position x of this table extended by symmetry.
    pub(super) fn mirror_columns(&self) -> Vec<usize> {
        let columns = self.laterals.len();
        (1..columns).rev().chain(0..columns).collect()
    }

    /// The column of each of `laterals` (m).
    pub(crate) fn columns_at(&self, laterals: &[f64]) -> Result<Vec<usize>, Refusal> {
        let column = |&lateral| place_of("lateral position", &self.laterals, lateral);
        laterals.iter().map(column).collect()
    }

    /// This table with some of its columns, from left to right.
    pub(crate) fn at_columns(&self, columns: &[usize]) -> Result<ForceTable, Refusal> {
        let laterals: Vec<f64> = columns
            .iter()
            .map(|&column| self.laterals[column])
            .collect();
        check_axis("laterals_m", &laterals)?;
        Ok(ForceTable {
            depths: self.depths.clone(),
            laterals,
            normal: self.normal.at_columns(columns),
            lateral: self.lateral().map(|force| force.at_columns(columns)),
        })
    }
}

/// The entry of `axis` that is the same position (m).
fn place_of(name: &str, axis: &[f64], position: f64) -> Result<usize, Refusal> {
    let same = |&entry: &f64| (entry - position).abs() <= SAME_POSITION;
    axis.iter().position(same).ok_or_else(|| {
        let axis: Vec<_> = axis.iter().map(|&entry| mm(entry).to_string()).collect();
        let found = format!("{name} {} mm is not in the map", mm(position));
        Refusal::state(found, format!("give one of {} mm", axis.join(", ")))
    })
}

/// The values without repetition, increasing: an axis.
pub(crate) fn increasing(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Refuses depths and lateral positions (m) over which there is no table.
///
/// Implements: MAP-002.
pub(crate) fn check_axes(depths: &[f64], laterals: &[f64]) -> Result<(), Refusal> {
    check_axis("depths_m", depths)?;
    check_axis("laterals_m", laterals)?;
    let expected = "at least 0, the undeformed surface";
    Refusal::value("depths_m[0]", depths[0], expected).when(depths[0] < 0.0)
}

fn check_axis(key: &str, axis: &[f64]) -> Result<(), Refusal> {
    let empty = Refusal::state(format!("{key} is empty"), "give at least one position");
    empty.when(axis.is_empty())?;
    let refuse = |index, expected| {
        let key = format!("{key}[{index}]");
        Err(Refusal::value(key, axis[index], expected))
    };
    if let Some(index) = axis.iter().position(|position| !position.is_finite()) {
        return refuse(index, "a finite number".into());
    }
    // Halves, since the difference of two finite numbers may overflow.
    let near = |pair: &[f64]| pair[1] / 2.0 - pair[0] / 2.0 <= SAME_POSITION / 2.0;
    axis.windows(2).position(near).map_or(Ok(()), |before| {
        let previous = axis[before];
        let expected =
            format!("more than {SAME_POSITION:e} m above the entry before it, {previous}");
        refuse(before + 1, expected)
    })
}

/// Refuses a table over other poses than `reference`.
pub(super) fn check_same_poses(table: &ForceTable, reference: &ForceTable) -> Result<(), Refusal> {
    check_same_axis("depths_m", &table.depths, &reference.depths)?;
    check_same_axis("laterals_m", &table.laterals, &reference.laterals)
}

fn check_same_axis(key: &str, ours: &[f64], theirs: &[f64]) -> Result<(), Refusal> {
    for index in 0..ours.len().max(theirs.len()) {
        let both = [ours, theirs].map(|axis| axis.get(index));
        if matches!(both, [Some(a), Some(b)] if (a - b).abs() <= SAME_POSITION) {
            continue;
        }
        let [ours, theirs] =
            both.map(|entry| entry.map_or("not there".into(), |metres| format!("{metres} m")));
        let found = format!("{key}[{index}] is {ours} in one map and {theirs} in the other");
        return Err(Refusal::state(found, "give maps with equal axes"));
    }
    Ok(())
}

/// The force of largest magnitude along a sweep, N, with its sign, and its lateral position, m; of equals the one nearest to x = 0, then
/// that at x > 0.
pub fn peak(laterals: &[f64], forces: &[f64]) -> (f64, f64) {
    let poses = forces.iter().copied().zip(laterals.iter().copied());
    let peak = poses.max_by(|(force, at), (other, other_at)| {
        let larger = force.abs().total_cmp(&other.abs());
        let nearer = other_at.abs().total_cmp(&at.abs());
        larger.then(nearer).then(at.total_cmp(other_at))
    });
    peak.unwrap_or_default()
}
