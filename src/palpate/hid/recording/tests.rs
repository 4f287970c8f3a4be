//! Recordings of the simulated device.

use super::*;
use crate::hid::simulated::PAPER;
use crate::hid::tests::{MS, limits, probing, recorded, table};
use palpate_asserts::{assert_cases, assert_error, changed};

/// The cycles of a session on this device, at most so many.
fn cycles(device: impl HapticDevice, most: usize) -> Vec<RecordedCycle> {
    let cycles = recorded(device, most);
    cycles.iter().map(RecordedCycle::from).collect()
}

/// Half a second of probing, with a deadman held from 0.1 s on.
fn recording() -> Recording {
    Recording {
        capabilities: PAPER,
        limits: limits(),
        cycles: cycles(probing(500 * MS, vec![]), 700),
    }
}

// Verifies: HID-050.
#[test]
fn a_recording_is_read_back_as_it_was() {
    let recording = recording();
    assert!(recording.cycles[600].playing && recording.cycles[600].force.normal > 1000);
    let again = |recording: &Recording| {
        let read = Recording::parse(&recording.to_text());
        assert_eq!(read.as_ref(), Ok(recording));
    };
    again(&recording);
    let mut gap = recording;
    gap.cycles[3].position = None;
    again(&gap);
    // Limits whose decimals are long, to the bit.
    gap.cycles.clear();
    for bits in (0..2000).map(|step| 0x3d4c_cccd + step) {
        gap.limits = Limits::new(2.0, f32::from_bits(bits), 0.2, 10).unwrap();
        again(&gap);
    }
}

// Verifies: HID-050.
#[test]
fn a_recorded_cycle_has_the_times_of_its_receipt_and_its_write() {
    let [woke, received, computed, written] = [1, 2, 3, 4].map(Duration::from_micros);
    let recorded = RecordedCycle::from(&Cycle {
        woke,
        received,
        computed,
        written,
        ..Cycle::default()
    });
    assert_eq!((recorded.received_us, recorded.written_us), (2, 4));
}

// Verifies: HID-052.
#[test]
fn a_recorded_report_is_read_once_in_its_cycle() {
    let recording = recording();
    let mut device = Recorded::new(&recording);
    device.cycle = 5;
    let report = recording.cycles[5].position.unwrap();
    let mut read = || device.read(Duration::ZERO).unwrap();
    assert_eq!(read(), Received::Report(report));
    assert_eq!(read(), Received::Nothing);
}

// Verifies: HID-052.
#[test]
fn a_recording_plays_again_to_the_bit_and_tells_where_it_differs() {
    let recording = recording();
    assert_eq!(recording.replay(table(3.2)), Ok(700));
    let differs = recording.replay(table(3.3)).unwrap_err();
    assert!(differs.found.starts_with("cycle 2"), "{differs}");
    // A session that did not begin to play shows nothing of the table.
    let begins = recording.cycles.iter().position(|cycle| cycle.playing);
    for cycles in [0, begins.unwrap()] {
        let mut short = recording.clone();
        short.cycles.truncate(cycles);
        let nothing = format!("{cycles} cycles, of which none played the table");
        let refused = short.replay(table(3.2)).unwrap_err();
        assert_eq!(refused.found, nothing);
    }
    type Spoil = fn(&mut RecordedCycle);
    let spoils: [(usize, Spoil); 4] = [
        (650, |cycle| cycle.force.lateral += 1),
        (699, |cycle| cycle.playing = false),
        (699, |cycle| cycle.force.sequence += 1),
        (699, |cycle| cycle.force.flags = 0),
    ];
    for (at, spoil) in spoils {
        let mut spoiled = recording.clone();
        spoil(&mut spoiled.cycles[at]);
        let differs = spoiled.replay(table(3.2)).unwrap_err();
        let place = format!("cycle {at}: ");
        assert!(differs.found.starts_with(&place), "{differs}");
    }
}

// Verifies: HID-052.
#[test]
fn cycles_that_a_session_would_not_have_played_are_not_the_same() {
    let mut forged = recording();
    for cycle in &mut forged.cycles[600..] {
        cycle.position.as_mut().unwrap().status = crate::hid::status::FAULT;
        cycle.force.normal = 30_000;
    }
    let replayed = forged.replay(table(3.2)).unwrap_err();
    assert!(replayed.found.starts_with("cycle 600: "), "{replayed}");
    // The forces of a fault at 600 as this program releases them, and then 15 N for ever.
    let released = cycles(Recorded::new(&forged), usize::MAX);
    let ends = released.len();
    assert!(ends > 600 && ends < 620);
    let mut after = forged.clone();
    after.cycles[..ends].copy_from_slice(&released);
    let early = format!(
        "700 cycles, but these positions end the session after {ends}: stopped by a fault: {}",
        crate::servo::Fault::Device
    );
    assert_eq!(after.replay(table(3.2)), Err(Refusal::state(early, "")));
    after.cycles.truncate(ends);
    assert_eq!(after.replay(table(3.2)), Ok(ends));
}

// Verifies: HID-050.
#[test]
fn what_is_no_recording_is_refused_with_its_line() {
    let good = recording().to_text();
    let lines: Vec<&str> = good.lines().take(6).collect();
    assert_cases("refused/recording.txt", "changes", |case| {
        let (number, change) = case.split_once(": ").unwrap();
        let at = number.parse::<usize>().unwrap() - 1;
        let wrong = changed(lines[at], &change.replace("CYCLE", lines[at]));
        let mut lines = lines.clone();
        lines[at] = &wrong;
        let refused = Recording::parse(&lines.join("\n")).unwrap_err();
        refused.to_string()
    });
    assert_error(Recording::parse(""), "line 1: \"\"; give a recording[..]");
}

// Verifies: HID-050, HID-052.
#[test]
fn a_recording_may_have_more_cycles_than_16_bits_count() {
    let mut recording = recording();
    recording.cycles = cycles(probing(500 * MS, vec![]), 65_540);
    let last = recording.cycles.len() - 1;
    assert_eq!(last, 65_539);
    let text = recording.to_text();
    assert_eq!(Recording::parse(&text).as_ref(), Ok(&recording));
    assert_eq!(recording.replay(table(3.2)), Ok(65_540));
    // What differs is named by its cycle.
    recording.cycles[last].force.lateral ^= 1;
    let error = recording.replay(table(3.2)).unwrap_err().to_string();
    assert!(error.starts_with("cycle 65539: "), "{error}");
}
