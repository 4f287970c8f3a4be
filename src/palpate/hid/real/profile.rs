//! What a device is, by its report descriptor.

use std::fmt;

use crate::hid::{DESCRIPTOR, uses_page};

/// What a device's report descriptor says that it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Profile {
    /// The vendor profile.
    Vendor,
    /// A force-feedback device of the USB class for physical interfaces, which the loop does not drive.
    Pid,
    /// Something else.
    Other {
        /// Length of its report descriptor, bytes.
        length: usize,
        /// The first byte in which it differs from the vendor profile's.
        differs_at: usize,
    },
    /// The descriptor could not be read.
    Unknown(String),
}

impl Profile {
    /// What a report descriptor fits.
    ///
    /// Implements: HID-031.
    pub fn of(descriptor: &[u8]) -> Profile {
        if descriptor == DESCRIPTOR {
            return Profile::Vendor;
        }
        if uses_page(descriptor, 0x0F) {
            return Profile::Pid;
        }
        let same = descriptor.iter().zip(&DESCRIPTOR);
        Profile::Other {
            length: descriptor.len(),
            differs_at: same.take_while(|(one, other)| one == other).count(),
        }
    }

    /// What a device of this usage fits, where the system passes on no report descriptor.
    ///
    /// Implements: HID-100.
    pub fn of_usage(page: u16, usage: u16) -> Profile {
        match (page, usage) {
            (0xFF00, 1) => Profile::Vendor,
            (0x0F, _) => Profile::Pid,
            _ => Profile::Unknown(format!("not shown, but usage {usage} of page {page:#06x}")),
        }
    }
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Profile::Vendor => write!(f, "vendor profile"),
            Profile::Pid => write!(f, "force-feedback (PID) class, which is not driven"),
            Profile::Other { length, differs_at } => write!(
                f,
                "not the vendor profile: a report descriptor of {length} bytes, different from byte {differs_at} on"
            ),
            Profile::Unknown(error) => write!(f, "unknown: report descriptor: {error}"),
        }
    }
}
