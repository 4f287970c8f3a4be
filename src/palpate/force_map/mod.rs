//! Force maps: the force on the probe over a grid of depths and lateral positions, where it comes
//! from, and the files that keep it (paper §3, §4).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | the map: forces and their source |
//! | `table.rs` | axes and matrices; symmetry, difference, one depth |
//! | `interpolation.rs` | forces between and beyond the poses |
//! | `pair.rs` | whether two maps are one gel without and with an inclusion |
//! | `certificate.rs` | the quality of a computed map |
//! | `grid.rs` | measured forces at any poses, put on a grid |
//! | `smoothing.rs` | measured forces with less of their noise |
//! | `json.rs`, `csv.rs` | files |
//!
//! ```
//! use palpate::force_map::ForceTable;
//!
//! // Two measured tables over one depth and x = 0, 2, 4 mm, and the signal of the paper's §2.
//! let map = |normal: [f64; 3]| {
//!     let mut text = String::from("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n");
//!     for (column, normal) in normal.iter().enumerate() {
//!         text += &format!("4,{},{normal},0\n", 2 * column);
//!     }
//!     ForceTable::from_csv(&text, "sweep.csv")
//! };
//! let signal = map([1.75, 1.5, 1.5])?.minus(&map([1.5, 1.5, 1.5])?)?;
//! assert_eq!(signal.row(0.004)?.normal, [0.25, 0.0, 0.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod certificate;
mod csv;
mod grid;
mod interpolation;
mod json;
mod pair;
mod smoothing;
mod table;
#[cfg(test)]
pub(crate) mod tests;

use std::path::Path;

use serde::{Deserialize, Serialize};

pub use certificate::{Certificate, Discretization, SmallestDet};
pub use grid::{Gridded, gridded};
pub use interpolation::interpolate;
pub(crate) use interpolation::{Place, Stencil, shallowest};
pub use json::{SCHEMA, SCHEMA_VERSION};
pub use pair::Hypotheses;
pub(crate) use pair::check_gel;
pub use smoothing::Smoothed;
pub use table::{ForceTable, Matrix, SAME_POSITION, SYMMETRY_TOLERANCE, peak};
pub(crate) use table::{check_axes, increasing};

use crate::csv::Layout;
use crate::phantom::Phantom;
use crate::refusal::Refusal;

/// Where the forces of a map come from.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a map has one")]
pub enum Source {
    /// Computed by this program's finite elements.
    FiniteElements {
        /// How good the computation was.
        certificate: Certificate,
    },
    /// Measured on a gel, as the paper's §3.2.
    Measured(Measurement),
}

/// Where measured forces come from.
///
/// Implements: MAP-020, MAP-074, MAP-082.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// The file that they came in.
    pub file: String,
    /// Whatever else is known of them.
    pub note: String,
    /// Half-width, m, of the parabolas that smoothed them, above 0; `None` if nothing was smoothed.
    #[serde(
        rename = "smoothed_half_width_m",
        default,
        skip_serializing_if = "Option::is_none"
    )]
    pub smoothed_half_width: Option<f64>,
    /// The steps of depth and lateral position, m, of the grid that the samples were put on; `None` if they were on one.
    #[serde(rename = "grid_m", default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<[f64; 2]>,
}

impl Measurement {
    /// Forces that came in `file`, of which the name without its folder counts, as they are.
    pub fn new(file: &str, note: &str) -> Measurement {
        let name = Path::new(file).file_name().unwrap_or_default();
        Measurement {
            file: name.to_string_lossy().into_owned(),
            note: note.into(),
            smoothed_half_width: None,
            grid: None,
        }
    }
}

/// The force on the probe at every pose of a grid, and where it comes from.
///
/// ```
/// use palpate::force::Force;
/// use palpate::force_map::{ForceMap, ForceTable, Matrix, Measurement, Source};
/// use palpate::phantom::Phantom;
///
/// let matrix = |values: [f64; 4]| Matrix::from_fn(2, 2, |row, column| values[2 * row + column]);
/// let (normal, lateral) = (matrix([0.25, 0.25, 1.5, 1.25]), matrix([0.0, 0.0, 0.0, -0.125]));
/// let forces = ForceTable::new(vec![0.001, 0.004], vec![0.0, 0.005], Force::new(lateral, normal))?;
/// let source = Source::Measured(Measurement::new("lab/gel.csv", ""));
/// let map = ForceMap::new(source, Some(Phantom::builtin("6.6")?), forces)?;
///
/// assert_eq!((map.table().depths(), map.table().laterals()), (&[0.001, 0.004][..], &[0.0, 0.005][..]));
/// assert_eq!(map.table().normal().row(1), [1.5, 1.25]);
/// assert_eq!(map.table().both()?.lateral.values(), [0.0, 0.0, 0.0, -0.125]);
/// // Measured, by this version, on a phantom that is known.
/// assert!(map.certificate().is_none() && matches!(map.source(), Source::Measured(_)));
/// assert_eq!(map.program_version(), env!("CARGO_PKG_VERSION"));
/// assert!(map.phantom().is_some_and(|phantom| phantom.name() == "6.6"));
/// // The normal force is even in x, the lateral force odd.
/// let whole = map.mirrored()?;
/// assert_eq!(whole.table().row(0.004)?.lateral, [0.125, 0.0, -0.125]);
/// assert_eq!(whole.at_laterals(&[0.0, 0.005])?, map);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: MAP-001, MAP-002.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "json::Document", try_from = "json::Document")]
pub struct ForceMap {
    program_version: String,
    source: Source,
    phantom: Option<Phantom>,
    table: ForceTable,
}

impl ForceMap {
    /// A map of `table`, made by this version of the program.
    ///
    /// # Errors
    /// The phantom or the lateral forces are missing for a computed map, or the phantom does not let the probe stand at one of the poses; the
    /// certificate does not fit the forces; the half-width of a smoothing is not above 0.
    ///
    /// Implements: MAP-006, MAP-002, MAP-074.
    pub fn new(
        source: Source,
        phantom: Option<Phantom>,
        table: ForceTable,
    ) -> Result<ForceMap, Refusal> {
        ForceMap::of_version(env!("CARGO_PKG_VERSION").into(), source, phantom, table)
    }

    /// A map made by any version of the program.
    fn of_version(
        program_version: String,
        source: Source,
        phantom: Option<Phantom>,
        table: ForceTable,
    ) -> Result<ForceMap, Refusal> {
        match &source {
            Source::FiniteElements { certificate } => {
                certificate.check(table.depths(), table.laterals())?;
                let expected = "give the phantom that the finite elements computed";
                Refusal::state("phantom is missing", expected).when(phantom.is_none())?;
                let expected = "give both forces of a computed map";
                let missing = Refusal::state("lateral_force_n is missing", expected);
                missing.when(table.lateral().is_none())?;
            }
            Source::Measured(of) => {
                if let Some(width) = of.smoothed_half_width {
                    let is_right = width > 0.0 && width.is_finite();
                    let key = "source.smoothed_half_width_m";
                    Refusal::value(key, width, "a finite number above 0").when(!is_right)?;
                }
                for step in of.grid.iter().flatten() {
                    let is_right = *step > 0.0 && step.is_finite();
                    let refusal = Refusal::value("source.grid_m", step, "finite numbers above 0");
                    refusal.when(!is_right)?;
                }
            }
        }
        if let Some(phantom) = &phantom {
            for &depth in table.depths() {
                for &lateral in table.laterals() {
                    let stands = phantom.check_pose(depth, lateral);
                    stands.map_err(|refusal| refusal.of_part("phantom"))?;
                }
            }
        }
        Ok(ForceMap {
            program_version,
            source,
            phantom,
            table,
        })
    }

    /// This computed map with bands of the discretisation in its certificate; a measured map as it is, for bands of a mesh say
    /// nothing of it.
    ///
    /// # Errors
    /// Bands of another shape than the forces, not finite or negative.
    ///
    /// Implements: MAP-006, MAP-002.
    pub fn with_discretization(
        mut self,
        discretization: Discretization,
    ) -> Result<ForceMap, Refusal> {
        if let Source::FiniteElements { certificate } = &mut self.source {
            discretization.check([self.table.depths().len(), self.table.laterals().len()])?;
            certificate.discretization = Some(discretization);
        }
        Ok(self)
    }

    /// Reads the map at `path`: measured forces if its name ends in `.csv`, else JSON.
    ///
    /// # Errors
    /// As [`ForceTable::from_csv`], [`ForceMap::new`] and [`ForceMap::from_json`]; a file that cannot be read as UTF-8.
    ///
    /// Implements: MAP-026.
    pub fn read(path: &Path) -> Result<ForceMap, Refusal> {
        Ok(ForceMap::read_as(path, None)?.0)
    }

    /// As [`ForceMap::read`], of CSV in this layout where the user may state one, and what a person should know of how it was read.
    ///
    /// # Errors
    /// As [`ForceMap::read`] and [`ForceTable::from_csv_with_notes`].
    ///
    /// Implements: MAP-026, MAP-044, MAP-046.
    pub fn read_as(
        path: &Path,
        layout: Option<&Layout>,
    ) -> Result<(ForceMap, Vec<String>), Refusal> {
        let is_csv = |extension: &std::ffi::OsStr| extension.eq_ignore_ascii_case("csv");
        let is_csv = path.extension().is_some_and(is_csv);
        crate::file::read(path, |text, file| {
            if !is_csv {
                return Ok((ForceMap::from_json(text, file)?, Vec::new()));
            }
            let (forces, notes) = ForceTable::from_csv_with_notes(text, file, layout)?;
            let source = Source::Measured(Measurement::new(file, ""));
            let map = ForceMap::new(source, None, forces);
            Ok((map.map_err(|refusal| refusal.in_file(file))?, notes))
        })
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
            Source::Measured(_) => None,
        }
    }

    /// The phantom under the probe; a measured map may not know it.
    pub fn phantom(&self) -> Option<&Phantom> {
        self.phantom.as_ref()
    }

    /// Axes and forces.
    pub fn table(&self) -> &ForceTable {
        &self.table
    }

    /// The forces of this map minus those of `reference`: see [`ForceTable::minus`].
    ///
    /// # Errors
    /// Other axes, or a difference that is not finite.
    pub fn signal(&self, reference: &ForceMap) -> Result<ForceTable, Refusal> {
        self.table.minus(&reference.table)
    }

    /// This map over x ≥ 0, extended to x < 0 by symmetry: see [`ForceTable::mirrored`].
    ///
    /// # Errors
    /// A phantom that is not its own mirror image; as [`ForceTable::mirrored`].
    pub fn mirrored(&self) -> Result<ForceMap, Refusal> {
        if let Some(phantom) = self.phantom.as_ref().filter(|p| !p.is_symmetric()) {
            return Err(Refusal::state(
                format!("phantom {:?} is not its own mirror image", phantom.name()),
                "give a map over negative lateral positions too: it cannot be extended by symmetry",
            ));
        }
        Ok(ForceMap {
            table: self.table.mirrored()?,
            source: self.source_at(&self.table.mirror_columns()),
            ..self.clone()
        })
    }

    /// This map over all lateral positions: extended by symmetry if it begins at x = 0.
    ///
    /// # Errors
    /// As [`ForceMap::mirrored`].
    ///
    /// Implements: MAP-092.
    pub fn whole(&self) -> Result<ForceMap, Refusal> {
        match self.table.laterals() {
            [first, _, ..] if first.abs() <= SAME_POSITION => self.mirrored(),
            _ => Ok(self.clone()),
        }
    }

    /// The map of the mirror image of this map's phantom, over the negatives of its lateral positions.
    ///
    /// # Errors
    /// No phantom; one with an inclusion that is not the mirror image of itself but for its place.
    ///
    /// Implements: MAP-009.
    pub fn mirror_image(&self) -> Result<ForceMap, Refusal> {
        let phantom = self.phantom.as_ref().and_then(Phantom::mirror_image);
        let phantom = phantom.ok_or_else(|| {
            let found = "no phantom, or one with friction, oblique fibres or an inclusion that is not symmetric";
            Refusal::state(found, "give a phantom to take the mirror image of")
        })?;
        let mut map = ForceMap {
            phantom: Some(phantom),
            ..self.clone()
        };
        let columns: Vec<usize> = (0..self.table.laterals().len()).rev().collect();
        map.table = self.table.mirror_image(&columns);
        map.source = self.source_at(&columns);
        if let Source::FiniteElements { certificate } = &mut map.source {
            let smallest = &mut certificate.smallest_det;
            smallest.lateral = 0.0 - smallest.lateral;
        }
        Ok(map)
    }

    /// The columns of this map at some of its lateral positions (m).
    ///
    /// # Errors
    /// A position that the map does not hold.
    ///
    /// Implements: MAP-012.
    pub fn at_laterals(&self, laterals: &[f64]) -> Result<ForceMap, Refusal> {
        if laterals == self.table().laterals() {
            return Ok(self.clone());
        }
        let columns = self.table.columns_at(laterals)?;
        let mut map = ForceMap {
            table: self.table.at_columns(&columns)?,
            source: self.source_at(&columns),
            ..self.clone()
        };
        if let Source::FiniteElements { certificate } = &mut map.source {
            let smallest = SmallestDet::of(&certificate.min_det, self.table().depths(), laterals);
            certificate.smallest_det = smallest.unwrap_or(certificate.smallest_det);
        }
        Ok(map)
    }

    /// The source with some of the columns of its certificate.
    fn source_at(&self, columns: &[usize]) -> Source {
        match &self.source {
            Source::FiniteElements { certificate } => Source::FiniteElements {
                certificate: certificate.at_columns(columns),
            },
            measured => measured.clone(),
        }
    }
}
