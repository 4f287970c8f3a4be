//! Between the counts of a device and metres, newtons.

use core::fmt;

use super::{Capabilities, ForceReport, PositionReport, button, status};
use crate::servo::{Command, Sample};

/// What a count is worth on one device, in the direction in which each number is needed.
///
/// ```
/// use palpate_core::hid::{Capabilities, ForceReport, PositionReport, Units, button};
/// use palpate_core::force::Force;
/// use palpate_core::servo::Command;
///
/// # let bytes = [3, 1, 0, 0xE8, 0x03, 0xF4, 0x01, 0x40, 0x1F, 0xE8, 0x03, 15, 0, 0x58, 0x02, 140, 0];
/// # let capabilities = Capabilities::decode(&bytes).expect("a report");
/// // Counts of 1 µm and of 0.5 mN.
/// let units = Units::new(&capabilities)?;
/// let report = PositionReport {
///     lateral: 500, normal: -2000, buttons: button::DEADMAN, status: 0, sequence: 7, force_sequence: 0,
/// };
/// let sample = units.sample(&report);
/// assert!(sample.deadman && (sample.depth - 2e-3).abs() < 1e-9 && (sample.lateral - 0.5e-3).abs() < 1e-9);
///
/// let command = Command { force: Force { lateral: 0.0, normal: 1.5 }, playing: true };
/// let sent = ForceReport { lateral: 0, normal: 3000, sequence: 8, flags: ForceReport::PLAY };
/// assert_eq!(units.report(&command, 8), sent);
/// # Ok::<(), palpate_core::hid::InvalidCapabilities>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    metres_per_count: f32,
    counts_per_newton: f32,
}

/// Why the numbers of a device's reports cannot be turned into metres and newtons: what it says of itself has another version of
/// the profile than 1, a unit of 0, or a force that 32767 counts, the most that a report holds, do not reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InvalidCapabilities(pub Capabilities);

impl fmt::Display for InvalidCapabilities {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let device = &self.0;
        let (unit, largest) = (device.force_unit_un, device.largest_force_mn);
        write!(f, "the device")?;
        if device.version != 1 {
            let version = device.version;
            write!(
                f,
                " speaks version {version} of the profile, but must speak version 1"
            )
        } else if device.position_unit_nm == 0 {
            write!(f, "'s position unit is 0 nm, but must be at least 1")
        } else if unit == 0 {
            write!(f, "'s force unit is 0 µN, but must be at least 1")
        } else {
            write!(
                f,
                "'s force unit is {unit} µN, which is too small for a report of its largest force of {largest} mN, \
                 but must be at least {} µN",
                (u32::from(largest) * 1000).div_ceil(32767)
            )
        }
    }
}

impl core::error::Error for InvalidCapabilities {}

impl Units {
    /// The units of a device.
    ///
    /// # Errors
    /// [`InvalidCapabilities`].
    ///
    /// Implements: HID-008.
    pub fn new(capabilities: &Capabilities) -> Result<Units, InvalidCapabilities> {
        let units = [capabilities.position_unit_nm, capabilities.force_unit_un];
        let [reach, largest] = [
            u32::from(capabilities.force_unit_un) * 32767,
            u32::from(capabilities.largest_force_mn) * 1000,
        ];
        if capabilities.version != 1 || units.contains(&0) || reach < largest {
            return Err(InvalidCapabilities(*capabilities));
        }
        Ok(Units {
            metres_per_count: f32::from(capabilities.position_unit_nm) * 1e-9,
            counts_per_newton: 1e6 / f32::from(capabilities.force_unit_un),
        })
    }

    /// What a position report says, in metres: the depth is the normal position turned over.
    ///
    /// Implements: HID-010.
    pub fn sample(&self, report: &PositionReport) -> Sample {
        Sample {
            sequence: report.sequence,
            deadman: report.buttons & button::DEADMAN != 0,
            device_fault: report.status & (status::FAULT | status::WATCHDOG) != 0,
            depth: -f32::from(report.normal) * self.metres_per_count,
            lateral: f32::from(report.lateral) * self.metres_per_count,
        }
    }

    /// The report that plays a command.
    ///
    /// Implements: HID-010.
    pub fn report(&self, command: &Command, sequence: u16) -> ForceReport {
        ForceReport {
            lateral: count(command.force.lateral * self.counts_per_newton),
            normal: count(command.force.normal * self.counts_per_newton),
            sequence,
            flags: ForceReport::PLAY,
        }
    }
}

/// The whole number nearest to `value`, halves to the even one, within ±32767; a NaN gives 0.
///
/// The sum with 1.5 · 2²³ has its last bit at 1, so that adding rounds, and the low bits of the sum
/// are the whole number in two's complement: no conversion from floating point is needed, whose
/// edge cases checkers model differently.
///
/// Implements: HID-011, SRV-001.
#[inline]
pub fn count(value: f32) -> i16 {
    const ROUND: f32 = 12_582_912.0;
    let limited = crate::servo::limit(value, 32767.0);
    let [low, high, ..] = (limited + ROUND).to_bits().to_le_bytes();
    i16::from_le_bytes([low, high])
}
