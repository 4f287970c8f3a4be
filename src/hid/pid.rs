//! The fallback profile: what a step needs of the USB class for force feedback (PID), in the layout of
//! OpenFFBoard's firmware for two axes. The class leaves report numbers and fields to each device.
//!
//! Only the host's direction is here: what it reads is decoded, what it sends is encoded.
//!
//! ```
//! use palpate::hid::pid::{Axis, CREATE, DeviceControl, loaded_block, set_effect, set_force, start};
//!
//! // What the host sends to play a force along the second axis, in its order.
//! assert_eq!(CREATE, [17, 1, 0, 0]);
//! let block = loaded_block(&[18, 3, 1, 0, 0])?; // the device's answer: at place 3
//! let reports = (set_effect(block, Axis::Y, 20), set_force(block, -1000), start(block));
//! assert_eq!(reports.1, [5, 3, 0x18, 0xFC]);
//! assert_eq!(DeviceControl::StopAll.encode(), [12, 4]);
//! # Ok::<(), palpate::hid::InvalidReport>(())
//! ```

use super::InvalidReport;
use super::report::payload;

/// Two axes of many, as a joystick reports them: input report 1.
///
/// ```
/// use palpate::hid::pid::JoystickReport;
///
/// let mut bytes = [0; JoystickReport::LENGTH];
/// bytes[..13].copy_from_slice(&[1, 0b10, 0, 0, 0, 0, 0, 0, 0, 0x34, 0x12, 0xFF, 0xFF]);
/// let report = JoystickReport::decode(&bytes)?;
/// assert_eq!((report.buttons, report.x, report.y), (0b10, 0x1234, -1));
/// # Ok::<(), palpate::hid::InvalidReport>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct JoystickReport {
    /// Switches, the first in bit 0.
    pub buttons: u64,
    /// First axis, counts of 1/32767 of half its range.
    pub x: i16,
    /// Second axis, the same.
    pub y: i16,
}

impl JoystickReport {
    /// The number of the report.
    pub const NUMBER: u8 = 1;
    /// Its length with the number, bytes: 64 switches and eight axes.
    pub const LENGTH: usize = 25;

    /// The report in `bytes`, which begin with the report's number; six axes are passed over.
    ///
    /// ```
    /// use palpate::hid::pid::JoystickReport;
    ///
    /// let mut bytes = [0; JoystickReport::LENGTH];
    /// assert!(JoystickReport::decode(&bytes).is_err()); // report 0
    /// bytes[0] = JoystickReport::NUMBER;
    /// assert_eq!(JoystickReport::decode(&bytes)?.x, 0);
    /// # Ok::<(), palpate::hid::InvalidReport>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidReport`] for another length or number.
    ///
    /// Implements: HID-038, HID-039.
    pub fn decode(bytes: &[u8]) -> Result<JoystickReport, InvalidReport> {
        let &[a, b, c, d, e, f, g, h, i, j, k, l, ..] =
            payload::<{ JoystickReport::LENGTH - 1 }>(bytes, JoystickReport::NUMBER)?;
        Ok(JoystickReport {
            buttons: u64::from_le_bytes([a, b, c, d, e, f, g, h]),
            x: i16::from_le_bytes([i, j]),
            y: i16::from_le_bytes([k, l]),
        })
    }
}

/// Which place in its memory the device gave to an effect: feature report 18.
///
/// ```
/// use palpate::hid::{InvalidReport, pid::loaded_block};
///
/// assert_eq!(loaded_block(&[18, 3, 1, 0, 0]), Ok(3));
/// const FULL: u8 = 2;
/// assert_eq!(loaded_block(&[18, 0, FULL, 0, 0]), Err(InvalidReport::Value { found: FULL }));
/// ```
///
/// # Errors
/// [`InvalidReport`] for another length or number, and for a status that is not success.
///
/// Implements: HID-038, HID-039.
pub fn loaded_block(bytes: &[u8]) -> Result<u8, InvalidReport> {
    const SUCCESS: u8 = 1;
    match *payload::<4>(bytes, BLOCK_LOAD)? {
        [block, SUCCESS, _, _] => Ok(block),
        [_, found, _, _] => Err(InvalidReport::Value { found }),
    }
}

/// Number of the feature report that says where an effect is.
pub const BLOCK_LOAD: u8 = 18;

/// The type of effect that plays a force: a constant one.
const CONSTANT_FORCE: u8 = 1;

/// Asks for a place for a constant force: feature report 17.
///
/// Implements: HID-038.
pub const CREATE: [u8; 4] = [17, CONSTANT_FORCE, 0, 0];

/// An axis of the device.
///
/// ```
/// use palpate::hid::pid::{Axis, set_effect};
///
/// // One bit for each axis.
/// assert_eq!([set_effect(3, Axis::X, 20)[13], set_effect(3, Axis::Y, 20)[13]], [1, 2]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
}

/// Lays the constant force at `block` along `axis`, for `duration_ms` after each start, at full gain:
/// output report 1.
///
/// ```
/// use palpate::hid::pid::{Axis, set_effect};
///
/// // The constant force at place 3, for 300 ms.
/// assert_eq!(set_effect(3, Axis::X, 300)[..5], [1, 3, 1, 0x2C, 0x01]);
/// ```
///
/// Implements: HID-038.
pub fn set_effect(block: u8, axis: Axis, duration_ms: u16) -> [u8; 22] {
    const SET_EFFECT: u8 = 1;
    const FULL: u8 = 255;
    const NO_TRIGGER: u8 = 0;
    let [low, high] = duration_ms.to_le_bytes();
    let axes = match axis {
        Axis::X => 0b01,
        Axis::Y => 0b10,
    };
    let mut bytes = [0; 22];
    bytes[..5].copy_from_slice(&[SET_EFFECT, block, CONSTANT_FORCE, low, high]);
    // Trigger interval, sample period and start delay stay 0, direction and offsets too.
    bytes[11..14].copy_from_slice(&[FULL, NO_TRIGGER, axes]);
    bytes
}

/// Sets the force at `block`, in counts of 1/32767 of the axis' largest: output report 5.
///
/// ```
/// assert_eq!(palpate::hid::pid::set_force(3, -2), [5, 3, 0xFE, 0xFF]);
/// ```
///
/// Implements: HID-038, HID-040.
pub fn set_force(block: u8, force: i16) -> [u8; 4] {
    let [low, high] = force.to_le_bytes();
    [5, block, low, high]
}

/// Starts the effect at `block` once: output report 10.
///
/// ```
/// assert_eq!(palpate::hid::pid::start(3), [10, 3, 1, 1]);
/// ```
///
/// Implements: HID-038.
pub fn start(block: u8) -> [u8; 4] {
    [10, block, 1, 1]
}

/// What the device is told: output report 12, one bit for each.
///
/// ```
/// use palpate::hid::pid::DeviceControl;
///
/// assert_eq!(DeviceControl::EnableActuators.encode(), [12, 1]);
/// assert_eq!(DeviceControl::Reset.encode(), [12, 8]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum DeviceControl {
    /// Switch the motors on.
    EnableActuators = 1,
    /// Switch the motors off.
    DisableActuators = 2,
    /// Stop all effects.
    StopAll = 4,
    /// Forget all effects.
    Reset = 8,
}

impl DeviceControl {
    /// The bytes of the report.
    ///
    /// ```
    /// assert_eq!(palpate::hid::pid::DeviceControl::DisableActuators.encode(), [12, 2]);
    /// ```
    ///
    /// Implements: HID-038.
    pub fn encode(self) -> [u8; 2] {
        [12, self as u8]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: HID-038.
    #[test]
    fn a_joystick_report_has_its_axes_after_its_switches() {
        let mut bytes = [0xEE; 25];
        bytes[..13].copy_from_slice(&[1, 2, 0, 0, 0, 0, 0, 0, 0x80, 0x01, 0x80, 0x03, 0x04]);
        let report = JoystickReport {
            buttons: 0x8000_0000_0000_0002,
            x: -32767,
            y: 0x0403,
        };
        assert_eq!(JoystickReport::decode(&bytes), Ok(report));
    }

    // Verifies: HID-039.
    #[test]
    fn another_length_number_or_status_is_refused() {
        let length = |found, expected| Err(InvalidReport::Length { found, expected });
        assert_eq!(loaded_block(&[18, 3, 1, 0]), length(4, 5));
        assert_eq!(loaded_block(&[]), length(0, 5));
        let number = InvalidReport::Number {
            found: 6,
            expected: 18,
        };
        assert_eq!(loaded_block(&[6, 3, 1, 0, 0]), Err(number));
        for found in [0, 2, 3, 255] {
            let refused = Err(InvalidReport::Value { found });
            assert_eq!(loaded_block(&[18, 3, found, 0, 0]), refused);
        }
        assert_eq!(loaded_block(&[18, 3, 1, 0, 0]), Ok(3));
        let joystick = JoystickReport::decode(&[1; 24]);
        assert_eq!(
            joystick,
            Err(InvalidReport::Length {
                found: 24,
                expected: 25
            })
        );
    }

    // Verifies: HID-038, HID-040.
    #[test]
    fn what_is_sent_has_its_bytes_in_order() {
        let mut effect = [0; 22];
        effect[..5].copy_from_slice(&[1, 3, 1, 0x2C, 0x01]);
        effect[11] = 255;
        effect[13] = 2;
        assert_eq!(set_effect(3, Axis::Y, 300), effect);
        effect[13] = 1;
        assert_eq!(set_effect(3, Axis::X, 300), effect);
        assert_eq!(set_force(3, -2), [5, 3, 0xFE, 0xFF]);
        assert_eq!(start(3), [10, 3, 1, 1]);
        assert_eq!(DeviceControl::StopAll.encode(), [12, 4]);
        assert_eq!(DeviceControl::EnableActuators.encode(), [12, 1]);
    }
}
