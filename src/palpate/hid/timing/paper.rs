//! What is timed where nothing else is given: a table of the paper's size, and the paper's display in a hand.

use std::time::Duration;

use crate::force::Force;
use crate::force_map::{ForceTable, Matrix};
use crate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use crate::refusal::Refusal;
use crate::servo::LoadedTable;

/// A table on the poses of the paper's force maps, 9 depths × 41 lateral positions, with forces of
/// the same size.
///
/// # Errors
/// None, as long as a table may be as large.
pub fn table() -> Result<LoadedTable, Refusal> {
    let position = |step| f64::from(step) * 0.5e-3;
    let depths: Vec<f64> = (0..9).map(position).collect();
    let laterals: Vec<f64> = (-20..=20).map(position).collect();
    let normal = Matrix::from_fn(9, 41, |row, _| 0.18 * row as f64);
    let lateral = Matrix::from_fn(9, 41, |row, column| {
        1e-3 * row as f64 * (column as f64 - 20.0)
    });
    let forces = ForceTable::new(depths, laterals, Force::new(lateral, normal))?;
    LoadedTable::new(&forces)
}

/// The paper's display in a hand that sweeps through the gel and back until `cycles` are over.
pub fn device(cycles: u64) -> SimulatedDevice {
    let sweep = Duration::from_millis(1000 + cycles);
    let trajectory = Trajectory::probing(3e-3, 9e-3, sweep);
    SimulatedDevice::new(PAPER, Mechanics::PAPER, trajectory, Vec::new())
}
