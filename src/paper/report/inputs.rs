//! What the uncertainty of the inputs does to the run's numbers: the results of a study beside them.

use super::{Run, Settings};
use crate::study::{Band, Conclusion, Kind, StudyResults};
use palpate::force_map::SAME_POSITION;
use palpate::phantom::Phantom;
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
    let differs = |what: &str| {
        let found = format!("the study of the inputs has another {what} than the run");
        Err(Refusal::state(
            found,
            "a study of the same phantoms, poses, noise and rates",
        ))
    };
    let own = std::iter::once(&run.reference).chain(&run.maps);
    let has = |phantom: &Phantom| own.clone().any(|map| map.phantom() == Some(phantom));
    if run.reference.phantom() != Some(&plan.reference) {
        return differs("reference");
    }
    if let Some(other) = plan.phantoms.iter().find(|phantom| !has(phantom)) {
        return differs(&format!("phantom {:?}", other.name));
    }
    if (plan.probe_depth - depth).abs() > SAME_POSITION {
        return differs("depth of the probe");
    }
    // γ is of all samples of the sweep.
    if plan.laterals != run.reference.laterals() {
        return differs("list of lateral positions");
    }
    let settings = Settings {
        max_false_alarm: plan.max_false_alarm,
        max_miss: plan.max_miss,
        prior_h1: plan.prior_h1,
        noise_sd_n: plan.noise_sd,
    };
    match settings == run.settings {
        true => Ok(()),
        false => differs("noise, rate or prior"),
    }
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
