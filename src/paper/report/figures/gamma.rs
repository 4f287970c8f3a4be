//! γ of a sweep beside what may be unknown of it.

use askama::Template;

use super::people::DEPTH;
use super::{Figures, words};
use crate::report::inputs;
use crate::report::text::extremes;
use crate::report::{Findings, GammaBeside, MapFindings, Run, Settings, Topic, text};
use crate::study::{Band, Kind};
use palpate::chart::style::{GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Panel};
use palpate::chart::{chart, round_range};
use palpate::refusal::Refusal;

/// The figure, if the top of an inclusion is known.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-030.
pub fn draw(figures: &mut Figures, run: &Run, found: &Findings) -> Result<(), Refusal> {
    let maps = found.maps.iter();
    let maps = maps.filter_map(|map| Some((1e3 * map.inclusion_depth_m?, map)));
    let mut maps: Vec<_> = maps.collect();
    maps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, first)) = maps.first() else {
        return Ok(());
    };
    let beside = &first.gamma_left.beside;
    let bars = maps.iter().filter_map(|(depth, map)| bar(run, *depth, map));
    let bars: Vec<_> = bars.collect();
    let has_bands = !bars.is_empty();
    let panel = panel(&maps, beside, found.required_gamma, bars);
    let text = Text {
        maps: &maps,
        beside,
        found,
        settings: &run.settings,
        has_bands,
    };
    let drawn = chart(&[panel], DEPTH);
    figures.add(
        ("gamma", ""),
        Topic::Detection,
        words!(text, as_gamma_caption, as_gamma_alt),
        drawn,
    )
}

/// The band of γ that a study has for a map, upright beside its depth, mm.
///
/// Implements: REP-081.
fn bar(run: &Run, depth: f64, map: &MapFindings) -> Option<Line> {
    let Band { lower, upper, .. } = inputs::band(run, &map.name, &Kind::Gamma)?;
    let x = depth + 0.15;
    let ends = vec![(x, lower.value), (x, upper.value)];
    Some(Line::new(VERMILION, ends).wide(3.0))
}

/// The maps with the depth of their inclusion, mm.
type Maps<'a> = [(f64, &'a MapFindings)];

/// A line for each list of what is unknown, which is that of every map; those that run close to another in dashes; and `bars`.
fn panel(maps: &Maps<'_>, beside: &[GammaBeside], needed: f64, bars: Vec<Line>) -> Panel {
    let mut ticks: Vec<_> = maps.iter().map(|of| of.0).collect();
    let [least, greatest] = extremes(ticks.iter().copied()).unwrap_or_default();
    let x = [least - 0.8, greatest + 0.8];
    // No number on the one before.
    ticks.dedup_by(|next, tick| *next - *tick < 0.12 * (x[1] - x[0]));
    let needed = vec![(x[0], needed), (x[1], needed)];
    let mut lines = vec![Line::new(GREY, needed).dashed(true).named("needed")];
    let colours = [INK].into_iter().chain(PALETTE);
    for (k, (of, colour)) in beside.iter().zip(colours).enumerate() {
        let gammas = maps.iter().filter_map(|(depth, map)| {
            let of = map.gamma_left.beside.get(k)?;
            Some((*depth, of.gamma))
        });
        // All of the line before, and one more.
        let name = of.words().replace("offset, drift, gain, ", "these and ");
        let line = Line::new(colour, gammas.collect()).named(name);
        lines.push(line.dotted(4).dashed([3, 4].contains(&k)));
    }
    lines.extend(bars);
    let values = lines.iter().flat_map(|line| &line.points);
    let y = round_range(values.map(|point| point.1));
    Panel {
        ticks,
        ..Panel::new("γ if this is unknown", [x, y], 330, lines)
    }
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "gamma_title", blocks = ["gamma_caption", "gamma_alt"])]
struct Text<'a> {
    maps: &'a Maps<'a>,
    beside: &'a [GammaBeside],
    found: &'a Findings,
    settings: &'a Settings,
    has_bands: bool,
}

impl Text<'_> {
    /// The least and the largest share of γ that the defaults of `palpate detect` leave.
    fn left(&self) -> Option<[f64; 2]> {
        let maps = self.maps.iter().filter(|(_, map)| map.gamma.both > 0.0);
        extremes(maps.map(|(_, map)| map.gamma_left.by_default.both / map.gamma.both))
    }
}
