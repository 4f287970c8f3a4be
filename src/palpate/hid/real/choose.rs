//! The choice of a device.

use std::fmt;

use super::{Identity, Listed, Profile};
use crate::refusal::Refusal;

/// The device to choose; `None` matches any.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Vendor number.
    pub vendor: Option<u16>,
    /// Product number.
    pub product: Option<u16>,
    /// Serial number.
    pub serial: Option<String>,
}

impl Wanted {
    fn is(&self, identity: &Identity) -> bool {
        fn fits<T: PartialEq>(wanted: &Option<T>, found: &T) -> bool {
            wanted.as_ref().is_none_or(|wanted| wanted == found)
        }
        fits(&self.vendor, &identity.vendor)
            && fits(&self.product, &identity.product)
            && fits(&self.serial, &identity.serial)
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let number = |number: Option<u16>| number.map_or("any".into(), |n| format!("{n:04x}"));
        write!(f, "{}:{}", number(self.vendor), number(self.product))?;
        match &self.serial {
            Some(serial) => write!(f, ", serial {serial}"),
            None => Ok(()),
        }
    }
}

/// The only one of `listed` that matches and has the vendor profile.
///
/// Implements: HID-030.
pub(super) fn choose<'a>(listed: &'a [Listed], wanted: &Wanted) -> Result<&'a Listed, Refusal> {
    let named = || listed.iter().filter(|one| wanted.is(&one.identity));
    let fits = |one: &&Listed| one.profile == Profile::Vendor;
    let fitting: Vec<&Listed> = named().filter(fits).collect();
    let wrong = match (&fitting[..], named().count(), named().next()) {
        (&[one], ..) => return Ok(one),
        // One that was asked for by name, and is something else, deserves an explanation.
        ([], 1, Some(one)) if *wanted != Wanted::default() => {
            format!("{}: {}", one.identity, one.profile)
        }
        ([], ..) => format!("no HID device {wanted}; `palpate devices` lists those there are"),
        (several, ..) => {
            let names: Vec<String> = several.iter().map(|one| one.identity.to_string()).collect();
            let (number, names) = (names.len(), names.join(", "));
            format!("{number} devices match: {names}; select one with --vid, --pid or --serial")
        }
    };
    Err(Refusal::state(wrong, ""))
}
