//! Counts of right answers: Table 1 of the paper, files of the same form, and files with a row for each trial.
//!
//! ```text
//! subject,condition,trials,2.6,4.6,6.6,8.6
//! 1,direct contact,30,30,28,27,27
//! ```

use std::collections::HashMap;
use std::path::Path;

use super::counts::{Column, Condition, MOST_TRIALS, Subject, columns, plain, refused};
use super::trials;
use palpate::csv::{fields, header_and_rows, split, wrong_header};
use palpate::refusal::Refusal;

/// Table 1.
const PAPER: &str = include_str!("table1.csv");
/// The first three fields of the header.
const KEYS: [&str; 3] = ["subject", "condition", "trials"];
/// The headers that are right, for a person.
const EXPECTED_HEADER: &str =
    "subject,condition,trials and a column for each inclusion, such as 2.6,4.6,6.6,8.6";
/// Which condition of Table 1 is the playback of FEM data.
pub const FEM_PLAYBACK: usize = 1;

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
        let (inclusions, subjects) = match trials::places(header).map_err(at(header_line))? {
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

/// The inclusions that a header names.
fn inclusions(header: &str) -> Result<Vec<Column>, Refusal> {
    let fields: Vec<&str> = split(header, ',').collect();
    let rest = fields.strip_prefix(&KEYS).filter(|rest| !rest.is_empty());
    let names = rest.ok_or_else(|| wrong_header(header, EXPECTED_HEADER))?;
    let place = |(number, &name)| (format!("header, column {number}"), name);
    columns((KEYS.len() + 1..).zip(names).map(place))
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

#[cfg(test)]
mod tests;
