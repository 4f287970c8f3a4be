//! Which input counts: tornado charts of a study.

use askama::Template;

use super::{Figures, words};
use crate::report::text::shortened;
use crate::report::{Run, Topic, text};
use crate::study::{Kind, QuantityResult, StudyResults};
use palpate::chart::style::{BLUE, VERMILION};
use palpate::chart::{Line, Panel};
use palpate::chart::{chart, round_range};
use palpate::refusal::Refusal;

/// What the x axis shows.
const CHANGE: &str = "Change from the lower to the upper quartile of the input (%)";
/// Pixels for one input.
const ROW: i32 = 20;
/// Letters of a name that fit beside the chart.
const LETTERS: usize = 21;

/// The figure, if the run has a study: of the force without inclusion at x = 0 and of γ of each inclusion.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-081.
pub fn draw(figures: &mut Figures, run: &Run) -> Result<(), Refusal> {
    let Some(study) = &run.study else {
        return Ok(());
    };
    let is_drawn = |of: &&QuantityResult| match of.quantity.kind {
        Kind::NormalForceN { .. } => of.quantity.phantom == study.plan.reference.name,
        ref kind => *kind == Kind::Gamma,
    };
    let drawn: Vec<_> = study.listed().filter(is_drawn).collect();
    let bars: Vec<_> = drawn.iter().map(|of| bars(study, of)).collect();
    let panels = drawn.iter().zip(&bars).map(|(of, bars)| panel(of, bars));
    let text = Text {
        drawn: &drawn,
        bars: &bars,
    };
    let panels: Vec<_> = panels.collect();
    figures.add(
        ("inputs", ""),
        Topic::Inputs,
        words!(text, as_inputs_caption, as_inputs_alt),
        chart(&panels, CHANGE),
    )
}

/// The inputs with the change that each makes to a quantity, %, the smallest first.
fn bars<'a>(study: &'a StudyResults, of: &QuantityResult) -> Vec<(&'a str, f64)> {
    let per_cent =
        |change: f64| Some(100.0 * change / of.at_medians?).filter(|part| part.is_finite());
    let slopes = study.plan.inputs.iter().zip(&of.slopes);
    let bars = slopes.filter_map(|(input, slope)| {
        Some((&*input.name, per_cent(slope.as_ref()?.between_quartiles)?))
    });
    let mut bars: Vec<_> = bars.collect();
    bars.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    bars
}

/// One bar for each input, the longest on top.
fn panel(of: &QuantityResult, bars: &[(&str, f64)]) -> Panel {
    let line = |(rank, &(name, change)): (usize, &(&str, f64))| {
        let height = rank as f64 + 0.5;
        let colour = if change < 0.0 { VERMILION } else { BLUE };
        let ends = vec![(0.0, height), (change, height)];
        Line::new(colour, ends)
            .wide(9.0)
            .named(shortened(name, LETTERS))
    };
    let lines: Vec<_> = bars.iter().enumerate().map(line).collect();
    let x = round_range(bars.iter().map(|bar| bar.1));
    let count = bars.len().max(1);
    Panel {
        is_ranked: true,
        ..Panel::new(
            of.quantity.to_string(),
            [x, [0.0, count as f64]],
            ROW * count as i32,
            lines,
        )
    }
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "inputs_title", blocks = ["inputs_caption", "inputs_alt"])]
struct Text<'a> {
    drawn: &'a [&'a QuantityResult],
    bars: &'a [Vec<(&'a str, f64)>],
}
