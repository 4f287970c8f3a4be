//! γ of a sweep beside what may be unknown of it.

use super::people::DEPTH;
use super::plan::{Plan, Words, over};
use crate::report::inputs;
use crate::report::text::{extremes, fixed, joined, millimetres, percent, trimmed};
use crate::report::{Findings, GammaBeside, MapFindings, Run, Topic};
use crate::study::{Band, Kind};
use palpate::chart::style::{GREY, INK, PALETTE};
use palpate::chart::{Line, Panel, round_range};
use palpate::force_map::ForceMap;

/// The figure, if the top of an inclusion is known.
///
/// Implements: REP-030.
pub fn figure(run: &Run, found: &Findings) -> Option<Plan> {
    let maps = found.maps.iter();
    let maps = maps.filter_map(|map| Some((1e3 * map.inclusion_depth_m?, map)));
    let mut maps: Vec<_> = maps.collect();
    maps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let beside = &maps.first()?.1.gamma_left.beside;
    let pairs = run.maps.iter().zip(&found.maps);
    let bars = pairs.filter_map(|(map, found)| bar(run, map, 1e3 * found.inclusion_depth_m?));
    let mut bars: Vec<_> = bars.collect();
    if let Some(first) = bars.first_mut() {
        *first = first.clone().named("95 % of the draws");
    }
    let words = words(run, found, &maps, !bars.is_empty());
    let panel = panel(&maps, beside, found.required_gamma, bars);
    let picture = over(DEPTH, [panel]);
    Some(Plan::new("gamma", Topic::Detection, words, picture))
}

/// The band of γ that a study has for a map, upright beside its depth, mm.
///
/// Implements: REP-081.
fn bar(run: &Run, map: &ForceMap, depth: f64) -> Option<Line> {
    let Band { lower, upper, .. } = inputs::band(run, map, &Kind::Gamma)?;
    let x = depth + 0.15;
    let ends = vec![(x, lower.value), (x, upper.value)];
    Some(Line::new(INK, ends).wide(3.0))
}

/// The maps with the depth of their inclusion, mm.
type Maps<'a> = [(f64, &'a MapFindings)];

/// A line for each list of what is unknown, which is that of every map; those that run close to another in dashes; and `bars`.
fn panel(maps: &Maps<'_>, beside: &[GammaBeside], needed: f64, bars: Vec<Line>) -> Panel {
    let left = |(k, of): (usize, &GammaBeside)| {
        let gammas = maps.iter().filter_map(|(depth, map)| {
            let of = map.gamma_left.beside.get(k)?;
            Some((*depth, of.gamma))
        });
        // All of the line before, and one more.
        let name = of.words().replace("offset, drift, gain, ", "these and ");
        (name, gammas.collect())
    };
    let left = beside.iter().enumerate().map(left);
    let mut panel = gammas("γ if this is unknown", needed, left, |k| {
        [3, 4].contains(&k)
    });
    panel.lines.extend(bars);
    let values = panel.lines.iter().flat_map(|line| &line.points);
    panel.y = round_range(values.map(|point| point.1));
    panel.ticks = maps.iter().map(|of| of.0).collect();
    // No number on the one before.
    let [from, to] = panel.x;
    (panel.ticks).dedup_by(|next, tick| *next - *tick < 0.12 * (to - from));
    panel
}

/// A line with its name through what is left of γ at each x, over one at the γ that is needed.
pub fn gammas(
    heading: &str,
    needed: f64,
    left: impl Iterator<Item = (String, Vec<(f64, f64)>)>,
    is_dashed: impl Fn(usize) -> bool,
) -> Panel {
    let colours = [INK].into_iter().chain(PALETTE);
    let line = |(k, ((name, gammas), colour))| {
        let line = Line::new(colour, gammas).named(name);
        line.dotted(4).dashed(is_dashed(k))
    };
    let mut lines: Vec<_> = left.zip(colours).enumerate().map(line).collect();
    let points = || lines.iter().flat_map(|line| &line.points);
    let [least, greatest] = extremes(points().map(|point| point.0)).unwrap_or_default();
    let y = round_range(points().map(|point| point.1).chain([needed]));
    let x = [least - 0.8, greatest + 0.8];
    let needed = x.map(|end| (end, needed)).into();
    lines.insert(0, Line::new(GREY, needed).dashed(true).named("needed"));
    Panel::new(heading, [x, y], 330, lines)
}

fn words(run: &Run, found: &Findings, maps: &Maps<'_>, has_bars: bool) -> Words {
    // The part of γ that the defaults of `palpate detect --model exact` leave.
    let felt = maps.iter().filter(|(_, map)| map.gamma.both > 0.0);
    let left = extremes(felt.map(|(_, map)| map.gamma_left.by_default.both / map.gamma.both));
    let left = left.map(|ends| {
        let [least, most] = ends.map(percent);
        let range = if least == most { most } else { format!("{least} to {most}") };
        format!(": with offset, drift and gain unknown, the defaults of palpate detect --model exact, {range} of it is left")
    });
    let left = left.unwrap_or_default();
    let bars = " Upright bars hold γ with all but the noise known in 95 % of the draws of the uncertain inputs.";
    let bars = if has_bars { bars } else { "" };
    let first = maps.iter().take(1);
    let beside = first.flat_map(|(_, map)| &map.gamma_left.beside);
    let gammas = maps.iter().map(|(depth, map)| {
        let gammas = map.gamma_left.beside.iter().map(|of| fixed(of.gamma, 2));
        format!("{} at {} mm", joined(gammas, ", "), trimmed(*depth, 6))
    });
    [
        format!(
            "Signal-to-noise ratio γ of a sweep at depth {} mm, by what is unknown",
            millimetres(found.probe_depth_m)
        ),
        format!(
            "What is unknown takes from γ the part of the signal that looks like it{left}. The paper has no such figure: its detector \
             knows everything but the noise (“nothing”). Noise of {} N in every sample; the table above has the numbers.{bars}",
            trimmed(run.settings.noise_sd_n, 6)
        ),
        format!(
            "Line chart of γ against the depth of the inclusion, one line for each of these to be unknown: {}. From the shallowest to \
             the deepest: {}. A dashed line at {} is what both error rates need.",
            joined(beside.map(GammaBeside::words), "; "),
            joined(gammas, "; "),
            fixed(found.required_gamma, 2)
        ),
    ]
}
