//! `summary.json`: the findings for programs.

use serde::Serialize;

use super::{Findings, Settings, Study};

/// The value of the key `schema`.
pub const SUMMARY_SCHEMA: &str = "palpate-summary";
/// The value of the key `schema_version`.
pub const SUMMARY_SCHEMA_VERSION: u32 = 2;

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
/// Implements: REP-050, REP-051, REP-005.
pub fn summary_json(findings: &Findings, study: &Study) -> String {
    let summary = Summary {
        schema: SUMMARY_SCHEMA,
        schema_version: SUMMARY_SCHEMA_VERSION,
        program_version: env!("CARGO_PKG_VERSION"),
        settings: &study.settings,
        depths_m: study.reference.depths(),
        laterals_m: study.reference.laterals(),
        findings,
    };
    // Only a map with keys other than strings, or a failing writer, could fail here; there is neither.
    let mut text = serde_json::to_string_pretty(&summary)
        .expect("plain structures of numbers and strings are always JSON");
    text.push('\n');
    text
}
