//! The detector of the core, and what computes beside it: hypotheses of many inclusions, simulated records, noise in proportion to the
//! force, and whether samples are independent (paper §2; `spec/detector.md`).

pub mod correlation;
pub mod mixture;
pub mod simulate;
pub mod weber;

pub use palpate_core::detect::*;
