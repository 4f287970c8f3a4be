//! The paper's subjects: what their answers say by themselves, and against the forces.

use super::findings::MapFindings;
use super::{ReportError, Study, paper};
use crate::psychophysics::bridge::{Bridge, bridge};
use crate::psychophysics::{
    Analysis, Bounds, NoiseDecomposition, Table, analyse, paper_noise_levels,
};
use crate::stats::normal;

/// Everything about the subjects.
pub struct Subjects {
    /// What Table 1 says by itself.
    pub people: Analysis,
    /// The paper's noise levels beside ours.
    pub noise: NoiseDecomposition,
    /// Table 1 against the signals.
    pub bridge: Option<Bridge>,
}

/// The analysis of Table 1, and the bridge from those maps of `study` whose findings are in `compared`.
///
/// # Errors
/// [`ReportError::People`] if a map is not over the poses of the reference.
///
/// Implements: REP-070, REP-071.
pub fn subjects(study: &Study, compared: &[MapFindings]) -> Result<Subjects, ReportError> {
    let refused = |source| ReportError::People { source };
    let table = Table::paper().map_err(|error| ReportError::Table { error })?;
    let columns = paper::INCLUSIONS.into_iter().filter_map(|name| {
        let of_map = |map: &MapFindings| map.paper_phantom == Some(name);
        let index = compared.iter().position(of_map)?;
        Some((name, study.maps.get(index)?))
    });
    let columns: Vec<_> = columns.collect();
    // Fewer than two depths say nothing of how rates fall with depth.
    let has_depths = columns.len() >= 2;
    let bridge = has_depths.then(|| bridge(&table, &study.reference, &columns, None));
    Ok(Subjects {
        people: analyse(&table).map_err(refused)?,
        noise: paper_noise_levels().map_err(refused)?,
        bridge: bridge.transpose().map_err(refused)?,
    })
}

/// The normal approximation to a 95 % interval of a share of `trials` answers, cut off at 0 and 1: what the paper's
/// error bars come nearest to.
///
/// Implements: REP-038.
pub(super) fn normal_approximation(share: f64, trials: u64) -> Bounds {
    // The quantile is defined at this probability.
    let quantile = normal::quantile(0.975).unwrap_or(f64::NAN);
    let reach = quantile * libm::sqrt(share * (1.0 - share) / trials as f64);
    Bounds {
        lower: (share - reach).max(0.0),
        upper: (share + reach).min(1.0),
    }
}
