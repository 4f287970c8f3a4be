//! Dense partial Cholesky factorisation of one front, in tiles of 4 × 4.
//!
//! A front is a symmetric matrix over `own` unknowns, which are eliminated, and `border` unknowns, which
//! are not: [F₁₁ ·; F₂₁ F₂₂] → L₁₁, L₂₁ = F₂₁ L₁₁⁻ᵀ and the update F₂₂ − L₂₁ L₂₁ᵀ. Rows stand in panels of
//! four, column by column, so that every product is one loop over contiguous memory that the compiler
//! turns into vector instructions. Additions and multiplications come in a fixed order and are never
//! fused: the bits are the same on every processor (requirement CON-006).

use super::FemError;

/// Rows of a panel and of a tile.
pub const TILE: usize = 4;

/// One column of a panel of rows.
pub type Strip = [f64; TILE];

/// The next multiple of [`TILE`].
pub fn padded(count: usize) -> usize {
    count.next_multiple_of(TILE)
}

/// The lower triangle of a front, zero where nothing was added. Counts are multiples of [`TILE`].
#[derive(Debug, Clone)]
pub struct Front {
    /// Unknowns to eliminate.
    pub own: usize,
    /// Unknowns that stay.
    pub border: usize,
    /// Columns of the own unknowns: own rows, then border rows. Holds L after [`Front::eliminate`], with the
    /// reciprocals of L's diagonal on the diagonal.
    pub panels: Vec<Strip>,
    /// Border × border, the same layout.
    pub update: Vec<Strip>,
}

impl Front {
    /// A front of zeros.
    pub fn new(own: usize, border: usize) -> Front {
        let (own, border) = (padded(own), padded(border));
        Front {
            own,
            border,
            panels: vec![[0.0; TILE]; (own + border) / TILE * own],
            update: vec![[0.0; TILE]; border / TILE * border],
        }
    }

    /// The entry in `row` ≥ `column`; border unknowns are counted on behind the own ones.
    pub fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        if column < self.own {
            &mut self.panels[row / TILE * self.own + column][row % TILE]
        } else {
            let (row, column) = (row - self.own, column - self.own);
            &mut self.update[row / TILE * self.border + column][row % TILE]
        }
    }

    /// Makes the own unknowns from `used` on, which only fill the last tile, independent of the rest.
    pub fn pad_diagonal(&mut self, used: usize) {
        for row in used..self.own {
            *self.entry(row, row) = 1.0;
        }
    }

    /// `out += U x` with U the symmetric update.
    pub fn add_update_product(&self, x: &[[f64; 1]], out: &mut [f64]) {
        for row in 0..out.len() {
            let strips = &self.update[row / TILE * self.border..];
            let mut sum = 0.0;
            for column in 0..=row {
                sum += strips[column][row % TILE] * x[column][0];
            }
            for below in row + 1..out.len() {
                sum += self.update[below / TILE * self.border + row][below % TILE] * x[below][0];
            }
            out[row] += sum;
        }
    }

    /// Factorises the own rows, L₁₁; those of the border stay as they are.
    ///
    /// # Errors
    /// [`FemError::NotPositiveDefinite`].
    pub fn factorise(&mut self) -> Result<(), FemError> {
        let own = self.own;
        for panel in 0..own / TILE {
            let (above, row) = self.panels.split_at_mut(panel * own);
            let row = &mut row[..own];
            reduce(row, above, own, 0, panel);
            let (left, diagonal) = row.split_at_mut(panel * TILE);
            let mut tile = tile_at(diagonal);
            subtract_product(&mut tile, left, left);
            factorise_tile(&mut tile)?;
            diagonal[..TILE].copy_from_slice(&tile);
        }
        Ok(())
    }

    /// Eliminates the own unknowns. `leading_zeros(panel)` own columns of a border panel hold zeros, a multiple
    /// of [`TILE`], and are skipped.
    ///
    /// # Errors
    /// [`FemError::NotPositiveDefinite`].
    pub fn eliminate(&mut self, leading_zeros: impl Fn(usize) -> usize) -> Result<(), FemError> {
        self.factorise()?;
        let own = self.own;
        let (above, rows) = self.panels.split_at_mut(own / TILE * own);
        for panel in 0..self.border / TILE {
            let zeros = leading_zeros(panel);
            let (finished, row) = rows.split_at_mut(panel * own);
            let row = &mut row[..own];
            reduce(row, above, own, zeros / TILE, own / TILE);
            let updates = &mut self.update[panel * self.border..][..(panel + 1) * TILE];
            for (column, update) in updates.chunks_exact_mut(TILE).enumerate() {
                let from = zeros.max(leading_zeros(column));
                let other = if column < panel {
                    &finished[column * own..][..own]
                } else {
                    &row[..]
                };
                let mut tile = tile_at(update);
                subtract_product(&mut tile, &row[from..], &other[from..]);
                update.copy_from_slice(&tile);
            }
        }
        Ok(())
    }

    /// `out += F₂₁ x`, before the border is reduced.
    pub fn add_border_product(&self, x: &[[f64; 1]], out: &mut [f64]) {
        let rows = self.panels[self.own / TILE * self.own..].chunks_exact(self.own);
        for (row, out) in rows.zip(out.chunks_mut(TILE)) {
            let mut sum = [0.0; TILE];
            for (strip, [x]) in row.iter().zip(x) {
                for i in 0..TILE {
                    sum[i] += strip[i] * x;
                }
            }
            for (out, sum) in out.iter_mut().zip(sum) {
                *out += sum;
            }
        }
    }
}

/// The tile at the start of a piece of a panel, column by column.
fn tile_at(strips: &[Strip]) -> [Strip; TILE] {
    core::array::from_fn(|column| strips[column])
}

/// `tile −= Σ_p left[p] right[p]ᵀ`.
#[inline]
fn subtract_product(tile: &mut [Strip; TILE], left: &[Strip], right: &[Strip]) {
    let mut sum = *tile;
    for (a, b) in left.iter().zip(right) {
        for j in 0..TILE {
            for i in 0..TILE {
                sum[j][i] -= a[i] * b[j];
            }
        }
    }
    *tile = sum;
}

/// Turns the tiles `from..to` of a panel of F into those of L, given the finished panels above.
fn reduce(row: &mut [Strip], above: &[Strip], own: usize, from: usize, to: usize) {
    for column in from..to {
        let (left, rest) = row.split_at_mut(column * TILE);
        let upper = &above[column * own..];
        let mut tile = tile_at(rest);
        subtract_product(
            &mut tile,
            &left[from * TILE..],
            &upper[from * TILE..column * TILE],
        );
        let diagonal = tile_at(&upper[column * TILE..]);
        for j in 0..TILE {
            for k in 0..j {
                for i in 0..TILE {
                    tile[j][i] -= tile[k][i] * diagonal[k][j];
                }
            }
            for i in 0..TILE {
                tile[j][i] *= diagonal[j][j];
            }
        }
        rest[..TILE].copy_from_slice(&tile);
    }
}

/// Cholesky factor of a diagonal tile, lower triangle, with reciprocals on the diagonal.
fn factorise_tile(tile: &mut [Strip; TILE]) -> Result<(), FemError> {
    for j in 0..TILE {
        for k in 0..j {
            for i in j..TILE {
                tile[j][i] -= tile[k][i] * tile[k][j];
            }
        }
        let pivot = tile[j][j];
        // Written so that a NaN is refused.
        if !(pivot > 0.0 && pivot < f64::INFINITY) {
            return Err(FemError::NotPositiveDefinite);
        }
        let reciprocal = 1.0 / libm::sqrt(pivot);
        for i in j + 1..TILE {
            tile[j][i] *= reciprocal;
        }
        tile[j][j] = reciprocal;
    }
    Ok(())
}

/// Solves L₁₁ᵀ x = y − L₂₁ᵀ z for `W` columns at once: `x` holds y, own rows first and then those of z.
pub fn substitute_back<const W: usize>(panels: &[Strip], own: usize, x: &mut [[f64; W]]) {
    for column in (0..own).rev() {
        let (before, after) = x.split_at_mut(column + 1);
        let mut sum = before[column];
        let within = column % TILE;
        let mut rows = after.iter();
        let first = column / TILE;
        for (entry, x) in panels[first * own + column][within + 1..]
            .iter()
            .zip(rows.by_ref())
        {
            for w in 0..W {
                sum[w] -= entry * x[w];
            }
        }
        let tiles = panels[(first + 1) * own..].iter().skip(column).step_by(own);
        for (strip, x) in tiles.zip(rows.as_slice().as_chunks::<TILE>().0) {
            for (entry, x) in strip.iter().zip(x) {
                for w in 0..W {
                    sum[w] -= entry * x[w];
                }
            }
        }
        let reciprocal = panels[first * own + column][within];
        before[column] = sum.map(|sum| sum * reciprocal);
    }
}

/// [`substitute_back`] for one column, whose sums run in four parts that do not wait for each other.
pub fn substitute_back_one(panels: &[Strip], own: usize, x: &mut [[f64; 1]]) {
    for column in (0..own).rev() {
        let (first, within) = (column / TILE, column % TILE);
        let (before, after) = x.split_at_mut((first + 1) * TILE);
        let mut sum = [0.0; TILE];
        let tiles = panels[(first + 1) * own..].iter().skip(column).step_by(own);
        for (strip, x) in tiles.zip(after.as_chunks::<TILE>().0) {
            for i in 0..TILE {
                sum[i] += strip[i] * x[i][0];
            }
        }
        let diagonal = &panels[first * own + column];
        for i in within + 1..TILE {
            sum[i] += diagonal[i] * before[first * TILE + i][0];
        }
        let [a, b, c, d] = sum;
        before[column][0] = (before[column][0] - ((a + b) + (c + d))) * diagonal[within];
    }
}

/// Solves L₁₁ y = x for the own rows of `x` and takes L₂₁ y from those of the border.
pub fn substitute_forward<const W: usize>(panels: &[Strip], own: usize, x: &mut [[f64; W]]) {
    for column in 0..own {
        let (first, within) = (column / TILE, column % TILE);
        let reciprocal = panels[first * own + column][within];
        let y = x[column].map(|x| x * reciprocal);
        x[column] = y;
        for (panel, rows) in x.chunks_exact_mut(TILE).enumerate().skip(first) {
            let strip = &panels[panel * own + column];
            for (row, x) in rows.iter_mut().enumerate() {
                if panel > first || row > within {
                    for w in 0..W {
                        x[w] -= strip[row] * y[w];
                    }
                }
            }
        }
    }
}

/// The inverse of the symmetric positive definite matrix whose lower triangle `entry` gives: the update
/// −S⁻¹ that eliminating S leaves in [S ·; I 0]. Its lower triangle stands in tiles.
///
/// # Errors
/// [`FemError::NotPositiveDefinite`].
pub fn inverse(size: usize, entry: impl Fn(usize, usize) -> f64) -> Result<Vec<Strip>, FemError> {
    let mut front = Front::new(size, size);
    let own = front.own;
    for row in 0..own {
        for column in 0..=row.min(size - 1) {
            if row < size {
                *front.entry(row, column) = entry(row, column);
            }
        }
        if row >= size {
            *front.entry(row, row) = 1.0;
        }
        *front.entry(own + row, row) = 1.0;
    }
    front.eliminate(|panel| panel * TILE)?;
    for strip in &mut front.update {
        *strip = strip.map(|x| -x);
    }
    Ok(front.update)
}
