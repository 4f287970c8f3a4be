//! What the fits say of the question which part of the force the subjects used.

use askama::Template;

use super::{
    Channel, CommonFit, Convention, ConventionFit, Favoured, LEVEL, Statistic, Verdict,
    WeightRange, told_apart,
};
use crate::psychophysics::noise::{BACKDRIVE_FRICTION, HUMAN_PERCEPTION, QUANTIZATION};

/// The verdict on all conventions of one condition, and on the weights of the level, `ranges` of them over all conditions.
///
/// Implements: PSY-080, PSY-081, PSY-085.
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
        (true, true) => Favoured::Undecided,
        (true, false) => Favoured::UniformPart,
        (false, true) => Favoured::ChangeAlongSweep,
        (false, false) => Favoured::None,
    };
    Verdict {
        support,
        compatible: names(false),
        rejected: names(true),
        survives: survives(weights, ranges),
        // Writing to a String does not fail.
        text: Words::new(fits, support).render().expect("sentences"),
    }
}

/// What holds over all sweeps, with the number of ranges and the dispersion counted.
///
/// Implements: PSY-085.
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

/// The verdict in sentences: the words are in the template.
///
/// Implements: PSY-081.
#[derive(Template)]
#[template(path = "verdict.txt", block = "verdict")]
struct Words<'a> {
    support: Favoured,
    /// The level, %.
    level: f64,
    /// The conventions that fit best with the level of the normal force, with it less its mean, and with the lateral force.
    uniform: Option<&'a ConventionFit>,
    normal: Option<&'a ConventionFit>,
    lateral: Option<&'a ConventionFit>,
    /// Whether the last two can be told apart, with the p-value of that.
    apart: Option<(&'static str, f64)>,
    /// The convention that is best by Akaike's criterion, to tell whether one noise level for all would do.
    common: Option<(&'a ConventionFit, &'a CommonFit)>,
    /// The best peak convention that is not rejected and its noise, N: like that of Table 2, N, it is for one moment.
    peak: Option<(&'a ConventionFit, f64)>,
    table_2: f64,
}

impl Words<'_> {
    fn new(fits: &[ConventionFit], support: Favoured) -> Words<'_> {
        let is_normal = |of: Convention| of.channel == Channel::Normal && !of.uses_uniform_part();
        let normal = best(fits, |of, _| is_normal(of));
        let lateral = best(fits, |of, _| of.channel == Channel::Lateral);
        let aic = |fit: &&ConventionFit| fit.by_subject.aic;
        let least = fits.iter().min_by(|a, b| aic(a).total_cmp(&aic(b)));
        let of_moment =
            |of: Convention, is_rejected: bool| of.statistic == Statistic::Peak && !is_rejected;
        let squares = [QUANTIZATION, BACKDRIVE_FRICTION, HUMAN_PERCEPTION].map(|n| n * n);
        Words {
            support,
            level: LEVEL * 100.0,
            uniform: best(fits, |of, _| of.uses_uniform_part()),
            normal,
            lateral,
            apart: normal.zip(lateral).and_then(apart),
            common: least.and_then(|fit| Some((fit, fit.common.as_ref()?))),
            peak: best(fits, of_moment).and_then(|fit| Some((fit, fit.common.as_ref()?.noise_n))),
            table_2: libm::sqrt(squares.iter().sum()),
        }
    }
}

/// Whether the normal force less its mean and the lateral force can be told apart.
///
/// Implements: PSY-081.
fn apart((normal, lateral): (&ConventionFit, &ConventionFit)) -> Option<(&'static str, f64)> {
    let p = told_apart(normal, lateral)?;
    let [normal, lateral] = [normal, lateral].map(|fit| fit.by_subject_with_lapse.deviance);
    let words = match normal < lateral {
        _ if p >= LEVEL => "normal force less its mean and the lateral force cannot be told apart",
        true => "normal force fits the better of these two",
        false => "lateral force fits the better of these two",
    };
    Some((words, p))
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

fn p_value(p: &f64) -> String {
    if *p < 0.001 {
        format!("{p:.0e}").replace('-', "−")
    } else {
        format!("{p:.3}")
    }
}
