//! Figures 2, 3, 4 and 9: what follows from Θ ~ N(∓γ²/2, γ²) alone.

use plotters::style::text_anchor::HPos;

use super::plan::{Picture, Plan, Words};
use crate::report::text::{fixed, percent};
use crate::report::{Topic, paper};
use palpate::chart::style::{BLUE, GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Mark, Panel};
use palpate::detect::{DetectError, gamma_from_two_afc, required_gamma, roc_miss, two_afc};
use palpate::stats::normal;

/// `count` + 1 evenly spaced numbers.
fn steps(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
}

/// Figures 2, 3, 4 and 9, which are the same for every run.
///
/// # Errors
/// Never for the γ that are drawn; the detector's refusal is passed on all the same.
pub fn figures() -> Result<[Plan; 4], DetectError> {
    let plan = |id: &str, x_name: &str, panels: Vec<Panel>, [title, caption, alt]: [&str; 3]| {
        let words = Words::new(title, caption, alt);
        Plan::new(id, Topic::Detection, words, panels, x_name)
    };
    Ok([
        Plan {
            picture: Picture::Finished(include_str!("figure-2.svg"), 560),
            ..plan("figure-2", "", Vec::new(), PROBLEM)
        },
        plan("figure-3", "Statistic θ", vec![densities()], DENSITIES),
        plan("figure-4", "False alarms Pr(e | H = 0)", vec![roc()?], ROC),
        plan("figure-9", "Signal-to-noise ratio γ", vec![pairs()?], PAIRS),
    ])
}

/// Title, caption and alternative text of Figure 2.
const PROBLEM: [&str; 3] = [
    "Figure 2. The signal detection problem",
    "From the probe's path to a decision; the numbers are those of the paper's equations. The paper's Figure 2 shows the same signals X, F \
     and Fₚ around a human observer. Here the observer is the matched filter that the paper proposes for him, with each of its steps.",
    "A chain of boxes. The trajectory X(t) moves the probe over the gel, which holds an inclusion or none; the force F(t), with noise added, \
     is the perceived force. Two matched filters give Y(0), then the statistic θ, which is compared with the threshold η to give the decision \
     Ĥ.",
];

/// Those of Figure 3.
const DENSITIES: [&str; 3] = [
    "Figure 3. Probability distributions of the statistic Θ",
    "Equation (8) for γ = 1, 2 and 3: Θ is normal with mean −γ²/2 without inclusion (dashed) and +γ²/2 with one (solid), and standard \
     deviation γ. The text of the paper names no γ for its Figure 3, so these may be others; the law is the same.",
    "Line chart of three pairs of bell curves, mirror images about θ = 0; the larger γ, the wider and the further apart.",
];

/// Those of Figure 4.
const ROC: [&str; 3] = [
    "Figure 4. Receiver operating characteristic",
    "Misses against false alarms as the threshold moves, in closed form: Φ(Φ⁻¹(1 − P_fa) − γ). As in the paper's Figure 4, the point of 5 % \
     misses and 5 % false alarms is marked (dot). The paper reads γ > 3.3 off its graph; the point lies on the curve of γ = 2Φ⁻¹(0.95) = \
     3.29.",
    "Line chart of misses against false alarms, four falling curves for γ from 1 to 3.29; the last runs through the point with 5 % of each.",
];

/// Those of Figure 9.
const PAIRS: [&str; 3] = [
    "Figure 9. Probability of choosing correctly in pairs",
    "Φ(γ/√2). The paper reads γ = 1.45 off its Figure 9 for its 84 %; the curve has 84 % at γ = 1.406, and 84.7 % at 1.45.",
    "Line chart rising from one half at γ = 0 towards 1, with 84 % marked at γ = 1.406.",
];

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
    for (gamma, colour) in [1.0, 2.0, 3.0, needed].into_iter().zip(PALETTE) {
        // Squares of even steps: the curve is steep at both ends.
        let rates = steps(0.0, 1.0, 100).map(|t| t * t * (3.0 - 2.0 * t));
        let points = rates.map(|rate| Ok((rate, roc_miss(gamma, rate)?)));
        let digits = if gamma == needed { 2 } else { 0 };
        let line = Line::new(colour, points.collect::<Result<_, _>>()?);
        lines.push(line.named(format!("γ = {}", fixed(gamma, digits))));
    }
    let dot = Line::new(INK, vec![(alarms, misses)]).wide(0.0).dotted(5);
    lines.push(dot.named("5 % of each"));
    Ok(Panel::new(
        "Misses Pr(e | H = 1)",
        [[0.0, 1.0]; 2],
        400,
        lines,
    ))
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
