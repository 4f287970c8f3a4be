//! The forces against the answers: which part of the force explains what the subjects felt.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::psychophysics::bridge::{Bridge, ConditionBridge, ConventionFit};
use crate::report::text::{escape, fixed, millimetres, p_value, prose, trimmed};

/// The verdict for each experiment, and every convention with its fit.
///
/// Implements: REP-062.
pub fn bridge(page: &Page<'_>) -> String {
    let Some(bridge) = &page.findings.bridge else {
        return "<p class=\"note\">The forces are not set against the answers: that takes two or more of the paper's \
                phantoms with inclusion, and its reference, at a probe depth of 4 mm.</p>\n"
            .into();
    };
    let verdict = |condition: &ConditionBridge| {
        format!(
            "<p><strong class=\"name\">{}.</strong> {}</p>\n",
            escape(&condition.name),
            prose(&condition.verdict.text)
        )
    };
    let verdicts: String = bridge.conditions.iter().map(verdict).collect();
    format!(
        "<h3>From forces to answers</h3>\n\
         <p>The paper did not predict its rates from its forces. Here each convention says what of the force a subject \
         uses: the largest difference at one position or the whole sweep, the normal force, the lateral or both, with its \
         mean over the sweep or without. That gives a signal for each inclusion, and a noise level gives the rate \
         Φ(γ/√2). The forces are the computed ones at probe depth {} mm. Only the subjects of FEM playback felt such forces; \
         in direct contact and in the playback of measured data they stand in for forces that are not available.</p>\n{verdicts}{}",
        millimetres(bridge.probe_depth),
        conventions(bridge)
    )
}

/// Noise and p-value of one convention in one experiment.
fn fit_cell(fit: &ConventionFit) -> String {
    let noise = fit
        .common
        .as_ref()
        .map_or("no noise level".into(), |common| {
            format!("{}\u{a0}N", fixed(common.noise, 3))
        });
    let tag = if fit.is_rejected {
        "<span class=\"tag\">rejected</span> "
    } else {
        ""
    };
    format!("{noise}<br>{tag}p\u{a0}=\u{a0}{}", p_value(fit.p_value))
}

fn conventions(bridge: &Bridge) -> String {
    let Some(first) = bridge.conditions.first() else {
        return String::new();
    };
    let names: Vec<_> = bridge
        .conditions
        .iter()
        .map(|of| escape(&of.name))
        .collect();
    let mut head = vec![("Convention", "quantity"), ("Signals (N)", "number")];
    head.extend(names.iter().map(|name| (name.as_str(), "number group")));
    let row = |(k, fit): (usize, &ConventionFit)| {
        let signals = fit.signals.iter().map(|signal| fixed(*signal, 3));
        let mut row = vec![escape(&fit.name), signals.collect::<Vec<_>>().join(", ")];
        let of_condition = |condition: &ConditionBridge| condition.conventions.get(k).map(fit_cell);
        row.extend(bridge.conditions.iter().filter_map(of_condition));
        row
    };
    let inclusions: Vec<_> = bridge
        .inclusions
        .iter()
        .map(|of| escape(&of.name))
        .collect();
    let caption = format!(
        "What of the force is felt, against Table 1. Signals of the inclusions at {} mm. In each experiment: the one \
         noise level for all subjects that makes the counts most likely, and p, how likely answers at least as far from the fit are, if the fit is true and each \
         subject has a noise level (and all one share of lapses, if that fits better); below {} the convention is rejected.",
        inclusions.join(", "),
        trimmed(bridge.level, 4)
    );
    let table = Table {
        id: "table-bridge",
        caption: &caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(first.conventions.iter().enumerate().map(row).collect()),
    };
    table.markup()
}
