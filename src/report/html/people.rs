//! The section on the paper's subjects.

use super::Page;
use super::table::{Group, Table};
use crate::report::text::{fixed, percent};
use crate::report::{Findings, PairwiseFinding, Topic};

/// Table 1, the figures made from it, and the model against it.
///
/// Implements: REP-062.
pub fn people(page: &Page<'_>) -> String {
    page.figures(Topic::People) + &pairs(page.findings)
}

fn pairs(findings: &Findings) -> String {
    let Some(calibration) = findings.calibration else {
        return String::new();
    };
    let row = |pair: &PairwiseFinding| {
        let tag = if pair.is_calibration {
            " <span class=\"tag\">calibration</span>"
        } else {
            ""
        };
        let mut row = vec![
            format!("{} mm", pair.phantom),
            fixed(pair.peak_signal, 3),
            fixed(pair.gamma, 2),
            format!("{}{tag}", percent(pair.predicted)),
        ];
        row.extend(pair.observed.map(|observed| {
            format!(
                "{} ({} of {})",
                percent(observed.share()),
                observed.correct,
                observed.trials
            )
        }));
        row
    };
    let rows: Vec<_> = findings.pairwise.iter().map(row).collect();
    let number = |name| (name, "number");
    let head = [
        ("Inclusion", ""),
        number("Peak signal (N)"),
        number("γ = peak/noise"),
        number("Predicted Φ(γ/√2)"),
        number("Direct contact"),
        number("FEM data"),
        number("Measured data"),
    ];
    let caption = format!(
        "Right answers in pairs: predicted with one noise level, {} N, fitted to the FEM playback at 6.6 mm (that row \
         is a calibration and proves nothing), and counted in the paper's Table 1, ten subjects pooled. The subjects \
         differ more than chance allows, so pooled shares are less certain than 300 trials suggest.",
        fixed(calibration.noise, 3)
    );
    let table = Table {
        id: "table-pairs",
        caption: &caption,
        stacks: false,
        head: &head,
        groups: Group::plain(rows),
    };
    format!("<h3>Pairs</h3>\n{}", table.markup())
}
