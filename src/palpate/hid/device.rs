//! What the loop needs of a haptic device, real or simulated.

use std::fmt;
use std::time::{Duration, Instant};

use super::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// A two-axis haptic device.
///
/// A handle that stands still is a device:
/// ```
/// use palpate::hid::simulated::PAPER;
/// use palpate::hid::{Capabilities, Control, DeviceError, ForceReport, HapticDevice, PositionReport, Received};
/// use std::time::Duration;
///
/// struct Still(PositionReport);
///
/// impl HapticDevice for Still {
///     fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
///         Ok(PAPER)
///     }
///     fn read(&mut self, _: Duration) -> Result<Received, DeviceError> {
///         self.0.sequence = self.0.sequence.wrapping_add(1);
///         Ok(Received::Report(self.0))
///     }
///     fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
///         self.0.force_sequence = report.sequence;
///         Ok(())
///     }
///     fn control(&mut self, _: Control) -> Result<(), DeviceError> {
///         Ok(())
///     }
///     fn now(&self) -> Duration {
///         Duration::from_millis(self.0.sequence.into())
///     }
/// }
///
/// let mut device = Still(PositionReport::default());
/// device.write(&ForceReport { sequence: 42, ..ForceReport::default() })?;
/// let Received::Report(report) = device.read(Duration::from_millis(2))? else { unreachable!() };
/// assert_eq!((report.sequence, report.force_sequence), (1, 42));
/// # Ok::<(), palpate::hid::DeviceError>(())
/// ```
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

/// Throws away the reports of some time: those that were made before the device was enabled may tell of a fault that is cleared.
///
/// Implements: HID-033.
pub(super) fn pass_over(device: &mut impl HapticDevice, time: Duration) -> Result<(), DeviceError> {
    let began = Instant::now();
    while let Some(left) = time.checked_sub(began.elapsed()) {
        device.read(left)?;
    }
    Ok(())
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
pub struct DeviceError {
    /// What it says of the device.
    pub state: DeviceState,
    /// Which device, what was asked of it, and what the system said.
    pub message: String,
}

/// What an error says of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceState {
    /// It is gone: unplugged, or its node removed. Nothing more can be sent to it.
    Gone,
    /// It did not take a report in time, which took seconds: asking again would hold up the loop.
    Stalled,
    /// A signal interrupted the wait for it.
    Interrupted,
    /// It is there, and may take the same a moment later.
    There,
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for DeviceError {}

impl DeviceError {
    /// A failure.
    pub fn new(state: DeviceState, message: impl Into<String>) -> DeviceError {
        let message = message.into();
        DeviceError { state, message }
    }
}
