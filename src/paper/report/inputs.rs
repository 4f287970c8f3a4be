//! What the uncertainty of the inputs does to the run's numbers: the results of a study beside them.

use super::Run;
use crate::study::{Band, Conclusion, Kind, StudyResults};
use palpate::force_map::{ForceMap, SAME_POSITION};
use palpate::refusal::Refusal;

/// A share of the draws from which on a statement counts as one that the inputs do not change.
///
/// Implements: REP-083.
const NEARLY_ALL: f64 = 0.95;

/// Refuses a study of other phantoms, poses or settings than those of the run.
///
/// Implements: REP-004.
pub(super) fn check(run: &Run, depth: f64) -> Result<(), Refusal> {
    let Some(StudyResults { plan, .. }) = &run.study else {
        return Ok(());
    };
    let own: Vec<_> = run.maps.iter().map(ForceMap::phantom).collect();
    let other = plan.phantoms.iter().find(|of| !own.contains(&Some(*of)));
    let what = if run.reference.phantom() != Some(&plan.reference) {
        "reference".into()
    } else if let Some(other) = other {
        format!("phantom {:?}", other.name())
    } else if (plan.probe_depth - depth).abs() > SAME_POSITION {
        "depth of the probe".into()
    } else if plan.laterals != run.reference.table().laterals() {
        // γ is of all samples of the sweep.
        "list of lateral positions".into()
    } else if plan.settings != run.settings {
        "noise, rate or prior".into()
    } else {
        return Ok(());
    };
    let found = format!(
        "the study of the inputs has another {what} than the run; choose one of the same phantoms, poses, noise and rates"
    );
    Err(Refusal::state(found, ""))
}

/// The band of a quantity of a phantom, if there is a study.
pub(super) fn band(run: &Run, phantom: &str, kind: &Kind) -> Option<Band> {
    run.study.as_ref()?.of(phantom, kind)?.band
}

/// What a study says of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Survival {
    /// It holds for nearly all draws.
    Holds,
    /// It does not hold for nearly all draws.
    Fails,
    /// The inputs decide.
    Depends,
}

/// Implements: REP-083.
pub fn survival(of: &Conclusion) -> Survival {
    match of.share {
        share if share >= NEARLY_ALL => Survival::Holds,
        share if share <= 1.0 - NEARLY_ALL => Survival::Fails,
        _ => Survival::Depends,
    }
}
