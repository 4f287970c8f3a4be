//! Reports of the device: decoded, encoded, and between counts and newtons.

use core::ops::Bound::Included;

use bolero::generator::bolero_generator;
use bolero::{Driver, TypeGenerator};
use palpate_core::force::Force;
use palpate_core::hid::{
    Capabilities, Control, ForceReport, InvalidReport, PositionReport, Units, count, uses_page,
};
use palpate_core::servo::Command;

use crate::cases::{Count, any_force};

/// Any bytes, 0 to 64 of them.
#[derive(Debug, Clone)]
pub struct Bytes {
    pub bytes: [u8; 64],
    pub length: usize,
}

impl TypeGenerator for Bytes {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        const LENGTHS: [usize; 4] = [
            PositionReport::LENGTH,
            ForceReport::LENGTH,
            Capabilities::LENGTH,
            Control::LENGTH,
        ];
        let mut bytes = [0; 64];
        for byte in &mut bytes {
            *byte = driver.produce()?;
        }
        let length = match driver.gen_variant(4, 0)? {
            0 => driver.gen_usize(Included(&0), Included(&64))?,
            _ => LENGTHS[driver.gen_variant(4, 0)?],
        };
        // Numbers of reports, and values of a control report.
        if driver.gen_variant(4, 0)? != 0 {
            bytes[0] = driver.gen_u8(Included(&0), Included(&5))?;
            bytes[1] %= 4;
        }
        Some(Bytes { bytes, length })
    }
}

/// Decoding is total, accepts what it should, with a first value of `largest` at the most, names what is
/// wrong, and is undone by encoding.
macro_rules! decoding {
    ($name:ident, $report:ident, $largest:expr) => {
        // Verifies: HID-002, HID-006.
        #[test]
        #[cfg_attr(kani, kani::proof, kani::unwind(66), kani::solver(cadical))]
        fn $name() {
            harness!(Bytes, |case| {
                let bytes = &case.bytes[..case.length];
                let valid = |value: u8| (0..=$largest).contains(&value);
                let decoded = $report::decode(bytes);
                let number = case.bytes[0];
                let right_length = case.length == $report::LENGTH;
                let right_number = number == $report::NUMBER;
                match decoded {
                    Ok(report) => {
                        assert!(right_length && right_number && valid(case.bytes[1]));
                        assert!(report.encode() == bytes[..]);
                    }
                    Err(InvalidReport::Length { found, expected }) => {
                        assert!(found == case.length && expected == $report::LENGTH);
                        assert!(!right_length);
                    }
                    Err(InvalidReport::Number { found, expected }) => {
                        assert!(found == number && expected == $report::NUMBER);
                        assert!(right_length && !right_number);
                    }
                    Err(InvalidReport::Value { found }) => {
                        assert!(found == case.bytes[1] && !valid(found));
                        assert!(right_length && right_number);
                    }
                }
                reached! {
                    "a report": decoded.is_ok(),
                    "another length": !right_length && right_number,
                    "another number": right_length && !right_number,
                }
            });
        }
    };
}

decoding!(decoding_a_position_report_is_total, PositionReport, 255);
decoding!(decoding_a_force_report_is_total, ForceReport, 255);
decoding!(decoding_capabilities_is_total, Capabilities, 255);
decoding!(decoding_control_is_total, Control, 2);

/// The numbers of a report.
#[derive(Debug, Clone, bolero_generator::TypeGenerator)]
struct Fields {
    signed: [i16; 2],
    bytes: [u8; 2],
    words: [u16; 8],
    #[generator(0..3)]
    control: usize,
}

// Verifies: HID-006.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(18), kani::solver(cadical))]
fn reports_survive_encoding_and_decoding() {
    harness!(Fields, |fields| {
        let position = PositionReport {
            lateral: fields.signed[0],
            normal: fields.signed[1],
            buttons: fields.bytes[0],
            status: fields.bytes[1],
            sequence: fields.words[0],
            force_sequence: fields.words[1],
        };
        assert!(PositionReport::decode(&position.encode()) == Ok(position));
        let force = ForceReport {
            lateral: fields.signed[0],
            normal: fields.signed[1],
            sequence: fields.words[0],
            flags: fields.bytes[0],
        };
        assert!(ForceReport::decode(&force.encode()) == Ok(force));
        let capabilities = capabilities(&fields.words);
        assert!(Capabilities::decode(&capabilities.encode()) == Ok(capabilities));
        let control = [Control::Stop, Control::Enable, Control::ClearFault][fields.control];
        assert!(Control::decode(&control.encode()) == Ok(control));
        reached! {
            "negative counts": fields.signed[0] < 0 && fields.signed[1] < 0,
            "the last control": fields.control == 2,
        }
    });
}

fn capabilities(words: &[u16; 8]) -> Capabilities {
    Capabilities {
        version: words[0],
        position_unit_nm: words[1],
        force_unit_un: words[2],
        largest_force_mn: words[3],
        period_us: words[4],
        watchdog_ms: words[5],
        damping_mn_s_per_m: words[6],
        friction_mn: words[7],
    }
}

// Verifies: HID-010, HID-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn a_count_is_the_nearest_whole_number() {
    harness!(Count, |case| {
        let value = case.0;
        let found = count(value);
        let within = value.abs() <= 32767.0;
        let mut on_a_half = false;
        if within {
            // Exact in f64.
            let off = (f64::from(value) - f64::from(found)).abs();
            on_a_half = off == 0.5;
            assert!(off < 0.5 || (on_a_half && found & 1 == 0));
        } else if value > 0.0 {
            assert!(found == 32767);
        } else if value < 0.0 {
            assert!(found == -32767);
        } else {
            assert!(found == 0);
        }
        reached! {
            "within": within,
            "halfway": on_a_half,
            "above": value > 32767.0,
            "below": value < -32767.0,
            "a NaN": value.is_nan(),
        }
    });
}

/// A device and one report each way.
#[derive(Debug, Clone)]
struct Exchange {
    words: [u16; 8],
    report: [i16; 2],
    bits: [u8; 2],
    force: Force<f32>,
}

impl TypeGenerator for Exchange {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let mut words: [u16; 8] = driver.produce()?;
        if driver.gen_variant(4, 0)? != 0 {
            words[0] = 1;
        }
        if driver.gen_variant(8, 0)? == 0 {
            words[1 + driver.gen_variant(2, 0)?] = 0;
        }
        Some(Exchange {
            words,
            report: driver.produce()?,
            bits: driver.produce()?,
            force: any_force(driver)?,
        })
    }
}

// Verifies: HID-008, HID-010, HID-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(10), kani::solver(cadical))]
fn a_device_gives_finite_samples_and_takes_any_force() {
    harness!(Exchange, |case| {
        let capabilities = capabilities(&case.words);
        let [version, position, force, largest, ..] = case.words;
        // A report holds up to 32767 counts of µN, and the largest force is in mN.
        let held = u32::from(force) * 32_767 >= u32::from(largest) * 1000;
        let known = version == 1 && position != 0 && force != 0 && held;
        let units = Units::new(&capabilities);
        assert!(units.is_ok() == known);
        if let Ok(units) = units {
            let report = PositionReport {
                lateral: case.report[0],
                normal: case.report[1],
                buttons: case.bits[0],
                status: case.bits[1],
                sequence: case.words[3],
                force_sequence: case.words[4],
            };
            let sample = units.sample(&report);
            // 32768 counts of 65535 nm.
            assert!(sample.depth.abs() <= 2.148 && sample.lateral.abs() <= 2.148);
            assert!((sample.depth < 0.0) == (report.normal > 0));
            assert!((sample.lateral < 0.0) == (report.lateral < 0));
            assert!(sample.deadman == (report.buttons % 2 == 1));
            assert!(sample.device_fault == (report.status & 3 != 0));
            assert!(sample.sequence == report.sequence);

            let command = Command {
                force: case.force,
                playing: false,
            };
            let sent = units.report(&command, case.words[5]);
            assert!(sent.sequence == case.words[5] && sent.flags == ForceReport::PLAY);
            assert!(sent.normal != i16::MIN && sent.lateral != i16::MIN);
            let up = case.force.normal > 0.0;
            assert!(sent.normal == 0 || (sent.normal > 0) == up);
        }
        reached! {
            "a device that is known": known,
            "no unit of force": case.words[0] == 1 && case.words[2] == 0,
            "another version": case.words[0] != 1,
            "a force beyond the counts": known && case.force.normal > 32767.0,
        }
    });
}

/// An item before a descriptor.
#[derive(Debug, Clone)]
struct Item {
    /// Its first byte: type and length of a short item.
    prefix: u8,
    /// Data of a short item; length, tag and data of a long one.
    data: [u8; 4],
    /// Bytes after the item, of which `length` count.
    rest: [u8; 2],
    length: usize,
}

impl TypeGenerator for Item {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        const PREFIXES: [u8; 4] = [0x05, 0x06, 0x07, 0xFE];
        let mut item = Item {
            prefix: driver.produce()?,
            data: driver.produce()?,
            rest: driver.produce()?,
            length: driver.gen_usize(Included(&0), Included(&2))?,
        };
        // Items that select a page, or long ones; the page 0x0F; the end of a long item.
        if driver.gen_variant(2, 0)? == 0 {
            item.prefix = PREFIXES[driver.gen_variant(4, 0)?];
            item.data[0] = [0x0F, 2, 1, 0][driver.gen_variant(4, 0)?];
            item.data[1] %= 2;
            item.data[2] %= 2;
            item.data[3] %= 2;
        }
        if driver.gen_variant(2, 0)? == 0 {
            item.rest[0] = 0x05;
            item.rest[1] = 0x0F;
        }
        Some(item)
    }
}

impl Item {
    /// Room for the item and two bytes behind it, and the size of its data.
    fn bytes(&self) -> ([u8; 7], usize) {
        let mut bytes = [0; 7];
        bytes[0] = self.prefix;
        bytes[1..5].copy_from_slice(&self.data);
        // A long item has its length in the second byte; here at most two bytes of data.
        if self.prefix == 0xFE {
            bytes[1] %= 3;
            return (bytes, 2 + usize::from(bytes[1]));
        }
        (bytes, [0, 1, 2, 4][usize::from(self.prefix % 4)])
    }
}

// Verifies: HID-031.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(8), kani::solver(cadical))]
fn an_item_that_is_cut_off_selects_nothing() {
    harness!(Item, |item| {
        let (bytes, size) = item.bytes();
        assert!(!uses_page(&bytes[..size], 0x0F));
        reached! {
            "a page that would be selected": item.prefix == 0x05 && item.data[0] == 0x0F,
            "a long item": item.prefix == 0xFE,
        }
    });
}

// Verifies: HID-031.
#[test]
#[cfg_attr(kani, kani::proof, kani::unwind(9), kani::solver(cadical))]
fn the_first_item_of_a_descriptor_decides_or_the_rest_does() {
    harness!(Item, |item| {
        let (mut bytes, size) = item.bytes();
        let long = item.prefix == 0xFE;
        bytes[1 + size..3 + size].copy_from_slice(&item.rest);
        let end = 1 + size + item.length;
        // Of a short item's data, the first byte is the least.
        let page = (0..size).fold(0, |page, byte| {
            page | u32::from(bytes[1 + byte]) << (8 * byte)
        });
        let selects = !long && size > 0 && item.prefix / 4 == 1 && page == 0x0F;
        let rest = uses_page(&item.rest[..item.length], 0x0F);
        assert!(uses_page(&bytes[..end], 0x0F) == (selects || rest));
        reached! {
            "the page": selects && !rest,
            "the page in the rest": rest && !selects,
            "a long item": long,
            "a selected page of another number": !selects && !long && item.prefix / 4 == 1 && size > 0,
        }
    });
}
