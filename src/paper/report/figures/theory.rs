//! Figures 2, 3, 4 and 9: what follows from Θ ~ N(∓γ²/2, γ²) alone.

use super::plan::{Picture, Plan, over};
use crate::report::text::{fixed, percent};
use crate::report::{Topic, paper};
use palpate::chart::style::{BLUE, GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Panel};
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
    let plan = |id: &str, words: [&str; 3], picture| {
        Plan::new(id, Topic::Detection, words.map(Into::into), picture)
    };
    let problem = Picture::Finished(include_str!("figure-2.svg"), 560);
    let alarms = over("False alarms Pr(e | H = 0)", [roc()?]);
    let pairs = over("Signal-to-noise ratio γ", [pairs()?]);
    Ok([
        plan("figure-2", PROBLEM, problem),
        plan("figure-3", DENSITIES, over("Statistic θ", [densities()])),
        plan("figure-4", ROC, alarms),
        plan("figure-9", PAIRS, pairs),
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
    let mut lines = Vec::new();
    for (gamma, colour) in [1.0, 2.0, 3.0].into_iter().zip(PALETTE) {
        let curve = |mean: f64| {
            // Finite for every finite argument.
            let density = |x: f64| normal::density((x - mean) / gamma).unwrap_or(0.0) / gamma;
            let points = steps(-14.0, 14.0, 140).map(|x| (x, density(x)));
            Line::new(colour, points.collect())
        };
        let mean = 0.5 * gamma * gamma;
        lines.push(curve(-mean).dashed(true));
        lines.push(curve(mean).named(format!("γ = {gamma}")));
    }
    let sample = |name: &str| Line::new(INK, Vec::new()).named(name);
    let heading = "Probability density of the statistic Θ";
    Panel {
        key: vec![sample("H = 0").dashed(true), sample("H = 1")],
        ..Panel::new(heading, [[-14.0, 14.0], [0.0, 0.45]], 270, lines)
    }
}

/// Figure 4: misses against false alarms.
fn roc() -> Result<Panel, DetectError> {
    let (alarms, misses) = (paper::MAX_FALSE_ALARM, paper::MAX_MISS);
    let needed = required_gamma(alarms, misses)?;
    let limits = [
        [(0.0, misses), (1.0, misses)],
        [(alarms, 0.0), (alarms, 1.0)],
    ];
    let mut lines = limits
        .map(|ends| Line::new(GREY, ends.into()).wide(1.0))
        .to_vec();
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
    let heading = "Misses Pr(e | H = 1)";
    Ok(Panel::new(heading, [[0.0, 1.0]; 2], 400, lines))
}

/// Figure 9: right answers in pairs, with the paper's reading of it.
fn pairs() -> Result<Panel, DetectError> {
    let curve = steps(0.0, 5.0, 200).map(|gamma| Ok((gamma, two_afc(gamma)?)));
    let (counted, printed) = (paper::ACCURACY_6_6, paper::GAMMA_OF_ACCURACY);
    let gamma = gamma_from_two_afc(counted)?;
    let at_printed = two_afc(printed)?;
    let found = vec![(0.0, counted), (gamma, counted), (gamma, 0.5)];
    let read = vec![(printed, at_printed), (printed, 0.5)];
    let [found_words, read_words] = [
        format!("84 % at γ = {}", fixed(gamma, 3)),
        format!("paper: γ = {printed}, there {}", percent(at_printed)),
    ];
    let dashed = |colour, points, words| Line::new(colour, points).dashed(true).named(words);
    let lines = vec![
        Line::new(INK, curve.collect::<Result<_, _>>()?),
        dashed(BLUE, found, found_words),
        dashed(VERMILION, read, read_words),
    ];
    let heading = "Probability of choosing the right one of a pair";
    Ok(Panel::new(heading, [[0.0, 5.0], [0.5, 1.0]], 300, lines))
}
