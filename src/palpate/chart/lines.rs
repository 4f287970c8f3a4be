//! Line charts: panels below one another, each with a key above it.

use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::key::{ROW, draw_key, key_height};
use super::panel::{
    Area, Cells, Context, DrawingResult, LEFT, Line, Panel, PanelKind, RIGHT, write,
};
use super::style::{GRID, INK, UNIT, WIDTH, stroke, text, text_width};
use super::with_head;
use crate::refusal::Refusal;
use crate::text::{extremes, trimmed};

/// Pixels from a plot to the names at its right.
const INDENT: i32 = 8;
/// Pixels above a plot for its heading.
const HEADING: i32 = 40;
/// Pixels below a plot for the numbers of its x axis.
const NUMBERS: i32 = 28;
/// Pixels at the bottom of the figure for the name of the x axis.
const FOOTING: i32 = 34;

/// The least and greatest x, the extent of y and the pixels down of a drawing with equal scales on both axes that holds `x` and
/// `high`: what would be higher than 600 pixels gets more room beside it, and what would be lower than `least` more above or below.
pub fn with_room(x: [f64; 2], high: f64, least: f64) -> ([f64; 2], f64, i32) {
    let (width, wide) = (f64::from(WIDTH - LEFT - RIGHT), x[1] - x[0]);
    let high = high.max(least / width * wide);
    let aside = 0.5 * (width / 600.0 * high - wide).max(0.0);
    let x = [x[0] - aside, x[1] + aside];
    let scale = width / (x[1] - x[0]);
    let height = (scale * high).ceil();
    // Whole pixels hold a little more than was asked for.
    (x, height / scale, height as i32)
}

impl Panel {
    /// A drawing with equal scales on both axes that holds all of its areas and has some room above them. What is very
    /// flat or very tall gets more room around it.
    pub fn to_scale(cells: Vec<Cells>, lines: Vec<Line>) -> Panel {
        let areas = lines.iter().filter(|line| line.is_area);
        let in_cells = cells.iter().flat_map(|of| of.areas.iter().flatten());
        let corners = in_cells.chain(areas.flat_map(|line| &line.points));
        let x = extremes(corners.clone().map(|corner| corner.0)).unwrap_or([-1.0, 1.0]);
        let mut y = extremes(corners.map(|corner| corner.1)).unwrap_or([-1.0, 1.0]);
        y[1] += 0.02 * (y[1] - y[0]);
        let (x, high, height) = with_room(x, y[1] - y[0], 60.0);
        y[1] = y[0] + high;
        Panel {
            heading: "Height y (mm)".into(),
            x,
            y,
            kind: PanelKind::ToScale,
            height,
            cells,
            lines,
            ..Panel::default()
        }
    }

    /// The bars whose names stand right of the plot.
    fn ranked(&self) -> &[Line] {
        match self.kind {
            PanelKind::Ranked => &self.lines,
            _ => &[],
        }
    }

    /// Pixels right of the plot.
    fn right(&self) -> i32 {
        let names = self.ranked().iter().map(|line| text_width(&line.name));
        names.max().map_or(RIGHT, |widest| INDENT + widest + 8)
    }

    /// Pixels from its top to the top of its heading.
    fn caption_height(&self) -> i32 {
        self.caption_lines().len() as i32 * ROW
    }

    /// The caption in lines as wide as the figure.
    fn caption_lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for sentence in &self.caption {
            lines.push(String::new());
            for word in sentence.split(' ') {
                let line = lines.last().map_or("", |line| line);
                let longer = format!("{line} {word}");
                match lines.last_mut() {
                    Some(line) if text_width(&longer) <= WIDTH => *line = longer,
                    _ => lines.push(format!(" {word}")),
                }
            }
        }
        lines
    }

    /// Pixels from its top to the bottom of the name of its x axis.
    fn whole_height(&self) -> i32 {
        let footing = if self.x_name.is_empty() { 0 } else { FOOTING };
        let above = self.caption_height() + HEADING + key_height(self);
        above + self.height + NUMBERS + footing
    }
}

/// Draws panels below one another, for a file name, a title and an alternative text, as an SVG document.
///
/// # Errors
/// The library refused to draw.
pub fn chart(panels: &[Panel], words: [&str; 3]) -> Result<String, Refusal> {
    let drawn = drawn(panels).map_err(Refusal::because(format!("figure {:?}", words[1])));
    let (svg, height) = drawn?;
    with_head(&svg, height, words)
}

/// The panels as SVG, and its height, pixels.
fn drawn(panels: &[Panel]) -> DrawingResult<(String, i32)> {
    let height = panels.iter().map(Panel::whole_height).sum();
    let right = panels.iter().map(Panel::right).max().unwrap_or(RIGHT);
    let (mut svg, mut paths) = (String::new(), String::new());
    let size = ((WIDTH * UNIT) as u32, (height * UNIT) as u32);
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        area.fill(&WHITE)?;
        let mut top = 0;
        for panel in panels {
            paths += &draw_panel(&area, panel, top, right)?;
            top += panel.whole_height();
            if !panel.x_name.is_empty() {
                let at = [LEFT + (WIDTH - LEFT - right) / 2, top - FOOTING / 2];
                write(&area, &panel.x_name, at, HPos::Center)?;
            }
        }
        area.present()?;
    }
    // The paths stand directly over the white ground, which is the first element that the library closes.
    Ok((svg.replacen("/>\n", &format!("/>\n{paths}"), 1), height))
}

/// Draws a panel but for its cells, and gives those as paths.
fn draw_panel(area: &Area<'_>, panel: &Panel, top: i32, right: i32) -> DrawingResult<String> {
    for (row, line) in (0..).zip(panel.caption_lines()) {
        write(
            area,
            line.trim_start(),
            [8, top + ROW * row + ROW / 2 + 6],
            HPos::Left,
        )?;
    }
    let top = top + panel.caption_height();
    write(area, &panel.heading, [8, top + 22], HPos::Left)?;
    let plot = top + HEADING + key_height(panel);
    let mut chart = axes(area, panel, plot, right)?;
    for line in &panel.lines {
        draw_line(&mut chart, line)?;
    }
    draw_key(area, panel, top + HEADING - 4)?;
    for line in panel.ranked() {
        let (_, y) = chart.backend_coord(&line.points.first().copied().unwrap_or_default());
        let at = [WIDTH - right + INDENT, y / UNIT];
        write(area, &line.name, at, HPos::Left)?;
    }
    Ok(panel.cells.iter().map(|of| path(&chart, of)).collect())
}

/// All cells of a colour as one path, which keeps the file small: the library would write one tag for each.
fn path(chart: &Context<'_>, Cells { fill, edge, areas }: &Cells) -> String {
    let outline = |corners: &Vec<(f64, f64)>| {
        let place = |corner| {
            let (x, y) = chart.backend_coord(corner);
            format!("{x} {y}")
        };
        let places: Vec<_> = corners.iter().map(place).collect();
        format!("M{}Z", places.join("L"))
    };
    let outlines: String = areas.iter().map(outline).collect();
    let [fill, edge] = [fill, edge].map(|RGBColor(r, g, b)| format!("#{r:02X}{g:02X}{b:02X}"));
    format!(
        "<path d=\"{outlines}\" fill=\"{fill}\" stroke=\"{edge}\" stroke-width=\"4\" stroke-linejoin=\"round\"/>\n"
    )
}

/// Axes with numbers around a plot that begins at `top` and ends `right` before the edge (pixels).
fn axes<'a>(area: &Area<'a>, panel: &Panel, top: i32, right: i32) -> DrawingResult<Context<'a>> {
    let place = |pixels: i32| pixels * UNIT;
    let (x, y, height) = (panel.x, panel.y, panel.height);
    let size = (place(WIDTH - right), place(height + NUMBERS));
    let sub = area.clone().shrink((0, place(top)), size);
    let mut chart = ChartBuilder::on(&sub)
        .set_label_area_size(LabelAreaPosition::Left, place(LEFT))
        .set_label_area_size(LabelAreaPosition::Bottom, place(NUMBERS))
        .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
    let (grid, heights) = (stroke(GRID, 1.0), (height / 40).max(2) as usize);
    let (grid, heights) = match panel.kind {
        PanelKind::Chart => (grid, heights),
        PanelKind::Ranked => (grid, 0),
        PanelKind::ToScale => (TRANSPARENT.stroke_width(0), heights),
    };
    let number = |range: [f64; 2]| move |value: &f64| tick(*value, range);
    let [of_x, of_y] = [x, y].map(number);
    chart
        .configure_mesh()
        .x_labels(if panel.ticks.is_empty() { 6 } else { 0 })
        .y_labels(heights)
        .x_label_formatter(&of_x)
        .y_label_formatter(&of_y)
        .label_style(text(INK, HPos::Center))
        .axis_style(stroke(INK, 1.0))
        .bold_line_style(grid)
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(place(5))
        .draw()?;
    for &at_tick in &panel.ticks {
        let foot = chart.backend_coord(&(at_tick, y[0]));
        let top = chart.backend_coord(&(at_tick, y[1]));
        area.draw(&PathElement::new(vec![top, foot], grid))?;
        let end = (foot.0, foot.1 + place(5));
        area.draw(&PathElement::new(vec![foot, end], stroke(INK, 1.0)))?;
        let at = [foot.0 / UNIT, foot.1 / UNIT + 15];
        write(area, &of_x(&at_tick), at, HPos::Center)?;
    }
    Ok(chart)
}

/// The number at a tick of an axis: in full, or by its power of ten where that is too long for its place or leaves no digit.
///
/// Implements: REP-031.
fn tick(value: f64, [low, high]: [f64; 2]) -> String {
    /// Most characters of a number in full.
    const MOST: usize = 7;
    let full = trimmed(value, 6);
    // Ticks are sums, which miss 0 by rounding.
    let is_zero = value.abs() <= 1e-9 * (high - low).abs();
    if is_zero || (full.chars().count() <= MOST && full != "0") {
        return full;
    }
    // Three digits, without the zeros behind them.
    let rounded = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{rounded:e}").replace('-', "−")
}

fn draw_line(chart: &mut Context<'_>, line: &Line) -> DrawingResult<()> {
    let (style, filled) = (stroke(line.colour, line.width), line.colour.filled());
    let points = line.points.iter().copied();
    if line.is_area {
        let outline = points.clone().chain(points.clone().take(1));
        chart.draw_series([Polygon::new(line.points.clone(), filled)])?;
        chart.draw_series(LineSeries::new(outline, stroke(INK, 1.2)))?;
        return Ok(());
    }
    // A curve of a single point would not be seen.
    let radius = match line.points.len() {
        1 if line.width > 0.0 && line.dot == 0 => 4,
        _ => line.dot,
    };
    if radius > 0 {
        let dot = |at| Circle::new(at, radius * UNIT, filled);
        chart.draw_series(points.clone().map(dot))?;
    }
    if line.width > 0.0 && line.is_dashed {
        chart.draw_series(DashedLineSeries::new(points, 6 * UNIT, 4 * UNIT, style))?;
    } else if line.width > 0.0 {
        chart.draw_series(LineSeries::new(points, style))?;
    }
    Ok(())
}

/// The least range of round numbers that holds all `values`, and 0, and is not empty.
pub fn round_range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, greatest] = extremes(values.chain([0.0])).unwrap_or_default();
    let span = greatest - least;
    // Less than a piconewton is rounding, and an overflow has no scale.
    if span < 1e-12 || !span.is_finite() {
        return [-1.0, 1.0];
    }
    // The step is 1, 2 or 5 times a power of ten, a tenth of the span or a little more.
    let power = libm::pow(10.0, libm::floor(libm::log10(span / 10.0)));
    let mut steps = [1.0, 2.0, 5.0].map(|factor| factor * power).into_iter();
    let step = steps.find(|step| step * 10.0 >= span);
    let step = step.unwrap_or(10.0 * power);
    [
        libm::floor(least / step) * step,
        libm::ceil(greatest / step) * step,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: REP-031.
    #[test]
    fn a_curve_of_one_point_is_a_dot() {
        let curve = |points| {
            chart(
                &[Panel::new(
                    "F (N)",
                    [[0.0, 1.0]; 2],
                    200,
                    vec![Line::new(INK, points)],
                )],
                ["a", "b", "c"],
            )
        };
        let dots = |points| curve(points).unwrap().matches("<circle").count();
        assert_eq!(
            [dots(vec![(0.5, 0.5)]), dots(vec![(0.5, 0.5), (1.0, 0.5)])],
            [1, 0]
        );
        let line = Line::new(INK, vec![(0.5, 0.5)]).dotted(2);
        let panel = Panel::new("F (N)", [[0.0, 1.0]; 2], 200, vec![line]);
        let svg = chart(&[panel], ["a", "b", "c"]).unwrap();
        assert!(svg.contains(&format!("r=\"{}\"", 2 * UNIT)), "{svg}");
    }

    // Verifies: REP-031.
    #[test]
    fn the_numbers_of_an_axis_differ_however_small_they_are() {
        let line = Line::new(INK, vec![(0.0, 0.0), (0.1, 1e-3)]);
        let panel = Panel::new("F (N)", [[0.0, 0.1], [0.0, 1e-3]], 200, vec![line]);
        let svg = chart(&[panel], ["a", "b", "c"]).unwrap();
        let words = svg.split(">\n").filter_map(|rest| rest.split('\n').next());
        let mut numbers: Vec<&str> = words.filter(|word| word.parse::<f64>().is_ok()).collect();
        let all = numbers.len();
        numbers.sort_unstable();
        numbers.dedup();
        // 0 stands at both axes.
        assert!(all >= 8 && numbers.len() == all - 1, "{numbers:?}");
    }

    // Verifies: REP-031.
    #[test]
    fn a_number_of_an_axis_is_short_and_none_but_0_reads_0() {
        for (value, text) in [
            (0.0, "0"),
            (-0.25, "−0.25"),
            (0.00015, "0.00015"),
            (-0.000125, "−1.25e−4"),
            (-2e-8, "−2e−8"),
            (123_456.0, "123456"),
            (-1.65e9, "−1.65e9"),
            (-1e-5, "−1e−5"),
            (9.999e-8, "1e−7"),
        ] {
            assert_eq!(tick(value, [-2.0 * value.abs(), 2.0 * value.abs()]), text);
            // 5 pixels of the mark at the tick, 5 beside it.
            assert!(text_width(text) + 10 <= LEFT, "{text}");
        }
        // −0.2 + 0.1 + 0.1, by rounding.
        assert_eq!(tick(2.8e-17, [-0.2, 0.2]), "0");
    }
}
