//! The servo kernel: from a force table to a force command, once a millisecond (paper §4;
//! `spec/servo.md`).
//!
//! | file | content |
//! |---|---|
//! | `axis.rs` | knots; the cell of a position and the fraction in it |
//! | `table.rs` | forces at the nodes; the paper's linear rule, in bounds and out |
//! | `limit.rs` | the largest force, and how fast it may change |
//! | `state.rs` | what a cycle is given, remembers and commands |
//! | `step.rs` | one cycle |
//! | `passivity.rs` | the steepest slope of a table, and what a device can play |
//!
//! What runs in a cycle is f32 without division, without allocation, without a conversion from floating point
//! to integer and without a path to a panic; `proofs/` holds the evidence.
//!
//! Implements: SRV-001.

mod axis;
mod limit;
mod passivity;
mod state;
mod step;
mod table;
#[cfg(test)]
mod tests;

use crate::force::Force;
pub use axis::{
    Axis, Cell, EXTRAPOLATION_CELLS, InvalidAxis, MAX_KNOTS, MIN_WIDTH, POSITION_LIMIT,
};
pub use limit::{FORCE_CEILING, InvalidLimits, Limits, MIN_SLEW, RELEASE_CYCLES, approach, limit};
pub use passivity::{Damping, stiffness};
pub use state::{Command, Fault, Input, Mode, Request, Sample, State};
pub use step::{MOST_AHEAD, step};
pub use table::{InvalidTable, TABLE_FORCE_LIMIT, Table, blend};
