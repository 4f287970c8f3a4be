//! A dense square matrix, as a container: the solver's arithmetic on it stands where it is needed.

use core::ops::{Index, IndexMut};

/// A square matrix of f64, column after column.
///
/// ```
/// use palpate::fem::SquareMatrix;
///
/// let mut matrix = SquareMatrix::from_fn(2, |row, column| (10 * row + column) as f64);
/// matrix[(0, 1)] = 5.0;
/// assert_eq!((matrix.order(), matrix[(1, 0)]), (2, 10.0));
/// assert_eq!(matrix.as_slice(), [0.0, 10.0, 5.0, 11.0]);
/// matrix.as_mut_slice().fill(0.0);
/// assert_eq!(matrix[(0, 1)], 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SquareMatrix {
    order: usize,
    entries: Vec<f64>,
}

impl SquareMatrix {
    /// The matrix of `order` rows whose entries are `entry(row, column)`.
    ///
    /// ```
    /// use palpate::fem::SquareMatrix;
    ///
    /// let unit = SquareMatrix::from_fn(3, |row, column| f64::from(u8::from(row == column)));
    /// assert_eq!([unit[(2, 2)], unit[(2, 0)]], [1.0, 0.0]);
    /// ```
    pub fn from_fn(order: usize, mut entry: impl FnMut(usize, usize) -> f64) -> SquareMatrix {
        let mut entries = Vec::with_capacity(order * order);
        for column in 0..order {
            entries.extend((0..order).map(|row| entry(row, column)));
        }
        SquareMatrix { order, entries }
    }

    /// Number of rows, and of columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// All entries, column after column.
    pub fn as_slice(&self) -> &[f64] {
        &self.entries
    }

    /// The same, to be changed.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.entries
    }
}

/// By row and column.
///
/// # Panics
/// If one of them is not below the order.
impl Index<(usize, usize)> for SquareMatrix {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.entries[column * self.order..][..self.order][row]
    }
}

impl IndexMut<(usize, usize)> for SquareMatrix {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.entries[column * self.order..][..self.order][row]
    }
}
