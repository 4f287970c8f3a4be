//! The paper's subjects: what their answers say by themselves, and against the forces.

use super::paper;
use super::text::extremes;
use crate::psychophysics::bridge::{Bridge, bridge};
use crate::psychophysics::{Analysis, AnswerTable, Bounds};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;
use palpate::stats::normal;

/// The bridge from those of `maps` whose phantom `name_of` calls one of the paper's to the answers of `table`; `None` with fewer than
/// two.
///
/// # Errors
/// If a map is not over the poses of the reference.
///
/// Implements: REP-070.
pub(super) fn bridge_to(
    table: &AnswerTable,
    reference: &ForceMap,
    maps: &[ForceMap],
    name_of: fn(&Phantom) -> Option<&'static str>,
) -> Result<Option<Bridge>, Refusal> {
    let column = |name| {
        let is_named = |map: &&ForceMap| map.phantom().and_then(name_of) == Some(name);
        Some((name, maps.iter().find(is_named)?))
    };
    let columns: Vec<_> = paper::INCLUSIONS.into_iter().filter_map(column).collect();
    // Fewer than two depths say nothing of how rates fall with depth.
    let has_depths = columns.len() >= 2;
    has_depths
        .then(|| bridge(table, reference, &columns, None))
        .transpose()
}

/// How much wider, at the least and at the most, the intervals by subject are than the exact ones of all answers pooled.
pub(super) fn width_ratios(people: &Analysis) -> Option<[f64; 2]> {
    let inclusions = people.conditions.iter().flat_map(|of| &of.inclusions);
    extremes(inclusions.filter_map(|of| Some(of.clustered.as_ref()?.width_ratio)))
}

/// The normal approximation to a 95 % interval of a share of `trials` answers, cut off at 0 and 1: what the paper's
/// error bars come nearest to.
///
/// Implements: REP-030.
pub(super) fn normal_approximation(share: f64, trials: u64) -> Bounds {
    // The quantile is defined at this probability.
    let quantile = normal::quantile(0.975).unwrap_or(f64::NAN);
    let reach = quantile * libm::sqrt(share * (1.0 - share) / trials as f64);
    Bounds {
        lower: (share - reach).max(0.0),
        upper: (share + reach).min(1.0),
    }
}
