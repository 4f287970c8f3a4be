//! A haptic device on the system's HID stack.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the device as the loop sees it |
//! | `list.rs` | which devices there are, and why one can not be opened |
//! | `profile.rs` | what a device is, by its report descriptor |
//! | `choose.rs` | the device that is asked for |
//! | `system.rs` | what differs between operating systems |

mod choose;
mod list;
mod profile;
mod system;
#[cfg(test)]
mod tests;

use std::ffi::CString;
use std::fmt::Display;
use std::io::ErrorKind;
use std::time::{Duration, Instant};

use hidapi::HidError;

pub use choose::Wanted;
pub use list::{Identity, Listed, list, no_permission, udev_rule};
pub use profile::Profile;

use super::device::pass_over;
use super::{
    Capabilities, Control, DeviceError, DeviceState, ForceReport, HapticDevice, PositionReport,
    Received,
};
use crate::refusal::Refusal;

/// More than any report of the profile, so that one which is too long is seen as such.
const LONGEST: usize = 64;

/// Between two looks for a device that is not there yet.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// A device of the vendor profile, opened.
///
/// Reading and writing neither allocate nor enumerate; opening does both and takes milliseconds, so it
/// has no place in the loop.
///
/// ```no_run
/// use palpate::hid::real::{RealDevice, Wanted};
/// use palpate::hid::{HapticDevice, Received};
/// use std::time::Duration;
///
/// let mut device = RealDevice::open(&Wanted::default())?;
/// let largest = device.capabilities()?.largest_force_mn;
/// println!("{} plays up to {largest} mN", device.identity());
/// if let Received::Report(report) = device.read(Duration::from_millis(2))? {
///     println!("{report:?}");
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: HID-033, HID-080.
#[derive(Debug)]
pub struct RealDevice {
    device: hidapi::HidDevice,
    identity: Identity,
    opened: Instant,
    /// Between two reports, as the device says.
    period: Duration,
}

impl RealDevice {
    /// Opens the only device that is wanted and fits the vendor profile.
    ///
    /// # Errors
    /// The devices that there are instead, or why it can not be opened.
    ///
    /// Implements: HID-030.
    pub fn open(wanted: &Wanted) -> Result<RealDevice, Refusal> {
        let api = list::api()?;
        let listed = list::look(&api);
        let chosen = choose::choose(&listed, wanted)?;
        let identity = chosen.identity.clone();
        let path = CString::new(identity.node.as_str()).unwrap_or_default();
        let device = api.open_path(&path).map_err(|error| {
            let wrong = match chosen.access() {
                Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                    no_permission(&identity)
                }
                _ => message(&error),
            };
            Refusal::state(format_args!("{identity}: {wrong}"), "")
        })?;
        Ok(RealDevice {
            device,
            identity,
            opened: Instant::now(),
            period: Duration::from_millis(1),
        })
    }

    /// [`RealDevice::open`], again and again for as long as `patience`: a device that was just plugged
    /// in is listed before it may be opened, and one that was replugged may have another node.
    ///
    /// # Errors
    /// The last one of [`RealDevice::open`].
    ///
    /// Implements: HID-036, HID-085.
    pub fn open_within(wanted: &Wanted, patience: Duration) -> Result<RealDevice, Refusal> {
        let began = Instant::now();
        loop {
            match RealDevice::open(wanted) {
                Err(error) if began.elapsed() >= patience => return Err(error),
                Err(_) => std::thread::sleep(LOOK_AGAIN),
                opened => return opened,
            }
        }
    }

    /// Which device it is.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// What failed, with the device's name.
    fn failed(&self, action: &str, problem: &dyn Display) -> DeviceError {
        let problem = problem.to_string();
        let message = format!("{}: {action}: {problem}", self.identity);
        DeviceError::new(state(&problem), message)
    }
}

/// What the library says of the device. It has no codes for that, only words: of its `poll`, of `ENODEV`, of `ESHUTDOWN` and of
/// `ETIMEDOUT`, and of Windows's `ERROR_DEVICE_NOT_CONNECTED`.
fn state(problem: &str) -> DeviceState {
    let says = |words: &str| problem.contains(words);
    let gone = [
        "device disconnected",
        "No such device",
        "endpoint shutdown",
        "os error 1167",
    ];
    if gone.into_iter().any(says) {
        DeviceState::Gone
    } else if says("timed out") {
        DeviceState::Stalled
    } else {
        DeviceState::There
    }
}

/// What the system says, without the library's name for itself.
fn message(error: &HidError) -> String {
    match error {
        HidError::HidApiError { message } => message.clone(),
        other => other.to_string(),
    }
}

/// Whole milliseconds, rounded up: a timeout may be longer than asked for, but not shorter.
fn milliseconds(timeout: Duration) -> i32 {
    i32::try_from(timeout.as_nanos().div_ceil(1_000_000)).unwrap_or(i32::MAX)
}

/// Refuses a write of which the system took fewer bytes than a force report has.
///
/// Implements: HID-033.
fn all_sent(sent: usize) -> Result<(), HidError> {
    let all = ForceReport::LENGTH;
    match sent == all {
        true => Ok(()),
        false => Err(HidError::IncompleteSendError { sent, all }),
    }
}

/// Whether a signal came in between; the device is as it was.
fn is_interrupted(error: &HidError) -> bool {
    matches!(error, HidError::IoError { error } if error.kind() == std::io::ErrorKind::Interrupted)
}

/// What `read` gives, which after an interruption is asked again for what is left of `timeout`.
///
/// Implements: HID-033.
fn within<T>(
    timeout: Duration,
    mut read: impl FnMut(i32) -> Result<T, HidError>,
) -> Result<T, HidError> {
    let began = Instant::now();
    loop {
        let left = milliseconds(timeout.saturating_sub(began.elapsed()));
        match read(left) {
            Err(error) if is_interrupted(&error) => {}
            read => return read,
        }
    }
}

impl HapticDevice for RealDevice {
    /// Implements: HID-080, HID-085.
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        let mut bytes = [0; LONGEST];
        bytes[0] = Capabilities::NUMBER;
        let length = self
            .device
            .get_feature_report(&mut bytes)
            .map_err(|error| self.failed("ask for feature report 3", &message(&error)))?;
        let capabilities = Capabilities::decode(&bytes[..length.min(LONGEST)])
            .map_err(|problem| self.failed("feature report 3", &problem))?;
        self.period = capabilities.period();
        Ok(capabilities)
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        let mut bytes = [0; LONGEST];
        match within(timeout, |left| self.device.read_timeout(&mut bytes, left)) {
            Ok(0) => Ok(Received::Nothing),
            Ok(length) => {
                let report = PositionReport::decode(&bytes[..length.min(LONGEST)]);
                Ok(report.map_or_else(Received::Garbage, Received::Report))
            }
            Err(error) => Err(self.failed("read", &message(&error))),
        }
    }

    /// Implements: HID-080, HID-091, HID-033.
    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        let sent = self.device.write(&report.encode());
        sent.and_then(all_sent)
            .map_err(|error| self.failed("write", &message(&error)))
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.device
            .send_feature_report(&control.encode())
            .map_err(|error| self.failed("send feature report 4", &message(&error)))?;
        match control {
            Control::Enable => {
                let time = 2 * self.period;
                pass_over(self, time)
            }
            Control::Stop | Control::ClearFault => Ok(()),
        }
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}
