//! Recordings of the simulated device.

use super::*;
use crate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use crate::servo::{Axis, Force};

/// Bilinear forces up to `normal` (N) at 8 mm.
fn with_table<R>(normal: f32, then: impl FnOnce(Table) -> R) -> R {
    let force = |lateral, normal| Force { lateral, normal };
    let forces = [
        Force::ZERO,
        Force::ZERO,
        force(-1.0, normal),
        force(1.0, normal),
    ];
    let knots = ([0.0, 0.008], [-0.02, 0.02]);
    let reciprocals = [knots.0, knots.1].map(|[start, end]| [Axis::reciprocal_width(start, end)]);
    let depths = Axis::new(&knots.0, &reciprocals[0]).unwrap();
    let laterals = Axis::new(&knots.1, &reciprocals[1]).unwrap();
    then(Table::new(depths, laterals, &forces).unwrap())
}

/// Half a second of probing, with a deadman held from 0.1 s on.
fn recorded() -> Recording {
    let limits = Limits::new(2.0, 0.05, 0.2, 10).unwrap();
    let trajectory = Trajectory::probing(0.004, 0.01, Duration::from_millis(500));
    let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, trajectory, Duration::ZERO, vec![]);
    let mut cycles = Vec::new();
    with_table(3.2, |table| {
        let mut session = Session::begin(device, table, limits).unwrap();
        session.run(|cycle, _| {
            cycles.push(RecordedCycle::from(cycle));
            cycles.len() < 700
        })
    });
    Recording {
        capabilities: PAPER,
        limits,
        cycles,
    }
}

// Verifies: HID-050.
#[test]
fn a_recording_is_read_back_as_it_was() {
    let recording = recorded();
    assert!(recording.cycles[600].playing && recording.cycles[600].force.normal > 1000);
    assert_eq!(
        Recording::parse(&recording.to_text()),
        Ok(recording.clone())
    );
    let mut gap = recording;
    gap.cycles[3].position = None;
    assert_eq!(Recording::parse(&gap.to_text()), Ok(gap));
}

// Verifies: HID-050.
#[test]
fn a_recorded_cycle_has_the_times_of_its_receipt_and_its_write() {
    let zero = ForceReport {
        lateral: 0,
        normal: 0,
        sequence: 1,
        flags: 1,
    };
    let recorded = RecordedCycle::from(&Cycle {
        position: None,
        force: zero,
        playing: false,
        woke: Duration::from_micros(1),
        received: Duration::from_micros(2),
        computed: Duration::from_micros(3),
        written: Duration::from_micros(4),
    });
    assert_eq!((recorded.received_us, recorded.written_us), (2, 4));
}

// Verifies: HID-052.
#[test]
fn a_recorded_report_is_read_once_in_its_cycle() {
    let recording = recorded();
    let mut device = Recorded {
        recording: &recording,
        cycle: 5,
        given: false,
    };
    let report = recording.cycles[5].position.unwrap();
    let mut read = || device.read(Duration::ZERO).unwrap();
    assert_eq!(read(), Received::Report(report));
    assert_eq!(read(), Received::Nothing);
}

// Verifies: HID-052.
#[test]
fn a_recording_plays_again_to_the_bit_and_tells_where_it_differs() {
    let recording = recorded();
    assert_eq!(with_table(3.2, |table| recording.replay(table)), Ok(700));
    let differs = with_table(3.3, |table| recording.replay(table)).unwrap_err();
    assert!(
        matches!(differs, RecordingError::Differs { cycle, .. } if cycle > 200),
        "{differs}"
    );
    let mut spoiled = recording.clone();
    spoiled.cycles[650].force.lateral += 1;
    let differs = with_table(3.2, |table| spoiled.replay(table)).unwrap_err();
    assert!(differs.to_string().starts_with("cycle 650: "), "{differs}");
    let spoils: [fn(&mut RecordedCycle); 3] = [
        |cycle| cycle.playing = false,
        |cycle| cycle.force.sequence += 1,
        |cycle| cycle.force.flags = 0,
    ];
    for spoil in spoils {
        let mut spoiled = recording.clone();
        spoil(&mut spoiled.cycles[699]);
        let differs = with_table(3.2, |table| spoiled.replay(table)).unwrap_err();
        assert!(differs.to_string().starts_with("cycle 699: "), "{differs}");
    }
}

// Verifies: HID-056.
#[test]
fn cycles_that_a_session_would_not_have_played_are_not_the_same() {
    let mut forged = recorded();
    for cycle in &mut forged.cycles[600..] {
        cycle.position.as_mut().unwrap().status = crate::hid::status::FAULT;
        cycle.force.normal = 30_000;
    }
    let replayed = with_table(3.2, |table| forged.replay(table));
    assert!(
        matches!(replayed, Err(RecordingError::Differs { cycle: 600, .. })),
        "{replayed:?}"
    );
    // The forces of a fault at 600 as this program releases them, and then 15 N for ever.
    let mut after = forged.clone();
    let limits = after.limits;
    let released = with_table(3.2, |table| {
        let device = Recorded {
            recording: &forged,
            cycle: 0,
            given: false,
        };
        let mut released = Vec::new();
        Session::begin(device, table, limits)
            .unwrap()
            .run(|cycle, _| {
                released.push(RecordedCycle::from(cycle));
                true
            });
        released
    });
    let ends = released.len();
    assert!(ends > 600 && ends < 620);
    after.cycles[..ends].copy_from_slice(&released);
    let replayed = with_table(3.2, |table| after.replay(table)).unwrap_err();
    assert_eq!(
        replayed.to_string(),
        format!(
            "700 cycles, but these positions end the session after {ends}: stopped by a fault: {}",
            crate::servo::Fault::Device
        )
    );
    after.cycles.truncate(ends);
    assert_eq!(with_table(3.2, |table| after.replay(table)), Ok(ends));
}

// Verifies: HID-051.
#[test]
fn what_is_no_recording_is_refused_with_its_line() {
    let good = recorded().to_text();
    let lines: Vec<&str> = good.lines().take(6).collect();
    let with = |at: usize, line: &str| {
        let mut changed = lines.clone();
        changed[at] = line;
        Recording::parse(&changed.join("\n"))
            .unwrap_err()
            .to_string()
    };
    assert!(with(0, "palpate-session 2").starts_with("line 1: \"palpate-session 2\", expected"));
    assert!(with(1, "capabilities 03").starts_with("line 2: "));
    assert!(with(2, "limits 7fc00000 3d4ccccd 3e4ccccd 10").starts_with("line 3: ")); // NaN
    let position = "01d8dce803000001000000";
    let force = "0200000000010001";
    for wrong in [
        String::new(),
        format!("1 2 {position} {force}"),
        format!("1 2 {position} {force} 2"),
        format!("1 2 {position} {force} 0 0"),
        format!("-1 2 {position} {force} 0"),
        format!("1 2 {position}00 {force} 0"),
        format!("1 2 0g {force} 0"),
        format!("1 2 é {force} 0"),
        format!("1 2 {force} {position} 0"),
        format!("1 2 {position} - 0"),
    ] {
        assert!(with(4, &wrong).starts_with("line 5: "), "{wrong}");
    }
    assert!(
        Recording::parse("")
            .unwrap_err()
            .to_string()
            .starts_with("line 1: \"\"")
    );
    assert!(
        Recording::parse(HEADER)
            .unwrap_err()
            .to_string()
            .starts_with("line 2: \"\"")
    );
}
