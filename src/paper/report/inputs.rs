//! What the uncertainty of the inputs does to the run's numbers: the results of a study beside them.

use super::{Run, Settings};
use crate::study::{Band, Conclusion, Kind, StudyResults};
use palpate::force_map::{ForceMap, SAME_POSITION};
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// A share of the draws from which on a statement counts as one that the inputs do not change.
///
/// Implements: REP-083.
const NEARLY_ALL: f64 = 0.95;

/// Checks that a study is of the phantoms of a run, the reference first, and of its poses: the depth of the probe and the lateral
/// positions, m.
///
/// # Errors
/// What is another in the study.
///
/// Implements: REP-004.
pub fn check_study(
    study: &StudyResults,
    phantoms: &[&Phantom],
    (depth, laterals): (f64, &[f64]),
    settings: &Settings,
) -> Result<(), Refusal> {
    let plan = &study.plan;
    let (reference, own) = phantoms.split_at(phantoms.len().min(1));
    let other = plan.phantoms.iter().find(|of| !own.contains(of));
    let what = if reference != [&plan.reference] {
        "reference".into()
    } else if let Some(other) = other {
        format!("phantom {:?}", other.name())
    } else if (plan.probe_depth - depth).abs() > SAME_POSITION {
        "depth of the probe".into()
    } else if plan.laterals != laterals {
        // γ is of all samples of the sweep.
        "list of lateral positions".into()
    } else if plan.settings != *settings {
        "noise, rate or prior".into()
    } else {
        return Ok(());
    };
    let found = format!(
        "the study of the inputs has another {what} than the run; choose one of the same phantoms, poses, noise and rates"
    );
    Err(Refusal::state(found, ""))
}

/// The band of a quantity of a map's phantom, if there is a study of it; another gel may have the same name.
pub(super) fn band(run: &Run, map: &ForceMap, kind: &Kind) -> Option<Band> {
    let (study, phantom) = run.study.as_ref().zip(map.phantom())?;
    let mut phantoms = study.plan.all_phantoms();
    phantoms.find(|of| *of == phantom)?;
    study.of(phantom.name(), kind)?.band
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
