//! The core of palpate for programs in C: the detector, the servo kernel and the HID reports (`spec/c-library.md`).
//!
//! The caller owns all memory. Nothing is allocated, and nothing is kept between two calls but in structures of the caller.
//!
//! # Safety
//! What holds for every entry: a pointer is null, or points to as many elements as the entry says, which no other thread writes
//! meanwhile. Null, an address that is not a multiple of the type's alignment, and output that overlaps input of the same call
//! are refused. That memory is there cannot be checked. An `unsafe` in an entry hands this promise of the caller's on.
//!
//! Implements: CLB-001.
#![no_std]
// Said once, above.
#![allow(clippy::missing_safety_doc)]
#![deny(unsafe_op_in_unsafe_fn)]

mod decision;
mod error;
mod hid_report;
mod laws;
mod layout;
mod memory;
mod record;
mod sequential;
mod servo;

pub use decision::*;
pub use error::*;
pub use hid_report::*;
pub use laws::*;
pub use layout::LAYOUT;
pub use record::*;
pub use sequential::*;
pub use servo::*;

/// A panic would be a defect of this library: it ends the program.
///
/// Implements: CLB-005.
#[cfg(feature = "library")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn abort() -> !;
    }
    // SAFETY: C's `abort` asks for nothing.
    unsafe { abort() }
}
