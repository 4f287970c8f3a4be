//! The section on the detector.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::report::text::{escape, percent, scientific, trimmed};
use crate::report::{Findings, MapFindings, Study, Threshold, Topic};

/// Thresholds and error rates of every map, and the detector's curves.
///
/// Implements: REP-041.
pub fn detection(page: &Page<'_>) -> String {
    let mut markup = String::new();
    if !page.findings.maps.is_empty() {
        markup += &threshold_table(page.study, page.findings);
    }
    markup += &page.figures(Topic::Detection);
    markup
}

fn threshold_table(study: &Study, findings: &Findings) -> String {
    let cells = |threshold: Option<Threshold>| match threshold {
        Some(t) => [trimmed(t.eta, 2), rate(t.false_alarm), rate(t.miss)],
        None => ["none", "–", "–"].map(String::from),
    };
    let row = |map: &MapFindings| {
        let mut row = vec![escape(&map.name)];
        row.extend(cells(Some(map.map_rule)));
        row.extend(cells(Some(map.bounded_miss)));
        row.extend(cells(map.bounded_false_alarm));
        row.extend([map.auc, map.two_afc].map(|share| escape(&percent(share))));
        row
    };
    let rows: Vec<_> = findings.maps.iter().map(row).collect();
    let caption = format!(
        "Thresholds η on Θ, with the false-alarm rate P<sub>fa</sub> and the miss rate P<sub>miss</sub> that follow: maximum a posteriori \
         (MAP), and Neyman–Pearson (NP) with at most {} misses or at most {} false alarms. AUC is the area under the \
         curve of hits against false alarms, and equals the rate of right answers in pairs (2AFC).",
        limit(study.settings.max_miss),
        limit(study.settings.max_false_alarm)
    );
    let number = |name| (name, "number");
    let head = [
        ("Phantom", ""),
        number("MAP: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("NP, misses bounded: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("NP, false alarms bounded: η"),
        number("P<sub>fa</sub>"),
        number("P<sub>miss</sub>"),
        number("AUC"),
        number("2AFC"),
    ];
    Table {
        id: "table-thresholds",
        caption: &caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(rows),
    }
    .markup()
}

/// A rate that was asked for, in per cent.
pub fn limit(rate: f64) -> String {
    format!("{} %", trimmed(100.0 * rate, 6))
}

/// An error rate: small ones by their power of ten.
fn rate(probability: f64) -> String {
    if probability > 0.0 && probability < 1e-3 {
        scientific(probability)
    } else {
        escape(&percent(probability))
    }
}
