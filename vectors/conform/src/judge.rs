//! One answer against what was expected.

use serde_json::{Map, Value};

use super::case::{BugAnswer, Case, Expected, Wanted};
use super::profile::Profile;
use super::text::shortened;
use super::tolerance::{Difference, Limit, Tolerance, compare};
use super::verdict::{Class, Outcome, Traces, Wrong};

/// Judges the answer to a case: a JSON value whose id was found to be right.
///
/// Implements: ORA-046, ORA-047, ORA-058.
pub fn judge(case: &Case, answer: &Value, profile: &Profile) -> Outcome {
    match (answer.get("ok"), answer.get("error")) {
        (Some(ok), None) => judge_values(case, ok, profile),
        (None, Some(error)) => judge_refusal(case, error),
        _ => Outcome::wrong(
            Class::Protocol,
            format!(
                "expected an answer with either ok or error, found {}",
                shortened(answer)
            ),
        ),
    }
}

/// Implements: ORA-058.
fn judge_refusal(case: &Case, error: &Value) -> Outcome {
    let is_coded = error["code"].is_string();
    if !is_coded && !error.is_string() && !error.is_object() {
        let reason = format!(
            "error is {}, expected an object with a code",
            shortened(error)
        );
        return Outcome::wrong(Class::Protocol, reason);
    }
    match &case.expected {
        Expected::Values(_) => {
            Outcome::wrong(Class::Range, format!("refused: {}", shortened(error)))
        }
        Expected::Refusal { .. } if is_coded => Outcome::Right,
        Expected::Refusal { .. } => {
            let error = shortened(error);
            Outcome::Acceptable(format!(
                "refused with {error}, expected an object with a code"
            ))
        }
    }
}

fn judge_values(case: &Case, ok: &Value, profile: &Profile) -> Outcome {
    let Value::Object(found) = ok else {
        let reason = format!("ok is {}, expected an object", shortened(ok));
        return Outcome::wrong(Class::Protocol, reason);
    };
    match &case.expected {
        Expected::Values(values) => match values
            .iter()
            .find_map(|wanted| differs(wanted, found, profile))
        {
            None => Outcome::Right,
            Some(Difference { class, place, text }) => Outcome::Wrong(Wrong {
                class,
                reason: format!("{place} {text}"),
                traces: traces(&case.wrong, values, found, profile),
            }),
        },
        Expected::Refusal { class, lenient } => {
            let reason = format!("answered {}, but must be refused", shortened(ok));
            if is_as_meant(lenient, found) {
                return Outcome::Acceptable(reason);
            }
            // What the case shows is what was not refused.
            let traces = Traces::of_all(&case.flags);
            Outcome::Wrong(Wrong {
                class: *class,
                reason,
                traces,
            })
        }
    }
}

/// Whether a request that must be refused was answered as it was meant; the tolerance tells that from other readings.
///
/// Implements: ORA-058.
fn is_as_meant(lenient: &Map<String, Value>, found: &Map<String, Value>) -> bool {
    let limit = Limit::stated(Tolerance::Relative(1e-6), 1.0);
    let is_near = |(key, value): (&String, &Value)| {
        found
            .get(key)
            .is_some_and(|found| compare(key, value, found, limit).is_ok())
    };
    !lenient.is_empty() && lenient.iter().all(is_near)
}

/// The difference of an answer from one wanted value.
fn differs(wanted: &Wanted, found: &Map<String, Value>, profile: &Profile) -> Option<Difference> {
    let Some(value) = found.get(&wanted.key) else {
        let (place, text) = (wanted.key.clone(), "is missing in the answer".into());
        return Some(Difference {
            place,
            text,
            class: Class::Protocol,
        });
    };
    compare(&wanted.key, &wanted.value, value, limit(wanted, profile)).err()
}

fn limit<'a>(wanted: &'a Wanted, profile: &Profile) -> Limit<'a> {
    let Wanted {
        tolerance,
        condition,
        ..
    } = wanted;
    Limit {
        tolerance: *tolerance,
        times: 1.0,
        condition,
        unit_roundoff: profile.unit_roundoff,
    }
}

/// Which keys of an answer are right, and which are those of each bug.
fn traces(
    bugs: &[BugAnswer],
    values: &[Wanted],
    found: &Map<String, Value>,
    profile: &Profile,
) -> Traces {
    // No op has nearly 64 keys.
    let keys = |is_its: &dyn Fn(&Wanted) -> bool| {
        let set = |(index, wanted)| u64::from(is_its(wanted)) << index;
        values.iter().enumerate().map(set).sum()
    };
    let of_bug = |bug: &BugAnswer| {
        let is_its = |wanted: &Wanted| match (bug.values.get(&wanted.key), found.get(&wanted.key)) {
            (Some(wrong), Some(found)) => {
                compare(&wanted.key, wrong, found, limit(wanted, profile)).is_ok()
            }
            _ => false,
        };
        (bug.flag.clone(), keys(&is_its))
    };
    Traces {
        all: keys(&|_| true),
        right: keys(&|wanted| differs(wanted, found, profile).is_none()),
        bugs: bugs.iter().map(of_bug).collect(),
    }
}
