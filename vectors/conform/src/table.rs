//! The verdict for people.

use std::fmt::Write;

use super::verdict::Verdict;

/// Most failures that the table lists.
const MOST_FAILURES: usize = 20;

/// The verdict as text.
pub fn table(verdict: &Verdict) -> String {
    let mut text = String::new();
    let widest = verdict.groups.iter().map(|group| group.group.len()).max();
    let width = widest.unwrap_or(0).max("group".len());
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{:width$} {:>7} {:>7} {:>8} {:>7} {:>8}",
        "group", "cases", "passed", "refused", "failed", "skipped"
    );
    for group in &verdict.groups {
        let _ = writeln!(
            text,
            "{:width$} {:>7} {:>7} {:>8} {:>7} {:>8}",
            group.group, group.cases, group.passed, group.refused, group.failed, group.skipped
        );
    }
    if !verdict.likely_bugs.is_empty() {
        text.push_str("\nlikely bugs\n");
    }
    for bug in &verdict.likely_bugs {
        let notes = if bug.notes.is_empty() {
            String::new()
        } else {
            format!(" ({})", bug.notes)
        };
        let _ = writeln!(
            text,
            "  {} in {}: {}{notes}; {} cases, first {}",
            bug.flag, bug.group, bug.bug, bug.cases, bug.first_case
        );
    }
    if !verdict.failures.is_empty() {
        text.push_str("\nfailed\n");
    }
    for failure in verdict.failures.iter().take(MOST_FAILURES) {
        let _ = writeln!(
            text,
            "  {} ({}): {}",
            failure.case, failure.comment, failure.reason
        );
    }
    if verdict.failures.len() > MOST_FAILURES {
        let more = verdict.failures.len() - MOST_FAILURES;
        let _ = writeln!(text, "  and {more} more, which --format json lists");
    }
    for note in &verdict.notes {
        let _ = writeln!(text, "\nnote: {note}");
    }
    let skipped: usize = verdict.groups.iter().map(|group| group.skipped).sum();
    let _ = writeln!(
        text,
        "\nversion {}: {} of {} cases as they should be, {skipped} not claimed; vectors {}",
        verdict.version,
        verdict.checked() - verdict.failures.len(),
        verdict.checked(),
        verdict.suite_sha256
    );
    text
}
