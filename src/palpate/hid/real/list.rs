//! Which HID devices there are, and why one can not be opened.

use std::fmt;

use hidapi::{DeviceInfo, HidApi};

use super::profile::Profile;
use super::system;
use crate::refusal::Refusal;

/// What a device is called, and where it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// Vendor number.
    pub vendor: u16,
    /// Product number.
    pub product: u16,
    /// Serial number; empty if it has none.
    pub serial: String,
    /// What the device calls itself.
    pub name: String,
    /// The system's file for it. Another one after a replug.
    pub node: String,
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} ({:04x}:{:04x}", self.name, self.vendor, self.product)?;
        if !self.serial.is_empty() {
            write!(f, ", serial {}", self.serial)?;
        }
        write!(f, ") at {}", self.node)
    }
}

/// A device and what it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Which device.
    pub identity: Identity,
    /// The profile that it fits.
    pub profile: Profile,
}

impl Listed {
    /// Whether the device can be opened, found out by opening it for a moment.
    ///
    /// # Errors
    /// What the system says; `PermissionDenied` where a udev rule is missing.
    ///
    /// Implements: HID-031.
    pub fn access(&self) -> std::io::Result<()> {
        system::access(&self.identity.node)
    }
}

/// All HID devices, in the order of their nodes, each once.
///
/// Takes milliseconds and allocates: not for the thread that runs the loop.
///
/// # Errors
/// What the system says.
///
/// Implements: HID-031.
pub fn list() -> Result<Vec<Listed>, Refusal> {
    Ok(look(&api()?))
}

/// The system's HID devices.
pub(super) fn api() -> Result<HidApi, Refusal> {
    let refused = |error| Refusal::state(format!("HID devices: {}", super::message(&error)), "");
    HidApi::new().map_err(refused)
}

/// The devices that `api` has found. A device with many usages is found once for each.
pub(super) fn look(api: &HidApi) -> Vec<Listed> {
    let mut found: Vec<&DeviceInfo> = api.device_list().collect();
    found.sort_by_key(|info| info.path());
    found.dedup_by_key(|info| info.path());
    found.into_iter().map(|info| listed(api, info)).collect()
}

fn listed(api: &HidApi, info: &DeviceInfo) -> Listed {
    let node = info.path().to_string_lossy().into_owned();
    let name = info.product_string().unwrap_or("unnamed device");
    Listed {
        profile: system::profile(api, info),
        identity: Identity {
            vendor: info.vendor_id(),
            product: info.product_id(),
            serial: info.serial_number().unwrap_or_default().to_owned(),
            name: name.to_owned(),
            node,
        },
    }
}

/// The udev rule that lets the person at the machine open a device.
///
/// It matches the `hidraw` node by the name of the HID device above it, which holds bus, vendor and
/// product on every bus; a rule for `SUBSYSTEM=="usb"` does not cover the node.
///
/// Implements: HID-031.
pub fn udev_rule(identity: &Identity) -> String {
    format!(
        r#"KERNEL=="hidraw*", KERNELS=="*:{:04X}:{:04X}.*", TAG+="uaccess""#,
        identity.vendor, identity.product
    )
}

/// What is said of a device that this user may not open.
pub fn no_permission(identity: &Identity) -> String {
    if !cfg!(target_os = "linux") {
        return "no permission: the system, or another program, keeps it".into();
    }
    let rule = udev_rule(identity);
    format!("no permission; the udev rule {rule} would give it")
}
