//! Figures 10 to 13: the right answers of the paper's subjects.

use plotters::style::RGBColor;

use super::bands::band_ends;
use super::plan::{Picture, Plan, Words, over};
use crate::psychophysics::{
    Analysis, Bounds, ConditionAnalysis, InclusionAnalysis, SubjectAnalysis,
};
use crate::report::people::width_ratios;
use crate::report::text::{extremes, fixed, joined, millimetres, percent};
use crate::report::{Findings, Run, Topic, inputs, normal_approximation, paper};
use crate::study::Kind;
use palpate::chart::style::{GREEN, GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Panel};
use palpate::force_map::ForceMap;

/// What the x axis of all charts over the inclusions shows.
pub const DEPTH: &str = "Depth of the inclusion (mm)";
/// What the y axis of all charts of right answers shows.
pub const SHARE: &str = "Right answers (%)";

/// A chart of shares in per cent against the depth of the inclusion (mm), with the line of pure chance.
pub fn share_panel(heading: &str, depths: &[f64], height: i32, mut lines: Vec<Line>) -> Panel {
    let [least, greatest] = extremes(depths.iter().copied()).unwrap_or_default();
    let x = [least - 0.8, greatest + 0.8];
    let chance = vec![(x[0], 50.0), (x[1], 50.0)];
    lines.insert(0, Line::new(GREY, chance).dashed(true));
    let shares = lines.iter().flat_map(|line| &line.points);
    // Room below pure chance, and the same scale for all experiments of the paper.
    let lowest = shares.map(|point| point.1).fold(40.0, f64::min);
    let y = [(lowest / 10.0).floor() * 10.0, 100.0];
    Panel {
        ticks: depths.into(),
        ..Panel::new(heading, [x, y], height, lines)
    }
}

/// Depths, mm, and shares in per cent as points.
pub fn points(depths: &[f64], shares: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let shares = shares.into_iter().map(|share| 100.0 * share);
    depths.iter().copied().zip(shares).collect()
}

/// An upright bar at `x` from end to end of an interval of shares.
pub fn bar(x: f64, bounds: Bounds, colour: RGBColor, width: f64) -> Line {
    let ends = vec![(x, 100.0 * bounds.lower), (x, 100.0 * bounds.upper)];
    Line::new(colour, ends).wide(width)
}

fn depths(condition: &ConditionAnalysis) -> Vec<f64> {
    let inclusions = condition.inclusions.iter();
    inclusions.map(|of| 1e3 * of.depth_m).collect()
}

/// Figures 8 and 10 to 13.
///
/// Implements: REP-030.
pub fn figures(run: &Run, found: &Findings) -> Vec<Plan> {
    let people = &found.people;
    let plan = |number, words, picture| {
        Plan::new(format!("figure-{number}"), Topic::People, words, picture)
    };
    let experiments = Picture::Finished(include_str!("figure-8.svg"), 436);
    let mut plans = vec![plan(8, EXPERIMENTS.map(Into::into), experiments)];
    for (at, (of, number)) in people.conditions.iter().zip(10..13).enumerate() {
        let predicted = match at {
            paper::FEM_PLAYBACK => predicted(run, found, of),
            _ => Vec::new(),
        };
        let words = subject_words(number, of, !predicted.is_empty());
        plans.push(plan(number, words, over(DEPTH, [subjects(of, predicted)])));
    }
    let picture = over(DEPTH, [comparison(&people.conditions)]);
    plans.push(plan(13, comparison_words(people), picture));
    plans
}

/// Title, caption and alternative text of Figure 8.
const EXPERIMENTS: [&str; 3] = [
    "Figure 8. The three experiments",
    "How the force came to the ten subjects, drawn after §3.2 and §4; below each chain the sources of noise that Table 2 names for it. \
         The paper's Figure 8 shows the apparatus. Here the finite elements and the force table are computed again (“palpate run”), a \
         table is played back on a display by “palpate play”, measured forces are read by “palpate import-map”, and “palpate experiment” \
         runs the pairs. The gels, their measurement and the subjects are the paper's alone.",
    "Three chains of boxes that end at the subject. Direct contact: gel, then a probe on the index finger. FEM data: finite elements, \
         force table, haptic display. Measured data: gel with a force sensor, force table, haptic display. The subject says which of two \
         samples holds the inclusion.",
];

/// The words of Figures 10 to 12.
fn subject_words(number: u32, of: &ConditionAnalysis, has_bands: bool) -> Words {
    let subjects = of.subjects.len();
    let trials = of.inclusions.first().map_or(0, |of| of.pooled.trials);
    let pairs = trials / (subjects as u64).max(1);
    let bands = " Between the dashed lines lie 95 % of the shares that the peak of the normal signal predicts, over the draws of the \
                 uncertain inputs.";
    let bands = if has_bands { bands } else { "" };
    let shares = of.inclusions.iter().map(|of| {
        let share = percent(of.pooled.rate);
        format!("{share} at {} mm", millimetres(of.depth_m))
    });
    [
        format!("Figure {number}. Detection rates, {}", of.name),
        format!(
            "Right answers of each of the {subjects} subjects in {pairs} pairs at each depth, from the paper's Table 1, and their mean. \
             The paper's Figure {number} comes from the same counts, so that only the drawing can differ; here each subject is named. \
             Where counts are equal, one line covers the other: Table 1 below has all.{bands}"
        ),
        format!(
            "Line chart of right answers in per cent against the depth of the inclusion, a thin line for each subject and a thick one for \
             their mean: {}.",
            joined(shares, ", ")
        ),
    ]
}

/// The words of Figure 13.
fn comparison_words(people: &Analysis) -> Words {
    let wider = width_ratios(people).map(|ends| {
        let [least, most] = ends.map(|ratio| fixed(ratio, 1));
        format!(" {least} to {most} times")
    });
    let wider = wider.unwrap_or_default();
    let shares = people.conditions.iter().map(|condition| {
        let shares = condition.inclusions.iter();
        let shares = shares.map(|of| percent(of.pooled.rate));
        format!("{}: {}", condition.name, joined(shares, ", "))
    });
    [
        "Figure 13. The three experiments with 95 % intervals".into(),
        format!(
            "Share of right answers, all subjects together, each with three 95 % intervals side by side: the normal approximation p̂ ± 1.96 \
             √(p̂(1 − p̂)/n) over all n answers (thin), the exact interval of Clopper and Pearson over the same answers (dot), and Student's \
             interval with the subjects as the sample (thick). The paper's Figure 13 has one interval, from a table of Natrella (1963) whose \
             formula it does not print; it counts all answers as independent, as the first two do. But subjects differ more than chance \
             allows, and the next subject would differ again: the third interval, which lets them, is{wider} as wide as the exact one."
        ),
        format!(
            "Chart of right answers in per cent at each depth of the inclusion, with intervals. From the shallowest to the deepest, {}.",
            joined(shares, "; ")
        ),
    ]
}

/// Figures 10, 11 and 12: one condition, each subject and the mean.
fn subjects(condition: &ConditionAnalysis, predicted: Vec<Line>) -> Panel {
    let depths = depths(condition);
    let subject = |(k, subject): (usize, &SubjectAnalysis)| {
        let shares = points(&depths, subject.rates.iter().map(|rate| rate.rate));
        let line = Line::nth(k, &PALETTE[..6], shares).wide(1.1).dotted(3);
        line.named(format!("subject {}", subject.name))
    };
    let mut lines: Vec<_> = condition.subjects.iter().enumerate().map(subject).collect();
    let pooled = condition.inclusions.iter().map(|of| of.pooled.rate);
    let mean = Line::new(INK, points(&depths, pooled));
    lines.push(mean.wide(3.2).dotted(5).named("mean"));
    lines.extend(predicted);
    Panel {
        key: vec![Line::new(GREY, Vec::new()).dashed(true).named("chance")],
        ..share_panel(SHARE, &depths, 300, lines)
    }
}

/// The ends of the bands that a study has for the share that the peak of the normal signal predicts, of the paper's phantoms at the
/// paper's depth.
///
/// Implements: REP-081.
fn predicted(run: &Run, found: &Findings, condition: &ConditionAnalysis) -> Vec<Line> {
    let is_paper_depth = found.probe_depth_note.is_none();
    let inclusions = condition.inclusions.iter();
    let inclusions = inclusions.filter(|_| is_paper_depth);
    let bands = inclusions.filter_map(|of| {
        let is_own = |map: &&ForceMap| map.phantom().and_then(paper::name_of) == Some(&of.name);
        let map = run.maps.iter().find(is_own)?;
        let band = inputs::band(run, map, &Kind::TwoAfcByPeak)?;
        Some((1e3 * of.depth_m, band))
    });
    band_ends("predicted, ", &bands.collect::<Vec<_>>(), 100.0)
}

/// The colours of the conditions.
const CONDITIONS: [RGBColor; 3] = [PALETTE[0], VERMILION, GREEN];

/// Figure 13: the conditions side by side, with three kinds of intervals.
fn comparison(conditions: &[ConditionAnalysis]) -> Panel {
    let (mut lines, mut key) = (Vec::new(), Vec::new());
    for (k, (condition, colour)) in conditions.iter().zip(CONDITIONS).enumerate() {
        let aside = 0.54 * (k as f64 - 0.5 * (conditions.len() as f64 - 1.0));
        for inclusion in &condition.inclusions {
            lines.extend(bars(inclusion, 1e3 * inclusion.depth_m + aside, colour));
        }
        let sample = Line::new(colour, Vec::new()).wide(0.0).dotted(5);
        key.push(sample.named(condition.name.clone()));
    }
    let sample = |width, name: &str| Line::new(INK, Vec::new()).wide(width).named(name);
    key.extend([
        sample(1.2, "normal approximation"),
        sample(2.6, "exact").dotted(4),
        sample(6.0, "by subject"),
    ]);
    let depths = conditions.first().map_or(Vec::new(), depths);
    Panel {
        key,
        ..share_panel(SHARE, &depths, 330, lines)
    }
}

/// The three intervals of one condition at one inclusion, about `x`.
fn bars(inclusion: &InclusionAnalysis, x: f64, colour: RGBColor) -> Vec<Line> {
    let pooled = &inclusion.pooled;
    let normal = normal_approximation(pooled.rate, pooled.trials);
    let share = Line::new(colour, vec![(x, 100.0 * pooled.rate)]);
    let mut bars = vec![
        bar(x - 0.14, normal, colour, 1.2),
        bar(x, pooled.clopper_pearson, colour, 2.6),
        share.wide(0.0).dotted(4),
    ];
    let clustered = inclusion.clustered.as_ref();
    bars.extend(clustered.map(|of| bar(x + 0.15, of.bounds, colour, 6.0)));
    bars
}
