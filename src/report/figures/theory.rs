//! Figures 3, 4 and 9: what follows from Θ ~ N(∓γ²/2, γ²) alone.

use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::chart::{Line, Mark, Panel};
use super::style::{BLUE, INK, OKABE_ITO, VERMILION};
use crate::detect::{DetectError, gamma_from_two_afc, required_gamma, roc_miss, two_afc};
use crate::report::paper;
use crate::report::text::{fixed, percent};
use crate::stats::normal;

/// `count` + 1 evenly spaced numbers.
fn steps(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
}

fn line(name: &str, colour: RGBColor, points: Vec<(f64, f64)>) -> Line {
    Line {
        name: name.into(),
        colour,
        is_dashed: false,
        points,
    }
}

fn dashed(colour: RGBColor, points: Vec<(f64, f64)>) -> Line {
    Line {
        is_dashed: true,
        ..line("", colour, points)
    }
}

fn words(at: (f64, f64), words: String, side: HPos, shift: (i32, i32), colour: RGBColor) -> Mark {
    Mark {
        at,
        has_dot: false,
        words,
        side,
        shift,
        colour,
    }
}

/// Figure 3: the densities of Θ under both hypotheses.
pub fn densities() -> Vec<Panel> {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for (gamma, colour) in [1.0, 2.0, 3.0].into_iter().zip(OKABE_ITO) {
        for sign in [-1.0, 1.0] {
            let mean = 0.5 * sign * gamma * gamma;
            let density = |theta: f64| {
                // Finite for every finite argument.
                normal::density((theta - mean) / gamma).unwrap_or(0.0) / gamma
            };
            lines.push(Line {
                is_dashed: sign < 0.0,
                ..line(
                    "",
                    colour,
                    steps(-14.0, 14.0, 280).map(|x| (x, density(x))).collect(),
                )
            });
            let side = if sign < 0.0 { HPos::Right } else { HPos::Left };
            let name = format!("γ = {gamma}");
            marks.push(words(
                (mean, density(mean)),
                name,
                side,
                (sign as i32 * 7, -9),
                colour,
            ));
        }
    }
    let hypotheses = [
        (-14.0, "H = 0 (dashed)", HPos::Left, 10),
        (14.0, "H = 1 (solid)", HPos::Right, -10),
    ];
    for (x, name, side, shift) in hypotheses {
        marks.push(words((x, 0.45), name.into(), side, (shift, 16), INK));
    }
    vec![Panel {
        heading: "Probability density of the statistic Θ".into(),
        x: [-14.0, 14.0],
        y: [0.0, 0.45],
        height: 270,
        lines,
        marks,
    }]
}

/// Figure 4: misses against false alarms.
///
/// # Errors
/// Never for these γ; the detector's refusal is passed on all the same.
pub fn roc() -> Result<Vec<Panel>, DetectError> {
    let needed = required_gamma(paper::MAX_FALSE_ALARM, paper::MAX_MISS)?;
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for limit in [
        vec![(0.0, paper::MAX_MISS), (1.0, paper::MAX_MISS)],
        vec![(paper::MAX_FALSE_ALARM, 0.0), (paper::MAX_FALSE_ALARM, 1.0)],
    ] {
        lines.push(line("", RGBColor(170, 176, 184), limit));
    }
    for (k, (gamma, colour)) in [1.0, 2.0, 3.0, needed]
        .into_iter()
        .zip(OKABE_ITO)
        .enumerate()
    {
        // Squares of even steps: the curve is steep at both ends.
        let rates = steps(0.0, 1.0, 100).map(|t| t * t * (3.0 - 2.0 * t));
        let points = rates.map(|rate| Ok((rate, roc_miss(gamma, rate)?)));
        lines.push(line("", colour, points.collect::<Result<_, _>>()?));
        let name = if gamma == needed {
            format!("γ = {}", fixed(gamma, 2))
        } else {
            format!("γ = {gamma}")
        };
        let height = 0.94 - 0.07 * k as f64;
        lines.push(line("", colour, vec![(0.60, height), (0.68, height)]));
        marks.push(words((0.70, height), name, HPos::Left, (0, 0), INK));
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
        height: 400,
        lines,
        marks,
    }])
}

/// Figure 9: right answers in pairs, with the paper's reading of it.
///
/// # Errors
/// Never for these γ; the detector's refusal is passed on all the same.
pub fn pairs() -> Result<Vec<Panel>, DetectError> {
    let curve = steps(0.0, 5.0, 200).map(|gamma| Ok((gamma, two_afc(gamma)?)));
    let gamma = gamma_from_two_afc(paper::ACCURACY_6_6)?;
    let printed = paper::GAMMA_OF_ACCURACY;
    let at_printed = two_afc(printed)?;
    let lines = vec![
        line("", INK, curve.collect::<Result<_, _>>()?),
        dashed(
            BLUE,
            vec![
                (0.0, paper::ACCURACY_6_6),
                (gamma, paper::ACCURACY_6_6),
                (gamma, 0.5),
            ],
        ),
        dashed(VERMILION, vec![(printed, at_printed), (printed, 0.5)]),
    ];
    let true_words = format!("true: γ = {}", fixed(gamma, 3));
    let printed_words = format!("paper: γ = {printed}, there {}", percent(at_printed));
    let marks = vec![
        words(
            (0.0, paper::ACCURACY_6_6),
            "84 %".into(),
            HPos::Left,
            (8, -12),
            BLUE,
        ),
        words((gamma, 0.53), true_words, HPos::Right, (-7, 0), BLUE),
        words(
            (printed, 0.53),
            printed_words,
            HPos::Left,
            (7, 0),
            VERMILION,
        ),
    ];
    Ok(vec![Panel {
        heading: "Probability of choosing the right one of a pair".into(),
        x: [0.0, 5.0],
        y: [0.5, 1.0],
        height: 300,
        lines,
        marks,
    }])
}
