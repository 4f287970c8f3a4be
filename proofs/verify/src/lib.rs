//! The evidence that the program can give of itself (`palpate-verify`).
//!
//! | file | content |
//! |---|---|
//! | `check.rs` | what a check is, when its figures pass, and what became of it |
//! | `statistics/`, `battery.rs` | Monte Carlo of the detector, with the probability of failing by chance |
//! | `diagnosis.rs` | sensitivity and specificity on the paper's inclusions |
//! | `kernel.rs` | functions of one f32 on all 2³² of them |
//! | `fem/` | the solver against exact solutions, and the forces of the paper's poses |
//! | `vectors.rs` | the oracle against the vectors for other implementations |
//! | `timing.rs` | the time that a step, a cycle and a force map take here |
//! | `build.rs`, `supply.rs`, `traceability.rs` | what was built, from which components, for which requirements |
//! | `evidence.rs`, `dossier/` | all of it for programs, and as a page |

#[macro_use]
mod check;
mod battery;
pub mod build;
mod diagnosis;
pub mod dossier;
pub mod evidence;
pub mod fem;
pub mod kernel;
pub mod statistics;
pub mod supply;
pub mod timing;
pub mod traceability;
pub mod vectors;

pub use battery::outcome as battery_outcome;
pub use check::{Check, Figure, Outcome};

/// All checks of this build but the statistics battery, in a fixed order.
///
/// ```
/// let mut kernel = palpate_verify::checks().filter(|check| check.name.starts_with("kernel."));
/// assert!(kernel.any(|check| check.requirements.contains(&"SRV-020")));
/// ```
pub fn checks() -> impl Iterator<Item = &'static Check> {
    [
        diagnosis::CHECKS,
        vectors::CHECKS,
        fem::CHECKS,
        kernel::CHECKS,
        timing::CHECKS,
    ]
    .into_iter()
    .flatten()
}

/// The check of a name, if there is one in this build.
pub fn find(name: &str) -> Option<&'static Check> {
    checks().find(|check| check.name == name)
}
