//! Symmetric elimination within the matrix's profile: the plainest exact solver, which shares nothing with the
//! library's. There is no pivoting: matrices that are positive definite need none, nor do those bordered by
//! constraints behind all unknowns that they bind.

/// A symmetric matrix, from the first entry of each row to its diagonal.
pub struct Skyline {
    first: Vec<usize>,
    rows: Vec<Vec<f64>>,
}

impl Skyline {
    /// A matrix of zeros in which row i begins at column `first[i]` ≤ i.
    pub fn new(first: Vec<usize>) -> Skyline {
        let rows = (0..first.len()).map(|i| vec![0.0; i + 1 - first[i]]);
        Skyline {
            rows: rows.collect(),
            first,
        }
    }

    /// Adds to the entry at `row` ≥ `column`.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row][column - self.first[row]] += value;
    }

    /// Replaces the matrix A by its factors, A = L D Lᵀ with ones on the diagonal of L, and D in their place.
    ///
    /// # Errors
    /// The row in which the matrix is singular.
    pub fn factorise(mut self) -> Result<Factor, String> {
        for i in 0..self.rows.len() {
            let (done, rest) = self.rows.split_at_mut(i);
            let (row, start) = (&mut rest[0], self.first[i]);
            // The row of L D, from which that of L and D's entry follow.
            for j in start..i {
                let from = start.max(self.first[j]);
                let other = &done[j][from - self.first[j]..j - self.first[j]];
                row[j - start] -= dot(&row[from - start..j - start], other);
            }
            let (before, diagonal) = row.split_at_mut(i - start);
            for (entry, other) in before.iter_mut().zip(&done[start..]) {
                let scaled = *entry;
                *entry /= other[other.len() - 1];
                diagonal[0] -= scaled * *entry;
            }
            if !diagonal[0].is_normal() {
                return Err(format!("the matrix is singular in row {i}"));
            }
        }
        Ok(Factor(self))
    }
}

/// The factors of a matrix.
pub struct Factor(Skyline);

impl Factor {
    /// Solves A x = b in place.
    pub fn solve(&self, x: &mut [f64]) {
        let Skyline { first, rows } = &self.0;
        for i in 0..x.len() {
            let before = &rows[i][..i - first[i]];
            x[i] -= dot(before, &x[first[i]..i]);
        }
        for (x, row) in x.iter_mut().zip(rows) {
            *x /= row[row.len() - 1];
        }
        for i in (0..x.len()).rev() {
            let value = x[i];
            for (x, l) in x[first[i]..i].iter_mut().zip(&rows[i]) {
                *x -= l * value;
            }
        }
    }
}

/// Σ a b over the shorter of the two, in four sums that the processor can add at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest = n - n % 4;
    let tail: f64 = a[rest..].iter().zip(&b[rest..]).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + tail
}
