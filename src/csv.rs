//! Tables of numbers as CSV, whose header names each column with its unit: what the readers of
//! force maps and of traces share.

use crate::decimal::parse_scaled;
use crate::refusal::{Refusal, shortened};

/// What a column can be called, and for each name the power of ten from its unit to SI.
///
/// Implements: CON-002.
pub(crate) type Column = &'static [(&'static str, i32)];

/// A table of `N` columns.
pub(crate) struct Rows<const N: usize> {
    /// The line of the header, from 1.
    pub line: usize,
    /// What the header calls each column.
    pub names: Vec<&'static str>,
    /// The line of each row, and its numbers in the order of the columns, SI.
    pub rows: Vec<(usize, [f64; N])>,
}

impl<const N: usize> Rows<N> {
    /// The table in `text`, whose header must name each of `columns` once and nothing else; `expected` says so to a person.
    ///
    /// # Errors
    /// Another header; a row of another length, or with a field that is no finite decimal number; with the line.
    ///
    /// Implements: MAP-030, MAP-031, MAP-035, MAP-038, TRC-001, TRC-002, TRC-004.
    pub fn parse(text: &str, columns: [Column; N], expected: &str) -> Result<Self, Refusal> {
        let ((line, header), lines) = header_and_rows(text);
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let place = |column: Column| {
            let named = |(place, field): (usize, &&str)| {
                let &(name, power) = column.iter().find(|(name, _)| name == field)?;
                Some((place, name, power))
            };
            names.iter().enumerate().find_map(named)
        };
        let places: Vec<_> = columns.into_iter().filter_map(place).collect();
        // N fields and each of the N columns among them: none is there twice.
        if [names.len(), places.len()] != [N; 2] {
            return Err(wrong_header(header, expected).at(line));
        }
        let numbers = |(line, row)| {
            let fields = fields(row, N, header)?;
            let mut numbers = [0.0; N];
            for (number, &(place, name, power)) in numbers.iter_mut().zip(&places) {
                let found = fields[place];
                *number = parse_scaled(found, power).ok_or_else(|| {
                    let found = format!("{:?}", shortened(found));
                    Refusal::value(name, found, "a finite decimal number")
                })?;
            }
            Ok((line, numbers))
        };
        let rows = lines.map(|row| numbers(row).map_err(|refusal: Refusal| refusal.at(row.0)));
        Ok(Rows {
            line,
            rows: rows.collect::<Result<_, _>>()?,
            names: places.into_iter().map(|(_, name, _)| name).collect(),
        })
    }
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

/// A header that does not name the columns.
pub(crate) fn wrong_header(header: &str, expected: &str) -> Refusal {
    Refusal::state(format!("header {:?}", shortened(header)), expected)
}

/// The fields of a row, trimmed, which must be `expected` as in the header.
pub(crate) fn fields<'a>(
    row: &'a str,
    expected: usize,
    header: &str,
) -> Result<Vec<&'a str>, Refusal> {
    let fields: Vec<&str> = row.split(',').map(str::trim).collect();
    if fields.len() == expected {
        return Ok(fields);
    }
    let expected = format!("{expected}, as in the header {header:?}");
    Err(Refusal::state(format!("{} fields", fields.len()), expected))
}
