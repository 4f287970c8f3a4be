//! Whether the cases of a file are what they should be.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use super::case::{
    BugAnswer, Case, CaseText, Expected, Question, ToleranceText, Wanted, WrongText,
};
use super::tolerance::{Condition, Limit, compare};
use super::verdict::Class;

/// Checks a case and takes it over; `tolerances` and `flags` are those of its file.
///
/// # Errors
/// What is wrong with it.
///
/// Implements: VEC-001, VEC-003, VEC-004, VEC-005, VEC-006, ORA-041.
pub fn case(
    text: CaseText,
    tolerances: &BTreeMap<String, ToleranceText>,
    is_flag: impl Fn(&str) -> bool,
) -> Result<Case, String> {
    let question = match (text.args.clone(), &text.line) {
        (Some(args), None) => Question::Arguments(args),
        (None, Some(line)) if line.contains('\n') => {
            return Err("line must be one line".into());
        }
        (None, Some(line)) => Question::Line(line.clone()),
        _ => return Err("expected either args or line".into()),
    };
    let expected = match (&text.ok, &text.error) {
        (Some(ok), None) if ok.is_empty() => return Err("ok is empty".into()),
        (Some(ok), None) => Expected::Values(values(ok, &text, tolerances)?),
        (None, Some(error)) => Expected::Refusal {
            class: class_of(error)?,
            lenient: text.lenient.clone(),
        },
        _ => return Err("expected either ok or error".into()),
    };
    if let Some(roundoff) = text.roundoff.filter(|size| !(0.0..1.0).contains(size)) {
        return Err(format!("roundoff = {roundoff}, expected 0 to 1"));
    }
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
    let wrong = |wrong: WrongText| BugAnswer {
        flag: wrong.flag,
        values: wrong.ok,
    };
    Ok(Case {
        id: text.id,
        comment: text.comment,
        question,
        expected,
        roundoff: text.roundoff,
        flags: text.flags,
        wrong: text.wrong.into_iter().map(wrong).collect(),
    })
}

/// What a program does wrong that does not refuse for this reason.
///
/// Implements: VEC-006, ORA-058.
fn class_of(code: &str) -> Result<Class, String> {
    match code {
        "bad_json" | "bad_request" | "unknown_op" | "bad_argument" => Ok(Class::Protocol),
        "out_of_range" | "overflow" => Ok(Class::Range),
        _ => Err(format!(
            "error = {code:?}, expected one of bad_json, bad_request, unknown_op, bad_argument, out_of_range, overflow"
        )),
    }
}

fn values(
    ok: &Map<String, Value>,
    text: &CaseText,
    tolerances: &BTreeMap<String, ToleranceText>,
) -> Result<Vec<Wanted>, String> {
    let mut of_keys = text.tolerance.keys().chain(text.condition.keys());
    if let Some(key) = of_keys.find(|key| !ok.contains_key(*key)) {
        return Err(format!(
            "tolerance or condition for {key:?}, which is no key of the answer"
        ));
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
        let condition = text.condition.get(key).cloned();
        let condition = condition.unwrap_or(Condition::All(0.0));
        if !condition.fits(value) {
            return Err(format!(
                "the condition of {key:?} has another shape than its value, or a number below 0"
            ));
        }
        let (key, value) = (key.clone(), value.clone());
        values.push(Wanted {
            key,
            value,
            tolerance,
            condition,
        });
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
    let near = |wanted: &Wanted| {
        let limit = Limit::stated(wanted.tolerance, 10.0);
        let found = wrong.get(&wanted.key);
        found.is_some_and(|wrong| compare(&wanted.key, &wanted.value, wrong, limit).is_ok())
    };
    if values.iter().all(near) {
        return Err(format!(
            "the wrong answer of {flag:?} is within ten times the tolerance of the right one"
        ));
    }
    Ok(())
}
