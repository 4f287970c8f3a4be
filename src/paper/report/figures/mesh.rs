//! Figure 6: the deformed mesh under the probe.

use std::collections::BTreeMap;

use askama::Template;
use plotters::style::RGBColor;

use super::setup::{PROBE, inclusion_key, layer_key, probe, tint};
use super::{Figures, words};
use crate::report::{DeformedMesh, Topic, paper, text};
use palpate::chart::chart;
use palpate::chart::to_mm;
use palpate::chart::{Cells, Line, Panel};
use palpate::refusal::Refusal;

/// The sides of elements.
const EDGE: RGBColor = RGBColor(0x5B, 0x64, 0x70);

#[derive(Template)]
#[template(path = "report/words.txt", block = "figure_6_title", blocks = ["figure_6_caption", "figure_6_alt"])]
struct Text<'a> {
    mesh: &'a DeformedMesh,
}

/// Figure 6: the mesh to scale, with straight sides between the corners of its elements.
pub fn draw(figures: &mut Figures, mesh: &DeformedMesh) -> Result<(), Refusal> {
    let phantom = &mesh.phantom;
    let mut regions: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for (region, corners) in &mesh.elements {
        let corners = to_mm(corners.iter().copied());
        regions.entry(*region).or_default().push(corners);
    }
    // The uppermost layer last, so that a thin one is not covered by the lines of its neighbour.
    let cells = regions.into_iter().rev().map(|(region, areas)| Cells {
        fill: tint(region, phantom),
        edge: EDGE,
        areas,
    });
    let lines = vec![probe(phantom, mesh.pose)];
    let mut panel = Panel::to_scale(cells.collect(), lines);
    panel.key = vec![Line::area(PROBE, Vec::new()).named("probe")];
    panel.key.extend(layer_key(phantom, |_| String::new()));
    panel.key.extend(match phantom.inclusions.len() {
        0 => None,
        1 => Some(inclusion_key("inclusion")),
        _ => Some(inclusion_key("inclusions")),
    });
    let text = Text { mesh };
    let drawn = chart(&[panel], "Lateral position x (mm)");
    figures.add(
        ("figure-6", ""),
        Topic::Setup,
        words!(text, as_figure_6_caption, as_figure_6_alt),
        drawn,
    )
}
