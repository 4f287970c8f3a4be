//! Counts of right answers: Table 1 of the paper, files of the same form, and files with a row for each trial.
//!
//! ```text
//! subject,condition,trials,2.6,4.6,6.6,8.6
//! 1,direct contact,30,30,28,27,27
//! ```

use std::collections::HashMap;
use std::path::Path;

use super::choice::Count;
use super::trials;
use palpate::csv::{fields, header_and_rows, wrong_header};
use palpate::decimal::parse_scaled;
use palpate::refusal::{Refusal, shortened};

/// Table 1.
const PAPER: &str = include_str!("table1.csv");
/// The first three fields of the header.
const KEYS: [&str; 3] = ["subject", "condition", "trials"];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str =
    "subject,condition,trials and a column for each inclusion, such as 2.6,4.6,6.6,8.6";
/// The names of inclusions that are right, for a person.
const EXPECTED_INCLUSION: &str =
    "the name of an inclusion that ends in its depth in mm, such as 6.6 or soft 6.6";
/// Most trials of a row, as many as an experiment may have; it keeps the work of an analysis small.
pub const MOST_TRIALS: u32 = 1_000;

/// Which condition of Table 1 is the playback of FEM data.
pub const FEM_PLAYBACK: usize = 1;

/// An inclusion: a column of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// As in the header: untrusted text.
    pub name: String,
    /// The depth of its top, m.
    pub depth: f64,
}

/// The answers of one subject in one condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subject {
    /// Who answered: untrusted text.
    pub name: String,
    /// Pairs judged for each inclusion.
    pub trials: u32,
    /// Right answers to each inclusion.
    pub correct: Vec<u32>,
}

impl Subject {
    /// The share of right answers to each inclusion.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> {
        let share = |&correct| f64::from(correct) / f64::from(self.trials);
        self.correct.iter().map(share)
    }
}

/// One of the experiments.
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
/// Implements: PSY-020.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerTable {
    inclusions: Vec<Column>,
    conditions: Vec<Condition>,
}

impl AnswerTable {
    /// Table 1 of the paper.
    ///
    /// # Errors
    /// None: the text is part of the program, and a test reads it.
    ///
    /// Implements: PSY-020.
    pub fn paper() -> Result<AnswerTable, Refusal> {
        AnswerTable::from_csv(PAPER, "Table 1")
    }

    /// Reads the table at `path`.
    ///
    /// # Errors
    /// As [`AnswerTable::from_csv`], and if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<AnswerTable, Refusal> {
        palpate::file::read(path, AnswerTable::from_csv)
    }

    /// The table in `text`, the content of `file`.
    ///
    /// # Errors
    /// The first line that is wrong.
    ///
    /// Implements: PSY-020, PSY-021.
    pub fn from_csv(text: &str, file: &str) -> Result<AnswerTable, Refusal> {
        let at = |line| move |refusal: Refusal| refusal.at(line).in_file(file);
        let ((header_line, header), rows) = header_and_rows(text);
        let (inclusions, subjects) = match trials::places(header) {
            Some(places) => {
                let counts = trials::counts(header, places, rows);
                counts.map_err(|refusal| refusal.in_file(file))?
            }
            None => {
                let inclusions = inclusions(header).map_err(at(header_line))?;
                let subject = |(line, row)| {
                    let (name, subject) = subject(header, row, &inclusions).map_err(at(line))?;
                    Ok((line, name, subject))
                };
                let subjects = rows.map(subject).collect::<Result<_, Refusal>>()?;
                (inclusions, subjects)
            }
        };
        let mut conditions: Vec<Condition> = Vec::new();
        let mut lines = HashMap::new();
        for (line, name, subject) in subjects {
            if let Some(first) = lines.insert((name.clone(), subject.name.clone()), line) {
                let again = format!("subject {:?} again under condition {name:?}", subject.name);
                let once = format!("keep one row; the first is line {first}");
                return Err(at(line)(Refusal::state(again, once)));
            }
            match conditions.iter_mut().find(|known| known.name == name) {
                Some(known) => known.subjects.push(subject),
                None => conditions.push(Condition {
                    name,
                    subjects: vec![subject],
                }),
            }
        }
        if conditions.is_empty() {
            let empty = Refusal::state("no rows under the header", "give at least one");
            return Err(at(header_line)(empty));
        }
        Ok(AnswerTable {
            inclusions,
            conditions,
        })
    }

    /// The columns.
    pub fn inclusions(&self) -> &[Column] {
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

    /// The same as a count of the likelihood.
    pub(super) fn count(&self, column: usize) -> Count {
        let (correct, trials) = self.pooled(column);
        Count::new(correct as f64, trials as f64)
    }
}

/// The inclusions that a header names.
fn inclusions(header: &str) -> Result<Vec<Column>, Refusal> {
    let fields: Vec<&str> = header.split(',').map(str::trim).collect();
    let rest = fields.strip_prefix(&KEYS).filter(|rest| !rest.is_empty());
    let names = rest.ok_or_else(|| wrong_header(header, EXPECTED_HEADER))?;
    let mut inclusions: Vec<Column> = Vec::new();
    for (number, name) in (KEYS.len() + 1..).zip(names) {
        let place = format!("header, column {number}");
        let column = column(&place, name)?;
        if inclusions.iter().any(|other| other.name == *name) {
            return Err(refused(&place, name, "each inclusion once"));
        }
        inclusions.push(column);
    }
    Ok(inclusions)
}

/// The inclusion of a name, which stands at a `place`.
pub(super) fn column(place: &str, name: &str) -> Result<Column, Refusal> {
    let last = name.split_whitespace().next_back();
    let depth = last
        .and_then(|word| parse_scaled(word, -3))
        .filter(|&depth| depth > 0.0 && is_plain(name))
        .ok_or_else(|| refused(place, name, EXPECTED_INCLUSION))?;
    let name = name.to_string();
    Ok(Column { name, depth })
}

/// A name in a column, which can be printed.
pub(super) fn plain(column: &str, name: &str) -> Result<String, Refusal> {
    if name.is_empty() || !is_plain(name) {
        return Err(refused(column, name, "a name of printable characters"));
    }
    Ok(name.into())
}

/// The condition and the subject of a row.
fn subject(header: &str, row: &str, inclusions: &[Column]) -> Result<(String, Subject), Refusal> {
    let fields = fields(row, KEYS.len() + inclusions.len(), header)?;
    let (keys, correct) = fields.split_at(KEYS.len());
    for (column, name) in KEYS.iter().zip(&keys[..2]) {
        plain(column, name)?;
    }
    let whole = |column: &str, text: &str, first: u32, last: u32, of: &str| {
        let number = text.parse().ok();
        let number = number.filter(|number| (first..=last).contains(number));
        let expected = || format!("a whole number from {first} to {of}");
        number.ok_or_else(|| refused(column, text, &expected()))
    };
    let trials = whole(KEYS[2], keys[2], 1, MOST_TRIALS, &MOST_TRIALS.to_string())?;
    let of_row = format!("the {trials} trials of the row");
    let correct = inclusions.iter().zip(correct);
    let correct = correct.map(|(of, field)| whole(&of.name, field, 0, trials, &of_row));
    let subject = Subject {
        name: keys[0].into(),
        trials,
        correct: correct.collect::<Result<_, _>>()?,
    };
    Ok((keys[1].into(), subject))
}

pub(super) fn refused(column: &str, found: &str, expected: &str) -> Refusal {
    Refusal::value(column, format!("{:?}", shortened(found)), expected)
}

/// Whether a name can be printed as it is.
fn is_plain(name: &str) -> bool {
    !name.chars().any(char::is_control)
}

#[cfg(test)]
mod tests;
