//! One sample, as a hand feels it: played through device, servo and table.

use std::time::Duration;

use crate::detect::Channels;
use crate::hid::{Counters, End, HapticDevice, Session, SessionError};
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

/// Why a presentation was not whole.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PresentationError {
    /// The device was refused.
    #[error("{0}")]
    Session(#[from] SessionError),
    /// It ended early.
    #[error("{0}")]
    Ended(End),
}

/// Plays `table` on `device` for `duration` of the device's time from the first force on, at most
/// `patience` from the beginning.
///
/// # Errors
/// [`PresentationError`].
///
/// Implements: PSY-010.
pub fn present<D: HapticDevice>(
    device: D,
    table: Table,
    limits: Limits,
    duration: Duration,
    patience: Duration,
) -> Result<Felt, PresentationError> {
    let mut session = Session::begin(device, table, limits)?;
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
        end => Err(PresentationError::Ended(end)),
    }
}
