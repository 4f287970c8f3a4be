//! Counts of right answers: Table 1 of the paper, and files of the same form.
//!
//! ```text
//! subject,condition,trials,2.6,4.6,6.6,8.6
//! 1,direct contact,30,30,28,27,27
//! ```

use std::path::Path;

use crate::csv::{header_and_rows, shortened, wrong_header};
use crate::phantom::decimal::parse_scaled;
use crate::refusal::Refusal;

/// Table 1.
const PAPER: &str = include_str!("table1.csv");
/// The first three fields of the header.
const KEYS: [&str; 3] = ["subject", "condition", "trials"];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str =
    "subject,condition,trials and a column for each inclusion, such as 2.6,4.6,6.6,8.6";
/// Most trials of a row, as many as an experiment may have; it keeps the work of an analysis small.
pub const MOST_TRIALS: u32 = 1_000;

/// An inclusion: a column of the table.
///
/// ```
/// use palpate::psychophysics::{Inclusion, Table};
///
/// let inclusion = Inclusion { name: "6.6".into(), depth: 0.0066 };
/// assert_eq!(Table::paper()?.inclusions()[2], inclusion);
/// # Ok::<(), palpate::psychophysics::TableError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Inclusion {
    /// As in the header: untrusted text.
    pub name: String,
    /// The depth of its top, m.
    pub depth: f64,
}

/// The answers of one subject in one condition.
///
/// ```
/// use palpate::psychophysics::Table;
///
/// let table = Table::paper()?;
/// let subject = &table.conditions()[0].subjects[6];
/// assert_eq!((subject.name.as_str(), subject.trials), ("7", 30));
/// assert_eq!(subject.correct, [23, 19, 18, 13]);
/// # Ok::<(), palpate::psychophysics::TableError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subject {
    /// Who answered: untrusted text.
    pub name: String,
    /// Pairs judged for each inclusion.
    pub trials: u32,
    /// Right answers to each inclusion.
    pub correct: Vec<u32>,
}

/// One of the experiments.
///
/// ```
/// use palpate::psychophysics::Table;
///
/// let table = Table::paper()?;
/// let (contact, playback) = (&table.conditions()[0], &table.conditions()[1]);
/// assert_eq!((contact.name.as_str(), playback.name.as_str()), ("direct contact", "FEM data"));
/// // The inclusion at 6.6 mm.
/// assert_eq!(playback.counts(2)[0], (30, 30));
/// assert_eq!(playback.pooled(2), (253, 300));
/// # Ok::<(), palpate::psychophysics::TableError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    /// What was felt: untrusted text.
    pub name: String,
    /// Who felt it, at least one, each once.
    pub subjects: Vec<Subject>,
}

/// Right answers of subjects to inclusions under conditions. Every count fits its trials, and there
/// is at least one of each.
///
/// ```
/// use palpate::psychophysics::Table;
///
/// let table = Table::from_csv("subject,condition,trials,2.6,8.6\nA,gel,20,19,12\n", "mine.csv")?;
/// assert_eq!(table.inclusions()[1].depth, 0.0086);
/// assert_eq!(table.conditions()[0].pooled(1), (12, 20));
/// // Three conditions, ten subjects each.
/// let paper = Table::paper()?;
/// assert!(paper.conditions().iter().all(|condition| condition.subjects.len() == 10));
/// # Ok::<(), palpate::psychophysics::TableError>(())
/// ```
///
/// Implements: PSY-020, PSY-021.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    inclusions: Vec<Inclusion>,
    conditions: Vec<Condition>,
}

/// Why a table of counts is refused: one line that begins with the file.
///
/// ```
/// use palpate::psychophysics::Table;
///
/// let error = Table::from_csv("subject,condition,trials,2.6\nA,gel,20,21\n", "mine.csv");
/// assert!(error.unwrap_err().to_string().starts_with("mine.csv:2: 2.6 = \"21\""));
/// ```
///
/// Implements: PSY-022.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{file}:{line}: {problem}")]
pub struct TableError {
    /// The file, as its reader named it.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    pub problem: TableProblem,
}

/// What is wrong with a table of counts.
///
/// ```
/// use palpate::psychophysics::{Table, TableProblem};
///
/// let error = Table::from_csv("subject,condition,trials,2.6\n", "mine.csv").unwrap_err();
/// assert_eq!(error.problem, TableProblem::Empty);
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TableProblem {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(String),
    /// A header that does not name the columns, or a row of another length.
    #[error(transparent)]
    Csv(Box<Refusal>),
    /// A field that makes no sense.
    #[error("{column} = {found:?}, expected {expected}")]
    Field {
        /// The column, as in the header.
        column: String,
        /// The field.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// A subject twice in one condition.
    #[error(
        "subject {subject:?} again under condition {condition:?}, expected once; first in line {first}"
    )]
    Repeated {
        /// Who.
        subject: String,
        /// Under which condition.
        condition: String,
        /// The line of the other row.
        first: usize,
    },
    /// A header and nothing under it.
    #[error("no rows under the header, expected at least one")]
    Empty,
}

impl Table {
    /// Table 1 of the paper.
    ///
    /// # Errors
    /// None: the text is part of the program, and a test reads it.
    ///
    /// Implements: PSY-020.
    pub fn paper() -> Result<Table, TableError> {
        Table::from_csv(PAPER, "Table 1")
    }

    /// Reads the table at `path`.
    ///
    /// ```
    /// use palpate::psychophysics::Table;
    ///
    /// let path = std::env::temp_dir().join(format!("counts-{}.csv", std::process::id()));
    /// std::fs::write(&path, "subject,condition,trials,2.6\nA,gel,20,19\n")?;
    /// assert_eq!(Table::read(&path)?.conditions()[0].pooled(0), (19, 20));
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Table::from_csv`]; [`TableProblem::Read`] if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Table, TableError> {
        let file = path.display().to_string();
        let text = crate::input::read(path).map_err(|error| TableError {
            file: file.clone(),
            line: 1,
            problem: TableProblem::Read(error.to_string()),
        })?;
        Table::from_csv(&text, &file)
    }

    /// The table in `text`, the content of `file`.
    ///
    /// # Errors
    /// [`TableError`] with the first line that is wrong.
    ///
    /// Implements: PSY-020, PSY-021, PSY-022.
    pub fn from_csv(text: &str, file: &str) -> Result<Table, TableError> {
        let at = |line| {
            move |problem| TableError {
                file: file.into(),
                line,
                problem,
            }
        };
        let ((header_line, header), rows) = header_and_rows(text);
        let inclusions = inclusions(header).map_err(at(header_line))?;
        let mut conditions: Vec<Condition> = Vec::new();
        let mut lines: Vec<Vec<usize>> = Vec::new();
        for (line, row) in rows {
            let (name, subject) = subject(header, row, &inclusions).map_err(at(line))?;
            let known = conditions.iter().position(|known| known.name == name);
            let place = known.unwrap_or_else(|| {
                conditions.push(Condition {
                    name: name.clone(),
                    subjects: Vec::new(),
                });
                lines.push(Vec::new());
                conditions.len() - 1
            });
            let subjects = &mut conditions[place].subjects;
            if let Some(other) = subjects.iter().position(|s| s.name == subject.name) {
                return Err(at(line)(TableProblem::Repeated {
                    subject: subject.name,
                    condition: name,
                    first: lines[place][other],
                }));
            }
            subjects.push(subject);
            lines[place].push(line);
        }
        if conditions.is_empty() {
            return Err(at(header_line)(TableProblem::Empty));
        }
        Ok(Table {
            inclusions,
            conditions,
        })
    }

    /// The columns.
    pub fn inclusions(&self) -> &[Inclusion] {
        &self.inclusions
    }

    /// The experiments in the order in which they first come.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }
}

impl Condition {
    /// Right answers and pairs of each subject at the inclusion in `column`.
    pub fn counts(&self, column: usize) -> Vec<(u32, u32)> {
        let count = |subject: &Subject| (subject.correct[column], subject.trials);
        self.subjects.iter().map(count).collect()
    }

    /// Right answers and pairs of all subjects together.
    pub fn pooled(&self, column: usize) -> (u64, u64) {
        let add =
            |(correct, trials), (k, n): (u32, u32)| (correct + u64::from(k), trials + u64::from(n));
        self.counts(column).into_iter().fold((0, 0), add)
    }
}

/// The inclusions that a header names.
fn inclusions(header: &str) -> Result<Vec<Inclusion>, TableProblem> {
    let fields: Vec<&str> = header.split(',').map(str::trim).collect();
    if fields.len() <= KEYS.len() || fields[..KEYS.len()] != KEYS {
        let refusal = wrong_header(header, EXPECTED_HEADER);
        return Err(TableProblem::Csv(refusal.into()));
    }
    let mut inclusions: Vec<Inclusion> = Vec::new();
    for (number, field) in (KEYS.len() + 1..).zip(&fields[KEYS.len()..]) {
        let refused = |expected: &str| TableProblem::Field {
            column: format!("header, column {number}"),
            found: shortened(field),
            expected: expected.into(),
        };
        let depth = field
            .split_whitespace()
            .next_back()
            .and_then(|word| parse_scaled(word, -3))
            .filter(|&depth| depth > 0.0 && is_plain(field));
        let depth = depth.ok_or_else(|| {
            refused(
                "the name of an inclusion that ends in its depth in mm, such as 6.6 or soft 6.6",
            )
        })?;
        if inclusions.iter().any(|other| other.name == *field) {
            return Err(refused("each inclusion once"));
        }
        inclusions.push(Inclusion {
            name: field.to_string(),
            depth,
        });
    }
    Ok(inclusions)
}

/// The condition and the subject of a row.
fn subject(
    header: &str,
    row: &str,
    inclusions: &[Inclusion],
) -> Result<(String, Subject), TableProblem> {
    let fields = crate::csv::fields(row, KEYS.len() + inclusions.len(), header)
        .map_err(|refusal| TableProblem::Csv(refusal.into()))?;
    let refused = |column: &str, found: &str, expected: String| TableProblem::Field {
        column: column.into(),
        found: shortened(found),
        expected,
    };
    for (column, name) in KEYS.iter().zip(&fields[..2]) {
        if name.is_empty() || !is_plain(name) {
            return Err(refused(
                column,
                name,
                "a name of printable characters".into(),
            ));
        }
    }
    let in_range = |text: &str, first: u32, last: u32| {
        let number = text.parse().ok();
        number.filter(|number| (first..=last).contains(number))
    };
    let trials = in_range(fields[2], 1, MOST_TRIALS).ok_or_else(|| {
        let expected = format!("a whole number from 1 to {MOST_TRIALS}");
        refused(KEYS[2], fields[2], expected)
    })?;
    let correct = inclusions.iter().zip(&fields[KEYS.len()..]);
    let correct = correct.map(|(inclusion, field)| {
        in_range(field, 0, trials).ok_or_else(|| {
            let expected = format!("a whole number from 0 to the {trials} trials of the row");
            refused(&inclusion.name, field, expected)
        })
    });
    let subject = Subject {
        name: fields[0].into(),
        trials,
        correct: correct.collect::<Result<_, _>>()?,
    };
    Ok((fields[1].into(), subject))
}

/// Whether a name can be printed as it is.
fn is_plain(name: &str) -> bool {
    !name.chars().any(char::is_control)
}

#[cfg(test)]
mod tests;
