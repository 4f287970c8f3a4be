//! From a force map in f64 to a table of the kernel in f32.

mod rotation;

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::passivity::{Damping, stiffness};
use super::{Axis, Force, InvalidAxis, InvalidTable, MAX_KNOTS, MIN_WIDTH, POSITION_LIMIT};
use super::{Limits, TABLE_FORCE_LIMIT, Table};
use crate::force_map::{ForceTable, Matrix};
use rotation::{largest_component, rotation};

/// Largest force at the surface, N, that counts as none: the noise of the paper's sensor (Table 2).
pub const SURFACE_FORCE: f64 = 0.02;

/// The fastest hand, m/s, for which a table is accepted: a quick probing motion. The slew limit lets the force follow up to here.
pub const HAND_SPEED: f64 = 0.2;

/// The largest differences between a map and its table.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RoundingError {
    /// Of a position, m.
    pub position_m: f64,
    /// Of a force, N.
    pub force_n: f64,
}

/// A table of the kernel with its storage.
///
/// ```
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::servo::LoadedTable;
///
/// // 0.5 N at 1 mm and 1 N at 2 mm, with a lateral force to the right on the right.
/// let normal = Matrix::from_fn(2, 3, |row, _| 0.5 * (row + 1) as f64);
/// let lateral = Matrix::from_fn(2, 3, |_, column| 0.25 * (column as f64 - 1.0));
/// let map = ForceTable::new(vec![1e-3, 2e-3], vec![-5e-3, 0.0, 5e-3], normal, lateral)?;
///
/// let loaded = LoadedTable::new(&map)?;
/// assert!(loaded.rounding().position_m < 1e-9);
/// let table = loaded.table()?;
/// assert_eq!(table.force(2e-3, 5e-3).lateral, 0.25);
/// assert_eq!(table.depths().knots()[0], 0.0); // the surface, which the map does not hold
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedTable {
    depths: Vec<f32>,
    laterals: Vec<f32>,
    reciprocal_heights: Vec<f32>,
    reciprocal_widths: Vec<f32>,
    forces: Vec<Force>,
    rounding: RoundingError,
}

/// Why a map can not be played. Rows and columns are the map's, from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// An axis has too few or too many entries.
    #[error("{key} has {found} entries for the servo, expected 2 to {MAX_KNOTS}")]
    Knots {
        /// The axis.
        key: &'static str,
        /// How many there are, with the surface in front.
        found: usize,
    },
    /// A position is too far out.
    #[error("{key}[{index}] = {value}, expected at most ±{POSITION_LIMIT} m for the servo")]
    Position {
        /// The axis.
        key: &'static str,
        /// Which entry.
        index: usize,
        /// Its value, m.
        value: f64,
    },
    /// Two positions are too close.
    #[error(
        "{key}[{index}] = {value}, expected at least {MIN_WIDTH:e} m above the one before, {previous}, for the servo"
    )]
    Width {
        /// The axis.
        key: &'static str,
        /// Which entry.
        index: usize,
        /// The entry before it (the surface, 0, before the first depth), m.
        previous: f64,
        /// Its value, m.
        value: f64,
    },
    /// A force is too large.
    #[error(
        "{key}[{row}][{column}] = {value}, expected at most ±{TABLE_FORCE_LIMIT} N for the servo"
    )]
    Force {
        /// The matrix.
        key: &'static str,
        /// The row.
        row: usize,
        /// The column.
        column: usize,
        /// Its value, N.
        value: f64,
    },
    /// There is a force where the probe touches nothing.
    #[error(
        "{key}[0][{column}] = {value} at depth 0, expected at most ±{SURFACE_FORCE} N, since nothing is touched there"
    )]
    SurfaceForce {
        /// The matrix.
        key: &'static str,
        /// The column.
        column: usize,
        /// Its value, N.
        value: f64,
    },
    /// The numbers that describe the device are none.
    #[error(
        "{0:?}: expected period and resolution above 0, damping and friction at least 0, all finite"
    )]
    Damping(Damping),
    /// The device would give energy out with the table.
    #[error(
        "the table has {found:.4} {what}, and the device plays at most {allowed:.4} passively: scale the forces by {scale:.4}"
    )]
    NotPassive {
        /// What is too large, with its unit.
        what: &'static str,
        /// The table's.
        found: f64,
        /// What the device and the limits allow.
        allowed: f64,
        /// The factor on the forces that would fit.
        scale: f64,
    },
    /// The kernel refuses what was loaded: a defect of this program.
    #[error("the servo refuses the table as loaded ({0}): this is a defect of the program")]
    Refused(String),
}

impl From<InvalidAxis> for LoadError {
    fn from(refusal: InvalidAxis) -> LoadError {
        LoadError::Refused(format!("{refusal:?}"))
    }
}

impl From<InvalidTable> for LoadError {
    fn from(refusal: InvalidTable) -> LoadError {
        LoadError::Refused(format!("{refusal:?}"))
    }
}

impl LoadedTable {
    /// The table of a map's forces, each rounded to f32, with the surface in front if the map does
    /// not begin there.
    ///
    /// # Errors
    /// [`LoadError`].
    ///
    /// Implements: SRV-044, SRV-045, SRV-046, SRV-047.
    pub fn new(map: &ForceTable) -> Result<LoadedTable, LoadError> {
        check_forces("lateral_force_n", map.lateral_force(), map.depths())?;
        check_forces("normal_force_n", map.normal_force(), map.depths())?;
        let mut rounding = RoundingError::default();
        let surface = map.depths().first().is_some_and(|&first| first > 0.0);
        let depths = knots("depths_m", surface, map.depths(), &mut rounding)?;
        let laterals = knots("laterals_m", false, map.laterals(), &mut rounding)?;

        let rows_in_front = if surface { laterals.len() } else { 0 };
        let mut forces = vec![Force::ZERO; rows_in_front];
        let normal = map.normal_force().values();
        for (&lateral, &normal) in map.lateral_force().values().iter().zip(normal) {
            forces.push(Force {
                lateral: rounded(lateral, &mut rounding.force_n),
                normal: rounded(normal, &mut rounding.force_n),
            });
        }
        let loaded = LoadedTable {
            reciprocal_heights: reciprocals(&depths),
            reciprocal_widths: reciprocals(&laterals),
            depths,
            laterals,
            forces,
            rounding,
        };
        loaded.table()?;
        Ok(loaded)
    }

    /// The table of a map for a device that must play it passively within `limits`.
    ///
    /// # Errors
    /// [`LoadError`], among them [`LoadError::NotPassive`].
    ///
    /// Implements: SRV-051.
    pub fn passive(
        map: &ForceTable,
        damping: &Damping,
        limits: &Limits,
    ) -> Result<LoadedTable, LoadError> {
        let loaded = LoadedTable::new(map)?;
        loaded.check_passive(damping, limits)?;
        Ok(loaded)
    }

    /// Like [`LoadedTable::passive`], but a table that is not passive is scaled down. Also returns the
    /// factor on its forces, 1 if none was needed.
    ///
    /// # Errors
    /// [`LoadError`]; [`LoadError::NotPassive`] only for a device that no spring suits.
    ///
    /// Implements: SRV-051.
    pub fn scaled_to_be_passive(
        map: &ForceTable,
        damping: &Damping,
        limits: &Limits,
    ) -> Result<(LoadedTable, f64), LoadError> {
        let loaded = LoadedTable::new(map)?;
        let fit = match loaded.check_passive(damping, limits) {
            Ok(()) => return Ok((loaded, 1.0)),
            Err(LoadError::NotPassive { scale, .. }) if scale > 0.0 => scale,
            Err(other) => return Err(other),
        };
        // Rounding the scaled forces may leave a slope a little too steep.
        let mut margin = 1e-7;
        loop {
            let factor = fit * (1.0 - margin);
            let scaled = loaded.scaled(factor);
            match scaled.check_passive(damping, limits) {
                Ok(()) => return Ok((scaled, factor)),
                Err(refusal) if margin > 0.5 => return Err(refusal),
                Err(_) => margin *= 2.0,
            }
        }
    }

    /// The table as the kernel takes it.
    ///
    /// # Errors
    /// [`LoadError::Refused`], which would be a defect of this program.
    pub fn table(&self) -> Result<Table<'_>, LoadError> {
        let depths = Axis::new(&self.depths, &self.reciprocal_heights)?;
        let laterals = Axis::new(&self.laterals, &self.reciprocal_widths)?;
        Ok(Table::new(depths, laterals, &self.forces)?)
    }

    /// The largest rounding errors of loading. Scaling is not counted.
    pub fn rounding(&self) -> RoundingError {
        self.rounding
    }

    /// This table with its forces multiplied by `factor`.
    fn scaled(&self, factor: f64) -> LoadedTable {
        let product = |force: f32| (f64::from(force) * factor) as f32;
        let mut scaled = self.clone();
        for force in &mut scaled.forces {
            force.lateral = product(force.lateral);
            force.normal = product(force.normal);
        }
        scaled
    }

    /// Refuses a table with which the device would give energy out, by what is worst.
    ///
    /// Implements: SRV-054, SRV-055, SRV-056.
    fn check_passive(&self, damping: &Damping, limits: &Limits) -> Result<(), LoadError> {
        let stiffest = damping.stiffest().ok_or(LoadError::Damping(*damping))?;
        let table = self.table()?;
        let stiffness = stiffness(&table);
        // A hand moves so far in a cycle, and is seen to move a step of each axis further.
        let motion = HAND_SPEED * damping.period_s + SQRT_2 * damping.resolution_m;
        let friction = rotation(&table) + stiffness * damping.resolution_m * FRAC_1_SQRT_2;
        let bounds = [
            ("N/m of stiffness", stiffness, stiffest),
            (
                "N of growth in a cycle",
                stiffness * motion,
                limits.slew().into(),
            ),
            (
                "N of force without a potential",
                friction,
                damping.friction_n,
            ),
            (
                "N of force",
                largest_component(&table),
                limits.force().into(),
            ),
        ];
        let mut worst = Ok(());
        let mut fit = 1.0;
        for (what, found, allowed) in bounds {
            let scale = allowed / found;
            if found > allowed && scale < fit {
                fit = scale;
                worst = Err(LoadError::NotPassive {
                    what,
                    found,
                    allowed,
                    scale,
                });
            }
        }
        worst
    }
}

/// Refuses forces that are too large, or that are there without a touch.
fn check_forces(key: &'static str, matrix: &Matrix, depths: &[f64]) -> Result<(), LoadError> {
    let surface = depths.first() == Some(&0.0);
    for (row, column, value) in matrix.entries() {
        if value.abs() > f64::from(TABLE_FORCE_LIMIT) {
            return Err(LoadError::Force {
                key,
                row,
                column,
                value,
            });
        }
        if surface && row == 0 && value.abs() > SURFACE_FORCE {
            return Err(LoadError::SurfaceForce { key, column, value });
        }
    }
    Ok(())
}

/// The knots of an axis in f32, with the surface (0) in front if it is missing.
fn knots(
    key: &'static str,
    surface: bool,
    axis: &[f64],
    rounding: &mut RoundingError,
) -> Result<Vec<f32>, LoadError> {
    let mut knots = Vec::with_capacity(axis.len() + 1);
    if surface {
        knots.push(0.0);
    }
    for (index, &value) in axis.iter().enumerate() {
        if value.abs() > f64::from(POSITION_LIMIT) {
            return Err(LoadError::Position { key, index, value });
        }
        let knot = rounded(value, &mut rounding.position_m);
        if let Some(&previous) = knots
            .last()
            .filter(|&&previous| knot - previous < MIN_WIDTH)
        {
            return Err(LoadError::Width {
                key,
                index,
                previous: f64::from(previous),
                value,
            });
        }
        knots.push(knot);
    }
    if !(2..=MAX_KNOTS).contains(&knots.len()) {
        let found = knots.len();
        return Err(LoadError::Knots { key, found });
    }
    Ok(knots)
}

/// The reciprocal width of each cell, 1/m.
fn reciprocals(knots: &[f32]) -> Vec<f32> {
    let ends = knots.iter().zip(knots.iter().skip(1));
    ends.map(|(&start, &end)| Axis::reciprocal_width(start, end))
        .collect()
}

/// `value` in f32; its error counts towards the largest.
fn rounded(value: f64, largest: &mut f64) -> f32 {
    let rounded = value as f32;
    *largest = largest.max((f64::from(rounded) - value).abs());
    rounded
}

#[cfg(test)]
mod tests;
