//! Options and loading of maps that `play`, `experiment` and `timing` share.

use std::io::{IsTerminal, stdin, stdout};
use std::path::Path;
use std::time::Duration;

use clap::{Args, ValueEnum};

use super::CliError;
use super::error::refuse;
use palpate::force_map::ForceMap;
use palpate::hid::pipe::PipeDevice;
use palpate::hid::real::{RealDevice, Wanted};
use palpate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use palpate::hid::{Capabilities, HapticDevice};
use palpate::refusal::Refusal;
use palpate::servo::{Damping, Limits, LoadedTable};

/// The time after plugging in within which a device must open.
const PLUG_IN: Duration = Duration::from_millis(500);

/// The haptic device.
#[derive(Debug, Args)]
pub struct DeviceArguments {
    /// Haptic device
    #[arg(long, value_enum, default_value_t = DeviceName::Sim)]
    device: DeviceName,
    /// Vendor id of the device, hexadecimal
    #[arg(long, value_name = "HEX", value_parser = number)]
    vid: Option<u16>,
    /// Product id of the device, hexadecimal
    #[arg(long, value_name = "HEX", value_parser = number)]
    pid: Option<u16>,
    /// Serial number of the device
    #[arg(long, value_name = "TEXT")]
    serial: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DeviceName {
    /// Simulation of the paper's display, moved by a simulated hand, on a virtual clock.
    Sim,
    /// HID device of this machine; --vid, --pid or --serial select one of several.
    Hid,
    /// Bridge to a device of another kind, which starts this command, writes positions to its standard input and reads forces from its
    /// standard output; the summary is on standard error.
    Pipe,
}

fn number(text: &str) -> Result<u16, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    u16::from_str_radix(digits, 16).map_err(|_| "must be up to four hexadecimal digits".into())
}

impl DeviceArguments {
    fn wanted(&self) -> Wanted {
        Wanted {
            vendor: self.vid,
            product: self.pid,
            serial: self.serial.clone(),
        }
    }

    /// Whether the device is the simulated one.
    pub fn is_simulated(&self) -> bool {
        self.device == DeviceName::Sim
    }

    /// Whether the device is at the other end of standard input and output.
    pub fn is_pipe(&self) -> bool {
        self.device == DeviceName::Pipe
    }

    /// Refuses the ids of a device that is no HID device.
    pub fn check(&self) -> Result<(), CliError> {
        if self.device != DeviceName::Hid && self.wanted() != Wanted::default() {
            refuse!("--vid, --pid and --serial need --device hid");
        }
        Ok(())
    }

    /// The device; the simulated one follows this trajectory of a hand.
    ///
    /// Implements: CLI-079.
    pub fn open(&self, hand: Trajectory) -> Result<Box<dyn HapticDevice + Send>, Refusal> {
        Ok(match self.device {
            DeviceName::Sim => {
                let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, hand, Vec::new());
                Box::new(device)
            }
            DeviceName::Hid => Box::new(RealDevice::open_within(&self.wanted(), PLUG_IN)?),
            DeviceName::Pipe => {
                let remedy = "let a bridge start this command (docs/how-to/devices.md)";
                Refusal::state("standard input is a terminal", remedy)
                    .when(stdin().is_terminal())?;
                let opened = PipeDevice::open(stdin(), stdout());
                Box::new(opened.map_err(|error| Refusal::state(error, ""))?)
            }
        })
    }

    /// The damping of this device by its `capabilities`. A bus or a bridge takes a period from a sample to its force each way, of which the report's
    /// is over when it is read.
    pub fn damping(&self, capabilities: &Capabilities) -> Damping {
        damping(capabilities, u16::from(!self.is_simulated()))
    }
}

/// Limits for a force of at most `force` (N) on a device of these `capabilities`.
pub fn limits(force: f32, capabilities: &Capabilities) -> Result<Limits, CliError> {
    let limits = Limits::for_playback(force, capabilities.period_us);
    limits.map_err(CliError::refused(format_args!("--max-force {force}")))
}

/// The damping of a device by its `capabilities`. Its force comes `delay_periods` after the sample.
fn damping(capabilities: &Capabilities, delay_periods: u16) -> Damping {
    Damping {
        period_s: f64::from(capabilities.period_us) * 1e-6,
        delay_periods,
        damping_n_s_per_m: f64::from(capabilities.damping_mn_s_per_m) * 1e-3,
        friction_n: f64::from(capabilities.friction_mn) * 1e-3,
        resolution_m: f64::from(capabilities.position_unit_nm) * 1e-9,
    }
}

/// The map in a file, over all lateral positions.
///
/// Implements: CLI-063, MAP-092.
pub fn played_map(path: &Path) -> Result<ForceMap, CliError> {
    let whole = ForceMap::read(path)?.whole();
    whole.map_err(CliError::refused(path.display()))
}

/// The servo table of the map in a file.
///
/// Implements: CLI-063.
pub fn loaded_map(path: &Path) -> Result<LoadedTable, CliError> {
    let map = played_map(path)?;
    LoadedTable::new(map.table()).map_err(CliError::refused(path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::force::Force;
    use palpate::servo::{Axis, Input, Mode, Sample, State, Table, step};

    // Verifies: CLI-063.
    #[test]
    fn a_device_is_taken_by_its_own_damping_and_friction() {
        let device = Capabilities {
            period_us: 500,
            damping_mn_s_per_m: 300,
            friction_mn: 20,
            position_unit_nm: 50_000,
            ..PAPER
        };
        let found = damping(&device, 1);
        // Each number times a power of ten that f64 rounds once.
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-15;
        assert!(near(found.period_s, 0.5e-3) && near(found.damping_n_s_per_m, 0.3));
        assert!(near(found.friction_n, 0.02) && near(found.resolution_m, 0.05e-3));
        assert_eq!(found.delay_periods, 1);
    }

    /// The forces of each cycle of `period_us` after one of `force` (N) that the hand lets go of, or that the gel pushes up against from 0.
    fn forces(force: f32, period_us: u16, pushed: bool) -> Vec<f32> {
        let device = Capabilities { period_us, ..PAPER };
        let limits = limits(force, &device).unwrap();
        let axis = Axis::new(&[0.0, 0.5], &[2.0]).unwrap();
        let normal = |normal| Force {
            lateral: 0.0,
            normal,
        };
        let nodes = [0.0, 0.0, force, force].map(normal);
        let table = Table::new(axis, axis, &nodes).unwrap();
        let mut state = State {
            mode: Mode::Armed,
            sequence: Some(0),
            force: normal(if pushed { 0.0 } else { force }),
            ..State::default()
        };
        let cycle = |sequence| {
            let sample = Sample {
                sequence,
                deadman: pushed,
                device_fault: false,
                depth: 0.5,
                lateral: 0.0,
            };
            let input = Input {
                sample: Some(sample),
                ..Input::default()
            };
            (state, _) = step(&table, &limits, state, input);
            state.force.normal
        };
        (1..=400).map(cycle).collect()
    }

    // Verifies: CLI-064.
    #[test]
    fn a_force_is_released_in_eight_equal_steps_and_built_up_no_faster() {
        for (force, period_us) in [(4.0, 1000), (4.0, 50), (4.0, 10_000), (0.25, 1000)] {
            let released = forces(force, period_us, false);
            for (cycle, found) in (1..).zip(&released[..8]) {
                assert_eq!(*found, force * (8 - cycle) as f32 / 8.0, "cycle {cycle}");
            }
            // 250 N/s; a release of less than that in a cycle is the smaller one.
            let change = f32::min(250e-6 * f32::from(period_us), force / 8.0);
            let built = forces(force, period_us, true);
            let cycles = built.iter().filter(|found| **found < force).count() + 1;
            // And one more for rounding.
            let more = cycles as f32 - force / change;
            assert!((0.0..=1.0).contains(&more), "{cycles}");
        }
    }

    // Verifies: CLI-079.
    #[test]
    fn numbers_are_hexadecimal() {
        assert_eq!(number("1209"), Ok(0x1209));
        assert_eq!(number("0xfFfF"), Ok(0xFFFF));
        for wrong in ["", "10000", "-1", "12g9", "0x"] {
            assert!(number(wrong).is_err(), "{wrong}");
        }
    }
}
