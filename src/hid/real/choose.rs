//! The device that is asked for.

use std::fmt;

use super::{Identity, ListError, Listed, Profile};

/// What is known of the device that is wanted; what is `None` does not matter.
///
/// ```
/// use palpate::hid::real::Wanted;
///
/// let wanted = Wanted { vendor: Some(0x1209), serial: Some("7".into()), ..Wanted::default() };
/// assert_eq!(wanted.to_string(), "1209:any, serial 7");
/// ```
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
    /// The same device, at whatever node.
    ///
    /// ```
    /// use palpate::hid::real::{Identity, Wanted};
    ///
    /// let found = Identity {
    ///     vendor: 0x1209, product: 1, serial: "7".into(), name: "probe".into(), node: "/dev/hidraw3".into(),
    /// };
    /// assert_eq!(Wanted::again(&found).to_string(), "1209:0001, serial 7");
    /// ```
    pub fn again(identity: &Identity) -> Wanted {
        Wanted {
            vendor: Some(identity.vendor),
            product: Some(identity.product),
            serial: Some(identity.serial.clone()),
        }
    }

    fn is(&self, identity: &Identity) -> bool {
        self.vendor.is_none_or(|vendor| vendor == identity.vendor)
            && self
                .product
                .is_none_or(|product| product == identity.product)
            && self
                .serial
                .as_ref()
                .is_none_or(|serial| *serial == identity.serial)
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

/// Why no device was opened.
///
/// ```
/// use palpate::hid::real::OpenError;
///
/// let error = OpenError::NotFound { wanted: "1209:any".into() };
/// assert_eq!(error.to_string(), "no HID device 1209:any; `palpate devices` lists those there are");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// The devices could not be listed.
    #[error("{0}")]
    List(#[from] ListError),
    /// There is none.
    #[error("no HID device {wanted}; `palpate devices` lists those there are")]
    NotFound {
        /// What was asked for.
        wanted: String,
    },
    /// There is one, but it is something else.
    #[error("{device}: {profile}")]
    Profile {
        /// Which device.
        device: Identity,
        /// What it is.
        profile: Profile,
    },
    /// There are several.
    #[error("{} devices: {}; choose one by its numbers", .0.len(), names(.0))]
    Several(Vec<Identity>),
    /// This user may not open it.
    #[error("{device}: no permission; the udev rule {rule} would give it")]
    Denied {
        /// Which device.
        device: Identity,
        /// The rule that is missing.
        rule: String,
    },
    /// The system does not open it.
    #[error("{device}: {error}")]
    Refused {
        /// Which device.
        device: Identity,
        /// What the system said.
        error: String,
    },
}

fn names(devices: &[Identity]) -> String {
    let names: Vec<String> = devices.iter().map(ToString::to_string).collect();
    names.join(", ")
}

/// The only one of `listed` that is wanted and fits the vendor profile.
///
/// Implements: HID-030.
pub(super) fn choose<'a>(listed: &'a [Listed], wanted: &Wanted) -> Result<&'a Listed, OpenError> {
    let named: Vec<&Listed> = listed
        .iter()
        .filter(|one| wanted.is(&one.identity))
        .collect();
    let fits = |one: &&&Listed| one.profile == Profile::Vendor;
    let fitting: Vec<&Listed> = named.iter().filter(fits).copied().collect();
    match (&fitting[..], &named[..]) {
        (&[one], _) => Ok(one),
        // One that was asked for by name, and is something else, deserves an explanation.
        ([], [one]) if *wanted != Wanted::default() => Err(OpenError::Profile {
            device: one.identity.clone(),
            profile: one.profile.clone(),
        }),
        ([], _) => Err(OpenError::NotFound {
            wanted: wanted.to_string(),
        }),
        (several, _) => {
            let several = several.iter().map(|one| one.identity.clone());
            Err(OpenError::Several(several.collect()))
        }
    }
}
