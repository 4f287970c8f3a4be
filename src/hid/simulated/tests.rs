//! The simulated device, and the loop on it.

use super::*;
use crate::hid::{End, Session, SessionError};
use crate::servo::{Axis, Fault as ServoFault, Force, Limits, Mode, Request, Table};

const MS: Duration = Duration::from_millis(1);

const DEPTHS: [f32; 2] = [0.0, 0.008];
const LATERALS: [f32; 2] = [-0.02, 0.02];

/// A table with 400 N/m along the depth and 50 N/m along x.
fn with_table<R>(then: impl FnOnce(Table) -> R) -> R {
    let force = |lateral, normal| Force { lateral, normal };
    let forces = [
        force(0.0, 0.0),
        force(0.0, 0.0),
        force(-1.0, 3.2),
        force(1.0, 3.2),
    ];
    let heights = [Axis::reciprocal_width(DEPTHS[0], DEPTHS[1])];
    let widths = [Axis::reciprocal_width(LATERALS[0], LATERALS[1])];
    let depths = Axis::new(&DEPTHS, &heights).unwrap();
    let laterals = Axis::new(&LATERALS, &widths).unwrap();
    then(Table::new(depths, laterals, &forces).unwrap())
}

fn limits() -> Limits {
    Limits::new(2.0, 0.05, 0.2, 10).unwrap()
}

fn device(mechanics: Mechanics, faults: Vec<Fault>) -> SimulatedDevice {
    let sweep = Duration::from_millis(1500);
    let trajectory = Trajectory::probing(0.004, 0.01, sweep);
    SimulatedDevice::new(PAPER, mechanics, trajectory, Duration::ZERO, faults)
}

fn fault(at: Duration, defect: Defect) -> Vec<Fault> {
    vec![Fault { at, defect }]
}

// Verifies: HID-022.
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
        assert!(
            (handle.position() - expected).abs() < 1.06e-4,
            "{t}: {}",
            handle.position()
        );
    }
}

// Verifies: HID-022.
#[test]
fn friction_holds_the_handle_and_backlash_hides_a_small_motion() {
    let mut handle = Handle::at(Mechanics::PAPER, 0.0);
    for _ in 0..100 {
        handle.advance(1e-3, 0.0, 0.139);
    }
    assert_eq!(handle.position(), 0.0);
    // 0.3 N against 0.14 N of friction: 0.16 N on the hand's 500 N/m, less the friction on the way back.
    for _ in 0..2000 {
        handle.advance(1e-3, 0.0, 0.3);
    }
    let (low, high) = ((0.3 - 0.14) / 500.0, (0.3 + 0.14) / 500.0);
    assert!(
        (low - 1e-9..=high + 1e-9).contains(&handle.position()),
        "{}",
        handle.position()
    );
    assert!((handle.encoder() - (handle.position() - 10e-6)).abs() < 1e-12);
}

// Verifies: HID-013, HID-018, HID-020.
#[test]
fn the_force_of_the_table_reaches_the_motors() {
    with_table(|table| {
        let mut session =
            Session::begin(device(Mechanics::IDEAL, vec![]), table, limits()).unwrap();
        let mut compared = 0;
        let mut last = [0.0; 2];
        let end = session.run(|cycle, _| {
            let report = cycle.position.unwrap();
            let depth = -f64::from(report.normal) * 1e-6;
            let lateral = f64::from(report.lateral) * 1e-6;
            let expected = [50.0 * lateral * depth / 0.008, 400.0 * depth];
            let found =
                [cycle.force.lateral, cycle.force.normal].map(|count| f64::from(count) * 5e-4);
            let settled = (0..2).all(|axis| (expected[axis] - last[axis]).abs() < 0.05);
            if cycle.playing && settled && depth > 0.0 {
                compared += 1;
                for axis in 0..2 {
                    // Half a count, and the rounding of the kernel, which is far below.
                    assert!(
                        (found[axis] - expected[axis]).abs() < 0.26e-3,
                        "{expected:?} {found:?}"
                    );
                }
            }
            last = found;
            cycle.written < Duration::from_millis(3900)
        });
        assert_eq!(end, End::Asked);
        assert!(compared > 3000, "{compared}");
        assert_eq!(session.device().motor_force(), [0.0, 0.0]);
        let counters = session.counters();
        assert_eq!(
            (counters.missed, counters.skipped, counters.garbage),
            (1, 0, 0)
        ); // the first
    });
}

// Verifies: HID-015.
#[test]
fn each_force_report_is_one_ahead_of_the_last() {
    with_table(|table| {
        // Repeated numbers, silence and a long session change nothing: 70 000 cycles go round the 65 536 numbers.
        let faults = vec![
            Fault {
                at: MS * 100,
                defect: Defect::Repeat(4),
            },
            Fault {
                at: MS * 200,
                defect: Defect::Silence(MS * 3),
            },
        ];
        let mut session =
            Session::begin(device(Mechanics::IDEAL, faults), table, limits()).unwrap();
        let mut numbers = Vec::new();
        session.run(|cycle, _| {
            numbers.push(cycle.force.sequence);
            numbers.len() < 70_000
        });
        assert_eq!(numbers.len(), 70_000);
        let ahead = |pair: &[u16]| pair[1] == pair[0].wrapping_add(1);
        assert!(numbers.windows(2).all(ahead));
    });
}

// Verifies: HID-020.
#[test]
fn a_session_is_the_same_to_the_bit_every_time() {
    let run = || {
        with_table(|table| {
            let faults = fault(MS * 900, Defect::Repeat(4));
            let mut session =
                Session::begin(device(Mechanics::PAPER, faults), table, limits()).unwrap();
            let mut cycles = Vec::new();
            session.run(|cycle, _| {
                cycles.push(*cycle);
                cycles.len() < 3000
            });
            cycles
        })
    };
    assert_eq!(run(), run());
}

/// Runs the paper's device with one fault at 1.2 s, in the middle of a sweep; the end, the last mode,
/// the motors' force then, and the counters.
fn run_with(defect: Defect) -> (End, Mode, [f64; 2], crate::hid::Counters) {
    with_table(|table| {
        let device = device(Mechanics::PAPER, fault(MS * 1200, defect));
        let mut session = Session::begin(device, table, limits()).unwrap();
        let end = session.run(|cycle, _| {
            if cycle.written < MS * 1200 && cycle.written > MS * 700 {
                assert!(cycle.playing && cycle.force.normal > 1000, "{cycle:?}");
            }
            cycle.written < MS * 3000
        });
        (
            end,
            session.mode(),
            session.device().motor_force(),
            session.counters(),
        )
    })
}

// Verifies: HID-016, HID-019, HID-023.
#[test]
fn every_fault_that_ends_a_session_is_named_and_leaves_the_motors_without_force() {
    let second = Duration::from_secs(1);
    let garbage = InvalidReport::Length {
        found: 3,
        expected: 11,
    };
    for (defect, message) in [
        (Defect::Unplug, "stopped: the device is gone"),
        (
            Defect::Stall(second * 6),
            "stopped: the device takes no more reports",
        ),
        (
            Defect::Interrupt,
            "stopped: a signal interrupted the device",
        ),
        (
            Defect::Silence(second),
            "stopped by a fault: no fresh report for too long",
        ),
        (
            Defect::DeviceFault(MS * 2),
            "stopped by a fault: the device reports a fault",
        ),
        (
            Defect::Repeat(30),
            "stopped by a fault: no fresh report for too long",
        ),
        (
            Defect::SequenceBack(500),
            "stopped by a fault: no fresh report for too long",
        ),
        (
            Defect::ClockJump(second * 33),
            "stopped by a fault: no fresh report for too long",
        ),
        // Blocks the loop for longer than the device's watchdog.
        (
            Defect::Stall(MS * 200),
            "stopped by a fault: the device reports a fault",
        ),
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

// Verifies: HID-014.
#[test]
fn reports_passed_over_and_reports_that_never_came_are_counted_apart() {
    let counters = run_with(Defect::Stall(MS * 10)).3;
    assert_eq!((counters.drained, counters.skipped), (9, 0));
    let counters = run_with(Defect::ClockJump(MS * 20)).3;
    assert_eq!((counters.drained, counters.skipped), (0, 20));
    let garbage = InvalidReport::Number {
        found: 9,
        expected: 1,
    };
    let counters = run_with(Defect::Garbage(garbage)).3;
    assert_eq!((counters.garbage, counters.skipped), (1, 1));
}

// Verifies: HID-021.
#[test]
fn the_device_drops_its_force_by_itself_and_keeps_the_oldest_reports() {
    let mut device = device(Mechanics::IDEAL, vec![]);
    device.control(Control::Enable).unwrap();
    let force = ForceReport {
        lateral: 200,
        normal: -400,
        sequence: 1,
        flags: ForceReport::PLAY,
    };
    device.write(&force).unwrap();
    assert_eq!(device.motor_force(), [0.1, -0.2]);
    device.pass(MS * 15);
    assert_eq!(device.motor_force(), [0.1, -0.2]);
    device.pass(MS * 16);
    assert_eq!(device.motor_force(), [0.0, 0.0]);
    device.pass(MS * 200);
    let mut sequences = Vec::new();
    while let Received::Report(report) = device.read(Duration::ZERO).unwrap() {
        sequences.push(report.sequence);
    }
    assert_eq!(sequences, (1..=63).collect::<Vec<u16>>());
}

// Verifies: HID-017.
#[test]
fn a_session_begins_only_with_a_device_that_can_be_trusted() {
    let refused = |change: fn(&mut Capabilities)| {
        let mut device = device(Mechanics::IDEAL, vec![]);
        change(&mut device.capabilities);
        with_table(|table| Session::begin(device, table, limits()).err().unwrap())
    };
    assert!(matches!(
        refused(|c| c.version = 2),
        SessionError::Capabilities(_)
    ));
    assert_eq!(refused(|c| c.period_us = 0), SessionError::Period);
    assert_eq!(refused(|c| c.watchdog_ms = 0), SessionError::NoWatchdog);
    let weak = SessionError::Force {
        limit: 2.0,
        largest: 1.9,
    };
    assert_eq!(refused(|c| c.largest_force_mn = 1900), weak);
}

// Verifies: HID-012, HID-016.
#[test]
fn a_panic_stops_the_device() {
    /// A device that is watched from outside. It has the operations of HID-012 and no other: a further one that the
    /// loop needs would not compile here.
    struct Watched<'a>(SimulatedDevice, &'a std::cell::Cell<(i16, bool)>);
    impl HapticDevice for Watched<'_> {
        fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
            self.0.capabilities()
        }
        fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
            self.0.read(timeout)
        }
        fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
            self.1.set((report.normal, self.1.get().1));
            self.0.write(report)
        }
        fn control(&mut self, control: Control) -> Result<(), DeviceError> {
            self.1.set((self.1.get().0, control == Control::Stop));
            self.0.control(control)
        }
        fn now(&self) -> Duration {
            self.0.now()
        }
    }
    let seen = std::cell::Cell::new((0, false));
    let run = std::panic::AssertUnwindSafe(|| {
        with_table(|table| {
            let device = Watched(device(Mechanics::PAPER, vec![]), &seen);
            let mut session = Session::begin(device, table, limits()).unwrap();
            session.run(|cycle, _| {
                assert!(cycle.force.normal < 1000, "planted");
                true
            })
        })
    });
    assert!(std::panic::catch_unwind(run).is_err());
    assert_eq!(seen.get(), (0, true));
}

fn refused() -> DeviceError {
    DeviceError::System {
        message: "refused".into(),
        gone: false,
    }
}

/// A device that refuses so many stops and force reports.
struct Refusing<'a>(SimulatedDevice, &'a std::cell::Cell<u32>);

impl Refusing<'_> {
    fn refuses(&self) -> Result<(), DeviceError> {
        let left = self.1.get().checked_sub(1);
        self.1.set(left.unwrap_or(0));
        left.map_or(Ok(()), |_| Err(refused()))
    }
}

impl HapticDevice for Refusing<'_> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        self.0.capabilities()
    }
    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        self.0.read(timeout)
    }
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.refuses().and_then(|()| self.0.write(report))
    }
    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.refuses().and_then(|()| self.0.control(control))
    }
    fn now(&self) -> Duration {
        self.0.now()
    }
}

// Verifies: HID-025, HID-027.
#[test]
fn a_stop_is_sent_again_until_the_device_takes_it_and_nothing_arms_after_it() {
    for refusals in 0..30 {
        let left = std::cell::Cell::new(0);
        with_table(|table| {
            let device = Refusing(device(Mechanics::PAPER, vec![]), &left);
            let mut session = Session::begin(device, table, limits()).unwrap();
            let mut request = Request::None;
            while session.device().0.motor_force()[1] <= 0.0 {
                session.cycle(request).unwrap();
                let armed = session.mode() == Mode::Armed;
                request = if armed || request == Request::Arm {
                    Request::None
                } else {
                    Request::Arm
                };
            }
            left.set(refusals);
            // Five stops, then five zeros: the last of them fails where ten are refused.
            let first = session.stop();
            assert_eq!(first.is_ok(), refusals < 5, "{refusals}");
            let moved = session.device().0.motor_force() != [0.0, 0.0];
            assert_eq!(moved, refusals >= 10, "{refusals}");
            for _ in 0..20 {
                let cycle = session.cycle(Request::Arm);
                assert!(cycle.is_err() || session.mode() == Mode::Disarmed);
            }
            assert_eq!(session.stop(), Ok(()), "{refusals}");
            assert_eq!(session.device().0.motor_force(), [0.0, 0.0]);
        });
    }
}

// Verifies: HID-026.
#[test]
fn a_stop_that_the_device_does_not_take_is_told_beside_the_end() {
    let end = |left: u32, refused: u32| {
        let refusals = std::cell::Cell::new(0);
        with_table(|table| {
            let device = Refusing(device(Mechanics::PAPER, vec![]), &refusals);
            let mut session = Session::begin(device, table, limits()).unwrap();
            session.run(|_, counters| {
                let on = counters.cycles < u64::from(left);
                refusals.set(if on { 0 } else { refused });
                on
            })
        })
    };
    assert_eq!(end(50, 4), End::Asked);
    let unstopped = end(50, 10);
    assert_eq!(unstopped, End::Unstopped(Box::new(End::Asked), refused()));
    let said = unstopped.to_string();
    assert!(
        said.contains("ended as asked") && said.contains("refused") && said.contains("watchdog")
    );
}

/// A defect from three random words.
fn defect(words: [u64; 4]) -> Defect {
    let time = MS * (words[1] % 60) as u32;
    let small = (words[2] % 40) as u16;
    match words[0] % 12 {
        0 => Defect::Unplug,
        1 => Defect::Silence(time),
        2 => Defect::Stall(time),
        3 => Defect::DeviceFault(time),
        4 | 5 => Defect::DeadmanReleased(time),
        6 => Defect::Interrupt,
        7 => Defect::Repeat(small),
        8 => Defect::SequenceBack(small),
        9 => Defect::Garbage(InvalidReport::Length {
            found: usize::from(small),
            expected: 11,
        }),
        10 => Defect::Glitch(words[3] as i16),
        _ => Defect::ClockJump(time),
    }
}

// Verifies: HID-024, SRV-020, SRV-021, SRV-032.
#[test]
fn a_million_cycles_with_faults_stay_within_the_limits() {
    let generator = crate::stats::random::Generator::new(20_261_121, 5);
    let (mut cycles, mut sessions, mut ends) = (0u64, 0u64, [0u64; 3]);
    while cycles < 1_000_000 {
        let faults = (0..sessions % 4).map(|number| {
            let words = generator.words([sessions, number, 0, 0]);
            let at = MS * (words[3] >> 32).rem_euclid(4000) as u32;
            Fault {
                at,
                defect: defect(words),
            }
        });
        let device = device(Mechanics::PAPER, faults.collect());
        with_table(|table| {
            let mut session = Session::begin(device, table, limits()).unwrap();
            let mut last = [0i32; 2];
            let mut played = true;
            let end = session.run(|cycle, _| {
                cycles += 1;
                let force = [cycle.force.lateral, cycle.force.normal].map(i32::from);
                for axis in 0..2 {
                    // 2 N are 4000 counts; released by 0.2 N, 400 counts, a cycle, and one for rounding.
                    assert!(force[axis].abs() <= 4000, "{cycle:?}");
                    assert!((force[axis] - last[axis]).abs() <= 401, "{cycle:?}");
                    if !cycle.playing {
                        assert!(force[axis].abs() <= last[axis].abs(), "{cycle:?}");
                    }
                }
                (last, played) = (force, cycle.playing);
                cycle.written < MS * 3900
            });
            if let End::Fault(fault) = end {
                assert!(!played && last == [0, 0], "{fault:?}");
                assert_ne!(fault, ServoFault::State);
            }
            assert!(!end.to_string().is_empty());
            ends[match end {
                End::Asked => 0,
                End::Fault(_) => 1,
                End::Device(_) | End::Unstopped(..) => 2,
            }] += 1;
            if end != End::Device(DeviceError::Gone) {
                assert_eq!(session.device().motor_force(), [0.0, 0.0]);
            }
        });
        sessions += 1;
    }
    // Each way to end is met often.
    assert!(ends.iter().all(|&count| count > sessions / 20), "{ends:?}");
}
