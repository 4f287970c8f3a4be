//! The evidence that the program can give of itself (`palpate verify`).

mod battery;
mod check;
#[cfg(feature = "fem")]
mod diagnosis;
mod outcome;

#[cfg(feature = "cli")]
pub mod build;
#[cfg(feature = "cli")]
pub mod dossier;
#[cfg(feature = "cli")]
pub mod evidence;
pub mod statistics;
#[cfg(feature = "cli")]
pub mod supply;
#[cfg(feature = "cli")]
pub mod traceability;

pub use battery::{outcome as battery_outcome, soaked};
pub use check::{Check, Figure};
pub use outcome::Outcome;

/// All checks of this build but the statistics battery, in a fixed order.
pub fn checks() -> impl Iterator<Item = &'static Check> {
    let parts: &[&'static [Check]] = &[
        #[cfg(feature = "fem")]
        diagnosis::CHECKS,
    ];
    let parts = parts.to_vec();
    parts.into_iter().flatten()
}
