//! Line charts: panels below one another, each line named at its right end.

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::names::{NAME_INDENT, draw_key, draw_names, key_height, names, plot_height};
use super::style::{GRID, INK, UNIT, WIDTH, stroke, text, text_width};
use crate::report::text::{printable, trimmed};

/// Why a drawing failed, in the words of the drawing library.
pub type DrawingResult<T> = Result<T, String>;
/// Where a chart is drawn.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// A chart with plain axes.
pub type Context<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Pixels left of a plot for the numbers of its y axis.
pub const LEFT: i32 = 58;
/// Pixels above a plot for its heading.
const HEADING: i32 = 40;
/// Pixels below a plot for the numbers of its x axis.
const NUMBERS: i32 = 28;
/// Pixels at the bottom of the figure for the name of the x axis.
const FOOTING: i32 = 34;

/// One curve.
#[derive(Debug, Clone)]
pub struct Line {
    /// Its name at the right end of the curve; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// Whether it is drawn in dashes.
    pub is_dashed: bool,
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
            name: String::new(),
            colour,
            is_dashed: false,
            width: 2.0,
            dot: 0,
            points,
        }
    }

    /// This curve with a name at its right end.
    pub fn named(self, name: impl Into<String>) -> Line {
        Line {
            name: name.into(),
            ..self
        }
    }

    /// This curve in dashes.
    pub fn dashed(self) -> Line {
        Line {
            is_dashed: true,
            ..self
        }
    }

    /// This curve `width` pixels wide.
    pub fn wide(self, width: f64) -> Line {
        Line { width, ..self }
    }

    /// This curve with a dot of `radius` pixels on each point.
    pub fn dotted(self, radius: i32) -> Line {
        Line {
            dot: radius,
            ..self
        }
    }
}

/// Words or a dot at a place in the plot. The words are in ink: a pale colour would be hard to read.
pub struct Mark {
    /// The place in data coordinates.
    pub at: (f64, f64),
    /// Whether a dot is drawn there.
    pub has_dot: bool,
    /// The words.
    pub words: String,
    /// The side of the words that is at the place.
    pub side: HPos,
    /// Shift of the words from the place, pixels, right and down.
    pub shift: (i32, i32),
    /// Colour of the dot.
    pub colour: RGBColor,
}

/// One plot.
pub struct Panel {
    /// What the y axis shows, with its unit.
    pub heading: String,
    /// Least and greatest x.
    pub x: [f64; 2],
    /// Least and greatest y.
    pub y: [f64; 2],
    /// Where the x axis has numbers; empty for round numbers.
    pub ticks: Vec<f64>,
    /// Height of the plot, pixels.
    pub height: i32,
    /// What the kinds of lines mean: each is shown by a sample above the plot with its name.
    pub key: Vec<Line>,
    /// Curves, the later over the earlier.
    pub lines: Vec<Line>,
    /// Words and dots.
    pub marks: Vec<Mark>,
}

/// Draws panels below one another over one x axis, and gives the body of an SVG document that has the size returned.
pub fn chart(panels: &[Panel], x_name: &str) -> DrawingResult<(String, [i32; 2])> {
    let each = |panel: &Panel| HEADING + key_height(panel) + plot_height(panel) + NUMBERS;
    let height = panels.iter().map(each).sum::<i32>() + FOOTING;
    let widest = panels
        .iter()
        .flat_map(names)
        .map(|line| NAME_INDENT + text_width(&line.name) + 8)
        .max();
    let right = widest.unwrap_or(0).clamp(24, WIDTH / 3);
    let svg = draw(height, |area| {
        let mut top = 0;
        for panel in panels {
            draw_panel(area, panel, top, right)?;
            top += each(panel);
        }
        let middle = LEFT + (WIDTH - LEFT - right) / 2;
        write(
            area,
            x_name,
            [middle, height - FOOTING / 2],
            INK,
            HPos::Center,
        )
    })?;
    Ok((svg, [WIDTH, height]))
}

/// Runs `paint` on a white figure `height` pixels high, and gives the SVG document that the library wrote.
pub fn draw(
    height: i32,
    paint: impl FnOnce(&Area<'_>) -> DrawingResult<()>,
) -> DrawingResult<String> {
    let mut svg = String::new();
    let size = ((WIDTH * UNIT) as u32, (height * UNIT) as u32);
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&WHITE).map_err(say)?;
        paint(&area)?;
        area.present().map_err(say)?;
    }
    Ok(svg)
}

/// The plain words of a drawing error.
pub fn say(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Writes `words` with its `side` at a place in pixels.
pub fn write(
    area: &Area<'_>,
    words: &str,
    at: [i32; 2],
    colour: RGBColor,
    side: HPos,
) -> DrawingResult<()> {
    let at = (at[0] * UNIT, at[1] * UNIT);
    area.draw(&Text::new(printable(words), at, text(colour, side)))
        .map_err(say)
}

fn draw_panel(area: &Area<'_>, panel: &Panel, top: i32, right: i32) -> DrawingResult<()> {
    write(area, &panel.heading, [8, top + 22], INK, HPos::Left)?;
    draw_key(area, panel, top + HEADING - 4)?;
    let top = top + HEADING + key_height(panel);
    let size = [WIDTH - LEFT - right, plot_height(panel)];
    let mut chart = axes(
        area,
        [LEFT, top],
        size,
        panel.x,
        panel.y,
        Some(&panel.ticks),
    )?;
    for line in &panel.lines {
        draw_line(&mut chart, line)?;
    }
    for mark in &panel.marks {
        draw_mark(area, &chart, mark)?;
    }
    draw_names(area, &chart, panel, top, right)
}

/// Axes with numbers around a plot at `corner` of `size` (pixels), with a grid if there are `ticks`: places of the
/// numbers of the x axis, or none for round numbers.
pub fn axes<'a>(
    area: &Area<'a>,
    corner: [i32; 2],
    size: [i32; 2],
    x: [f64; 2],
    y: [f64; 2],
    ticks: Option<&[f64]>,
) -> DrawingResult<Context<'a>> {
    let place = |pixels: i32| pixels * UNIT;
    let sub = area.clone().shrink(
        (place(corner[0] - LEFT), place(corner[1])),
        (place(size[0] + LEFT), place(size[1] + NUMBERS)),
    );
    let mut chart = ChartBuilder::on(&sub)
        .set_label_area_size(LabelAreaPosition::Left, place(LEFT))
        .set_label_area_size(LabelAreaPosition::Bottom, place(NUMBERS))
        .build_cartesian_2d(x[0]..x[1], y[0]..y[1])
        .map_err(say)?;
    let own_ticks = ticks.filter(|ticks| !ticks.is_empty());
    let grid = if ticks.is_some() {
        stroke(GRID, 1.0)
    } else {
        TRANSPARENT.stroke_width(0)
    };
    let number = |value: &f64| trimmed(*value, 6);
    chart
        .configure_mesh()
        .x_labels(if own_ticks.is_some() { 0 } else { 6 })
        .y_labels((size[1] / 40).max(2) as usize)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(text(INK, HPos::Center))
        .axis_style(stroke(INK, 1.0))
        .bold_line_style(grid)
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(place(5))
        .draw()
        .map_err(say)?;
    for &tick in own_ticks.unwrap_or_default() {
        let (foot, top) = (
            chart.backend_coord(&(tick, y[0])),
            chart.backend_coord(&(tick, y[1])),
        );
        let line = PathElement::new(vec![top, foot], grid);
        area.draw(&line).map_err(say)?;
        let end = (foot.0, foot.1 + place(5));
        let mark = PathElement::new(vec![foot, end], stroke(INK, 1.0));
        area.draw(&mark).map_err(say)?;
        let at = [foot.0 / UNIT, foot.1 / UNIT + 15];
        write(area, &number(&tick), at, INK, HPos::Center)?;
    }
    Ok(chart)
}

fn draw_line(chart: &mut Context<'_>, line: &Line) -> DrawingResult<()> {
    let style = stroke(line.colour, line.width);
    let points = line.points.iter().copied();
    if line.dot > 0 {
        let filled = ShapeStyle::from(&line.colour).filled();
        let dots = points
            .clone()
            .map(|at| Circle::new(at, line.dot * UNIT, filled));
        chart.draw_series(dots).map_err(say)?;
    }
    if line.width <= 0.0 {
        return Ok(());
    }
    if line.is_dashed {
        let series = DashedLineSeries::new(points, 6 * UNIT, 4 * UNIT, style);
        chart.draw_series(series).map_err(say)?;
    } else {
        chart
            .draw_series(LineSeries::new(points, style))
            .map_err(say)?;
    }
    Ok(())
}

fn draw_mark(area: &Area<'_>, chart: &Context<'_>, mark: &Mark) -> DrawingResult<()> {
    let (x, y) = chart.backend_coord(&mark.at);
    if mark.has_dot {
        let dot = Circle::new((x, y), 5 * UNIT, ShapeStyle::from(&mark.colour).filled());
        area.draw(&dot).map_err(say)?;
    }
    let at = [x / UNIT + mark.shift.0, y / UNIT + mark.shift.1];
    write(area, &mark.words, at, INK, mark.side)
}

/// The least range of round numbers that holds all `values`, and 0, and is not empty.
pub fn round_range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (least, greatest) = values.fold((0.0, 0.0), |(least, greatest): (f64, f64), value| {
        (least.min(value), greatest.max(value))
    });
    let span = greatest - least;
    // Less than a piconewton is rounding, and an overflow has no scale.
    if span < 1e-12 || !span.is_finite() {
        return [-1.0, 1.0];
    }
    // The step is 1, 2 or 5 times a power of ten, a tenth of the span or a little more.
    let power = libm::pow(10.0, libm::floor(libm::log10(span / 10.0)));
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|factor| factor * power * 10.0 >= span);
    let step = factor.unwrap_or(10.0) * power;
    [
        libm::floor(least / step) * step,
        libm::ceil(greatest / step) * step,
    ]
}
