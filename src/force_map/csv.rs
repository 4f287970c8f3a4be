//! Measured force maps as CSV (`spec/force-map.md`).

use std::cmp::Ordering;
use std::path::Path;

use super::file::{ForceMapFileError, ForceMapFileProblem, shortened};
use super::{ForceMap, ForceTable, Matrix, Source};
use crate::phantom::Phantom;
use crate::phantom::decimal::{format_scaled, parse_scaled};

/// What a column can be called, and the power of ten from its unit to SI; depth, lateral position,
/// normal force, lateral force.
const COLUMNS: [[(&str, i32); 2]; 4] = [
    [("depth_mm", -3), ("depth_m", 0)],
    [("lateral_mm", -3), ("lateral_m", 0)],
    [("normal_force_n", 0), ("normal_force_mn", -3)],
    [("lateral_force_n", 0), ("lateral_force_mn", -3)],
];

impl ForceMap {
    /// The measured map in `text`, the content of `file`. The map records the file's name without
    /// its folder, `note`, and the `phantom` that was measured, if it is known.
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
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = (1..)
            .zip(text.lines())
            .map(|(line, content)| (line, content.trim()))
            .filter(|(_, content)| !content.is_empty() && !content.starts_with('#'));
        let (line, header) = lines.next().unwrap_or((1, ""));
        let header = Header::parse(header).map_err(|problem| problem.at(file, line))?;
        let mut points = Vec::new();
        for (line, row) in lines {
            let point = header
                .point(line, row)
                .map_err(|problem| problem.at(file, line))?;
            points.push(point);
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

/// Which field of a row is what.
struct Header<'a> {
    text: &'a str,
    /// Place, name and power of ten of each of [`COLUMNS`].
    columns: [(usize, &'static str, i32); 4],
}

impl<'a> Header<'a> {
    fn parse(text: &'a str) -> Result<Header<'a>, ForceMapFileProblem> {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let refused = || ForceMapFileProblem::Header {
            found: shortened(text),
        };
        // Four fields and each column among them: none is there twice.
        if fields.len() != COLUMNS.len() {
            return Err(refused());
        }
        let mut columns = [(0, "", 0); COLUMNS.len()];
        for (column, names) in columns.iter_mut().zip(COLUMNS) {
            let mut found = fields.iter().enumerate().filter_map(|(place, field)| {
                let &(name, power) = names.iter().find(|(name, _)| name == field)?;
                Some((place, name, power))
            });
            *column = found.next().ok_or_else(refused)?;
        }
        Ok(Header { text, columns })
    }

    fn point(&self, line: usize, row: &str) -> Result<Point, ForceMapFileProblem> {
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != COLUMNS.len() {
            return Err(ForceMapFileProblem::Fields {
                found: fields.len(),
                expected: COLUMNS.len(),
                header: self.text.into(),
            });
        }
        let mut values = [0.0; 4];
        for (value, (place, name, power)) in values.iter_mut().zip(self.columns) {
            *value = parse_scaled(fields[place], power).ok_or_else(|| {
                let (column, found) = (name.into(), shortened(fields[place]));
                ForceMapFileProblem::Number { column, found }
            })?;
        }
        let [depth, lateral, normal_force, lateral_force] = values;
        // Adding 0 makes −0 the same position as 0.
        let (depth, lateral) = (depth + 0.0, lateral + 0.0);
        Ok(Point {
            line,
            depth,
            lateral,
            normal_force,
            lateral_force,
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
