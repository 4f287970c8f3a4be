//! What the fits say of the question which part of the force the subjects used.

use super::{
    Channel, Convention, ConventionFit, LEVEL, Statistic, Support, Verdict, WeightRange, told_apart,
};
use crate::psychophysics::noise::{BACKDRIVE_FRICTION, HUMAN_PERCEPTION, QUANTIZATION};

/// The verdict on all conventions of one condition, and on the weights of the level, `ranges` of them over all conditions.
///
/// Implements: PSY-080, PSY-081, PSY-082, PSY-087.
pub fn verdict(fits: &[ConventionFit], weights: &[WeightRange], ranges: usize) -> Verdict {
    let names = |rejected: bool| {
        let chosen = fits.iter().filter(|fit| fit.is_rejected == rejected);
        chosen.map(|fit| fit.name.clone()).collect::<Vec<_>>()
    };
    let fits_some = |uniform: bool| {
        let of_kind = |fit: &&ConventionFit| fit.convention.uses_uniform_part() == uniform;
        fits.iter().filter(of_kind).any(|fit| !fit.is_rejected)
    };
    let support = match (fits_some(true), fits_some(false)) {
        (true, true) => Support::Undecided,
        (true, false) => Support::UniformPart,
        (false, true) => Support::ChangeAlongSweep,
        (false, false) => Support::None,
    };
    Verdict {
        support,
        compatible: names(false),
        rejected: names(true),
        survives: survives(weights, ranges),
        text: text(fits, support),
    }
}

/// What holds over all sweeps, with the number of ranges and the dispersion counted.
///
/// Implements: PSY-087.
fn survives(weights: &[WeightRange], ranges: usize) -> Option<String> {
    let (first, last) = (weights.first()?, weights.last()?);
    let all = weights.len();
    let count = |holds: &dyn Fn(&WeightRange) -> bool| match weights
        .iter()
        .filter(|of| holds(of))
        .count()
    {
        n if n == all => format!("all {all}"),
        n => format!("{n} of {all}"),
    };
    let uppers = weights.iter().map(|range| range.left.upper);
    let largest = uppers.fold(0.0, f64::max);
    Some(format!(
        "Over sweeps of ±{:.0} to ±{:.0} mm, by the peak and by the whole sweep, the whole level of the normal force fits worse than the same force less its mean and than the lateral force in {} fits. Against the best weight of the level, with the dispersion and {ranges} ranges counted, it is rejected in {}; the largest weight of the level that one of them leaves is {largest:.2}.",
        1e3 * first.half_sweep_m,
        1e3 * last.half_sweep_m,
        count(&WeightRange::level_fits_worst),
        count(&|range| range.left.upper < 1.0),
    ))
}

/// The verdict in sentences.
fn text(fits: &[ConventionFit], support: Support) -> String {
    let uniform = best(fits, |of, _| of.uses_uniform_part());
    let is_normal = |of: Convention| of.channel == Channel::Normal && !of.uses_uniform_part();
    let normal = best(fits, |of, _| is_normal(of));
    let lateral = best(fits, |of, _| of.channel == Channel::Lateral);
    let mut sentences = vec![conclusion(support)];
    for (kind, fit) in [
        (
            "the conventions with the level of the normal force",
            uniform,
        ),
        ("those with the normal force less its mean", normal),
        ("those with the lateral force alone", lateral),
    ] {
        sentences.extend(fit.map(|fit| evidence(kind, fit)));
    }
    sentences.extend(both_of(normal, lateral));
    sentences.push(heterogeneity(fits));
    sentences.extend(against_table_2(fits));
    sentences.join(" ")
}

fn conclusion(support: Support) -> String {
    let level = LEVEL * 100.0;
    match support {
        Support::ChangeAlongSweep => format!(
            "Over the whole of these maps, each convention by itself and the answers of a subject taken as binomial, the counts support subjects who use how the force changes along the sweep: at {level} % every convention that counts the whole level of the normal force is rejected, and at least one without it is not."
        ),
        Support::UniformPart => format!(
            "Over the whole of these maps, each convention by itself and the answers of a subject taken as binomial, the counts support subjects who use the level of the normal force: at {level} % only conventions that count its uniform part are not rejected."
        ),
        Support::Undecided => format!(
            "The counts do not tell whether the subjects used the level of the normal force: at {level} % some conventions with its uniform part and some without it are not rejected."
        ),
        Support::None => {
            format!("No convention fits the counts: at {level} % all are rejected.")
        }
    }
}

fn evidence(kind: &str, fit: &ConventionFit) -> String {
    let best = match fit.by_subject_with_lapse.p_value > fit.by_subject.p_value {
        true => &fit.by_subject_with_lapse,
        false => &fit.by_subject,
    };
    let lapse = match best.lapse > 0.0 {
        true => format!(" and {:.1} % lapses", 100.0 * best.lapse),
        false => String::new(),
    };
    format!(
        "Of {kind}, “{}” fits best: with a noise level for each subject{lapse} the deviance is {:.1} where {:.1} ± {:.1} is expected, p = {}.",
        fit.name,
        best.deviance,
        best.expected_deviance,
        best.deviance_sd,
        p_value(fit.p_value)
    )
}

/// Whether the normal force less its mean and the lateral force can be told apart.
///
/// Implements: PSY-081.
fn both_of(normal: Option<&ConventionFit>, lateral: Option<&ConventionFit>) -> Option<String> {
    let p = told_apart(normal?, lateral?)?;
    let [normal, lateral] = [normal?, lateral?].map(|fit| fit.by_subject_with_lapse.deviance);
    let said = match normal < lateral {
        _ if p >= LEVEL => "normal force less its mean and the lateral force cannot be told apart",
        true => "normal force fits the better of these two",
        false => "lateral force fits the better of these two",
    };
    let p = p_value(p);
    Some(format!(
        "Over this sweep the {said} (subjects as blocks, p = {p})."
    ))
}

/// Whether one noise level for all would do, by Akaike's criterion of the best convention.
///
/// Implements: PSY-082.
fn heterogeneity(fits: &[ConventionFit]) -> String {
    let aic = |fit: &&ConventionFit| fit.by_subject.aic;
    let best = fits.iter().min_by(|a, b| aic(a).total_cmp(&aic(b)));
    let Some((best, common)) = best.and_then(|best| Some((best, best.common.as_ref()?))) else {
        return "No noise level for all subjects together can be fitted.".into();
    };
    let gain = common.aic - best.by_subject.aic;
    if gain > 0.0 {
        format!(
            "Subjects differ: for “{}”, one noise level for all, {:.3} N, has an AIC larger by {gain:.0} than one for each.",
            best.name, common.noise_n
        )
    } else {
        format!(
            "One noise level for all, {:.3} N for “{}”, is enough: its AIC is smaller by {:.0} than with one for each.",
            common.noise_n, best.name, -gain
        )
    }
}

/// The noise of the best peak convention that is not rejected beside that of Table 2, which is for one moment.
///
/// Implements: PSY-083.
fn against_table_2(fits: &[ConventionFit]) -> Option<String> {
    let fit = best(fits, |of, is_rejected| {
        of.statistic == Statistic::Peak && !is_rejected
    })?;
    let noise = fit.common.as_ref()?.noise_n;
    let squares = [QUANTIZATION, BACKDRIVE_FRICTION, HUMAN_PERCEPTION].map(|n| n * n);
    let table = libm::sqrt(squares.iter().sum());
    let remark = match noise < table {
        true => {
            "smaller, so that subjects with the noise of Table 2 would have to combine several moments of the sweep"
        }
        false => "at least as large, so that Table 2 leaves room for it",
    };
    Some(format!(
        "The one noise level for “{}”, {noise:.3} N, is {:.2} of the {table:.3} N that Table 2 of the paper adds up to for playback: {remark}.",
        fit.name,
        noise / table
    ))
}

/// The first convention of a kind, rejected or not, with the largest p-value.
fn best(
    fits: &[ConventionFit],
    is_kind: impl Fn(Convention, bool) -> bool,
) -> Option<&ConventionFit> {
    let of_kind = fits
        .iter()
        .filter(|fit| is_kind(fit.convention, fit.is_rejected));
    // The last of equals, backwards.
    of_kind.rev().max_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

fn p_value(p: f64) -> String {
    match p < 0.001 {
        true => format!("{p:.0e}").replace('-', "−"),
        false => format!("{p:.3}"),
    }
}
