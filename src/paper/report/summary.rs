//! `summary.json`: the findings for programs.

use serde::Serialize;

use super::{Findings, Run, Settings, VERSION};

/// Implements: REP-050.
#[derive(Serialize)]
struct Summary<'a> {
    schema: &'static str,
    schema_version: u32,
    program_version: &'static str,
    settings: &'a Settings,
    depths_m: &'a [f64],
    laterals_m: &'a [f64],
    findings: &'a Findings,
}

/// The findings as JSON, with every unit in its key; ends in a line feed.
///
/// Implements: REP-050, REP-005.
pub fn summary_json(findings: &Findings, run: &Run) -> String {
    let summary = Summary {
        schema: "palpate-summary",
        schema_version: 2,
        program_version: VERSION,
        settings: &run.settings,
        depths_m: run.reference.table().depths(),
        laterals_m: run.reference.table().laterals(),
        findings,
    };
    // Only a map with keys other than strings, or a failing writer, could fail here; there is neither.
    let mut text = serde_json::to_string_pretty(&summary)
        .expect("plain structures of numbers and strings are always JSON");
    text.push('\n');
    text
}
