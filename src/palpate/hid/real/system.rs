//! What differs between operating systems: how a device is looked at before the loop opens it.

use std::io;

use hidapi::{DeviceInfo, HidApi};

use super::profile::Profile;

/// The profile that a device fits, by the report descriptor, which Linux shows also to those who may not open the device.
#[cfg(target_os = "linux")]
pub fn profile(_: &HidApi, info: &DeviceInfo) -> Profile {
    let node = info.path().to_string_lossy();
    let name = node.rsplit('/').next().unwrap_or_default();
    let file = format!("/sys/class/hidraw/{name}/device/report_descriptor");
    described(std::fs::read(file))
}

/// The profile that a device fits, by the report descriptor, for which macOS has the device opened.
#[cfg(target_os = "macos")]
pub fn profile(api: &HidApi, info: &DeviceInfo) -> Profile {
    let mut bytes = [0; hidapi::MAX_REPORT_DESCRIPTOR_SIZE];
    let read = info.open_device(api);
    let read = read.and_then(|device| device.get_report_descriptor(&mut bytes));
    described(read.map(|length| bytes[..length].to_vec()))
}

#[cfg(unix)]
fn described(descriptor: Result<Vec<u8>, impl ToString>) -> Profile {
    match descriptor {
        Ok(bytes) => Profile::of(&bytes),
        Err(error) => Profile::Unknown(error.to_string()),
    }
}

/// The profile that a device fits, by its usage: Windows passes on no report descriptor.
#[cfg(windows)]
pub fn profile(_: &HidApi, info: &DeviceInfo) -> Profile {
    Profile::of_usage(info.usage_page(), info.usage())
}

/// Whether the device at a node can be opened, found out by opening it for a moment.
///
/// # Errors
/// What the system says.
#[cfg(not(target_os = "macos"))]
pub fn access(node: &str) -> io::Result<()> {
    let opened = std::fs::OpenOptions::new()
        .read(true)
        .write(true)
        .open(node);
    opened.map(|_| ())
}

/// Whether the device at a node, which is no file on macOS, can be opened, found out by opening it for a moment.
///
/// # Errors
/// What the system says.
#[cfg(target_os = "macos")]
pub fn access(node: &str) -> io::Result<()> {
    let api = HidApi::new().map_err(io::Error::other)?;
    let path = std::ffi::CString::new(node).map_err(io::Error::other)?;
    api.open_path(&path).map_err(io::Error::other).map(|_| ())
}
