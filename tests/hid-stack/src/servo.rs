//! The host's part: the loop that is shipped, and devices that wrap the real one to watch or to disturb it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use assert_no_alloc::assert_no_alloc;
use palpate::force::Force;
use palpate::hid::real::{RealDevice, Wanted};
use palpate::hid::{
    Capabilities, Control, DeviceError, ForceReport, HapticDevice, Received, Session,
};
use palpate::refusal::Refusal;
use palpate::servo::{Axis, Limits, Table};

use crate::link::NUMBERS;
use crate::schedule::{self, Fifo};

/// How long a device may take to be there after it was plugged in.
const PATIENCE: Duration = Duration::from_secs(2);

/// Force limit, N.
pub const FORCE_LIMIT: f32 = 4.0;

/// Force at 2 mm, where the board's hand stays: N, and as counts of 0.5 mN.
const FORCE_AT_2_MM: f32 = 1.0;
pub const COUNTS_AT_2_MM: u16 = 2000;

/// The board with this serial number.
pub fn wanted(serial: &str) -> Wanted {
    Wanted {
        vendor: Some(NUMBERS[0]),
        product: Some(NUMBERS[1]),
        serial: Some(serial.into()),
    }
}

/// Opens the board with this serial number.
pub fn open(serial: &str) -> Result<RealDevice, Refusal> {
    RealDevice::open_within(&wanted(serial), PATIENCE)
}

/// Hands the table and the limits of this test to `then`.
pub fn with_table<T>(then: impl FnOnce(Table, Limits) -> T) -> Result<T, String> {
    let depths = [0.0, 0.002, 0.004];
    let laterals = [-0.005, 0.0, 0.005];
    let reciprocals =
        |knots: [f32; 3]| [0, 1].map(|cell| Axis::reciprocal_width(knots[cell], knots[cell + 1]));
    let mut forces = [Force::ZERO; 9];
    for (index, force) in forces.iter_mut().enumerate() {
        force.normal = FORCE_AT_2_MM * [0.0, 1.0, 2.0][index / 3];
        force.lateral = 0.1 * force.normal * [-1.0, 0.0, 1.0][index % 3];
    }
    let widths = [reciprocals(depths), reciprocals(laterals)];
    let failed = |problem: &dyn std::fmt::Debug| format!("the test's own table: {problem:?}");
    let depths = Axis::new(&depths, &widths[0]).map_err(|e| failed(&e))?;
    let laterals = Axis::new(&laterals, &widths[1]).map_err(|e| failed(&e))?;
    let table = Table::new(depths, laterals, &forces).map_err(|e| failed(&e))?;
    let limits = Limits::new(FORCE_LIMIT, 0.05, 0.5, 10).map_err(|e| failed(&e))?;
    Ok(then(table, limits))
}

/// Begins a session with `device` and hands it to `then`.
pub fn with_session<D: HapticDevice, T>(
    device: D,
    then: impl FnOnce(Session<D>) -> T,
) -> Result<T, String> {
    let begun = with_table(|table, limits| Session::begin(device, table, limits).map(then))?;
    begun.map_err(|error: Refusal| error.to_string())
}

/// A device whose reads and writes must not allocate, and which burns time before each write.
pub struct Watched<D> {
    /// The device.
    pub device: D,
    /// What is burnt.
    pub burn: Duration,
}

impl<D: HapticDevice> HapticDevice for Watched<D> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.device.capabilities()
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        assert_no_alloc(|| self.device.read(timeout))
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        let began = Instant::now();
        while began.elapsed() < self.burn {
            std::hint::spin_loop();
        }
        assert_no_alloc(|| self.device.write(report))
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.device.control(control)
    }

    fn now(&self) -> Duration {
        self.device.now()
    }
}

/// A process of its own that plays on the board `serial`, until it is killed.
pub fn play_until_killed(serial: &str) -> ExitCode {
    let played = schedule::fifo(Fifo::Loop)
        .map_err(|error| error.to_string())
        .and_then(|()| open(serial).map_err(|error| error.to_string()))
        .and_then(|device| with_session(device, |mut session| session.run(|_, _| true)));
    println!("the process that was to be killed ended: {played:?}");
    ExitCode::FAILURE
}
