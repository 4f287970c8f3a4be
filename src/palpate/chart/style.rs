//! How every figure looks: one size, one type size, one palette.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Drawing units in one pixel: the library rounds to whole units, and a tenth of a pixel is not seen.
pub const UNIT: i32 = 10;
/// Width of a figure, pixels: narrow, so that its text stays legible on a phone.
pub const WIDTH: i32 = 520;
/// Size of the text, pixels.
const TEXT: f64 = 15.0;
/// What the SVG backend divides the size of a font by.
const BACKEND_DIVISOR: f64 = 1.24;

/// Text and axes.
pub const INK: RGBColor = RGBColor(45, 49, 56);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(226, 229, 233);

/// The colours of Okabe and Ito, which all kinds of colour vision tell apart. Orange, purple and sky blue are
/// darkened until they stand out three to one from white, as WCAG 1.4.11 asks for; their yellow cannot be.
///
/// Implements: REP-034.
pub const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(184, 92, 143),
    RGBColor(178, 116, 0),
    RGBColor(46, 143, 200),
    RGBColor(0, 0, 0),
];
/// Blue of [`PALETTE`].
pub const BLUE: RGBColor = PALETTE[0];
/// Vermilion of [`PALETTE`].
pub const VERMILION: RGBColor = PALETTE[1];
/// Bluish green of [`PALETTE`].
pub const GREEN: RGBColor = PALETTE[2];
/// Lines that others are compared with, such as a limit or pure chance.
pub const GREY: RGBColor = RGBColor(118, 126, 136);

/// Step `index` of `count` from sky blue over blue to navy: darker is more.
pub fn ramp(index: usize, count: usize) -> RGBColor {
    let stops = [[46.0, 143.0, 200.0], [0.0, 114.0, 178.0], [8.0, 29.0, 68.0]];
    let place = 2.0 * index as f64 / (count.max(2) - 1) as f64;
    let below = usize::from(place > 1.0);
    let ([from, to], share) = ([stops[below], stops[below + 1]], place - below as f64);
    let mix = |k: usize| (from[k] + share * (to[k] - from[k])).round() as u8;
    RGBColor(mix(0), mix(1), mix(2))
}

/// A line of `width` pixels.
pub fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: colour.into(),
        filled: false,
        stroke_width: (width * f64::from(UNIT)) as u32,
    }
}

/// Text in `colour`, held at its `horizontal` side and in the middle of its height.
pub fn text(colour: RGBColor, horizontal: HPos) -> TextStyle<'static> {
    let size = TEXT * BACKEND_DIVISOR * f64::from(UNIT);
    ("sans-serif", size)
        .into_font()
        .color(&colour)
        .pos(Pos::new(horizontal, VPos::Center))
}

/// A generous estimate of how wide `text` is, pixels: no font is read, since every machine has others.
pub fn text_width(text: &str) -> i32 {
    (0.58 * TEXT * text.chars().count() as f64).ceil() as i32
}
