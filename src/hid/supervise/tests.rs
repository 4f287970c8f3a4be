//! The supervisor over devices that fail on the clock of the host.

use super::*;
use crate::hid::simulated::{Defect, SimulatedDevice};
use crate::hid::tests::{limits, probing, with_table};
use crate::hid::{Capabilities, Control, ForceReport, Received};

/// A device whose first write after `trouble`, and one every 100 ms from then on, does what it says.
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
            self.trouble += Duration::from_millis(100);
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
    let device = probing(Duration::from_secs(1), vec![]);
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
    with_table(0.0, |table| {
        let session = Session::begin(device, table, limits()).unwrap();
        play(session, &options, &Board::default(), || (), stop, look)
    })
}

// Verifies: HID-053.
#[test]
fn a_session_is_played_and_recorded_as_far_as_there_is_room() {
    let played = played(|| (), || false, |_, _| ()).unwrap();
    assert_eq!(played.end, End::Asked);
    assert_eq!(played.counters.cycles, 2000);
    assert_eq!((played.cycles.len(), played.held_up), (1500, None));
}

// Verifies: HID-054.
#[test]
fn the_longest_time_that_a_loop_is_held_up_is_told() {
    // Each hold lasts until the supervisor has seen it last so long, so that no machine is too slow for this.
    let (seen, holds) = std::sync::mpsc::channel::<()>();
    let hold = move || {
        let _ = holds.recv_timeout(Duration::from_secs(60));
    };
    let mut least = vec![HELD_UP, 3 * HELD_UP];
    let mut seen = Some(seen);
    let look = |_: &Counters, silent| match least.last() {
        Some(&time) if silent > time => {
            least.pop();
            let _ = seen.as_ref().unwrap().send(());
        }
        Some(_) => (),
        None => seen = None,
    };
    let played = played(hold, || false, look).unwrap();
    assert!(least.is_empty());
    assert!(played.held_up > Some(3 * HELD_UP), "{:?}", played.held_up);
}

// Verifies: HID-053.
#[test]
fn a_signal_that_interrupts_a_read_ends_the_session_as_asked_only_if_it_was_asked() {
    let end = |asked: bool| {
        let at = Duration::from_millis(1);
        let device = probing(Duration::from_secs(1), vec![(at, Defect::Interrupt)]);
        let options = PlayOptions {
            duration: None,
            record: 0,
            budget: at,
        };
        let board = Board::default();
        if asked {
            board.stop();
        }
        with_table(0.0, |table| {
            let session = Session::begin(device, table, limits()).unwrap();
            servo_loop(session, &options, &board).end
        })
    };
    assert_eq!(end(true), End::Asked);
    assert_eq!(end(false), End::Device(DeviceError::Interrupted));
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
