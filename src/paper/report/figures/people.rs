//! Figures 10 to 13: the right answers of the paper's subjects.

use askama::Template;
use plotters::style::RGBColor;

use super::{Figures, band_ends, words};
use crate::psychophysics::{
    Analysis, Bounds, ConditionAnalysis, InclusionAnalysis, SubjectAnalysis,
};
use crate::report::people::width_ratios;
use crate::report::text::extremes;
use crate::report::{Run, Topic, inputs, normal_approximation, paper, text};
use crate::study::Kind;
use palpate::chart::chart;
use palpate::chart::style::{GREEN, GREY, INK, PALETTE, VERMILION};
use palpate::chart::{Line, Panel};
use palpate::refusal::Refusal;

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

/// Figures 10 to 13.
///
/// # Errors
/// If drawing fails.
///
/// Implements: REP-030.
pub fn draw(figures: &mut Figures, run: &Run, people: &Analysis) -> Result<(), Refusal> {
    for (at, (of, number)) in people.conditions.iter().zip(10..13).enumerate() {
        let predicted = match at {
            paper::FEM_PLAYBACK => predicted(run, of),
            _ => Vec::new(),
        };
        let text = SubjectText {
            number,
            of,
            has_bands: !predicted.is_empty(),
        };
        let file = format!("figure-{number}");
        figures.add(
            (&file, ""),
            Topic::People,
            words!(text, as_subjects_caption, as_subjects_alt),
            chart(&[subjects(of, predicted)], DEPTH),
        )?;
    }
    let text = ComparisonText {
        conditions: &people.conditions,
        width_ratios: width_ratios(people),
    };
    let panel = comparison(&people.conditions);
    figures.add(
        ("figure-13", ""),
        Topic::People,
        words!(text, as_figure_13_caption, as_figure_13_alt),
        chart(&[panel], DEPTH),
    )
}

/// Figures 10, 11 and 12: one condition, each subject and the mean.
fn subjects(condition: &ConditionAnalysis, predicted: Vec<Line>) -> Panel {
    let depths = depths(condition);
    let colours = &PALETTE[..6];
    let of_subject = |colour, points| Line::new(colour, points).wide(1.1).dotted(3);
    let of_mean = |points| Line::new(INK, points).wide(3.2).dotted(5).named("mean");
    let subject = |(k, subject): (usize, &SubjectAnalysis)| {
        let shares = points(&depths, subject.rates.iter().map(|rate| rate.rate));
        of_subject(colours[k % colours.len()], shares)
            .dashed((k / colours.len()) % 2 == 1)
            .named(format!("subject {}", subject.name))
    };
    let mut lines: Vec<_> = condition.subjects.iter().enumerate().map(subject).collect();
    let pooled = condition.inclusions.iter().map(|of| of.pooled.rate);
    lines.push(of_mean(points(&depths, pooled)));
    lines.extend(predicted);
    let mut panel = share_panel(SHARE, &depths, 300, lines);
    panel.key = vec![
        of_mean(Vec::new()),
        of_subject(colours[0], Vec::new()).named("one subject"),
        Line::new(GREY, Vec::new()).dashed(true).named("chance"),
    ];
    panel
}

/// The ends of the bands that a study has for the share that the peak of the normal signal predicts.
///
/// Implements: REP-081.
fn predicted(run: &Run, condition: &ConditionAnalysis) -> Vec<Line> {
    let inclusions = condition.inclusions.iter();
    let bands = inclusions.filter_map(|of| {
        let band = inputs::band(run, &of.name, &Kind::TwoAfcByPeak)?;
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
    let panel = share_panel(SHARE, &depths, 330, lines);
    Panel { key, ..panel }
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

#[derive(Template)]
#[template(path = "report/words.txt", block = "subjects_title", blocks = ["subjects_caption", "subjects_alt"])]
struct SubjectText<'a> {
    number: u32,
    of: &'a ConditionAnalysis,
    /// Whether predictions are drawn.
    has_bands: bool,
}

impl SubjectText<'_> {
    /// Pairs that each subject judged at each depth.
    fn pairs(&self) -> u64 {
        let trials = self.of.inclusions.first().map_or(0, |of| of.pooled.trials);
        trials / (self.of.subjects.len() as u64).max(1)
    }
}

#[derive(Template)]
#[template(path = "report/words.txt", block = "figure_13_title", blocks = ["figure_13_caption", "figure_13_alt"])]
struct ComparisonText<'a> {
    conditions: &'a [ConditionAnalysis],
    width_ratios: Option<[f64; 2]>,
}
