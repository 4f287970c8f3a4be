//! Measured force maps as CSV (`spec/force-map.md`).

use std::cmp::Ordering;
use std::path::Path;

use super::file::{ForceMapFileError, ForceMapFileProblem};
use super::{ForceMap, ForceTable, Matrix, Source};
use crate::csv::{Column, Header, header_and_rows};
use crate::phantom::Phantom;
use crate::phantom::decimal::format_scaled;

/// Depth, lateral position, normal force, lateral force.
const COLUMNS: [Column; 4] = [
    &[("depth_mm", -3), ("depth_m", 0)],
    &[("lateral_mm", -3), ("lateral_m", 0)],
    &[("normal_force_n", 0), ("normal_force_mn", -3)],
    &[("lateral_force_n", 0), ("lateral_force_mn", -3)],
];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str = "depth_mm,lateral_mm,normal_force_n,lateral_force_n, in any order, lengths also as _m, forces also as _mn";

impl ForceMap {
    /// The measured map in `text`, the content of `file`. The map records the file's name without
    /// its folder, `note`, and the `phantom` that was measured, if it is known.
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let text = "lateral_mm,depth_mm,normal_force_mn,lateral_force_mn\n0,4,1500,0\n2,4,1250,-125\n";
    /// let map = ForceMap::from_csv(text, "gel.csv", "third gel", None)?;
    /// assert_eq!((map.depths(), map.laterals()), (&[0.004][..], &[0.0, 0.002][..]));
    /// assert_eq!(map.lateral_force().values(), [0.0, -0.125]);
    /// # Ok::<(), palpate::force_map::ForceMapFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`ForceMapFileError`] if the header does not name the four columns, a row is malformed, a
    /// pose is missing or there twice, or the forces make no map (see [`ForceMap::new`]).
    ///
    /// Implements: MAP-026, MAP-030, MAP-031, MAP-032, MAP-033, MAP-034, MAP-035, MAP-037, MAP-038.
    pub fn from_csv(
        text: &str,
        file: &str,
        note: &str,
        phantom: Option<Phantom>,
    ) -> Result<ForceMap, ForceMapFileError> {
        let forces = ForceTable::from_csv(text, file)?;
        let name = Path::new(file)
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let source = Source::Measured {
            file: name.unwrap_or_default(),
            note: note.into(),
        };
        ForceMap::new(source, phantom, forces)
            .map_err(|invalid| ForceMapFileProblem::from(invalid).at(file, None))
    }
}

impl ForceTable {
    /// This table as CSV, row by row, lengths in mm and forces in N.
    ///
    /// Implements: MAP-030, MAP-036.
    pub fn to_csv(&self) -> String {
        let mut text = COLUMNS.map(|names| names[0].0).join(",") + "\n";
        let forces = self
            .normal_force()
            .entries()
            .zip(self.lateral_force().values());
        for ((row, column, normal), &lateral) in forces {
            let fields = [self.depths()[row], self.laterals()[column], normal, lateral];
            let written = std::iter::zip(fields, COLUMNS)
                .map(|(value, names)| format_scaled(value, -names[0].1));
            text.push_str(&written.collect::<Vec<_>>().join(","));
            text.push('\n');
        }
        text
    }

    /// The table in `text`, the content of `file`: see [`ForceMap::from_csv`].
    ///
    /// # Errors
    /// As [`ForceMap::from_csv`].
    ///
    /// Implements: MAP-030, MAP-031, MAP-032, MAP-033, MAP-034, MAP-035, MAP-038.
    pub fn from_csv(text: &str, file: &str) -> Result<ForceTable, ForceMapFileError> {
        let refused = |line| move |problem| ForceMapFileProblem::from(problem).at(file, line);
        let ((line, header), rows) = header_and_rows(text);
        let header = Header::parse(header, COLUMNS, EXPECTED_HEADER).map_err(refused(line))?;
        let mut points = Vec::new();
        for (line, row) in rows {
            let numbers = header.numbers(row).map_err(refused(line))?;
            points.push(Point::new(line, numbers));
        }
        check_grid(&mut points, file).and_then(|(depths, laterals)| {
            let columns = laterals.len();
            let matrix = |force: fn(&Point) -> f64| {
                Matrix::from_fn(depths.len(), columns, |row, column| {
                    force(&points[row * columns + column])
                })
            };
            let normal = matrix(|point| point.normal_force);
            let lateral = matrix(|point| point.lateral_force);
            ForceTable::new(depths, laterals, normal, lateral)
                .map_err(|invalid| ForceMapFileProblem::from(invalid).at(file, None))
        })
    }
}

/// One row of the file, SI.
struct Point {
    line: usize,
    depth: f64,
    lateral: f64,
    normal_force: f64,
    lateral_force: f64,
}

impl Point {
    /// The row in `line` with the numbers of [`COLUMNS`].
    fn new(line: usize, [depth, lateral, normal_force, lateral_force]: [f64; 4]) -> Point {
        Point {
            line,
            // Adding 0 makes −0 the same position as 0.
            depth: depth + 0.0,
            lateral: lateral + 0.0,
            normal_force,
            lateral_force,
        }
    }

    fn order(&self, other: &Point) -> Ordering {
        let depths = self.depth.total_cmp(&other.depth);
        depths.then(self.lateral.total_cmp(&other.lateral))
    }
}

/// Sorts `points` by depth, then by lateral position, and gives both axes (m). There is exactly one
/// point for each pose of the grid, or an error.
///
/// The poses are compared one by one, never laid out: n rows can span n² of them.
///
/// Implements: MAP-033, MAP-034, MAP-037.
fn check_grid(points: &mut [Point], file: &str) -> Result<(Vec<f64>, Vec<f64>), ForceMapFileError> {
    points.sort_by(Point::order); // stable: the first line of a pose stays first
    let mm = |length| format_scaled(length, 3);
    for pair in points.windows(2) {
        let [first, second] = pair else { continue };
        if first.order(second) == Ordering::Equal {
            let problem = ForceMapFileProblem::Repeated {
                depth_mm: mm(second.depth),
                lateral_mm: mm(second.lateral),
                first: first.line,
            };
            return Err(problem.at(file, second.line));
        }
    }
    let depths = distinct(points.iter().map(|point| point.depth));
    let laterals = distinct(points.iter().map(|point| point.lateral));
    let mut rest = points.iter().peekable();
    for &depth in &depths {
        for &lateral in &laterals {
            let here = |point: &&Point| point.depth == depth && point.lateral == lateral;
            if rest.next_if(here).is_none() {
                let (depths, laterals) = (depths.len(), laterals.len());
                let (depth_mm, lateral_mm) = (mm(depth), mm(lateral));
                let problem = ForceMapFileProblem::Missing {
                    depth_mm,
                    lateral_mm,
                    depths,
                    laterals,
                };
                return Err(problem.at(file, None));
            }
        }
    }
    Ok((depths, laterals))
}

/// The distinct numbers of `values`, increasing.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
