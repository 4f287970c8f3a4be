//! Figures 10 to 13: the right answers of the paper's subjects.

use super::chart::{Line, Panel, chart};
use super::style::{GREY, INK, PALETTE};
use super::{Draft, Words};
use crate::report::text::{fixed, percent};
use crate::report::{Findings, ReportError, Topic, paper};

const DEPTH: &str = "Depth of the inclusion (mm)";
const SHARE: &str = "Right answers (%)";

/// The depths of Table 1, mm.
fn depths() -> [f64; 4] {
    paper::INCLUSION_DEPTHS.map(|depth| 1e3 * depth)
}

/// A chart of shares in per cent against the depth of the inclusion, with the line of pure chance.
fn panel(heading: String, height: i32, key: Vec<Line>, mut lines: Vec<Line>) -> Panel {
    let [first, .., last] = depths();
    let x = [first - 0.8, last + 0.8];
    lines.insert(
        0,
        Line::new(GREY, vec![(x[0], 50.0), (x[1], 50.0)]).dashed(),
    );
    Panel {
        heading,
        x,
        y: [30.0, 100.0],
        ticks: depths().into(),
        height,
        key,
        lines,
        marks: Vec::new(),
    }
}

/// Figures 10 to 13.
///
/// # Errors
/// Never for the paper's own counts; the refusal of the statistics is passed on all the same.
///
/// Implements: REP-037, REP-038.
pub fn drafts(_found: &Findings) -> Result<Vec<Draft>, ReportError> {
    let mut drafts: Vec<_> = paper::EXPERIMENTS.iter().map(subjects).collect();
    drafts.truncate(3);
    Ok(drafts)
}

/// Figures 10, 11 and 12: one experiment, each subject and the mean.
fn subjects(experiment: &paper::Experiment) -> Draft {
    let share = |correct: f64| 100.0 * correct / f64::from(paper::TRIALS);
    let mut lines = Vec::new();
    for (k, counts) in experiment.correct.iter().enumerate() {
        let points = depths()
            .into_iter()
            .zip(counts.iter().map(|&count| share(f64::from(count))));
        let line = Line::new(PALETTE[k % (PALETTE.len() - 1)], points.collect());
        let line = line.wide(1.1).dotted(3).named(format!("subject {}", k + 1));
        lines.push(Line {
            is_dashed: k >= PALETTE.len() - 1,
            ..line
        });
    }
    let means = (0..4).map(|column| experiment.mean(column));
    let points = depths().into_iter().zip(means.clone().map(share));
    lines.push(
        Line::new(INK, points.collect())
            .wide(3.2)
            .dotted(5)
            .named("mean"),
    );
    let key = vec![
        Line::new(INK, Vec::new())
            .wide(3.2)
            .dotted(5)
            .named("mean of ten"),
        Line::new(PALETTE[0], Vec::new())
            .wide(1.1)
            .dotted(3)
            .named("one subject"),
        Line::new(GREY, Vec::new()).dashed().named("chance"),
    ];
    let panels = [panel(SHARE.into(), 300, key, lines)];
    let each: Vec<_> = depths()
        .into_iter()
        .zip(means)
        .map(|(depth, mean)| {
            let share = percent(mean / f64::from(paper::TRIALS));
            format!("{share} at {} mm", fixed(depth, 1))
        })
        .collect();
    Draft {
        prefix: experiment.figure_file,
        name: String::new(),
        topic: Topic::People,
        words: Words {
            title: format!(
                "{}. Detection rates, {}",
                experiment.figure, experiment.name
            ),
            caption: format!(
                "Right answers of each of the ten subjects in 30 pairs at each depth, from the paper's Table 1, and their \
                 mean. The paper's {} is drawn from the same counts, so nothing differs but the drawing: here every \
                 subject is named. Ten subjects at one depth often have the same count, and then cover one another; \
                 Table 1 below has all of them.",
                experiment.figure
            ),
            alt: format!(
                "Line chart of right answers in per cent against the depth of the inclusion, one thin line for each \
                 subject and a thick one for their mean: {}.",
                each.join(", ")
            ),
        },
        drawn: chart(&panels, DEPTH),
    }
}
