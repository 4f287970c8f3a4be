//! The servo kernel of the core, and tables for it that are loaded from force maps (paper §4; `spec/servo.md`).

mod load;

pub(crate) use load::Knots;
pub use load::{HAND_SPEED, LoadedTable, RoundingError, SURFACE_FORCE};
pub use palpate_core::servo::*;
