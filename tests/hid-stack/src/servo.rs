//! The host's part: the loop that is shipped, and a device that wraps the real one to watch or to disturb it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use assert_no_alloc::assert_no_alloc;
use palpate::force::Force;
use palpate::hid::real::{RealDevice, Wanted};
use palpate::hid::{
    Capabilities, Control, DeviceError, ForceReport, HapticDevice, Received, Session,
};
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
pub fn open(serial: &str) -> RealDevice {
    RealDevice::open_within(&wanted(serial), PATIENCE).expect("the board can be opened")
}

/// The table and the limits of this test.
pub fn played() -> (Table<'static>, Limits) {
    let axis = |knots: [f32; 3]| {
        let width = |cell| Axis::reciprocal_width(knots[cell], knots[cell + 1]);
        let widths = vec![width(0), width(1)];
        Axis::new(knots.to_vec().leak(), widths.leak()).expect("an axis")
    };
    let force = |index: usize| {
        let normal = FORCE_AT_2_MM * [0.0, 1.0, 2.0][index / 3];
        let lateral = 0.1 * normal * [-1.0, 0.0, 1.0][index % 3];
        Force { lateral, normal }
    };
    let forces: Vec<Force<f32>> = (0..9).map(force).collect();
    let (depths, laterals) = (axis([0.0, 0.002, 0.004]), axis([-0.005, 0.0, 0.005]));
    let table = Table::new(depths, laterals, forces.leak()).expect("a table");
    let limits = Limits::new(FORCE_LIMIT, 0.05, 0.5, 10).expect("limits");
    (table, limits)
}

/// Begins a session with `device`.
pub fn begin<D: HapticDevice>(device: D) -> Session<'static, D> {
    let (table, limits) = played();
    Session::begin(device, table, limits).expect("the board can be trusted")
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
    schedule::fifo(Fifo::Loop);
    let end = begin(open(serial)).run(|_, _| true);
    println!("the process that was to be killed ended: {end}");
    ExitCode::FAILURE
}
