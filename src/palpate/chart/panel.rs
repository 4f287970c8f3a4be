//! What a chart is made of: panels and lines.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{INK, UNIT, text};
use crate::text::printable;

/// What drawing gives, or what the drawing library refused.
pub type DrawingResult<T> = Result<T, Box<dyn std::error::Error>>;
/// Where a chart is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// A chart with plain axes.
pub type Context<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Pixels left of a plot for the numbers of its y axis.
pub const LEFT: i32 = 80;
/// Pixels right of a plot, where nothing stands there.
pub const RIGHT: i32 = 24;

/// One curve.
#[derive(Debug, Clone, Default)]
pub struct Line {
    /// Its name in the key; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// Whether it is drawn in dashes.
    pub is_dashed: bool,
    /// Whether it is the outline of an area that is filled with its colour.
    pub is_area: bool,
    /// Its width, pixels; 0 for dots alone.
    pub width: f64,
    /// Radius of the dot on each point, pixels; 0 for none.
    pub dot: i32,
    /// Its points in data coordinates.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// A solid curve two pixels wide, without a name and without dots.
    pub fn new(colour: RGBColor, points: Vec<(f64, f64)>) -> Line {
        Line {
            colour,
            width: 2.0,
            points,
            ..Line::default()
        }
    }

    /// Curve `k` of many: in `colours` in turn, with dashes in every second turn.
    pub fn nth(k: usize, colours: &[RGBColor], points: Vec<(f64, f64)>) -> Line {
        let colour = colours[k % colours.len()];
        Line::new(colour, points).dashed((k / colours.len()) % 2 == 1)
    }

    /// An area with a thin outline.
    pub fn area(colour: RGBColor, points: Vec<(f64, f64)>) -> Line {
        Line {
            is_area: true,
            ..Line::new(colour, points)
        }
    }

    /// This curve with a name in the key.
    pub fn named(mut self, name: impl Into<String>) -> Line {
        self.name = name.into();
        self
    }

    /// This curve in dashes, if it is to have them.
    pub fn dashed(mut self, is_dashed: bool) -> Line {
        self.is_dashed = is_dashed;
        self
    }

    /// This curve `width` pixels wide.
    pub fn wide(mut self, width: f64) -> Line {
        self.width = width;
        self
    }

    /// This curve with a dot of `radius` pixels on each point.
    pub fn dotted(mut self, radius: i32) -> Line {
        self.dot = radius;
        self
    }
}

/// Many small areas of one colour, each given by its corners in data coordinates.
pub struct Cells {
    /// What they are filled with.
    pub fill: RGBColor,
    /// The colour of the thin lines around them.
    pub edge: RGBColor,
    /// The corners of each.
    pub areas: Vec<Vec<(f64, f64)>>,
}

/// What a panel shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PanelKind {
    /// Curves over both axes.
    #[default]
    Chart,
    /// Bars by rank: the y axis has no numbers, and each name stands right of its bar.
    Ranked,
    /// A drawing to scale, without a grid.
    ToScale,
}

/// One plot.
#[derive(Default)]
pub struct Panel {
    /// Sentences above everything else.
    pub caption: Vec<String>,
    /// What the y axis shows, with its unit.
    pub heading: String,
    /// What the x axis shows, with its unit; empty where a panel below has the same axis.
    pub x_name: String,
    /// Least and greatest x.
    pub x: [f64; 2],
    /// Least and greatest y.
    pub y: [f64; 2],
    /// Where the x axis has numbers; empty for round numbers.
    pub ticks: Vec<f64>,
    /// What it shows.
    pub kind: PanelKind,
    /// Height of the plot, pixels.
    pub height: i32,
    /// Entries of the key above the plot beside those of the named lines.
    pub key: Vec<Line>,
    /// Small areas under everything.
    pub cells: Vec<Cells>,
    /// Curves, the later over the earlier.
    pub lines: Vec<Line>,
}

impl Panel {
    /// A chart of curves.
    pub fn new(
        heading: impl Into<String>,
        [x, y]: [[f64; 2]; 2],
        height: i32,
        lines: Vec<Line>,
    ) -> Panel {
        Panel {
            heading: heading.into(),
            x,
            y,
            height,
            lines,
            ..Panel::default()
        }
    }
}

/// Writes `words` with its `side` at a place in pixels.
pub fn write(area: &Area<'_>, words: &str, at: [i32; 2], side: HPos) -> DrawingResult<()> {
    let at = (at[0] * UNIT, at[1] * UNIT);
    Ok(area.draw(&Text::new(printable(words), at, text(INK, side)))?)
}
