//! The trace as the committed table `spec/traceability.csv`.

use std::collections::BTreeSet;

use crate::trace::Trace;

pub const PATH: &str = "spec/traceability.csv";

const HEADER: &str = "requirement,chapter,text,code,tests,proofs,vectors,inspection\n";

/// The whole file, a line a requirement in the order of their ids. What is many in a cell is separated by `; `.
///
/// Implements: EVD-030.
pub fn csv(trace: &Trace) -> String {
    let mut table = String::from(HEADER);
    for requirement in &trace.requirements {
        let row = &trace.rows[&requirement.id];
        let cells = [
            requirement.id.clone(),
            requirement.chapter.clone(),
            requirement.text.clone(),
            joined(&row.code),
            joined(&row.tests),
            joined(&row.proofs),
            joined(&row.vectors),
            requirement.inspection.clone().unwrap_or_default(),
        ];
        let cells: Vec<String> = cells.iter().map(|cell| quoted(cell)).collect();
        table.push_str(&cells.join(","));
        table.push('\n');
    }
    table
}

fn joined(names: &BTreeSet<String>) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    names.join("; ")
}

/// A cell as RFC 4180 has it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.into()
    }
}

/// The first lines in which the committed table differs from that of the sources.
pub fn differences(committed: &str, current: &str) -> Vec<String> {
    let (committed, current): (BTreeSet<&str>, BTreeSet<&str>) =
        (committed.lines().collect(), current.lines().collect());
    let gone = committed
        .difference(&current)
        .map(|line| format!("- {line}"));
    let new = current
        .difference(&committed)
        .map(|line| format!("+ {line}"));
    gone.chain(new).take(10).collect()
}
