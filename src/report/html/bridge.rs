//! The forces against the answers: which part of the force explains what the subjects felt.

use super::Page;
use super::people::p_value;
use super::table::{Group, Layout, Table};
use crate::psychophysics::bridge::{Bridge, ConditionBridge, ConventionFit};
use crate::report::convention_name;
use crate::report::text::{escape, fixed, prose, trimmed};

/// The verdict for each experiment, and every convention with its fit.
///
/// Implements: REP-062, REP-074.
pub fn bridge(page: &Page<'_>) -> String {
    let Some(bridge) = &page.findings.bridge else {
        return "<p class=\"note\">The forces are not set against the answers: that takes two or more of the paper's \
                phantoms with inclusion, and its reference, at a probe depth of 4 mm.</p>\n"
            .into();
    };
    let verdict = |condition: &ConditionBridge| {
        format!(
            "<p><strong>{}.</strong> {}</p>\n",
            escape(&condition.name),
            prose(&condition.verdict.text)
        )
    };
    let verdicts: String = bridge.conditions.iter().map(verdict).collect();
    format!(
        "<h3>From forces to answers</h3>\n\
         <p>The paper could not predict its rates from its forces. Here each convention says what of the force a subject \
         uses: the largest difference at one position or the whole sweep, the normal force, the lateral or both, with its \
         mean over the sweep or without. That gives a signal for each inclusion, and a noise level gives the rate \
         Φ(γ/√2).</p>\n{verdicts}{}",
        conventions(bridge)
    )
}

/// The better of the fits by subject, on which the verdict rests.
fn fit_p(fit: &ConventionFit) -> f64 {
    fit.by_subject
        .p_value
        .max(fit.by_subject_with_lapse.p_value)
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
    let mut head = vec![
        ("Convention".to_string(), ""),
        ("Signals (N)".into(), "number"),
    ];
    for name in &names {
        head.push((format!("{name}: noise (N)"), "number"));
        head.push((format!("{name}: p"), "number"));
    }
    let head: Vec<_> = head
        .iter()
        .map(|(name, kind)| (name.as_str(), *kind))
        .collect();
    let row = |(k, fit): (usize, &ConventionFit)| {
        let signals: Vec<_> = fit
            .signals
            .iter()
            .map(|signal| trimmed(*signal, 3))
            .collect();
        let mut row = vec![convention_name(fit), signals.join(", ")];
        for condition in &bridge.conditions {
            let Some(fit) = condition.conventions.get(k) else {
                continue;
            };
            row.push(
                fit.common
                    .as_ref()
                    .map_or("–".into(), |common| fixed(common.noise, 3)),
            );
            let p = p_value(fit_p(fit));
            row.push(match fit.is_rejected {
                true => format!("{p} <span class=\"tag\">rejected</span>"),
                false => p,
            });
        }
        row
    };
    let inclusions: Vec<_> = bridge
        .inclusions
        .iter()
        .map(|of| escape(&of.name))
        .collect();
    let caption = format!(
        "What of the force is felt, against Table 1. Signals at {} mm. Noise: one level for all subjects that makes \
         the counts most likely. p: how likely answers at least as far from the fit are, if the fit is true and each \
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
