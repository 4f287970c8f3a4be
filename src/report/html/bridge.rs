//! The forces against the answers: which part of the force explains what the subjects felt.

use super::Page;
use super::table::{Group, Layout, Table};
use crate::psychophysics::bridge::{
    Bridge, ConditionBridge, ConventionFit, WeightFit, WeightRange,
};
use crate::report::text::{escape, fixed, millimetres, p_value, prose, trimmed};

/// The verdict for each experiment, every convention with its fit, and the weights of the level.
///
/// Implements: REP-062.
pub fn bridge(page: &Page<'_>) -> String {
    let Some(bridge) = &page.findings.bridge else {
        return "<p class=\"note\">The forces are not set against the answers: that takes two or more of the paper's \
                phantoms with inclusion, and its reference, at a probe depth of 4 mm.</p>\n"
            .into();
    };
    let verdict = |condition: &ConditionBridge| {
        let survives = condition.verdict.survives.iter();
        let survives = survives.map(|text| format!("<p>{}</p>\n", prose(text)));
        format!(
            "<p><strong class=\"name\">{}.</strong> {}</p>\n{}",
            escape(&condition.name),
            prose(&condition.verdict.text),
            survives.collect::<String>()
        )
    };
    let verdicts: String = bridge.conditions.iter().map(verdict).collect();
    format!(
        "<h3>From forces to answers</h3>\n\
         <p>The paper did not predict its rates from its forces. Here each convention says what of the force a subject \
         uses: the largest difference at one position or the whole sweep, the normal force, the lateral or both, with its \
         mean over the sweep or without. That gives a signal for each inclusion, and a noise level gives the rate \
         Φ(γ/√2). The forces are the computed ones at probe depth {} mm. Only the subjects of FEM playback felt such forces; \
         in direct contact and in the playback of measured data they stand in for forces that are not available.</p>\n{verdicts}{}{}",
        millimetres(bridge.probe_depth),
        conventions(bridge),
        weights(bridge)
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

/// The weights that the level may have, over each sweep.
fn weights(bridge: &Bridge) -> String {
    let first = bridge.conditions.first();
    let Some(first) = first.filter(|of| !of.weights.is_empty()) else {
        return String::new();
    };
    let names = bridge.conditions.iter().map(|of| escape(&of.name));
    let names: Vec<_> = names.collect();
    let mut head = vec![("Sweep (mm)", "number"), ("Statistic", "quantity")];
    head.extend(names.iter().map(|name| (name.as_str(), "number group")));
    let deviance = |fit: Option<WeightFit>| fit.map_or("none".into(), |fit| fixed(fit.deviance, 1));
    let cell = |range: &WeightRange| {
        format!(
            "{} to {}<br>{}, {}, {}",
            fixed(range.left.lower, 2),
            fixed(range.left.upper, 2),
            deviance(range.whole_level),
            deviance(range.no_level),
            deviance(range.lateral)
        )
    };
    let row = |(k, range): (usize, &WeightRange)| {
        let sweep = format!("±{}", millimetres(range.half_sweep));
        let mut row = vec![sweep, range.statistic.text().into()];
        let of_condition = |condition: &ConditionBridge| condition.weights.get(k).map(cell);
        row.extend(bridge.conditions.iter().filter_map(of_condition));
        row
    };
    let caption = format!(
        "How much of the level of the normal force may count: the weights of its mean over the sweep that are not rejected at {}, \
         divided by the {} ranges of the table, with the dispersion within subjects. Below them the deviances of the whole level, of the force less its mean and of the \
         lateral force: the largest fits worst.",
        trimmed(bridge.level, 4),
        bridge.weight_ranges
    );
    let table = Table {
        id: "table-weights",
        caption: &caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(first.weights.iter().enumerate().map(row).collect()),
    };
    table.markup()
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
         subject has a noise level (and all one share of lapses, if that fits better); below {} the convention is rejected over this sweep, by itself and with the answers of a subject taken as binomial.",
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
