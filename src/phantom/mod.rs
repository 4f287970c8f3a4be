//! The phantom: a well of gel under a rubber skin, a hard inclusion in it or none, and the probe
//! that presses on it (paper §3). All lengths are metres, moduli pascals.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the data, the paper's five phantoms, derived lengths |
//! | `limits.rs` | which phantoms are physical |
//! | `pose.rs` | where the probe may stand |
//! | `file.rs` | phantom files in TOML |
//! | `decimal.rs` | mm and kPa to SI and back |
//!
//! ```
//! use palpate::phantom::Phantom;
//!
//! // The paper's phantom with the disc 6.6 mm deep, and a harder disc in it.
//! let mut phantom = Phantom::builtin("6.6")?;
//! if let Some(disc) = &mut phantom.inclusion {
//!     disc.material.youngs_modulus = 2.4e6;
//! }
//! phantom.validate()?;
//! assert!(phantom.to_toml()?.contains("youngs_modulus_kpa = 2400.0"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod decimal;
mod file;
mod limits;
mod pose;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use file::{PhantomFileError, PhantomFileProblem};
pub use limits::{GEL_CLEARANCE, InvalidPhantom, OutOfRange, Quantity};
pub use pose::PoseError;

/// A linear isotropic elastic material.
///
/// ```
/// use palpate::phantom::{Material, Phantom};
///
/// let gel = Phantom::builtin("none")?.gel.material;
/// assert_eq!(gel, Material { youngs_modulus: 5e3, poisson_ratio: 0.49 });
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E, Pa.
    #[serde(rename = "youngs_modulus_pa")]
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
}

/// The block of gel that fills the well, bonded to its floor and walls.
///
/// ```
/// use palpate::phantom::Phantom;
///
/// let gel = Phantom::builtin("none")?.gel;
/// assert_eq!((gel.width, gel.height), (0.034, 0.015));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gel {
    /// Width of the well, m.
    #[serde(rename = "width_m")]
    pub width: f64,
    /// Height of the gel without the skin, m.
    #[serde(rename = "height_m")]
    pub height: f64,
    /// What the gel is made of.
    pub material: Material,
}

/// The rubber layer on top of the gel, bonded to the gel and, at its edges, to the walls.
///
/// ```
/// use palpate::phantom::Phantom;
///
/// let skin = Phantom::builtin("none")?.skin;
/// assert_eq!((skin.thickness, skin.material.youngs_modulus), (0.0005, 1.8e5));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skin {
    /// Thickness, m.
    #[serde(rename = "thickness_m")]
    pub thickness: f64,
    /// What the skin is made of.
    pub material: Material,
}

/// A solid disc (a cylinder along the probe), centred at x = 0 and bonded to the gel.
///
/// ```
/// use palpate::phantom::{Inclusion, Phantom};
///
/// let Phantom { inclusion, .. } = Phantom::builtin("2.6")?;
/// // 6.4 mm across and 2.6 mm deep: its centre is 5.8 mm below the surface.
/// assert_eq!(inclusion.as_ref().map(Inclusion::radius), Some(0.0032));
/// assert!(inclusion.is_some_and(|disc| (disc.centre_y() + 0.0058).abs() < 1e-15));
/// assert!(Phantom::builtin("none")?.inclusion.is_none());
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inclusion {
    /// Diameter, m.
    #[serde(rename = "diameter_m")]
    pub diameter: f64,
    /// Depth of the disc's top below the outer surface of the skin, m.
    #[serde(rename = "depth_m")]
    pub depth: f64,
    /// What the disc is made of.
    pub material: Material,
}

impl Inclusion {
    /// Radius of the disc, m.
    pub fn radius(&self) -> f64 {
        self.diameter / 2.0
    }

    /// Height of the disc's centre above the undeformed outer surface, m: negative, since the disc
    /// lies below it. Its lateral position is 0.
    ///
    /// Implements: PHA-008, CON-003.
    pub fn centre_y(&self) -> f64 {
        -(self.depth + self.radius())
    }
}

/// The rigid, frictionless, semicylindrical probe.
///
/// ```
/// use palpate::phantom::Probe;
///
/// let probe = Probe { radius: 0.0065, length: 0.03 };
/// // At a depth of the radius, and below, half of the width is the radius.
/// assert!((probe.half_width_at(0.0065) - 0.0065).abs() < 1e-15);
/// // The half chord at 4 mm: √(6.5² − 2.5²) = 6 mm.
/// assert!((probe.half_width_at(0.004) - 0.006).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Radius, m.
    #[serde(rename = "radius_m")]
    pub radius: f64,
    /// Length along the cylinder, m: forces are totals over it.
    #[serde(rename = "length_m")]
    pub length: f64,
}

/// Everything that fixes the force on the probe, but for the probe's position.
///
/// Reading one with serde checks the types alone: call [`Phantom::validate`] on the result.
///
/// ```
/// use palpate::phantom::Phantom;
///
/// let phantom = Phantom::builtin("8.6")?;
/// assert!((phantom.total_height() - 0.0155).abs() < 1e-15);
/// assert!(phantom.validate().is_ok());
/// // What is written can be read.
/// let text = phantom.to_toml()?;
/// assert_eq!(Phantom::from_toml(&text, "mine.toml")?, phantom);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: PHA-029.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phantom {
    /// A name for tables and figures.
    pub name: String,
    /// The gel and its well.
    pub gel: Gel,
    /// The skin.
    pub skin: Skin,
    /// The inclusion, if there is one.
    pub inclusion: Option<Inclusion>,
    /// The probe.
    pub probe: Probe,
}

/// The names of the paper's five phantoms: without an inclusion, then by its depth in mm.
///
/// Implements: PHA-001.
pub const BUILTIN_NAMES: [&str; 5] = ["none", "2.6", "4.6", "6.6", "8.6"];

/// A name that is none of [`BUILTIN_NAMES`].
///
/// ```
/// use palpate::phantom::Phantom;
///
/// let error = Phantom::builtin("5.6").unwrap_err();
/// assert!(error.to_string().ends_with("built in are none, 2.6, 4.6, 6.6, 8.6"));
/// ```
///
/// Implements: PHA-014.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no phantom named {name:?} is built in; built in are {}", BUILTIN_NAMES.join(", "))]
pub struct UnknownPhantom {
    /// The name that was asked for.
    pub name: String,
}

impl Phantom {
    /// One of the paper's five phantoms (§3, §3.1), by its name in [`BUILTIN_NAMES`].
    ///
    /// ```
    /// use palpate::phantom::{BUILTIN_NAMES, Phantom};
    ///
    /// for name in BUILTIN_NAMES {
    ///     assert_eq!(Phantom::builtin(name)?.inclusion.is_none(), name == "none");
    /// }
    /// # Ok::<(), palpate::phantom::UnknownPhantom>(())
    /// ```
    ///
    /// # Errors
    /// [`UnknownPhantom`] for any other name.
    ///
    /// Implements: PHA-001, PHA-002, PHA-014.
    pub fn builtin(name: &str) -> Result<Phantom, UnknownPhantom> {
        let inclusion_depth = match name {
            "none" => None,
            "2.6" => Some(0.0026),
            "4.6" => Some(0.0046),
            "6.6" => Some(0.0066),
            "8.6" => Some(0.0086),
            _ => return Err(UnknownPhantom { name: name.into() }),
        };
        let material = |youngs_modulus| Material {
            youngs_modulus,
            poisson_ratio: 0.49,
        };
        Ok(Phantom {
            name: name.into(),
            gel: Gel {
                width: 0.034,
                height: 0.015,
                material: material(5e3),
            },
            skin: Skin {
                thickness: 0.0005,
                material: material(1.8e5),
            },
            inclusion: inclusion_depth.map(|depth| Inclusion {
                diameter: 0.0064,
                depth,
                material: material(1.2e6),
            }),
            probe: Probe {
                radius: 0.0065,
                length: 0.03,
            },
        })
    }

    /// Height of the outer surface above the floor, m: gel and skin.
    ///
    /// Implements: PHA-008.
    pub fn total_height(&self) -> f64 {
        self.gel.height + self.skin.thickness
    }
}
