//! What the commands around playback share.

use std::path::Path;

use super::CliError;
use crate::force_map::ForceMap;
use crate::hid::Capabilities;
use crate::servo::{Damping, Limits, LoadedTable};

/// Largest growth of the force in one cycle of 1 ms, N: 250 N/s. The stiffest spring of the paper's display, 1200 N/m, grows so
/// fast under a hand of 0.2 m/s.
const SLEW: f32 = 0.25;

/// Cycles without a fresh sample that are no fault.
const WATCHDOG: u16 = 20;

/// Limits for a force of at most `force` (N).
///
/// Implements: CLI-064.
pub fn limits(force: f32) -> Result<Limits, CliError> {
    let release = force / 8.0;
    let slew = if SLEW < release { SLEW } else { release };
    Limits::new(force, slew, release, WATCHDOG)
        .map_err(|error| CliError::Usage(format!("--max-force {force}: {error}")))
}

/// What a device says of its damping. Its force comes `delay_periods` after the sample.
pub fn damping(capabilities: &Capabilities, delay_periods: u16) -> Damping {
    Damping {
        period_s: f64::from(capabilities.period_us) * 1e-6,
        delay_periods,
        damping_n_s_per_m: f64::from(capabilities.damping_mn_s_per_m) * 1e-3,
        friction_n: f64::from(capabilities.friction_mn) * 1e-3,
        resolution_m: f64::from(capabilities.position_unit_nm) * 1e-9,
    }
}

/// The table of a map's file.
///
/// Implements: CLI-062.
pub fn loaded_map(path: &Path) -> Result<LoadedTable, CliError> {
    let map = ForceMap::read(path)?;
    LoadedTable::new(map.forces())
        .map_err(|error| CliError::Playback(format!("{}: {error}", path.display())))
}
