//! The verdict for people.

use super::counts::{Counts, Finding};
use super::diagnosis::{Diagnosis, Explanation, NamedBug};
use super::verdict::Verdict;

/// The largest number of findings that the table lists.
const MOST_FINDINGS: usize = 20;

/// The verdict as text.
///
/// Implements: ORA-048.
pub fn table(verdict: &Verdict) -> String {
    // What the program fails for comes first.
    let mut findings: Vec<_> = verdict.findings.iter().collect();
    findings.sort_by_key(|finding| !finding.counts);
    let line = |finding: &&Finding| {
        let (case, comment) = (&finding.case, &finding.comment);
        format!("{case} ({comment}), {}: {}", finding.kind(), finding.reason)
    };
    let mut listed: Vec<String> = findings.iter().take(MOST_FINDINGS).map(line).collect();
    if findings.len() > MOST_FINDINGS {
        let more = findings.len() - MOST_FINDINGS;
        listed.push(format!("and {more} more, which --format json lists"));
    }
    let bugs = verdict.diagnosis.iter().flat_map(lines).collect();
    let mended = match verdict.mended.join(", ") {
        cases if cases.is_empty() => cases,
        cases => {
            format!("\nright now, so that it can leave the list of accepted mistakes: {cases}\n")
        }
    };
    let notes = verdict.notes.iter().map(|note| format!("\nnote: {note}\n"));
    let version = match &verdict.program.version[..] {
        "" => String::new(),
        version => format!("version {version}: "),
    };
    let Counts {
        failed,
        accepted,
        extreme,
        skipped,
        ..
    } = verdict.totals;
    let checked = verdict.totals.checked();
    let as_they_should_be = checked - failed - accepted - extreme;
    let apart = [(accepted, "accepted, "), (extreme, "extreme, ")];
    let apart = apart.iter().filter(|(count, _)| *count > 0);
    let apart = apart.map(|(count, kind)| format!("{count} {kind}"));
    format!(
        "{}{}{}{mended}{}\n{version}{as_they_should_be} of {checked} cases as they should be, {}{skipped} skipped; profile {}; vectors {}\n",
        counts(verdict),
        section("likely bugs", bugs),
        section("not right", listed),
        notes.collect::<String>(),
        apart.collect::<String>(),
        verdict.measure.profile.in_words(),
        verdict.suite_sha256
    )
}

/// Lines under a title, if there are any.
fn section(title: &str, lines: Vec<String>) -> String {
    if lines.is_empty() {
        return String::new();
    }
    format!("\n{title}\n  {}\n", lines.join("\n  "))
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
