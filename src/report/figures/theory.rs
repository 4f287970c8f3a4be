//! Figures 3, 4 and 9: what follows from Θ ~ N(∓γ²/2, γ²) alone.

use plotters::style::text_anchor::HPos;

use super::chart::{Line, Mark, Panel, chart};
use super::style::{BLUE, GREY, INK, PALETTE, VERMILION};
use super::{Draft, Words};
use crate::detect::{DetectError, gamma_from_two_afc, required_gamma, roc_miss, two_afc};
use crate::report::text::{fixed, percent};
use crate::report::{Topic, paper};
use crate::stats::normal;

/// `count` + 1 evenly spaced numbers.
fn steps(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
}

fn words(at: (f64, f64), words: String, side: HPos, shift: (i32, i32)) -> Mark {
    Mark {
        at,
        has_dot: false,
        words,
        side,
        shift,
        colour: INK,
    }
}

/// Figures 3, 4 and 9.
///
/// # Errors
/// Never for the γ that are drawn; the detector's refusal is passed on all the same.
pub fn drafts() -> Result<[Draft; 3], DetectError> {
    let draft = |prefix, words, panels: Vec<Panel>, x_name| Draft {
        prefix,
        name: String::new(),
        topic: Topic::Detection,
        words,
        drawn: chart(&panels, x_name),
    };
    Ok([
        draft("figure-3", densities_words(), densities(), "Statistic θ"),
        draft(
            "figure-4",
            roc_words(),
            roc()?,
            "False alarms Pr(e | H = 0)",
        ),
        draft(
            "figure-9",
            pairs_words(),
            pairs()?,
            "Signal-to-noise ratio γ",
        ),
    ])
}

/// Figure 3: the densities of Θ under both hypotheses.
fn densities() -> Vec<Panel> {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for (gamma, colour) in [1.0, 2.0, 3.0].into_iter().zip(PALETTE) {
        for sign in [-1.0, 1.0] {
            let mean = 0.5 * sign * gamma * gamma;
            let density = |theta: f64| {
                // Finite for every finite argument.
                normal::density((theta - mean) / gamma).unwrap_or(0.0) / gamma
            };
            lines.push(Line {
                is_dashed: sign < 0.0,
                ..Line::new(
                    colour,
                    steps(-14.0, 14.0, 140).map(|x| (x, density(x))).collect(),
                )
            });
            let side = if sign < 0.0 { HPos::Right } else { HPos::Left };
            let name = format!("γ = {gamma}");
            marks.push(words(
                (mean, density(mean)),
                name,
                side,
                (sign as i32 * 7, -9),
            ));
        }
    }
    let hypotheses = [
        (-14.0, "H = 0 (dashed)", HPos::Left, 10),
        (14.0, "H = 1 (solid)", HPos::Right, -10),
    ];
    for (x, name, side, shift) in hypotheses {
        marks.push(words((x, 0.45), name.into(), side, (shift, 16)));
    }
    vec![Panel {
        heading: "Probability density of the statistic Θ".into(),
        x: [-14.0, 14.0],
        y: [0.0, 0.45],
        ticks: Vec::new(),
        height: 270,
        key: Vec::new(),
        lines,
        marks,
    }]
}

/// Figure 4: misses against false alarms.
///
/// # Errors
/// Never for these γ; the detector's refusal is passed on all the same.
fn roc() -> Result<Vec<Panel>, DetectError> {
    let needed = required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)?;
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for limit in [
        vec![(0.0, paper::MAX_MISS), (1.0, paper::MAX_MISS)],
        vec![(paper::MAX_FALSE_ALARM, 0.0), (paper::MAX_FALSE_ALARM, 1.0)],
    ] {
        lines.push(Line::new(GREY, limit).wide(1.0));
    }
    for (k, (gamma, colour)) in [1.0, 2.0, 3.0, needed].into_iter().zip(PALETTE).enumerate() {
        // Squares of even steps: the curve is steep at both ends.
        let rates = steps(0.0, 1.0, 100).map(|t| t * t * (3.0 - 2.0 * t));
        let points = rates.map(|rate| Ok((rate, roc_miss(gamma, rate)?)));
        lines.push(Line::new(colour, points.collect::<Result<_, _>>()?));
        let name = if gamma == needed {
            format!("γ = {}", fixed(gamma, 2))
        } else {
            format!("γ = {gamma}")
        };
        let height = 0.94 - 0.07 * k as f64;
        lines.push(Line::new(colour, vec![(0.60, height), (0.68, height)]));
        marks.push(words((0.70, height), name, HPos::Left, (0, 0)));
    }
    marks.push(Mark {
        at: (paper::MAX_FALSE_ALARM, paper::MAX_MISS),
        has_dot: true,
        words: String::new(),
        side: HPos::Left,
        shift: (0, 0),
        colour: INK,
    });
    marks.push(Mark {
        at: (0.64, 0.66),
        has_dot: true,
        words: "5 % of each".into(),
        side: HPos::Left,
        shift: (25, 0),
        colour: INK,
    });
    Ok(vec![Panel {
        heading: "Misses Pr(e | H = 1)".into(),
        x: [0.0, 1.0],
        y: [0.0, 1.0],
        ticks: Vec::new(),
        height: 400,
        key: Vec::new(),
        lines,
        marks,
    }])
}

/// Figure 9: right answers in pairs, with the paper's reading of it.
///
/// # Errors
/// Never for these γ; the detector's refusal is passed on all the same.
fn pairs() -> Result<Vec<Panel>, DetectError> {
    let curve = steps(0.0, 5.0, 200).map(|gamma| Ok((gamma, two_afc(gamma)?)));
    let gamma = gamma_from_two_afc(paper::ACCURACY_6_6)?;
    let printed = paper::GAMMA_OF_ACCURACY;
    let at_printed = two_afc(printed)?;
    let lines = vec![
        Line::new(INK, curve.collect::<Result<_, _>>()?),
        Line::new(
            BLUE,
            vec![
                (0.0, paper::ACCURACY_6_6),
                (gamma, paper::ACCURACY_6_6),
                (gamma, 0.5),
            ],
        )
        .dashed(),
        Line::new(VERMILION, vec![(printed, at_printed), (printed, 0.5)]).dashed(),
    ];
    let true_words = format!("true: γ = {}", fixed(gamma, 3));
    let printed_words = format!("paper: γ = {printed}, there {}", percent(at_printed));
    let marks = vec![
        words(
            (0.0, paper::ACCURACY_6_6),
            "84 %".into(),
            HPos::Left,
            (8, -12),
        ),
        words((gamma, 0.53), true_words, HPos::Right, (-7, 0)),
        words((printed, 0.53), printed_words, HPos::Left, (7, 0)),
    ];
    Ok(vec![Panel {
        heading: "Probability of choosing the right one of a pair".into(),
        x: [0.0, 5.0],
        y: [0.5, 1.0],
        ticks: Vec::new(),
        height: 300,
        key: Vec::new(),
        lines,
        marks,
    }])
}

fn densities_words() -> Words {
    Words {
        title: "Figure 3. Probability distributions of the statistic Θ".into(),
        caption: "Equation (8) for γ = 1, 2 and 3: Θ is normal with mean −γ²/2 without inclusion (dashed) and +γ²/2 \
                  with one (solid), and standard deviation γ. The text of the paper names no γ for its Figure 3, so these \
                  may be others; the law is the same."
            .into(),
        alt: "Line chart of three pairs of bell curves, mirror images about θ = 0; the larger γ, the wider and the \
              further apart."
            .into(),
    }
}

fn roc_words() -> Words {
    Words {
        title: "Figure 4. Receiver operating characteristic".into(),
        caption: "Misses against false alarms as the threshold moves, in closed form: Φ(Φ⁻¹(1 − P_fa) − γ). As in the \
                  paper's Figure 4, the point of 5 % misses and 5 % false alarms is marked (dot). The paper reads γ > 3.3 \
                  off its graph; the point lies on the curve of γ = 2Φ⁻¹(0.95) = 3.29."
            .into(),
        alt: "Line chart of misses against false alarms, four falling curves for γ from 1 to 3.29; the last runs \
              through the point with 5 % of each."
            .into(),
    }
}

fn pairs_words() -> Words {
    Words {
        title: "Figure 9. Probability of choosing correctly in pairs".into(),
        caption: "Φ(γ/√2). The paper reads γ = 1.45 off its Figure 9 for its 84 %; the curve has 84 % at γ = 1.406, \
                  and 84.7 % at 1.45."
            .into(),
        alt: "Line chart rising from one half at γ = 0 towards 1, with 84 % marked at γ = 1.406.".into(),
    }
}
