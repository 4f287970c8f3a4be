//! Sessions with defects at random.

use super::*;

/// A defect from random words.
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
        9 => Defect::Garbage(InvalidReport::Value { found: small as u8 }),
        10 => Defect::Glitch(words[3] as i16),
        _ => Defect::ClockJump(time),
    }
}

// Verifies: HID-024, SRV-020, SRV-021, SRV-032.
#[test]
fn a_million_cycles_with_faults_stay_within_the_limits() {
    let generator = crate::stats::random::Generator::new(20_261_121, 5);
    let (mut cycles, mut sessions, mut ends) = (0u64, 0u64, [0u64; 3]);
    let mut unstopped = 0u64;
    while cycles < 1_000_000 {
        let faults = (0..sessions % 4).map(|number| {
            let words = generator.words([sessions, number, 0, 0]);
            let at = MS * (words[3] >> 32).rem_euclid(4000) as u32;
            (at, defect(words))
        });
        // In half of all sessions what is sent is refused from some time on: so often, or for ever.
        let [when, often, ..] = generator.words([sessions, 0, 0, 1]);
        let refusals = [0, 0, 1 + (often % 20) as u32, u32::MAX][sessions as usize / 4 % 4];
        let (refuses_from, left) = (MS * (when % 3900) as u32, Cell::new(0));
        let mut session = begin(Watched(device(faults.collect()), refuse(&left)));
        let mut last = [0i32; 2];
        let mut played = true;
        let mut last_written = Duration::ZERO;
        let end = session.run(|cycle, _| {
            if last_written < refuses_from && cycle.written >= refuses_from {
                left.set(refusals);
            }
            last_written = cycle.written;
            cycles += 1;
            let force = [cycle.force.lateral, cycle.force.normal].map(i32::from);
            for axis in 0..2 {
                // 2 N are 4000 counts; released by 0.2 N, 400 counts, a cycle, and one for rounding.
                assert!(force[axis].abs() <= 4000, "{cycle:?}");
                assert!((force[axis] - last[axis]).abs() <= 401, "{cycle:?}");
                let holds = cycle.playing || force[axis].abs() <= last[axis].abs();
                assert!(holds, "{cycle:?}");
            }
            (last, played) = (force, cycle.playing);
            cycle.written < MS * 3900
        });
        assert!(!end.to_string().is_empty());
        let kind = match end {
            End::Asked => 0,
            End::Fault(fault) => {
                assert!(!played && last == [0, 0], "{fault:?}");
                assert_ne!(fault, ServoFault::State);
                1
            }
            End::Device(_) => 2,
            End::Unstopped(..) => {
                // The device's own watchdog drops the force after 15 ms, if no report comes through before.
                for _ in 0..17 {
                    let _ = session.cycle(Request::Arm);
                }
                unstopped += 1;
                2
            }
        };
        ends[kind] += 1;
        let device = &session.device().0;
        let gone = device.check_plugged().is_err();
        assert!(gone || device.motor_force() == [0.0, 0.0], "{kind}");
        sessions += 1;
    }
    // Each way to end is met often.
    assert!(ends.iter().all(|&count| count > sessions / 20), "{ends:?}");
    assert!(unstopped > sessions / 20, "{unstopped} of {sessions}");
}
