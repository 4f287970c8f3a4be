//! The verdict for CI: JUnit's XML, as Jenkins, GitLab and others read it.

use std::fmt::Write;

use super::counts::{Counts, Finding};
use super::outcome::Outcome;
use super::suite::Suite;
use super::text::escaped;
use super::verdict::Verdict;

/// The verdict as XML; `suite` is the one that was judged. A finding that the program does not fail for is a skipped test. If no case
/// fails, but the program does, a test of its own tells why.
///
/// Implements: ORA-050.
pub fn junit(verdict: &Verdict, suite: &Suite) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let why = verdict.failure.as_deref();
    let why = why.filter(|_| verdict.totals.failed == 0);
    let verdict_itself = Counts {
        cases: 1,
        failed: 1,
        ..Counts::default()
    };
    let mut all = verdict.totals.clone();
    all += &why.map_or_else(Counts::default, |_| verdict_itself.clone());
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "<testsuites name=\"palpate-conform, profile {}, vectors {}\" {}>",
        escaped(&verdict.measure.profile.in_words()),
        verdict.suite_sha256,
        totals(&all, "")
    );
    let mut findings = verdict.findings.iter().peekable();
    let mut outcomes = verdict.outcomes.iter();
    for (count, group) in verdict.groups.iter().zip(&suite.groups) {
        let name = escaped(&group.name);
        let counts = totals(&count.counts, "errors=\"0\" ");
        let _ = writeln!(text, "<testsuite name=\"{name}\" {counts}>");
        for (case, outcome) in group.cases.iter().zip(&mut outcomes) {
            let finding = findings.next_if(|finding| finding.case == case.id);
            let _ = writeln!(
                text,
                "<testcase classname=\"palpate.{name}\" name=\"{}: {}\"{}",
                escaped(&case.id),
                escaped(&case.comment),
                content(outcome, finding),
            );
        }
        text.push_str("</testsuite>\n");
    }
    if let Some(why) = why {
        let _ = writeln!(
            text,
            "<testsuite name=\"verdict\" {}>\n<testcase classname=\"palpate.verdict\" name=\"the program passes\">\
             <failure type=\"verdict\" message=\"{}\"/></testcase>\n</testsuite>",
            totals(&verdict_itself, "errors=\"0\" "),
            escaped(why)
        );
    }
    text.push_str("</testsuites>\n");
    text
}

/// The attributes that count tests. Every test passes, fails or is skipped.
fn totals(counts: &Counts, errors: &str) -> String {
    let Counts {
        cases,
        right,
        failed,
        ..
    } = counts;
    let skipped = cases - right - failed;
    format!("tests=\"{cases}\" failures=\"{failed}\" {errors}skipped=\"{skipped}\"")
}

/// What follows the attributes of a test.
fn content(outcome: &Outcome, finding: Option<&Finding>) -> String {
    let (element, message) = match (outcome, finding) {
        (Outcome::Skipped(why), _) => ("skipped".into(), why.clone()),
        (Outcome::Unclaimed(op), _) => {
            let why = format!("the program does not claim {op}");
            ("skipped".into(), why)
        }
        (_, None) => return "/>".into(),
        (_, Some(finding)) => {
            let reason = finding.reason.clone();
            match &finding.accepted {
                _ if finding.counts => {
                    (format!("failure type=\"{}\"", finding.class_name()), reason)
                }
                Some(why) => ("skipped".into(), format!("accepted, {why}: {reason}")),
                None => ("skipped".into(), format!("does not count: {reason}")),
            }
        }
    };
    format!("><{element} message=\"{}\"/></testcase>", escaped(&message))
}
