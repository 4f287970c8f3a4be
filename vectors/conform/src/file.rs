//! A file of vectors, read and checked.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::case::{Bug, BugAnswer, Case, Expected, Group, Question, Wanted};
use super::outcome::Class;
use super::text::{ensure, shortened};
use super::tolerance::{Condition, Limit, Tolerance, compare};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupText {
    schema: String,
    schema_version: u64,
    group: String,
    op: String,
    source: String,
    generator_version: String,
    tolerance: BTreeMap<String, Tolerance>,
    flags: BTreeMap<String, Bug>,
    cases: Vec<Box<RawValue>>,
}

/// A case as a file has it. Of its 13 keys no two can be one type, since serde refuses no unknown keys of a flattened one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseText {
    id: String,
    comment: String,
    args: Option<Map<String, Value>>,
    line: Option<String>,
    ok: Option<Map<String, Value>>,
    #[serde(default)]
    bits: Map<String, Value>,
    error: Option<String>,
    #[serde(default)]
    lenient: Map<String, Value>,
    #[serde(default)]
    tolerance: BTreeMap<String, Tolerance>,
    #[serde(default)]
    condition: BTreeMap<String, Condition>,
    roundoff: Option<f64>,
    #[serde(default)]
    flags: Vec<String>,
    #[serde(default)]
    wrong: Vec<BugAnswer>,
}

/// Reads one file.
///
/// Implements: VEC-001.
pub fn group(text: &str) -> Result<Group, String> {
    let read: GroupText = serde_json::from_str(text).map_err(|cause| cause.to_string())?;
    ensure!(
        read.schema == "palpate-vectors" && read.schema_version == 1,
        "schema {:?} version {} instead of \"palpate-vectors\" version 1",
        read.schema,
        read.schema_version
    );
    let stated = [&read.group, &read.source, &read.generator_version];
    let is_stated = !stated.contains(&&String::new());
    ensure!(is_stated, "group, source or generator_version is empty");
    let mut names = read.flags.keys().chain([&read.group]);
    let wrong = names.find(|name| !is_name(name)).cloned();
    drop(names);
    if let Some(name) = wrong {
        return Err(format!(
            "the name {name:?} must have small letters, digits, _ and - alone"
        ));
    }
    let cases = (1..).zip(&read.cases).map(|(number, text)| {
        case(text.get(), &read).map_err(|message| {
            let value: Value = serde_json::from_str(text.get()).unwrap_or_default();
            let number = || format!("number {number}");
            let id = value["id"].as_str().map_or_else(number, str::to_string);
            format!("case {id}: {message}")
        })
    });
    let cases = cases.collect::<Result<Vec<Case>, String>>()?;
    ensure!(!cases.is_empty(), "no cases");
    let used: BTreeSet<&String> = cases.iter().flat_map(|case| &case.flags).collect();
    for flag in read.flags.keys() {
        let is_used = used.contains(flag);
        ensure!(
            is_used,
            "the flag {flag:?} is explained, but no case has it"
        );
    }
    Ok(Group {
        name: read.group,
        op: read.op,
        flags: read.flags,
        cases,
    })
}

/// Reads a case of a file.
///
/// Implements: VEC-001, VEC-003, VEC-004, VEC-005, VEC-006, ORA-041.
fn case(text: &str, file: &GroupText) -> Result<Case, String> {
    let mut text: CaseText = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let question = match (text.args.take(), text.line.take()) {
        (Some(args), None) => Question::Arguments(args),
        (None, Some(line)) => {
            ensure!(!line.contains(['\n', '\r']), "line must be one line");
            Question::Line(line)
        }
        _ => return Err("a case needs either args or line".into()),
    };
    let is_line = matches!(question, Question::Line(_));
    ensure!(
        !file.op.is_empty() || (is_line && text.error.is_some()),
        "the group has no op, so that every case must be a line with an error"
    );
    ensure!(
        is_name(&text.id),
        "an id has small letters, digits, _ and - alone"
    );
    let of_values = text.bits.len() + text.tolerance.len() + text.condition.len();
    let other = match text.ok {
        Some(_) => text.lenient.len(),
        None => of_values,
    };
    ensure!(
        other == 0,
        "lenient stands beside error alone, and bits, tolerance and condition beside ok"
    );
    let expected = match (text.ok.take(), text.error.take()) {
        (Some(ok), None) => Expected::Values(values(ok, &text, &file.tolerance)?),
        (None, Some(error)) => Expected::Refusal {
            class: class_of(&error)?,
            lenient: text.lenient,
        },
        _ => return Err("a case needs either ok or error".into()),
    };
    if let Some(u) = text.roundoff {
        let is_between = u > 0.0 && u < 1.0;
        ensure!(is_between, "roundoff = {u} is not above 0 and below 1");
    }
    for flag in &text.flags {
        let is_known = file.flags.contains_key(flag);
        ensure!(is_known, "the flag {flag:?} is not explained in flags");
    }
    for wrong in &text.wrong {
        let flag = &wrong.flag;
        ensure!(
            text.flags.contains(flag),
            "wrong names {flag:?}, which is not in its flags"
        );
        check_wrong(wrong, &expected)?;
    }
    Ok(Case {
        id: text.id,
        comment: text.comment,
        question,
        expected,
        roundoff: text.roundoff,
        flags: text.flags,
        wrong: text.wrong,
    })
}

/// Whether a text can be the name of a group, a flag or a case in a table and in a file of another format.
fn is_name(text: &str) -> bool {
    let is_in_names =
        |of: u8| of.is_ascii_lowercase() || of.is_ascii_digit() || b"_-".contains(&of);
    !text.is_empty() && text.bytes().all(is_in_names)
}

/// The class of an answer to a question that must be refused with this code.
///
/// Implements: VEC-006, ORA-058.
fn class_of(code: &str) -> Result<Class, String> {
    match code {
        "bad_json" | "bad_request" | "unknown_op" | "bad_argument" => Ok(Class::Protocol),
        "out_of_range" | "overflow" => Ok(Class::Range),
        _ => Err(format!(
            "error = {code:?} is none of bad_json, bad_request, unknown_op, bad_argument, out_of_range, overflow"
        )),
    }
}

fn values(
    ok: Map<String, Value>,
    text: &CaseText,
    tolerances: &BTreeMap<String, Tolerance>,
) -> Result<Vec<Wanted>, String> {
    ensure!(!ok.is_empty(), "ok is empty");
    let of_keys = text.tolerance.keys().chain(text.condition.keys());
    for key in of_keys.chain(text.bits.keys()) {
        ensure!(
            ok.contains_key(key),
            "bits, tolerance or condition for {key:?}, which is no key of the answer"
        );
    }
    let wanted = |(key, value): (String, Value)| {
        let bits = bits_of(&value);
        ensure!(
            *text.bits.get(&key).unwrap_or(&Value::Null) == bits,
            "the bits of {key:?} must be {}",
            shortened(&bits)
        );
        let tolerance = text.tolerance.get(&key).or_else(|| tolerances.get(&key));
        let tolerance = *tolerance.ok_or_else(|| format!("no tolerance for {key:?}"))?;
        let condition = text.condition.get(&key).cloned();
        let condition = condition.unwrap_or(Condition::All(0.0));
        ensure!(
            condition.fits(&value),
            "the condition of {key:?} has another shape than its value, or a number below 0"
        );
        Ok(Wanted {
            key,
            value,
            tolerance,
            condition,
        })
    };
    ok.into_iter().map(wanted).collect()
}

/// The bits of every number with a point or exponent, in the shape of the value; null if there is no such number.
fn bits_of(value: &Value) -> Value {
    match value {
        Value::Array(values) => {
            let bits: Vec<Value> = values.iter().map(bits_of).collect();
            let is_none = bits.iter().all(Value::is_null);
            if is_none { Value::Null } else { bits.into() }
        }
        Value::Number(number) if number.is_f64() => {
            format!("{:#018x}", number.as_f64().unwrap_or_default().to_bits()).into()
        }
        _ => Value::Null,
    }
}

/// Checks that the answer of a bug is far enough from the right one to tell them apart.
fn check_wrong(wrong: &BugAnswer, expected: &Expected) -> Result<(), String> {
    let Expected::Values(values) = expected else {
        return Err("a case that must be refused has flags, but no wrong answers".into());
    };
    let lacking = values
        .iter()
        .find(|wanted| !wrong.values.contains_key(&wanted.key));
    if let Some(Wanted { key, .. }) = lacking {
        return Err(format!(
            "the wrong answer of {:?} has no {key:?}",
            wrong.flag
        ));
    }
    let is_near = |wanted: &Wanted| {
        let limit = Limit::stated(wanted.tolerance, 10.0);
        let found = wrong.values.get(&wanted.key);
        found.is_some_and(|found| compare(&wanted.key, &wanted.value, found, limit).is_ok())
    };
    ensure!(
        !values.iter().all(is_near),
        "the wrong answer of {:?} is within ten times the tolerance of the right one",
        wrong.flag
    );
    Ok(())
}
