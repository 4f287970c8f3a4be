//! Recordings of the simulated device.

use super::*;
use crate::hid::simulated::PAPER;
use crate::hid::tests::{limits, probing, with_table};

/// Half a second of probing, with a deadman held from 0.1 s on.
fn recorded() -> Recording {
    let device = probing(Duration::from_millis(500), vec![]);
    let mut cycles = Vec::new();
    with_table(3.2, |table| {
        let mut session = Session::begin(device, table, limits()).unwrap();
        session.run(|cycle, _| {
            cycles.push(RecordedCycle::from(cycle));
            cycles.len() < 700
        })
    });
    Recording {
        capabilities: PAPER,
        limits: limits(),
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
    assert_eq!(Recording::parse(&gap.to_text()), Ok(gap.clone()));
    // Limits whose decimals are long, to the bit.
    for bits in (0..2000).map(|step| 0x3d4c_cccd + step) {
        gap.cycles.clear();
        gap.limits = Limits::new(2.0, f32::from_bits(bits), 0.2, 10).unwrap();
        assert_eq!(Recording::parse(&gap.to_text()), Ok(gap.clone()));
    }
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
    assert!(differs.found.starts_with("cycle 2"), "{differs}");
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
    let replayed = with_table(3.2, |table| forged.replay(table)).unwrap_err();
    assert!(replayed.found.starts_with("cycle 600: "), "{replayed}");
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
    let other = lines[0].replace("palpate-session 2", "palpate-session 3");
    let refused = with(0, &other);
    assert!(refused.starts_with("line 1: \"{\\\"format\\\":\\\"palpate-session 3"));
    assert!(
        refused.contains("unknown variant `palpate-session 3`"),
        "{refused}"
    );
    for (from, to) in [
        ("\"force_n\":2.0", "\"force_n\":NaN"),
        ("\"force_n\":2.0", "\"force_n\":1e39"),
        ("\"force_n\":2.0", "\"force_n\":-2.0"),
        ("\"version\":1,", ""),
        ("\"version\":1,", "\"version\":65536,"),
        ("\"version\":1,", "\"version\":1,\"version\":1,"),
        ("\"version\":1,", "\"version\":1,\"more\":1,"),
    ] {
        let wrong = lines[0].replace(from, to);
        assert_ne!(wrong, lines[0], "{from}");
        assert!(with(0, &wrong).starts_with("line 1: "), "{wrong}");
    }
    let cycle = lines[4];
    for (from, to) in [
        (cycle, ""),
        (cycle, "[]"),
        (cycle, &cycle[..cycle.len() - 1]),
        (cycle, &format!("{cycle}{cycle}")),
        (",\"playing\":false", ""),
        ("\"playing\":false", "\"playing\":0"),
        ("\"playing\":false", "\"playing\":false,\"played\":false"),
        ("\"received_us\":", "\"received_us\":-"),
        ("\"flags\":1", "\"flags\":256"),
        ("\"buttons\":0,", ""),
        ("\"force\":{", "\"force\":{\"version\":1,"),
    ] {
        let wrong = cycle.replace(from, to);
        assert_ne!(wrong, cycle, "{from}");
        assert!(with(4, &wrong).starts_with("line 5: "), "{wrong}");
    }
    let refused = Recording::parse("").unwrap_err().to_string();
    assert!(refused.starts_with("line 1: \"\", expected"), "{refused}");
}
