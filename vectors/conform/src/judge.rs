//! One answer against what was expected.

use serde_json::{Map, Value};

use super::case::{Case, Expected};
use super::tolerance::{compare, shortened};
use super::verdict::Outcome;

/// Judges the answer to a case: a JSON value whose id was found to be right.
///
/// Implements: ORA-046, ORA-047.
pub fn judge(case: &Case, answer: &Value) -> Outcome {
    match (answer.get("ok"), answer.get("error")) {
        (Some(ok), None) => judge_values(case, ok),
        (None, Some(error)) => judge_refusal(case, error),
        _ => Outcome::failed(format!(
            "expected an answer with either ok or error, found {}",
            shortened(answer)
        )),
    }
}

/// Implements: ORA-052.
fn judge_refusal(case: &Case, error: &Value) -> Outcome {
    if !error["code"].is_string() {
        let error = shortened(error);
        return Outcome::failed(format!("error is {error}, expected an object with a code"));
    }
    match &case.expected {
        Expected::Refusal(_) => Outcome::Refused,
        Expected::Values(_) => Outcome::failed(format!("refused: {}", shortened(error))),
    }
}

fn judge_values(case: &Case, ok: &Value) -> Outcome {
    let Expected::Values(values) = &case.expected else {
        return Outcome::Failed {
            reason: format!("answered {}, but must be refused", shortened(ok)),
            // What the case shows is what was not refused.
            bugs: case.flags.clone(),
        };
    };
    let Value::Object(found) = ok else {
        return Outcome::failed(format!("ok is {}, expected an object", shortened(ok)));
    };
    let difference = values
        .iter()
        .find_map(|(key, expected, tolerance)| match found.get(key) {
            None => Some(format!("{key} is missing in {}", shortened(ok))),
            Some(value) => compare(key, expected, value, *tolerance, 1.0)
                .err()
                .map(|difference| difference.to_string()),
        });
    match difference {
        None => Outcome::Passed,
        Some(reason) => Outcome::Failed {
            reason,
            bugs: bugs(case, found),
        },
    }
}

/// The flags of the bugs whose answer this is.
fn bugs(case: &Case, found: &Map<String, Value>) -> Vec<String> {
    let Expected::Values(values) = &case.expected else {
        return Vec::new();
    };
    let is_its = |wrong: &Map<String, Value>| {
        values.iter().all(
            |(key, _, tolerance)| match (wrong.get(key), found.get(key)) {
                (Some(wrong), Some(found)) => compare(key, wrong, found, *tolerance, 1.0).is_ok(),
                _ => false,
            },
        )
    };
    let matching = case.wrong.iter().filter(|wrong| is_its(&wrong.values));
    matching.map(|wrong| wrong.flag.clone()).collect()
}
