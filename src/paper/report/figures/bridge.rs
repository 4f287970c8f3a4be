//! The bridge: rates predicted from the forces, against the subjects' answers to FEM playback.

use askama::Template;

use super::people::{DEPTH, SHARE, bar, points, share_panel};
use super::{Figures, words};
use crate::psychophysics::bridge::{
    Bridge, Channel, ConditionBridge, ConventionFit, Offset, Statistic,
};
use crate::report::{Findings, Topic, paper, text};
use palpate::chart::Line;
use palpate::chart::chart;
use palpate::chart::style::{INK, PALETTE};
use palpate::refusal::Refusal;

/// The figure, if the run holds the maps for it.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-030.
pub fn draw(figures: &mut Figures, found: &Findings) -> Result<(), Refusal> {
    let bridge = found.bridge.as_ref();
    let played = bridge.and_then(|bridge| bridge.conditions.get(paper::FEM_PLAYBACK));
    let counted = found.people.conditions.get(paper::FEM_PLAYBACK);
    let (Some(bridge), Some(condition), Some(counted)) = (bridge, played, counted) else {
        return Ok(());
    };
    let depths = bridge.inclusions.iter().filter_map(|of| {
        let mut known = counted.inclusions.iter();
        Some(1e3 * known.find(|known| known.name == of.name)?.depth_m)
    });
    let depths: Vec<_> = depths.collect();
    let panel = |offset, words| {
        let lines = lines(condition, &depths, offset);
        share_panel(&format!("{SHARE}, {words}"), &depths, 270, lines)
    };
    let mut panels = [
        panel(Offset::Kept, "with the mean of the force"),
        panel(Offset::Removed, "without its mean over the sweep"),
    ];
    let sample = |colour, name| Line::new(colour, Vec::new()).named(name);
    panels[0].key = vec![
        sample(INK, "answers, 95 % by subject").wide(6.0).dotted(5),
        sample(PALETTE[0], "not rejected"),
        sample(PALETTE[0], "rejected").dashed(true),
    ];
    let text = Text { bridge, condition };
    let drawn = chart(&panels, DEPTH);
    figures.add(
        ("bridge", ""),
        Topic::People,
        words!(text, as_bridge_caption, as_bridge_alt),
        drawn,
    )
}

/// Predictions of the conventions with one treatment of the mean, and what was observed.
fn lines(condition: &ConditionBridge, depths: &[f64], offset: Offset) -> Vec<Line> {
    let fits = condition.conventions.iter();
    let fits = fits.filter(|fit| fit.convention.offset == offset);
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

#[derive(Template)]
#[template(path = "report/words.txt", block = "bridge_title", blocks = ["bridge_caption", "bridge_alt"])]
struct Text<'a> {
    bridge: &'a Bridge,
    condition: &'a ConditionBridge,
}
