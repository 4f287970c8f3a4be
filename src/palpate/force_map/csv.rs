//! Measured force maps as CSV (`spec/force-map.md`).

use super::grid::{Gridded, gridded};
use super::{ForceTable, Matrix, SAME_POSITION, increasing};
use crate::csv::{Column, Layout, Rows};
use crate::decimal::{format_scaled, mm};
use crate::refusal::Refusal;

/// Depth, lateral position, normal force, lateral force, which may be missing.
const COLUMNS: [Column; 4] = [
    &[&[("depth_mm", -3), ("depth_m", 0)]],
    &[&[("lateral_mm", -3), ("lateral_m", 0)]],
    &[&[("normal_force_n", 0), ("normal_force_mn", -3)]],
    &[&[("lateral_force_n", 0), ("lateral_force_mn", -3)]],
];
/// The headers that are right, for a person, and what else there is where the user may state a layout.
const EXPECTED_HEADER: &str = "depth_mm,lateral_mm,normal_force_n,lateral_force_n, in any order, lengths also as _m, forces also as _mn";
const OR_STATED: &str = ", or say with --columns or [columns] what each holds";

impl ForceTable {
    /// This table as CSV, row by row, lengths in mm and forces in N; without a column of lateral forces if it has none.
    ///
    /// Implements: MAP-030, MAP-022.
    pub fn to_csv(&self) -> String {
        let columns = COLUMNS.map(|names| names[0][0]);
        let columns = &columns[..3 + usize::from(self.lateral().is_some())];
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let mut text = line(columns.iter().map(|(name, _)| (*name).into()).collect());
        for (row, column, normal) in self.normal().entries() {
            let lateral = self.lateral().map(|lateral| lateral.row(row)[column]);
            let fields = [self.depths()[row], self.laterals()[column], normal];
            let fields = fields.into_iter().chain(lateral).zip(columns);
            let written = fields.map(|(value, (_, power))| format_scaled(value, -power));
            text.push_str(&line(written.collect()));
        }
        text
    }

    /// The table in `text`, the content of `file`.
    ///
    /// # Errors
    /// The header does not name each of the four columns, but for the lateral force, once, a row is malformed, a pose is missing or there twice, or the forces
    /// make no table (see [`ForceTable::new`]); with the file, and the line where there is one.
    ///
    /// Implements: MAP-026, MAP-030, MAP-032, MAP-033, MAP-037, MAP-041.
    pub fn from_csv(text: &str, file: &str) -> Result<ForceTable, Refusal> {
        Ok(ForceTable::from_csv_with_notes(text, file, None)?.0)
    }

    /// As [`ForceTable::from_csv`], of a file in this layout if the user may state one, and what a person should know of how the text was
    /// read, such as the columns that are not used.
    ///
    /// ```
    /// use palpate::force_map::ForceTable;
    ///
    /// let text = "\"\";depth_mm;lateral_mm;normal_force_n;lateral_force_n;volt\n1;4;0;1,5;0,0;2,25\n";
    /// let (table, notes) = ForceTable::from_csv_with_notes(text, "gel.csv", None)?;
    /// assert_eq!(table.normal().values(), [1.5]);
    /// assert_eq!(notes[0], "column \"volt\" is not used");
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// As [`ForceTable::from_csv`]; a layout that states what a map does not have.
    ///
    /// Implements: MAP-041, MAP-044, MAP-046.
    pub fn from_csv_with_notes(
        text: &str,
        file: &str,
        layout: Option<&Layout>,
    ) -> Result<(ForceTable, Vec<String>), Refusal> {
        let on_grid = || {
            let (table, has_lateral) = read(text, layout, false)?;
            Ok((on_a_grid(table.rows, has_lateral)?, table.notes))
        };
        on_grid().map_err(|refusal: Refusal| refusal.in_file(file))
    }

    /// As [`ForceTable::from_csv_with_notes`], of samples at any poses, which are put on a grid with these steps of depth and lateral
    /// position, m.
    ///
    /// # Errors
    /// A header or a row as in [`ForceTable::from_csv`]; a step that is not above 0; a pose of the grid without a sample.
    ///
    /// Implements: MAP-080.
    pub fn from_scattered_csv(
        text: &str,
        file: &str,
        layout: &Layout,
        steps: [f64; 2],
    ) -> Result<(Gridded, Vec<String>), Refusal> {
        let on_grid = || {
            let (table, has_lateral) = read(text, Some(layout), true)?;
            let samples: Vec<_> = table.rows.iter().map(|(_, sample)| *sample).collect();
            Ok((gridded(&samples, has_lateral, steps)?, table.notes))
        };
        on_grid().map_err(|refusal: Refusal| refusal.in_file(file))
    }
}

/// The rows of a file, whether they are samples that may lack a number, and whether they have lateral forces; if not, a note says so.
///
/// Implements: MAP-083.
fn read(
    text: &str,
    layout: Option<&Layout>,
    are_samples: bool,
) -> Result<(Rows<4>, bool), Refusal> {
    let expected = format!("{EXPECTED_HEADER}{}", layout.map_or("", |_| OR_STATED));
    let (none, required) = (Layout::default(), 3);
    let layout = layout.unwrap_or(&none);
    let read = Rows::parse_optional(text, COLUMNS, required, &expected, layout, are_samples)?;
    let (mut rows, [.., has_lateral]) = read;
    if !has_lateral {
        let note = "there is no lateral force: the map is of the normal force alone";
        rows.notes.push(note.into());
    }
    Ok((rows, has_lateral))
}

/// Makes depths, and positions, that are closer to each other than two of an axis may be the same.
fn unite(rows: &mut [(usize, [f64; 4])]) {
    for axis in [1, 0] {
        rows.sort_by(|(_, a), (_, b)| a[axis].total_cmp(&b[axis]));
        let mut last = f64::NEG_INFINITY;
        for (_, row) in &mut *rows {
            if row[axis] - last > SAME_POSITION {
                // Adding 0 makes −0 the same position as 0.
                last = row[axis] + 0.0;
            }
            row[axis] = last;
        }
    }
}

/// The table of `rows`, each with its line, of the normal force alone unless it `has_lateral` forces. There is exactly one for each pose of the grid, or an error.
///
/// The poses are compared one by one, never laid out: n rows can span n² of them.
///
/// Implements: MAP-033, MAP-037, MAP-002.
fn on_a_grid(mut rows: Vec<(usize, [f64; 4])>, has_lateral: bool) -> Result<ForceTable, Refusal> {
    unite(&mut rows);
    // The first line of a pose first.
    rows.sort_by(|(first, a), (second, b)| {
        let order = a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        order.then(first.cmp(second))
    });
    let named = |depth, lateral| {
        let (depth, lateral) = (mm(depth), mm(lateral));
        format!("row for depth {depth} mm, lateral {lateral} mm")
    };
    let next = rows.iter().skip(1);
    for ((first, before), (line, [depth, lateral, ..])) in rows.iter().zip(next) {
        if before[..2] == [*depth, *lateral] {
            let found = format!("a second {}", named(*depth, *lateral));
            let expected = format!("keep one; the first is line {first}");
            return Err(Refusal::state(found, expected).at(*line));
        }
    }
    let axis = |column: usize| increasing(rows.iter().map(|(_, row)| row[column]));
    let (depths, laterals) = (axis(0), axis(1));
    let mut rest = rows.iter().peekable();
    for &depth in &depths {
        for &lateral in &laterals {
            let is_next = rest.next_if(|(_, row)| row[..2] == [depth, lateral]);
            if is_next.is_none() {
                let (depths, laterals) = (depths.len(), laterals.len());
                return Err(Refusal::state(
                    format!("no {}", named(depth, lateral)),
                    format!(
                        "give one for each of the {depths} depths at each of the {laterals} lateral positions in the file"
                    ),
                ));
            }
        }
    }
    let columns = laterals.len();
    let matrix = |force: usize| {
        Matrix::from_fn(depths.len(), columns, |row, column| {
            rows[row * columns + column].1[force]
        })
    };
    let (normal, lateral) = (matrix(2), has_lateral.then(|| matrix(3)));
    ForceTable::of_channels(depths, laterals, normal, lateral)
}
