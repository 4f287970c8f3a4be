//! Figures 2 and 8: the detection problem and the experiments as diagrams.

use plotters::style::text_anchor::HPos;

use super::chart::{Area, DrawingResult, draw};
use super::diagram::{GEL, PROBE, STEP, WAX, arrow, boxed, dashes, say_at};
use super::style::{GREY, WIDTH};
use super::{Draft, Words};
use crate::report::Topic;

/// Figure 2: from the probe's trajectory to the decision.
pub fn detection() -> Draft {
    let height = 560;
    let svg = draw(height, draw_detection);
    Draft {
        prefix: "figure-2",
        name: String::new(),
        topic: Topic::Detection,
        words: Words {
            title: "Figure 2. The signal detection problem".into(),
            caption: "From the probe's path to a decision; the numbers are those of the paper's equations. The paper's \
                      Figure 2 shows the same signals X, F and Fₚ around a human observer. Here the observer is the \
                      matched filter that the paper proposes for him, with each of its steps."
                .into(),
            alt: "A chain of boxes. The trajectory X(t) moves the probe over the gel, which holds an inclusion or \
                  none; the force F(t), with noise added, is the perceived force. Two matched filters give \
                  Y(0), then the statistic θ, which is compared with the threshold η to give the decision Ĥ."
                .into(),
        },
        drawn: svg.map(|svg| (svg, [WIDTH, height])),
    }
}

fn draw_detection(area: &Area<'_>) -> DrawingResult<()> {
    let (left, width) = (150.0, 330.0);
    let middle = left + 0.5 * width;
    let boxes: [(f64, f64, _, &[&str]); 4] = [
        (12.0, 36.0, WAX, &["Trajectory X(t) = (v t, d)"]),
        (
            82.0,
            76.0,
            GEL,
            &[
                "Gel under the probe (1)",
                "H = 0, no inclusion: F(t) = F₀(t)",
                "H = 1, inclusion: F(t) = F₁(t)",
            ],
        ),
        (
            292.0,
            56.0,
            STEP,
            &["Matched filters of Fₚ − F₀:", "Y(t) (2), (4), (5)"],
        ),
        (
            388.0,
            56.0,
            STEP,
            &["Sufficient statistic Θ (7)", "N(∓γ²/2, γ²) (8)"],
        ),
    ];
    for (top, height, fill, lines) in boxes {
        boxed(area, [left, top, width, height], fill, lines)?;
    }
    boxed(
        area,
        [left + 65.0, 484.0, 200.0, 36.0],
        STEP,
        &["θ ≥ η ? (9)"],
    )?;
    boxed(area, [middle - 18.0, 202.0, 36.0, 36.0], PROBE, &["+"])?;
    for (from, to, name) in [
        (48.0, 82.0, ""),
        (158.0, 202.0, "F(t)"),
        (238.0, 292.0, "Fₚ(t), perceived"),
        (348.0, 388.0, "Y(0)"),
        (444.0, 484.0, "θ"),
        (520.0, 548.0, "Ĥ = 0 or 1"),
    ] {
        arrow(area, &[[middle, from], [middle, to]])?;
        say_at(area, name, [middle + 12.0, 0.5 * (from + to)], HPos::Left)?;
    }
    // What comes from the side: the truth, the noise, the threshold.
    for (height, end, lines) in [
        (120.0, left, ["truth", "H"]),
        (220.0, middle - 18.0, ["noise", "N(0, K)"]),
        (502.0, left + 65.0, ["prior, costs,", "rates: η"]),
    ] {
        for (k, line) in lines.iter().enumerate() {
            let at = [14.0, height - 10.0 + 20.0 * k as f64];
            say_at(area, line, at, HPos::Left)?;
        }
        arrow(area, &[[118.0, height], [end, height]])?;
    }
    Ok(())
}

/// Figure 8: the three experiments.
pub fn experiments() -> Draft {
    let height = 436;
    let svg = draw(height, draw_experiments);
    Draft {
        prefix: "figure-8",
        name: String::new(),
        topic: Topic::People,
        words: Words {
            title: "Figure 8. The three experiments".into(),
            caption: "How the force came to the ten subjects, drawn after §3.2 and §4; below each chain the sources of \
                      noise that Table 2 names for it. The paper's Figure 8 shows the apparatus. Here the finite \
                      elements and the force table are computed again (“palpate run”), a table is played back on a \
                      display by “palpate play”, measured forces are read by “palpate import-map”, and “palpate \
                      experiment” runs the pairs. The gels, their measurement and the subjects are the paper's alone."
                .into(),
            alt: "Three chains of boxes that end at the subject. Direct contact: gel, then a probe on the index \
                  finger. FEM data: finite elements, force table, haptic display. Measured data: gel with a force \
                  sensor, force table, haptic display. The subject says which of two samples holds the inclusion."
                .into(),
        },
        drawn: svg.map(|svg| (svg, [WIDTH, height])),
    }
}

fn draw_experiments(area: &Area<'_>) -> DrawingResult<()> {
    let (width, distance) = (156.0, 168.0);
    let column = |k: usize| 14.0 + distance * k as f64;
    let heads = ["Direct contact", "FEM data", "Measured data"];
    let noise = [
        ["200 mN unmodelled", "contact"],
        ["140 mN friction,", "0.5 mN steps"],
        ["20 mN sensor, 140 mN", "friction, 0.5 mN steps"],
    ];
    for (k, head) in heads.iter().enumerate() {
        let (left, middle) = (column(k), column(k) + 0.5 * width);
        say_at(area, head, [middle, 20.0], HPos::Center)?;
        let chain: &[(f64, f64, _, &[&str])] = match k {
            0 => &[
                (40.0, 40.0, GEL, &["Gel"]),
                (196.0, 56.0, PROBE, &["Probe on the", "index finger"]),
            ],
            1 => &[
                (40.0, 40.0, STEP, &["Finite elements"]),
                (118.0, 40.0, STEP, &["Force table"]),
                (196.0, 56.0, PROBE, &["Haptic display", "(Impulse Engine)"]),
            ],
            _ => &[
                (40.0, 40.0, GEL, &["Gel, force sensor"]),
                (118.0, 40.0, STEP, &["Force table"]),
                (196.0, 56.0, PROBE, &["Haptic display", "(Impulse Engine)"]),
            ],
        };
        for &(top, height, fill, lines) in chain {
            boxed(area, [left, top, width, height], fill, lines)?;
        }
        for pair in chain.windows(2) {
            arrow(
                area,
                &[[middle, pair[0].0 + pair[0].1], [middle, pair[1].0]],
            )?;
        }
        for (row, line) in noise[k].iter().enumerate() {
            let at = [middle, 272.0 + 20.0 * row as f64];
            say_at(area, line, at, HPos::Center)?;
        }
        arrow(area, &[[middle, 306.0], [middle, 340.0]])?;
    }
    dashes(area, &[[14.0, 258.0], [506.0, 258.0]], GREY)?;
    let subject = [
        "Subject (93 mN): which of the two samples",
        "holds the inclusion? 3 s for each,",
        "30 pairs for each of four depths",
    ];
    boxed(area, [14.0, 340.0, 492.0, 80.0], WAX, &subject)
}
