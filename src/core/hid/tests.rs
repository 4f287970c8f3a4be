//! The reports byte by byte. That no bytes are mistaken for another report is checked in `proofs/`.

use super::*;
use crate::force::Force;
use crate::servo::Command;

/// The descriptor in hexadecimal, as a device's firmware has it.
const DESCRIPTOR_TEXT: &str = "06 00 FF 09 01 A1 01 85 01 09 10 09 11 16 01 80 26 FF 7F 75 10 95 02 81 02 \
    09 12 09 13 15 00 26 FF 00 75 08 95 02 81 02 09 14 09 15 15 00 27 FF FF 00 00 75 10 95 02 81 02 85 02 \
    09 20 09 21 16 01 80 26 FF 7F 75 10 95 02 91 02 09 22 15 00 27 FF FF 00 00 75 10 95 01 91 02 09 23 15 \
    00 26 FF 00 75 08 95 01 91 02 85 03 09 30 15 00 27 FF FF 00 00 75 10 95 08 B1 03 85 04 09 40 15 00 26 \
    FF 00 75 08 95 01 B1 02 C0";

// Verifies: HID-001.
#[test]
fn the_descriptor_is_that_of_the_vendor_profile() {
    let bytes = DESCRIPTOR_TEXT.split_whitespace();
    let bytes = bytes.map(|text| u8::from_str_radix(text, 16).unwrap());
    assert!(bytes.eq(DESCRIPTOR));
}

// Verifies: HID-002, HID-006.
#[test]
fn a_report_has_its_bytes_in_order() {
    let position = PositionReport {
        lateral: 0x0102,
        normal: -2,
        buttons: 0x05,
        status: 0x06,
        sequence: 0x0708,
        force_sequence: 0x090A,
    };
    let bytes = [1, 0x02, 0x01, 0xFE, 0xFF, 0x05, 0x06, 0x08, 0x07, 0x0A, 9];
    assert_eq!(position.encode(), bytes);
    assert_eq!(PositionReport::decode(&bytes), Ok(position));
    let force = ForceReport {
        lateral: -32767,
        normal: 0x0304,
        sequence: 0x0506,
        flags: 7,
    };
    let bytes = [2, 0x01, 0x80, 0x04, 0x03, 0x06, 0x05, 7];
    assert_eq!(force.encode(), bytes);
    assert_eq!(ForceReport::decode(&bytes), Ok(force));
    let words = [1, 1000, 500, 8000, 1000, 15, 600, 140].map(u16::to_le_bytes);
    let bytes = [&[3], words.as_flattened()].concat();
    assert_eq!(PAPER.encode(), bytes[..]);
    assert_eq!(Capabilities::decode(&bytes), Ok(PAPER));
}

// Verifies: HID-002, HID-006.
#[test]
fn control_has_three_values() {
    let controls = [Control::Stop, Control::Enable, Control::ClearFault];
    for (value, control) in (0..).zip(controls) {
        assert_eq!(control.encode(), [4, value]);
        assert_eq!(Control::decode(&[4, value]), Ok(control));
    }
    let refused = Err(InvalidReport::Value { found: 3 });
    assert_eq!(Control::decode(&[4, 3]), refused);
}

// Verifies: HID-006.
#[test]
fn another_length_or_number_is_refused() {
    let good = PAPER.encode();
    let (found, expected) = (2, 3);
    let number = InvalidReport::Number { found, expected };
    let other = [&[found], &good[1..]].concat();
    assert_eq!(Capabilities::decode(&other), Err(number));
    for bytes in [&[][..], &good[..16], &[3; 34]] {
        let (found, expected) = (bytes.len(), 17);
        let length = InvalidReport::Length { found, expected };
        assert_eq!(Capabilities::decode(bytes), Err(length));
    }
}

// Verifies: HID-008.
#[test]
fn a_device_without_units_is_refused() {
    type Change = fn(&mut Capabilities);
    let changes: [(Change, &str); 3] = [
        (|c| c.version = 2, " speaks version 2 of the profile"),
        (|c| c.position_unit_nm = 0, "'s position unit is 0 nm"),
        (|c| c.force_unit_un = 0, "'s force unit is 0 µN"),
    ];
    for ((change, found), least) in
        changes
            .into_iter()
            .zip(["speak version", "be at least", "be at least"])
    {
        let mut device = PAPER;
        change(&mut device);
        let refused = format!("{}", Units::new(&device).unwrap_err());
        let expected = format!("the device{found}, but must {least} 1");
        assert_eq!(refused, expected);
    }
}

// Verifies: HID-010.
#[test]
fn counts_are_micrometres_and_half_millinewtons_here() {
    let units = Units::new(&PAPER).unwrap();
    let report = PositionReport {
        lateral: -12_000,
        normal: -4_000,
        buttons: button::DEADMAN,
        sequence: 9,
        ..PositionReport::default()
    };
    let sample = units.sample(&report);
    // The constant 1e-9 and two products are rounded: at most 3 · 2⁻²⁴ of the value.
    let near = |found: f32, expected: f32| (found / expected - 1.0).abs() < 1.8e-7;
    assert!(near(sample.depth, 0.004), "{}", sample.depth);
    assert!(near(sample.lateral, -0.012), "{}", sample.lateral);
    let told = (sample.sequence, sample.deadman, sample.device_fault);
    assert_eq!(told, (9, true, false));
    for status in [status::FAULT, status::WATCHDOG] {
        let report = PositionReport { status, ..report };
        assert!(units.sample(&report).device_fault);
    }
    let (force, playing) = (Force::new(-0.1, 1.5), true);
    let sent = ForceReport {
        lateral: -200,
        normal: 3000,
        sequence: 77,
        flags: ForceReport::PLAY,
    };
    assert_eq!(units.report(&Command { force, playing }, 77), sent);
}

// Verifies: HID-010, HID-011.
#[test]
fn a_count_is_the_nearest_whole_number_within_its_range() {
    let (infinity, nan) = (f32::INFINITY, f32::NAN);
    let halves = [0.5, 1.5, -0.5, -1.5, 2.4999998];
    assert_eq!(halves.map(count), [0, 2, 0, -2, 2]);
    let large = [-32766.7, 32767.4, 1e9, -infinity, nan];
    assert_eq!(large.map(count), [-32767, 32767, 32767, -32767, 0]);
}
