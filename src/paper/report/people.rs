//! The paper's subjects: what their answers say by themselves, and against the forces.

use super::maps::MapFindings;
use super::text::extremes;
use super::{Run, paper};
use crate::psychophysics::bridge::{Bridge, bridge};
use crate::psychophysics::{Analysis, AnswerTable, Bounds};
use palpate::refusal::Refusal;
use palpate::stats::normal;

/// The bridge from those maps of `run` whose findings are in `compared` to the answers of `table`; `None` with fewer than two.
///
/// # Errors
/// If a map is not over the poses of the reference.
///
/// Implements: REP-070.
pub(super) fn bridge_to(
    table: &AnswerTable,
    run: &Run,
    compared: &[MapFindings],
) -> Result<Option<Bridge>, Refusal> {
    let columns = paper::INCLUSIONS.into_iter().filter_map(|name| {
        let of_map = |map: &MapFindings| map.paper_phantom == Some(name);
        let index = compared.iter().position(of_map)?;
        Some((name, run.maps.get(index)?))
    });
    let columns: Vec<_> = columns.collect();
    // Fewer than two depths say nothing of how rates fall with depth.
    let has_depths = columns.len() >= 2;
    has_depths
        .then(|| bridge(table, &run.reference, &columns, None))
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
