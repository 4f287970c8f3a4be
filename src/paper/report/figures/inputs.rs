//! Which input counts: tornado charts of a study.

use super::plan::{Plan, Words, over};
use crate::report::text::{fixed, joined, shortened};
use crate::report::{Run, Topic};
use crate::study::{Kind, QuantityResult, StudyResults};
use palpate::chart::style::{BLUE, VERMILION};
use palpate::chart::{Line, Panel, PanelKind, round_range};

/// What the x axis shows.
const CHANGE: &str = "Change between the quartiles of the input (%)";
/// Pixels for one input.
const ROW: i32 = 20;
/// Letters of a name that fit beside the chart.
const LETTERS: usize = 21;

/// The figure, if the run has a study: of the force without inclusion at x = 0 and of γ of each inclusion.
///
/// Implements: REP-081.
pub fn figure(run: &Run) -> Option<Plan> {
    let study = run.study.as_ref()?;
    let is_drawn = |of: &&QuantityResult| match of.quantity.kind {
        Kind::NormalForceN { .. } => of.quantity.phantom == study.plan.reference.name(),
        ref kind => *kind == Kind::Gamma,
    };
    let with_bars = |of| (of, bars(study, of));
    let drawn: Vec<_> = study.listed().filter(is_drawn).map(with_bars).collect();
    let panels = drawn.iter().map(|(of, bars)| panel(of, bars));
    let picture = over(CHANGE, panels.collect::<Vec<_>>());
    Some(Plan::new("inputs", Topic::Inputs, words(&drawn), picture))
}

/// The inputs with the change that each makes to a quantity, %.
type Bars<'a> = Vec<(&'a str, f64)>;

fn words(drawn: &[(&QuantityResult, Bars<'_>)]) -> Words {
    let largest = drawn.iter().map(|(of, bars)| {
        let longest = bars.iter().rev().take(3);
        let named = longest.map(|(name, change)| format!("{name} {} %", fixed(*change, 1)));
        format!("{}: {}", of.quantity, joined(named, ", "))
    });
    [
        "Which input counts".into(),
        "How far each number moves, in per cent, when one input goes from its lower to its upper quartile and all others stay at their \
         medians: blue up, vermilion down. The paper has no such figure."
            .into(),
        format!("Bar charts, the longest bar on top. {}.", joined(largest, "; ")),
    ]
}

/// The bars of a quantity, the shortest first.
fn bars<'a>(study: &'a StudyResults, of: &QuantityResult) -> Bars<'a> {
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
        let bar = Line::new(colour, vec![(0.0, height), (change, height)]);
        bar.wide(9.0).named(shortened(name, LETTERS))
    };
    let lines: Vec<_> = bars.iter().enumerate().map(line).collect();
    let x = round_range(bars.iter().map(|bar| bar.1));
    let count = bars.len().max(1);
    // Its change is in per cent.
    let heading = of.quantity.to_string();
    let heading = heading.strip_suffix(", N").unwrap_or(&heading);
    let (y, height) = ([0.0, count as f64], ROW * count as i32);
    Panel {
        kind: PanelKind::Ranked,
        ..Panel::new(heading, [x, y], height, lines)
    }
}
