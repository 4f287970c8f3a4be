//! What stands around a plot: the names of its lines at the right, and the key above it.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::panel::{Area, Context, DrawingResult, LEFT, Line, Panel, write};
use super::style::{INK, UNIT, WIDTH, stroke, text_width};

/// Least distance between two names at the right, pixels.
const NAME_DISTANCE: i32 = 18;
/// Distance from a plot to the names at its right, pixels.
const NAME_INDENT: i32 = 20;
/// Most names beside one plot.
const MOST_NAMES: usize = 40;
/// Height of a row of the key, pixels.
const KEY_ROW: i32 = 22;
/// Length of a sample in the key, pixels.
const SAMPLE: i32 = 26;

/// The names of lines that stand at the right, not more than fit.
fn names(panel: &Panel) -> Vec<&Line> {
    let named = panel.lines.iter().filter(|line| !line.name.is_empty());
    let named: Vec<_> = named.collect();
    let most = match panel.is_to_scale {
        true => (panel.height / NAME_DISTANCE - 1).max(1) as usize,
        false => MOST_NAMES,
    };
    let every = named.len().div_ceil(most).max(1);
    named.into_iter().step_by(every).collect()
}

/// Height of a plot that has room for all its names, pixels.
pub fn plot_height(panel: &Panel) -> i32 {
    panel
        .height
        .max(NAME_DISTANCE * (names(panel).len() as i32 + 1))
}

/// Pixels right of a plot for the names of these lines.
pub fn right_margin(lines: &[Line]) -> i32 {
    let named = lines.iter().filter(|line| !line.name.is_empty());
    let widths = named.map(|line| NAME_INDENT + text_width(&line.name) + 8);
    widths.max().unwrap_or(0).clamp(24, WIDTH / 3)
}

/// Where each entry of the key begins: pixels from the left, and its row.
fn key_places(panel: &Panel) -> Vec<(i32, i32)> {
    let (mut left, mut row) = (LEFT, 0);
    let place = |entry: &Line| {
        let width = SAMPLE + 8 + text_width(&entry.name) + 12;
        if left > LEFT && left + width > WIDTH {
            (left, row) = (LEFT, row + 1);
        }
        left += width;
        (left - width, row)
    };
    panel.key.iter().map(place).collect()
}

/// Height of the key above the plot, pixels.
pub fn key_height(panel: &Panel) -> i32 {
    key_places(panel)
        .last()
        .map_or(0, |(_, row)| (row + 1) * KEY_ROW)
}

/// Draws a sample of each kind of line with its name, in rows from `top` on.
pub fn draw_key(area: &Area<'_>, panel: &Panel, top: i32) -> DrawingResult<()> {
    for (entry, (left, row)) in panel.key.iter().zip(key_places(panel)) {
        let middle = top + row * KEY_ROW + KEY_ROW / 2 - 4;
        let at = |x: i32| ((left + x) * UNIT, middle * UNIT);
        let (ends, style) = (vec![at(0), at(SAMPLE)], stroke(entry.colour, entry.width));
        if entry.is_area {
            let corners = [(0, -7), (SAMPLE, 7)].map(|(x, y)| (at(x).0, at(x).1 + y * UNIT));
            area.draw(&Rectangle::new(corners, entry.colour.filled()))?;
            area.draw(&Rectangle::new(corners, stroke(INK, 1.0)))?;
        } else if entry.is_dashed {
            area.draw(&plotters::element::DashedPathElement::new(
                ends,
                6 * UNIT,
                4 * UNIT,
                style,
            ))?;
        } else if entry.width > 0.0 {
            area.draw(&PathElement::new(ends, style))?;
        }
        if entry.dot > 0 {
            let filled = entry.colour.filled();
            area.draw(&Circle::new(at(SAMPLE / 2), entry.dot * UNIT, filled))?;
        }
        write(area, &entry.name, [left + SAMPLE + 8, middle], HPos::Left)?;
    }
    Ok(())
}

/// Writes each line's name right of the plot at the height of its last point, pushed apart where they would
/// overlap, with a thin leader from the one to the other.
pub fn draw_names(
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
        area.draw(&leader)?;
        let at = [(WIDTH - right) + NAME_INDENT, height / UNIT];
        // The leader carries the colour: pale words would be hard to read.
        write(area, &line.name, at, HPos::Left)?;
    }
    Ok(())
}

/// Moves `heights` apart to at least `distance`, keeping their order, within `range` as far as there is room: halfway between
/// where they come to stand if the lower ones give way and if the upper ones do.
fn spread(heights: &[i32], distance: i32, range: [i32; 2]) -> Vec<i32> {
    let mut order: Vec<_> = (0..heights.len()).collect();
    order.sort_by_key(|&k| heights[k]);
    // Less the place in a row without gaps, in which a name is to stand no higher than the one above it.
    let offset = |row: usize| distance * row as i32;
    let wanted = order.iter().enumerate();
    let wanted: Vec<_> = wanted.map(|(row, &k)| heights[k] - offset(row)).collect();
    let bottom = (range[1] - offset(heights.len().saturating_sub(1))).max(range[0]);
    let mut spread = vec![0; heights.len()];
    for (row, &k) in order.iter().enumerate() {
        let above = wanted[..=row].iter().max();
        let below = wanted[row..].iter().min();
        let middle = above.zip(below).map_or(0, |(a, b)| i32::midpoint(*a, *b));
        spread[k] = middle.clamp(range[0], bottom) + offset(row);
    }
    spread
}
