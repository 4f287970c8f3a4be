//! The verdict for CI: JUnit's XML, as Jenkins, GitLab and others read it.

use std::fmt::Write;

use super::suite::Suite;
use super::text::escaped;
use super::verdict::{Class, Finding, Outcome, Verdict};

/// The verdict as XML; `suite` is the one that was judged. A finding that the program does not fail for is a skipped test.
///
/// Implements: ORA-050.
pub fn junit(verdict: &Verdict, suite: &Suite) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let counted = |group: Option<&str>| {
        let findings = || verdict.findings.iter();
        let is_of = |finding: &&Finding| group.is_none_or(|group| finding.group == group);
        let failures = findings()
            .filter(is_of)
            .filter(|finding| finding.counts)
            .count();
        let passed_over = findings()
            .filter(is_of)
            .filter(|finding| !finding.counts)
            .count();
        (failures, passed_over)
    };
    let (failures, passed_over) = counted(None);
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "<testsuites name=\"palpate-conform, vectors {}\" tests=\"{}\" failures=\"{failures}\" skipped=\"{}\">",
        verdict.suite_sha256,
        verdict.total(|group| group.cases),
        verdict.total(|group| group.skipped) + passed_over,
    );
    let mut findings = verdict.findings.iter().peekable();
    for (index, (count, group)) in verdict.groups.iter().zip(&suite.groups).enumerate() {
        let (failures, passed_over) = counted(Some(&group.name));
        let _ = writeln!(
            text,
            "<testsuite name=\"{}\" tests=\"{}\" failures=\"{failures}\" errors=\"0\" skipped=\"{}\">",
            escaped(&group.name),
            count.cases,
            count.skipped + passed_over,
        );
        for (case, outcome) in group.cases.iter().zip(&verdict.outcomes[index]) {
            let finding = findings.next_if(|finding| finding.case == case.id);
            let _ = writeln!(
                text,
                "<testcase classname=\"palpate.{}\" name=\"{}: {}\"{}",
                escaped(&group.name),
                escaped(&case.id),
                escaped(&case.comment),
                content(outcome, finding),
            );
        }
        text.push_str("</testsuite>\n");
    }
    text.push_str("</testsuites>\n");
    text
}

/// What follows the attributes of a test.
fn content(outcome: &Outcome, finding: Option<&Finding>) -> String {
    let skipped = |why: &str| format!("><skipped message=\"{}\"/></testcase>", escaped(why));
    match (outcome, finding) {
        (Outcome::Skipped(why), _) => skipped(why),
        (_, None) => "/>".into(),
        (_, Some(finding)) if finding.counts => format!(
            "><failure type=\"{}\" message=\"{}\"/></testcase>",
            finding.class.map_or("acceptable", Class::name),
            escaped(&finding.reason),
        ),
        (_, Some(finding)) => match &finding.accepted {
            Some(why) => skipped(&format!("accepted, {why}: {}", finding.reason)),
            None => skipped(&format!("does not count: {}", finding.reason)),
        },
    }
}
