//! What can be tested without a device; `tests/hid-stack` has the rest.

use std::time::Duration;

use super::choose::choose;
use super::*;
use crate::hid::DESCRIPTOR;

fn listed(serial: &str, profile: Profile) -> Listed {
    Listed {
        identity: Identity {
            vendor: 0x1209,
            product: 1,
            serial: serial.into(),
            name: "Display".into(),
            node: format!("/dev/{serial}"),
        },
        profile,
    }
}

fn wanted(serial: &str) -> Wanted {
    Wanted {
        vendor: Some(0x1209),
        product: Some(1),
        serial: Some(serial.into()),
    }
}

// Verifies: HID-030, HID-031.
#[test]
fn the_only_device_of_the_profile_needs_no_name_and_another_is_explained() {
    let devices = |names: &str| -> Vec<Listed> {
        let profile = |name: &str| match name {
            "mouse" => Profile::Pid,
            "other" => Profile::of(&DESCRIPTOR[..135]),
            _ => Profile::Vendor,
        };
        let names = names.split(' ');
        names.map(|name| listed(name, profile(name))).collect()
    };
    let chosen = |names: &str, wanted: &Wanted| match choose(&devices(names), wanted) {
        Ok(one) => one.identity.serial.clone(),
        Err(refusal) => refusal.to_string(),
    };
    let any = Wanted::default();
    assert_eq!(chosen("mouse a", &any), "a");
    assert_eq!(chosen("a b", &wanted("b")), "b");
    assert_eq!(
        chosen("a b", &any),
        "2 devices match: Display (1209:0001, serial a) at /dev/a, Display (1209:0001, serial b) at /dev/b; \
         select one with --vid, --pid or --serial"
    );
    assert_eq!(
        chosen("other", &wanted("other")),
        "Display (1209:0001, serial other) at /dev/other: not the vendor profile: \
         a report descriptor of 135 bytes, different from byte 135 on"
    );
    let mut others = [wanted("b"), wanted("a"), wanted("a"), any];
    others[1].vendor = Some(0x1208);
    others[2].product = Some(2);
    others[3].product = Some(3);
    let names = "1209:0001, serial b|1208:0001, serial a|1209:0002, serial a|any:0003";
    for (other, name) in others.iter().zip(names.split('|')) {
        let missing = format!("no HID device {name}; `palpate devices` lists those there are");
        assert_eq!(chosen("a", other), missing);
    }
}

// Verifies: HID-031.
#[test]
fn a_profile_is_told_by_every_byte_of_the_descriptor() {
    assert_eq!(Profile::of(&DESCRIPTOR), Profile::Vendor);
    for index in 0..DESCRIPTOR.len() {
        let mut other = DESCRIPTOR;
        other[index] ^= 0x80;
        assert_ne!(Profile::of(&other), Profile::Vendor, "byte {index}");
    }
}

// Verifies: HID-031.
#[test]
fn a_force_feedback_device_is_told_by_its_usage_page() {
    // A joystick's application collection, with a collection of the PID page in it.
    let pid = [
        0x05, 0x01, 0x09, 0x04, 0xA1, 0x01, 0x05, 0x0F, 0x09, 0x21, 0xA1, 0x02, 0xC0, 0xC0,
    ];
    assert_eq!(Profile::of(&pid), Profile::Pid);
    // The same bytes as the data of an item, and cut off in the middle of one.
    let data = [0x27, 0x05, 0x0F, 0x05, 0x0F];
    let cut = [0x05, 0x01, 0x06, 0x0F];
    // As data of a long item, which has its length in the second byte.
    let long = [0xFE, 2, 0, 0x05, 0x0F];
    for other in [&data[..], &cut, &long, &[], &[0xFE], &[0xFE, 9, 0]] {
        let found = Profile::of(other);
        assert!(matches!(found, Profile::Other { .. }), "{other:?}");
    }
}

// Verifies: HID-100.
#[test]
fn without_a_descriptor_a_profile_is_told_by_its_usage() {
    // The descriptor's own first items: usage page 0xFF00, usage 1.
    assert_eq!(DESCRIPTOR[..5], [0x06, 0x00, 0xFF, 0x09, 0x01]);
    assert_eq!(Profile::of_usage(0xFF00, 1), Profile::Vendor);
    assert_eq!(Profile::of_usage(0x0F, 1), Profile::Pid);
    for (page, usage) in [(0xFF00, 2), (1, 4), (0xFF, 1)] {
        let found = Profile::of_usage(page, usage);
        assert!(matches!(found, Profile::Unknown(_)), "{page} {usage}");
    }
}

// Verifies: HID-031.
#[test]
fn the_rule_matches_the_node_by_the_device_above_it() {
    let rule = udev_rule(&listed("a", Profile::Vendor).identity);
    assert_eq!(
        rule,
        r#"KERNEL=="hidraw*", KERNELS=="*:1209:0001.*", TAG+="uaccess""#
    );
}

// Verifies: HID-033.
#[test]
fn a_timeout_is_never_shorter_than_asked_for() {
    for (nanoseconds, expected) in [(0, 0), (1, 1), (2_000_000, 2), (2_001_000, 3)] {
        assert_eq!(milliseconds(Duration::from_nanos(nanoseconds)), expected);
    }
    assert_eq!(milliseconds(Duration::MAX), i32::MAX);
}

// Verifies: HID-033.
#[test]
fn a_read_that_is_interrupted_waits_for_what_is_left() {
    let mut asked = Vec::new();
    let read = within(Duration::from_secs(60), |left| {
        asked.push(left);
        std::thread::sleep(Duration::from_millis(20));
        match asked.len() {
            4 => Ok(7),
            _ => Err(HidError::from(std::io::Error::from(ErrorKind::Interrupted))),
        }
    });
    assert_eq!(read.unwrap(), 7);
    // Each began 20 ms or more after the one before.
    assert!(asked[0] <= 60_000);
    assert!(
        asked.windows(2).all(|pair| pair[1] <= pair[0] - 19),
        "{asked:?}"
    );
    let other = within(Duration::ZERO, |_| -> Result<(), HidError> {
        Err(HidError::from(std::io::Error::from(ErrorKind::TimedOut)))
    });
    assert!(other.is_err());
}

// Verifies: HID-033.
#[test]
fn a_write_in_part_is_a_failure() {
    let all = ForceReport::LENGTH;
    assert!(all_sent(all).is_ok());
    for sent in 0..all {
        let error = all_sent(sent).unwrap_err().to_string();
        assert!(error.contains(&sent.to_string()), "{error}");
    }
}

// Verifies: HID-025.
#[test]
fn an_unplug_is_told_from_a_refusal_by_what_the_library_says() {
    let code = |code| HidError::from(std::io::Error::from_raw_os_error(code)).to_string();
    let [no_device, shutdown, timed_out, input_output, pipe] = [19, 108, 110, 5, 32].map(code);
    use DeviceState::{Gone, Stalled, There};
    for (problem, expected) in [
        (&*no_device, Gone),
        (&shutdown, Gone),
        ("unexpected poll error (device disconnected)", Gone),
        ("The device is not connected. (os error 1167)", Gone),
        ("ioctl (GFEATURE): ENODEV: No such device", Gone),
        (&timed_out, Stalled),
        ("ioctl (SFEATURE): ETIMEDOUT: Connection timed out", Stalled),
        // A board that answers with an error is still there.
        (&input_output, There),
        (&pipe, There),
        ("ioctl (GFEATURE): EPIPE: Broken pipe", There),
    ] {
        assert_eq!(state(problem), expected, "{problem}");
    }
}
