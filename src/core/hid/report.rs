//! The vendor profile: four reports of fixed length, numbers little-endian.

use core::fmt;
use core::time::Duration;

/// The report descriptor of the vendor profile (usage page FF00).
///
/// Implements: HID-001.
pub const DESCRIPTOR: [u8; 136] = [
    0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, // vendor page, application
    0x85, 0x01, 0x09, 0x10, 0x09, 0x11, 0x16, 0x01, 0x80, 0x26, 0xFF, 0x7F, 0x75, 0x10, 0x95, 0x02,
    0x81, 0x02, // input 1: two positions
    0x09, 0x12, 0x09, 0x13, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 0x02, 0x81,
    0x02, // buttons, status
    0x09, 0x14, 0x09, 0x15, 0x15, 0x00, 0x27, 0xFF, 0xFF, 0x00, 0x00, 0x75, 0x10, 0x95, 0x02, 0x81,
    0x02, // sequence, last force's sequence
    0x85, 0x02, 0x09, 0x20, 0x09, 0x21, 0x16, 0x01, 0x80, 0x26, 0xFF, 0x7F, 0x75, 0x10, 0x95, 0x02,
    0x91, 0x02, // output 2: two forces
    0x09, 0x22, 0x15, 0x00, 0x27, 0xFF, 0xFF, 0x00, 0x00, 0x75, 0x10, 0x95, 0x01, 0x91,
    0x02, // sequence
    0x09, 0x23, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 0x01, 0x91, 0x02, // flags
    0x85, 0x03, 0x09, 0x30, 0x15, 0x00, 0x27, 0xFF, 0xFF, 0x00, 0x00, 0x75, 0x10, 0x95, 0x08, 0xB1,
    0x03, // feature 3: capabilities
    0x85, 0x04, 0x09, 0x40, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 0x01, 0xB1,
    0x02, // feature 4: control
    0xC0,
];

/// Whether any device's report descriptor has an item that selects the usage page `page`.
///
/// Implements: HID-031.
pub fn uses_page(descriptor: &[u8], page: u8) -> bool {
    const LONG_ITEM: u8 = 0xFE;
    const USAGE_PAGE: u8 = 0x04;
    let mut rest = descriptor;
    while let Some((&prefix, after)) = rest.split_first() {
        let size = match (prefix, after.first()) {
            (LONG_ITEM, Some(&length)) => usize::from(length) + 2,
            _ => [0, 1, 2, 4][usize::from(prefix & 3)],
        };
        // An item that is cut off ends the descriptor.
        let Some(data) = after.get(..size) else {
            return false;
        };
        let (low, high) = data.split_at(data.len().min(1));
        if prefix & !3 == USAGE_PAGE && low == [page] && high.iter().all(|&byte| byte == 0) {
            return true;
        }
        rest = &after[size..];
    }
    false
}

/// Bits of [`PositionReport::buttons`].
pub mod button {
    /// The deadman switch is held.
    pub const DEADMAN: u8 = 1;
}

/// Bits of [`PositionReport::status`].
pub mod status {
    /// The device has found a fault in itself and plays no force.
    pub const FAULT: u8 = 1;
    /// The device's own watchdog has dropped the force.
    pub const WATCHDOG: u8 = 2;
}

/// Input report 1: where the handle is.
// Implements: HID-002, HID-006.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
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
// Implements: HID-002, HID-006.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
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
// Implements: HID-002, HID-006.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
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

/// What the paper's display would answer: counts of 1 µm and, as the paper says of its quantization,
/// 0.5 mN; friction as in its Table 2.
pub const PAPER: Capabilities = Capabilities {
    version: 1,
    position_unit_nm: 1000,
    force_unit_un: 500,
    largest_force_mn: 8000,
    period_us: 1000,
    watchdog_ms: 15,
    damping_mn_s_per_m: 600,
    friction_mn: 140,
};

/// Feature report 4: what the device is told.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Control {
    /// Play no force until enabled.
    Stop = 0,
    /// Play the force reports.
    Enable = 1,
    /// Clear the device's own fault.
    ClearFault = 2,
}

/// Why bytes are no report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum InvalidReport {
    /// Another number of bytes, the report's number included.
    Length {
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// Another report's number in the first byte.
    Number {
        /// The number found.
        found: u8,
        /// The number that must be there.
        expected: u8,
    },
    /// A value that has no meaning.
    Value {
        /// What was found.
        found: u8,
    },
}

impl fmt::Display for InvalidReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            InvalidReport::Length { found, expected } => {
                write!(f, "a report of {found} bytes, which must have {expected}")
            }
            InvalidReport::Number { found, expected } => {
                write!(f, "report number {found}, which must be {expected}")
            }
            InvalidReport::Value { found } => write!(f, "the value {found} has no meaning"),
        }
    }
}

impl core::error::Error for InvalidReport {}

/// The bytes after the report's number.
pub(super) fn payload<const LENGTH: usize>(
    bytes: &[u8],
    expected: u8,
) -> Result<&[u8; LENGTH], InvalidReport> {
    let wrong_length = InvalidReport::Length {
        found: bytes.len(),
        expected: LENGTH + 1,
    };
    let (&found, rest) = bytes.split_first().ok_or(wrong_length)?;
    let rest = rest.try_into().map_err(|_| wrong_length)?;
    if found != expected {
        return Err(InvalidReport::Number { found, expected });
    }
    Ok(rest)
}

/// The bytes of a report after its number: each field, its type and the names of its bytes, least first.
macro_rules! report {
    ($report:ident, $number:literal, $($field:ident: $type:ty = $($byte:ident)+;)+) => {
        impl $report {
            /// The number of the report.
            pub const NUMBER: u8 = $number;
            /// Its length with the number, bytes.
            pub const LENGTH: usize = 1 $(+ size_of::<$type>())+;

            /// The report in `bytes`, which begin with the report's number.
            ///
            /// # Errors
            /// [`InvalidReport`] for another length or number.
            pub fn decode(bytes: &[u8]) -> Result<$report, InvalidReport> {
                let &[$($($byte),+),+] = payload(bytes, $report::NUMBER)?;
                Ok($report { $($field: <$type>::from_le_bytes([$($byte),+])),+ })
            }

            /// The bytes of the report.
            pub fn encode(&self) -> [u8; $report::LENGTH] {
                $(let [$($byte),+] = self.$field.to_le_bytes();)+
                [$report::NUMBER, $($($byte),+),+]
            }
        }
    };
}

report! {
    PositionReport, 1,
    lateral: i16 = a b;
    normal: i16 = c d;
    buttons: u8 = e;
    status: u8 = f;
    sequence: u16 = g h;
    force_sequence: u16 = i j;
}

report! {
    ForceReport, 2,
    lateral: i16 = a b;
    normal: i16 = c d;
    sequence: u16 = e f;
    flags: u8 = g;
}

report! {
    Capabilities, 3,
    version: u16 = a b;
    position_unit_nm: u16 = c d;
    force_unit_un: u16 = e f;
    largest_force_mn: u16 = g h;
    period_us: u16 = i j;
    watchdog_ms: u16 = k l;
    damping_mn_s_per_m: u16 = m n;
    friction_mn: u16 = o p;
}

impl ForceReport {
    /// The bit of [`ForceReport::flags`] that lets the device play the force.
    pub const PLAY: u8 = 1;
}

impl Capabilities {
    /// Time between two position reports.
    pub fn period(&self) -> Duration {
        Duration::from_micros(self.period_us.into())
    }

    /// Time without a force report after which the device drops the force.
    pub fn watchdog(&self) -> Duration {
        Duration::from_millis(self.watchdog_ms.into())
    }
}

impl Control {
    /// The number of the report.
    pub const NUMBER: u8 = 4;
    /// Its length with the number, bytes.
    pub const LENGTH: usize = 2;

    /// The report in `bytes`, which begin with the report's number.
    ///
    /// # Errors
    /// [`InvalidReport`] for another length, number or value.
    ///
    /// Implements: HID-002, HID-006.
    pub fn decode(bytes: &[u8]) -> Result<Control, InvalidReport> {
        match *payload(bytes, Control::NUMBER)? {
            [0] => Ok(Control::Stop),
            [1] => Ok(Control::Enable),
            [2] => Ok(Control::ClearFault),
            [found] => Err(InvalidReport::Value { found }),
        }
    }

    /// The bytes of the report.
    ///
    /// Implements: HID-002, HID-006.
    pub fn encode(&self) -> [u8; Control::LENGTH] {
        [Control::NUMBER, *self as u8]
    }
}
