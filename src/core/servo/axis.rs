//! An axis of a force table.

use super::limit::between;

/// Most knots of an axis: each one costs a comparison in each cycle (SRV-002).
pub const MAX_KNOTS: usize = 1024;

/// Largest magnitude of a knot, m (SRV-002).
pub const POSITION_LIMIT: f32 = 1.0;

/// Smallest distance of two knots, m (SRV-002).
pub const MIN_WIDTH: f32 = 1e-6;

/// How far beyond the border of the table its last cell is continued, in widths of that cell
/// (SRV-012).
pub const EXTRAPOLATION_CELLS: f32 = 1.0;

/// Positions beyond this magnitude, m, count as this: further out than the widest cell reaches, and
/// near enough for every product below to be finite.
const FAR: f32 = 4.0;

/// Knots along one coordinate, m, increasing but not necessarily uniform, with the reciprocals of
/// the widths of their cells, 1/m. Knot i and knot i + 1 enclose cell i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis<'a> {
    knots: &'a [f32],
    reciprocal_widths: &'a [f32],
    /// Where the cells start: all knots but the last.
    starts: &'a [f32],
    /// The highest bit that the index of a cell can have; 0 if there is one cell.
    stride: usize,
}

/// Where a position lies: a cell of an axis, and the fraction of its width.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    /// The cell, from 0 to the number of cells minus 1.
    pub index: usize,
    /// 0 at the cell's first knot, 1 at its last; from −1 to 2 outside the axis.
    pub fraction: f32,
}

/// Why numbers are no axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InvalidAxis {
    /// Fewer than 2 knots or more than [`MAX_KNOTS`].
    Knots {
        /// How many there are.
        found: usize,
    },
    /// Not one reciprocal for each cell.
    Reciprocals {
        /// How many there are.
        found: usize,
        /// How many cells there are.
        expected: usize,
    },
    /// A knot that is not a number within ±[`POSITION_LIMIT`].
    Position {
        /// Which knot, from 0.
        index: usize,
        /// Its value, m.
        value: f32,
    },
    /// A knot less than [`MIN_WIDTH`] above the one before.
    Width {
        /// Which knot, from 1.
        index: usize,
        /// Its value minus the one before, m.
        width: f32,
    },
    /// A reciprocal that is not 1 divided by the cell's width.
    Reciprocal {
        /// Which cell, from 0.
        index: usize,
        /// Its value, 1/m.
        value: f32,
    },
}

impl<'a> Axis<'a> {
    /// The axis of `knots` (m), each cell with its reciprocal width (1/m) as
    /// [`Axis::reciprocal_width`] gives it. The division is done once, here and there, so that the
    /// servo loop has none.
    ///
    /// # Errors
    /// [`InvalidAxis`].
    ///
    /// Implements: SRV-002.
    pub fn new(knots: &'a [f32], reciprocal_widths: &'a [f32]) -> Result<Axis<'a>, InvalidAxis> {
        let found = knots.len();
        if !(2..=MAX_KNOTS).contains(&found) {
            return Err(InvalidAxis::Knots { found });
        }
        if reciprocal_widths.len() != found - 1 {
            return Err(InvalidAxis::Reciprocals {
                found: reciprocal_widths.len(),
                expected: found - 1,
            });
        }
        for (index, &value) in knots.iter().enumerate() {
            // Written so that NaN is refused.
            if !(-POSITION_LIMIT..=POSITION_LIMIT).contains(&value) {
                return Err(InvalidAxis::Position { index, value });
            }
        }
        let cells = knots.iter().zip(knots.iter().skip(1));
        for (index, ((&start, &end), &value)) in cells.zip(reciprocal_widths).enumerate() {
            let width = end - start;
            if width < MIN_WIDTH {
                let index = index + 1;
                return Err(InvalidAxis::Width { index, width });
            }
            if value != Axis::reciprocal_width(start, end) {
                return Err(InvalidAxis::Reciprocal { index, value });
            }
        }
        let starts = match knots {
            [starts @ .., _] => starts,
            [] => knots, // there are at least two
        };
        let stride = match starts.len() - 1 {
            0 => 0,
            last => 1 << last.ilog2(),
        };
        Ok(Axis {
            knots,
            reciprocal_widths,
            starts,
            stride,
        })
    }

    /// What an axis stores of the cell between two knots (m): 1/(end − start), 1/m.
    pub fn reciprocal_width(start: f32, end: f32) -> f32 {
        1.0 / (end - start)
    }

    /// The knots, m.
    pub fn knots(&self) -> &'a [f32] {
        self.knots
    }

    /// Where `position` (m) lies. A NaN counts as far before the axis: it is the caller who must not
    /// ask.
    ///
    /// The index is found bit by bit, the highest first: as many comparisons for every position.
    ///
    /// Implements: SRV-004, SRV-015.
    #[inline]
    pub fn locate(&self, position: f32) -> Cell {
        let position = between(position, -FAR, FAR);
        let mut index = 0;
        let mut stride = self.stride;
        while stride > 0 {
            let ahead = stride.wrapping_add(index);
            if self
                .starts
                .get(ahead)
                .is_some_and(|&start| start <= position)
            {
                index = ahead;
            }
            stride /= 2;
        }
        let Some(&[start, end, ..]) = self.knots.get(index..) else {
            return Cell::default(); // `new` gave every cell two ends
        };
        let Some(&reciprocal) = self.reciprocal_widths.get(index) else {
            return Cell::default(); // and a reciprocal
        };
        let fraction = (position - start) * reciprocal;
        // The product may miss 1 by its last bit on either side.
        let fraction = if position >= end {
            between(fraction, 1.0, 1.0 + EXTRAPOLATION_CELLS)
        } else {
            between(fraction, -EXTRAPOLATION_CELLS, 1.0)
        };
        Cell { index, fraction }
    }
}
