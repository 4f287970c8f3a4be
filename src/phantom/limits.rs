//! Which phantoms are physical, and can be meshed.

use std::fmt;
use std::ops::Bound::{self, Excluded, Included, Unbounded};

use super::decimal::format_scaled;
use super::{Gel, Inclusion, Material, Phantom, Probe};

/// The least gel, m, between the disc and the skin, the floor and each wall: a thinner layer cannot
/// be meshed with elements of a sound shape.
///
/// Implements: PHA-006.
pub const GEL_CLEARANCE: f64 = 1e-4;

/// Allowed lengths, m. The upper end catches a length in the wrong unit, the lower one a layer that
/// no mesh resolves.
const LENGTHS: [f64; 2] = [1e-6, 1.0];

/// Above this Poisson's ratio displacement elements lock, and the stiffness matrix is nearly singular.
const LARGEST_POISSON_RATIO: f64 = 0.4995;

/// What a number of a phantom measures; it fixes the unit in the number's key.
///
/// ```
/// use palpate::phantom::{InvalidPhantom, Phantom, Quantity};
///
/// let mut phantom = Phantom::builtin("none")?;
/// phantom.gel.material.poisson_ratio = 0.5;
/// let error = phantom.validate().unwrap_err();
/// assert!(matches!(error, InvalidPhantom::OutOfRange(n) if n.quantity == Quantity::Ratio));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A length: m inside, mm in a phantom file.
    Length,
    /// A modulus: Pa inside, kPa in a phantom file.
    Modulus,
    /// A pure number.
    Ratio,
}

impl Quantity {
    /// The unit at the end of a key of the phantom file.
    ///
    /// Implements: CON-002.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            Quantity::Length => "_mm",
            Quantity::Modulus => "_kpa",
            Quantity::Ratio => "",
        }
    }

    /// The power of ten from the phantom file's unit to SI.
    pub(super) fn power_to_si(self) -> i32 {
        match self {
            Quantity::Length => -3,
            Quantity::Modulus => 3,
            Quantity::Ratio => 0,
        }
    }

    /// An SI value in the phantom file's unit.
    pub(super) fn in_file_unit(self, value: f64) -> String {
        format_scaled(value, -self.power_to_si())
    }
}

/// A number of a phantom that is not finite or outside its allowed range.
///
/// Its message speaks in the keys and units of the phantom file.
///
/// ```
/// use palpate::phantom::{InvalidPhantom, Phantom};
///
/// let mut phantom = Phantom::builtin("none")?;
/// phantom.gel.width = f64::NAN;
/// let error = phantom.validate().unwrap_err();
/// assert_eq!(error.to_string(), "gel.width_mm = NaN, allowed: at least 0.001 and at most 1000.0");
/// assert!(matches!(error, InvalidPhantom::OutOfRange(number) if number.key == "gel.width"));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
///
/// Implements: PHA-009.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// Where it stands in the phantom file, without the unit: `gel.width`.
    pub key: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Its value, SI.
    pub value: f64,
    /// The lower end of the allowed range, SI.
    pub lower: Bound<f64>,
    /// The upper end of the allowed range, SI.
    pub upper: Bound<f64>,
    /// What the range is for, or nothing where it speaks for itself.
    pub reason: &'static str,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |value: f64| self.quantity.in_file_unit(value);
        let suffix = self.quantity.suffix();
        write!(f, "{}{suffix} = {}, allowed: ", self.key, show(self.value))?;
        if self.is_empty() {
            write!(f, "nothing")?;
        } else {
            match self.lower {
                Included(lower) => write!(f, "at least {}", show(lower))?,
                Excluded(lower) => write!(f, "above {}", show(lower))?,
                Unbounded => write!(f, "any finite number")?,
            }
            match self.upper {
                Included(upper) => write!(f, " and at most {}", show(upper))?,
                Excluded(upper) => write!(f, " and below {}", show(upper))?,
                Unbounded => {}
            }
        }
        if !self.reason.is_empty() {
            write!(f, " ({})", self.reason)?;
        }
        Ok(())
    }
}

impl OutOfRange {
    /// Whether no number at all is allowed, because the rest of the phantom leaves no room.
    fn is_empty(&self) -> bool {
        match (self.lower, self.upper) {
            (Included(lower), Included(upper)) => lower > upper,
            (Excluded(lower) | Included(lower), Excluded(upper) | Included(upper)) => {
                lower >= upper
            }
            _ => false,
        }
    }

    /// `Err(self)` if the value is not finite or outside the range.
    fn check(self) -> Result<(), InvalidPhantom> {
        let above = match self.lower {
            Included(lower) => self.value >= lower,
            Excluded(lower) => self.value > lower,
            Unbounded => true,
        };
        let below = match self.upper {
            Included(upper) => self.value <= upper,
            Excluded(upper) => self.value < upper,
            Unbounded => true,
        };
        if self.value.is_finite() && above && below {
            Ok(())
        } else {
            Err(InvalidPhantom::OutOfRange(self))
        }
    }
}

/// Why a phantom is refused.
///
/// ```
/// use palpate::phantom::{InvalidPhantom, Phantom};
///
/// let mut phantom = Phantom::builtin("none")?;
/// phantom.name.clear();
/// assert_eq!(phantom.validate(), Err(InvalidPhantom::Name { name: "".into() }));
/// # Ok::<(), palpate::phantom::UnknownPhantom>(())
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidPhantom {
    /// A number is not finite or outside its range.
    #[error("{0}")]
    OutOfRange(OutOfRange),
    /// The name is empty, too long, or would break a table or a figure.
    #[error("name = {name:?}, allowed: 1 to 80 characters, none of them a control character")]
    Name {
        /// The name.
        name: String,
    },
}

impl InvalidPhantom {
    /// The key that is refused, in the phantom file but without the unit.
    pub(super) fn key(&self) -> &'static str {
        match self {
            InvalidPhantom::OutOfRange(number) => number.key,
            InvalidPhantom::Name { .. } => "name",
        }
    }
}

impl Phantom {
    /// Whether this phantom can exist and be meshed.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// // 15.5 mm in all, less the disc's 6.4 mm and 0.1 mm of gel under it.
    /// let mut phantom = Phantom::builtin("8.6")?;
    /// assert!(phantom.validate().is_ok());
    /// if let Some(disc) = &mut phantom.inclusion {
    ///     disc.depth = 0.0091;
    /// }
    /// assert!(phantom.validate().unwrap_err().to_string().contains("at most 9.0 "));
    /// # Ok::<(), palpate::phantom::UnknownPhantom>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidPhantom`] with the first offending key, its value and what is allowed.
    ///
    /// Implements: PHA-003, PHA-004, PHA-005, PHA-006, PHA-007, PHA-009, PHA-010, PHA-015, CON-007.
    pub fn validate(&self) -> Result<(), InvalidPhantom> {
        check_name(&self.name)?;
        check_length("gel.width", self.gel.width)?;
        check_length("gel.height", self.gel.height)?;
        check_material(
            ["gel.youngs_modulus", "gel.poisson_ratio"],
            &self.gel.material,
        )?;
        check_length("skin.thickness", self.skin.thickness)?;
        check_material(
            ["skin.youngs_modulus", "skin.poisson_ratio"],
            &self.skin.material,
        )?;
        check_probe(&self.probe, &self.gel)?;
        match &self.inclusion {
            Some(inclusion) => self.check_inclusion(inclusion),
            None => Ok(()),
        }
    }

    fn check_inclusion(&self, inclusion: &Inclusion) -> Result<(), InvalidPhantom> {
        check_length("inclusion.diameter", inclusion.diameter)?;
        check_length("inclusion.depth", inclusion.depth)?;
        check_material(
            ["inclusion.youngs_modulus", "inclusion.poisson_ratio"],
            &inclusion.material,
        )?;
        let inside_gel = |key, value, lower, upper| OutOfRange {
            key,
            quantity: Quantity::Length,
            value,
            lower: Included(to_picometre(lower)),
            upper: Included(to_picometre(upper)),
            reason: "at least 0.1 mm of gel must lie between the inclusion and the skin, the floor and each wall",
        };
        let room = self.gel.width.min(self.gel.height) - 2.0 * GEL_CLEARANCE;
        inside_gel("inclusion.diameter", inclusion.diameter, LENGTHS[0], room).check()?;
        let shallowest = self.skin.thickness + GEL_CLEARANCE;
        let deepest = self.total_height() - inclusion.diameter - GEL_CLEARANCE;
        inside_gel("inclusion.depth", inclusion.depth, shallowest, deepest).check()
    }
}

/// `length` (m) on a grid of 1 pm. A bound that is a sum of decimals then equals the decimal that a
/// person writes for it, and that exact value passes: 0.0005 + 0.0001 alone is not 0.0006 in binary.
///
/// Implements: PHA-015.
fn to_picometre(length: f64) -> f64 {
    (length * 1e12).round() / 1e12
}

fn check_name(name: &str) -> Result<(), InvalidPhantom> {
    let length = name.chars().count();
    if (1..=80).contains(&length) && !name.chars().any(char::is_control) {
        Ok(())
    } else {
        Err(InvalidPhantom::Name { name: name.into() })
    }
}

fn check_length(key: &'static str, value: f64) -> Result<(), InvalidPhantom> {
    OutOfRange {
        key,
        quantity: Quantity::Length,
        value,
        lower: Included(LENGTHS[0]),
        upper: Included(LENGTHS[1]),
        reason: "",
    }
    .check()
}

fn check_material(keys: [&'static str; 2], material: &Material) -> Result<(), InvalidPhantom> {
    OutOfRange {
        key: keys[0],
        quantity: Quantity::Modulus,
        value: material.youngs_modulus,
        lower: Excluded(0.0),
        upper: Unbounded,
        reason: "",
    }
    .check()?;
    OutOfRange {
        key: keys[1],
        quantity: Quantity::Ratio,
        value: material.poisson_ratio,
        lower: Excluded(-1.0),
        upper: Included(LARGEST_POISSON_RATIO),
        reason: "",
    }
    .check()
}

fn check_probe(probe: &Probe, gel: &Gel) -> Result<(), InvalidPhantom> {
    check_length("probe.length", probe.length)?;
    OutOfRange {
        key: "probe.radius",
        quantity: Quantity::Length,
        value: probe.radius,
        lower: Included(LENGTHS[0]),
        upper: Excluded(to_picometre(gel.width / 2.0)),
        reason: "the probe must be narrower than the well",
    }
    .check()
}
