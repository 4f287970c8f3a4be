//! Forces at the nodes of a grid, and between and beyond them.

use super::limit::between;
use super::{Axis, Cell, Force};

/// Largest magnitude of a component in a table, N (SRV-002).
pub const TABLE_FORCE_LIMIT: f32 = 100.0;

/// The force on the probe over depth and lateral position, at 1 kHz.
///
/// ```
/// use palpate_core::force::Force;
/// use palpate_core::servo::{Axis, Table};
///
/// let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// let forces = [0.0, 0.0, 2.0, 4.0].map(|normal| Force { lateral: 0.0, normal });
/// let table = Table::new(axis, axis, &forces)?;
/// assert_eq!(table.forces(), forces);
///
/// let middle = table.force(0.25, 0.25);
/// assert_eq!(middle.normal, 1.5);
/// let cells = (table.depths().locate(0.25), table.laterals().locate(0.25));
/// assert_eq!(table.force_in(cells.0, cells.1), middle);
/// # Ok::<(), palpate_core::servo::InvalidTable>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table<'a> {
    depths: Axis<'a>,
    laterals: Axis<'a>,
    /// One row for each depth.
    forces: &'a [Force<f32>],
}

/// Why forces are no table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InvalidTable {
    /// Not one force for each pair of knots.
    Shape {
        /// How many forces there are.
        found: usize,
        /// Depths times lateral positions.
        expected: usize,
    },
    /// A force that is not a number within ±[`TABLE_FORCE_LIMIT`].
    Force {
        /// Its place: row times the number of lateral positions, plus column.
        index: usize,
        /// Its value, N.
        value: Force<f32>,
    },
}

impl<'a> Table<'a> {
    /// The table of `forces`, one row after the other: depths × lateral positions.
    ///
    /// # Errors
    /// [`InvalidTable`].
    ///
    /// Implements: SRV-002, CON-007.
    pub fn new(
        depths: Axis<'a>,
        laterals: Axis<'a>,
        forces: &'a [Force<f32>],
    ) -> Result<Table<'a>, InvalidTable> {
        let expected = depths.knots().len() * laterals.knots().len(); // at most 1024²
        if forces.len() != expected {
            let found = forces.len();
            return Err(InvalidTable::Shape { found, expected });
        }
        for (index, &value) in forces.iter().enumerate() {
            // Written so that NaN is refused.
            let allowed = -TABLE_FORCE_LIMIT..=TABLE_FORCE_LIMIT;
            if !(allowed.contains(&value.lateral) && allowed.contains(&value.normal)) {
                return Err(InvalidTable::Force { index, value });
            }
        }
        Ok(Table {
            depths,
            laterals,
            forces,
        })
    }

    /// The axis of depths.
    pub fn depths(&self) -> Axis<'a> {
        self.depths
    }

    /// The axis of lateral positions.
    pub fn laterals(&self) -> Axis<'a> {
        self.laterals
    }

    /// The forces at the nodes, N: depths × lateral positions, row by row.
    pub fn forces(&self) -> &'a [Force<f32>] {
        self.forces
    }

    /// The force at a depth and lateral position (m): bilinear in the cell, continued one cell width
    /// beyond the border, constant from there on, and zero above the surface.
    ///
    /// Implements: SRV-010, SRV-011, SRV-012, SRV-013, SRV-014, SRV-015.
    #[inline]
    pub fn force(&self, depth: f32, lateral: f32) -> Force<f32> {
        let force = self.continued(depth, lateral);
        if depth < 0.0 { Force::ZERO } else { force }
    }

    /// [`Table::force`] without regard to the surface, for who looks after it himself.
    #[inline]
    pub fn continued(&self, depth: f32, lateral: f32) -> Force<f32> {
        self.force_in(self.depths.locate(depth), self.laterals.locate(lateral))
    }

    /// The bilinear form of the cell in row `depth.index` and column `lateral.index`, at the fractions
    /// given; zero for a cell that the table does not have.
    #[inline]
    pub fn force_in(&self, depth: Cell, lateral: Cell) -> Force<f32> {
        let columns = self.laterals.knots().len();
        let first = depth
            .index
            .wrapping_mul(columns)
            .wrapping_add(lateral.index);
        let second = first.wrapping_add(columns);
        let rows = (self.forces.get(first..), self.forces.get(second..));
        let (Some(&[a, b, ..]), Some(&[c, d, ..])) = rows else {
            return Force::ZERO; // `locate` gives cells of the axis alone
        };
        let component = |a, b, c, d| {
            let upper = blend(a, b, lateral.fraction);
            let lower = blend(c, d, lateral.fraction);
            blend(upper, lower, depth.fraction)
        };
        Force::new(
            component(a.lateral, b.lateral, c.lateral, d.lateral),
            component(a.normal, b.normal, c.normal, d.normal),
        )
    }
}

/// (1 − t) a + t b; for 0 ≤ t ≤ 1 between a and b to the bit, with a at 0 and b at 1.
///
/// This form, of the two that are common, is exact at both ends; rounding may still carry it out of
/// the hull by a bit (for a = b, say).
#[inline]
pub fn blend(a: f32, b: f32, t: f32) -> f32 {
    let value = (1.0 - t) * a + t * b;
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    let within = between(value, low, high);
    if (0.0..=1.0).contains(&t) {
        within
    } else {
        value
    }
}
