//! The answer of `palpate psychophysics` for people. Its words are in `templates/cli/psychophysics.txt`.

use askama::Template;

use super::psychophysics::Answer;
use crate::psychophysics::{Bounds, ConditionAnalysis, OpenBounds, Parameter};

/// The whole answer.
///
/// Implements: CLI-084.
pub fn text(answer: &Answer) -> String {
    let (counts, confidence) = (&answer.counts, 100.0 * answer.analysis.confidence);
    let words = Text { answer }.render();
    // Writing to a String does not fail.
    let words = words.expect("lines of text and numbers");
    let lines: Vec<&str> = words.trim_end().lines().collect();
    let blocks = lines.chunk_by(|one, other| one.contains('\t') == other.contains('\t'));
    let text: String = blocks.map(columns).collect();
    format!("{counts}: shares of right answers with intervals of {confidence} %\n\n{text}")
}

/// Lines as they are, or rows with their cells left-aligned in columns; a row may have fewer than others.
fn columns(lines: &[&str]) -> String {
    let rows = lines
        .iter()
        .map(|line| line.split('\t').collect::<Vec<_>>());
    let rows: Vec<_> = rows.collect();
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let line = |row: &Vec<&str>| {
        if let [line] = row[..] {
            return format!("{line}\n");
        }
        let cells = row.iter().enumerate();
        let padded = cells.map(|(column, cell)| format!("{cell:<0$}", width(column)));
        let line = format!("  {}", padded.collect::<Vec<_>>().join("  "));
        line.trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

#[derive(Template)]
#[template(path = "cli/psychophysics.txt")]
struct Text<'a> {
    answer: &'a Answer,
}

fn has_rough_p(condition: &ConditionAnalysis) -> bool {
    let mut dispersions = condition.inclusions.iter().filter_map(|of| of.dispersion);
    dispersions.any(|found| found.is_rough)
}

fn parameter(found: &Parameter, scale: f64, digits: usize) -> String {
    let ends = [&found.bounds, &found.dispersed_bounds];
    let [bounds, dispersed] = ends.map(|of| open(of, scale, digits));
    let value = scale * found.value;
    format!("{value:.digits$} {bounds}, with the subjects' dispersion {dispersed}")
}

fn bounds(found: &Bounds) -> String {
    format!("[{:.3}, {:.3}]", found.lower, found.upper)
}

/// An interval times `scale`; an end that is missing is said to be.
fn open(found: &OpenBounds, scale: f64, digits: usize) -> String {
    let end =
        |end: Option<f64>| end.map_or("no bound".into(), |end| format!("{:.digits$}", scale * end));
    format!("[{}, {}]", end(found.lower), end(found.upper))
}

fn p_value(p: &Option<f64>) -> String {
    p.as_ref().map_or("-".into(), known_p)
}

fn known_p(p: &f64) -> String {
    match *p < 1e-3 {
        true => format!("{p:.0e}"),
        false => format!("{p:.3}"),
    }
}
