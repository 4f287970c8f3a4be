//! Tables of numbers as CSV, whose header names each column with its unit: what the readers of
//! force maps and of traces share.

use crate::decimal::parse_scaled;
use crate::refusal::{Refusal, shortened};

/// What a column can be called, and for each name the power of ten from its unit to SI. Of several groups of names the first that
/// the header has counts.
///
/// Implements: CON-002.
pub type Column = &'static [&'static [(&'static str, i32)]];

/// A table of `N` columns.
pub struct Rows<const N: usize> {
    /// The line of the header, from 1.
    pub line: usize,
    /// What each column is called, as in [`Column`].
    pub names: [&'static str; N],
    /// The line of each row, and its numbers in the order of the columns, SI.
    pub rows: Vec<(usize, [f64; N])>,
    /// What a person should know of how the table was read.
    pub notes: Vec<String>,
}

impl<const N: usize> Rows<N> {
    /// The table in `text`, whose header must name each of `columns` once; `expected` says so to a person. Other columns do not
    /// count.
    ///
    /// # Errors
    /// Another header; a row of another length, or with a field that is no finite decimal number; with the line.
    ///
    /// Implements: MAP-030, MAP-033, MAP-041, MAP-040, TRC-001, TRC-004.
    pub fn parse(text: &str, columns: [Column; N], expected: &str) -> Result<Self, Refusal> {
        let ((line, header), lines) = header_and_rows(text);
        // Of equally many fields the last makes it: the comma.
        let separators = ['\t', ';', ','].into_iter();
        let separator = separators.max_by_key(|&separator| split(header, separator).count());
        let separator = separator.unwrap_or(',');
        let fields: Vec<&str> = split(header, separator).collect();
        let mut places = [(0, "", 0); N];
        for (place, column) in places.iter_mut().zip(columns) {
            *place = find(&fields, column).map_err(|found| {
                let header = shortened(header.trim());
                Refusal::state(
                    format!("{found} in the header {header:?}"),
                    format!("give {expected}"),
                )
                .at(line)
            })?;
        }
        // Where commas separate the fields, none is a decimal comma.
        let mut mark = (separator == ',').then_some('.');
        let mut numbers = |row| {
            let fields = counted(split(row, separator).collect(), fields.len(), header)?;
            let mut numbers = [0.0; N];
            for (number, (place, name, power)) in numbers.iter_mut().zip(places) {
                *number = decimal(fields[place], power, &mut mark).ok_or_else(|| {
                    let found = format!("{:?}", shortened(fields[place]));
                    let with = match mark.filter(|_| separator != ',') {
                        Some(mark) => format!(" with the decimal mark {mark:?} of the file"),
                        None => String::new(),
                    };
                    Refusal::value(name, found, format!("a finite decimal number{with}"))
                })?;
            }
            Ok(numbers)
        };
        let row = |(line, row)| match numbers(row) {
            Ok(numbers) => Ok((line, numbers)),
            Err(refusal) => Err(Refusal::at(refusal, line)),
        };
        let rows = lines.map(row).collect::<Result<_, _>>()?;
        let mut notes = Vec::from_iter(unused(&fields, &places.map(|(place, ..)| place)));
        if mark == Some(',') {
            notes.push("commas in its numbers are decimal commas".into());
        }
        Ok(Rows {
            line,
            names: places.map(|(_, name, _)| name),
            rows,
            notes,
        })
    }
}

/// What there is to say of the columns of a header that are not `used`, if any.
///
/// Implements: MAP-044.
fn unused(header: &[&str], used: &[usize]) -> Option<String> {
    // A first column without a name numbers the rows.
    let others = (0..).zip(header).filter(|&(place, name)| {
        let is_index = (place, *name) == (0, "");
        !is_index && !used.contains(&place)
    });
    let names = others.map(|(_, name)| format!("{:?}", shortened(name)));
    match &names.collect::<Vec<_>>()[..] {
        [] => None,
        [name] => Some(format!("column {name} is not used")),
        names => Some(format!("columns {} are not used", names.join(", "))),
    }
}

/// Where in a header a column is, under which name, and the power of ten of that.
///
/// Implements: MAP-030, MAP-033.
fn find(header: &[&str], column: Column) -> Result<(usize, &'static str, i32), String> {
    for names in column {
        let named = (0..).zip(header).filter_map(|(place, field)| {
            let same = |(name, _): &&(&str, i32)| name.eq_ignore_ascii_case(field);
            let &(name, power) = names.iter().find(same)?;
            Some((place, name, power))
        });
        match named.collect::<Vec<_>>()[..] {
            [] => {}
            [only] => return Ok(only),
            [(_, first, _), (_, second, _), ..] => {
                return Err(format!("columns {first} and {second}"));
            }
        }
    }
    let names = column.iter().copied().flatten().map(|(name, _)| *name);
    let names: Vec<_> = names.collect();
    Err(format!("no column {}", names.join(" or ")))
}

/// The fields of a line, without the spaces and then the quotes around them. A separator between quotes is none.
///
/// Implements: MAP-040.
fn split(line: &str, separator: char) -> impl Iterator<Item = &str> {
    let mut quoted = false;
    let fields = line.split(move |c| {
        quoted ^= c == '"';
        c == separator && !quoted
    });
    fields.map(str::trim).map(|field| {
        let rest = field.strip_prefix('"');
        let inner = rest.and_then(|rest| rest.strip_suffix('"'));
        inner.map_or(field, str::trim)
    })
}

/// The number in a field, whose decimal mark is that of the file; the first one that is there sets it.
///
/// Implements: MAP-041, MAP-033.
fn decimal(field: &str, power: i32, mark: &mut Option<char>) -> Option<f64> {
    if let Some(own) = field.chars().find(|c| matches!(c, '.' | ','))
        && *mark.get_or_insert(own) != own
    {
        return None;
    }
    parse_scaled(&field.replacen(',', ".", 1), power)
}

/// The lines of `text` that say something, with their numbers from 1: neither blank nor a
/// comment. The header is the first; without any it is an empty line 1.
///
/// Implements: MAP-032, TRC-001.
pub fn header_and_rows(text: &str) -> ((usize, &str), impl Iterator<Item = (usize, &str)>) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| {
        let content = line.trim();
        !content.is_empty() && !content.starts_with('#')
    });
    (lines.next().unwrap_or((1, "")), lines)
}

/// A header that does not name the columns.
pub fn wrong_header(header: &str, expected: &str) -> Refusal {
    Refusal::state(
        format!("header {:?}", shortened(header.trim())),
        format!("give {expected}"),
    )
}

/// The fields of a row between commas, trimmed, which must be `expected` as in the header.
pub fn fields<'a>(row: &'a str, expected: usize, header: &str) -> Result<Vec<&'a str>, Refusal> {
    counted(row.split(',').map(str::trim).collect(), expected, header)
}

/// The fields of a row, which must be `expected` as in the header.
fn counted<'a>(
    fields: Vec<&'a str>,
    expected: usize,
    header: &str,
) -> Result<Vec<&'a str>, Refusal> {
    if fields.len() == expected {
        return Ok(fields);
    }
    let expected = format!("give {expected}, as in the header {:?}", header.trim());
    Err(Refusal::state(format!("{} fields", fields.len()), expected))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_asserts::assert_cases;

    const COLUMNS: [Column; 2] = [
        &[&[("x_mm", -3), ("x_m", 0)], &[("t_s", 0)]],
        &[&[("force_n", 0), ("force_mn", -3)]],
    ];

    fn read(text: &str) -> Result<Rows<2>, String> {
        Rows::parse(text, COLUMNS, "x_mm,force_n").map_err(|refusal| refusal.to_string())
    }

    // Verifies: MAP-040, MAP-041, MAP-030, MAP-044.
    #[test]
    fn tables_are_read_as_they_come() {
        assert_cases("refused/csv.txt", "the same table", |text| {
            let found = read(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
            let rows: Vec<_> = found.rows.iter().map(|(_, numbers)| *numbers).collect();
            assert_eq!(rows, [[5e-4, -1.25], [1.0, 2.0]], "{text:?}");
            match &found.notes[..] {
                [] => "nothing".into(),
                notes => notes.join("; "),
            }
        });
        let found = read("t_s,force_n\n0.5,1\n").unwrap();
        assert_eq!((found.names, found.line), (["t_s", "force_n"], 1));
        assert_eq!(found.rows, [(2, [0.5, 1.0])]);
    }

    // Verifies: MAP-040, MAP-033.
    #[test]
    fn tables_that_are_not_clear_are_refused_in_one_line() {
        let refusal = |text: &str| read(text).err().expect("a refusal");
        assert_cases("refused/csv.txt", "tables that are not clear", refusal);
    }
}
