//! Evidence for palpate's servo kernel, the reports of its device, the detector's decision and entries of the C library.
//!
//! | file | content |
//! |---|---|
//! | `harness.rs` | how a harness runs as a test, a fuzz target and a Kani proof |
//! | `cases.rs` | generators of valid values |
//! | `axis.rs`, `table.rs`, `step.rs`, `report.rs`, `decision.rs`, `nuisance.rs`, `sequential.rs`, `c.rs` | the harnesses |
//!
//! `README.md` lists each with its scope and its assumptions. What needs other profiles is in
//! `tests/` (all 2³² inputs, planted defects) and `examples/` (no path to a panic).

#[cfg(test)]
#[macro_use]
mod harness;
#[cfg(test)]
mod axis;
#[cfg(test)]
mod c;
#[cfg(test)]
mod cases;
#[cfg(test)]
mod decision;
#[cfg(test)]
mod nuisance;
#[cfg(test)]
mod report;
#[cfg(test)]
mod sequential;
#[cfg(test)]
mod step;
#[cfg(test)]
mod table;
