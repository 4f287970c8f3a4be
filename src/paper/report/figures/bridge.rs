//! The bridge: rates predicted from the forces, against the subjects' answers to FEM playback.

use super::people::{DEPTH, SHARE, bar, points, share_panel};
use super::plan::{Plan, Words, over};
use crate::psychophysics::bridge::{Channel, ConditionBridge, ConventionFit, Mean, Statistic};
use crate::report::text::millimetres;
use crate::report::{Findings, Topic, paper};
use palpate::chart::Line;
use palpate::chart::style::{INK, PALETTE};

/// The figure, if the run holds the maps for it.
///
/// Implements: REP-030.
pub fn figure(found: &Findings) -> Option<Plan> {
    let bridge = found.bridge.as_ref()?;
    let condition = bridge.conditions.get(paper::FEM_PLAYBACK)?;
    let counted = &found.people.conditions.get(paper::FEM_PLAYBACK)?.inclusions;
    let depths = bridge.inclusions.iter().filter_map(|of| {
        let known = counted.iter().find(|known| known.name == of.name)?;
        Some(1e3 * known.depth_m)
    });
    let depths: Vec<_> = depths.collect();
    let panel = |mean, words| {
        let lines = lines(condition, &depths, mean);
        share_panel(&format!("{SHARE}, {words}"), &depths, 270, lines)
    };
    let mut panels = [
        panel(Mean::Kept, "with the mean of the force"),
        panel(Mean::Removed, "without its mean over the sweep"),
    ];
    let sample = |colour, name| Line::new(colour, Vec::new()).named(name);
    panels[0].key = vec![
        sample(INK, "answers, 95 % by subject").wide(6.0).dotted(5),
        sample(INK, "rejected").dashed(true),
    ];
    let words = words(condition, bridge.probe_depth_m);
    Some(Plan::new(
        "bridge",
        Topic::People,
        words,
        over(DEPTH, panels),
    ))
}

fn words(condition: &ConditionBridge, probe_depth: f64) -> Words {
    let compatible = match &condition.verdict.compatible[..] {
        [] => "none".into(),
        names => names.join("; "),
    };
    [
        "Rates predicted from the forces, and the answers to FEM playback".into(),
        format!(
            "The paper has no such figure: it computed forces and counted answers, but did not predict the one from the other. Each \
             line takes one part of the force at probe depth {} mm as what the subjects used, with a noise level for each of them (and \
             one share of lapses, where that fits better); the dots are the answers of Table 1. Lines that are rejected over this sweep \
             are dashed; where lines lie on one another, the answers cannot tell them apart. The table below has the numbers, for the \
             other experiments too.",
            millimetres(probe_depth)
        ),
        format!(
            "Two line charts of predicted right answers against the depth of the inclusion, one line for each convention, with the \
             observed shares as dots. Not rejected: {compatible}."
        ),
    ]
}

/// Predictions of the conventions with one treatment of the mean, and what was observed.
fn lines(condition: &ConditionBridge, depths: &[f64], mean: Mean) -> Vec<Line> {
    let fits = condition.conventions.iter();
    let fits = fits.filter(|fit| fit.convention.mean == mean);
    let line = |(fit, colour): (&ConventionFit, _)| {
        let predicted = &fit.better_by_subject().predicted;
        let line = Line::new(colour, points(depths, predicted.iter().copied()));
        line.dashed(fit.is_rejected).named(short_name(fit))
    };
    let mut lines: Vec<_> = fits.zip(PALETTE).map(line).collect();
    for (observed, &depth) in condition.observed.iter().zip(depths) {
        let bounds = observed.clustered_bounds;
        lines.extend(bounds.map(|bounds| bar(depth, bounds, INK, 6.0)));
        let dot = Line::new(INK, vec![(depth, 100.0 * observed.rate)]);
        lines.push(dot.wide(0.0).dotted(5));
    }
    lines
}

/// What the heading of the panel does not say: "peak, normal".
fn short_name(fit: &ConventionFit) -> String {
    let statistic = match fit.convention.statistic {
        Statistic::Peak => "peak",
        Statistic::MatchedFilter => "filter",
    };
    let channel = match fit.convention.channel {
        Channel::Normal => "normal",
        Channel::Lateral => "lateral",
        Channel::Both => "both",
    };
    format!("{statistic}, {channel}")
}
