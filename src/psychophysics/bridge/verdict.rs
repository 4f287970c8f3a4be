//! What the fits say of the question which part of the force the subjects used.

use super::{Channel, ConventionFit, LEVEL, Support, Verdict};

/// The verdict on all conventions of one condition.
///
/// Implements: PSY-080, PSY-081, PSY-082.
pub fn verdict(fits: &[ConventionFit]) -> Verdict {
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
        text: text(fits, support),
    }
}

/// The verdict in sentences.
fn text(fits: &[ConventionFit], support: Support) -> String {
    let uniform = largest_p(fits, |fit| fit.convention.uses_uniform_part());
    let normal = largest_p(fits, |fit| {
        !fit.convention.uses_uniform_part() && fit.convention.channel == Channel::Normal
    });
    let lateral = largest_p(fits, |fit| fit.convention.channel == Channel::Lateral);
    let mut sentences = vec![conclusion(support)];
    for (what, fit) in [
        ("with the uniform part of the normal force", uniform),
        ("the normal force less its mean", normal),
        ("the lateral force alone", lateral),
    ] {
        if let Some(fit) = fit {
            sentences.push(evidence(what, fit));
        }
    }
    sentences.extend(both_of(normal, lateral));
    sentences.push(heterogeneity(fits));
    sentences.join(" ")
}

fn conclusion(support: Support) -> String {
    let level = LEVEL * 100.0;
    match support {
        Support::ChangeAlongSweep => format!(
            "The counts support subjects who use how the force changes along the sweep, not its level: at {level} % every convention that counts the uniform part of the normal force is rejected, and at least one without it is not."
        ),
        Support::UniformPart => format!(
            "The counts support subjects who use the level of the normal force: at {level} % only conventions that count its uniform part are not rejected."
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
        format!(", {:.1} % lapses", 100.0 * best.lapse)
    } else {
        String::new()
    };
    format!(
        "Best {what}: {} (a noise level for each subject{lapse}: deviance {:.1} where {:.1} ± {:.1} is expected, p = {}).",
        fit.name,
        best.deviance,
        best.expected_deviance,
        best.deviance_sd,
        p_value(fit.p_value)
    )
}

/// Whether the normal force less its mean and the lateral force can be told apart.
fn both_of(normal: Option<&ConventionFit>, lateral: Option<&ConventionFit>) -> Option<String> {
    let (normal, lateral) = (normal?, lateral?);
    if normal.is_rejected || lateral.is_rejected {
        return None;
    }
    Some(
        "The normal force less its mean and the lateral force both fit, and cannot be told apart by these counts."
            .into(),
    )
}

/// Whether one noise level for all would do, by Akaike's criterion of the best convention.
///
/// Implements: PSY-082.
fn heterogeneity(fits: &[ConventionFit]) -> String {
    let best = fits
        .iter()
        .min_by(|a, b| a.by_subject.aic.total_cmp(&b.by_subject.aic));
    let Some((best, common)) = best.and_then(|best| Some((best, best.common.as_ref()?))) else {
        return "No noise level for all subjects together can be fitted.".into();
    };
    let gain = common.aic - best.by_subject.aic;
    if gain > 0.0 {
        format!(
            "Subjects differ: for {} one noise level for all, {:.3} N, has an AIC larger by {gain:.0} than one for each.",
            best.name, common.noise
        )
    } else {
        format!(
            "One noise level for all, {:.3} N for {}, is enough: its AIC is smaller by {:.0} than with one for each.",
            common.noise, best.name, -gain
        )
    }
}

fn largest_p(
    fits: &[ConventionFit],
    is_kind: impl Fn(&ConventionFit) -> bool,
) -> Option<&ConventionFit> {
    let of_kind = fits.iter().filter(|fit| is_kind(fit));
    of_kind.max_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

fn p_value(p: f64) -> String {
    if p < 0.001 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}
