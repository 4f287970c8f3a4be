//! The vectors for other implementations, asked of the oracle of this build, in this process.

use serde_json::Value;

use super::{Check, Figure};
use palpate::oracle::serve;
use palpate_conform::{Case, Count, Outcome, Question, Suite, Verdict, judge};

/// The checks of this part.
pub const CHECKS: &[Check] = &[Check::new(
    "vectors.oracle",
    "The oracle of this build answers every vector of the embedded suite within its tolerance, \
         and refuses what must be refused.",
    &["ORA-001", "ORA-046", "VEC-002", "EVD-050"],
    oracle,
)];

/// Implements: EVD-050.
fn oracle() -> Result<Vec<Figure>, String> {
    let suite = Suite::embedded().map_err(|error| error.to_string())?;
    let verdict = verdict(&suite, answers)?;
    Ok(figures(&suite, &verdict))
}

/// The oracle's answers, a line to a line.
fn answers(requests: &[u8]) -> Result<Vec<u8>, String> {
    let mut answers = Vec::new();
    serve(requests, &mut answers).map_err(|error| error.to_string())?;
    Ok(answers)
}

/// The verdict on what `answers` gives for the lines of all cases.
fn verdict(
    suite: &Suite,
    answers: impl Fn(&[u8]) -> Result<Vec<u8>, String>,
) -> Result<Verdict, String> {
    let lines: Vec<u8> = suite
        .groups
        .iter()
        .flat_map(|group| group.cases.iter().flat_map(|case| case.line(&group.op)))
        .collect();
    let answered = answers(&lines)?;
    let mut answered = answered.split(|&byte| byte == b'\n');
    let mut judged = |case| outcome(case, answered.next().unwrap_or_default());
    let outcomes: Vec<Vec<Outcome>> = suite
        .groups
        .iter()
        .map(|group| group.cases.iter().map(&mut judged).collect())
        .collect();
    if answered.next() != Some(b"") || answered.next().is_some() {
        return Err("the oracle did not give one line for each request".into());
    }
    let version = env!("CARGO_PKG_VERSION").into();
    Ok(Verdict::new(
        suite,
        Vec::new(),
        version,
        outcomes,
        Vec::new(),
    ))
}

/// One answer, which must have the case's id; that of a line which is no request may be lost.
fn outcome(case: &Case, answer: &[u8]) -> Outcome {
    let Ok(answer) = serde_json::from_slice::<Value>(answer) else {
        return Outcome::failed("answered with no JSON");
    };
    let id = answer.get("id").unwrap_or(&Value::Null);
    let may_be_lost = matches!(case.question, Question::Line(_));
    if *id == *case.id || (id.is_null() && may_be_lost) {
        judge(case, &answer)
    } else {
        Outcome::failed(format!("answered with the id {id}"))
    }
}

fn figures(suite: &Suite, verdict: &Verdict) -> Vec<Figure> {
    let sum = |of: fn(&Count) -> usize| verdict.groups.iter().map(of).sum::<usize>() as u64;
    let [passed, refused] = [sum(|group| group.passed), sum(|group| group.refused)];
    let failed = match verdict.failures.first() {
        None => "cases failed".into(),
        Some(first) => format!(
            "cases failed, the first {} of {}: {}",
            first.case, first.group, first.reason
        ),
    };
    vec![
        Figure::told("groups of cases", verdict.groups.len() as f64),
        Figure::count("cases passed", passed + refused, suite.cases() as u64),
        Figure::told("cases of these that must be refused", refused as f64),
        Figure::count(failed, verdict.failures.len() as u64, 0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures for the oracle's answers to one group, with a change.
    fn changed(change: impl Fn(String) -> String) -> Result<Vec<Figure>, String> {
        let suite = Suite::embedded().unwrap().only(&["normal_cdf".into()]);
        let answers = |requests: &[u8]| {
            let text = String::from_utf8(answers(requests)?).unwrap();
            Ok(change(text).into_bytes())
        };
        Ok(figures(&suite, &verdict(&suite, answers)?))
    }

    // Verifies: EVD-050.
    #[test]
    fn a_wrong_answer_is_a_failed_case_and_named() {
        // The number of the first answer that has one, made negative.
        let figures = changed(|text| text.replacen(":0.", ":-0.", 1)).unwrap();
        let failed = figures.last().unwrap();
        assert_eq!(failed.value, 1.0, "{failed}");
        assert!(
            failed.what.starts_with("cases failed, the first "),
            "{failed}"
        );
        assert!(!failed.passes() && !figures[1].passes());
    }

    // Verifies: EVD-050.
    #[test]
    fn a_right_answer_that_is_not_the_case_s_own_fails_and_so_does_a_missing_one() {
        let first = "\"id\":\"normal_cdf-001\"";
        for id in ["\"id\":\"normal_cdf-002\"", "\"id\":null", "\"id\":1"] {
            let failed = changed(|text| text.replacen(first, id, 1))
                .unwrap()
                .pop()
                .unwrap();
            assert_eq!(failed.value, 1.0, "{failed}");
        }
        let moved = |text: String| {
            let (first, rest) = text.split_once('\n').unwrap();
            format!("{rest}{first}\n")
        };
        assert!(changed(moved).unwrap().last().unwrap().value > 100.0);
        let missing = |text: String| text.split_once('\n').unwrap().1.to_string();
        assert!(changed(missing).is_err());
    }
}
