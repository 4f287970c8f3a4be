//! Figure 6: the deformed mesh under the probe.

use std::fmt::Write;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::chart::{Context, DrawingResult, axes, draw, say, write};
use super::diagram::{GEL, INCLUSION, PROBE, SKIN};
use super::style::{INK, UNIT, WIDTH, stroke};
use super::{Draft, Words};
use crate::fem::mesh::Region;
use crate::report::text::{fixed, millimetres};
use crate::report::{DeformedMesh, ReportError, Topic};

/// Pixels left of the plot.
const LEFT: i32 = 58;
/// Pixels right of the plot.
const RIGHT: i32 = 24;
/// Pixels above the plot, for the key.
const TOP: i32 = 44;
/// Pixels below the plot, for numbers and the axis' name.
const BOTTOM: i32 = 62;

/// What a region is called and filled with.
fn look(region: Region, has_disc: bool) -> (&'static str, RGBColor) {
    match region {
        Region::Skin => ("skin", SKIN),
        Region::Disc if has_disc => ("inclusion", INCLUSION),
        Region::Gel | Region::Disc => ("gel", GEL),
    }
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

/// All elements of one look as one path, which keeps the file small: the library would write one tag for each.
fn region_path(mesh: &DeformedMesh, places: &[(i32, i32)], name: &str) -> String {
    let has_disc = mesh.phantom.inclusion.is_some();
    let mut path = String::new();
    let mut colour = WHITE;
    for (corners, &region) in mesh.corners.iter().zip(&mesh.regions) {
        let (of_region, fill) = look(region, has_disc);
        if of_region != name {
            continue;
        }
        colour = fill;
        for (k, &corner) in corners.iter().enumerate() {
            let (x, y) = places[corner as usize];
            // Writing to a String does not fail.
            let _ = write!(path, "{}{x} {y}", if k == 0 { 'M' } else { 'L' });
        }
        path.push('Z');
    }
    if path.is_empty() {
        return path;
    }
    let RGBColor(r, g, b) = colour;
    format!(
        "<path d=\"{path}\" fill=\"#{r:02X}{g:02X}{b:02X}\" stroke=\"#5B6470\" stroke-width=\"4\" stroke-linejoin=\"round\"/>\n"
    )
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
    let disc = match mesh.phantom.inclusion {
        Some(_) => {
            " The inclusion keeps its shape, since it is far stiffer than the gel, as the paper says of its Figure 6."
        }
        None => "",
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
            "A mesh of {} elements: gel under a thin skin, dented by a round probe from above.",
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
    let whole = TOP + height + BOTTOM;
    let mut paths = String::new();
    let svg = draw(whole, |area| {
        let chart = axes(area, [LEFT, TOP], [width, height], x, y, None)?;
        let places: Vec<_> = nodes.iter().map(|node| chart.backend_coord(node)).collect();
        for name in ["gel", "inclusion", "skin"] {
            paths.push_str(&region_path(mesh, &places, name));
        }
        draw_probe(area, &chart, &outline)?;
        draw_key(area, mesh.phantom.inclusion.is_some())?;
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

fn draw_key(area: &super::chart::Area<'_>, has_disc: bool) -> DrawingResult<()> {
    let looks = [
        ("probe", PROBE),
        look(Region::Skin, has_disc),
        look(Region::Gel, has_disc),
        look(Region::Disc, has_disc),
    ];
    for (k, (name, colour)) in looks
        .into_iter()
        .take(if has_disc { 4 } else { 3 })
        .enumerate()
    {
        let left = LEFT + 100 * k as i32;
        let corners = [(left * UNIT, 14 * UNIT), ((left + 18) * UNIT, 30 * UNIT)];
        area.draw(&Rectangle::new(corners, colour.filled()))
            .map_err(say)?;
        area.draw(&Rectangle::new(corners, stroke(INK, 1.0)))
            .map_err(say)?;
        write(area, name, [left + 25, 22], INK, HPos::Left)?;
    }
    Ok(())
}
