//! Tables of numbers as CSV, whose header names each column with its unit: what the readers of
//! force maps and of traces share.

use crate::phantom::decimal::parse_scaled;

/// What a column can be called, and for each name the power of ten from its unit to SI.
///
/// Implements: CON-002.
pub(crate) type Column = &'static [(&'static str, i32)];

/// What is wrong with a line of a CSV file.
///
/// ```
/// use palpate::csv::CsvProblem;
/// use palpate::force_map::{ForceMapFileProblem, ForceTable};
///
/// let problem = ForceTable::from_csv("depth,force\n1,2\n", "gel.csv").unwrap_err().problem;
/// assert!(matches!(
///     problem,
///     ForceMapFileProblem::Csv(CsvProblem::Header { found, .. }) if found == "depth,force"
/// ));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CsvProblem {
    /// A header that does not name the columns.
    #[error("header {found:?}, expected {expected}")]
    Header {
        /// The header.
        found: String,
        /// The headers that would be right.
        expected: &'static str,
    },
    /// A row with too few or too many fields.
    #[error("{found} fields, expected {expected}, as in the header {header:?}")]
    Fields {
        /// Fields in the row.
        found: usize,
        /// Fields in the header.
        expected: usize,
        /// The header.
        header: String,
    },
    /// A field that is no number.
    #[error("{column} = {found:?}, expected a finite decimal number")]
    Number {
        /// The column, as in the header.
        column: String,
        /// The field.
        found: String,
    },
}

/// The lines of `text` that say something, trimmed, with their numbers from 1: neither blank nor a
/// comment. The header is the first; without any it is an empty line 1.
///
/// Implements: MAP-032, TRC-003.
pub(crate) fn header_and_rows(text: &str) -> ((usize, &str), impl Iterator<Item = (usize, &str)>) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..)
        .zip(text.lines())
        .map(|(line, content)| (line, content.trim()))
        .filter(|(_, content)| !content.is_empty() && !content.starts_with('#'));
    (lines.next().unwrap_or((1, "")), lines)
}

/// Which field of a row is what.
pub(crate) struct Header<'a, const N: usize> {
    text: &'a str,
    /// Place, name and power of ten of each column.
    columns: [(usize, &'static str, i32); N],
}

impl<'a, const N: usize> Header<'a, N> {
    /// The header in `text`, which must name each of `columns` once and nothing else; `expected`
    /// says so to a person.
    ///
    /// Implements: MAP-030, TRC-001.
    pub(crate) fn parse(
        text: &'a str,
        columns: [Column; N],
        expected: &'static str,
    ) -> Result<Self, CsvProblem> {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let refused = || CsvProblem::Header {
            found: shortened(text),
            expected,
        };
        // N fields and each of the N columns among them: none is there twice.
        if fields.len() != N {
            return Err(refused());
        }
        let mut places = [(0, "", 0); N];
        for (place, names) in places.iter_mut().zip(columns) {
            let mut found = fields.iter().enumerate().filter_map(|(place, field)| {
                let &(name, power) = names.iter().find(|(name, _)| name == field)?;
                Some((place, name, power))
            });
            *place = found.next().ok_or_else(refused)?;
        }
        Ok(Header {
            text,
            columns: places,
        })
    }

    /// The name of a column in this header.
    pub(crate) fn name(&self, column: usize) -> &'static str {
        self.columns[column].1
    }

    /// The numbers of a row in the order of the columns, SI.
    ///
    /// Implements: MAP-031, MAP-035, MAP-038, TRC-002, TRC-004.
    pub(crate) fn numbers(&self, row: &str) -> Result<[f64; N], CsvProblem> {
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != N {
            return Err(CsvProblem::Fields {
                found: fields.len(),
                expected: N,
                header: self.text.into(),
            });
        }
        let mut numbers = [0.0; N];
        for (number, (place, name, power)) in numbers.iter_mut().zip(self.columns) {
            *number = parse_scaled(fields[place], power).ok_or_else(|| {
                let (column, found) = (name.into(), shortened(fields[place]));
                CsvProblem::Number { column, found }
            })?;
        }
        Ok(numbers)
    }
}

/// The beginning of `text`, enough to recognise it in a message.
pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}

/// `text` with a space for each control character: a message that quotes a file stays one line, and
/// no terminal obeys it.
///
/// Implements: EVD-082.
pub fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
