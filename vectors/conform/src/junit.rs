//! The verdict for CI: JUnit's XML, as Jenkins, GitLab and others read it.

use std::fmt::Write;

use super::suite::Suite;
use super::verdict::{Count, Outcome, Verdict};

/// The verdict as XML; `suite` holds the groups of the verdict, and may hold others.
///
/// Implements: ORA-050.
pub fn junit(verdict: &Verdict, suite: &Suite) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let total = |count: fn(&Count) -> usize| verdict.groups.iter().map(count).sum::<usize>();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "<testsuites name=\"palpate-conform, vectors {}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">",
        verdict.suite_sha256,
        total(|group| group.cases),
        total(|group| group.failed),
        total(|group| group.skipped),
    );
    for (count, outcomes) in verdict.groups.iter().zip(&verdict.outcomes) {
        let _ = writeln!(
            text,
            "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">",
            escaped(&count.group),
            count.cases,
            count.failed,
            count.skipped
        );
        let cases = suite.groups.iter().find(|group| group.name == count.group);
        for (case, outcome) in cases.iter().flat_map(|group| &group.cases).zip(outcomes) {
            let head = format!(
                "<testcase classname=\"palpate.{}\" name=\"{}: {}\"",
                escaped(&count.group),
                escaped(&case.id),
                escaped(&case.comment)
            );
            let _ = match outcome {
                Outcome::Passed | Outcome::Refused => writeln!(text, "{head}/>"),
                Outcome::Skipped => writeln!(
                    text,
                    "{head}><skipped message=\"the program does not claim {}\"/></testcase>",
                    escaped(&count.op)
                ),
                Outcome::Failed { reason, bugs } => writeln!(
                    text,
                    "{head}><failure message=\"{}\">{}</failure></testcase>",
                    escaped(reason),
                    escaped(&bugs.join(", "))
                ),
            };
        }
        text.push_str("</testsuite>\n");
    }
    text.push_str("</testsuites>\n");
    text
}

/// Text between tags or quotes; characters that XML does not have become U+FFFD.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(character),
        }
    }
    out
}
