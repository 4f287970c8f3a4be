//! Errors of a convergence study against stored ones.

use super::{Figure, largest};

/// How far an error may be from its stored value, over that value. Meshes and arithmetic are the same in each run, so that
/// only rounding moves it, by 1e-9; a tenth of a per cent lets another solver or a finer rule for the norms pass, but
/// nothing that touches the elements.
const SHARE: f64 = 1e-3;

/// The least orders of displacement and stress that are demanded: 3 and 2 by the theory, less 0.1.
pub const ORDERS: [f64; 2] = [2.9, 1.9];
/// Where ν is so near ½ that these meshes are too coarse for those: quadratic triangles lose one order at most, however near
/// (I. Babuška and M. Suri, Numerische Mathematik 62, 1992, on straight ones).
pub const ORDERS_OF_ANY_NU: [f64; 2] = [2.0, 1.0];

/// Compares `errors`, on meshes each twice as fine as the one before, with stored ones, and demands that the last observed
/// order log₂(e_{k−1}/e_k) be at least `order`. A run better than stored fails as a worse one does.
///
/// Implements: FEM-062.
pub fn convergence<const MESHES: usize>(
    what: &str,
    errors: [f64; MESHES],
    stored: [f64; MESHES],
    order: f64,
) -> Vec<Figure> {
    let off = errors
        .iter()
        .zip(stored)
        .map(|(error, stored)| (error / stored - 1.0).abs());
    let [before, finest] = [2, 1].map(|back| errors[MESHES - back]);
    figures! {
        "{what}: relative error on the finest mesh" => told(finest);
        "{what}: largest difference of an error from the stored one, over that" => at_most(largest(off), SHARE);
        "{what}: last observed order" => at_least(libm::log2(before / finest), order);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: FEM-062.
    #[test]
    fn an_error_that_moves_and_an_order_that_is_lost_fail() {
        let stored = [8.0, 1.0, 0.125];
        let passes = |errors: [f64; 3]| {
            let figures = convergence("u", errors, stored, 2.9);
            figures
                .iter()
                .map(|figure| figure.passes())
                .collect::<Vec<_>>()
        };
        assert_eq!(passes(stored), [true; 3]);
        assert_eq!(passes([8.0, 1.0009, 0.125]), [true; 3]);
        // A run that is better fails as a worse one.
        assert_eq!(passes([8.0, 1.0011, 0.125]), [true, false, true]);
        assert_eq!(passes([7.99, 1.0, 0.125]), [true, false, true]);
        // The order 2.9 is the least: 2^−2.9 is 0.13397.
        assert_eq!(passes([8.0, 1.0, 0.1339]), [true, false, true]);
        assert_eq!(passes([8.0, 1.0, 0.1340]), [true, false, false]);
        assert_eq!(passes([8.0, f64::NAN, 0.125]), [true, false, false]);
    }
}
