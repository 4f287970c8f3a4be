//! What the loop needs of a haptic device, real or simulated.

use core::fmt;
use core::time::Duration;

use super::{Capabilities, Control, ForceReport, InvalidReport, PositionReport};

/// A two-axis haptic device.
///
/// A handle that stands still is a device:
/// ```
/// use core::time::Duration;
/// use palpate::hid::{Capabilities, Control, DeviceError, ForceReport, HapticDevice, PositionReport, Received};
///
/// struct Still(PositionReport);
///
/// impl HapticDevice for Still {
///     fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
///         let bytes = [3, 1, 0, 0xE8, 0x03, 0xF4, 0x01, 0x40, 0x1F, 0xE8, 0x03, 15, 0, 0x58, 0x02, 140, 0];
///         Capabilities::decode(&bytes).map_err(|_| DeviceError::Gone)
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
/// let zeros = PositionReport::decode(&[1; 11])?;
/// let mut device = Still(PositionReport { sequence: 0, ..zeros });
/// device.write(&ForceReport { lateral: 0, normal: 0, sequence: 42, flags: 0 })?;
/// let Received::Report(report) = device.read(Duration::from_millis(2))? else { unreachable!() };
/// assert_eq!((report.sequence, report.force_sequence), (1, 42));
/// assert_eq!(device.now(), Duration::from_millis(1));
/// assert_eq!(device.capabilities()?.watchdog_ms, 15);
/// device.control(Control::Stop)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
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
    /// The system refused.
    #[cfg(feature = "std")]
    System {
        /// Which device, what was asked of it, and what the system said.
        message: String,
        /// What that says of the device.
        state: DeviceState,
    },
}

/// What an error says of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceState {
    /// It is gone, as in [`DeviceError::Gone`].
    Gone,
    /// It took nothing in time, as in [`DeviceError::Stalled`].
    Stalled,
    /// It is there, and may take the same a moment later.
    There,
}

impl DeviceError {
    /// What it says of the device.
    fn state(&self) -> DeviceState {
        match self {
            DeviceError::Gone => DeviceState::Gone,
            DeviceError::Stalled => DeviceState::Stalled,
            #[cfg(feature = "std")]
            DeviceError::System { state, .. } => *state,
            _ => DeviceState::There,
        }
    }

    /// Whether the device is gone, so that nothing more can be sent to it.
    pub fn is_gone(&self) -> bool {
        self.state() == DeviceState::Gone
    }

    /// Whether it took seconds to fail, so that asking again would hold up the loop.
    pub fn is_stalled(&self) -> bool {
        self.state() == DeviceState::Stalled
    }
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            DeviceError::Gone => write!(f, "the device is gone"),
            DeviceError::Stalled => write!(f, "the device takes no more reports"),
            DeviceError::Interrupted => write!(f, "a signal interrupted the device"),
            #[cfg(feature = "std")]
            DeviceError::System { message, .. } => write!(f, "{message}"),
        }
    }
}

impl core::error::Error for DeviceError {}
