//! Parts of drawings that are no charts: boxes, arrows, dimensions. All places are in pixels.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::chart::{Area, DrawingResult, say, write};
use super::style::{INK, UNIT, stroke};

/// A place, pixels from the left and from the top.
pub type Place = [f64; 2];

/// Tints for what is in a drawing, the same in all of them.
pub const GEL: RGBColor = RGBColor(250, 243, 224);
/// The rubber on the gel.
const SKIN: RGBColor = RGBColor(86, 180, 233);
/// Layers between the uppermost and the lowest.
const BETWEEN: [RGBColor; 3] = [
    RGBColor(211, 234, 212),
    RGBColor(240, 213, 221),
    RGBColor(221, 214, 238),
];
/// The hard inclusion.
pub const INCLUSION: RGBColor = RGBColor(230, 159, 0);
/// The rigid probe.
pub const PROBE: RGBColor = RGBColor(208, 212, 218);
/// The block of wax around the gel, and whatever stays outside the program.
pub const WAX: RGBColor = RGBColor(226, 221, 212);
/// A step of a computation.
pub const STEP: RGBColor = RGBColor(226, 239, 248);

/// The tint of layer `k` from the top of `count`: the lowest is the gel, the uppermost on it the skin.
pub fn layer_tint(k: usize, count: usize) -> RGBColor {
    match k {
        _ if k + 1 == count => GEL,
        0 => SKIN,
        _ => BETWEEN[(k - 1) % BETWEEN.len()],
    }
}

/// Distance of two lines of text, pixels.
pub const LINE: f64 = 20.0;

fn units([x, y]: Place) -> (i32, i32) {
    let unit = f64::from(UNIT);
    ((x * unit).round() as i32, (y * unit).round() as i32)
}

/// Words whose `side` is at a place.
pub fn say_at(area: &Area<'_>, words: &str, at: Place, side: HPos) -> DrawingResult<()> {
    let [x, y] = at.map(|pixels| pixels.round() as i32);
    write(area, words, [x, y], INK, side)
}

/// A filled shape with an outline.
pub fn shape(area: &Area<'_>, corners: &[Place], fill: RGBColor) -> DrawingResult<()> {
    let mut places: Vec<_> = corners.iter().copied().map(units).collect();
    area.draw(&Polygon::new(places.clone(), fill.filled()))
        .map_err(say)?;
    places.extend(places.first().copied());
    area.draw(&PathElement::new(places, stroke(INK, 1.2)))
        .map_err(say)
}

/// An open line of `width` pixels.
pub fn path(area: &Area<'_>, places: &[Place], colour: RGBColor, width: f64) -> DrawingResult<()> {
    let places: Vec<_> = places.iter().copied().map(units).collect();
    area.draw(&PathElement::new(places, stroke(colour, width)))
        .map_err(say)
}

/// A dashed line through `places`.
pub fn dashes(area: &Area<'_>, places: &[Place], colour: RGBColor) -> DrawingResult<()> {
    let places: Vec<_> = places.iter().copied().map(units).collect();
    let (dash, gap) = (5 * UNIT, 4 * UNIT);
    area.draw(&DashedPathElement::new(
        places,
        dash,
        gap,
        stroke(colour, 1.2),
    ))
    .map_err(say)
}

/// A rectangle with its words in lines in the middle. `frame` is left, top, width, height.
pub fn boxed(
    area: &Area<'_>,
    [left, top, width, height]: [f64; 4],
    fill: RGBColor,
    lines: &[&str],
) -> DrawingResult<()> {
    let (right, bottom) = (left + width, top + height);
    shape(
        area,
        &[[left, top], [right, top], [right, bottom], [left, bottom]],
        fill,
    )?;
    let first = top + 0.5 * height - 0.5 * LINE * (lines.len() as f64 - 1.0);
    for (k, line) in lines.iter().enumerate() {
        let at = [left + 0.5 * width, first + LINE * k as f64];
        say_at(area, line, at, HPos::Center)?;
    }
    Ok(())
}

/// A line through `places` with a head at its end.
pub fn arrow(area: &Area<'_>, places: &[Place]) -> DrawingResult<()> {
    path(area, places, INK, 1.5)?;
    match places {
        [.., from, to] => head(area, *from, *to),
        _ => Ok(()),
    }
}

/// A line with a head at both ends.
pub fn dimension(area: &Area<'_>, [from, to]: [Place; 2]) -> DrawingResult<()> {
    path(area, &[from, to], INK, 1.2)?;
    head(area, from, to)?;
    head(area, to, from)
}

/// The head of an arrow that comes from `from` and ends at `to`.
fn head(area: &Area<'_>, from: Place, to: Place) -> DrawingResult<()> {
    let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
    if length <= 0.0 {
        return Ok(());
    }
    let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    let back = |side: f64| {
        [
            to[0] - 8.0 * along[0] + side * 4.0 * along[1],
            to[1] - 8.0 * along[1] - side * 4.0 * along[0],
        ]
    };
    let corners = [to, back(1.0), back(-1.0)].map(units);
    area.draw(&Polygon::new(corners.to_vec(), INK.filled()))
        .map_err(say)
}
