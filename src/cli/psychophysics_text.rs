//! The answer of `palpate psychophysics` for people.

use super::psychophysics::Answer;
use crate::psychophysics::bridge::{Bridge, ConditionBridge, ConventionFit, WeightFit};
use crate::psychophysics::{
    Bounds, ConditionAnalysis, ConditionComparison, InclusionAnalysis, NoiseDecomposition,
    OpenBounds, Parameter, Psychometric, SubjectAnalysis,
};

/// The whole answer.
///
/// Implements: CLI-084.
pub fn text(answer: &Answer) -> String {
    let mut parts = vec![format!(
        "{}: shares of right answers with intervals of {} %\n",
        answer.counts,
        100.0 * answer.analysis.confidence
    )];
    parts.extend(answer.analysis.conditions.iter().map(condition));
    parts.extend(comparisons(&answer.analysis.comparisons));
    parts.extend(answer.noise_levels.as_ref().map(noise_levels));
    parts.extend(answer.bridge.as_ref().map(bridge));
    parts.join("\n")
}

fn condition(condition: &ConditionAnalysis) -> String {
    let mut rows = vec![[
        "inclusion".into(),
        "right".into(),
        "share".into(),
        "Clopper-Pearson".into(),
        "Wilson".into(),
        "subjects as sample".into(),
        "gamma".into(),
        "chi2/df".into(),
        "p".into(),
        "rho".into(),
    ]];
    rows.extend(condition.inclusions.iter().map(inclusion));
    let mut text = format!(
        "{} ({} subjects{})\n{}",
        condition.name,
        condition.subjects.len(),
        condition.dispersion.map_or(String::new(), |ratio| format!(
            ", chi2/df {ratio:.2} over all"
        )),
        columns(&rows)
    );
    if condition
        .inclusions
        .iter()
        .any(|i| i.dispersion.is_some_and(|d| d.is_rough))
    {
        text += "  * p is rough: a subject's expected count of wrong answers is below 5\n";
    }
    text += &match &condition.psychometric {
        Some(found) => psychometric(found),
        None => "  no psychometric function: it needs three depths and answers of two subjects that are not all right\n".into(),
    };
    text + &subjects(condition)
}

fn inclusion(inclusion: &InclusionAnalysis) -> [String; 10] {
    let pooled = &inclusion.pooled;
    let none = || "-".to_string();
    [
        inclusion.name.clone(),
        format!("{}/{}", pooled.correct, pooled.trials),
        format!("{:.3}", pooled.rate),
        bounds(pooled.clopper_pearson),
        bounds(pooled.wilson),
        inclusion
            .clustered
            .map_or_else(none, |found| bounds(found.bounds)),
        format!(
            "{} {}",
            pooled
                .gamma
                .gamma
                .map_or_else(none, |gamma| format!("{gamma:.2}")),
            open(
                OpenBounds {
                    lower: pooled.gamma.lower,
                    upper: pooled.gamma.upper
                },
                1.0,
                2
            )
        ),
        inclusion
            .dispersion
            .map_or_else(none, |found| format!("{:.2}", found.ratio)),
        inclusion.dispersion.map_or_else(none, |found| {
            p_value(Some(found.p_value)) + if found.is_rough { " *" } else { "" }
        }),
        inclusion.beta_binomial.map_or_else(none, |found| {
            format!(
                "{:.3} {}",
                found.correlation,
                open(found.correlation_bounds, 1.0, 3)
            )
        }),
    ]
}

fn subjects(condition: &ConditionAnalysis) -> String {
    let mut header = vec!["subject".to_string()];
    header.extend(
        condition
            .inclusions
            .iter()
            .map(|inclusion| inclusion.name.clone()),
    );
    let mut rows = vec![header];
    rows.extend(condition.subjects.iter().map(|subject: &SubjectAnalysis| {
        let mut row = vec![subject.name.clone()];
        row.extend(subject.rates.iter().map(|rate| {
            format!(
                "{}/{} {}",
                rate.correct,
                rate.trials,
                bounds(rate.clopper_pearson)
            )
        }));
        row
    }));
    columns(&rows)
}

fn psychometric(found: &Psychometric) -> String {
    let said = |name: &str, parameter: &Parameter, scale: f64, digits: usize| {
        format!(
            "{name} {:.digits$} {}, with the subjects' dispersion {}",
            scale * parameter.value,
            open(parameter.bounds, scale, digits),
            open(parameter.dispersed_bounds, scale, digits)
        )
    };
    format!(
        "  share = 1/2 + (1/2 - lapse) Phi((midpoint - depth)/spread)\n    {}\n    {}\n    {}\n    deviance {:.2} with {} degrees of freedom: p = {}, with the subjects' dispersion {}\n",
        said("midpoint, mm:", &found.midpoint, 1e3, 2),
        said("spread, mm:", &found.spread, 1e3, 2),
        said("lapse:", &found.lapse, 1.0, 3),
        found.deviance,
        found.degrees,
        p_value(found.p_value),
        p_value(found.p_value_dispersed)
    )
}

fn comparisons(comparisons: &[ConditionComparison]) -> Option<String> {
    let mut rows = vec![
        [
            "difference of shares",
            "inclusion",
            "mean",
            "subjects as sample",
            "p, signs exchanged",
            "p, Holm",
        ]
        .map(String::from),
    ];
    for comparison in comparisons {
        let pair = format!("{} - {}", comparison.first, comparison.second);
        let overall = &comparison.overall;
        rows.push(row_of(
            &pair,
            "all",
            overall,
            p_value(comparison.p_value_holm),
        ));
        for found in &comparison.by_inclusion {
            rows.push(row_of(
                "",
                &found.inclusion,
                &found.difference,
                String::new(),
            ));
        }
    }
    (rows.len() > 1).then(|| {
        format!(
            "Conditions, each subject against itself (the order in which a subject met the conditions is not known)\n{}",
            columns(&rows)
        )
    })
}

fn row_of(
    pair: &str,
    inclusion: &str,
    difference: &crate::psychophysics::Difference,
    holm: String,
) -> [String; 6] {
    [
        pair.into(),
        inclusion.into(),
        format!("{:+.3}", difference.mean),
        difference.bounds.map_or("-".into(), bounds),
        p_value(difference.p_value),
        holm,
    ]
}

fn noise_levels(found: &NoiseDecomposition) -> String {
    let mut rows = vec![
        [
            "noise, mN",
            "paper",
            "here",
            "all pooled",
            "subjects as sample",
            "formula",
        ]
        .map(String::from),
    ];
    let milli = |bounds: Option<OpenBounds>| bounds.map_or(String::new(), |b| open(b, 1e3, 0));
    rows.extend(found.levels.iter().map(|level| {
        [
            level.name.into(),
            level
                .printed
                .map_or("-".into(), |noise| format!("{:.0}", 1e3 * noise)),
            format!("{:.1}", 1e3 * level.noise),
            milli(level.pooled_bounds),
            milli(level.clustered_bounds),
            level.formula.clone(),
        ]
    }));
    let mut text = format!("Noise levels of the paper's section 5\n{}", columns(&rows));
    for level in &found.levels {
        text += &format!("  {}: assumes that {}\n", level.name, level.assumption);
    }
    text + &format!("  {}\n", found.agreement)
}

fn bridge(bridge: &Bridge) -> String {
    let mut text = format!(
        "Force maps against the counts: probe at {:.2} mm, {} positions from {:.1} to {:.1} mm\n",
        1e3 * bridge.probe_depth,
        bridge.positions,
        1e3 * bridge.from,
        1e3 * bridge.to
    );
    text.extend(
        bridge
            .probe_depth_note
            .iter()
            .map(|note| format!("  {note}\n")),
    );
    let mut rows = vec![
        [
            "inclusion",
            "normal: peak, N",
            "at, mm",
            "mean, N",
            "lateral: peak, N",
            "at, mm",
        ]
        .map(String::from),
    ];
    rows.extend(bridge.inclusions.iter().map(|found| {
        [
            found.name.clone(),
            format!("{:.3}", found.peak_normal),
            format!("{:.1}", 1e3 * found.peak_normal_at),
            format!("{:.3}", found.mean_normal),
            format!("{:.3}", found.peak_lateral),
            format!("{:.1}", 1e3 * found.peak_lateral_at),
        ]
    }));
    text += &columns(&rows);
    text += "  The maps are what the subjects felt only where the maps were played back.\n";
    for condition in &bridge.conditions {
        text += &format!("\n{}", bridge_condition(condition, bridge));
    }
    text
}

fn bridge_condition(condition: &ConditionBridge, bridge: &Bridge) -> String {
    let mut header: Vec<String> = vec![condition.name.clone(), "noise, N".into()];
    header.extend(
        bridge
            .inclusions
            .iter()
            .map(|inclusion| inclusion.name.clone()),
    );
    header.extend(["p, one noise", "p, by subject", "lapse", "p", ""].map(String::from));
    let mut observed = vec!["counted".into(), String::new()];
    observed.extend(
        condition
            .observed
            .iter()
            .map(|found| format!("{:.3}", found.rate)),
    );
    let mut subjects = vec!["  subjects as sample".into(), String::new()];
    subjects.extend(
        condition
            .observed
            .iter()
            .map(|found| found.clustered_bounds.map_or("-".into(), bounds)),
    );
    let mut noise = vec!["  peak normal force/gamma, N".into(), String::new()];
    noise.extend(condition.noise_by_inclusion.iter().map(|found| {
        let value = found
            .noise
            .map_or("-".into(), |noise| format!("{noise:.3}"));
        format!("{value} {}", open(found.pooled_bounds, 1.0, 2))
    }));
    let mut clustered = vec!["  subjects as sample".into(), String::new()];
    clustered.extend(condition.noise_by_inclusion.iter().map(|found| {
        found
            .clustered_bounds
            .map_or("-".into(), |found| open(found, 1.0, 2))
    }));
    let mut rows = vec![header, observed, subjects, noise, clustered];
    rows.extend(condition.conventions.iter().map(convention));
    for row in &mut rows {
        row.resize(7 + bridge.inclusions.len(), String::new());
    }
    let mut text = format!("{}  {}\n", columns(&rows), condition.verdict.text);
    if let Some(survives) = &condition.verdict.survives {
        text += &format!("\n{}  {survives}\n", weights(condition));
    }
    text
}

/// The weights that the level of the normal force may have.
fn weights(condition: &ConditionBridge) -> String {
    let mut rows = vec![
        [
            "weight of the level",
            "sweep, mm",
            "left",
            "best",
            "deviance: whole level",
            "p",
            "less its mean",
            "lateral",
            "fits worst",
        ]
        .map(String::from),
    ];
    let deviance = |fit: Option<WeightFit>| {
        fit.map_or("-".into(), |fit: WeightFit| format!("{:.1}", fit.deviance))
    };
    rows.extend(condition.weights.iter().map(|range| {
        let whole = range.whole_level;
        [
            range.statistic.text().into(),
            format!("±{:.0}", 1e3 * range.half_sweep),
            format!("{:.2}-{:.2}", range.left.lower, range.left.upper),
            format!("{:.2}", range.best_weight),
            deviance(whole),
            p_value(whole.and_then(|fit| fit.p_value_dispersed)),
            deviance(range.no_level),
            deviance(range.lateral),
            range.fits_worst.map_or("-".into(), |worst| worst.text()),
        ]
    }));
    columns(&rows)
}

fn convention(fit: &ConventionFit) -> Vec<String> {
    let mut row = vec![fit.name.clone()];
    match &fit.common {
        Some(common) => {
            row.push(format!("{:.3}", common.noise));
            row.extend(common.predicted.iter().map(|share| format!("{share:.3}")));
            row.push(p_value(
                common.p_value_clustered.or(common.p_value_dispersed),
            ));
        }
        None => row.resize(3 + fit.signals.len(), "-".into()),
    }
    let with_lapse = &fit.by_subject_with_lapse;
    row.extend([
        p_value(Some(fit.by_subject.p_value)),
        format!("{:.3}", with_lapse.lapse),
        p_value(Some(with_lapse.p_value)),
        if fit.is_rejected {
            "rejected".into()
        } else {
            String::new()
        },
    ]);
    row
}

/// Lines of left-aligned columns.
fn columns<Row: AsRef<[String]>>(rows: &[Row]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.as_ref().get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let line = |row: &Row| {
        let cells = row.as_ref().iter().enumerate();
        let padded = cells.map(|(column, cell)| format!("{cell:<0$}", width(column)));
        format!("  {}", padded.collect::<Vec<_>>().join("  "))
            .trim_end()
            .to_string()
            + "\n"
    };
    rows.iter().map(line).collect()
}

fn bounds(found: Bounds) -> String {
    format!("[{:.3}, {:.3}]", found.lower, found.upper)
}

/// An interval times `scale`; an end that is missing is said to be.
fn open(found: OpenBounds, scale: f64, digits: usize) -> String {
    let end =
        |end: Option<f64>| end.map_or("no bound".into(), |end| format!("{:.digits$}", scale * end));
    format!("[{}, {}]", end(found.lower), end(found.upper))
}

fn p_value(p: Option<f64>) -> String {
    match p {
        None => "-".into(),
        Some(p) if p < 1e-3 => format!("{p:.0e}"),
        Some(p) => format!("{p:.3}"),
    }
}
