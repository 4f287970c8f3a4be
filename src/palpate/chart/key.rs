//! The key above a plot: a sample of each line with its name.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::panel::{Area, DrawingResult, LEFT, Line, Panel, PanelKind, write};
use super::style::{INK, UNIT, WIDTH, stroke, text_width};

/// Height of a row of text, pixels.
pub const ROW: i32 = 22;
/// Length of a sample, pixels.
const SAMPLE: i32 = 26;
/// Most named lines that have an entry.
const MOST_LINES: usize = 40;

/// The entries of a panel's key: its own, then the named lines, or evenly spaced ones of very many.
fn entries(panel: &Panel) -> impl Iterator<Item = &Line> {
    let is_named = |line: &&Line| panel.kind != PanelKind::Ranked && !line.name.is_empty();
    let named = panel.lines.iter().filter(is_named);
    let every = named.clone().count().div_ceil(MOST_LINES).max(1);
    panel.key.iter().chain(named.step_by(every))
}

/// Each entry with where it begins: pixels from the left, and its row.
fn places(panel: &Panel) -> Vec<(&Line, i32, i32)> {
    let (mut left, mut row) = (LEFT, 0);
    let mut places = Vec::new();
    for entry in entries(panel) {
        let width = SAMPLE + 8 + text_width(&entry.name) + 12;
        if left > LEFT && left + width > WIDTH {
            (left, row) = (LEFT, row + 1);
        }
        places.push((entry, left, row));
        left += width;
    }
    places
}

/// Height of the key above the plot, pixels.
pub fn key_height(panel: &Panel) -> i32 {
    places(panel)
        .last()
        .map_or(0, |(_, _, row)| (row + 1) * ROW)
}

/// Draws the key in rows from `top` on.
pub fn draw_key(area: &Area<'_>, panel: &Panel, top: i32) -> DrawingResult<()> {
    for (entry, left, row) in places(panel) {
        let middle = top + row * ROW + ROW / 2 - 4;
        let at = |x: i32| ((left + x) * UNIT, middle * UNIT);
        let (ends, style) = (vec![at(0), at(SAMPLE)], stroke(entry.colour, entry.width));
        if entry.is_area {
            let corners = [(0, -7), (SAMPLE, 7)].map(|(x, y)| (at(x).0, at(x).1 + y * UNIT));
            area.draw(&Rectangle::new(corners, entry.colour.filled()))?;
            area.draw(&Rectangle::new(corners, stroke(INK, 1.0)))?;
        } else if entry.is_dashed {
            area.draw(&DashedPathElement::new(ends, 6 * UNIT, 4 * UNIT, style))?;
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
