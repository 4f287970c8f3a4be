//! The verdict for people.

use std::fmt::Write;

use super::counts::Counts;
use super::diagnosis::{Diagnosis, Explanation, NamedBug};
use super::verdict::Verdict;

/// The largest number of findings that the table lists.
const MOST_FINDINGS: usize = 20;

/// The verdict as text.
///
/// Implements: ORA-048.
pub fn table(verdict: &Verdict) -> String {
    let mut text = counts(verdict);
    // Writing to a String cannot fail.
    if !verdict.diagnosis.is_empty() {
        text.push_str("\nlikely bugs\n");
    }
    for line in verdict.diagnosis.iter().flat_map(lines) {
        let _ = writeln!(text, "  {line}");
    }
    // What the program fails for comes first.
    let mut findings: Vec<_> = verdict.findings.iter().collect();
    findings.sort_by_key(|finding| !finding.counts);
    if !findings.is_empty() {
        text.push_str("\nnot right\n");
    }
    for finding in findings.iter().take(MOST_FINDINGS) {
        let (case, comment) = (&finding.case, &finding.comment);
        let (kind, reason) = (finding.kind(), &finding.reason);
        let _ = writeln!(text, "  {case} ({comment}), {kind}: {reason}");
    }
    if findings.len() > MOST_FINDINGS {
        let more = findings.len() - MOST_FINDINGS;
        let _ = writeln!(text, "  and {more} more, which --format json lists");
    }
    if !verdict.mended.is_empty() {
        let cases = verdict.mended.join(", ");
        let _ = writeln!(
            text,
            "\nright now, so that it can leave the list of accepted mistakes: {cases}"
        );
    }
    for note in &verdict.notes {
        let _ = writeln!(text, "\nnote: {note}");
    }
    let version = match &verdict.program.version[..] {
        "" => String::new(),
        version => format!("version {version}: "),
    };
    let Counts {
        failed, skipped, ..
    } = verdict.totals;
    let checked = verdict.totals.checked();
    let _ = writeln!(
        text,
        "\n{version}{} of {checked} cases as they should be, {skipped} skipped; profile {}; vectors {}",
        checked - failed,
        verdict.measure.profile.name,
        verdict.suite_sha256
    );
    text
}

/// The counts of each group, without columns of zeros.
fn counts(verdict: &Verdict) -> String {
    let names = verdict.groups.iter().map(|group| group.group.len());
    let width = names.max().unwrap_or(0).max("group".len());
    let totals: Vec<_> = verdict.totals.columns().collect();
    let row = |name: &str, cells: Vec<String>| {
        let cells = cells.iter().zip(&totals);
        let cells =
            cells.filter(|(_, (head, total))| matches!(*head, "cases" | "right") || *total > 0);
        let cells = cells.map(|(cell, (head, _))| format!("  {cell:>0$}", head.len()));
        format!("{name:width$}{}\n", cells.collect::<String>())
    };
    let mut text = row(
        "group",
        totals.iter().map(|(head, _)| head.to_string()).collect(),
    );
    for group in &verdict.groups {
        let cells = group.counts.columns().map(|(_, count)| count.to_string());
        text.push_str(&row(&group.group, cells.collect()));
    }
    text
}

/// A line for each explanation, or one that says that there is none.
pub(super) fn lines(diagnosis: &Diagnosis) -> Vec<String> {
    let wrong = diagnosis.wrong;
    let head = format!("{}, {}", diagnosis.group, diagnosis.class.name());
    if diagnosis.explanations.is_empty() {
        return vec![format!("{head}: unexplained, {wrong} wrong")];
    }
    let bug = |NamedBug { flag, bug, notes }: &NamedBug| match &notes[..] {
        "" => format!("{flag}, {bug}"),
        notes => format!("{flag}, {bug} ({notes})"),
    };
    let line = |one: &Explanation| {
        let Explanation {
            explains,
            first_case,
            ..
        } = one;
        let bugs: Vec<String> = one.bugs.iter().map(bug).collect();
        let bugs = bugs.join(" and ");
        let against = match one.against {
            0 => String::new(),
            count => format!(", though {count} right answers would be wrong with it"),
        };
        format!("{head}: {bugs}; explains {explains} of {wrong}{against}, first {first_case}")
    };
    diagnosis.explanations.iter().map(line).collect()
}
