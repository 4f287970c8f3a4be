//! The supervisor over devices that fail on the clock of the host.

use super::*;
use crate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use crate::hid::{Capabilities, Control, ForceReport, Received};
use crate::servo::{Axis, Force, Limits, Table};

/// A device whose first write after `trouble` does what it says.
struct Troubled<F> {
    device: SimulatedDevice,
    trouble: Duration,
    what: F,
}

impl<F: FnMut()> HapticDevice for Troubled<F> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.device.capabilities()
    }
    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        self.device.read(timeout)
    }
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        if self.device.now() >= self.trouble {
            self.trouble = Duration::MAX;
            (self.what)();
        }
        self.device.write(report)
    }
    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.device.control(control)
    }
    fn now(&self) -> Duration {
        self.device.now()
    }
}

/// Plays on the paper's device, with trouble after a second of its time.
fn played(
    what: impl FnMut() + Send,
    stop: impl Fn() -> bool,
    look: impl FnMut(&Counters, Duration),
) -> Option<Played> {
    let forces = [Force::ZERO; 4];
    let (knots, reciprocals) = ([0.0, 0.5], [2.0]);
    let axis = Axis::new(&knots, &reciprocals).unwrap();
    let table = Table::new(axis, axis, &forces).unwrap();
    let limits = Limits::new(2.0, 0.05, 0.2, 10).unwrap();
    let trajectory = Trajectory::probing(0.004, 0.01, Duration::from_secs(1));
    let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, trajectory, Duration::ZERO, vec![]);
    let device = Troubled {
        device,
        trouble: Duration::from_secs(1),
        what,
    };
    let options = PlayOptions {
        duration: Some(Duration::from_secs(2)),
        record: 1500,
        budget: Duration::from_millis(1),
    };
    let session = Session::begin(device, table, limits).unwrap();
    play(session, &options, &Board::default(), || (), stop, look)
}

// Verifies: HID-053.
#[test]
fn a_session_is_played_and_recorded_as_far_as_there_is_room() {
    let played = played(|| (), || false, |_, _| ()).unwrap();
    assert_eq!(played.end, End::Asked);
    assert_eq!(played.counters.cycles, 2000);
    assert_eq!((played.cycles.len(), played.held_up), (1500, None));
}

// Verifies: HID-054. A lower bound of a time alone: no machine is too slow for it.
#[test]
fn a_loop_that_is_held_up_is_seen() {
    let hold = || std::thread::sleep(Duration::from_millis(400));
    let mut seen = Duration::ZERO;
    let played = played(hold, || false, |_, silent| seen = seen.max(silent)).unwrap();
    let held_up = played.held_up.unwrap();
    assert!(held_up > HELD_UP && seen > HELD_UP, "{held_up:?} {seen:?}");
}

// Verifies: HID-054.
#[test]
fn the_wish_to_stop_reaches_the_loop() {
    let asked = std::sync::atomic::AtomicBool::new(false);
    let (sender, receiver) = std::sync::mpsc::channel::<()>();
    // The loop waits in its write until the supervisor has passed the wish on.
    let wait = move || {
        let _ = receiver.recv_timeout(Duration::from_secs(60));
    };
    let mut sender = Some(sender);
    let look = |counters: &Counters, _| {
        if counters.cycles > 900 && asked.swap(true, Ordering::Relaxed) {
            sender.take();
        }
    };
    let played = played(wait, || asked.load(Ordering::Relaxed), look).unwrap();
    assert_eq!(played.end, End::Asked);
    assert!(played.counters.cycles < 1100, "{:?}", played.counters);
}

// Verifies: HID-016.
#[test]
fn a_panic_on_the_servo_thread_ends_the_supervisor() {
    assert_eq!(played(|| panic!("planted"), || false, |_, _| ()), None);
}
