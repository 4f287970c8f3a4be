//! The simulated device, and the loop on it.

mod random;

use std::cell::Cell;

use super::*;
use crate::hid::tests::{MS, Sent, Watched, begin, probing, recorded, table};
use crate::hid::{Counters, End, Session};
use crate::servo::{Fault as ServoFault, Limits, Mode, Request};
use palpate_asserts::{assert_cases, assert_near};

fn device(faults: Vec<(Duration, Defect)>) -> SimulatedDevice {
    probing(1500 * MS, faults)
}

/// A device that follows the hand without force, friction or play.
fn ideal(faults: Vec<(Duration, Defect)>) -> SimulatedDevice {
    let mechanics = Mechanics {
        backlash_m: 0.0,
        hand_n_per_m: f64::INFINITY,
        ..Mechanics::PAPER
    };
    let trajectory = device(vec![]).trajectory;
    SimulatedDevice::new(PAPER, mechanics, trajectory, faults)
}

// Verifies: HID-020.
#[test]
fn the_handle_swings_as_a_damped_spring_does() {
    let mechanics = Mechanics {
        friction_n: 0.0,
        backlash_m: 0.0,
        ..Mechanics::PAPER
    };
    let mut handle = Handle::at(mechanics, 0.0);
    // m x″ + c x′ + k x = k h: x = h (1 − e^(−σt) (cos ωt + σ/ω sin ωt)).
    let (m, k) = (0.05, 500.0);
    let c: f64 = 5.6;
    let sigma = c / (2.0 * m);
    let omega = (k / m - sigma * sigma).sqrt();
    for tick in 1..=60 {
        handle.advance(1e-3, 0.01, 0.0);
        let t = f64::from(tick) * 1e-3;
        let swing = (omega * t).cos() + sigma / omega * (omega * t).sin();
        let expected = 0.01 * (1.0 - (-sigma * t).exp() * swing);
        // The spring acts half a step early on 0.01 m at 100/s, and the damping (σ = 56/s) up to a
        // step late: 0.01 · (100/2 + 56) · 1e-4.
        assert_near(handle.position, expected, 1.06e-4);
    }
}

// Verifies: HID-020.
#[test]
fn friction_holds_the_handle_and_backlash_hides_a_small_motion() {
    let mut handle = Handle::at(Mechanics::PAPER, 0.0);
    for _ in 0..100 {
        handle.advance(1e-3, 0.0, 0.139);
    }
    assert_eq!(handle.position, 0.0);
    // 0.3 N against 0.14 N of friction: 0.16 N on the hand's 500 N/m, less the friction on the way back.
    for _ in 0..2000 {
        handle.advance(1e-3, 0.0, 0.3);
    }
    let (low, high) = ((0.3 - 0.14) / 500.0, (0.3 + 0.14) / 500.0);
    let holds = (low - 1e-9..=high + 1e-9).contains(&handle.position);
    assert!(holds, "{}", handle.position);
    assert!((handle.encoder - (handle.position - 10e-6)).abs() < 1e-12);
}

// Verifies: HID-013, HID-018, HID-020.
#[test]
fn the_force_of_the_table_reaches_the_motors() {
    let mut session = begin(ideal(vec![]));
    let mut compared = 0;
    let mut last = [0.0; 2];
    let end = session.run(|cycle, _| {
        let report = cycle.position.unwrap();
        let depth = -f64::from(report.normal) * 1e-6;
        let lateral = f64::from(report.lateral) * 1e-6;
        // 400 N/m along the depth and 50 N/m along x.
        let expected = [50.0 * lateral * depth / 0.008, 400.0 * depth];
        let found = [cycle.force.lateral, cycle.force.normal].map(|count| f64::from(count) * 5e-4);
        let settled = (0..2).all(|axis| (expected[axis] - last[axis]).abs() < 0.05);
        if cycle.playing && settled && depth > 0.0 {
            compared += 1;
            // Half a count, and the rounding of the kernel, which is far below.
            let near = |axis| f64::abs(found[axis] - expected[axis]) < 0.26e-3;
            assert!(near(0) && near(1), "{expected:?} {found:?}");
        }
        last = found;
        cycle.written < 3900 * MS
    });
    assert_eq!(end, End::Asked);
    assert!(compared > 3000, "{compared}");
    assert_eq!(session.device().motor_force(), [0.0, 0.0]);
    let found = session.counters();
    let missed = 1; // the first
    assert_eq!((found.missed, found.skipped, found.garbage), (missed, 0, 0));
}

// Verifies: HID-013.
#[test]
fn each_force_report_is_one_ahead_of_the_last() {
    // Repeated numbers, silence and a long session change nothing: 70 000 cycles go round the 65 536 numbers.
    let faults = vec![
        (100 * MS, Defect::Repeat(4)),
        (200 * MS, Defect::Silence(3 * MS)),
    ];
    let cycles = recorded(ideal(faults), 70_000);
    assert_eq!(cycles.len(), 70_000);
    for pair in cycles.windows(2) {
        let [before, after] = [0, 1].map(|k: usize| pair[k].force.sequence);
        assert_eq!(after, before.wrapping_add(1));
    }
}

// Verifies: HID-020.
#[test]
fn a_session_is_the_same_to_the_bit_every_time() {
    let faults = || vec![(900 * MS, Defect::Repeat(4))];
    let run = || recorded(device(faults()), 3000);
    assert_eq!(run(), run());
}

/// Runs the paper's device with one fault at 1.2 s, in the middle of a sweep; the end, the last mode,
/// the motors' force then, and the counters.
fn run_with(defect: Defect) -> (End, Mode, [f64; 2], Counters) {
    let mut session = begin(device(vec![(1200 * MS, defect)]));
    let end = session.run(|cycle, _| {
        if cycle.written < 1200 * MS && cycle.written > 700 * MS {
            assert!(cycle.playing && cycle.force.normal > 1000, "{cycle:?}");
        }
        cycle.written < 3000 * MS
    });
    let force = session.device().motor_force();
    (end, session.mode(), force, session.counters())
}

/// The force is released in ten cycles; whoever ends the session within them is told the fault all the same.
// Verifies: HID-019.
#[test]
fn a_fault_is_the_end_of_a_session_that_is_ended_while_its_force_is_released() {
    let mut session = begin(device(vec![(1200 * MS, Defect::DeviceFault(2 * MS))]));
    let mut last = 0;
    let end = session.run(|cycle, _| {
        last = cycle.force.normal;
        cycle.written < 1200 * MS || cycle.playing
    });
    assert!(
        last > 0 && matches!(end, End::Fault(ServoFault::Device)),
        "{last} {end}"
    );
}

// Verifies: HID-016, HID-019, HID-020.
#[test]
fn every_fault_that_ends_a_session_is_named_and_leaves_the_motors_without_force() {
    let second = Duration::from_secs(1);
    let garbage = InvalidReport::Value { found: 3 };
    let [stale, faulty] = ["no fresh report for too long", "the device reports a fault"]
        .map(|fault| format!("stopped by a fault: {fault}"));
    let blocked = "stopped: the device takes no more reports";
    let interrupted = "stopped: a signal interrupted the device";
    for (defect, message) in [
        (Defect::Unplug, "stopped: the device is gone"),
        (Defect::Stall(second * 6), blocked),
        (Defect::Interrupt, interrupted),
        (Defect::Silence(second), &stale),
        (Defect::DeviceFault(MS * 2), &faulty),
        (Defect::Repeat(30), &stale),
        (Defect::SequenceBack(500), &stale),
        (Defect::ClockJump(second * 33), &stale),
        // Blocks the loop for longer than the device's watchdog.
        (Defect::Stall(MS * 200), &faulty),
    ] {
        let (end, _, force, _) = run_with(defect);
        assert_eq!(end.to_string(), message, "{defect:?}");
        if defect != Defect::Unplug {
            assert_eq!(force, [0.0, 0.0], "{defect:?}");
        }
    }
    for (defect, missed) in [
        (Defect::Repeat(4), 4),
        (Defect::Silence(MS * 5), 2), // five reports, two periods a cycle
        (Defect::Garbage(garbage), 1),
        (Defect::Stall(MS * 10), 0),
        (Defect::Glitch(20_000), 0),
        (Defect::DeadmanReleased(MS * 40), 0),
        (Defect::ClockJump(MS * 20), 0),
    ] {
        let (end, mode, force, counters) = run_with(defect);
        assert_eq!((end, mode), (End::Asked, Mode::Disarmed), "{defect:?}");
        assert_eq!(force, [0.0, 0.0], "{defect:?}");
        assert_eq!(counters.missed, 1 + missed, "{defect:?}");
    }
}

// Verifies: HID-013.
#[test]
fn reports_passed_over_and_reports_that_never_came_are_counted_apart() {
    let (found, expected) = (9, 1);
    let garbage = InvalidReport::Number { found, expected };
    for (defect, counted) in [
        (Defect::Stall(10 * MS), [9, 0, 0]),
        (Defect::ClockJump(20 * MS), [0, 20, 0]),
        (Defect::Garbage(garbage), [0, 1, 1]),
    ] {
        let counters = run_with(defect).3;
        let found = [counters.passed_over, counters.skipped, counters.garbage];
        assert_eq!(found, counted, "{defect:?}");
    }
}

/// A device that always has one more report.
struct Endless(PositionReport);

impl HapticDevice for Endless {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        Ok(PAPER)
    }
    fn read(&mut self, _: Duration) -> Result<Received, DeviceError> {
        self.0.sequence = self.0.sequence.wrapping_add(1);
        Ok(Received::Report(self.0))
    }
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.0.force_sequence = report.sequence;
        Ok(())
    }
    fn control(&mut self, _: Control) -> Result<(), DeviceError> {
        Ok(())
    }
    fn now(&self) -> Duration {
        Duration::ZERO
    }
}

// Verifies: HID-013.
#[test]
fn a_cycle_takes_at_most_64_reports_and_loses_none() {
    let mut session = begin(Endless(PositionReport::default()));
    session.run(|_, counters| counters.cycles < 5);
    let counters = session.counters();
    // 63 in each cycle, but perhaps for those before the first.
    let found = [counters.passed_over / counters.cycles, counters.skipped];
    assert_eq!(found, [63, 0], "{counters:?}");
}

// Verifies: HID-013.
#[test]
fn reports_that_never_came_are_counted_where_the_numbers_begin_again() {
    // The device begins at 65 526; the first report that comes after 20 lost ones has a number of 0 to 30.
    for lost in [1, 9, 10, 11, 20] {
        let faults = vec![
            (MS, Defect::SequenceBack(11)),
            (5 * MS, Defect::ClockJump(lost * MS)),
        ];
        let mut session = begin(ideal(faults));
        session.run(|_, counters| counters.cycles < 40);
        let counters = session.counters();
        assert_eq!(
            (counters.skipped, counters.missed),
            (lost.into(), 1),
            "{lost}"
        );
    }
}

// Verifies: CLI-065.
#[test]
fn counters_have_the_same_keys_whatever_they_count() {
    let keys = |counters: Counters| {
        let json = serde_json::to_value(counters).unwrap();
        json.as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect::<Vec<_>>()
    };
    let expected = "cycles garbage missed passed_over played skipped stops_refused";
    let one = Counters {
        cycles: 1,
        played: 1,
        missed: 1,
        skipped: 1,
        passed_over: 1,
        garbage: 1,
        stops_refused: 1,
    };
    assert_eq!(keys(one).join(" "), expected);
    assert_eq!(keys(Counters::default()).join(" "), expected);
}

// Verifies: HID-020.
#[test]
fn the_device_drops_its_force_by_itself_and_keeps_the_oldest_reports() {
    let mut device = ideal(vec![]);
    device.control(Control::Enable).unwrap();
    let force = ForceReport {
        lateral: 200,
        normal: -400,
        sequence: 1,
        flags: ForceReport::PLAY,
    };
    device.write(&force).unwrap();
    let on = [0.1, -0.2];
    for (time, force) in [(0, on), (15, on), (16, [0.0; 2]), (200, [0.0; 2])] {
        device.pass(time * MS);
        assert_eq!(device.motor_force(), force, "{time} ms");
    }
    let mut sequences = Vec::new();
    while let Received::Report(report) = device.read(Duration::ZERO).unwrap() {
        sequences.push(report.sequence);
    }
    assert!(sequences.into_iter().eq(1..=63));
}

// Verifies: HID-017, HID-008.
#[test]
fn a_session_begins_only_with_a_device_that_can_be_trusted() {
    let begins = |capabilities: Capabilities, force: f32| {
        let mut device = ideal(vec![]);
        device.capabilities = capabilities;
        let limits = Limits::new(force, 0.05, 0.2, 10).unwrap();
        Session::begin(device, table(3.2), limits).map(|_| ())
    };
    let weak = Capabilities {
        largest_force_mn: 2000,
        ..PAPER
    };
    // 2 N and not a step of an f32 more.
    assert_eq!(begins(weak, 2.0), Ok(()));
    assert!(begins(weak, 2f32.next_up()).is_err());
    let patient = Capabilities {
        watchdog_ms: 100,
        ..PAPER
    };
    assert_eq!(begins(patient, 2.0), Ok(()));
    assert_cases("refused/device.txt", "devices", |case| {
        let (mut capabilities, words) = (PAPER, case.split(' ').collect::<Vec<_>>());
        for pair in words.chunks(2) {
            let changed = match pair[0] {
                "version" => &mut capabilities.version,
                "period_us" => &mut capabilities.period_us,
                "watchdog_ms" => &mut capabilities.watchdog_ms,
                "largest_force_mn" => &mut capabilities.largest_force_mn,
                _ => &mut capabilities.force_unit_un,
            };
            *changed = pair[1].parse().unwrap();
        }
        begins(capabilities, 2.0).unwrap_err().to_string()
    });
}

// Verifies: HID-012, HID-016.
#[test]
fn a_panic_stops_the_device() {
    let (force, stopped) = (Cell::new(0), Cell::new(false));
    let run = std::panic::AssertUnwindSafe(|| {
        let watch = |sent, _| {
            match sent {
                Sent::Force(report) => force.set(report.normal),
                Sent::Control(control) => stopped.set(control == Control::Stop),
            }
            Ok(())
        };
        begin(Watched(device(vec![]), watch)).run(|cycle, _| {
            assert!(cycle.force.normal < 1000, "planted");
            true
        })
    });
    assert!(std::panic::catch_unwind(run).is_err());
    assert_eq!((force.get(), stopped.get()), (0, true));
}

fn failed(state: DeviceState) -> DeviceError {
    DeviceError::new(state, "refused")
}

fn refused() -> DeviceError {
    failed(DeviceState::There)
}

/// Refuses as many times as `left` says.
fn refuse(left: &Cell<u32>) -> impl FnMut(Sent, Duration) -> Result<(), DeviceError> {
    move |_, _| {
        let after = left.get().checked_sub(1);
        left.set(after.unwrap_or(0));
        after.map_or(Ok(()), |_| Err(refused()))
    }
}

// Verifies: HID-025, HID-027.
#[test]
fn a_stop_is_sent_again_until_the_device_takes_it_and_nothing_arms_after_it() {
    for refusals in 0..30 {
        let left = Cell::new(0);
        let mut session = begin(Watched(device(vec![]), refuse(&left)));
        let mut arm = true;
        while session.device().0.motor_force()[1] <= 0.0 {
            arm = !arm && session.mode() == Mode::Disarmed;
            let request = if arm { Request::Arm } else { Request::None };
            session.cycle(request).unwrap();
        }
        left.set(refusals);
        // Five stops, then five zeros: the last of them fails where ten are refused.
        let first = session.stop();
        assert_eq!(first.is_ok(), refusals < 5, "{refusals}");
        let refused = u64::from(refusals.min(10));
        assert_eq!(session.counters().stops_refused, refused);
        let moved = session.device().0.motor_force() != [0.0, 0.0];
        assert_eq!(moved, refusals >= 10, "{refusals}");
        for _ in 0..20 {
            let cycle = session.cycle(Request::Arm);
            assert!(cycle.is_err() || session.mode() == Mode::Disarmed);
        }
        assert_eq!(session.stop(), Ok(()), "{refusals}");
        assert_eq!(session.device().0.motor_force(), [0.0, 0.0]);
        // Nothing is sent to a device that has taken the stop.
        left.set(1);
        assert_eq!(session.stop(), Ok(()), "{refusals}");
        assert_eq!(left.replace(0), 1, "{refusals}");
        // While the deadman is not held, the kernel would arm.
        let mut session = begin(Watched(device(vec![]), refuse(&left)));
        session.cycle(Request::None).unwrap();
        left.set(refusals);
        let _ = session.stop();
        left.set(0);
        for request in [Request::Arm, Request::None, Request::Arm] {
            session.cycle(request).unwrap();
            assert_eq!(session.mode(), Mode::Disarmed, "{refusals}");
        }
    }
}

// Verifies: HID-025.
#[test]
fn a_stop_that_the_device_does_not_take_is_told_beside_the_end() {
    use DeviceState::{Gone, Stalled, There};
    let unstopped = |state| End::Unstopped(Box::new(End::Asked), failed(state));
    // Who answers so: the control, the force report; and how often in all. One that is gone, or blocks each write for
    // seconds, is asked once for each.
    for (control, force, end, refusals) in [
        (None, None, End::Asked, 0),
        (Some(There), Some(There), unstopped(There), 10),
        (Some(There), None, unstopped(There), 5),
        (None, Some(There), unstopped(There), 1),
        (Some(Gone), Some(Gone), End::Device(failed(Gone)), 2),
        (Some(Stalled), Some(Stalled), unstopped(Stalled), 2),
    ] {
        let ending = Cell::new(false);
        let watch = |sent, _| {
            let answer = match sent {
                Sent::Control(_) => control,
                Sent::Force(_) => force,
            };
            let answer = answer.filter(|_| ending.get());
            answer.map_or(Ok(()), |state| Err(failed(state)))
        };
        let mut session = begin(Watched(device(vec![]), watch));
        let found = session.run(|_, counters| {
            ending.set(counters.cycles == 50);
            counters.cycles < 50
        });
        assert_eq!((found, session.counters().stops_refused), (end, refusals));
    }
    assert_eq!(
        unstopped(There).to_string(),
        "ended as asked; stopping the device failed (refused): its own watchdog must drop the force"
    );
}
