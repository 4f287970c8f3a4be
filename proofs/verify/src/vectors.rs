//! The vectors for other implementations, asked of the oracle of this build, in this process.

use super::{Check, Figure};
use palpate::oracle::serve;
use palpate_conform::{Case, Expected, Measure, Program, Suite, Verdict, judge_lines};

/// The checks of this part.
pub const CHECKS: &[Check] = &[Check::new(
    "vectors.oracle",
    "The oracle of this build answers every vector of the embedded suite within its tolerance, \
         and refuses what must be refused.",
    &["ORA-001", "ORA-046", "VEC-001"],
    oracle,
)];

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
    let lines = suite.groups.iter().flat_map(|group| {
        let line = |case: &Case| case.line(&group.op);
        group.cases.iter().map(line)
    });
    let answered = answers(lines.collect::<String>().as_bytes())?;
    let measure = Measure::exact();
    let outcomes = judge_lines(suite, &answered, &measure.profile);
    let program = Program::default();
    Ok(Verdict::new(suite, &measure, program, outcomes, Vec::new()))
}

fn figures(suite: &Suite, verdict: &Verdict) -> Vec<Figure> {
    let cases = suite.groups.iter().flat_map(|group| &group.cases);
    let refused = cases.filter(|case| matches!(case.expected, Expected::Refusal { .. }));
    let failed = match verdict.findings.first() {
        None => "cases failed".into(),
        Some(first) => format!(
            "cases failed, the first {} of {}: {}",
            first.case, first.group, first.reason
        ),
    };
    let right = verdict.total(|group| group.right) as u64;
    vec![
        Figure::told("groups of cases", verdict.groups.len() as f64),
        Figure::count("cases right", right, suite.cases() as u64),
        Figure::told(
            "cases of these that must be refused",
            refused.count() as f64,
        ),
        Figure::count(failed, verdict.findings.len() as u64, 0),
    ]
}

#[cfg(test)]
mod tests {
    use palpate_conform::Choice;

    use super::*;

    /// The figures for the oracle's answers to one group, with a change.
    fn changed(change: impl Fn(String) -> String) -> Result<Vec<Figure>, String> {
        let only = vec!["normal_cdf".into()];
        let choice = Choice {
            only,
            ..Choice::default()
        };
        let suite = Suite::embedded().unwrap().select(&choice).unwrap();
        let answers = |requests: &[u8]| {
            let text = String::from_utf8(answers(requests)?).unwrap();
            Ok(change(text).into_bytes())
        };
        Ok(figures(&suite, &verdict(&suite, answers)?))
    }

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

    #[test]
    fn a_right_answer_that_is_not_the_case_s_own_fails_and_so_does_a_missing_one() {
        let first = "\"id\":\"normal_cdf-001\"";
        // The id of the second case leaves the first one without an answer too.
        for (id, wrong) in [
            ("\"id\":\"normal_cdf-002\"", 2.0),
            ("\"id\":null", 1.0),
            ("\"id\":1", 1.0),
        ] {
            let figures = changed(|text| text.replacen(first, id, 1)).unwrap();
            assert_eq!(figures.last().unwrap().value, wrong, "{id}");
        }
        let moved = |text: String| {
            let (first, rest) = text.split_once('\n').unwrap();
            format!("{rest}{first}\n")
        };
        assert_eq!(changed(moved).unwrap().last().unwrap().value, 1.0);
        let missing = |text: String| text.split_once('\n').unwrap().1.to_string();
        assert_eq!(changed(missing).unwrap().last().unwrap().value, 1.0);
    }
}
