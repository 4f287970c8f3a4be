//! Force maps: the force on the probe over a grid of depths and lateral positions, where it comes
//! from, and the files that keep it (paper §3, §4).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the map: forces and their source |
//! | `table.rs` | axes and matrices; symmetry, difference, one depth |
//! | `sweep.rs` | the forces between the poses, along a sweep |
//! | `interpolation.rs` | the paper's rule between and beyond the poses |
//! | `pair.rs` | whether two maps are one gel without and with an inclusion |
//! | `certificate.rs` | the quality of a computed map |
//! | `error.rs` | what can be wrong |
//! | `file.rs`, `json.rs`, `csv.rs` | files |
//!
//! ```
//! use palpate::force_map::ForceMap;
//!
//! // Two measured maps over one depth and x = 0, 2, 4 mm, and the signal of the paper's §2.
//! let map = |normal: [f64; 3]| {
//!     let mut text = String::from("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n");
//!     for (column, normal) in normal.iter().enumerate() {
//!         text += &format!("4,{},{normal},0\n", 2 * column);
//!     }
//!     ForceMap::from_csv(&text, "sweep.csv", "", None)
//! };
//! let signal = map([1.75, 1.5, 1.5])?.signal(&map([1.5, 1.5, 1.5])?)?;
//! assert_eq!(signal.row(0.004)?.normal_force, [0.25, 0.0, 0.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod certificate;
mod csv;
mod error;
mod file;
mod interpolation;
mod json;
mod pair;
mod sweep;
mod table;
#[cfg(test)]
mod tests;

pub use certificate::{Certificate, Discretization, SmallestDet};
pub use error::InvalidForceMap;
pub use file::{ForceMapFileError, ForceMapFileProblem};
pub use interpolation::ProbeForce;
#[cfg(feature = "oracle")]
pub(crate) use interpolation::interpolate;
pub use json::{SCHEMA, SCHEMA_VERSION};
pub use pair::Unpaired;
pub use sweep::Sweep;
pub use table::{ForceCurve, ForceTable, Matrix, SAME_POSITION, SYMMETRY_TOLERANCE};

use crate::phantom::Phantom;

/// Where the forces of a map come from.
///
/// ```
/// use palpate::force_map::{ForceMap, Source};
///
/// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n";
/// let map = ForceMap::from_csv(text, "folder/gel.csv", "third gel", None)?;
/// let (file, note) = ("gel.csv".into(), "third gel".into());
/// assert_eq!(map.source(), &Source::Measured { file, note });
/// # Ok::<(), palpate::force_map::ForceMapFileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a map has one")]
pub enum Source {
    /// Computed by this program's finite elements.
    FiniteElements {
        /// How good the computation was.
        certificate: Certificate,
    },
    /// Measured on a gel, as the paper's §3.2.
    Measured {
        /// The file that the measurement came in.
        file: String,
        /// Whatever else is known of it.
        note: String,
    },
}

/// The force on the probe at every pose of a grid, and where it comes from.
///
/// ```
/// use palpate::force_map::{ForceMap, ForceTable, Matrix, Source};
/// use palpate::phantom::Phantom;
///
/// let matrix = |values: [f64; 4]| Matrix::from_fn(2, 2, |row, column| values[2 * row + column]);
/// let (normal, lateral) = (matrix([0.25, 0.25, 1.5, 1.25]), matrix([0.0, 0.0, 0.0, -0.125]));
/// let forces = ForceTable::new(vec![0.001, 0.004], vec![0.0, 0.005], normal, lateral)?;
/// let source = Source::Measured { file: "gel.csv".into(), note: "".into() };
/// let map = ForceMap::new(source, Some(Phantom::builtin("6.6")?), forces)?;
///
/// assert_eq!((map.depths(), map.laterals()), (&[0.001, 0.004][..], &[0.0, 0.005][..]));
/// assert_eq!(map.normal_force().row(1), [1.5, 1.25]);
/// assert_eq!(map.lateral_force().values(), [0.0, 0.0, 0.0, -0.125]);
/// assert_eq!(map.forces().row(0.004)?, map.row(0.004)?);
/// // Measured, by this version, on a phantom that is known.
/// assert!(map.certificate().is_none() && matches!(map.source(), Source::Measured { .. }));
/// assert_eq!(map.program_version(), env!("CARGO_PKG_VERSION"));
/// assert!(map.phantom().is_some_and(|phantom| phantom.name == "6.6"));
/// // The normal force is even in x, the lateral force odd.
/// let whole = map.mirrored()?;
/// assert_eq!(whole.row(0.004)?.lateral_force, [0.125, 0.0, -0.125]);
/// assert_eq!(whole.at_laterals(&[0.0, 0.005])?, map);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: MAP-001, MAP-008.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceMap {
    program_version: String,
    source: Source,
    phantom: Option<Phantom>,
    forces: ForceTable,
}

impl ForceMap {
    /// A map of `forces`, made by this version of the program.
    ///
    /// # Errors
    /// [`InvalidForceMap`] if the phantom is missing for a computed map, is not valid, or does not
    /// let the probe stand at one of the poses, or if the certificate does not fit the forces.
    ///
    /// Implements: MAP-006, MAP-007, MAP-008.
    pub fn new(
        source: Source,
        phantom: Option<Phantom>,
        forces: ForceTable,
    ) -> Result<ForceMap, InvalidForceMap> {
        let program_version = env!("CARGO_PKG_VERSION").into();
        ForceMap::by_version(program_version, source, phantom, forces)
    }

    /// [`ForceMap::new`] for a map that another version made.
    fn by_version(
        program_version: String,
        source: Source,
        phantom: Option<Phantom>,
        forces: ForceTable,
    ) -> Result<ForceMap, InvalidForceMap> {
        if let Source::FiniteElements { certificate } = &source {
            certificate.check(forces.depths(), forces.laterals())?;
            if phantom.is_none() {
                return Err(InvalidForceMap::NoPhantom);
            }
        }
        if let Some(phantom) = &phantom {
            phantom.validate()?;
            for &depth in forces.depths() {
                for &lateral in forces.laterals() {
                    phantom.check_pose(depth, lateral)?;
                }
            }
        }
        Ok(ForceMap {
            program_version,
            source,
            phantom,
            forces,
        })
    }

    /// This computed map with bands of the discretisation in its certificate; a measured map as it is.
    ///
    /// ```
    /// use palpate::force_map::{Discretization, ForceMap, Matrix};
    ///
    /// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n";
    /// let map = ForceMap::from_csv(text, "gel.csv", "", None)?;
    /// // Bands of a mesh say nothing of what was measured.
    /// let band = |value| Matrix::from_fn(1, 1, |_, _| value);
    /// let bands = Discretization {
    ///     nodes: [4000, 1000, 250],
    ///     normal_force_band: band(0.002),
    ///     lateral_force_band: band(0.0),
    /// };
    /// assert_eq!(map.clone().with_discretization(bands)?, map);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidForceMap::Shape`], [`InvalidForceMap::Band`].
    ///
    /// Implements: MAP-050, MAP-051.
    pub fn with_discretization(
        mut self,
        discretization: Discretization,
    ) -> Result<ForceMap, InvalidForceMap> {
        if let Source::FiniteElements { certificate } = &mut self.source {
            certificate.discretization = Some(discretization);
            certificate.check(self.forces.depths(), self.forces.laterals())?;
        }
        Ok(self)
    }

    /// The version of the program that made the map.
    pub fn program_version(&self) -> &str {
        &self.program_version
    }

    /// Where the forces come from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The evidence for a computed map; `None` for a measured one.
    pub fn certificate(&self) -> Option<&Certificate> {
        match &self.source {
            Source::FiniteElements { certificate } => Some(certificate),
            Source::Measured { .. } => None,
        }
    }

    /// The phantom under the probe; a measured map may not know it.
    pub fn phantom(&self) -> Option<&Phantom> {
        self.phantom.as_ref()
    }

    /// Axes and forces.
    pub fn forces(&self) -> &ForceTable {
        &self.forces
    }

    /// Depths of the rows, m, increasing.
    pub fn depths(&self) -> &[f64] {
        self.forces.depths()
    }

    /// Lateral positions of the columns, m, increasing.
    pub fn laterals(&self) -> &[f64] {
        self.forces.laterals()
    }

    /// Normal forces, N, positive where they push the probe up; depths × lateral positions.
    pub fn normal_force(&self) -> &Matrix {
        self.forces.normal_force()
    }

    /// Lateral forces on the probe along +x, N; depths × lateral positions.
    pub fn lateral_force(&self) -> &Matrix {
        self.forces.lateral_force()
    }

    /// The forces at a stored depth (m): see [`ForceTable::row`].
    ///
    /// # Errors
    /// [`InvalidForceMap::NoSuchDepth`].
    pub fn row(&self, depth: f64) -> Result<ForceCurve<'_>, InvalidForceMap> {
        self.forces.row(depth)
    }

    /// The forces of this map minus those of `reference`: see [`ForceTable::minus`].
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let map = |force: f64| {
    ///     let text = format!("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,{force},0\n");
    ///     ForceMap::from_csv(&text, "gel.csv", "", None)
    /// };
    /// assert_eq!(map(1.75)?.signal(&map(1.5)?)?.normal_force().values(), [0.25]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidForceMap::AxesDiffer`], [`InvalidForceMap::Force`].
    pub fn signal(&self, reference: &ForceMap) -> Result<ForceTable, InvalidForceMap> {
        self.forces.minus(&reference.forces)
    }

    /// This map over x ≥ 0, extended to x < 0 by symmetry: see [`ForceTable::mirrored`].
    ///
    /// ```
    /// use palpate::force_map::ForceMap;
    ///
    /// let text = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n4,0,1.5,0\n4,2,1.25,-0.125\n";
    /// let whole = ForceMap::from_csv(text, "gel.csv", "", None)?.mirrored()?;
    /// assert_eq!(whole.laterals(), [-0.002, 0.0, 0.002]);
    /// assert_eq!(whole.row(0.004)?.normal_force, [1.25, 1.5, 1.25]);
    /// assert_eq!(whole.row(0.004)?.lateral_force, [0.125, 0.0, -0.125]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`InvalidForceMap::AsymmetricPhantom`], [`InvalidForceMap::NotFromZero`], [`InvalidForceMap::NotSymmetric`].
    pub fn mirrored(&self) -> Result<ForceMap, InvalidForceMap> {
        if let Some(phantom) = self.phantom.as_ref().filter(|p| !p.is_symmetric()) {
            let name = phantom.name.clone();
            return Err(InvalidForceMap::AsymmetricPhantom { name });
        }
        let source = match &self.source {
            Source::FiniteElements { certificate } => Source::FiniteElements {
                certificate: certificate.mirrored(),
            },
            measured => measured.clone(),
        };
        ForceMap::by_version(
            self.program_version.clone(),
            source,
            self.phantom.clone(),
            self.forces.mirrored()?,
        )
    }

    /// The columns of this map at some of its lateral positions (m).
    ///
    /// # Errors
    /// [`InvalidForceMap::NoSuchLateral`] for a position that the map does not hold.
    ///
    /// Implements: MAP-016.
    pub fn at_laterals(&self, laterals: &[f64]) -> Result<ForceMap, InvalidForceMap> {
        if laterals == self.laterals() {
            return Ok(self.clone());
        }
        let columns = self.forces.columns_at(laterals)?;
        let source = match &self.source {
            Source::FiniteElements { certificate } => Source::FiniteElements {
                certificate: certificate.at_columns(&columns, self.depths(), laterals)?,
            },
            measured => measured.clone(),
        };
        ForceMap::by_version(
            self.program_version.clone(),
            source,
            self.phantom.clone(),
            self.forces.at_columns(&columns)?,
        )
    }
}
