//! The servo kernel of `palpate` with the reports of the device, on a Cortex-M4F (`spec/firmware.md`).
//!
//! | file | content |
//! |---|---|
//! | `device.rs` | one cycle: from the bytes of a position report to those of a force report |
//! | `table.rs` | a force table of the paper's size, in flash |
//! | `scenario.rs` | 10,000 cycles of a hand, a switch, losses and faults |
//! | `hash.rs` | a digest of texts |
//! | `digest.rs`, `digest/` | one number for all results of the core over a fixed sweep |
//! | `board.rs` | start, text and counters of the board, on the target alone |
//! | `bin/device.rs` | the small image: what a product would have |
//! | `bin/check.rs` | digest and measurements |
//! | `bin/host.rs` | the same digest on the machine that compares |
#![no_std]

#[cfg(target_os = "none")]
pub mod board;
pub mod device;
pub mod digest;
pub mod hash;
pub mod scenario;
pub mod table;
