//! Figure 5 for every phantom, Figure 7 for measured maps, and the signals at one depth.

use askama::Template;

use super::{Figures, Words, band_ends, words};
use crate::report::maps::incomparable;
use crate::report::text::{millimetres, shortened};
use crate::report::{Findings, MapFindings, Run, Topic, paper, text};
use crate::study::Kind;
use palpate::chart::style::{PALETTE, ramp};
use palpate::chart::{Line, Panel};
use palpate::chart::{chart, round_range};
use palpate::force_map::{ForceMap, ForceTable, Matrix, Source};
use palpate::phantom::Inclusion;
use palpate::refusal::Refusal;

/// The signals, if there are any, and the forces of every map: computed ones, then the measured ones.
///
/// # Errors
/// If a map does not fit the reference.
///
/// Implements: REP-031.
pub fn draw(figures: &mut Figures, run: &Run, found: &Findings) -> Result<(), Refusal> {
    let mut add = |file: (&str, &str), words: Words<'_>, panels: &[Panel]| {
        let drawn = chart(panels, "Lateral position of the probe x (mm)");
        figures.add(file, Topic::Forces, words, drawn)
    };
    if !run.maps.is_empty() {
        let text = SignalText { found };
        add(
            ("signals", ""),
            words!(text, as_signals_caption, as_signals_alt),
            &signals(run, found)?,
        )?;
    }
    for map in [&run.reference].into_iter().chain(&run.maps) {
        let name = text::name_of_map(map);
        let bands = bands(run, map);
        let depth = run.study.as_ref().map(|study| study.plan.probe_depth);
        let depth = depth.filter(|_| !bands[0].is_empty());
        let text = ForceText { map, depth };
        add(
            ("figure-5", &name),
            words!(text, as_figure_5_caption, as_figure_5_alt),
            &force_curves(map.table(), bands),
        )?;
    }
    for map in &run.measured {
        let (text, name) = (MeasuredText { map }, text::name_of_map(map));
        add(
            ("figure-7", &name),
            words!(text, as_figure_7_caption, as_figure_7_alt),
            &force_curves(map.table(), Default::default()),
        )?;
    }
    Ok(())
}

/// Lateral positions of the plot's ends, mm. One position alone gets some room.
fn lateral_range(laterals: &[f64]) -> [f64; 2] {
    match laterals {
        [first, .., last] => [first * 1e3, last * 1e3],
        [only] => [only * 1e3 - 1.0, only * 1e3 + 1.0],
        [] => [-1.0, 1.0],
    }
}

fn panel(heading: &str, laterals: &[f64], height: i32, lines: Vec<Line>) -> Panel {
    let points = lines.iter().flat_map(|line| &line.points);
    let y = round_range(points.map(|point| point.1));
    Panel::new(heading, [lateral_range(laterals), y], height, lines)
}

fn points(laterals: &[f64], forces: &[f64]) -> Vec<(f64, f64)> {
    laterals
        .iter()
        .zip(forces)
        .map(|(x, force)| (x * 1e3, *force))
        .collect()
}

/// Figure 5: both forces of a map, one curve for each depth of the probe, and the ends of a band of the normal and of the lateral
/// force.
fn force_curves(table: &ForceTable, [normal, lateral]: [Vec<Line>; 2]) -> [Panel; 2] {
    let panel = |heading: &str, matrix: &Matrix, height, band: Vec<Line>| {
        let count = table.depths().len();
        let lines = table.depths().iter().zip(matrix.rows()).enumerate();
        let lines = lines.map(|(row, (depth, forces))| {
            Line::new(ramp(row, count), points(table.laterals(), forces))
                .named(format!("{} mm", millimetres(*depth)))
        });
        let lines = lines.chain(band).collect();
        panel(heading, table.laterals(), height, lines)
    };
    [
        panel("Normal force (N)", &table.forces().normal, 230, normal),
        panel("Lateral force (N)", &table.forces().lateral, 200, lateral),
    ]
}

/// The ends of the bands of the normal and of the lateral force that a study has for the phantom of a map.
///
/// Implements: REP-081.
fn bands(run: &Run, map: &ForceMap) -> [Vec<Line>; 2] {
    let Some((study, phantom)) = run.study.as_ref().zip(map.phantom()) else {
        return Default::default();
    };
    let ends = |kind: fn(f64) -> Kind| {
        let at = |&x: &f64| Some((1e3 * x, study.of(&phantom.name, &kind(x))?.band?));
        let bands: Vec<_> = study.plan.laterals.iter().filter_map(at).collect();
        band_ends("", &bands, 1.0)
    };
    [
        ends(|lateral_m| Kind::NormalForceN { lateral_m }),
        ends(|lateral_m| Kind::LateralForceN { lateral_m }),
    ]
}

/// How a map is called in a figure: the inclusion's depth for the paper's phantoms, or else its name.
pub fn label(map: &MapFindings) -> String {
    match map.paper_phantom {
        Some("none") | None => shortened(&map.name, 14),
        Some(depth) => format!("{depth} mm"),
    }
}

/// F_1 − F_0 of every map at one depth of the probe.
///
/// # Errors
/// If a map does not fit the reference.
fn signals(run: &Run, found: &Findings) -> Result<[Panel; 2], Refusal> {
    let (mut normal, mut lateral) = (Vec::new(), Vec::new());
    for (k, (map, of_map)) in run.maps.iter().zip(&found.maps).enumerate() {
        let table = map.signal(&run.reference);
        let table = table.map_err(incomparable(map))?;
        let curve = table.row(found.probe_depth_m);
        let curve = curve.map_err(incomparable(map))?;
        let line = |forces| {
            Line::new(PALETTE[k % PALETTE.len()], points(table.laterals(), forces))
                .dashed((k / PALETTE.len()) % 2 == 1)
                .named(label(of_map))
        };
        normal.push(line(curve.normal));
        lateral.push(line(curve.lateral));
    }
    let laterals = run.reference.laterals();
    Ok([
        panel("Normal signal F₁ − F₀ (N)", laterals, 230, normal),
        panel("Lateral signal F₁ − F₀ (N)", laterals, 200, lateral),
    ])
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "signals_title", blocks = ["signals_caption", "signals_alt"])]
struct SignalText<'a> {
    found: &'a Findings,
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "figure_5_title", blocks = ["figure_5_caption", "figure_5_alt"])]
struct ForceText<'a> {
    map: &'a ForceMap,
    /// The depth of the bands, m, if there are any.
    depth: Option<f64>,
}

impl ForceText<'_> {
    fn inclusions(&self) -> Option<&[Inclusion]> {
        self.map.phantom().map(|phantom| &phantom.inclusions[..])
    }

    fn is_the_papers(&self) -> bool {
        self.map.phantom().and_then(paper::name_of) == Some("2.6")
    }

    /// The largest normal force, N.
    fn largest(&self) -> f64 {
        let forces = self.map.forces().normal.values();
        forces.iter().copied().fold(0.0, f64::max)
    }
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "figure_7_title", blocks = ["figure_7_caption", "figure_7_alt"])]
struct MeasuredText<'a> {
    map: &'a ForceMap,
}
