//! A row for each trial, as programs for experiments write them, as counts of right answers.

use std::collections::HashMap;

use super::counts::{Column, MOST_TRIALS, Subject, column, plain, refused};
use palpate::csv::{fields, split};
use palpate::refusal::Refusal;

/// What the columns hold: who answered, what was felt, the inclusion of the pair, whether the answer was right. Of each the names, and
/// those that count where there is none of these: jsPsych has a `stimulus` in every file.
const COLUMNS: [(&str, [&[&str]; 2]); 4] = [
    (
        "subject",
        [
            &["subject", "participant", "subject_id", "participant_id"],
            &[],
        ],
    ),
    ("condition", [&["condition"], &[]]),
    ("inclusion", [&["inclusion"], &["stimulus"]]),
    (
        "answer",
        [&["correct", "corr", "key_resp.corr", "response.corr"], &[]],
    ),
];
/// An answer in small letters, and whether it is right.
const ANSWERS: [(&str, bool); 6] = [
    ("1", true),
    ("1.0", true),
    ("true", true),
    ("0", false),
    ("0.0", false),
    ("false", false),
];

/// Where a header of trials has its columns; none of another header.
///
/// # Errors
/// Two columns of the same kind.
///
/// Implements: PSY-021.
pub(super) fn places(header: &str) -> Result<Option<[usize; 4]>, Refusal> {
    let fields: Vec<&str> = split(header, ',').collect();
    let [
        Some(subject),
        Some(condition),
        Some(inclusion),
        Some(correct),
    ] = COLUMNS.map(|(kind, names)| place(&fields, kind, names))
    else {
        return Ok(None);
    };
    Ok(Some([subject?, condition?, inclusion?, correct?]))
}

/// Where a header has the column of a kind, by the first names that are there.
fn place(header: &[&str], kind: &str, names: [&[&str]; 2]) -> Option<Result<usize, Refusal>> {
    names.into_iter().find_map(|names| {
        let is_named = |place: &usize| {
            let mut names = names.iter();
            names.any(|name| name.eq_ignore_ascii_case(header[*place]))
        };
        let found: Vec<usize> = (0..header.len()).filter(is_named).collect();
        match found[..] {
            [] => None,
            [only] => Some(Ok(only)),
            [first, second, ..] => {
                let column = |place: usize| format!("{} ({:?})", place + 1, header[place]);
                let (first, second) = (column(first), column(second));
                let found = format!("columns {first} and {second} for the {kind} in the header");
                Some(Err(Refusal::state(found, "keep one of them")))
            }
        }
    })
}

/// The line of a subject's first answer, the condition, and the counts.
type OfSubject = (usize, String, Subject);

/// Right answers and trials of an inclusion.
type Counts = HashMap<String, (u32, u32)>;

/// The inclusions of the rows by depth, and for each subject under a condition, in the order in which they first come, the line of the
/// first trial, the condition and the counts. A row without an answer is no trial.
///
/// # Errors
/// The first row that is wrong, or a subject who did not answer to each inclusion equally often; with the line.
///
/// Implements: PSY-021.
pub(super) fn counts<'a>(
    header: &str,
    places: [usize; 4],
    rows: impl Iterator<Item = (usize, &'a str)>,
) -> Result<(Vec<Column>, Vec<OfSubject>), Refusal> {
    let width = split(header, ',').count();
    let mut inclusions: Vec<Column> = Vec::new();
    let mut found: Vec<(usize, [String; 2], Counts)> = Vec::new();
    let mut known: HashMap<[String; 2], usize> = HashMap::new();
    for (line, row) in rows {
        let fields = fields(row, width, header);
        let fields = fields.map_err(|refusal| refusal.at(line))?;
        let [subject, condition, inclusion, answer] = places.map(|place| fields[place]);
        if answer.is_empty() {
            continue;
        }
        let read = || {
            let is_right = right(answer)?;
            let names = [plain("subject", subject)?, plain("condition", condition)?];
            Ok((is_right, names, column("inclusion", inclusion)?))
        };
        let (is_right, names, column) = read().map_err(|refusal: Refusal| refusal.at(line))?;
        if inclusions.iter().all(|known| known.name != column.name) {
            inclusions.push(column);
        }
        let place = *known.entry(names.clone()).or_insert_with(|| {
            found.push((line, names, Counts::new()));
            found.len() - 1
        });
        let counts = found[place].2.entry(inclusion.into()).or_default();
        *counts = (counts.0 + u32::from(is_right), counts.1 + 1);
    }
    inclusions.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.name.cmp(&b.name)));
    let subject = |(line, names, counts): (usize, [String; 2], Counts)| {
        let [name, condition] = names;
        let subject = subject(name, &inclusions, &counts);
        let subject = subject.map_err(|refusal| refusal.at(line))?;
        Ok((line, condition, subject))
    };
    let subjects = found.into_iter().map(subject);
    let subjects = subjects.collect::<Result<_, Refusal>>()?;
    Ok((inclusions, subjects))
}

/// Whether an answer was right.
fn right(answer: &str) -> Result<bool, Refusal> {
    let mut answers = ANSWERS.iter();
    let known = answers.find(|(text, _)| text.eq_ignore_ascii_case(answer));
    let known = known.map(|(_, is_right)| *is_right);
    known.ok_or_else(|| refused("correct", answer, "1 or 0, or true or false"))
}

/// The counts of a subject, with as many trials of each inclusion.
fn subject(name: String, inclusions: &[Column], counts: &Counts) -> Result<Subject, Refusal> {
    let of = |column: &Column| counts.get(&column.name).copied().unwrap_or((0, 0));
    let trials = inclusions.first().map_or(0, |first| of(first).1);
    let other = inclusions.iter().find(|other| of(other).1 != trials);
    if let Some(other) = other {
        let (first, count) = (&inclusions[0].name, of(other).1);
        let found = format!(
            "subject {name:?} has {trials} trials of {first:?} and {count} of {:?}",
            other.name
        );
        return Err(Refusal::state(found, "give as many of each inclusion"));
    }
    if trials > MOST_TRIALS {
        let found = format!("subject {name:?} has {trials} trials of an inclusion");
        let most = format!("give at most {MOST_TRIALS}");
        return Err(Refusal::state(found, most));
    }
    let correct = inclusions.iter().map(|column| of(column).0).collect();
    Ok(Subject {
        name,
        trials,
        correct,
    })
}
