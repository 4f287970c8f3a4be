//! The reports of the vendor profile, and between counts and metres, newtons.
//!
//! Implements: CLB-010.

use palpate_core::force;
use palpate_core::hid::{self, DESCRIPTOR, Units};
use palpate_core::servo;

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
        && hid::PositionReport::LENGTH == Length::PositionReport as usize
        && hid::ForceReport::LENGTH == Length::ForceReport as usize
        && hid::Capabilities::LENGTH == Length::Capabilities as usize
        && hid::Control::LENGTH == Length::Control as usize
);

/// Input report 1: where the handle is.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PositionReport {
    /// Lateral position, counts.
    pub lateral: i16,
    /// Position along the normal, counts, positive out of the gel.
    pub normal: i16,
    /// Switches: bit 0 is the deadman.
    pub buttons: u8,
    /// State of the device: bit 0 a fault, bit 1 its watchdog.
    pub status: u8,
    /// Number of this report, modulo 65536.
    pub sequence: u16,
    /// Number of the last force report that the device played.
    pub force_sequence: u16,
}

/// Output report 2: what to play.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ForceReport {
    /// Lateral force, counts.
    pub lateral: i16,
    /// Normal force, counts, positive out of the gel.
    pub normal: i16,
    /// Number of this report, modulo 65536.
    pub sequence: u16,
    /// Bit 0: play the force; otherwise the device plays none.
    pub flags: u8,
}

/// Feature report 3: what the device is.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Capabilities {
    /// Version of the profile: 1.
    pub version: u16,
    /// Length of a count of a position, nm.
    pub position_unit_nm: u16,
    /// Force of a count, µN.
    pub force_unit_un: u16,
    /// Largest force of each axis, mN.
    pub largest_force_mn: u16,
    /// Time between two position reports, µs.
    pub period_us: u16,
    /// Time without a force report after which the device drops the force, ms.
    pub watchdog_ms: u16,
    /// Viscous damping of each axis, mN·s/m.
    pub damping_mn_s_per_m: u16,
    /// Coulomb friction of each axis, mN.
    pub friction_mn: u16,
}

/// What control report 4 tells the device.
#[repr(u8)]
#[derive(Debug, Clone, Copy)]
pub enum Control {
    /// Play no force until enabled.
    Stop,
    /// Play the force reports.
    Enable,
    /// Clear the device's own fault.
    ClearFault,
}

/// The same structure here and in the kernel, field by field.
macro_rules! mirror {
    ($name:ident { $($field:ident),* }) => {
        impl From<hid::$name> for $name {
            fn from(report: hid::$name) -> $name {
                $name { $($field: report.$field),* }
            }
        }
        impl From<$name> for hid::$name {
            fn from(report: $name) -> hid::$name {
                hid::$name { $($field: report.$field),* }
            }
        }
    };
}
mirror!(PositionReport {
    lateral,
    normal,
    buttons,
    status,
    sequence,
    force_sequence
});
mirror!(ForceReport {
    lateral,
    normal,
    sequence,
    flags
});
mirror!(Capabilities {
    version,
    position_unit_nm,
    force_unit_un,
    largest_force_mn,
    period_us,
    watchdog_ms,
    damping_mn_s_per_m,
    friction_mn
});

/// Decodes `length` bytes at `start`, which begin with the number of the report.
///
/// # Safety
/// As the crate says.
unsafe fn decode<R, T>(
    start: *const u8,
    length: usize,
    decode: impl FnOnce(&[u8]) -> Result<R, hid::InvalidReport>,
    report: *mut T,
) -> Error
where
    T: From<R>,
{
    let found = || Ok(decode(unsafe { list(start, length) }?)?.into());
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
    unsafe { decode(start, length, hid::PositionReport::decode, report) }
}

/// The `length` = 11 bytes of a position report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_position_report_encode(
    report: *const PositionReport,
    start: *mut u8,
    length: usize,
) -> Error {
    let bytes = |report| Ok(hid::PositionReport::from(report).encode());
    unsafe { encode(report, bytes, start, length) }
}

/// The force report in `length` = 8 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_force_report_decode(
    start: *const u8,
    length: usize,
    report: *mut ForceReport,
) -> Error {
    unsafe { decode(start, length, hid::ForceReport::decode, report) }
}

/// The `length` = 8 bytes of a force report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_force_report_encode(
    report: *const ForceReport,
    start: *mut u8,
    length: usize,
) -> Error {
    let bytes = |report| Ok(hid::ForceReport::from(report).encode());
    unsafe { encode(report, bytes, start, length) }
}

/// The capabilities in `length` = 17 bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_capabilities_decode(
    start: *const u8,
    length: usize,
    report: *mut Capabilities,
) -> Error {
    unsafe { decode(start, length, hid::Capabilities::decode, report) }
}

/// The `length` = 17 bytes of capabilities.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_capabilities_encode(
    report: *const Capabilities,
    start: *mut u8,
    length: usize,
) -> Error {
    let bytes = |report| Ok(hid::Capabilities::from(report).encode());
    unsafe { encode(report, bytes, start, length) }
}

/// The `PALPATE_CONTROL_…` in the `length` = 2 bytes of a control report.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_control_decode(
    start: *const u8,
    length: usize,
    control: *mut u8,
) -> Error {
    let value = |bytes: &[u8]| hid::Control::decode(bytes).map(|control| control.encode()[1]);
    unsafe { decode(start, length, value, control) }
}

/// The `length` = 2 bytes of the control report for a `PALPATE_CONTROL_…`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_control_encode(
    control: u8,
    start: *mut u8,
    length: usize,
) -> Error {
    let bytes = |value| Ok(hid::Control::decode(&[hid::Control::NUMBER, value])?.encode());
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
        let units = Units::new(&unsafe { read(device) }?.into())?;
        Ok(units.sample(&unsafe { read(report) }?.into()).into())
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
        let units = Units::new(&unsafe { read(device) }?.into())?;
        let command = unsafe { read(command) }?;
        let command = servo::Command {
            force: force::Force::new(command.force.lateral, command.force.normal),
            playing: command.playing != 0,
        };
        Ok(units.report(&command, sequence).into())
    };
    unsafe { give(report, found) }
}
