//! Figure 6: the deformed mesh under the probe.

use std::collections::BTreeMap;
use std::fmt::Write;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::chart::{Context, DrawingResult, axes, draw, say, write};
use super::diagram::{INCLUSION, PROBE, layer_tint};
use super::style::{INK, UNIT, WIDTH, stroke, text_width};
use super::{Draft, Words};
use crate::fem::mesh::Region;
use crate::phantom::Phantom;
use crate::report::text::{fixed, millimetres, shortened};
use crate::report::{DeformedMesh, ReportError, Topic, paper};

/// Pixels left of the plot.
const LEFT: i32 = 58;
/// Pixels right of the plot.
const RIGHT: i32 = 24;
/// Height of a row of the key, pixels.
const KEY_ROW: i32 = 22;
/// Least distance of two entries of the key, pixels.
const KEY_STEP: i32 = 100;
/// Most layers in the key.
const MOST_LAYERS: usize = 20;
/// Pixels below the plot, for numbers and the axis' name.
const BOTTOM: i32 = 62;

/// What a region is filled with.
fn fill(region: Region, phantom: &Phantom) -> RGBColor {
    match region {
        Region::Layer(k) => layer_tint(k, phantom.layers.len()),
        Region::Inclusion(_) => INCLUSION,
    }
}

/// Names and colours of the key, with their places: pixels from the left, and the row.
fn key(phantom: &Phantom) -> Vec<(String, RGBColor, [i32; 2])> {
    let layers = phantom.layers.iter().enumerate().take(MOST_LAYERS);
    let layers =
        layers.map(|(k, layer)| (shortened(&layer.name, 24), fill(Region::Layer(k), phantom)));
    let inclusions = match phantom.inclusions.len() {
        0 => None,
        1 => Some(("inclusion".into(), INCLUSION)),
        _ => Some(("inclusions".into(), INCLUSION)),
    };
    let (mut left, mut row) = (LEFT, 0);
    let place = |(name, colour): (String, RGBColor)| {
        let width = 25 + text_width(&name);
        if left > LEFT && left + width > WIDTH {
            (left, row) = (LEFT, row + 1);
        }
        let at = [left, row];
        left += (width + 12).max(KEY_STEP);
        (name, colour, at)
    };
    let probe = ("probe".into(), PROBE);
    core::iter::once(probe)
        .chain(layers)
        .chain(inclusions)
        .map(place)
        .collect()
}

/// Pixels above the plot, for the key.
fn top(phantom: &Phantom) -> i32 {
    KEY_ROW * (2 + key(phantom).last().map_or(0, |(.., [_, row])| *row))
}

/// Refuses a mesh that contradicts itself or is not finite.
///
/// # Errors
/// [`ReportError::Mesh`] with what is wrong.
///
/// Implements: REP-004.
pub fn check(mesh: &DeformedMesh) -> Result<(), ReportError> {
    let wrong = |problem: String| Err(ReportError::Mesh { problem });
    if mesh.nodes.len() != mesh.displacements.len() {
        return wrong(format!(
            "{} nodes, but {} displacements",
            mesh.nodes.len(),
            mesh.displacements.len()
        ));
    }
    if mesh.corners.len() != mesh.regions.len() {
        return wrong(format!(
            "{} elements, but {} regions",
            mesh.corners.len(),
            mesh.regions.len()
        ));
    }
    let (layers, inclusions) = (mesh.phantom.layers.len(), mesh.phantom.inclusions.len());
    let unknown = |region: &Region| match *region {
        Region::Layer(k) => k >= layers,
        Region::Inclusion(k) => k >= inclusions,
    };
    if let Some(element) = mesh.regions.iter().position(unknown) {
        let region = mesh.regions[element];
        return wrong(format!(
            "element {element} lies in {region:?}, expected one of {layers} layers and {inclusions} inclusions"
        ));
    }
    let last = mesh.nodes.len() as u64;
    let outside = |element: &Vec<u32>| {
        element.len() < 3 || element.iter().any(|&node| u64::from(node) >= last)
    };
    if let Some(element) = mesh.corners.iter().position(outside) {
        return wrong(format!(
            "element {element} needs at least three corners, each below {last}"
        ));
    }
    let finite = |p: &[f64; 2]| p.iter().all(|coordinate| coordinate.is_finite());
    let both = mesh.nodes.iter().zip(&mesh.displacements);
    if let Some(node) = both
        .into_iter()
        .position(|(p, u)| !(finite(p) && finite(u)))
    {
        return wrong(format!(
            "node {node} has a position or displacement that is not finite"
        ));
    }
    if !(mesh.pose.depth.is_finite() && mesh.pose.lateral.is_finite() && mesh.min_det.is_finite()) {
        return wrong("the pose or the smallest determinant is not finite".into());
    }
    Ok(())
}

/// Deformed positions of the nodes, mm.
fn deformed(mesh: &DeformedMesh) -> Vec<(f64, f64)> {
    let moved = mesh.nodes.iter().zip(&mesh.displacements);
    moved
        .map(|([x, y], [u, v])| (1e3 * (x + u), 1e3 * (y + v)))
        .collect()
}

/// The outline of the probe's half cylinder, mm, from its left edge round its bottom to its right edge.
fn probe_outline(mesh: &DeformedMesh) -> Vec<(f64, f64)> {
    let radius = mesh.phantom.probe.radius;
    let centre = [mesh.pose.lateral, radius - mesh.pose.depth];
    // The half circle ends at its centre's height; a probe that is deeper than its radius goes on upwards.
    let top = centre[1].max(1e-3);
    let arc = (0..=90).map(|k| {
        let angle = core::f64::consts::PI * (1.0 + f64::from(k) / 90.0);
        let (sine, cosine) = libm::sincos(angle);
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    });
    let ends = |sign: f64| [centre[0] + sign * radius, top];
    let points = [ends(-1.0)].into_iter().chain(arc).chain([ends(1.0)]);
    points.map(|[x, y]| (1e3 * x, 1e3 * y)).collect()
}

/// All elements of one region as one path, which keeps the file small: the library would write one tag for each.
fn region_paths(mesh: &DeformedMesh, places: &[(i32, i32)]) -> String {
    let mut paths: BTreeMap<Region, String> = BTreeMap::new();
    for (corners, &region) in mesh.corners.iter().zip(&mesh.regions) {
        let path = paths.entry(region).or_default();
        for (k, &corner) in corners.iter().enumerate() {
            let (x, y) = places[corner as usize];
            // Writing to a String does not fail.
            let _ = write!(path, "{}{x} {y}", if k == 0 { 'M' } else { 'L' });
        }
        path.push('Z');
    }
    let element = |(&region, path): (&Region, &String)| {
        let RGBColor(r, g, b) = fill(region, &mesh.phantom);
        format!(
            "<path d=\"{path}\" fill=\"#{r:02X}{g:02X}{b:02X}\" stroke=\"#5B6470\" stroke-width=\"4\" stroke-linejoin=\"round\"/>\n"
        )
    };
    // The uppermost layer last, so that a thin one is not covered by the lines of its neighbour.
    paths.iter().rev().map(element).collect()
}

/// Figure 6.
pub fn draft(mesh: &DeformedMesh) -> Draft {
    Draft {
        prefix: "figure-6",
        name: String::new(),
        topic: Topic::Setup,
        words: words(mesh),
        drawn: deformed_mesh(mesh),
    }
}

fn words(mesh: &DeformedMesh) -> Words {
    let name = &mesh.phantom.name;
    let (depth, lateral) = (millimetres(mesh.pose.depth), millimetres(mesh.pose.lateral));
    let disc = match paper::name_of(&mesh.phantom) {
        None | Some("none") => "",
        Some(_) => {
            " The inclusion keeps its shape, since it is far stiffer than the gel, as the paper says of its Figure 6."
        }
    };
    let layers = match mesh.phantom.layers.len() {
        1 => "one layer".into(),
        count => format!("{count} layers"),
    };
    let holds = match mesh.phantom.inclusions.len() {
        0 => String::new(),
        1 => " with an inclusion".into(),
        count => format!(" with {count} inclusions"),
    };
    Words {
        title: format!(
            "Figure 6. Deformed mesh, phantom “{name}”, probe at depth {depth} mm, x = {lateral} mm"
        ),
        caption: format!(
            "The mesh as the probe deforms it (paper's Figure 6, whose pose is not stated), to scale and not \
             exaggerated; elements are drawn with straight sides between their corners.{disc} The smallest \
             det(I + ∇u) is {}: 1 is undeformed, and below 0.2 small strain is at its limit.",
            fixed(mesh.min_det, 3)
        ),
        alt: format!(
            "A mesh of {} elements: {layers}{holds}, dented by a round probe from above.",
            mesh.corners.len()
        ),
    }
}

/// Draws the deformed mesh to scale, and gives an SVG document with its size in pixels.
fn deformed_mesh(mesh: &DeformedMesh) -> DrawingResult<(String, [i32; 2])> {
    let nodes = deformed(mesh);
    let outline = probe_outline(mesh);
    let range = |of: fn(&(f64, f64)) -> f64| {
        let all = nodes.iter().chain(&outline).map(of);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| {
            [a.min(v), b.max(v)]
        })
    };
    let (x, y) = (range(|p| p.0), range(|p| p.1));
    let y = [y[0], y[1] + 0.02 * (y[1] - y[0])];
    let width = WIDTH - LEFT - RIGHT;
    // Equal scales; the bound keeps an absurd phantom from making an absurd page.
    let height = (f64::from(width) * (y[1] - y[0]) / (x[1] - x[0])).clamp(60.0, 1500.0) as i32;
    let top = top(&mesh.phantom);
    let whole = top + height + BOTTOM;
    let mut paths = String::new();
    let svg = draw(whole, |area| {
        let chart = axes(area, [LEFT, top], [width, height], x, y, None)?;
        let places: Vec<_> = nodes.iter().map(|node| chart.backend_coord(node)).collect();
        paths = region_paths(mesh, &places);
        draw_probe(area, &chart, &outline)?;
        draw_key(area, &mesh.phantom)?;
        let middle = LEFT + width / 2;
        write(
            area,
            "Lateral position x and height y (mm)",
            [middle, whole - 17],
            INK,
            HPos::Center,
        )
    })?;
    Ok((under_everything(&svg, &paths), [WIDTH, whole]))
}

/// Puts `paths` directly over the white ground, which is the first element that the library closes.
fn under_everything(svg: &str, paths: &str) -> String {
    match svg.split_once("/>\n") {
        Some((ground, rest)) => format!("{ground}/>\n{paths}{rest}"),
        None => svg.into(),
    }
}

fn draw_probe(
    area: &super::chart::Area<'_>,
    chart: &Context<'_>,
    outline: &[(f64, f64)],
) -> DrawingResult<()> {
    let places: Vec<_> = outline
        .iter()
        .map(|point| chart.backend_coord(point))
        .collect();
    area.draw(&Polygon::new(places.clone(), PROBE.filled()))
        .map_err(say)?;
    area.draw(&PathElement::new(places, stroke(INK, 1.5)))
        .map_err(say)
}

fn draw_key(area: &super::chart::Area<'_>, phantom: &Phantom) -> DrawingResult<()> {
    for (name, colour, [left, row]) in key(phantom) {
        let middle = KEY_ROW * (row + 1);
        let (upper, lower) = ((middle - 8) * UNIT, (middle + 8) * UNIT);
        let corners = [(left * UNIT, upper), ((left + 18) * UNIT, lower)];
        area.draw(&Rectangle::new(corners, colour.filled()))
            .map_err(say)?;
        area.draw(&Rectangle::new(corners, stroke(INK, 1.0)))
            .map_err(say)?;
        write(area, &name, [left + 25, middle], INK, HPos::Left)?;
    }
    Ok(())
}
