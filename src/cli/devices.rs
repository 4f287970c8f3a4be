//! `palpate devices`: the HID devices of this machine (`spec/playback-command.md`).

use std::fmt::Write;

use clap::Args;
use serde_json::{Value, json};

use super::output::print;
use super::{CliError, Format};
use crate::hid::real::{Access, Listed, Profile, Wanted, list, udev_rule};

/// Arguments of `palpate devices`.
#[derive(Debug, Args)]
pub struct DevicesArguments {
    /// How the devices are printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Which device is meant.
#[derive(Debug, Args)]
pub struct DeviceNumbers {
    /// Vendor number of the device, hexadecimal
    #[arg(long, value_name = "HEX", value_parser = number)]
    vid: Option<u16>,
    /// Product number of the device, hexadecimal
    #[arg(long, value_name = "HEX", value_parser = number)]
    pid: Option<u16>,
    /// Serial number of the device
    #[arg(long, value_name = "TEXT")]
    serial: Option<String>,
}

impl DeviceNumbers {
    /// The device that is meant.
    pub fn wanted(&self) -> Wanted {
        Wanted {
            vendor: self.vid,
            product: self.pid,
            serial: self.serial.clone(),
        }
    }

    /// Whether any is given.
    pub fn are_given(&self) -> bool {
        self.wanted() != Wanted::default()
    }
}

fn number(text: &str) -> Result<u16, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    u16::from_str_radix(digits, 16).map_err(|_| "expected up to four hexadecimal digits".into())
}

/// Runs the command.
///
/// Implements: CLI-078, HID-093.
pub fn devices(arguments: &DevicesArguments) -> Result<(), CliError> {
    let listed = list().map_err(|error| CliError::Playback(error.to_string()))?;
    print(&match arguments.format {
        Format::Table => describe(&listed),
        Format::Json => format!("{:#}\n", listed.iter().map(as_json).collect::<Value>()),
    })
}

fn describe(listed: &[Listed]) -> String {
    if listed.is_empty() {
        return "no HID device\n".into();
    }
    let mut text = String::new();
    for one in listed {
        let mut line = |line: String| {
            let _ = writeln!(text, "{line}"); // a String takes everything
        };
        line(one.identity.to_string());
        line(format!("    {}", one.profile));
        match one.access() {
            Access::Granted => {}
            Access::Denied => line(format!(
                "    no permission; the udev rule {} would give it",
                udev_rule(&one.identity)
            )),
            Access::Failed(error) => line(format!("    cannot be opened: {error}")),
        }
    }
    text
}

fn as_json(one: &Listed) -> Value {
    let identity = &one.identity;
    let access = one.access();
    json!({
        "vendor": format!("{:04x}", identity.vendor),
        "product": format!("{:04x}", identity.product),
        "serial": identity.serial,
        "name": identity.name,
        "node": identity.node,
        "fits": one.profile == Profile::Vendor,
        "profile": one.profile.to_string(),
        "access": match &access {
            Access::Granted => "granted",
            Access::Denied => "no permission",
            Access::Failed(error) => error,
        },
        "udev_rule": (access == Access::Denied).then(|| udev_rule(identity)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hid::real::Identity;

    fn nowhere(profile: Profile) -> Listed {
        Listed {
            identity: Identity {
                vendor: 0x1209,
                product: 0x00AB,
                serial: "7".into(),
                name: "Display".into(),
                node: "/nowhere".into(),
            },
            profile,
        }
    }

    // Verifies: CLI-078.
    #[test]
    fn a_device_is_described_with_its_profile_and_why_it_can_not_be_opened() {
        assert_eq!(describe(&[]), "no HID device\n");
        let text = describe(&[nowhere(Profile::Vendor)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "Display (1209:00ab, serial 7) at /nowhere");
        assert_eq!(lines[1], "    vendor profile");
        assert!(
            lines[2].starts_with("    cannot be opened: No such file"),
            "{text}"
        );
    }

    // Verifies: CLI-078.
    #[test]
    fn a_program_reads_numbers_as_they_are_given() {
        let device = as_json(&nowhere(Profile::Pid));
        assert_eq!(device["vendor"], "1209");
        assert_eq!(device["product"], "00ab");
        assert_eq!(device["fits"], false);
        assert_eq!(device["udev_rule"], Value::Null);
    }

    // Verifies: CLI-079.
    #[test]
    fn numbers_are_hexadecimal() {
        assert_eq!(number("1209"), Ok(0x1209));
        assert_eq!(number("0xfFfF"), Ok(0xFFFF));
        for wrong in ["", "10000", "-1", "12g9", "0x"] {
            assert!(number(wrong).is_err(), "{wrong}");
        }
    }
}
