//! One answer, judged against what is expected.

use serde_json::{Map, Value};

use super::case::{Case, Expected, Wanted};
use super::outcome::{Class, Outcome, Traces, Wrong};
use super::profile::Profile;
use super::text::shortened;
use super::tolerance::{Limit, Tolerance, compare};

/// Judges the answer to a case, apart from its id.
///
/// Implements: ORA-046, ORA-047, ORA-058.
pub fn judge(case: &Case, answer: &Value, profile: &Profile) -> Outcome {
    let malformed = |what: &str, value| {
        Outcome::wrong(Class::Protocol, format!("{what}, not {}", shortened(value)))
    };
    match (answer.get("ok"), answer.get("error")) {
        (Some(Value::Object(found)), None) => match &case.expected {
            Expected::Values(values) => judge_values(case, values, found, profile.unit_roundoff),
            Expected::Refusal { class, lenient } => judge_unrefused(case, *class, lenient, found),
        },
        (Some(ok), None) => malformed("ok must be an object", ok),
        (None, Some(error)) => {
            let is_coded = error["code"].is_string();
            if !is_coded && !error.is_string() && !error.is_object() {
                return malformed("error must be an object with a code", error);
            }
            let refused = format!("refused with {}", shortened(error));
            match &case.expected {
                Expected::Values(_) => Outcome::wrong(Class::Range, refused),
                Expected::Refusal { .. } if is_coded => Outcome::Right,
                Expected::Refusal { .. } => {
                    Outcome::Acceptable(refused + ", not with an object with a code")
                }
            }
        }
        _ => malformed("an answer must have either ok or error", answer),
    }
}

fn judge_values(
    case: &Case,
    values: &[Wanted],
    found: &Map<String, Value>,
    unit_roundoff: f64,
) -> Outcome {
    let difference = |wanted: &Wanted| wanted.compare(&wanted.value, found, unit_roundoff).err();
    let differences = values.iter().filter_map(difference);
    let Some(worst) = differences.min_by_key(|of| of.class) else {
        return Outcome::Right;
    };
    // One bit for each key; no op has nearly 64 keys.
    let keys = |is_in: &dyn Fn(&Wanted) -> bool| {
        let bit = |(index, wanted)| u64::from(is_in(wanted)) << index;
        values.iter().enumerate().map(bit).sum()
    };
    let bugs = case.wrong.iter().map(|bug| {
        let is_its = |wanted: &Wanted| {
            let value = bug.values.get(&wanted.key);
            value.is_some_and(|value| wanted.compare(value, found, unit_roundoff).is_ok())
        };
        (bug.flag.clone(), keys(&is_its))
    });
    Outcome::Wrong(Wrong {
        class: worst.class,
        reason: worst.to_string(),
        traces: Traces {
            all: keys(&|_| true),
            right: keys(&|wanted| difference(wanted).is_none()),
            bugs: bugs.collect(),
        },
    })
}

/// Judges an answer to a question that must be refused. The tolerance of 10⁻⁶ tells the intended reading from others.
///
/// Implements: ORA-058.
fn judge_unrefused(
    case: &Case,
    class: Class,
    lenient: &Map<String, Value>,
    found: &Map<String, Value>,
) -> Outcome {
    let limit = Limit::stated(Tolerance::Relative(1e-6), 1.0);
    let is_near = |(key, value): (&String, &Value)| {
        let found = found.get(key);
        found.is_some_and(|found| compare(key, value, found, limit).is_ok())
    };
    let answer = shortened(&Value::Object(found.clone()));
    let reason = format!("answered {answer}, but must be refused");
    if !lenient.is_empty() && lenient.iter().all(is_near) {
        return Outcome::Acceptable(reason);
    }
    Outcome::Wrong(Wrong {
        class,
        reason,
        // The flags of the case are the bugs that keep a program from refusing it.
        traces: Traces::of_all(&case.flags),
    })
}
