//! The answer of `palpate psychophysics` for people.

use super::psychophysics::Answer;
use crate::psychophysics::bridge::{Bridge, ConditionBridge, ConventionFit, WeightFit};
use crate::psychophysics::{
    Bounds, ConditionAnalysis, ConditionComparison, Difference, InclusionAnalysis,
    NoiseDecomposition, OpenBounds, Parameter, Psychometric,
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
    let over_all = condition.dispersion;
    let over_all = over_all.map(|ratio| format!(", chi2/df {ratio:.2} over all"));
    let mut text = format!(
        "{} ({} subjects{})\n",
        condition.name,
        condition.subjects.len(),
        over_all.unwrap_or_default()
    );
    text += &table(
        "inclusion|right|share|Clopper-Pearson|Wilson|subjects as sample|gamma|chi2/df|p|rho",
        condition.inclusions.iter().map(inclusion),
    );
    let mut dispersions = condition.inclusions.iter().filter_map(|of| of.dispersion);
    if dispersions.any(|found| found.is_rough) {
        text += "  * p is rough: a subject's expected count of wrong answers is below 5\n";
    }
    text += &match &condition.psychometric {
        Some(found) => psychometric(found),
        None => "  no psychometric function: it needs three depths and answers of two subjects that are not all right\n".into(),
    };
    let names = row(&["subject"], &condition.inclusions, |of| of.name.clone());
    let subjects = condition.subjects.iter().map(|subject| {
        row(&[&subject.name], &subject.rates, |of| {
            let exact = bounds(of.clopper_pearson);
            format!("{}/{} {exact}", of.correct, of.trials)
        })
    });
    text + &columns(&[names].into_iter().chain(subjects).collect::<Vec<_>>())
}

fn inclusion(inclusion: &InclusionAnalysis) -> Vec<String> {
    let pooled = &inclusion.pooled;
    let gamma = or_dash(pooled.gamma.gamma, |gamma| format!("{gamma:.2}"));
    vec![
        inclusion.name.clone(),
        format!("{}/{}", pooled.correct, pooled.trials),
        format!("{:.3}", pooled.rate),
        bounds(pooled.clopper_pearson),
        bounds(pooled.wilson),
        or_dash(inclusion.clustered, |found| bounds(found.bounds)),
        format!("{gamma} {}", open(pooled.gamma.bounds, 1.0, 2)),
        or_dash(inclusion.dispersion, |found| format!("{:.2}", found.ratio)),
        or_dash(inclusion.dispersion, |found| {
            p_value(Some(found.p_value)) + if found.is_rough { " *" } else { "" }
        }),
        or_dash(inclusion.beta_binomial, |found| {
            let ends = open(found.correlation_bounds, 1.0, 3);
            format!("{:.3} {ends}", found.correlation)
        }),
    ]
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
    let row = |pair: String, inclusion: &str, difference: &Difference, holm: String| {
        vec![
            pair,
            inclusion.into(),
            format!("{:+.3}", difference.mean),
            or_dash(difference.bounds, bounds),
            p_value(difference.p_value),
            holm,
        ]
    };
    let rows = comparisons.iter().flat_map(|of| {
        let pair = format!("{} - {}", of.first, of.second);
        let mut rows = vec![row(pair, "all", &of.overall, p_value(of.p_value_holm))];
        let each = of.by_inclusion.iter();
        let none = String::new;
        rows.extend(each.map(|of| row(none(), &of.inclusion, &of.difference, none())));
        rows
    });
    let header =
        "difference of shares|inclusion|mean|subjects as sample|p, signs exchanged|p, Holm";
    let title = "Conditions, each subject against itself (the order in which a subject met the conditions is not known)\n";
    (!comparisons.is_empty()).then(|| title.to_string() + &table(header, rows))
}

fn noise_levels(found: &NoiseDecomposition) -> String {
    let milli = |bounds: Option<OpenBounds>| bounds.map_or(String::new(), |b| open(b, 1e3, 0));
    let levels = found.levels.iter().map(|level| {
        vec![
            level.name.into(),
            or_dash(level.printed, |noise| format!("{:.0}", 1e3 * noise)),
            format!("{:.1}", 1e3 * level.noise),
            milli(level.pooled_bounds),
            milli(level.clustered_bounds),
            level.formula.clone(),
        ]
    });
    let header = "noise, mN|paper|here|all pooled|subjects as sample|formula";
    let mut text = "Noise levels of the paper's section 5\n".to_string() + &table(header, levels);
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
    let note = bridge.probe_depth_note.iter();
    text.extend(note.map(|note| format!("  {note}\n")));
    text += &table(
        "inclusion|normal: peak, N|at, mm|mean, N|lateral: peak, N|at, mm",
        bridge.inclusions.iter().map(|found| {
            vec![
                found.name.clone(),
                format!("{:.3}", found.peak_normal),
                format!("{:.1}", 1e3 * found.peak_normal_at),
                format!("{:.3}", found.mean_normal),
                format!("{:.3}", found.peak_lateral),
                format!("{:.1}", 1e3 * found.peak_lateral_at),
            ]
        }),
    );
    text += "  The maps are what the subjects felt only where the maps were played back.\n";
    for condition in &bridge.conditions {
        text += &format!("\n{}", bridge_condition(condition, bridge));
    }
    text
}

fn bridge_condition(condition: &ConditionBridge, bridge: &Bridge) -> String {
    let (observed, noise) = (&condition.observed, &condition.noise_by_inclusion);
    let mut header = row(&[&condition.name, "noise, N"], &bridge.inclusions, |of| {
        of.name.clone()
    });
    header.extend(["p, one noise", "p, by subject", "lapse", "p"].map(String::from));
    let mut rows = vec![
        header,
        row(&["counted", ""], observed, |of| format!("{:.3}", of.rate)),
        row(&["  subjects as sample", ""], observed, |of| {
            or_dash(of.clustered_bounds, bounds)
        }),
        row(&["  peak normal force/gamma, N", ""], noise, |of| {
            let value = or_dash(of.noise, |noise| format!("{noise:.3}"));
            format!("{value} {}", open(of.pooled_bounds, 1.0, 2))
        }),
        row(&["  subjects as sample", ""], noise, |of| {
            or_dash(of.clustered_bounds, |found| open(found, 1.0, 2))
        }),
    ];
    rows.extend(condition.conventions.iter().map(convention));
    let mut text = format!("{}  {}\n", columns(&rows), condition.verdict.text);
    if let Some(survives) = &condition.verdict.survives {
        text += &format!("\n{}  {survives}\n", weights(condition));
    }
    text
}

/// The weights that the level of the normal force may have.
fn weights(condition: &ConditionBridge) -> String {
    let deviance = |fit: Option<WeightFit>| or_dash(fit, |fit| format!("{:.1}", fit.deviance));
    let rows = condition.weights.iter().map(|range| {
        let whole = range.whole_level;
        vec![
            range.statistic.text().into(),
            format!("±{:.0}", 1e3 * range.half_sweep),
            format!("{:.2}-{:.2}", range.left.lower, range.left.upper),
            format!("{:.2}", range.best_weight),
            deviance(whole),
            p_value(whole.and_then(|fit| fit.p_value_dispersed)),
            deviance(range.no_level),
            deviance(range.lateral),
            or_dash(range.fits_worst, |worst| worst.text()),
        ]
    });
    table(
        "weight of the level|sweep, mm|left|best|deviance: whole level|p|less its mean|lateral|fits worst",
        rows,
    )
}

fn convention(fit: &ConventionFit) -> Vec<String> {
    let mut row = vec![fit.name.clone()];
    if let Some(common) = &fit.common {
        row.push(format!("{:.3}", common.noise));
        row.extend(common.predicted.iter().map(|share| format!("{share:.3}")));
        row.push(p_value(
            common.p_value_clustered.or(common.p_value_dispersed),
        ));
    }
    row.resize(3 + fit.signals.len(), "-".into());
    let with_lapse = &fit.by_subject_with_lapse;
    row.extend([
        p_value(Some(fit.by_subject.p_value)),
        format!("{:.3}", with_lapse.lapse),
        p_value(Some(with_lapse.p_value)),
    ]);
    row.extend(fit.is_rejected.then(|| "rejected".into()));
    row
}

/// Lines of left-aligned columns under the headings, which | separates.
fn table(headings: &str, rows: impl Iterator<Item = Vec<String>>) -> String {
    let headings = headings.split('|').map(String::from).collect();
    columns(&[headings].into_iter().chain(rows).collect::<Vec<_>>())
}

/// A row with a cell for each of some things.
fn row<T>(first: &[&str], things: &[T], text: impl Fn(&T) -> String) -> Vec<String> {
    let first = first.iter().map(|cell| cell.to_string());
    first.chain(things.iter().map(text)).collect()
}

/// Lines of left-aligned columns; a row may have fewer than others.
fn columns(rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let line = |row: &Vec<String>| {
        let cells = row.iter().enumerate();
        let padded = cells.map(|(column, cell)| format!("{cell:<0$}", width(column)));
        let line = format!("  {}", padded.collect::<Vec<_>>().join("  "));
        line.trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

fn or_dash<T>(found: Option<T>, text: impl FnOnce(T) -> String) -> String {
    found.map_or("-".into(), text)
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
    or_dash(p, |p| match p < 1e-3 {
        true => format!("{p:.0e}"),
        false => format!("{p:.3}"),
    })
}
