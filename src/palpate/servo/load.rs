//! From a force map in f64 to a table of the kernel in f32.

mod rotation;

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use palpate_core::servo::{Axis, Damping, InvalidAxis, Limits, Table, stiffness};

use super::{MAX_KNOTS, MIN_WIDTH, POSITION_LIMIT, TABLE_FORCE_LIMIT};
use crate::force::Force;
use crate::force_map::{ForceTable, Matrix};
use crate::refusal::Refusal;
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

/// The knots of an axis as the kernel takes them, with the reciprocals of the distances between them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Knots {
    knots: Vec<f32>,
    reciprocals: Vec<f32>,
}

impl Knots {
    pub fn new(knots: Vec<f32>) -> Knots {
        let width = |ends: &[f32]| Axis::reciprocal_width(ends[0], ends[1]);
        let reciprocals = knots.windows(2).map(width).collect();
        Knots { knots, reciprocals }
    }

    pub fn axis(&self) -> Result<Axis<'_>, InvalidAxis> {
        Axis::new(&self.knots, &self.reciprocals)
    }
}

/// A table of the kernel with its storage.
///
/// ```
/// use palpate::force::Force;
/// use palpate::force_map::{ForceTable, Matrix};
/// use palpate::servo::LoadedTable;
///
/// // 0.5 N at 1 mm and 1 N at 2 mm, with a lateral force to the right on the right.
/// let normal = Matrix::from_fn(2, 3, |row, _| 0.5 * (row + 1) as f64);
/// let lateral = Matrix::from_fn(2, 3, |_, column| 0.25 * (column as f64 - 1.0));
/// let map = ForceTable::new(vec![1e-3, 2e-3], vec![-5e-3, 0.0, 5e-3], Force::new(lateral, normal))?;
///
/// let loaded = LoadedTable::new(&map)?;
/// assert!(loaded.rounding().position_m < 1e-9);
/// let table = loaded.table();
/// assert_eq!(table.force(2e-3, 5e-3).lateral, 0.25);
/// assert_eq!(table.depths().knots()[0], 0.0); // the surface, which the map does not hold
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedTable {
    depths: Knots,
    laterals: Knots,
    forces: Vec<Force<f32>>,
    rounding: RoundingError,
}

/// A bound that a table breaks, so that the device would give energy out with it.
struct Excess {
    /// What is too large, with its unit.
    what: &'static str,
    /// The table's.
    found: f64,
    /// What the device and the limits allow.
    allowed: f64,
}

impl Excess {
    /// The factor on the forces that would fit.
    fn scale(&self) -> f64 {
        self.allowed / self.found
    }

    fn refusal(&self) -> Refusal {
        let (what, found, allowed) = (self.what, self.found, self.allowed);
        let scale = self.scale();
        let remedy = match scale > 0.0 {
            true => format!("scale the forces by {scale:.4}"),
            false => "use a device with more damping and friction".into(),
        };
        let found = format!(
            "the table has {found:.4} {what}, where device and force limit allow {allowed:.4} at most"
        );
        Refusal::state(found, remedy)
    }
}

impl LoadedTable {
    /// The table of a map's forces, each rounded to f32, with the surface in front if the map does
    /// not begin there.
    ///
    /// # Errors
    /// Positions or forces that the kernel cannot hold, with row and column of the map, from 0; a force at the surface; a map of the
    /// normal force alone.
    ///
    /// Implements: SRV-044, SRV-047.
    pub fn new(map: &ForceTable) -> Result<LoadedTable, Refusal> {
        let Force { lateral, normal } = map.both()?;
        check_forces("lateral_force_n", lateral, map.depths())?;
        check_forces("normal_force_n", normal, map.depths())?;
        let mut rounding = RoundingError::default();
        let surface = map.depths().first().is_some_and(|&first| first > 0.0);
        let depths = knots("depths_m", surface, map.depths(), &mut rounding)?;
        let laterals = knots("laterals_m", false, map.laterals(), &mut rounding)?;

        let rows_in_front = if surface { map.laterals().len() } else { 0 };
        let mut forces = vec![Force::ZERO; rows_in_front];
        for (&lateral, &normal) in lateral.values().iter().zip(normal.values()) {
            let force = Force::new(lateral, normal);
            forces.push(force.map(|force| rounded(force, &mut rounding.force_n)));
        }
        Ok(LoadedTable {
            depths: Knots::new(depths),
            laterals: Knots::new(laterals),
            forces,
            rounding,
        })
    }

    /// The table of a map for a device that must play it passively within `limits`.
    ///
    /// # Errors
    /// As [`LoadedTable::new`]; numbers that describe no device; a table with which it would give energy out.
    ///
    /// Implements: SRV-051.
    pub fn passive(
        map: &ForceTable,
        damping: &Damping,
        limits: &Limits,
    ) -> Result<LoadedTable, Refusal> {
        let loaded = LoadedTable::new(map)?;
        let excess = loaded.excess(damping, limits)?;
        excess.map_or(Ok(loaded), |excess| Err(excess.refusal()))
    }

    /// Like [`LoadedTable::passive`], but a table that is not passive is scaled down. Also returns the
    /// factor on its forces, 1 if none was needed.
    ///
    /// # Errors
    /// As [`LoadedTable::new`]; numbers that describe no device, or one that no spring suits.
    ///
    /// Implements: SRV-051.
    pub fn scaled_to_be_passive(
        map: &ForceTable,
        damping: &Damping,
        limits: &Limits,
    ) -> Result<(LoadedTable, f64), Refusal> {
        let loaded = LoadedTable::new(map)?;
        let fit = match loaded.excess(damping, limits)? {
            None => return Ok((loaded, 1.0)),
            Some(excess) if excess.scale() > 0.0 => excess.scale(),
            Some(excess) => return Err(excess.refusal()),
        };
        // Rounding the scaled forces may leave a slope a little too steep.
        let mut margin = 1e-7;
        loop {
            let factor = fit * (1.0 - margin);
            let scaled = loaded.scaled(factor);
            match scaled.excess(damping, limits)? {
                None => return Ok((scaled, factor)),
                Some(excess) if margin > 0.5 => return Err(excess.refusal()),
                Some(_) => margin *= 2.0,
            }
        }
    }

    /// The table as the kernel takes it.
    pub fn table(&self) -> Table<'_> {
        let [depths, laterals] = [&self.depths, &self.laterals].map(Knots::axis);
        let [depths, laterals] = [depths, laterals].map(|axis| axis.expect("`knots` checked it"));
        Table::new(depths, laterals, &self.forces).expect("`check_forces` checked it")
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
            *force = force.map(product);
        }
        scaled
    }

    /// The worst of the bounds that the table breaks, beyond which the device would give energy out.
    ///
    /// Implements: SRV-051.
    fn excess(&self, damping: &Damping, limits: &Limits) -> Result<Option<Excess>, Refusal> {
        let remedy =
            "give period and resolution above 0, damping and friction at least 0, all finite";
        let no_device = || Refusal::state("no device has such numbers", remedy);
        let stiffest = damping.stiffest().ok_or_else(no_device)?;
        let table = self.table();
        let stiffness = stiffness(&table);
        // A hand moves so far in a cycle, and is seen to move a step of each axis further.
        let motion = HAND_SPEED * damping.period_s + SQRT_2 * damping.resolution_m;
        let growth = stiffness * motion;
        let friction = rotation(&table) + stiffness * damping.resolution_m * FRAC_1_SQRT_2;
        let (slew, force) = (limits.slew().into(), limits.force().into());
        let bound = |(what, found, allowed)| Excess {
            what,
            found,
            allowed,
        };
        let held = damping.friction_n;
        let bounds = [
            ("N/m of stiffness", stiffness, stiffest),
            ("N of growth in a cycle", growth, slew),
            ("N of force without a potential", friction, held),
            ("N of force", largest_component(&table), force),
        ];
        let bounds = bounds.map(bound).into_iter();
        let broken = bounds.filter(|b| b.found > b.allowed);
        Ok(broken.min_by(|a, b| a.scale().total_cmp(&b.scale())))
    }
}

/// Refuses forces that are too large, or that are there without a touch.
fn check_forces(name: &str, matrix: &Matrix, depths: &[f64]) -> Result<(), Refusal> {
    let surface = depths.first() == Some(&0.0);
    for (row, column, value) in matrix.entries() {
        let key = || format!("{name}[{row}][{column}]");
        if value.abs() > f64::from(TABLE_FORCE_LIMIT) {
            let expected = format!("at most ±{TABLE_FORCE_LIMIT} N for the servo");
            return Err(Refusal::value(key(), value, expected));
        }
        if surface && row == 0 && value.abs() > SURFACE_FORCE {
            let found = format_args!("{value} at depth 0");
            let expected = format!("at most ±{SURFACE_FORCE} N, since nothing is touched there");
            return Err(Refusal::value(key(), found, expected));
        }
    }
    Ok(())
}

/// The knots of an axis in f32, with the surface (0) in front if it is missing.
fn knots(
    name: &str,
    surface: bool,
    axis: &[f64],
    rounding: &mut RoundingError,
) -> Result<Vec<f32>, Refusal> {
    let mut knots = Vec::with_capacity(axis.len() + 1);
    if surface {
        knots.push(0.0);
    }
    for (index, &value) in axis.iter().enumerate() {
        let refused = |expected| Err(Refusal::value(format!("{name}[{index}]"), value, expected));
        if value.abs() > f64::from(POSITION_LIMIT) {
            return refused(format!("at most ±{POSITION_LIMIT} m for the servo"));
        }
        let knot = rounded(value, &mut rounding.position_m);
        if let Some(&before) = knots.last()
            && knot - before < MIN_WIDTH
        {
            let before = f64::from(before);
            return refused(format!(
                "at least {MIN_WIDTH:e} m above the one before, {before}, for the servo"
            ));
        }
        knots.push(knot);
    }
    let found = format!("{name} has {} entries for the servo", knots.len());
    let is_right = (2..=MAX_KNOTS).contains(&knots.len());
    Refusal::state(found, format!("give 2 to {MAX_KNOTS}")).when(!is_right)?;
    Ok(knots)
}

/// `value` in f32; its error counts towards the largest.
fn rounded(value: f64, largest: &mut f64) -> f32 {
    let rounded = value as f32;
    *largest = largest.max((f64::from(rounded) - value).abs());
    rounded
}

#[cfg(test)]
mod tests;
