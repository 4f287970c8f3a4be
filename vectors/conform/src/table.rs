//! The verdict for people.

use std::fmt::Write;

use super::diagnosis::{Diagnosis, Explanation};
use super::verdict::{Class, Count, Finding, Verdict};

/// Most findings that the table lists.
const MOST_FINDINGS: usize = 20;

/// The columns of counts.
type Column = (&'static str, fn(&Count) -> usize);
pub(super) const COLUMNS: [Column; 9] = [
    ("cases", |count| count.cases),
    ("right", |count| count.right),
    ("acceptable", |count| count.acceptable),
    ("mathematics", |count| count.mathematics),
    ("range", |count| count.range),
    ("protocol", |count| count.protocol),
    ("accepted", |count| count.accepted),
    ("extreme", |count| count.extreme),
    ("skipped", |count| count.skipped),
];

/// The verdict as text.
///
/// Implements: ORA-048.
pub fn table(verdict: &Verdict) -> String {
    let mut text = String::new();
    let widest = verdict.groups.iter().map(|group| group.group.len()).max();
    let width = widest.unwrap_or(0).max("group".len());
    // Columns of nothing are left out.
    let is_shown =
        |(name, of): &&Column| matches!(*name, "cases" | "right") || verdict.total(of) > 0;
    let columns: Vec<&Column> = COLUMNS.iter().filter(is_shown).collect();
    let mut line = |name: &str, cells: Vec<String>| {
        let cells: String = cells
            .iter()
            .zip(&columns)
            .map(|(cell, (head, _))| format!("  {cell:>0$}", head.len()))
            .collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:width$}{cells}");
    };
    line(
        "group",
        columns.iter().map(|(name, _)| name.to_string()).collect(),
    );
    for group in &verdict.groups {
        line(
            &group.group,
            columns
                .iter()
                .map(|(_, of)| of(group).to_string())
                .collect(),
        );
    }
    if !verdict.diagnosis.is_empty() {
        text.push_str("\nlikely bugs\n");
    }
    for diagnosis in &verdict.diagnosis {
        for said in diagnosis.lines() {
            let _ = writeln!(text, "  {said}");
        }
    }
    // What the program fails for comes first.
    let mut findings: Vec<&Finding> = verdict.findings.iter().collect();
    findings.sort_by_key(|finding| !finding.counts);
    if !findings.is_empty() {
        text.push_str("\nnot right\n");
    }
    for finding in findings.iter().take(MOST_FINDINGS) {
        let _ = writeln!(
            text,
            "  {} ({}), {}: {}",
            finding.case,
            finding.comment,
            finding.kind(),
            finding.reason
        );
    }
    if findings.len() > MOST_FINDINGS {
        let more = findings.len() - MOST_FINDINGS;
        let _ = writeln!(text, "  and {more} more, which --format json lists");
    }
    if !verdict.mended.is_empty() {
        let _ = writeln!(
            text,
            "\nright now, so that it can leave the list of accepted mistakes: {}",
            verdict.mended.join(", ")
        );
    }
    for note in &verdict.notes {
        let _ = writeln!(text, "\nnote: {note}");
    }
    let _ = writeln!(text, "\n{}", summary(verdict));
    text
}

/// The last line.
fn summary(verdict: &Verdict) -> String {
    let version = match &verdict.program.version[..] {
        "" => String::new(),
        version => format!("version {version}: "),
    };
    format!(
        "{version}{} of {} cases as they should be, {} skipped; profile {}; vectors {}",
        verdict.checked() - verdict.failed(),
        verdict.checked(),
        verdict.total(|group| group.skipped),
        verdict.profile.name,
        verdict.suite_sha256
    )
}

impl Class {
    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Class::Mathematics => "mathematics",
            Class::Range => "range",
            Class::Protocol => "protocol",
        }
    }
}

impl Finding {
    /// What counts of it, in words.
    pub(super) fn kind(&self) -> String {
        let class = self.class.map_or("acceptable", Class::name);
        match &self.accepted {
            Some(why) => format!("{class}, accepted ({why})"),
            None if self.extreme => format!("{class}, extreme"),
            None => class.into(),
        }
    }
}

impl Diagnosis {
    /// A line for each explanation, or one that says that there is none.
    pub(super) fn lines(&self) -> Vec<String> {
        let Diagnosis {
            group,
            class,
            wrong,
            explanations,
        } = self;
        let head = format!("{group}, {}", class.name());
        if explanations.is_empty() {
            return vec![format!("{head}: unexplained, {wrong} wrong")];
        }
        let line = |one: &Explanation| {
            let bug = |bug: &super::diagnosis::NamedBug| match &bug.notes[..] {
                "" => format!("{}, {}", bug.flag, bug.bug),
                notes => format!("{}, {} ({notes})", bug.flag, bug.bug),
            };
            let bugs: Vec<String> = one.bugs.iter().map(bug).collect();
            let against = match one.against {
                0 => String::new(),
                count => format!(", though {count} right answers would be wrong with it"),
            };
            format!(
                "{head}: {}; explains {} of {wrong}{against}, first {}",
                bugs.join(" and "),
                one.explains,
                one.first_case
            )
        };
        explanations.iter().map(line).collect()
    }
}
