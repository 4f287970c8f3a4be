//! Playback through a haptic device on the USB human-interface class (paper §4; `spec/hid.md`).
//!
//! | file | content |
//! |---|---|
//! | `report.rs` | the vendor profile's reports, byte by byte |
//! | `units.rs` | between counts and metres, newtons |
//! | `device.rs` | what the loop needs of a device |
//! | `session.rs` | the loop: read, drain, step, write; it ends with a stopped device |
//! | `recording.rs` | a session in a file that plays again to the bit |
//! | `supervise.rs` | the servo thread and its supervisor |
//! | `real/` | a device on the system's HID stack |
//! | `timing.rs` | how long the cycles take on this machine |
//! | `simulated/` | a device and a hand on a virtual clock, with faults by script |

#[cfg(feature = "std")]
mod device;
#[cfg(feature = "hid")]
pub mod real;
#[cfg(feature = "std")]
mod recording;
mod report;
#[cfg(feature = "std")]
mod session;
#[cfg(feature = "std")]
pub mod simulated;
#[cfg(feature = "hid")]
pub mod supervise;
#[cfg(test)]
mod tests;
#[cfg(feature = "hid")]
pub mod timing;
mod units;

#[cfg(feature = "std")]
pub use device::{DeviceError, DeviceState, HapticDevice, Received};
#[cfg(feature = "std")]
pub use recording::{RecordedCycle, Recording};
pub use report::{
    Capabilities, Control, DESCRIPTOR, ForceReport, InvalidReport, PositionReport, button, status,
    uses_page,
};
#[cfg(feature = "std")]
pub use session::{Counters, Cycle, End, Session};
pub use units::{InvalidCapabilities, Units, count};
