//! Questions and answers as a table with one number per row, for programs that read no JSON.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashSet};
use std::fmt::Write;

use serde_json::{Map, Number, Value, json};

use super::answers::{Answers, ignored};
use super::case::{Case, Expected, Question, Wanted};
use super::judge::judge;
use super::outcome::{Class, Outcome};
use super::suite::Suite;
use super::text::cut;

/// The first line of the questions.
pub const HEAD: &str = "id,op,argument,row,column,value";
/// The first line of the answers.
const ANSWER_HEAD: &str = "id,key,row,column,value";

/// The questions that a table can hold.
///
/// Implements: ORA-064.
pub fn questions(suite: &Suite) -> String {
    let mut text = format!("{HEAD}\n");
    for group in &suite.groups {
        for case in &group.cases {
            text.push_str(&rows(case, &group.op).unwrap_or_default());
        }
    }
    text
}

/// The rows of a case; none if an argument is neither a number nor a word nor a list of them, or if the case is about the form of its
/// request: a table does not tell a text from a number, nor a misspelt name from a right one.
fn rows(case: &Case, op: &str) -> Option<String> {
    let (Question::Arguments(arguments), id) = (&case.question, &case.id) else {
        return None;
    };
    let is_of_form = matches!(
        case.expected,
        Expected::Refusal {
            class: Class::Protocol,
            ..
        }
    );
    if is_of_form || arguments.is_empty() {
        return None;
    }
    let mut text = String::new();
    for (name, value) in arguments {
        for (place, value) in cells(value)? {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{id},{op},{name},{place},{value}");
        }
    }
    Some(text)
}

/// Row and column, and the text, of each number or word of a value.
fn cells(value: &Value) -> Option<Vec<(String, String)>> {
    let entries = match value {
        Value::Array(entries) if entries.is_empty() => {
            return Some(vec![(",".into(), "[]".into())]);
        }
        Value::Array(entries) => entries,
        value => return Some(vec![(",".into(), word(value)?)]),
    };
    let mut cells = Vec::new();
    for (row, entry) in entries.iter().enumerate() {
        match entry {
            Value::Array(numbers) if numbers.is_empty() => return None,
            Value::Array(numbers) => {
                for (column, number) in numbers.iter().enumerate() {
                    cells.push((format!("{row},{column}"), word(number)?));
                }
            }
            number => cells.push((format!("{row},"), word(number)?)),
        }
    }
    Some(cells)
}

/// A number, or a text that needs no quotes.
fn word(value: &Value) -> Option<String> {
    match value {
        Value::Number(number) => Some(number.to_string()),
        Value::String(text) => {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
            text.chars().all(is_plain).then(|| text.clone())
        }
        _ => None,
    }
}

/// The part of the suite whose questions a table holds.
pub fn asked(suite: Suite, text: &str) -> Result<Suite, String> {
    let rows = text.lines().skip(1);
    let ids: HashSet<&str> = rows.filter_map(|row| row.split(',').next()).collect();
    let suite = suite.part(|case| ids.contains(&case.id[..]));
    // An editor may have written its own ends of lines.
    if questions(&suite) != text.replace("\r\n", "\n") {
        return Err("is not the table of questions of these vectors".into());
    }
    Ok(suite)
}

/// Judges the answers of a table. A group without an answer is not claimed.
///
/// # Errors
/// A row that is no answer, unless such rows are ignored.
pub fn judge_table(answers: &mut Answers, text: &str) -> Result<(), String> {
    let mut found: BTreeMap<&str, BTreeMap<&str, Cells>> = BTreeMap::new();
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || (number == 1 && line == ANSWER_HEAD) {
            continue;
        }
        let mut add = || {
            let (id, key, place, value) = cell(line)?;
            let cells = found.entry(id).or_default().entry(key).or_default();
            // The first of two rows for one place counts.
            let Entry::Vacant(free) = cells.entry(place) else {
                return None;
            };
            free.insert(value);
            Some(())
        };
        if add().is_none() {
            if !answers.lenient {
                let line = cut(line);
                return Err(format!(
                    "line {number} is {line:?}, but must be a new {ANSWER_HEAD}"
                ));
            }
            answers.notes.push(ignored(line));
        }
    }
    answers.claim_answered(|id| found.contains_key(id));
    while answers.ask().is_some() {
        answers.settle(|case, profile| match found.get(&case.id[..]) {
            Some(found) => judge(case, &answer(found, case), profile),
            None => Outcome::wrong(Class::Protocol, "no answer"),
        });
    }
    Ok(())
}

/// Row and column, where there are any.
type Place = (Option<usize>, Option<usize>);

/// The texts of one key.
type Cells = BTreeMap<Place, Value>;

/// The cells of a row of answers.
fn cell(line: &str) -> Option<(&str, &str, Place, Value)> {
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    let &[id, key, row, column, value] = &cells[..] else {
        return None;
    };
    let index = |text: &str| match text {
        "" => Some(None),
        text => text.parse().ok().map(Some),
    };
    let place = (index(row)?, index(column)?);
    let is_place = place.0.is_some() || place.1.is_none();
    (is_place && !id.is_empty() && !key.is_empty()).then_some((id, key, place, value.into()))
}

/// The answer to a case in the form of the lines' answers.
fn answer(found: &BTreeMap<&str, Cells>, case: &Case) -> Value {
    // A refusal beside values is none: `judge` sees both.
    let error = found.get("error").map(|code| json!({"code": value(code)}));
    let entry = |(key, cells): (&&str, &Cells)| {
        let mut wanted = case.expected.values().iter();
        let wanted = wanted.find(|wanted| wanted.key == **key);
        let expected = wanted.map_or(&Value::Null, |Wanted { value, .. }| value);
        (key.to_string(), typed(&value(cells), expected))
    };
    let values = found.iter().filter(|(key, _)| **key != "error");
    let ok: Map<String, Value> = values.map(entry).collect();
    match error {
        Some(error) if ok.is_empty() => json!({"error": error}),
        Some(error) => json!({"error": error, "ok": ok}),
        None => json!({"ok": ok}),
    }
}

/// A value, a list, or a list of lists. Rows and columns that do not count from 0, one by one, are no value.
fn value(cells: &Cells) -> Value {
    let mut list: Vec<Value> = Vec::new();
    for (&place, value) in cells {
        let value = value.clone();
        let count = list.len();
        match (place, list.last_mut()) {
            ((None, None), _) if cells.len() > 1 => return json!({}),
            ((None, None), _) if value == "[]" => return json!([]),
            ((None, _), _) => return value,
            ((Some(row), None), _) if row == count => list.push(value),
            ((Some(row), Some(0)), _) if row == count => list.push(json!([value])),
            ((Some(row), Some(column)), Some(Value::Array(last)))
                if row + 1 == count && column == last.len() =>
            {
                last.push(value);
            }
            _ => return json!({}),
        }
    }
    Value::from(list)
}

/// A text of a table as what is expected in its place: a text, or a number if it is one.
fn typed(found: &Value, expected: &Value) -> Value {
    match (found, expected) {
        (Value::Array(found), Value::Array(expected)) => {
            let first = expected.first().unwrap_or(&Value::Null);
            found.iter().map(|found| typed(found, first)).collect()
        }
        (Value::String(text), Value::Number(_)) => {
            let number = serde_json::from_str(text).ok();
            // What JSON has no number for, such as .5 and +1, may still be one; NaN stays a text.
            let loose = || text.parse().ok().and_then(Number::from_f64);
            let number = number.or_else(loose).map(Value::Number);
            number.unwrap_or_else(|| found.clone())
        }
        _ => found.clone(),
    }
}
