//! The section on the paper's subjects: Table 1, its figures, the experiments against one another.

use super::table::{Group, Layout, Table};
use super::{Page, bridge};
use crate::psychophysics::{Bounds, ConditionAnalysis, ConditionComparison, InclusionAnalysis};
use crate::report::text::{escape, fixed, millimetres, p_value, percent};
use crate::report::{Topic, paper};

/// Table 1, the figures made from it, and the forces against it.
///
/// Implements: REP-062.
pub fn people(page: &Page<'_>) -> String {
    let conditions = &page.findings.people.conditions;
    format!(
        "<p>Ten subjects felt pairs of gels, of which one held an inclusion, and said which: {} pairs at each depth in each \
         of three experiments (§4). All counts are the paper's; the intervals are ours.</p>\n{}{}{}{}",
        paper::TRIALS,
        page.figures(Topic::People),
        table_1(conditions),
        comparisons(&page.findings.people.comparisons),
        bridge::bridge(page)
    )
}

/// "93.1 to 97.9 %".
pub fn interval(Bounds { lower, upper }: Bounds) -> String {
    format!(
        "{} to {} %",
        fixed(100.0 * lower, 1),
        fixed(100.0 * upper, 1)
    )
}

fn table_1(conditions: &[ConditionAnalysis]) -> String {
    let Some(first) = conditions.first() else {
        return String::new();
    };
    let depths: Vec<_> = first
        .inclusions
        .iter()
        .map(|of| format!("{} mm", millimetres(of.depth)))
        .collect();
    let mut head = vec![("Subject", "")];
    head.extend(depths.iter().map(|depth| (depth.as_str(), "number")));
    let groups = conditions
        .iter()
        .zip(paper::PRINTED_MEANS)
        .map(|(condition, printed)| group(condition, printed))
        .collect();
    let caption = format!(
        "Table 1. Right answers in {} pairs, by depth of the inclusion's top. Shares are those of all subjects together. \
         The exact interval takes all answers as independent with one probability; the interval by subject takes the \
         subjects as the sample. χ²/df is the spread between subjects over what chance alone gives: 1 if they were all \
         alike.",
        paper::TRIALS
    );
    let table = Table {
        id: "table-1",
        caption: &caption,
        layout: Layout::Dense,
        head: &head,
        groups,
    };
    table.markup()
}

fn group(condition: &ConditionAnalysis, printed: [f64; 4]) -> Group {
    let row = |name: &str, cell: &dyn Fn(&InclusionAnalysis) -> String| {
        let mut row = vec![name.to_string()];
        row.extend(condition.inclusions.iter().map(cell));
        row
    };
    let subject = |subject: &crate::psychophysics::SubjectAnalysis| {
        let mut row = vec![escape(&subject.name)];
        row.extend(subject.rates.iter().map(|rate| rate.correct.to_string()));
        row
    };
    let mut rows: Vec<_> = condition.subjects.iter().map(subject).collect();
    let subjects = condition.subjects.len() as f64;
    rows.push(row("mean", &|of| {
        fixed(of.pooled.correct as f64 / subjects, 1)
    }));
    let mut of_paper = vec!["mean, as printed".to_string()];
    of_paper.extend(printed.map(|mean| fixed(mean, 1)));
    rows.push(of_paper);
    rows.push(row("share", &|of| escape(&percent(of.pooled.rate))));
    rows.push(row("95 %, exact", &|of| {
        interval(of.pooled.clopper_pearson)
    }));
    rows.push(row("95 %, by subject", &|of| {
        of.clustered
            .as_ref()
            .map_or("–".into(), |clustered| interval(clustered.bounds))
    }));
    rows.push(row("χ²/df", &|of| {
        of.dispersion
            .as_ref()
            .map_or("–".into(), |dispersion| fixed(dispersion.ratio, 1))
    }));
    Group {
        heading: escape(&condition.name),
        rows,
    }
}

/// Whether the experiments differ, with each subject compared with itself.
fn comparisons(comparisons: &[ConditionComparison]) -> String {
    if comparisons.is_empty() {
        return String::new();
    }
    let points = |share: f64| {
        let sign = if share > 0.0 { "+" } else { "" };
        format!("{sign}{}", fixed(100.0 * share, 1))
    };
    let row = |of: &ConditionComparison| {
        let bounds = of
            .overall
            .bounds
            .map_or("–".into(), |Bounds { lower, upper }| {
                format!("{} to {}", points(lower), points(upper))
            });
        vec![
            format!("{} – {}", escape(&of.first), escape(&of.second)),
            points(of.overall.mean),
            bounds,
            of.overall.p_value.map_or("–".into(), p_value),
            of.p_value_holm.map_or("–".into(), p_value),
        ]
    };
    let head = [
        ("Experiments", ""),
        ("Difference (percentage points)", "number"),
        ("95 % interval (percentage points)", "number"),
        ("p", "number"),
        ("p, Holm", "number"),
    ];
    let caption = "The experiments against one another: share of right answers over all depths, each subject compared with \
                   itself. Interval by Student's law over the subjects; p by exchanging the signs of their differences, \
                   then after Holm for three comparisons. The paper says that direct contact and FEM playback are “quite \
                   close” and that measured playback does “not compare as well”; it tests neither.";
    let table = Table {
        id: "table-experiments",
        caption,
        layout: Layout::Rows,
        head: &head,
        groups: Group::plain(comparisons.iter().map(row).collect()),
    };
    table.markup()
}
