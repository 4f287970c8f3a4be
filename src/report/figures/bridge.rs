//! The bridge: rates predicted from the forces, against the subjects' answers to FEM playback.

use askama::Template;

use super::chart::Line;
use super::people::{DEPTH, SHARE, bar, points, share_panel};
use super::style::{INK, PALETTE};
use super::{Draft, Words};
use crate::psychophysics::bridge::{
    Bridge, Channel, ConditionBridge, ConventionFit, Offset, Statistic,
};
use crate::report::{Findings, Topic, paper, text};

/// The figure, if the study holds the maps for it.
///
/// Implements: REP-039.
pub fn draft(found: &Findings) -> Option<Draft> {
    let bridge = found.bridge.as_ref()?;
    let condition = bridge.conditions.get(paper::FEM_PLAYBACK)?;
    let depths: Vec<_> = bridge
        .inclusions
        .iter()
        .filter_map(|of| {
            let inclusions = &found.people.conditions.get(paper::FEM_PLAYBACK)?.inclusions;
            let known = inclusions.iter().find(|known| known.name == of.name)?;
            Some(1e3 * known.depth)
        })
        .collect();
    let panels = [
        (Offset::Kept, "with the mean of the force"),
        (Offset::Removed, "without its mean over the sweep"),
    ]
    .map(|(offset, words)| {
        let heading = format!("{SHARE}, {words}");
        let mut panel = share_panel(&heading, &depths, 270, lines(condition, &depths, offset));
        if offset == Offset::Kept {
            panel.key = key();
        }
        panel
    });
    let text = Text { bridge, condition };
    let words = Words::of([&text.as_title(), &text.as_caption(), &text.as_alt()]);
    Some(Draft::chart("bridge", Topic::People, words, &panels, DEPTH))
}

fn key() -> Vec<Line> {
    vec![
        Line::new(INK, Vec::new())
            .wide(6.0)
            .dotted(5)
            .named("answers, 95 % by subject"),
        Line::new(PALETTE[0], Vec::new()).named("not rejected"),
        Line::new(PALETTE[0], Vec::new()).dashed().named("rejected"),
    ]
}

/// The fit by subject that explains the answers better.
fn predicted(fit: &ConventionFit) -> &[f64] {
    let (plain, lapse) = (&fit.by_subject, &fit.by_subject_with_lapse);
    if lapse.p_value > plain.p_value {
        &lapse.predicted
    } else {
        &plain.predicted
    }
}

/// Predictions of the conventions with one treatment of the mean, and what was observed.
fn lines(condition: &ConditionBridge, depths: &[f64], offset: Offset) -> Vec<Line> {
    let fits = condition
        .conventions
        .iter()
        .filter(|fit| fit.convention.offset == offset);
    let mut lines: Vec<_> = fits
        .zip(PALETTE)
        .map(|(fit, colour)| Line {
            is_dashed: fit.is_rejected,
            ..Line::new(colour, points(depths, predicted(fit).iter().copied()))
                .named(short_name(fit))
        })
        .collect();
    for (observed, &depth) in condition.observed.iter().zip(depths) {
        if let Some(bounds) = observed.clustered_bounds {
            lines.push(bar(depth, bounds, INK, 6.0));
        }
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

#[derive(Template)]
#[template(path = "report/words/bridge.txt", blocks = ["title", "caption", "alt"])]
struct Text<'a> {
    bridge: &'a Bridge,
    condition: &'a ConditionBridge,
}
