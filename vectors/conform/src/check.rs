//! Whether the cases of a file are what they should be.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use super::case::{Case, CaseText, Expected, Question, ToleranceText, Wrong};
use super::tolerance::{Tolerance, compare};
use palpate::oracle::Code;

/// Checks a case and takes it over; `tolerances` and `flags` are those of its file.
///
/// # Errors
/// What is wrong with it.
///
/// Implements: VEC-001, VEC-002, VEC-003, VEC-004, VEC-005, VEC-006, ORA-041.
pub fn case(
    text: CaseText,
    tolerances: &BTreeMap<String, ToleranceText>,
    is_flag: impl Fn(&str) -> bool,
) -> Result<Case, String> {
    let question = match (&text.args, &text.line) {
        (Some(args), None) if args.get().starts_with('{') => {
            // A line is a line: what the file spreads over several is put into one.
            Question::Arguments(args.get().replace(['\n', '\r'], " "))
        }
        (Some(_), None) => return Err("args must be an object".into()),
        (None, Some(line)) if line.contains('\n') => {
            return Err("line must be one line".into());
        }
        (None, Some(line)) => Question::Line(line.clone()),
        _ => return Err("expected either args or line".into()),
    };
    let expected = match (&text.ok, &text.error) {
        (Some(ok), None) => Expected::Values(values(ok, &text, tolerances)?),
        (None, Some(error)) => Expected::Refusal(code(error)?),
        _ => return Err("expected either ok or error".into()),
    };
    if let Some(flag) = text.flags.iter().find(|flag| !is_flag(flag)) {
        return Err(format!("the flag {flag:?} is not explained in flags"));
    }
    for wrong in &text.wrong {
        if !text.flags.contains(&wrong.flag) {
            return Err(format!(
                "wrong names {:?}, which is not in its flags",
                wrong.flag
            ));
        }
        check_wrong(&wrong.flag, &wrong.ok, &expected)?;
    }
    let wrong = |wrong: super::case::WrongText| Wrong {
        flag: wrong.flag,
        values: wrong.ok,
    };
    Ok(Case {
        id: text.id,
        comment: text.comment,
        question,
        expected,
        flags: text.flags,
        wrong: text.wrong.into_iter().map(wrong).collect(),
    })
}

fn code(error: &str) -> Result<String, String> {
    let code = serde_json::from_value::<Code>(error.into());
    code.map_err(|unknown| format!("error: {unknown}"))?;
    Ok(error.into())
}

fn values(
    ok: &Map<String, Value>,
    text: &CaseText,
    tolerances: &BTreeMap<String, ToleranceText>,
) -> Result<Vec<(String, Value, Tolerance)>, String> {
    if let Some(key) = text.tolerance.keys().find(|key| !ok.contains_key(*key)) {
        return Err(format!("tolerance for {key:?}, which is no key of ok"));
    }
    let nothing = Map::new();
    let bits = text.bits.as_ref().unwrap_or(&nothing);
    let mut values = Vec::new();
    for (key, value) in ok {
        check_bits(key, value, bits.get(key))?;
        let stated = text.tolerance.get(key).or_else(|| tolerances.get(key));
        let tolerance = stated
            .ok_or_else(|| format!("no tolerance for {key:?}"))?
            .tolerance()
            .map_err(|error| format!("tolerance of {key:?}: {error}"))?;
        values.push((key.clone(), value.clone(), tolerance));
    }
    if values.is_empty() {
        return Err("ok is empty".into());
    }
    Ok(values)
}

/// Whether the bits of every number with a point or exponent are there and are its own.
fn check_bits(key: &str, value: &Value, bits: Option<&Value>) -> Result<(), String> {
    match (value, bits) {
        (Value::Array(values), Some(Value::Array(all))) if values.len() == all.len() => values
            .iter()
            .zip(all)
            .try_for_each(|(value, bits)| check_bits(key, value, Some(bits))),
        (Value::Array(values), None) => values
            .iter()
            .try_for_each(|value| check_bits(key, value, None)),
        (Value::Number(number), bits) if number.is_f64() => {
            let found = bits.and_then(Value::as_str);
            let right = number
                .as_f64()
                .map(|value| format!("{:#018x}", value.to_bits()));
            if found == right.as_deref() {
                return Ok(());
            }
            let right = right.unwrap_or_default();
            Err(format!("bits of {key:?}: expected {right} for {number}"))
        }
        (Value::Array(_), Some(_)) | (_, Some(Value::String(_) | Value::Array(_))) => {
            Err(format!("bits of {key:?} have another shape than ok"))
        }
        _ => Ok(()),
    }
}

/// Whether the answer of a bug is far enough from the right one to tell them apart.
fn check_wrong(flag: &str, wrong: &Map<String, Value>, expected: &Expected) -> Result<(), String> {
    let Expected::Values(values) = expected else {
        return Err("wrong answers to what must be refused: its flags say it".into());
    };
    let near = |(key, value, tolerance): &(String, Value, Tolerance)| {
        wrong
            .get(key)
            .is_some_and(|wrong| compare(key, value, wrong, *tolerance, 10.0).is_ok())
    };
    if values.iter().all(near) {
        return Err(format!(
            "the wrong answer of {flag:?} is within ten times the tolerance of the right one"
        ));
    }
    Ok(())
}
