//! What the fits say of the question which part of the force the subjects used.

use super::{Channel, ConventionFit, LEVEL, Statistic, Support, Verdict, WeightRange, told_apart};
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
    let count = |holds: &dyn Fn(&WeightRange) -> bool| {
        let all = weights.len();
        match weights.iter().filter(|range| holds(range)).count() {
            n if n == all => format!("all {all}"),
            n => format!("{n} of {all}"),
        }
    };
    let largest = weights
        .iter()
        .fold(0.0, |w: f64, range| w.max(range.left.upper));
    Some(format!(
        "Over sweeps of ±{:.0} to ±{:.0} mm, by the peak and by the whole sweep, the whole level of the normal force fits worse than the same force less its mean and than the lateral force in {} fits. Against the best weight of the level, with the dispersion and {ranges} ranges counted, it is rejected in {}; the largest weight of the level that one of them leaves is {largest:.2}.",
        1e3 * first.half_sweep,
        1e3 * last.half_sweep,
        count(&WeightRange::level_fits_worst),
        count(&|range| range.left.upper < 1.0),
    ))
}

/// The verdict in sentences.
fn text(fits: &[ConventionFit], support: Support) -> String {
    let uniform = best(fits, |fit| fit.convention.uses_uniform_part());
    let normal = best(fits, |fit| {
        !fit.convention.uses_uniform_part() && fit.convention.channel == Channel::Normal
    });
    let lateral = best(fits, |fit| fit.convention.channel == Channel::Lateral);
    let mut sentences = vec![conclusion(support)];
    for (what, fit) in [
        (
            "Of the conventions with the level of the normal force",
            uniform,
        ),
        ("Of those with the normal force less its mean", normal),
        ("Of those with the lateral force alone", lateral),
    ] {
        sentences.extend(fit.map(|fit| evidence(what, fit)));
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

fn evidence(what: &str, fit: &ConventionFit) -> String {
    let best = if fit.by_subject_with_lapse.p_value > fit.by_subject.p_value {
        &fit.by_subject_with_lapse
    } else {
        &fit.by_subject
    };
    let lapse = if best.lapse > 0.0 {
        format!(" and {:.1} % lapses", 100.0 * best.lapse)
    } else {
        String::new()
    };
    format!(
        "{what}, “{}” fits best: with a noise level for each subject{lapse} the deviance is {:.1} where {:.1} ± {:.1} is expected, p = {}.",
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
    let (normal, lateral) = (normal?, lateral?);
    let p = told_apart(normal, lateral)?;
    let [normal_deviance, lateral_deviance] =
        [normal, lateral].map(|fit| fit.by_subject_with_lapse.deviance);
    Some(if p >= LEVEL {
        format!(
            "Over this sweep the normal force less its mean and the lateral force cannot be told apart (subjects as blocks, p = {}).",
            p_value(p)
        )
    } else {
        format!(
            "Over this sweep the {} force fits the better of these two (subjects as blocks, p = {}).",
            if normal_deviance < lateral_deviance {
                "normal"
            } else {
                "lateral"
            },
            p_value(p)
        )
    })
}

/// Whether one noise level for all would do, by Akaike's criterion of the best convention.
///
/// Implements: PSY-082.
fn heterogeneity(fits: &[ConventionFit]) -> String {
    let smallest = fits
        .iter()
        .min_by(|a, b| a.by_subject.aic.total_cmp(&b.by_subject.aic));
    let Some((best, common)) = smallest.and_then(|best| Some((best, best.common.as_ref()?))) else {
        return "No noise level for all subjects together can be fitted.".into();
    };
    let gain = common.aic - best.by_subject.aic;
    if gain > 0.0 {
        format!(
            "Subjects differ: for “{}”, one noise level for all, {:.3} N, has an AIC larger by {gain:.0} than one for each.",
            best.name, common.noise
        )
    } else {
        format!(
            "One noise level for all, {:.3} N for “{}”, is enough: its AIC is smaller by {:.0} than with one for each.",
            common.noise, best.name, -gain
        )
    }
}

/// The noise of the best peak convention that is not rejected beside that of Table 2, which is for one moment.
///
/// Implements: PSY-083.
fn against_table_2(fits: &[ConventionFit]) -> Option<String> {
    let compatible_peak =
        |fit: &ConventionFit| fit.convention.statistic == Statistic::Peak && !fit.is_rejected;
    let fit = best(fits, compatible_peak)?;
    let noise = fit.common.as_ref()?.noise;
    let table = libm::sqrt(
        [QUANTIZATION, BACKDRIVE_FRICTION, HUMAN_PERCEPTION]
            .iter()
            .map(|source| source * source)
            .sum(),
    );
    let remark = if noise < table {
        "smaller, so that subjects with the noise of Table 2 would have to combine several moments of the sweep"
    } else {
        "at least as large, so that Table 2 leaves room for it"
    };
    Some(format!(
        "The one noise level for “{}”, {noise:.3} N, is {:.2} of the {table:.3} N that Table 2 of the paper adds up to for playback: {remark}.",
        fit.name,
        noise / table
    ))
}

/// The first convention of a kind with the largest p-value.
fn best(
    fits: &[ConventionFit],
    is_kind: impl Fn(&ConventionFit) -> bool,
) -> Option<&ConventionFit> {
    let of_kind = fits.iter().filter(|fit| is_kind(fit));
    of_kind.reduce(|best, fit| {
        if fit.p_value > best.p_value {
            fit
        } else {
            best
        }
    })
}

fn p_value(p: f64) -> String {
    if p < 0.001 {
        format!("{p:.0e}").replace('-', "−")
    } else {
        format!("{p:.3}")
    }
}
