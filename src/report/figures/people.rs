//! Figures 10 to 13: the right answers of the paper's subjects.

use super::chart::{Line, Panel, chart};
use super::style::{GREEN, GREY, INK, PALETTE, VERMILION};
use super::{Draft, Words};
use crate::psychophysics::{Bounds, ConditionAnalysis, InclusionAnalysis};
use crate::report::text::{millimetres, percent};
use crate::report::{Findings, Topic, normal_approximation};

/// What the x axis of all charts over the inclusions shows.
pub const DEPTH: &str = "Depth of the inclusion (mm)";
/// What the y axis of all charts of right answers shows.
pub const SHARE: &str = "Right answers (%)";

/// A chart of shares in per cent against the depth of the inclusion (mm), with the line of pure chance.
pub fn share_panel(heading: &str, depths: &[f64], height: i32, mut lines: Vec<Line>) -> Panel {
    let least = depths.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let x = [least - 0.8, greatest + 0.8];
    lines.insert(
        0,
        Line::new(GREY, vec![(x[0], 50.0), (x[1], 50.0)]).dashed(),
    );
    let shares = lines.iter().flat_map(|line| &line.points);
    // Room below pure chance, and the same scale for all experiments of the paper.
    let lowest = shares.map(|point| point.1).fold(40.0, f64::min);
    Panel {
        heading: heading.into(),
        x,
        y: [(lowest / 10.0).floor() * 10.0, 100.0],
        ticks: depths.into(),
        height,
        key: Vec::new(),
        lines,
        marks: Vec::new(),
    }
}

/// Depths, mm, and shares in per cent as points.
pub fn points(depths: &[f64], shares: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let shares = shares.into_iter().map(|share| 100.0 * share);
    depths.iter().copied().zip(shares).collect()
}

/// An upright bar at `x` from end to end of an interval of shares.
pub fn bar(x: f64, bounds: Bounds, colour: plotters::style::RGBColor, width: f64) -> Line {
    let ends = vec![(x, 100.0 * bounds.lower), (x, 100.0 * bounds.upper)];
    Line::new(colour, ends).wide(width)
}

fn depths(condition: &ConditionAnalysis) -> Vec<f64> {
    let inclusions = condition.inclusions.iter();
    inclusions.map(|inclusion| 1e3 * inclusion.depth).collect()
}

/// Figures 10 to 13.
///
/// Implements: REP-037, REP-038.
pub fn drafts(found: &Findings) -> Vec<Draft> {
    let conditions = &found.people.conditions;
    let files = ["figure-10", "figure-11", "figure-12"];
    let mut drafts: Vec<_> = conditions
        .iter()
        .zip(files)
        .zip(10..)
        .map(|((condition, file), number)| subjects(condition, file, number))
        .collect();
    drafts.push(comparison(conditions));
    drafts
}

/// Figures 10, 11 and 12: one condition, each subject and the mean.
fn subjects(condition: &ConditionAnalysis, prefix: &'static str, number: u32) -> Draft {
    let depths = depths(condition);
    let colours = &PALETTE[..6];
    let subject = |(k, subject): (usize, &crate::psychophysics::SubjectAnalysis)| {
        let shares = subject.rates.iter().map(|rate| rate.rate);
        let line = Line::new(colours[k % colours.len()], points(&depths, shares));
        Line {
            is_dashed: (k / colours.len()) % 2 == 1,
            ..line
                .wide(1.1)
                .dotted(3)
                .named(format!("subject {}", subject.name))
        }
    };
    let mut lines: Vec<_> = condition.subjects.iter().enumerate().map(subject).collect();
    let pooled = condition
        .inclusions
        .iter()
        .map(|inclusion| inclusion.pooled.rate);
    let mean = Line::new(INK, points(&depths, pooled)).wide(3.2).dotted(5);
    lines.push(mean.named("mean"));
    let mut panel = share_panel(SHARE, &depths, 300, lines);
    panel.key = vec![
        Line::new(INK, Vec::new()).wide(3.2).dotted(5).named("mean"),
        Line::new(colours[0], Vec::new())
            .wide(1.1)
            .dotted(3)
            .named("one subject"),
        Line::new(GREY, Vec::new()).dashed().named("chance"),
    ];
    let each: Vec<_> = condition
        .inclusions
        .iter()
        .map(|of| {
            format!(
                "{} at {} mm",
                percent(of.pooled.rate),
                millimetres(of.depth)
            )
        })
        .collect();
    let trials = condition
        .inclusions
        .first()
        .map_or(0, |of| of.pooled.trials);
    let pairs = trials / (condition.subjects.len() as u64).max(1);
    Draft {
        prefix,
        name: String::new(),
        topic: Topic::People,
        words: Words {
            title: format!("Figure {number}. Detection rates, {}", condition.name),
            caption: format!(
                "Right answers of each of the {} subjects in {pairs} pairs at each depth, from the paper's Table 1, and \
                 their mean. The paper's Figure {number} comes from the same counts, so that only the drawing can differ; \
                 here each subject is named. Where counts are equal, one line covers the other: Table 1 below has all.",
                condition.subjects.len()
            ),
            alt: format!(
                "Line chart of right answers in per cent against the depth of the inclusion, a thin line for each \
                 subject and a thick one for their mean: {}.",
                each.join(", ")
            ),
        },
        drawn: chart(&[panel], DEPTH),
    }
}

/// The colours of the conditions.
pub const CONDITIONS: [plotters::style::RGBColor; 3] = [PALETTE[0], VERMILION, GREEN];

/// Figure 13: the conditions side by side, with three kinds of intervals.
fn comparison(conditions: &[ConditionAnalysis]) -> Draft {
    let mut lines = Vec::new();
    let mut key = Vec::new();
    for (k, (condition, colour)) in conditions.iter().zip(CONDITIONS).enumerate() {
        let aside = 0.54 * (k as f64 - 0.5 * (conditions.len() as f64 - 1.0));
        for inclusion in &condition.inclusions {
            let x = 1e3 * inclusion.depth + aside;
            lines.extend(bars(inclusion, x, colour));
        }
        key.push(
            Line::new(colour, Vec::new())
                .wide(0.0)
                .dotted(5)
                .named(condition.name.clone()),
        );
    }
    key.extend([
        Line::new(INK, Vec::new())
            .wide(1.2)
            .named("normal approximation"),
        Line::new(INK, Vec::new())
            .wide(2.6)
            .dotted(4)
            .named("exact"),
        Line::new(INK, Vec::new()).wide(6.0).named("by subject"),
    ]);
    let depths = conditions.first().map_or(Vec::new(), depths);
    let mut panel = share_panel(SHARE, &depths, 330, lines);
    panel.key = key;
    Draft {
        prefix: "figure-13",
        name: String::new(),
        topic: Topic::People,
        words: Words {
            title: "Figure 13. The three experiments with 95 % intervals".into(),
            caption: format!(
                "Share of right answers, all subjects together, each with three 95 % intervals side by side: the normal \
                 approximation p̂\u{a0}±\u{a0}1.96\u{a0}√(p̂(1\u{a0}−\u{a0}p̂)/n) over all n answers (thin), the exact interval of Clopper and Pearson \
                 over the same answers (dot), and Student's interval with the subjects as the sample (thick). The paper's \
                 Figure 13 has one interval, from a table of Natrella (1963) whose formula it does not print; it counts all \
                 answers as independent, as the first two do. But subjects differ more than chance allows, and the next \
                 subject would differ again: the third interval, which lets them, is {} as wide as the exact one.",
                width_ratios(conditions)
            ),
            alt: comparison_alt(conditions),
        },
        drawn: chart(&[panel], DEPTH),
    }
}

/// The three intervals of one condition at one inclusion, about `x`.
fn bars(inclusion: &InclusionAnalysis, x: f64, colour: plotters::style::RGBColor) -> Vec<Line> {
    let pooled = &inclusion.pooled;
    let mut bars = vec![
        bar(
            x - 0.14,
            normal_approximation(pooled.rate, pooled.trials),
            colour,
            1.2,
        ),
        bar(x, pooled.clopper_pearson, colour, 2.6),
        Line::new(colour, vec![(x, 100.0 * pooled.rate)])
            .wide(0.0)
            .dotted(4),
    ];
    if let Some(clustered) = &inclusion.clustered {
        bars.push(bar(x + 0.15, clustered.bounds, colour, 6.0));
    }
    bars
}

/// How much wider the clustered intervals are: "1.1 to 2.6 times".
fn width_ratios(conditions: &[ConditionAnalysis]) -> String {
    let inclusions = conditions
        .iter()
        .flat_map(|condition| &condition.inclusions);
    let ratios = inclusions.filter_map(|inclusion| Some(inclusion.clustered.as_ref()?.width_ratio));
    let range = ratios.fold([f64::INFINITY, 0.0_f64], |[least, most], ratio| {
        [least.min(ratio), most.max(ratio)]
    });
    format!("{:.1} to {:.1} times", range[0], range[1])
}

fn comparison_alt(conditions: &[ConditionAnalysis]) -> String {
    let of = |condition: &ConditionAnalysis| {
        let shares: Vec<_> = condition
            .inclusions
            .iter()
            .map(|inclusion| percent(inclusion.pooled.rate))
            .collect();
        format!("{}: {}", condition.name, shares.join(", "))
    };
    let all: Vec<_> = conditions.iter().map(of).collect();
    format!(
        "Chart of right answers in per cent at each depth of the inclusion, with intervals. From the shallowest to the \
         deepest, {}.",
        all.join("; ")
    )
}
