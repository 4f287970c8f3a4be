//! What the loop needs of a haptic device, real or simulated.

use core::fmt;
use core::time::Duration;

use super::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// A two-axis haptic device.
///
/// Implements: HID-012.
pub trait HapticDevice {
    /// What the device is: units, limits, its own watchdog.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError>;

    /// The oldest report not yet read; waits up to `timeout` for one. A timeout of zero does not wait.
    ///
    /// # Errors
    /// [`DeviceError`], after which the device has to be opened again.
    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError>;

    /// Sends a force.
    ///
    /// # Errors
    /// [`DeviceError`]. May block far longer than a cycle: only the device's own watchdog drops the
    /// force then (`spec/hid.md`).
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError>;

    /// Enables or stops the device.
    ///
    /// # Errors
    /// [`DeviceError`].
    fn control(&mut self, control: Control) -> Result<(), DeviceError>;

    /// The time since the device was opened, on the clock by which it reports.
    fn now(&self) -> Duration;
}

#[cfg(feature = "std")]
impl<D: HapticDevice + ?Sized> HapticDevice for Box<D> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        (**self).capabilities()
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        (**self).read(timeout)
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        (**self).write(report)
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        (**self).control(control)
    }

    fn now(&self) -> Duration {
        (**self).now()
    }
}

/// What a read brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Received {
    /// A report.
    Report(PositionReport),
    /// Bytes that are none.
    Garbage(InvalidReport),
    /// Nothing in time.
    Nothing,
}

/// Why a device can no longer be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceError {
    /// It is gone: unplugged, or its node removed.
    Gone,
    /// It did not take a report in time.
    Stalled,
    /// A signal interrupted the wait.
    Interrupted,
    /// It has no such report, or answers with something else.
    Profile(InvalidReport),
    /// The system refused.
    #[cfg(feature = "std")]
    System(String),
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            DeviceError::Gone => write!(f, "the device is gone"),
            DeviceError::Stalled => write!(f, "the device takes no more reports"),
            DeviceError::Interrupted => write!(f, "a signal interrupted the device"),
            DeviceError::Profile(problem) => {
                write!(f, "the device does not speak the vendor profile: {problem}")
            }
            #[cfg(feature = "std")]
            DeviceError::System(message) => write!(f, "{message}"),
        }
    }
}

impl core::error::Error for DeviceError {}
