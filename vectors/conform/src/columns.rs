//! Questions and answers as a table, a number a row, for programs that read no JSON.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::case::{Case, Expected, Question};
use super::offline::part;
use super::suite::Suite;
use super::text::cut;
use super::verdict::Class;

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

/// The rows of a case; none, if an argument is neither number nor word nor a list of them.
fn rows(case: &Case, op: &str) -> Option<String> {
    let Question::Arguments(arguments) = &case.question else {
        return None;
    };
    // A table does not tell a text from a number, nor a misspelt name from a right one.
    if matches!(
        case.expected,
        Expected::Refusal {
            class: Class::Protocol,
            ..
        }
    ) {
        return None;
    }
    let mut text = String::new();
    let id = &case.id;
    let mut row = |name: &str, place: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{id},{op},{name},{place},{value}");
    };
    for (name, value) in arguments {
        match value {
            Value::Array(entries) if entries.is_empty() => row(name, ",", "[]"),
            Value::Array(entries) => {
                for (index, entry) in entries.iter().enumerate() {
                    match entry {
                        Value::Array(numbers) if numbers.is_empty() => return None,
                        Value::Array(numbers) => {
                            for (column, number) in numbers.iter().enumerate() {
                                row(name, &format!("{index},{column}"), &word(number)?);
                            }
                        }
                        number => row(name, &format!("{index},"), &word(number)?),
                    }
                }
            }
            value => row(name, ",", &word(value)?),
        }
    }
    (!arguments.is_empty()).then_some(text)
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
pub fn asked(suite: &Suite, text: &str) -> Result<Suite, String> {
    let rows = text.lines().skip(1);
    let ids: HashSet<&str> = rows.filter_map(|row| row.split(',').next()).collect();
    let suite = part(suite, |case| ids.contains(&case.id[..]));
    // An editor may have written its own ends of lines.
    if questions(&suite) != text.replace("\r\n", "\n") {
        return Err("is not the table of questions of these vectors".into());
    }
    Ok(suite)
}

/// The answers of a table by id, in the form of the lines' answers, but all of text; and what was passed over.
///
/// # Errors
/// A row that is none, unless they are passed over.
pub fn read_answers(
    text: &str,
    lenient: bool,
) -> Result<(HashMap<String, Value>, Vec<String>), String> {
    let mut cells: BTreeMap<(&str, &str), Cells> = BTreeMap::new();
    let mut notes = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || (number == 1 && line == ANSWER_HEAD) {
            continue;
        }
        let added = cell(line).and_then(|(id, key, place, value)| {
            cells.entry((id, key)).or_default().add(place, value)
        });
        match added {
            Some(()) => {}
            None if lenient => {
                notes.push(format!("passed over, since it is no answer: {}", cut(line)))
            }
            None => {
                return Err(format!(
                    "line {number} is {:?}, expected a new {ANSWER_HEAD}",
                    cut(line)
                ));
            }
        }
    }
    let mut answers: HashMap<String, Map<String, Value>> = HashMap::new();
    for ((id, key), cells) in cells {
        answers
            .entry(id.into())
            .or_default()
            .insert(key.into(), cells.value());
    }
    let answer = |(id, mut ok): (String, Map<String, Value>)| {
        let answer = match ok.remove("error") {
            Some(code) => json!({"error": {"code": code}}),
            None => json!({"ok": ok}),
        };
        (id, answer)
    };
    Ok((answers.into_iter().map(answer).collect(), notes))
}

type Place = (Option<usize>, Option<usize>);

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

/// A text of a table as what is expected in its place: a text, or a number if it is one.
pub fn typed(found: &Value, expected: &Value) -> Value {
    match (found, expected) {
        (Value::Array(found), Value::Array(expected)) => {
            let first = expected.first().unwrap_or(&Value::Null);
            found.iter().map(|found| typed(found, first)).collect()
        }
        (Value::String(text), Value::Number(_)) => {
            let number: Option<Value> = serde_json::from_str(text).ok().filter(Value::is_number);
            // What JSON has no number for, such as .5 and +1, may still be one; NaN stays a text.
            let loose = || text.parse().ok().and_then(serde_json::Number::from_f64);
            number
                .or_else(|| loose().map(Value::Number))
                .unwrap_or_else(|| found.clone())
        }
        _ => found.clone(),
    }
}

/// The texts of one key, by their place.
#[derive(Default)]
struct Cells(BTreeMap<Place, Value>);

impl Cells {
    /// None, if the place has a value.
    fn add(&mut self, place: Place, value: Value) -> Option<()> {
        self.0.insert(place, value).is_none().then_some(())
    }

    /// A value, a list, or a list of lists; places that are left out are closed up, so that the lengths differ.
    fn value(self) -> Value {
        let mut rows: BTreeMap<usize, Vec<Value>> = BTreeMap::new();
        let mut list = Vec::new();
        for ((row, column), value) in self.0 {
            match (row, column) {
                (Some(row), Some(_)) => rows.entry(row).or_default().push(value),
                (Some(_), None) => list.push(value),
                _ if value == "[]" => return json!([]),
                _ => return value,
            }
        }
        list.extend(rows.into_values().map(Value::from));
        Value::from(list)
    }
}
