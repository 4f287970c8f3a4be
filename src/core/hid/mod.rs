//! The reports of a haptic device on the USB human-interface class (paper §4; `spec/hid.md`).
//!
//! | file | content |
//! |---|---|
//! | `report.rs` | the vendor profile's reports, byte by byte |
//! | `units.rs` | between counts and metres, newtons |

mod report;
#[cfg(test)]
mod tests;
mod units;

pub use report::{
    Capabilities, Control, DESCRIPTOR, ForceReport, InvalidReport, PAPER, PositionReport, button,
    status, uses_page,
};
pub use units::{InvalidCapabilities, Units, count};
