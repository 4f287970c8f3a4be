//! What JSON and CSV files of force maps have in common: reading by path, and errors.

use std::fmt;
use std::path::Path;

use super::{ForceMap, InvalidForceMap};
use crate::csv::CsvProblem;

/// Why a file of a force map is refused: one line that begins with the file.
///
/// ```
/// use palpate::force_map::ForceMap;
///
/// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5\n";
/// let error = ForceMap::from_csv(text, "gel.csv", "", None).unwrap_err();
/// assert_eq!((error.file.as_str(), error.line), ("gel.csv", Some(2)));
/// assert!(error.to_string().starts_with("gel.csv:2: 3 fields, expected 4"));
/// ```
///
/// Implements: MAP-026.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceMapFileError {
    /// The file, as its reader named it.
    pub file: String,
    /// The line, from 1, where there is one.
    pub line: Option<usize>,
    /// What is wrong there.
    pub problem: ForceMapFileProblem,
}

impl fmt::Display for ForceMapFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.problem),
            None => write!(f, "{}: {}", self.file, self.problem),
        }
    }
}

impl std::error::Error for ForceMapFileError {}

/// What is wrong with a file of a force map.
///
/// ```
/// use palpate::force_map::{ForceMap, ForceMapFileProblem};
///
/// let error = ForceMap::from_json(r#"{"schema": "another"}"#, "map.json").unwrap_err();
/// assert!(matches!(error.problem, ForceMapFileProblem::Schema { key: "schema", .. }));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForceMapFileProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(String),
    /// The text is not JSON, or its keys and types are not those of a force map.
    #[error("column {column}: {message}, in {excerpt:?}")]
    Json {
        /// Column, from 1, in bytes.
        column: usize,
        /// What is wrong, with the key.
        message: String,
        /// The text around that place.
        excerpt: String,
    },
    /// Another kind of file, or another version of it.
    #[error("{key} = {found}, expected {expected}")]
    Schema {
        /// `schema` or `schema_version`.
        key: &'static str,
        /// The value.
        found: String,
        /// What it would be.
        expected: String,
    },
    /// The keys do not fit one another.
    #[error("{key} is {found}, expected {expected}")]
    Key {
        /// The key.
        key: &'static str,
        /// `missing` or `there`.
        found: &'static str,
        /// What would be right.
        expected: &'static str,
    },
    /// A line of a CSV file is malformed.
    #[error(transparent)]
    Csv(#[from] CsvProblem),
    /// Two CSV rows for one pose.
    #[error(
        "second row for depth {depth_mm} mm, lateral {lateral_mm} mm, expected one; the first is line {first}"
    )]
    Repeated {
        /// The depth, mm.
        depth_mm: String,
        /// The lateral position, mm.
        lateral_mm: String,
        /// The line of the first row.
        first: usize,
    },
    /// No CSV row for a pose of the grid.
    #[error(
        "no row for depth {depth_mm} mm, lateral {lateral_mm} mm, expected one for each of the {depths} depths at each of the {laterals} lateral positions in the file"
    )]
    Missing {
        /// The depth, mm.
        depth_mm: String,
        /// The lateral position, mm.
        lateral_mm: String,
        /// Depths in the file.
        depths: usize,
        /// Lateral positions in the file.
        laterals: usize,
    },
    /// The values make no force map.
    #[error(transparent)]
    Invalid(#[from] InvalidForceMap),
}

impl ForceMapFileProblem {
    /// This problem in `line` (from 1) of `file`.
    pub(super) fn at(self, file: &str, line: impl Into<Option<usize>>) -> ForceMapFileError {
        let (file, line) = (file.into(), line.into());
        ForceMapFileError {
            file,
            line,
            problem: self,
        }
    }
}

impl ForceMap {
    /// Reads the map at `path`: measured forces if its name ends in `.csv`, else JSON.
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n";
    /// let path = std::env::temp_dir().join(format!("map-{}.csv", std::process::id()));
    /// std::fs::write(&path, text)?;
    /// assert_eq!(ForceMap::read(&path)?.normal_force().values(), [1.5]);
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`ForceMap::from_csv`] and [`ForceMap::from_json`]; [`ForceMapFileProblem::Read`] if the
    /// file cannot be read as UTF-8.
    ///
    /// Implements: MAP-026.
    pub fn read(path: &Path) -> Result<ForceMap, ForceMapFileError> {
        let file = path.display().to_string();
        let text = crate::input::read(path)
            .map_err(|error| ForceMapFileProblem::Read(error.to_string()).at(&file, None))?;
        let is_csv = |extension: &std::ffi::OsStr| extension.eq_ignore_ascii_case("csv");
        if path.extension().is_some_and(is_csv) {
            ForceMap::from_csv(&text, &file, "", None)
        } else {
            ForceMap::from_json(&text, &file)
        }
    }
}
