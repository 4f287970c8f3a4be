//! The verdict as a page to be signed.

use std::fmt::Write;

use clap::ValueEnum;

use super::counts::Counts;
use super::table::lines;
use super::text::escaped;
use super::verdict::Verdict;

const STYLE: &str = "body{font:14px/1.4 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;margin:1em 0}th,td{border:1px solid #999;padding:.15em .6em;text-align:left;vertical-align:top}\
td.n{text-align:right}td:first-child{min-width:10em}code{font-size:12px;word-break:break-all}.sign td{height:2.5em;width:15em}";

/// A row of a table.
type Row = Vec<String>;

/// The verdict as one page of HTML.
///
/// Implements: ORA-050.
pub fn page(verdict: &Verdict) -> String {
    let outcome = if verdict.passed { "passed" } else { "failed" };
    let head = verdict.totals.columns().map(|(name, _)| name.to_string());
    let cells = |name: &str, counts: &Counts| {
        let cells = counts.columns().map(|(_, count)| count.to_string());
        std::iter::once(name.to_string()).chain(cells).collect()
    };
    let mut results: Vec<Row> = vec![std::iter::once("group".into()).chain(head).collect()];
    let groups = verdict.groups.iter();
    results.extend(groups.map(|group| cells(&group.group, &group.counts)));
    results.push(cells("all", &verdict.totals));
    let (mut accepted, mut not_right) = (Vec::new(), Vec::new());
    for finding in &verdict.findings {
        let row = |kind| vec![finding.case.clone(), kind, finding.reason.clone()];
        match &finding.accepted {
            Some(why) => accepted.push(row(why.clone())),
            None => not_right.push(row(finding.kind())),
        }
    }
    let one_cell = |line| vec![line];
    let explanations = verdict.diagnosis.iter().flat_map(lines).map(one_cell);
    let notes = verdict.notes.iter().cloned().map(one_cell);
    let sections = [
        section("Accepted", accepted),
        section("Not right", not_right),
        section("Likely bugs", explanations.collect()),
        section("Notes", notes.collect()),
    ];
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Certificate of conformance</title>\n<style>{STYLE}</style>\n\
         <h1>Conformance to palpate's test vectors: {outcome}</h1>\n\
         {}{}\
         <p><i>mathematics</i>, <i>range</i> and <i>protocol</i> are wrong answers. <i>accepted</i> answers are known mistakes, listed below. \
         <i>extreme</i> answers are wrong at the limit of the precision, and do not count.</p>\n\
         {}\
         <h2>Signed</h2>\n<table class=\"sign\"><tr><th>Name</th><td></td></tr><tr><th>Date</th><td></td></tr>\
         <tr><th>Signature</th><td></td></tr></table>\n</html>\n",
        table(&facts(verdict)),
        section("Results", results),
        sections.concat()
    )
}

/// What was judged, and how.
fn facts(verdict: &Verdict) -> Vec<Row> {
    let (measure, program) = (&verdict.measure, &verdict.program);
    let profile = &measure.profile;
    let precision = match profile.unit_roundoff {
        0.0 => format!("{}: the stated tolerances", profile.name),
        u => format!(
            "{}: unit roundoff {u:.3e}, numbers from {:.3e} to {:.3e}",
            profile.name, profile.smallest, profile.largest
        ),
    };
    let required = measure.require.to_possible_value();
    let required = required.as_ref().and_then(|value| value.get_help());
    let required = required.map(|help| help.to_string()).unwrap_or_default();
    let extreme = if measure.extreme { "" } else { " do not" };
    let judge = format!("palpate-conform {}", verdict.conform_version);
    let fact = |name: &str, value: &str| vec![name.to_string(), value.to_string()];
    let mut rows = vec![
        fact("Program", &program.command.join(" ")),
        fact("Version", &program.version),
    ];
    let files = program.files.iter();
    rows.extend(files.map(|file| fact(&format!("SHA-256 of {}", file.name), &file.sha256)));
    rows.extend([
        fact("SHA-256 of the vectors", &verdict.suite_sha256),
        fact("Profile", &precision),
        fact(
            "Required",
            &format!("{required}; extreme cases{extreme} count"),
        ),
        fact(
            "Result",
            verdict.failure.as_deref().unwrap_or("as required"),
        ),
        fact("Judged by", &judge),
    ]);
    rows
}

/// A table under a title, if it has rows.
fn section(title: &str, rows: Vec<Row>) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!("<h2>{title}</h2>\n{}", table(&rows))
}

/// Rows of cells; numbers are set to the right.
fn table(rows: &[Row]) -> String {
    let mut text = String::from("<table>\n");
    for row in rows {
        text.push_str("<tr>");
        for cell in row {
            let is_number = !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit());
            let class = if is_number { " class=\"n\"" } else { "" };
            // Writing to a String cannot fail.
            let _ = write!(text, "<td{class}>{}</td>", escaped(cell));
        }
        text.push_str("</tr>\n");
    }
    text + "</table>\n"
}
