//! Figures 3, 4 and 9: what follows from Θ ~ N(∓γ²/2, γ²) alone.

use plotters::style::text_anchor::HPos;

use super::Figures;
use crate::report::text::{fixed, percent};
use crate::report::{Topic, paper};
use palpate::chart::chart;
use palpate::chart::style::{BLUE, GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Mark, Panel};
use palpate::detect::{DetectError, gamma_from_two_afc, required_gamma, roc_miss, two_afc};
use palpate::refusal::Refusal;
use palpate::stats::normal;

/// `count` + 1 evenly spaced numbers.
fn steps(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
}

/// Figures 3, 4 and 9.
///
/// # Errors
/// Never for the γ that are drawn; the detector's refusal is passed on all the same.
pub fn draw(figures: &mut Figures) -> Result<(), Refusal> {
    let (roc, pairs) = (
        roc().map_err(Refusal::because("figures"))?,
        pairs().map_err(Refusal::because("figures"))?,
    );
    for (prefix, panel, x_name) in [
        ("figure-3", densities(), "Statistic θ"),
        ("figure-4", roc, "False alarms Pr(e | H = 0)"),
        ("figure-9", pairs, "Signal-to-noise ratio γ"),
    ] {
        figures.add_fixed(prefix, Topic::Detection, chart(&[panel], x_name))?;
    }
    Ok(())
}

/// Figure 3: the densities of Θ under both hypotheses.
fn densities() -> Panel {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for (gamma, colour) in [1.0, 2.0, 3.0].into_iter().zip(PALETTE) {
        for sign in [-1.0, 1.0] {
            let mean = 0.5 * sign * gamma * gamma;
            // Finite for every finite argument.
            let density =
                |theta: f64| normal::density((theta - mean) / gamma).unwrap_or(0.0) / gamma;
            let points = steps(-14.0, 14.0, 140).map(|x| (x, density(x)));
            lines.push(Line::new(colour, points.collect()).dashed(sign < 0.0));
            let side = if sign < 0.0 { HPos::Right } else { HPos::Left };
            let (at, shift) = ((mean, density(mean)), (sign as i32 * 7, -9));
            marks.push(Mark::new(at, format!("γ = {gamma}"), side, shift));
        }
    }
    marks.push(Mark::new(
        (-14.0, 0.45),
        "H = 0 (dashed)",
        HPos::Left,
        (10, 16),
    ));
    marks.push(Mark::new(
        (14.0, 0.45),
        "H = 1 (solid)",
        HPos::Right,
        (-10, 16),
    ));
    let heading = "Probability density of the statistic Θ";
    Panel {
        marks,
        ..Panel::new(heading, [[-14.0, 14.0], [0.0, 0.45]], 270, lines)
    }
}

/// Figure 4: misses against false alarms.
fn roc() -> Result<Panel, DetectError> {
    let (alarms, misses) = (paper::MAX_FALSE_ALARM, paper::MAX_MISS);
    let needed = required_gamma(alarms, misses)?;
    let mut lines = vec![
        Line::new(GREY, vec![(0.0, misses), (1.0, misses)]).wide(1.0),
        Line::new(GREY, vec![(alarms, 0.0), (alarms, 1.0)]).wide(1.0),
    ];
    let dot = |at, name: &str| Mark {
        has_dot: true,
        ..Mark::new(at, name, HPos::Left, (25, 0))
    };
    let mut marks = vec![dot((alarms, misses), ""), dot((0.64, 0.66), "5 % of each")];
    for (k, (gamma, colour)) in [1.0, 2.0, 3.0, needed].into_iter().zip(PALETTE).enumerate() {
        // Squares of even steps: the curve is steep at both ends.
        let rates = steps(0.0, 1.0, 100).map(|t| t * t * (3.0 - 2.0 * t));
        let points = rates.map(|rate| Ok((rate, roc_miss(gamma, rate)?)));
        lines.push(Line::new(colour, points.collect::<Result<_, _>>()?));
        let digits = if gamma == needed { 2 } else { 0 };
        let height = 0.94 - 0.07 * k as f64;
        lines.push(Line::new(colour, vec![(0.60, height), (0.68, height)]));
        let name = format!("γ = {}", fixed(gamma, digits));
        marks.push(Mark::new((0.70, height), name, HPos::Left, (0, 0)));
    }
    Ok(Panel {
        marks,
        ..Panel::new("Misses Pr(e | H = 1)", [[0.0, 1.0]; 2], 400, lines)
    })
}

/// Figure 9: right answers in pairs, with the paper's reading of it.
fn pairs() -> Result<Panel, DetectError> {
    let curve = steps(0.0, 5.0, 200).map(|gamma| Ok((gamma, two_afc(gamma)?)));
    let (counted, printed) = (paper::ACCURACY_6_6, paper::GAMMA_OF_ACCURACY);
    let gamma = gamma_from_two_afc(counted)?;
    let at_printed = two_afc(printed)?;
    let found = vec![(0.0, counted), (gamma, counted), (gamma, 0.5)];
    let read = vec![(printed, at_printed), (printed, 0.5)];
    let lines = vec![
        Line::new(INK, curve.collect::<Result<_, _>>()?),
        Line::new(BLUE, found).dashed(true),
        Line::new(VERMILION, read).dashed(true),
    ];
    let true_words = format!("true: γ = {}", fixed(gamma, 3));
    let printed_words = format!("paper: γ = {printed}, there {}", percent(at_printed));
    let marks = vec![
        Mark::new((0.0, counted), "84 %", HPos::Left, (8, -12)),
        Mark::new((gamma, 0.53), true_words, HPos::Right, (-7, 0)),
        Mark::new((printed, 0.53), printed_words, HPos::Left, (7, 0)),
    ];
    let heading = "Probability of choosing the right one of a pair";
    Ok(Panel {
        marks,
        ..Panel::new(heading, [[0.0, 5.0], [0.5, 1.0]], 300, lines)
    })
}
