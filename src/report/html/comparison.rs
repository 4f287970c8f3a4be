//! The section "paper | here | why".

use super::Page;
use super::table::{Group, Layout, Table};
use crate::report::Comparison;
use crate::report::text::{escape, prose};

/// Each number that the paper prints, ours, and the reason for the difference.
///
/// Implements: REP-041.
pub fn comparison(page: &Page<'_>) -> String {
    let row = |row: &Comparison| {
        vec![
            format!(
                "{} <span class=\"soft\">({})</span>",
                prose(&row.quantity),
                escape(row.place)
            ),
            prose(&row.paper_text),
            prose(&row.here.text()),
            prose(&row.why),
        ]
    };
    let rows: Vec<_> = page.findings.comparison.iter().map(row).collect();
    let head = [
        ("Quantity", "quantity"),
        ("Paper", "number"),
        ("Here", "number"),
        ("Why", "why"),
    ];
    let caption = "Each number that the paper prints and this run covers; rows whose phantom or depth is not in \
                   the run are left out.";
    let table = Table {
        id: "table-paper",
        caption,
        layout: Layout::Stack,
        head: &head,
        groups: Group::plain(rows),
    };
    table.markup()
}
