//! The phantom: a well of gel under a rubber skin, a hard inclusion in it or none, and the probe
//! that presses on it (paper §3). All lengths are metres, moduli pascals.

/// A linear isotropic elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
}

/// The block of gel that fills the well, bonded to its floor and walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gel {
    /// Width of the well, m.
    pub width: f64,
    /// Height of the gel without the skin, m.
    pub height: f64,
    /// What the gel is made of.
    pub material: Material,
}

/// The rubber layer on top of the gel, bonded to the gel and, at its edges, to the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skin {
    /// Thickness, m.
    pub thickness: f64,
    /// What the skin is made of.
    pub material: Material,
}

/// A solid disc (a cylinder along the probe), centred at x = 0 and bonded to the gel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inclusion {
    /// Diameter, m.
    pub diameter: f64,
    /// Depth of the disc's top below the outer surface of the skin, m.
    pub depth: f64,
    /// What the disc is made of.
    pub material: Material,
}

/// The rigid, frictionless, semicylindrical probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probe {
    /// Radius, m.
    pub radius: f64,
    /// Length along the cylinder, m: forces are totals over it.
    pub length: f64,
}

/// Everything that fixes the force on the probe, but for the probe's position.
#[derive(Debug, Clone, PartialEq)]
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
