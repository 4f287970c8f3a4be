//! What people feel: two-alternative forced choice (paper §4, `spec/psychophysics.md`).
//!
//! | file | content |
//! |---|---|
//! | `plan.rs` | which pair when: random, from a seed |
//! | `journal.rs` | the answers so far, in a file that survives an abort |
//! | `presentation.rs` | one sample played through device and servo, as it was felt |
//! | `observer.rs` | the ideal observer, who decides by Θ |

mod journal;
#[cfg(feature = "hid")]
mod observer;
mod plan;
#[cfg(feature = "hid")]
mod presentation;
#[cfg(test)]
mod tests;

pub use journal::{Journal, JournalError, Setup};
#[cfg(feature = "hid")]
pub use observer::{IdealObserver, ObserverError};
pub use plan::{Interval, Plan, Trial};
#[cfg(feature = "hid")]
pub use presentation::{Felt, PresentationError, present};
