//! The statistics of the core, and whether counts differ more than chance allows.

pub mod dispersion;

pub use palpate_core::stats::*;
