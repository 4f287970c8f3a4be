//! The evidence that the program can give of itself (`palpate verify`).

mod battery;
pub mod build;
mod check;
#[cfg(feature = "fem")]
mod diagnosis;
#[cfg(feature = "cli")]
pub mod dossier;
#[cfg(feature = "cli")]
pub mod evidence;
mod outcome;
pub mod statistics;
#[cfg(feature = "std")]
pub mod supply;
#[cfg(feature = "std")]
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
