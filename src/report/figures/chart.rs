//! Line charts: panels below one another, each line named at its right end.

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

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
const LEFT: i32 = 58;
/// Pixels above a plot for its heading.
const HEADING: i32 = 40;
/// Pixels below a plot for the numbers of its x axis.
const NUMBERS: i32 = 28;
/// Pixels at the bottom of the figure for the name of the x axis.
const FOOTING: i32 = 34;
/// Least distance between two names at the right, pixels.
const NAME_DISTANCE: i32 = 18;
/// Distance from a plot to the names at its right, pixels.
const NAME_INDENT: i32 = 20;
/// Most names beside one plot.
const MOST_NAMES: usize = 40;

/// One curve.
pub struct Line {
    /// Its name at the right end of the curve; empty for none.
    pub name: String,
    /// Its colour and that of its name.
    pub colour: RGBColor,
    /// Whether it is drawn in dashes.
    pub is_dashed: bool,
    /// Its points in data coordinates.
    pub points: Vec<(f64, f64)>,
}

/// Words or a dot at a place in the plot.
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
    /// Colour.
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
    /// Height of the plot, pixels.
    pub height: i32,
    /// Curves, the later over the earlier.
    pub lines: Vec<Line>,
    /// Words and dots.
    pub marks: Vec<Mark>,
}

/// The names of a panel's lines that stand at the right, not more than fit.
fn names(panel: &Panel) -> Vec<&Line> {
    let named: Vec<_> = panel
        .lines
        .iter()
        .filter(|line| !line.name.is_empty())
        .collect();
    let every = named.len().div_ceil(MOST_NAMES).max(1);
    named.into_iter().step_by(every).collect()
}

/// Height of a plot that has room for all its names, pixels.
fn plot_height(panel: &Panel) -> i32 {
    panel
        .height
        .max(NAME_DISTANCE * (names(panel).len() as i32 + 1))
}

/// Draws panels below one another over one x axis, and gives the body of an SVG document that has the size returned.
pub fn chart(panels: &[Panel], x_name: &str) -> DrawingResult<(String, [i32; 2])> {
    let each = |panel: &Panel| HEADING + plot_height(panel) + NUMBERS;
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
    let size = [WIDTH - LEFT - right, plot_height(panel)];
    let mut chart = axes(area, [LEFT, top + HEADING], size, panel.x, panel.y, true)?;
    for line in &panel.lines {
        draw_line(&mut chart, line)?;
    }
    for mark in &panel.marks {
        draw_mark(area, &chart, mark)?;
    }
    draw_names(area, &chart, panel, top + HEADING, right)
}

/// Axes with numbers around a plot at `corner` of `size` (pixels).
pub fn axes<'a>(
    area: &Area<'a>,
    corner: [i32; 2],
    size: [i32; 2],
    x: [f64; 2],
    y: [f64; 2],
    has_grid: bool,
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
    let grid = if has_grid {
        stroke(GRID, 1.0)
    } else {
        TRANSPARENT.stroke_width(0)
    };
    let number = |value: &f64| trimmed(*value, 6);
    chart
        .configure_mesh()
        .x_labels(6)
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
    Ok(chart)
}

fn draw_line(chart: &mut Context<'_>, line: &Line) -> DrawingResult<()> {
    let style = stroke(line.colour, 2.0);
    let points = line.points.iter().copied();
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
    write(area, &mark.words, at, mark.colour, mark.side)
}

/// Writes each line's name right of the plot at the height of its last point, pushed apart where they would
/// overlap, with a thin leader from the one to the other.
fn draw_names(
    area: &Area<'_>,
    chart: &Context<'_>,
    panel: &Panel,
    top: i32,
    right: i32,
) -> DrawingResult<()> {
    let ends: Vec<_> = names(panel)
        .into_iter()
        .filter_map(|line| Some((line, chart.backend_coord(line.points.last()?))))
        .collect();
    let heights: Vec<_> = ends.iter().map(|(_, end)| end.1).collect();
    let range = [top * UNIT, (top + plot_height(panel)) * UNIT];
    let spread = spread(&heights, NAME_DISTANCE * UNIT, range);
    let edge = (WIDTH - right) * UNIT;
    for ((line, end), height) in ends.into_iter().zip(spread) {
        let elbow = (edge + (NAME_INDENT - 4) * UNIT, height);
        let leader = PathElement::new(vec![end, elbow], stroke(line.colour, 1.4));
        area.draw(&leader).map_err(say)?;
        let at = [(WIDTH - right) + NAME_INDENT, height / UNIT];
        // The leader carries the colour: pale words would be hard to read.
        write(area, &line.name, at, INK, HPos::Left)?;
    }
    Ok(())
}

/// Moves `heights` apart to at least `distance`, keeping their order and, where there is room, their mean, within
/// `range`.
fn spread(heights: &[i32], distance: i32, range: [i32; 2]) -> Vec<i32> {
    let mut order: Vec<_> = (0..heights.len()).collect();
    order.sort_by_key(|&k| heights[k]);
    // Groups of names that touch, each with its members' wanted places less their place in the group.
    let mut groups: Vec<(i64, usize)> = Vec::new();
    let top_of = |&(sum, count): &(i64, usize)| {
        let span = distance * (count as i32 - 1);
        let free = (sum / count as i64) as i32;
        free.min(range[1] - span).max(range[0])
    };
    for &k in &order {
        groups.push((i64::from(heights[k]), 1));
        while let [.., above, below] = groups[..] {
            let shift = i64::from(distance) * above.1 as i64;
            if i64::from(top_of(&above)) + shift <= i64::from(top_of(&below)) {
                break;
            }
            groups.truncate(groups.len() - 2);
            groups.push((
                above.0 + below.0 - shift * below.1 as i64,
                above.1 + below.1,
            ));
        }
    }
    let places = groups.iter().flat_map(|group| {
        let top = top_of(group);
        (0..group.1 as i32).map(move |k| top + k * distance)
    });
    let mut spread = vec![0; heights.len()];
    for (&k, place) in order.iter().zip(places) {
        spread[k] = place;
    }
    spread
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
