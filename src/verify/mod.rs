//! The evidence that the program can give of itself (`palpate verify`).
//!
//! | file | content |
//! |---|---|
//! | `check.rs` | what a check is, and when its figures pass |
//! | `statistics/` | Monte Carlo of the detector, with the probability of failing by chance |
//! | `kernel.rs` | functions of one f32 on all 2³² of them |
//! | `fem/` | the solver against exact solutions, and the forces of the paper's poses |
//! | `vectors.rs` | the oracle against the vectors for other implementations |
//! | `timing.rs` | the time that a step, a cycle and a force map take here |

mod check;
#[cfg(feature = "fem")]
pub mod fem;
pub mod kernel;
pub mod statistics;
#[cfg(all(feature = "hid", feature = "fem"))]
pub mod timing;
#[cfg(feature = "oracle")]
pub mod vectors;

pub use check::{Check, Figure};

/// All checks of this build but the statistics battery, in a fixed order.
///
/// Implements: EVD-040.
pub fn checks() -> impl Iterator<Item = &'static Check> {
    let parts: &[&'static [Check]] = &[
        kernel::CHECKS,
        #[cfg(feature = "fem")]
        fem::CHECKS,
        #[cfg(feature = "oracle")]
        vectors::CHECKS,
        #[cfg(all(feature = "hid", feature = "fem"))]
        timing::CHECKS,
    ];
    let parts = parts.to_vec();
    parts.into_iter().flatten()
}

/// The check of a name, if there is one in this build.
pub fn find(name: &str) -> Option<&'static Check> {
    checks().find(|check| check.name == name)
}
