//! What tests of the loop share.

use std::time::Duration;

use super::*;
use crate::force::Force;
use crate::hid::simulated::{Defect, Mechanics, PAPER, SimulatedDevice, Trajectory};
use crate::servo::{Axis, Limits, Table};

pub const MS: Duration = Duration::from_millis(1);

/// Forces over a square of 8 mm by 40 mm that grow with the depth to `normal` (N), and to ±1 N to the sides.
pub fn table(normal: f32) -> Table<'static> {
    let axis = |start, end| {
        let width = vec![Axis::reciprocal_width(start, end)];
        Axis::new(vec![start, end].leak(), width.leak()).unwrap()
    };
    let deep = [-1.0, 1.0].map(|lateral| Force { lateral, normal });
    let forces = vec![Force::ZERO, Force::ZERO, deep[0], deep[1]];
    Table::new(axis(0.0, 0.008), axis(-0.02, 0.02), forces.leak()).unwrap()
}

/// 2 N, built up by 50 N/s and released in ten cycles.
pub fn limits() -> Limits {
    Limits::new(2.0, 0.05, 0.2, 10).unwrap()
}

/// The paper's display in a hand that presses by 4 mm and sweeps over 20 mm, each sweep so long.
pub fn probing(sweep: Duration, faults: Vec<(Duration, Defect)>) -> SimulatedDevice {
    let hand = Trajectory::probing(0.004, 0.01, sweep);
    SimulatedDevice::new(PAPER, Mechanics::PAPER, hand, faults)
}

/// A session with 400 N/m along the depth.
pub fn begin<D: HapticDevice>(device: D) -> Session<'static, D> {
    Session::begin(device, table(3.2), limits()).unwrap()
}

/// The cycles of a session until it ends, at most so many.
pub fn recorded(device: impl HapticDevice, most: usize) -> Vec<Cycle> {
    let mut cycles = Vec::new();
    begin(device).run(|cycle, _| {
        cycles.push(*cycle);
        cycles.len() < most
    });
    cycles
}

/// What the loop sends to a device.
pub enum Sent {
    Force(ForceReport),
    Control(Control),
}

/// A device with a say in what is sent to it, and when. It has the operations of HID-012 and no other: a further one that
/// the loop needs would not compile here.
pub struct Watched<F>(pub SimulatedDevice, pub F);

impl<F: FnMut(Sent, Duration) -> Result<(), DeviceError>> HapticDevice for Watched<F> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.0.capabilities()
    }
    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        self.0.read(timeout)
    }
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        (self.1)(Sent::Force(*report), self.0.now()).and_then(|()| self.0.write(report))
    }
    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        (self.1)(Sent::Control(control), self.0.now()).and_then(|()| self.0.control(control))
    }
    fn now(&self) -> Duration {
        self.0.now()
    }
}
