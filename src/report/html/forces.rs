//! The section on forces and signals.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::report::text::{escape, fixed, millimetres, prose, trimmed};
use crate::report::{Findings, MapFindings, Peak, Topic};

/// Signals of every map, the force curves, and measured ones or why there are none.
///
/// Implements: REP-036, REP-041.
pub fn forces(page: &Page<'_>) -> String {
    let findings = page.findings;
    let mut markup = String::new();
    if findings.maps.is_empty() {
        markup += "<p>The study holds no map beside the reference, so there is no signal.</p>\n";
    } else {
        for map in &findings.maps {
            for warning in &map.warnings {
                markup += &format!(
                    "<p class=\"warning\"><strong>Phantom {}.</strong> {}</p>\n",
                    escape(&map.name),
                    prose(warning)
                );
            }
        }
        markup += &signal_table(findings);
        markup += &format!(
            "<p class=\"soft\">γ takes all {} samples of the sweep in each channel as independent readings, so it \
             grows with their number (as its square root for even finer steps). It is not the γ of the paper's subjects, \
             which rests on one peak; that is under “People”.</p>\n",
            findings.samples
        );
    }
    markup += &page.figures(Topic::Forces);
    if page.study.measured.is_empty() {
        markup += NOTHING_MEASURED;
    }
    markup
}

/// Why there is no Figure 7.
const NOTHING_MEASURED: &str = "<p class=\"note\"><strong>Figure 7 is not made again.</strong> It shows forces that the \
paper's authors measured on their gel, and those data are not available; nothing on this page stands in for them. A map that \
you measured yourself is shown as Figure 7 if the run's configuration names it: <code>palpate import-map gel.csv --out \
gel.json</code>, then <code>measured = [\"gel.json\"]</code>.</p>\n";

fn peak_cell(peak: Peak) -> String {
    format!(
        "{} at {}",
        fixed(peak.force, 3),
        trimmed(peak.lateral * 1e3, 3)
    )
}

fn signal_table(findings: &Findings) -> String {
    let row = |map: &MapFindings| {
        let depth = map.inclusion_depth.map_or("none".into(), millimetres);
        let enough = if map.gamma.both >= findings.required_gamma {
            "yes"
        } else {
            "no"
        };
        vec![
            escape(&map.name),
            depth,
            peak_cell(map.peak_normal),
            peak_cell(map.peak_lateral),
            fixed(map.gamma.both, 2),
            fixed(map.gamma.normal, 2),
            fixed(map.gamma.lateral, 2),
            enough.into(),
        ]
    };
    let rows: Vec<_> = findings.maps.iter().map(row).collect();
    let caption = format!(
        "Signal F₁ − F₀ at probe depth {} mm, and the signal-to-noise ratio γ of the matched filter over the whole \
         sweep. Needed for both error rates: γ ≥ {}.",
        millimetres(findings.probe_depth),
        fixed(findings.required_gamma, 2)
    );
    let head = [
        ("Phantom", ""),
        ("Inclusion depth (mm)", "number"),
        ("Peak normal (N at mm)", "number"),
        ("Peak lateral (N at mm)", "number"),
        ("γ", "number"),
        ("γ, normal alone", "number"),
        ("γ, lateral alone", "number"),
        ("Rates met", "number"),
    ];
    Table {
        id: "table-signals",
        caption: &caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(rows),
    }
    .markup()
}
