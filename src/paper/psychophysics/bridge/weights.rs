//! How much of the level of the normal force may count, over how wide a sweep.
//!
//! How far a subject swept is not known, and the level may count in part. With weight w the signal of the whole sweep is
//! √(w² mean² + change²); w = 1 and w = 0 are the two conventions.

use rayon::prelude::*;

use super::common::Signals;
use super::signals::{Signal, is_within};
use super::subjects::by_subject;
use super::{Channel, Convention, Mean, Observations, Statistic, WeightFit, WeightRange};
use crate::psychophysics::Result;
use crate::psychophysics::dispersion::Overdispersion;
use crate::psychophysics::rates::Bounds;
use palpate::force_map::SAME_POSITION;

/// Half sweeps that are tried, mm.
const HALF_SWEEPS_MM: core::ops::RangeInclusive<u32> = 3..=10;
/// Steps of the weight from 0 to 1.
const STEPS: u32 = 20;
/// What of the sweep counts.
pub const STATISTICS: [Statistic; 2] = [Statistic::Peak, Statistic::MatchedFilter];

/// The half sweeps, m, both of whose ends lie on these positions, two of which they hold at the least.
///
/// Implements: PSY-085.
pub fn half_sweeps(laterals: &[f64]) -> Vec<f64> {
    let reach = |sign: f64| laterals.iter().map(|x| sign * x).fold(0.0, f64::max);
    let widest = f64::min(reach(-1.0), reach(1.0));
    let fits = |half: &f64| {
        let inside = laterals.iter().filter(|&&x| is_within(x, *half));
        *half <= widest + SAME_POSITION && inside.count() > 1
    };
    let sweeps = HALF_SWEEPS_MM.map(|half| 1e-3 * f64::from(half));
    sweeps.filter(fits).collect()
}

/// The range of weights for each sweep and statistic, each rejected below `level`.
///
/// Implements: PSY-085.
pub fn weight_ranges(
    signals: &[Signal],
    observed: &Observations,
    half_sweeps: &[f64],
    level: f64,
) -> Result<Vec<WeightRange>> {
    let ranges = |&half: &f64| {
        let within: Vec<_> = signals.iter().map(|signal| signal.within(half)).collect();
        STATISTICS.map(|statistic| weight_range(&within, observed, (half, statistic), level))
    };
    // All of them, so that the first error is the same for any number of threads.
    let ranges: Vec<_> = half_sweeps.par_iter().map(ranges).collect();
    let ranges = ranges.into_iter().flatten();
    ranges.filter_map(Result::transpose).collect()
}

/// `None` without a difference of the normal force.
fn weight_range(
    signals: &[Signal],
    observed: &Observations,
    (half_sweep, statistic): (f64, Statistic),
    level: f64,
) -> Result<Option<WeightRange>> {
    let at = |channel, weight| weigh(signals, observed, (statistic, channel), weight);
    let mut fits: Vec<WeightFit> = Vec::new();
    for step in 0..=STEPS {
        fits.extend(at(Channel::Normal, f64::from(step) / f64::from(STEPS))?);
    }
    let Some(&best) = fits.iter().min_by(by_deviance) else {
        return Ok(None);
    };
    let is_expected = best.expected_deviance > 0.0;
    let ratio = is_expected.then(|| best.deviance / best.expected_deviance);
    let dispersion = Overdispersion {
        ratio: ratio.unwrap_or(1.0),
        // Less one for the weight itself.
        degrees: best.degrees.saturating_sub(1),
    };
    for fit in fits.iter_mut().filter(|_| dispersion.degrees > 0) {
        fit.p_value_dispersed = dispersion.p_value(fit.deviance - best.deviance, 1)?;
    }
    let is_left = |fit: &&WeightFit| fit.p_value_dispersed.is_none_or(|p| p >= level);
    let left = || fits.iter().filter(is_left).map(|fit| fit.weight);
    let at_weight = |weight| fits.iter().find(|fit| fit.weight == weight).copied();
    // A force that has a level but does not change has no signal at weight 0.
    let (whole_level, no_level) = (at_weight(1.0), at_weight(0.0));
    let lateral = at(Channel::Lateral, 1.0)?;
    Ok(Some(WeightRange {
        half_sweep_m: half_sweep,
        statistic,
        left: Bounds {
            lower: left().fold(1.0, f64::min),
            upper: left().fold(0.0, f64::max),
        },
        dispersion: dispersion.factor(),
        best_weight: best.weight,
        fits_worst: worst(statistic, [whole_level, no_level, lateral]),
        whole_level,
        no_level,
        lateral,
    }))
}

/// One convention at one weight of the level; `None` without a signal.
///
/// Implements: PSY-070.
fn weigh(
    signals: &[Signal],
    observed: &Observations,
    (statistic, channel): (Statistic, Channel),
    weight: f64,
) -> Result<Option<WeightFit>> {
    let strength = |signal: &Signal| signal.weighted(statistic, channel, weight);
    let Some(strengths) = Signals::new(signals, strength) else {
        return Ok(None);
    };
    let fit = by_subject(&strengths, observed)?;
    Ok(Some(WeightFit {
        weight,
        deviance: fit.deviance,
        expected_deviance: fit.expected_deviance,
        degrees: (observed.subjects.len() * (signals.len() - 1)) as u32,
        p_value: fit.p_value,
        p_value_dispersed: None,
    }))
}

fn by_deviance(a: &&WeightFit, b: &&WeightFit) -> core::cmp::Ordering {
    a.deviance.total_cmp(&b.deviance)
}

/// Which of the normal force, the same less its mean and the lateral force has the largest deviance; `None` if two have it, but for
/// rounding.
fn worst(statistic: Statistic, fits: [Option<WeightFit>; 3]) -> Option<Convention> {
    let conventions = [
        (Channel::Normal, Mean::Kept),
        (Channel::Normal, Mean::Removed),
        (Channel::Lateral, Mean::Kept),
    ];
    let pairs = fits.iter().zip(conventions);
    let known = pairs.filter_map(|(fit, convention)| Some((fit.as_ref()?, convention)));
    let mut known: Vec<_> = known.collect();
    known.sort_by(|a, b| by_deviance(&b.0, &a.0));
    let &(worst, (channel, mean)) = known.first()?;
    let is_shared = |(other, _): &(&WeightFit, _)| other.deviance >= (1.0 - 1e-9) * worst.deviance;
    if known.get(1).is_some_and(is_shared) {
        return None;
    }
    Some(Convention {
        statistic,
        channel,
        mean,
    })
}
