//! The verdict as a page to be signed.

use std::fmt::Write;

use super::table::COLUMNS;
use super::text::escaped;
use super::verdict::{Count, Require, Verdict};

const STYLE: &str = "body{font:14px/1.4 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;margin:1em 0}th,td{border:1px solid #999;padding:.15em .6em;text-align:left;vertical-align:top}\
td.n{text-align:right}td:first-child{min-width:10em}code{font-size:12px;word-break:break-all}.sign td{height:2.5em;width:15em}";

/// The verdict as one page of HTML.
///
/// Implements: ORA-050.
pub fn page(verdict: &Verdict) -> String {
    let mut page = String::new();
    let outcome = if verdict.passed { "passed" } else { "failed" };
    // Writing to a String cannot fail.
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Certificate of conformance</title>\n<style>{STYLE}</style>\n\
         <h1>Conformance to palpate's test vectors: {outcome}</h1>\n"
    );
    table(&mut page, &facts(verdict));
    page.push_str("<h2>Results</h2>\n");
    let mut rows = vec![heads()];
    rows.extend(
        verdict
            .groups
            .iter()
            .map(|group| cells(&group.group, |of| of(group))),
    );
    rows.push(cells("all", |of| verdict.total(of)));
    table(&mut page, &rows);
    page.push_str("<p><i>mathematics</i>, <i>range</i> and <i>protocol</i> are wrong answers; <i>accepted</i> ones are known and listed below; \
         <i>extreme</i> ones are wrong where the precision of the profile ends, and do not count.</p>\n");
    let accepted = verdict
        .findings
        .iter()
        .filter(|finding| finding.accepted.is_some());
    section(
        &mut page,
        "Accepted",
        accepted.map(|finding| {
            vec![
                finding.case.clone(),
                finding.accepted.clone().unwrap_or_default(),
                finding.reason.clone(),
            ]
        }),
    );
    let counted = verdict
        .findings
        .iter()
        .filter(|finding| finding.accepted.is_none());
    section(
        &mut page,
        "Not right",
        counted.map(|finding| vec![finding.case.clone(), finding.kind(), finding.reason.clone()]),
    );
    section(
        &mut page,
        "What explains it",
        verdict
            .diagnosis
            .iter()
            .flat_map(|one| one.lines())
            .map(|line| vec![line]),
    );
    section(
        &mut page,
        "Notes",
        verdict.notes.iter().map(|note| vec![note.clone()]),
    );
    page.push_str("<h2>Signed</h2>\n<table class=\"sign\"><tr><th>Name</th><td></td></tr><tr><th>Date</th><td></td></tr><tr><th>Signature</th><td></td></tr></table>\n</html>\n");
    page
}

/// What was judged, and how.
fn facts(verdict: &Verdict) -> Vec<Vec<String>> {
    let profile = &verdict.profile;
    let precision = match profile.unit_roundoff {
        0.0 => format!("{}: the stated tolerances", profile.name),
        u => format!(
            "{}: unit roundoff {u:.3e}, numbers from {:.3e} to {:.3e}",
            profile.name, profile.smallest, profile.largest
        ),
    };
    let required = match verdict.require {
        Require::Right => "every answer is right",
        Require::Acceptable => "no answer is wrong",
        Require::Range => "no answer is wrong in mathematics or range",
        Require::Mathematics => "no answer is wrong in mathematics",
    };
    let extreme = if verdict.extreme_counts {
        "count"
    } else {
        "do not count"
    };
    let fact = |name: &str, value: String| vec![name.to_string(), value];
    let mut rows = vec![
        fact("Program", verdict.program.command.join(" ")),
        fact("Its version", verdict.program.version.clone()),
    ];
    rows.extend(
        verdict
            .program
            .files
            .iter()
            .map(|file| fact(&format!("SHA-256 of {}", file.name), file.sha256.clone())),
    );
    rows.extend([
        fact("SHA-256 of the vectors", verdict.suite_sha256.clone()),
        fact("Profile", precision),
        fact("Required", format!("{required}; extreme cases {extreme}")),
        fact(
            "Result",
            verdict.failure().unwrap_or_else(|| "as required".into()),
        ),
        fact(
            "Judged by",
            format!("palpate-conform {}", verdict.conform_version),
        ),
    ]);
    rows
}

fn heads() -> Vec<String> {
    let names = COLUMNS.iter().map(|(name, _)| name.to_string());
    std::iter::once("group".to_string()).chain(names).collect()
}

fn cells(name: &str, value: impl Fn(fn(&Count) -> usize) -> usize) -> Vec<String> {
    let values = COLUMNS.iter().map(|(_, of)| value(*of).to_string());
    std::iter::once(name.to_string()).chain(values).collect()
}

/// A table under a title, if it has rows.
fn section(page: &mut String, title: &str, rows: impl Iterator<Item = Vec<String>>) {
    let rows: Vec<Vec<String>> = rows.collect();
    if !rows.is_empty() {
        let _ = writeln!(page, "<h2>{title}</h2>");
        table(page, &rows);
    }
}

/// Rows of cells; numbers stand to the right.
fn table(page: &mut String, rows: &[Vec<String>]) {
    page.push_str("<table>\n");
    for row in rows {
        page.push_str("<tr>");
        for cell in row {
            let is_number = !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit());
            let class = if is_number { " class=\"n\"" } else { "" };
            let _ = write!(page, "<td{class}>{}</td>", escaped(cell));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</table>\n");
}
