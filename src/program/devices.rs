//! `palpate devices`: the HID devices of this machine (`spec/command-line.md`).

use std::io::{Error, ErrorKind};

use clap::Args;
use serde_json::{Value, json};

use super::{CliError, Format};
use palpate::hid::real::{Listed, Profile, list, no_permission, udev_rule};

/// Arguments of `palpate devices`.
#[derive(Debug, Args)]
pub struct DevicesArguments {
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Runs the command.
///
/// Implements: CLI-078, HID-094.
pub fn devices(arguments: &DevicesArguments) -> Result<(), CliError> {
    let listed = list()?;
    let answer: Value = listed.iter().map(as_json).collect();
    arguments.format.print(&answer, || describe(&listed))
}

fn describe(listed: &[Listed]) -> String {
    if listed.is_empty() {
        return "no HID device\n".into();
    }
    let text = |one: &Listed| {
        let (identity, profile) = (&one.identity, &one.profile);
        let refused = match one.access() {
            Ok(()) => String::new(),
            Err(error) if is_denied(&error) => format!("    {}\n", no_permission(identity)),
            Err(error) => format!("    cannot be opened: {error}\n"),
        };
        format!("{identity}\n    {profile}\n{refused}")
    };
    listed.iter().map(text).collect()
}

fn is_denied(error: &Error) -> bool {
    error.kind() == ErrorKind::PermissionDenied
}

fn as_json(one: &Listed) -> Value {
    let identity = &one.identity;
    let refused = one.access().err();
    let is_denied = refused.as_ref().is_some_and(is_denied);
    json!({
        "vendor": format!("{:04x}", identity.vendor),
        "product": format!("{:04x}", identity.product),
        "serial": identity.serial,
        "name": identity.name,
        "node": identity.node,
        "fits": one.profile == Profile::Vendor,
        "profile": one.profile.to_string(),
        "access": match &refused {
            None => "granted".into(),
            Some(_) if is_denied => "no permission".into(),
            Some(error) => error.to_string(),
        },
        "udev_rule": (is_denied && cfg!(target_os = "linux")).then(|| udev_rule(identity)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::hid::real::Identity;

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
        let holds = lines[2].starts_with("    cannot be opened: No such file");
        assert!(holds, "{text}");
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
}
