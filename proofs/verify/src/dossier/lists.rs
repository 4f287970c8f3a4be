//! The long lists: components of other makers, and the trace of every requirement.

use super::results::breakable;
use crate::evidence::Evidence;
use crate::supply::Component;
use crate::traceability::{Requirement, Summary, summary};
use palpate::report::html::table::{Group, Layout, Table};
use palpate::report::text::escape;

/// Software of unknown provenance, as IEC 62304 calls it.
///
/// Implements: EVD-006.
pub fn components(evidence: &Evidence) -> String {
    let row = |component: &Component| {
        vec![
            escape(component.name),
            escape(&component.version),
            escape(component.licence),
            escape(component.layer),
            escape(component.why),
        ]
    };
    let table = Table {
        id: "components-table",
        caption: "Crates in the shipped program; version, checksum and dependencies are the lock file's, and stand in evidence.json",
        layout: Layout::Stack,
        head: &[
            ("Component", ""),
            ("Version", ""),
            ("Licence", ""),
            ("Layer", ""),
            ("Why", "claim"),
        ],
        groups: Group::plain(evidence.components.iter().map(row).collect()),
    };
    table.markup()
}

/// Each requirement with its code, tests, proofs and vectors.
///
/// Implements: EVD-006.
pub fn trace(evidence: &Evidence) -> String {
    let Summary {
        requirements,
        code,
        tests,
        proofs,
        vectors,
        inspection,
    } = summary(&evidence.requirements);
    let mut groups: Vec<Group> = Vec::new();
    for requirement in &evidence.requirements {
        if groups
            .last()
            .is_none_or(|group| group.heading != escape(&requirement.chapter))
        {
            groups.push(Group {
                heading: escape(&requirement.chapter),
                rows: Vec::new(),
            });
        }
        if let Some(group) = groups.last_mut() {
            group.rows.push(row(requirement));
        }
    }
    let table = Table {
        id: "trace-table",
        caption: "Found in the annotations of the sources, and compared with them in each test run",
        layout: Layout::Stack,
        head: &[
            ("Requirement", ""),
            ("Sentence", "sentence"),
            ("Code", "places"),
            ("Tests", "places"),
            ("Proofs and vectors", "places"),
        ],
        groups,
    };
    format!(
        "<p>{requirements} requirements: {code} with code, {tests} with tests, {proofs} with proofs, {vectors} with vectors, {inspection} \
         by inspection.</p>\n{}",
        table.markup()
    )
}

fn row(requirement: &Requirement) -> Vec<String> {
    let places = |places: &[String]| {
        let places: Vec<String> = places.iter().map(|place| breakable(place)).collect();
        places.join("<br>")
    };
    let inspection = requirement
        .inspection
        .as_deref()
        .map(|reason| format!("<em>Inspection: {}</em>", escape(reason)));
    let mut shown = requirement.proofs.clone();
    shown.extend_from_slice(&requirement.vectors);
    vec![
        escape(&requirement.id),
        escape(&requirement.text),
        places(&requirement.code),
        places(&requirement.tests) + &inspection.unwrap_or_default(),
        places(&shown),
    ]
}
