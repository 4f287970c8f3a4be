//! The phantom: layers of gel and rubber in a well, hard inclusions in them or none, and the probe that presses on
//! them (paper §3). All lengths are metres, moduli pascals, angles degrees.
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the data, the paper's five phantoms, derived lengths |
//! | `paper.toml` | one of the five as a phantom file |
//! | `shape.rs` | outlines of inclusions |
//! | `limits.rs` | which phantoms are physical and can be meshed |
//! | `pose.rs` | where the probe may stand |
//! | `file.rs` | phantom files in TOML |
//!
//! ```
//! use palpate::phantom::Phantom;
//!
//! // The paper's phantom with the disc 6.6 mm deep, and a harder disc, 3 mm off the middle.
//! let phantom = Phantom::builtin("6.6")?.changed(|parts| {
//!     parts.inclusions[0].material.youngs_modulus = 2.4e6;
//!     parts.inclusions[0].centre_x = 3e-3;
//! })?;
//! assert!(!phantom.is_symmetric());
//! assert!(phantom.to_toml().contains("youngs_modulus_kpa = 2400.0"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod file;
mod limits;
mod pose;
mod shape;
#[cfg(test)]
pub(crate) mod tests;

use std::fmt;

use crate::decimal::parse_scaled;
use serde::{Deserialize, Serialize};

pub use limits::CLEARANCE;
pub use shape::{Ellipse, Outline, Shape};
pub use shape::{edges, point_to_segment};

use crate::refusal::Refusal;

/// An elastic material: isotropic at small strain but for its fibres.
///
/// Implements: PHA-031.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Material {
    /// Young's modulus E, Pa.
    #[serde(rename = "youngs_modulus_pa")]
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Yeoh's second coefficient C₂₀, Pa: how fast the material stiffens at finite strain.
    #[serde(rename = "yeoh_c20_pa", default, skip_serializing_if = "is_default")]
    pub yeoh_c20: f64,
    /// What fibres add to Young's modulus along them, Pa.
    #[serde(
        rename = "fibre_modulus_pa",
        default,
        skip_serializing_if = "is_default"
    )]
    pub fibre_modulus: f64,
    /// Angle from +x to the fibres, counter-clockwise.
    #[serde(default, skip_serializing_if = "is_default")]
    pub fibre_angle_deg: f64,
}

impl Material {
    /// An isotropic material with Young's modulus E, Pa, and Poisson's ratio ν, which does not stiffen.
    pub const fn isotropic(youngs_modulus: f64, poisson_ratio: f64) -> Material {
        Material {
            youngs_modulus,
            poisson_ratio,
            yeoh_c20: 0.0,
            fibre_modulus: 0.0,
            fibre_angle_deg: 0.0,
        }
    }

    /// The direction of the fibres.
    pub fn fibre_direction(&self) -> [f64; 2] {
        let angle = self.fibre_angle_deg.to_radians();
        [libm::cos(angle), libm::sin(angle)]
    }

    /// Whether the mirror image in x is the same material.
    fn is_symmetric(&self) -> bool {
        self.fibre_modulus == 0.0 || self.fibre_angle_deg % 90.0 == 0.0
    }
}

/// Whether a key need not be written.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The theory that computes the forces.
///
/// Implements: PHA-032.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Strain {
    /// Linear elasticity, as the paper's.
    #[default]
    Small,
    /// Finite strain.
    Finite,
}

/// How a wall or the floor of the well holds the layers.
///
/// Implements: PHA-016.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Support {
    /// Bonded: no displacement.
    #[default]
    Fixed,
    /// Lubricated: no displacement across the wall or floor, no friction along it.
    Sliding,
    /// Not there: no force.
    Free,
}

/// What the cross-section of a phantom stands for.
///
/// Implements: PHA-033.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Geometry {
    /// Cylinders along the probe, which is one too.
    #[default]
    Plane,
    /// Bodies of revolution about the axis x = 0, under a spherical probe.
    Axisymmetric,
}

/// Displays the word of a file.
macro_rules! display_word {
    ($($name:ident),*) => {$(
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.serialize(f)
            }
        }
    )*};
}
display_word!(Strain, Support, Geometry);

/// The well that holds the layers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Well {
    /// Width between the walls, m.
    #[serde(rename = "width_m")]
    pub width: f64,
    /// Both walls.
    #[serde(default)]
    pub walls: Support,
    /// The floor.
    #[serde(default)]
    pub floor: Support,
}

/// A layer from wall to wall, bonded to its neighbours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Layer {
    /// A name for tables and figures.
    pub name: String,
    /// Thickness, m.
    #[serde(rename = "thickness_m")]
    pub thickness: f64,
    /// What the layer is made of.
    pub material: Material,
}

/// A solid cylinder along the probe, bonded to the layer in which it lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Inclusion {
    /// x of the shape's centre, m; of a polygon, where its points have x = 0.
    #[serde(rename = "centre_x_m", default)]
    pub centre_x: f64,
    /// Depth of the shape's highest point below the outer surface, m.
    #[serde(rename = "depth_m")]
    pub depth: f64,
    /// The outline.
    pub shape: Shape,
    /// What the inclusion is made of.
    pub material: Material,
}

/// The rigid probe: a semicylinder, or a sphere where the phantom is axisymmetric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Probe {
    /// Radius, m.
    #[serde(rename = "radius_m")]
    pub radius: f64,
    /// Length along the cylinder, m: forces are totals over it. Of a sphere its diameter.
    #[serde(rename = "length_m")]
    pub length: f64,
    /// Coulomb's coefficient μ of friction between probe and surface.
    #[serde(default, skip_serializing_if = "is_default")]
    pub friction: f64,
}

/// The parts of a phantom, with any values: [`Phantom::new`] makes a phantom of them.
///
/// Implements: PHA-029.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a phantom")]
pub struct PhantomParts {
    /// A name for tables and figures.
    pub name: String,
    /// The theory that computes the forces.
    #[serde(default, skip_serializing_if = "is_default")]
    pub strain: Strain,
    /// What the cross-section stands for.
    #[serde(default, skip_serializing_if = "is_default")]
    pub geometry: Geometry,
    /// The well.
    pub well: Well,
    /// The layers, top to bottom; the first one's top is the outer surface.
    #[serde(rename = "layer")]
    pub layers: Vec<Layer>,
    /// The inclusions; none for a plain gel.
    #[serde(rename = "inclusion", default, skip_serializing_if = "Vec::is_empty")]
    pub inclusions: Vec<Inclusion>,
    /// The probe.
    pub probe: Probe,
}

/// Everything that fixes the force on the probe, but for the probe's position: parts that can exist and be meshed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PhantomParts")]
pub struct Phantom(PhantomParts);

impl TryFrom<PhantomParts> for Phantom {
    type Error = Refusal;

    fn try_from(parts: PhantomParts) -> Result<Phantom, Refusal> {
        Phantom::new(parts)
    }
}

impl PhantomParts {
    /// What layers and inclusions are made of, in their order.
    pub fn materials_mut(&mut self) -> impl Iterator<Item = &mut Material> {
        let layers = self.layers.iter_mut().map(|layer| &mut layer.material);
        layers.chain(self.inclusions.iter_mut().map(|of| &mut of.material))
    }
}

impl From<Phantom> for PhantomParts {
    fn from(phantom: Phantom) -> PhantomParts {
        phantom.0
    }
}

/// The names of the paper's five phantoms: without an inclusion, then by its depth in mm.
///
/// Implements: PHA-001.
pub const BUILTIN_NAMES: [&str; 5] = ["none", "2.6", "4.6", "6.6", "8.6"];

impl Phantom {
    /// One of the paper's five phantoms (§3, §3.1), by its name in [`BUILTIN_NAMES`].
    ///
    /// # Errors
    /// Any other name, with the list.
    ///
    /// Implements: PHA-001.
    pub fn builtin(name: &str) -> Result<Phantom, Refusal> {
        if !BUILTIN_NAMES.contains(&name) {
            let found = format!("no phantom named {name:?} is built in");
            let known = format!("{found}; built in are {}", BUILTIN_NAMES.join(", "));
            return Err(Refusal::state(known, ""));
        }
        let paper = Phantom::from_toml(include_str!("paper.toml"), "paper.toml");
        let mut phantom = paper.expect("a test reads this very text");
        phantom.0.name = name.into();
        match parse_scaled(name, -3) {
            Some(depth) => phantom.0.inclusions[0].depth = depth,
            None => phantom.0.inclusions.clear(),
        }
        Ok(phantom)
    }

    /// The phantom of these parts.
    ///
    /// # Errors
    /// The first offending key of the phantom file, its value and what is allowed, both in the unit of the file.
    ///
    /// Implements: PHA-004, CON-007.
    pub fn new(parts: PhantomParts) -> Result<Phantom, Refusal> {
        let phantom = Phantom(parts);
        phantom.check()?;
        Ok(phantom)
    }

    /// This phantom with other parts.
    ///
    /// # Errors
    /// As [`Phantom::new`].
    pub fn changed(&self, change: impl FnOnce(&mut PhantomParts)) -> Result<Phantom, Refusal> {
        let mut parts = self.0.clone();
        change(&mut parts);
        Phantom::new(parts)
    }

    /// This phantom without inclusions.
    pub fn without_inclusions(&self) -> Phantom {
        let inclusions = Vec::new();
        Phantom(PhantomParts {
            inclusions,
            ..self.0.clone()
        })
    }

    /// A name for tables and figures.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// The theory that computes the forces.
    pub fn strain(&self) -> Strain {
        self.0.strain
    }

    /// What the cross-section stands for.
    pub fn geometry(&self) -> Geometry {
        self.0.geometry
    }

    /// The well.
    pub fn well(&self) -> &Well {
        &self.0.well
    }

    /// The layers, top to bottom.
    pub fn layers(&self) -> &[Layer] {
        &self.0.layers
    }

    /// The inclusions; none for a plain gel.
    pub fn inclusions(&self) -> &[Inclusion] {
        &self.0.inclusions
    }

    /// What layers and inclusions are made of, in their order.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        let layers = self.layers().iter().map(|layer| &layer.material);
        layers.chain(self.inclusions().iter().map(|of| &of.material))
    }

    /// The probe.
    pub fn probe(&self) -> Probe {
        self.0.probe
    }

    /// Height of the outer surface above the floor, m.
    ///
    /// Implements: PHA-008.
    pub fn height(&self) -> f64 {
        self.layers().iter().map(|layer| layer.thickness).sum()
    }

    /// The depth of the highest point of all inclusions, m; `None` without any.
    pub fn inclusion_depth(&self) -> Option<f64> {
        let depths = self.inclusions().iter().map(|inclusion| inclusion.depth);
        depths.reduce(f64::min)
    }

    /// y of the top of each layer and of the floor, m: 0 first, then negative.
    pub fn levels(&self) -> Vec<f64> {
        let mut levels = vec![0.0];
        for layer in self.layers() {
            levels.push(levels[levels.len() - 1] - layer.thickness);
        }
        levels
    }

    /// Whether the phantom is its own mirror image in x, to the bit: each inclusion is on the axis and symmetric, or has a
    /// mirror image of the same material; no fibres are oblique; and the probe does not rub, for that has a direction.
    ///
    /// Implements: PHA-019.
    pub fn is_symmetric(&self) -> bool {
        self.has_mirror_image() && self.mirror_images().len() == self.inclusions().len()
    }

    /// Whether there is a mirror image in x, as far as materials and friction go.
    fn has_mirror_image(&self) -> bool {
        self.probe().friction == 0.0 && self.materials().all(Material::is_symmetric)
    }

    /// Whether the phantoms differ in name and materials alone, such that they have the same mesh.
    pub(crate) fn is_meshed_as(&self, other: &Phantom) -> bool {
        let mut alike = self.clone();
        alike.0.name.clone_from(&other.0.name);
        let own = alike.0.materials_mut();
        own.zip(other.materials())
            .for_each(|(own, other)| *own = *other);
        alike == *other && self.is_symmetric() == other.is_symmetric()
    }

    /// The number of each inclusion's mirror image; fewer numbers than inclusions where one has none.
    pub fn mirror_images(&self) -> Vec<usize> {
        let image = |inclusion: &Inclusion| {
            let mirrored = inclusion.outline().mirrored();
            self.inclusions().iter().position(|other| {
                other.material == inclusion.material && mirrored.is_same(&other.outline())
            })
        };
        self.inclusions().iter().filter_map(image).collect()
    }

    /// The phantom seen from behind: its mirror image in x. `None` where an inclusion is no mirror image of itself but for its
    /// place.
    pub fn mirror_image(&self) -> Option<Phantom> {
        if !self.has_mirror_image() {
            return None;
        }
        let mut image = self.clone();
        for inclusion in &mut image.0.inclusions {
            let place = std::mem::take(&mut inclusion.centre_x);
            let outline = inclusion.outline();
            if !outline.clone().mirrored().is_same(&outline) {
                return None;
            }
            // Subtracted from zero, since the negative of +0 would be −0.
            inclusion.centre_x = 0.0 - place;
        }
        Some(image)
    }
}
