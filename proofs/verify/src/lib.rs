//! The evidence that the program can give of itself (`palpate-verify`).
//!
//! | file | content |
//! |---|---|
//! | `check.rs` | what a check is, when its figures pass, and what became of it |
//! | `statistics/`, `battery.rs` | Monte Carlo of the detector, with the probability of failing by chance |
//! | `rates.rs` | error rates on the paper's inclusions, in simulated records |
//! | `kernel.rs` | functions of one f32 on all 2³² of them |
//! | `fem/` | the solver against exact solutions, and the forces of the paper's poses |
//! | `program.rs`, `program/` | the shipped program, judged from outside: vectors through a pipe, forces against other programs', decisions and refusals |
//! | `timing.rs` | the time that a step and a cycle take here |
//! | `system.rs`, `components.rs` | the machine of this run, and the components of the program |
//! | `test_run.rs` | test runs, and the evidence of each requirement |
//! | `planted.rs` | the share of planted defects that the tests find |
//! | `evidence.rs`, `dossier/` | all of it for programs, and as a page |

#[macro_use]
mod check;
mod battery;
pub mod components;
pub mod dossier;
pub mod evidence;
pub mod fem;
pub mod kernel;
pub mod planted;
pub mod program;
mod rates;
pub mod statistics;
pub mod system;
pub mod test_run;
pub mod timing;

use std::path::Path;

use serde::de::DeserializeOwned;

pub use battery::outcome as battery_outcome;
pub use check::{Check, Claim, Error, Figure, Measured, Outcome};

/// All checks of this build but the statistics battery and those of [`program`], in a fixed order.
///
/// ```
/// let mut kernel = palpate_verify::checks().filter(|check| check.claim.name.starts_with("kernel."));
/// assert!(kernel.any(|check| check.claim.requirements.contains(&"SRV-020")));
/// ```
pub fn checks() -> impl Iterator<Item = &'static Check> {
    [rates::CHECKS, fem::CHECKS, kernel::CHECKS, timing::CHECKS]
        .into_iter()
        .flatten()
}

/// What all checks claim, but those of the statistics battery.
pub fn claims() -> impl Iterator<Item = &'static Claim> {
    let outside = program::CHECKS.iter().map(|check| &check.claim);
    checks()
        .map(|check| &check.claim)
        .chain(outside)
        .chain([&test_run::CLAIM])
}

/// The ids of all requirements that a check names, those of the statistics battery too; one may come several times.
pub fn served_requirements() -> impl Iterator<Item = &'static str> {
    let battery = battery::GROUPS.iter().map(|(.., ids)| *ids);
    let all = claims().map(|claim| claim.requirements).chain(battery);
    all.flatten().copied()
}

/// What a file of JSON holds, or a line that names the file and what is wrong with it.
fn json<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string());
    let read = text.and_then(|text| serde_json::from_str(&text).map_err(|error| error.to_string()));
    read.map_err(|error| format!("{}: {error}", path.display()))
}
