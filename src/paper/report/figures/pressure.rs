//! γ of a tactile array under the probe against the number of its elements.

use askama::Template;

use super::forces::label;
use super::{Figures, words};
use crate::report::pressure::times;
use crate::report::{
    ArrayFindings, Findings, GammaOfArray, MapFindings, Run, Settings, Topic, text,
};
use palpate::chart::style::{GREY, INK, PALETTE};
use palpate::chart::{Line, Panel};
use palpate::chart::{chart, round_range};
use palpate::refusal::Refusal;

/// The figure, if the run holds what an array reads.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-030.
pub fn draw(figures: &mut Figures, run: &Run, found: &Findings) -> Result<(), Refusal> {
    let maps: Vec<_> = found.arrays().collect();
    if maps.is_empty() {
        return Ok(());
    }
    let mut panels = vec![panel(
        "γ of a sweep",
        &maps,
        found,
        |map, _| map.gamma.both,
        |of| Some(of.sweep),
    )];
    let total = |_: &MapFindings, array: &ArrayFindings| array.press_of_total_force.unwrap_or(0.0);
    if maps
        .iter()
        .any(|(_, array)| array.press_of_total_force.is_some())
    {
        panels.push(panel(
            "γ of one press at x = 0",
            &maps,
            found,
            total,
            |of| of.press,
        ));
    }
    let sample = |name: &str| Line::new(INK, Vec::new()).named(name);
    panels[0].key = vec![
        sample("array").dotted(4),
        sample("total force").dashed(true),
    ];
    let text = Text {
        maps: &maps,
        found,
        settings: &run.settings,
    };
    let drawn = chart(&panels, "Elements of the array");
    figures.add(
        ("pressure", ""),
        Topic::Pressure,
        words!(text, as_pressure_caption, as_pressure_alt),
        drawn,
    )
}

/// For each map a line of its γ, a dashed one at that of the total force, and one for all at the γ that the rates need.
fn panel(
    heading: &str,
    maps: &[(&MapFindings, &ArrayFindings)],
    found: &Findings,
    total: impl Fn(&MapFindings, &ArrayFindings) -> f64,
    gamma: impl Fn(&GammaOfArray) -> Option<f64>,
) -> Panel {
    let exponent = |of: &GammaOfArray| libm::log2(of.elements as f64);
    let ticks = maps
        .first()
        .map(|(_, array)| array.arrays.iter().map(exponent));
    let ticks: Vec<f64> = ticks.into_iter().flatten().collect();
    let last = ticks.last().copied().unwrap_or(0.0);
    let x = [-0.2, last + 0.2];
    let level = |colour, y| Line::new(colour, vec![(x[0], y), (x[1], y)]).dashed(true);
    let mut lines = vec![level(GREY, found.required_gamma).named("needed")];
    for ((map, array), colour) in maps.iter().zip(PALETTE.into_iter().cycle()) {
        lines.push(level(colour, total(map, array)).wide(1.4));
        let points = array.arrays.iter();
        let points = points.filter_map(|of| Some((exponent(of), gamma(of)?)));
        lines.push(
            Line::new(colour, points.collect())
                .named(label(map))
                .dotted(4),
        );
    }
    let values = lines.iter().flat_map(|line| &line.points);
    let y = round_range(values.map(|point| point.1));
    Panel {
        ticks,
        is_doubling: true,
        ..Panel::new(heading, [x, y], 270, lines)
    }
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "pressure_title", blocks = ["pressure_caption", "pressure_alt"])]
struct Text<'a> {
    maps: &'a [(&'a MapFindings, &'a ArrayFindings)],
    found: &'a Findings,
    settings: &'a Settings,
}

impl Text<'_> {
    /// How many times the γ of a single element that of the most elements is.
    fn gained(&self) -> Option<String> {
        times(self.maps.iter().filter_map(|(_, array)| {
            let arrays = &array.arrays;
            Some([arrays.first()?.sweep, arrays.last()?.sweep])
        }))
    }
}
