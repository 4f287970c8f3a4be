//! One sample, as a hand feels it: played through device, servo and table.

use std::fmt::Display;
use std::time::Duration;

use crate::detect::Channels;
use crate::hid::{Counters, End, HapticDevice, Session};
use crate::refusal::Refusal;
use crate::servo::{Limits, Table};

/// Where the handle was, and what was played, while the force followed the table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Felt {
    /// Depths, m.
    pub depths: Vec<f64>,
    /// Lateral positions, m.
    pub laterals: Vec<f64>,
    /// Forces as sent to the device: x lateral, y normal, N.
    pub forces: Channels<Vec<f64>>,
    /// What happened.
    pub counters: Counters,
}

/// Plays `table` on `device` for `duration` of the device's time from the first force on, at most
/// `patience` from the beginning.
///
/// ```
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
/// use palpate::psychophysics::present;
/// use palpate::servo::{Limits, LoadedTable};
/// use std::time::Duration;
///
/// # let (depths, laterals) = (vec![0.0, 0.004], vec![-0.01, 0.01]);
/// # let matrix = |force: f64| Matrix::from_fn(2, 2, |row, _| force * row as f64);
/// // A map whose force grows from 0 to 1 N at 4 mm, and a hand that presses and sweeps.
/// let map = ForceTable::new(depths, laterals, matrix(1.0), matrix(0.0))?;
/// let loaded = LoadedTable::new(&map)?;
/// let hand = Trajectory::probing(0.003, 0.008, Duration::from_secs(1));
/// let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, hand, Duration::ZERO, vec![]);
/// let limits = Limits::new(4.0, 0.05, 0.5, 20)?;
/// let (half, second) = (Duration::from_millis(500), Duration::from_secs(1));
/// let felt = present(device, loaded.table()?, limits, half, second)?;
/// // 1 kHz for half a second, and pushed out of the gel.
/// assert!(felt.forces.y.len() > 480);
/// assert!(felt.forces.y.iter().all(|&force| (0.0..1.0).contains(&force)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The device was refused, or ended early.
///
/// Implements: PSY-010.
pub fn present<D: HapticDevice>(
    device: D,
    table: Table,
    limits: Limits,
    duration: Duration,
    patience: Duration,
) -> Result<Felt, Refusal> {
    let refused = |reason: &dyn Display| Refusal::state(reason, "");
    let mut session = Session::begin(device, table, limits).map_err(|error| refused(&error))?;
    let capabilities = *session.capabilities();
    let metres = f64::from(capabilities.position_unit_nm) * 1e-9;
    let newtons = f64::from(capabilities.force_unit_un) * 1e-6;
    let mut felt = Felt::default();
    let mut began = None;
    let end = session.run(|cycle, _| {
        if let (true, Some(position)) = (cycle.playing, cycle.position) {
            began.get_or_insert(cycle.written);
            felt.depths.push(-f64::from(position.normal) * metres);
            felt.laterals.push(f64::from(position.lateral) * metres);
            felt.forces.x.push(f64::from(cycle.force.lateral) * newtons);
            felt.forces.y.push(f64::from(cycle.force.normal) * newtons);
        }
        let until = began.map_or(patience, |began| began + duration);
        cycle.written < until
    });
    felt.counters = session.counters();
    match end {
        End::Asked => Ok(felt),
        end => Err(refused(&end)),
    }
}
