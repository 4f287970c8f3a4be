//! Why a call is refused.
//!
//! Implements: CLB-004.

use core::ffi::{CStr, c_char};

use palpate_core::hid::{InvalidCapabilities, InvalidReport};
use palpate_core::servo::{InvalidAxis, InvalidLimits, InvalidTable};
use palpate_core::stats::NumericError;

/// What a call answers: 0, or why it was refused. A refused call writes no result.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error {
    /// The call did what it was asked for.
    Ok = 0,
    /// A pointer is null.
    NullPointer,
    /// A pointer is not a multiple of its type's alignment.
    Unaligned,
    /// Memory to write to overlaps other memory of the same call.
    Overlap,
    /// There is no sample.
    Empty,
    /// A list has another length than the call needs.
    Length,
    /// A sample is NaN or infinite.
    NotFinite,
    /// A number is outside the range in which there is an answer, or is NaN.
    OutOfRange,
    /// The signal is 0, or the nuisances explain it.
    NoSignal,
    /// The covariance is not symmetric.
    NotSymmetric,
    /// The covariance is not positive definite to working precision.
    NotPositiveDefinite,
    /// The answer is too large for a double.
    Overflow,
    /// The knots are not 2 to 1024 numbers within 1 m, each at least 1e-6 m above the one before.
    Knots,
    /// A force of the table is not a number within 100 N.
    TableForce,
    /// The structure is not what its `init` made.
    NotInitialised,
    /// A limit of the servo loop is out of its range.
    Limits,
    /// The bytes are no report of this kind.
    Report,
    /// The device's units do not allow forces to be computed.
    Device,
}

/// What the errors mean, in the order of their numbers.
const TEXTS: [&CStr; 18] = [
    c"no error",
    c"a pointer is null",
    c"a pointer is not a multiple of its type's alignment",
    c"memory to write to overlaps other memory of the same call",
    c"there is no sample; give at least one",
    c"a list has the wrong length",
    c"a sample is NaN or infinite",
    c"a number is out of its range or NaN",
    c"there is no signal, or the nuisances explain it",
    c"the covariance is not symmetric",
    c"the covariance is not positive definite",
    c"the answer is too large for a double",
    c"the knots are wrong; give 2 to 1024 within 1 m, each at least 1e-6 m above the one before",
    c"a force of the table is wrong; give a number within 100 N",
    c"the structure was not made by its init",
    c"a limit of the servo loop is out of its range",
    c"the bytes are no report of this kind: wrong length, number or value",
    c"the device's capabilities are wrong: version, a unit of 0, or a largest force that no report holds",
];

/// What an error means, in one line that ends with a zero. Never null, also for a number that is no error.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_error_text(error: u32) -> *const c_char {
    let text = usize::try_from(error)
        .ok()
        .and_then(|error| TEXTS.get(error));
    text.unwrap_or(&c"an unknown error").as_ptr()
}

impl From<NumericError> for Error {
    fn from(error: NumericError) -> Error {
        match error {
            NumericError::Empty { .. } => Error::Empty,
            NumericError::LengthMismatch { .. } => Error::Length,
            NumericError::NotFinite { .. } => Error::NotFinite,
            NumericError::NoSignal => Error::NoSignal,
            NumericError::NotSymmetric { .. } => Error::NotSymmetric,
            NumericError::NotPositiveDefinite { .. } => Error::NotPositiveDefinite,
            NumericError::Overflow { .. } => Error::Overflow,
            _ => Error::OutOfRange,
        }
    }
}

/// Reasons that C hears of by one number each.
macro_rules! numbered {
    ($($reason:ident: $number:ident),+) => {$(
        impl From<$reason> for Error {
            fn from(_: $reason) -> Error {
                Error::$number
            }
        }
    )+};
}

numbered! {
    InvalidAxis: Knots, InvalidTable: TableForce, InvalidLimits: Limits, InvalidReport: Report, InvalidCapabilities: Device
}
