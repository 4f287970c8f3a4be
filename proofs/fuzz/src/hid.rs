//! Reports of a device, alone and in a pipe, and recordings of a session.

use std::io::Write;
use std::time::Duration;

use palpate::force::Force;
use palpate::force_map::{ForceTable, Matrix};
use palpate::hid::pipe::PipeDevice;
use palpate::hid::{
    Capabilities, Control, ForceReport, HapticDevice, InvalidReport, PositionReport, Received,
    Recording, Units, count,
};
use palpate::servo::LoadedTable;

use crate::message::{check_message, check_quoting};
use crate::{Outcome, judged};

/// Bytes are a report if, and only if, length and number are its own; what is decoded encodes to
/// the same bytes, and a refusal tells what was found.
pub fn hid_report(bytes: &[u8]) -> Outcome {
    let mut outcome = Outcome::Refused;
    macro_rules! check {
        ($report:ident) => {
            match $report::decode(bytes) {
                Ok(report) => {
                    assert_eq!(report.encode(), bytes);
                    outcome = Outcome::Accepted;
                }
                Err(error) => check_invalid(error, $report::NUMBER, $report::LENGTH, bytes),
            }
        };
    }
    check!(PositionReport);
    check!(ForceReport);
    check!(Capabilities);
    match Control::decode(bytes) {
        Ok(control) => {
            assert_eq!(control.encode(), bytes);
            outcome = Outcome::Accepted;
        }
        Err(InvalidReport::Value { found }) => {
            assert!(bytes == [Control::NUMBER, found] && found > 2)
        }
        Err(error) => check_invalid(error, Control::NUMBER, Control::LENGTH, bytes),
    }
    if let Ok(capabilities) = Capabilities::decode(bytes) {
        check_units(&capabilities, bytes);
    }
    outcome
}

/// Checks that another length or number was the reason, and is told.
fn check_invalid(error: InvalidReport, number: u8, length: usize, bytes: &[u8]) {
    check_message(&error.to_string());
    match error {
        InvalidReport::Length { found, expected } => {
            assert_eq!((found, expected), (bytes.len(), length));
            assert_ne!(found, length);
        }
        InvalidReport::Number { found, expected } => {
            assert_eq!((found, expected, bytes.len()), (bytes[0], number, length));
            assert_ne!(found, number);
        }
        InvalidReport::Value { .. } => panic!("{error}"),
    }
}

/// Units are refused or make finite numbers of every report.
fn check_units(capabilities: &Capabilities, bytes: &[u8]) {
    let has_meaning = capabilities.version == 1
        && capabilities.position_unit_nm != 0
        && capabilities.force_unit_un != 0
        && u32::from(capabilities.force_unit_un) * 32_767
            >= u32::from(capabilities.largest_force_mn) * 1000;
    let units = Units::new(capabilities);
    assert_eq!(units.is_ok(), has_meaning);
    let units = match units {
        Ok(units) => units,
        Err(error) => return check_message(&error.to_string()),
    };
    let word = |at: usize| i16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let sample = units.sample(&PositionReport {
        lateral: word(13),
        normal: word(15),
        buttons: bytes[9],
        status: bytes[10],
        sequence: 0,
        force_sequence: 0,
    });
    assert!(sample.depth.is_finite() && sample.lateral.is_finite());
    let value = f32::from_le_bytes([bytes[11], bytes[12], bytes[13], bytes[14]]);
    assert!(count(value).unsigned_abs() <= 32767);
}

/// A pipe brings the reports that stand in its bytes one after the other, and then tells how it ended. More than 4,096 bytes, which a pipe
/// may not hold, are not tried.
pub fn pipe_reports(bytes: &[u8]) -> Outcome {
    const FIRST: usize = Capabilities::LENGTH;
    if bytes.len() > 4096 {
        return Outcome::Refused;
    }
    let (input, mut bridge) = std::io::pipe().expect("a pipe");
    bridge.write_all(bytes).expect("room for 4096 bytes");
    drop(bridge);
    let whole = bytes
        .get(..FIRST)
        .and_then(|first| Capabilities::decode(first).ok());
    let mut device = match PipeDevice::open(input, Vec::new()) {
        Ok(device) => device,
        Err(error) => {
            check_message(&error.to_string());
            assert_eq!(whole, None);
            return Outcome::Refused;
        }
    };
    assert_eq!(device.capabilities().ok(), whole);
    let reports = bytes[FIRST..].chunks(PositionReport::LENGTH);
    let reports = reports.map_while(|bytes| PositionReport::decode(bytes).ok());
    let expected: Vec<_> = reports.map(Received::Report).collect();
    let mut read = || device.read(Duration::ZERO);
    let found: Vec<_> = std::iter::from_fn(|| read().ok()).collect();
    assert_eq!(found, expected);
    check_message(&read().expect_err("an end").to_string());
    Outcome::Accepted
}

/// An accepted recording is the same when it is written and read again, and plays again or tells
/// which cycle differs; a refusal names the line and quotes its beginning.
pub fn recording(text: &str) -> Outcome {
    let accepted = |recording: Recording| {
        let written = recording.to_text();
        let again = Recording::parse(&written).expect("what was written can be read");
        assert_eq!((&again, again.to_text()), (&recording, written));
        check_replay(&recording);
    };
    judged(Recording::parse(text), accepted, |refusal| {
        assert_eq!(refusal.found, check_quoting(&refusal, text));
    })
}

fn check_replay(recording: &Recording) {
    let matrix = |forces: [f64; 4]| Matrix::new(2, forces.to_vec()).expect("two columns");
    let [lateral, normal] = [[0.0, 0.0, 0.1, -0.1], [0.0, 0.0, 1.5, 1.5]].map(matrix);
    let map = ForceTable::new(
        vec![0.0, 0.004],
        vec![-0.01, 0.01],
        Force { lateral, normal },
    );
    let loaded = LoadedTable::new(&map.expect("a map")).expect("a table");
    match recording.replay(loaded.table()) {
        Ok(cycles) => assert_eq!(cycles, recording.cycles.len()),
        Err(refusal) => check_message(&refusal.to_string()),
    }
}
