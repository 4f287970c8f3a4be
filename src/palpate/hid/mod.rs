//! Playback through a haptic device on the USB human-interface class (paper §4; `spec/hid.md`).
//!
//! | file | content |
//! |---|---|
//! | the core's `hid` | the vendor profile's reports, byte by byte, and their units |
//! | `device.rs` | what the loop needs of a device |
//! | `session.rs` | the loop: read, drain, step, write; it ends with a stopped device |
//! | `recording.rs` | a session in a file that plays again to the bit |
//! | `supervise.rs` | the servo thread and its supervisor |
//! | `real/` | a device on the system's HID stack |
//! | `pipe.rs` | a device behind a bridge in any language, over a pipe |
//! | `timing.rs` | how long the cycles take on this machine |
//! | `simulated/` | a device and a hand on a virtual clock, with faults by script |

mod device;
pub mod pipe;
pub mod real;
mod recording;
mod session;
pub mod simulated;
pub mod supervise;
#[cfg(test)]
mod tests;
pub mod timing;

pub use device::{DeviceError, DeviceState, HapticDevice, Received};
pub use palpate_core::hid::*;
pub use recording::{RecordedCycle, Recording};
pub use session::{Counters, Cycle, End, Session, check_device};
