//! A haptic device and the hand that holds it, on a virtual clock: the same session every time, on
//! any machine, however loaded.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the device: its clock, queue and watchdog, and what goes wrong |
//! | `handle.rs` | one axis: mass, damping, friction, backlash, the hand's spring |
//! | `trajectory.rs` | where the hand wants to be |

mod handle;
#[cfg(test)]
mod tests;
mod trajectory;

use std::collections::VecDeque;
use std::time::Duration;

pub(crate) use handle::Handle;
pub use handle::Mechanics;
pub use palpate_core::hid::PAPER;
pub use trajectory::Trajectory;

use super::{
    Capabilities, Control, DeviceError, DeviceState, ForceReport, HapticDevice, InvalidReport,
    PositionReport, Received, button, status,
};

/// Reports that the system's queue holds; when it is full, the oldest stay.
const QUEUE: usize = 63;

/// After this long without taking a report, a write is given up.
const GIVE_UP: Duration = Duration::from_millis(5_190);

/// What can go wrong between a device and the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// The cable is pulled.
    Unplug,
    /// No report is sent for this long.
    Silence(Duration),
    /// The device takes no report for this long: a write blocks, and fails after 5.19 s.
    Stall(Duration),
    /// The device reports a fault in itself for this long.
    DeviceFault(Duration),
    /// The deadman is let go for this long.
    DeadmanReleased(Duration),
    /// A read is interrupted by a signal.
    Interrupt,
    /// This many reports repeat the sequence number of the one before.
    Repeat(u16),
    /// The sequence goes back by this much, and counts on from there.
    SequenceBack(u16),
    /// One report is garbage.
    Garbage(InvalidReport),
    /// One report has its positions off by this many counts.
    Glitch(i16),
    /// The device's clock jumps ahead: the reports of this time never come.
    ClockJump(Duration),
}

/// A simulated device in a simulated hand.
///
/// ```
/// use palpate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
/// use palpate::hid::{Control, ForceReport, HapticDevice};
/// use std::time::Duration;
///
/// let trajectory = Trajectory::probing(4e-3, 10e-3, Duration::from_secs(1));
/// let mut device = SimulatedDevice::new(PAPER, Mechanics::PAPER, trajectory, vec![]);
/// device.control(Control::Enable)?;
/// device.write(&ForceReport { lateral: -200, normal: 3000, sequence: 1, flags: ForceReport::PLAY })?;
/// assert_eq!(device.motor_force(), [-0.1, 1.5]);
/// device.read(Duration::from_millis(2))?;
/// assert_eq!(device.now(), Duration::from_millis(1)); // when the report came
/// # Ok::<(), palpate::hid::DeviceError>(())
/// ```
///
/// Implements: HID-020.
#[derive(Debug, Clone)]
pub struct SimulatedDevice {
    capabilities: Capabilities,
    trajectory: Trajectory,
    /// What goes wrong, by time.
    faults: VecDeque<(Duration, Defect)>,
    /// Lateral, and along the normal.
    handles: [Handle; 2],
    clock: Duration,
    /// When the last period ended.
    ticked: Duration,
    /// What was sent and not read yet.
    queue: VecDeque<Received>,
    sequence: u16,
    motor: Motor,
    ongoing: Ongoing,
}

/// The device's force output.
#[derive(Debug, Clone, Copy, Default)]
struct Motor {
    enabled: bool,
    /// The device's watchdog dropped the force.
    dropped: bool,
    /// Counts: lateral, normal.
    force: [i16; 2],
    sequence: u16,
    written: Duration,
}

/// Faults that last.
#[derive(Debug, Clone, Copy, Default)]
struct Ongoing {
    unplugged: bool,
    silent_until: Duration,
    stalled_until: Duration,
    faulty_until: Duration,
    released_until: Duration,
    interrupted: bool,
    repeat: u16,
    garbage: Option<InvalidReport>,
    glitch: i16,
}

impl SimulatedDevice {
    /// A device of these capabilities, in a hand that follows `trajectory`, with `faults` and the times of
    /// the device's clock at which they begin.
    pub fn new(
        capabilities: Capabilities,
        mechanics: Mechanics,
        trajectory: Trajectory,
        mut faults: Vec<(Duration, Defect)>,
    ) -> SimulatedDevice {
        faults.sort_by_key(|&(at, _)| at);
        let start = trajectory.at(Duration::ZERO);
        SimulatedDevice {
            capabilities,
            trajectory,
            faults: faults.into(),
            handles: start.map(|position| Handle::at(mechanics, position)),
            clock: Duration::ZERO,
            ticked: Duration::ZERO,
            queue: VecDeque::with_capacity(QUEUE),
            sequence: 0,
            motor: Motor::default(),
            ongoing: Ongoing::default(),
        }
    }

    /// The force that the motors make now, N: lateral, normal.
    pub fn motor_force(&self) -> [f64; 2] {
        if !self.motor.enabled || self.motor.dropped {
            return [0.0, 0.0];
        }
        let unit = f64::from(self.capabilities.force_unit_un) * 1e-6;
        let largest = f64::from(self.capabilities.largest_force_mn) * 1e-3;
        self.motor
            .force
            .map(|count| (f64::from(count) * unit).clamp(-largest, largest))
    }

    fn period(&self) -> Duration {
        self.capabilities.period().max(Duration::from_micros(1))
    }

    /// Lets the time pass up to `until`, period by period.
    fn pass(&mut self, until: Duration) {
        while self.ticked + self.period() <= until {
            self.ticked += self.period();
            self.clock = self.ticked;
            self.simulate_period();
        }
        self.clock = until;
    }

    /// One period of the device: faults, motion, watchdog, report.
    fn simulate_period(&mut self) {
        while let Some(&(at, defect)) = self.faults.front()
            && at <= self.clock
        {
            self.faults.pop_front();
            self.begin(defect);
        }
        let silent = self.clock.saturating_sub(self.motor.written);
        self.motor.dropped |= self.motor.enabled && silent > self.capabilities.watchdog();
        let period = self.period().as_secs_f64();
        let target = self.trajectory.at(self.clock);
        let force = self.motor_force();
        for axis in 0..2 {
            self.handles[axis].advance(period, target[axis], force[axis]);
        }
        self.send();
    }

    /// Puts this period's report into the queue.
    fn send(&mut self) {
        let repeats = self.ongoing.repeat > 0;
        self.ongoing.repeat = self.ongoing.repeat.saturating_sub(1);
        self.sequence = self.sequence.wrapping_add(u16::from(!repeats));
        if self.ongoing.unplugged || self.clock < self.ongoing.silent_until {
            return;
        }
        let received = match self.ongoing.garbage.take() {
            Some(problem) => Received::Garbage(problem),
            None => Received::Report(self.report()),
        };
        if self.queue.len() < QUEUE {
            self.queue.push_back(received);
        }
    }

    fn report(&mut self) -> PositionReport {
        let unit = f64::from(self.capabilities.position_unit_nm) * 1e-9;
        let counts = |handle: Handle| super::count((handle.encoder / unit) as f32);
        let [lateral, normal] = self.handles.map(counts);
        let glitch = std::mem::take(&mut self.ongoing.glitch);
        let deadman = self.clock >= self.ongoing.released_until && self.trajectory.held(self.clock);
        let faulty = self.clock < self.ongoing.faulty_until;
        PositionReport {
            lateral: lateral.wrapping_add(glitch),
            normal: normal.wrapping_sub(glitch),
            buttons: button::DEADMAN * u8::from(deadman),
            status: (status::FAULT * u8::from(faulty))
                | (status::WATCHDOG * u8::from(self.motor.dropped)),
            sequence: self.sequence,
            force_sequence: self.motor.sequence,
        }
    }

    fn begin(&mut self, defect: Defect) {
        let ongoing = &mut self.ongoing;
        match defect {
            Defect::Unplug => ongoing.unplugged = true,
            Defect::Silence(time) => ongoing.silent_until = self.clock + time,
            Defect::Stall(time) => ongoing.stalled_until = self.clock + time,
            Defect::DeviceFault(time) => ongoing.faulty_until = self.clock + time,
            Defect::DeadmanReleased(time) => ongoing.released_until = self.clock + time,
            Defect::Interrupt => ongoing.interrupted = true,
            Defect::Repeat(reports) => ongoing.repeat = reports,
            Defect::SequenceBack(by) => self.sequence = self.sequence.wrapping_sub(by),
            Defect::Garbage(problem) => ongoing.garbage = Some(problem),
            Defect::Glitch(counts) => ongoing.glitch = counts,
            // What is in the queue keeps its place; the hand moves on.
            Defect::ClockJump(time) => {
                let missing = time.as_micros() / self.period().as_micros();
                self.sequence = self.sequence.wrapping_add(missing as u16);
            }
        }
    }

    fn check_plugged(&self) -> Result<(), DeviceError> {
        match self.ongoing.unplugged {
            true => Err(DeviceError::new(DeviceState::Gone, "the device is gone")),
            false => Ok(()),
        }
    }
}

impl HapticDevice for SimulatedDevice {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.check_plugged()?;
        Ok(self.capabilities)
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        let deadline = self.clock + timeout;
        loop {
            self.check_plugged()?;
            if std::mem::take(&mut self.ongoing.interrupted) {
                let message = "a signal interrupted the device";
                return Err(DeviceError::new(DeviceState::Interrupted, message));
            }
            if let Some(received) = self.queue.pop_front() {
                return Ok(received);
            }
            if self.clock >= deadline {
                return Ok(Received::Nothing);
            }
            self.pass(deadline.min(self.ticked + self.period()));
        }
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.check_plugged()?;
        let (stalled_until, give_up) = (self.ongoing.stalled_until, self.clock + GIVE_UP);
        if self.clock < stalled_until {
            self.pass(stalled_until.min(give_up));
            if stalled_until >= give_up {
                let message = "the device takes no more reports";
                return Err(DeviceError::new(DeviceState::Stalled, message));
            }
            self.check_plugged()?;
        }
        let playing = i16::from(report.flags & ForceReport::PLAY != 0);
        self.motor.force = [report.lateral, report.normal].map(|force| force * playing);
        self.motor.sequence = report.sequence;
        self.motor.written = self.clock;
        Ok(())
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.check_plugged()?;
        match control {
            Control::Stop => self.motor.enabled = false,
            Control::Enable => self.motor.enabled = true,
            Control::ClearFault => self.motor.dropped = false,
        }
        self.motor.written = self.clock;
        Ok(())
    }

    fn now(&self) -> Duration {
        self.clock
    }
}
