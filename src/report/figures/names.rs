//! What stands around a plot: the names of its lines at the right, and the key above it.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::chart::{Area, Context, DrawingResult, LEFT, Line, Panel, say, write};
use super::style::{INK, UNIT, WIDTH, stroke, text_width};

/// Least distance between two names at the right, pixels.
const NAME_DISTANCE: i32 = 18;
/// Distance from a plot to the names at its right, pixels.
pub const NAME_INDENT: i32 = 20;
/// Most names beside one plot.
const MOST_NAMES: usize = 40;
/// Height of a row of the key, pixels.
const KEY_ROW: i32 = 22;
/// Length of a sample in the key, pixels.
const SAMPLE: i32 = 26;

/// The names of a panel's lines that stand at the right, not more than fit.
pub fn names(panel: &Panel) -> Vec<&Line> {
    let named: Vec<_> = panel
        .lines
        .iter()
        .filter(|line| !line.name.is_empty())
        .collect();
    let every = named.len().div_ceil(MOST_NAMES).max(1);
    named.into_iter().step_by(every).collect()
}

/// Height of a plot that has room for all its names, pixels.
pub fn plot_height(panel: &Panel) -> i32 {
    panel
        .height
        .max(NAME_DISTANCE * (names(panel).len() as i32 + 1))
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
        let dashes: &[[i32; 2]] = if entry.is_dashed {
            &[[0, 6], [10, 16], [20, SAMPLE]]
        } else {
            &[[0, SAMPLE]]
        };
        for &[from, to] in dashes.iter().filter(|_| entry.width > 0.0) {
            let sample =
                PathElement::new(vec![at(from), at(to)], stroke(entry.colour, entry.width));
            area.draw(&sample).map_err(say)?;
        }
        if entry.dot > 0 {
            let filled = ShapeStyle::from(&entry.colour).filled();
            let dot = Circle::new(at(SAMPLE / 2), entry.dot * UNIT, filled);
            area.draw(&dot).map_err(say)?;
        }
        write(
            area,
            &entry.name,
            [left + SAMPLE + 8, middle],
            INK,
            HPos::Left,
        )?;
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
        area.draw(&leader).map_err(say)?;
        let at = [(WIDTH - right) + NAME_INDENT, height / UNIT];
        // The leader carries the colour: pale words would be hard to read.
        write(area, &line.name, at, INK, HPos::Left)?;
    }
    Ok(())
}

/// Moves `heights` apart to at least `distance`, keeping their order and, where there is room, their mean, within
/// `range`.
pub fn spread(heights: &[i32], distance: i32, range: [i32; 2]) -> Vec<i32> {
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
