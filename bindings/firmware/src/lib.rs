//! The servo kernel of `palpate` with the reports of the device, on a Cortex-M4F (`spec/firmware.md`).
//!
//! | file | content |
//! |---|---|
//! | `device.rs` | one cycle: from the bytes of a position report to those of a force report |
//! | `table.rs` | a force table of the paper's size, in flash |
//! | `scenario.rs` | 10,000 cycles of a hand, a switch, losses and faults |
//! | `vectors.rs`, `vectors/ops.rs` | the cases that `vectors.py` has written |
//! | `told.rs` | what both machines must say of vectors and scenario |
//! | `board.rs` | start, text and counters of the board, on the target alone |
//! | `bin/device.rs` | the small image: what a product would have |
//! | `bin/check.rs` | vectors, scenario and measurements |
//! | `bin/host.rs` | the same vectors and scenario on the machine that compares |
#![no_std]

#[cfg(target_os = "none")]
pub mod board;
pub mod device;
pub mod scenario;
pub mod table;
pub mod told;
pub mod vectors;
