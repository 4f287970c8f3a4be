//! The reports of the vendor profile, and between counts and metres, newtons.
//!
//! Implements: CLB-010.

pub use palpate_core::hid::{Capabilities, Control, ForceReport, PositionReport};
use palpate_core::hid::{DESCRIPTOR, InvalidReport, Units};
use palpate_core::servo::Command;

use crate::memory::{bytes, check_apart, give, list, list_mut, read};
use crate::{Error, ServoCommand, ServoSample};

/// The report descriptor of the profile, `PALPATE_LENGTH_DESCRIPTOR` bytes that never change.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_report_descriptor() -> *const u8 {
    DESCRIPTOR.as_ptr()
}

/// Lengths in bytes, of a report with its number.
#[repr(u32)]
#[derive(Debug, Clone, Copy)]
pub enum Length {
    /// Of the report descriptor.
    Descriptor = 136,
    /// Of input report 1.
    PositionReport = 11,
    /// Of output report 2.
    ForceReport = 8,
    /// Of feature report 3.
    Capabilities = 17,
    /// Of feature report 4.
    Control = 2,
}

const _: () = assert!(
    DESCRIPTOR.len() == Length::Descriptor as usize
        && PositionReport::LENGTH == Length::PositionReport as usize
        && ForceReport::LENGTH == Length::ForceReport as usize
        && Capabilities::LENGTH == Length::Capabilities as usize
        && Control::LENGTH == Length::Control as usize
);

/// Decodes `length` bytes at `start`, which begin with the number of the report.
///
/// # Safety
/// As the crate says.
unsafe fn decode<T>(
    start: *const u8,
    length: usize,
    decode: impl FnOnce(&[u8]) -> Result<T, InvalidReport>,
    report: *mut T,
) -> Error {
    let found = || Ok(decode(unsafe { list(start, length) }?)?);
    unsafe { give(report, found) }
}

/// Writes an encoded report to `length` bytes at `start`.
///
/// # Safety
/// As the crate says.
unsafe fn encode<T: Copy, const LENGTH: usize>(
    report: *const T,
    encode: impl FnOnce(T) -> Result<[u8; LENGTH], Error>,
    start: *mut u8,
    length: usize,
) -> Error {
    let write = || {
        if length != LENGTH {
            return Err(Error::Length);
        }
        check_apart(&[bytes(start, length)], &[bytes(report, 1)])?;
        let encoded = encode(unsafe { read(report) }?)?;
        unsafe { list_mut(start, length) }?.copy_from_slice(&encoded);
        Ok(())
    };
    match write() {
        Ok(()) => Error::Ok,
        Err(error) => error,
    }
}

/// The position report in `length` = 11 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_position_report_decode(
    start: *const u8,
    length: usize,
    report: *mut PositionReport,
) -> Error {
    unsafe { decode(start, length, PositionReport::decode, report) }
}

/// The `length` = 11 bytes of a position report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_position_report_encode(
    report: *const PositionReport,
    start: *mut u8,
    length: usize,
) -> Error {
    unsafe { encode(report, |report| Ok(report.encode()), start, length) }
}

/// The force report in `length` = 8 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_force_report_decode(
    start: *const u8,
    length: usize,
    report: *mut ForceReport,
) -> Error {
    unsafe { decode(start, length, ForceReport::decode, report) }
}

/// The `length` = 8 bytes of a force report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_force_report_encode(
    report: *const ForceReport,
    start: *mut u8,
    length: usize,
) -> Error {
    unsafe { encode(report, |report| Ok(report.encode()), start, length) }
}

/// The capabilities in `length` = 17 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_capabilities_decode(
    start: *const u8,
    length: usize,
    report: *mut Capabilities,
) -> Error {
    unsafe { decode(start, length, Capabilities::decode, report) }
}

/// The `length` = 17 bytes of capabilities.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_capabilities_encode(
    report: *const Capabilities,
    start: *mut u8,
    length: usize,
) -> Error {
    unsafe { encode(report, |report| Ok(report.encode()), start, length) }
}

/// The `PALPATE_CONTROL_…` in the `length` = 2 bytes of a control report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_control_decode(
    start: *const u8,
    length: usize,
    control: *mut u8,
) -> Error {
    let value = |bytes: &[u8]| Control::decode(bytes).map(|control| control.encode()[1]);
    unsafe { decode(start, length, value, control) }
}

/// The `length` = 2 bytes of the control report for a `PALPATE_CONTROL_…`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_control_encode(
    control: u8,
    start: *mut u8,
    length: usize,
) -> Error {
    let bytes = |value| Ok(Control::decode(&[Control::NUMBER, value])?.encode());
    unsafe { encode(&raw const control, bytes, start, length) }
}

/// What a position report says, in metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_sample_of_report(
    device: *const Capabilities,
    report: *const PositionReport,
    sample: *mut ServoSample,
) -> Error {
    let found = || {
        let units = Units::new(&unsafe { read(device) }?)?;
        Ok(units.sample(&unsafe { read(report) }?).into())
    };
    unsafe { give(sample, found) }
}

/// The report with this number that plays a command.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_report_of_command(
    device: *const Capabilities,
    command: *const ServoCommand,
    sequence: u16,
    report: *mut ForceReport,
) -> Error {
    let found = || {
        let units = Units::new(&unsafe { read(device) }?)?;
        let ServoCommand { force, playing, .. } = unsafe { read(command) }?;
        let playing = playing != 0;
        Ok(units.report(&Command { force, playing }, sequence))
    };
    unsafe { give(report, found) }
}
