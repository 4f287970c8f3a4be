//! Tables of numbers as CSV, whose header names each column with its unit: what the readers of
//! force maps and of traces share.

use crate::decimal::parse_scaled;
use crate::refusal::{Refusal, shortened};

mod columns;

use columns::{By, Found, UnitBy, find, names};
pub use columns::{Column, Layout};

/// Lines among which the header is looked for.
const MOST_LINES_BEFORE: usize = 200;

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
    /// Rows that were left out because they lack a number.
    pub(crate) missing: usize,
    /// Whether the line below the header gives the units.
    pub(crate) has_units: bool,
    /// The decimal mark of its numbers, if it is known.
    pub(crate) mark: Option<char>,
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
        Ok(Rows::parse_optional(text, columns, N, expected, &Layout::default(), false)?.0)
    }

    /// As [`Rows::parse`], of a file in this layout, where the header may lack all columns but the first `required`: their numbers are then
    /// 0. Also whether each is there. Of samples, those that lack a number, empty or NaN, are left out with a note.
    ///
    /// # Errors
    /// As [`Rows::parse`]; a layout that states what the table does not have.
    ///
    /// Implements: MAP-045, MAP-046, MAP-047, MAP-048, CAL-001, TRC-011, TRC-080, MAP-083.
    pub fn parse_optional(
        text: &str,
        columns: [Column; N],
        required: usize,
        expected: &str,
        layout: &Layout,
        are_samples: bool,
    ) -> Result<(Self, [bool; N]), Refusal> {
        layout.check(&columns)?;
        let lines = lines(text, layout);
        let header = Header::find(&lines, (columns, required), layout);
        let header = header.map_err(|(found, (line, header))| {
            let found = match layout.is_of_objects {
                true => found.replacen("no column", "no key", 1),
                false if header.trim().is_empty() => "no header and no rows".into(),
                false => format!("{found} in the header {:?}", shortened(header.trim())),
            };
            Refusal::state(found, format!("give {expected}")).at(line)
        })?;
        let mut notes = header.notes(&lines);
        let rows = &lines[header.below..];
        let footer = header.footer(rows);
        if footer > 0 {
            notes.push(format!("lines after the last row are not used: {footer}"));
        }
        // Where commas separate the fields, none is a decimal comma.
        let mut mark = (header.separator == ',').then_some('.').or(layout.mark);
        let mut row = |&(line, row): &(usize, &str)| match header.numbers(row, &mut mark) {
            Ok(numbers) => Ok((line, numbers)),
            Err(refusal) => Err(Refusal::at(refusal, line)),
        };
        let rows = rows[..rows.len() - footer].iter();
        let (missing, rows): (Vec<&_>, Vec<&_>) = rows.partition(|(_, row)| header.lacks(row));
        let first = missing.first().copied();
        let first = first.and_then(|first| row(first).err());
        let rows = rows.into_iter().map(row).collect::<Result<_, _>>()?;
        notes.extend(header.unused());
        if mark == Some(',') {
            notes.push("commas in its numbers are decimal commas".into());
        }
        match first {
            Some(refusal) if !are_samples => return Err(refusal),
            Some(_) => {
                let count = missing.len();
                notes.push(format!(
                    "samples with a missing number are not used: {count}"
                ));
            }
            None => {}
        }
        let table = Rows {
            line: lines[header.at].0,
            names: header
                .found
                .map(|found| found.map_or("", |found| found.name)),
            rows,
            notes,
            missing: missing.len(),
            has_units: header.has_units(),
            mark,
        };
        Ok((table, header.found.map(|found| found.is_some())))
    }
}

/// The lines of `text` that say something and are not skipped, with their numbers; at least one.
fn lines<'a>(text: &'a str, layout: &Layout) -> Vec<(usize, &'a str)> {
    let ((first, line), rest) = header_and_rows(text);
    let lines = std::iter::once((first, line)).chain(rest);
    let mut lines: Vec<_> = lines.filter(|(line, _)| *line > layout.skipped).collect();
    if lines.is_empty() {
        lines.push((first, ""));
    }
    lines
}

/// The header of a table, and where its columns are.
struct Header<'a, const N: usize> {
    /// Its place among the lines.
    at: usize,
    /// The place of the line below it and its units.
    below: usize,
    line: &'a str,
    separator: char,
    fields: Vec<&'a str>,
    /// None of a column that is not there.
    found: [Option<Found>; N],
}

impl<'a, const N: usize> Header<'a, N> {
    /// The first line that names the columns and has numbers below it, else the first that names them.
    ///
    /// # Errors
    /// What is wrong with that line, or with the first where none names them.
    ///
    /// Implements: MAP-047.
    fn find(
        lines: &[(usize, &'a str)],
        columns: ([Column; N], usize),
        layout: &Layout,
    ) -> Result<Header<'a, N>, (String, (usize, &'a str))> {
        let mut named = None;
        for at in 0..lines.len().min(MOST_LINES_BEFORE) {
            if let Ok(header) = Header::of(lines, at, columns, layout) {
                let is_row = |row| header.lacks(row) || header.numbers(row, &mut None).is_ok();
                let row = lines.get(header.below);
                if row.is_some_and(|(_, row)| is_row(row)) {
                    named = Some(header);
                    break;
                }
                named.get_or_insert(header);
            }
        }
        let first = || Header::of(lines, 0, columns, layout);
        let header = named.map_or_else(|| first().map_err(|found| (found, lines[0])), Ok)?;
        let mut wrong = header.found.iter().flatten().filter_map(|found| {
            let why = match (found.by, found.unit) {
                (By::Unitless, _) => "has no unit",
                (_, UnitBy::Two) => "has two units, one in its name and one below it,",
                _ => return None,
            };
            Some(format!("column {} {why}", found.place + 1))
        });
        match wrong.next() {
            None => Ok(header),
            Some(wrong) => Err((wrong, lines[header.at])),
        }
    }

    /// The columns in one line.
    ///
    /// Implements: MAP-040.
    fn of(
        lines: &[(usize, &'a str)],
        at: usize,
        (columns, required): ([Column; N], usize),
        layout: &Layout,
    ) -> Result<Header<'a, N>, String> {
        let line = lines[at].1;
        // Of equally many fields the last makes it: the comma.
        let separators = ['\t', ';', ','].into_iter();
        let separator = separators.max_by_key(|&separator| split(line, separator).count());
        let separator = separator.unwrap_or(',');
        let fields: Vec<&str> = split(line, separator).collect();
        let is_there = |column| layout.states(column) || fields.iter().any(|of| names(of, column));
        let mut found = [None; N];
        for (at, (found, column)) in found.iter_mut().zip(columns).enumerate() {
            if at < required || is_there(column) {
                *found = Some(find(&fields, column, layout)?);
            }
        }
        let mut places: Vec<_> = (found.iter().zip(columns))
            .filter_map(|(of, column)| Some((of.as_ref()?.place, column.first()?.first()?.0)))
            .collect();
        places.sort_by_key(|(place, _)| *place);
        if let Some(twice) = places.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let ((place, one), (_, other)) = (twice[0], twice[1]);
            return Err(format!("column {} for both {one} and {other}", place + 1));
        }
        let units = lines.get(at + 1).and_then(|(_, row)| {
            let units: Vec<&str> = split(row, separator).collect();
            in_units(found, columns, &units)
        });
        Ok(Header {
            at,
            below: at + 1 + usize::from(units.is_some()),
            line,
            separator,
            fields,
            found: units.unwrap_or(found),
        })
    }

    fn has_units(&self) -> bool {
        self.below > self.at + 1
    }

    /// What a person should know of how the columns were found.
    fn notes(&self, lines: &[(usize, &str)]) -> Vec<String> {
        let mut notes = Vec::new();
        if self.at > 0 {
            let line = lines[self.at].0;
            notes.push(format!(
                "the header is line {line}: what is before it is not used"
            ));
        }
        let is_number = |field: &&str| decimal(field, 0, &mut None).is_some();
        if self.fields.iter().all(is_number) {
            let line = lines[self.at].0;
            notes.push(format!(
                "line {line}, which holds numbers, is taken for the header"
            ));
        }
        if self.has_units() {
            let line = lines[self.at + 1].0;
            notes.push(format!("line {line} gives the units"));
        }
        for found in (self.found.iter().flatten()).filter(|found| found.by == By::Synonym) {
            let name = shortened(self.fields[found.place]);
            notes.push(format!("column {name:?} is read as {}", found.name));
        }
        notes
    }

    /// What there is to say of the columns that are not used, if any.
    ///
    /// Implements: MAP-044.
    fn unused(&self) -> Option<String> {
        let is_used = |place| {
            self.found
                .iter()
                .flatten()
                .any(|found| found.place == place)
        };
        // A first column without a name numbers the rows.
        let others = (0..).zip(&self.fields).filter(|&(place, name)| {
            let is_index = (place, *name) == (0, "");
            !is_index && !is_used(place)
        });
        let names = others.map(|(_, name)| format!("{:?}", shortened(name)));
        match &names.collect::<Vec<_>>()[..] {
            [] => None,
            [name] => Some(format!("column {name} is not used")),
            names => Some(format!("columns {} are not used", names.join(", "))),
        }
    }

    /// How many lines behind the last row of this table are none: they have another number of fields and begin with no number.
    fn footer(&self, rows: &[(usize, &str)]) -> usize {
        let is_row = |row: &str| split(row, self.separator).count() == self.fields.len();
        let is_number = |row: &str| {
            let first = split(row, self.separator).next();
            first.is_some_and(|first| decimal(first, 0, &mut None).is_some())
        };
        let behind = rows
            .iter()
            .rev()
            .take_while(|(_, row)| !is_row(row) && !is_number(row));
        let behind = behind.count();
        if behind < rows.len() { behind } else { 0 }
    }

    /// Whether a row has as many fields as the header, and in the columns that count numbers alone, of which one or more are missing.
    ///
    /// Implements: MAP-048.
    fn lacks(&self, row: &str) -> bool {
        let fields: Vec<&str> = split(row, self.separator).collect();
        if fields.len() != self.fields.len() {
            return false;
        }
        let fields = self.found.iter().flatten().map(|found| fields[found.place]);
        let is_missing = |field: &&str| {
            ["", "nan", "#n/a"]
                .iter()
                .any(|none| field.eq_ignore_ascii_case(none))
        };
        let (missing, others): (Vec<_>, Vec<_>) = fields.partition(is_missing);
        !missing.is_empty()
            && others
                .iter()
                .all(|field| decimal(field, 0, &mut None).is_some())
    }

    /// The numbers of a row, in SI; the first decimal mark that is there sets that of the file.
    fn numbers(&self, row: &str, mark: &mut Option<char>) -> Result<[f64; N], Refusal> {
        let fields = counted(
            split(row, self.separator).collect(),
            self.fields.len(),
            self.line,
        )?;
        let mut numbers = [0.0; N];
        for (number, found) in numbers.iter_mut().zip(self.found) {
            let Some(found) = found else { continue };
            let field = fields[found.place];
            let read = decimal(field, found.power, mark).map(|read| read * found.factor);
            *number = read.filter(|read| read.is_finite()).ok_or_else(|| {
                let with = match mark.filter(|_| self.separator != ',') {
                    Some(mark) => format!(" with the decimal mark {mark:?} of the file"),
                    None => String::new(),
                };
                let text = format!("{:?}", shortened(field));
                Refusal::value(found.name, text, format!("a finite decimal number{with}"))
            })?;
        }
        Ok(numbers)
    }
}

/// The columns in the units of a row, if it is one of units.
fn in_units<const N: usize>(
    mut found: [Option<Found>; N],
    columns: [Column; N],
    units: &[&str],
) -> Option<[Option<Found>; N]> {
    let mut has_unit = false;
    for (found, column) in found.iter_mut().zip(columns) {
        let Some(found) = found else { continue };
        let unit = *units.get(found.place)?;
        if unit.is_empty() && found.by != By::Unitless {
            continue;
        }
        match found.in_unit(column, unit) {
            None if found.unit != UnitBy::User => return None,
            None => {}
            Some(other) => {
                has_unit = true;
                *found = other;
            }
        }
    }
    has_unit.then_some(found)
}

/// The fields of a line, without the spaces and then the quotes around them. A separator between quotes is none.
///
/// Implements: MAP-040.
pub fn split(line: &str, separator: char) -> impl Iterator<Item = &str> {
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

/// What a spreadsheet writes where it has no number.
const NO_NUMBER: [&str; 7] = [
    "#N/A", "#DIV/0!", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!",
];

/// Whether a line, without the spaces around it, is blank or a comment.
///
/// Implements: MAP-032.
pub(crate) fn is_comment(line: &str) -> bool {
    let is_field = NO_NUMBER.iter().any(|error| line.starts_with(error));
    line.is_empty() || line.starts_with('#') && !is_field
}

/// The lines of `text` that say something, with their numbers from 1: neither blank nor a
/// comment. The header is the first; without any it is an empty line 1.
///
/// Implements: MAP-032, TRC-001.
pub fn header_and_rows(text: &str) -> ((usize, &str), impl Iterator<Item = (usize, &str)>) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_said = |(_, line): &(usize, &str)| !is_comment(line.trim());
    // Old Macintosh programs end a line with a carriage return alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let lines = text
        .split_terminator(end)
        .map(|line| line.trim_end_matches('\r'));
    let mut lines = (1..).zip(lines).filter(is_said);
    (lines.next().unwrap_or((1, "")), lines)
}

/// A header that does not name the columns.
pub fn wrong_header(header: &str, expected: &str) -> Refusal {
    Refusal::state(
        format!("header {:?}", shortened(header.trim())),
        format!("give {expected}"),
    )
}

/// The fields of a row between commas, as [`split`] finds them, which must be `expected` as in the header.
pub fn fields<'a>(row: &'a str, expected: usize, header: &str) -> Result<Vec<&'a str>, Refusal> {
    counted(split(row, ',').collect(), expected, header)
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

    // Verifies: MAP-033.
    #[test]
    fn the_lines_of_a_table_are_counted_beyond_16_bits() {
        let text = "t_s,force_n\n".to_string() + &"1,2\n".repeat(1 << 16);
        let last = read(&text).unwrap().rows.pop();
        assert_eq!(last, Some((65_537, [1.0, 2.0])));
        let refused = read(&(text + "1,none\n")).err().unwrap();
        assert!(refused.starts_with("line 65538: "), "{refused}");
    }

    // Verifies: MAP-048.
    #[test]
    fn samples_that_lack_a_number_are_left_out_and_counted() {
        let text = "t_s,force_n,note\n1,,a\n2,5,\n3,NaN,c\n,4,d\n6,7,nan\n";
        let layout = Layout::default();
        let read = |text: &str, are_samples| {
            Rows::parse_optional(text, COLUMNS, 1, "", &layout, are_samples)
        };
        let (read_all, is_there) = read(text, true).unwrap();
        assert_eq!(is_there, [true; 2]);
        assert_eq!(read_all.rows, [(3, [2.0, 5.0]), (6, [6.0, 7.0])]);
        let notes = [
            "column \"note\" is not used",
            "samples with a missing number are not used: 3",
        ];
        assert_eq!(read_all.notes, notes);
        // What is no number lacks none: a row of units that are not known, or text.
        for row in [",gf", "1,none", "none,"] {
            let text = format!("t_s,force_n\n{row}\n1,2\n");
            let refused = read(&text, true).err().expect(row).to_string();
            assert!(refused.starts_with("line 2: "), "{refused}");
        }
        // A spreadsheet's "not available" is missing, and its other errors are no comments.
        let spreadsheet = "t_s,force_n\n# a pass\n#N/A,#N/A\n1,#n/a\n2,5\n";
        let (read_all, _) = read(spreadsheet, true).unwrap();
        assert_eq!(read_all.rows, [(5, [2.0, 5.0])]);
        assert_eq!(
            read_all.notes,
            ["samples with a missing number are not used: 2"]
        );
        for error in ["#DIV/0!", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!"] {
            let text = format!("t_s,force_n\n1,2\n{error},3\n");
            let refused = read(&text, true).err().expect(error).to_string();
            assert!(refused.starts_with("line 3: t_s"), "{refused}");
        }
        // A table of other numbers is refused.
        let whole = Rows::parse(text, COLUMNS, "").err().unwrap().to_string();
        let optional = read(text, false).err().unwrap().to_string();
        let expected = "line 2: force_n = \"\", but must be";
        assert!(whole.starts_with(expected), "{whole}");
        assert_eq!(optional, whole);
    }

    // Verifies: MAP-046.
    #[test]
    fn no_two_quantities_share_a_column() {
        const FOUR: [Column; 4] = [
            &[&[("position_mm", -3)]],
            &[&[("normal_force_n", 0)]],
            &[&[("lateral_force_n", 0)]],
            &[&[("depth_mm", -3)]],
        ];
        let stated = |[position, normal, lateral, depth]: [usize; 4]| {
            let layout = format!(
                "position={position}[mm],normal={normal}[N],lateral={lateral}[N],depth={depth}[mm]"
            );
            let layout = layout.parse().unwrap();
            let text = "a,b,c,d\n1,2,3,4\n";
            let read = Rows::parse_optional(text, FOUR, 4, "", &layout, false);
            read.map_err(|refusal| refusal.to_string())
        };
        assert!(stated([4, 2, 1, 3]).is_ok());
        for one in 0..4 {
            for other in 0..one {
                let mut columns = [1, 2, 3, 4];
                columns[one] = columns[other];
                let refused = stated(columns).err().unwrap();
                let twice = format!("line 1: column {} for both ", columns[other]);
                assert!(refused.starts_with(&twice), "{refused}");
            }
        }
    }

    // Verifies: MAP-040, MAP-033.
    #[test]
    fn tables_that_are_not_clear_are_refused_in_one_line() {
        let refusal = |text: &str| read(text).err().expect("a refusal");
        assert_cases("refused/csv.txt", "tables that are not clear", refusal);
    }
}
