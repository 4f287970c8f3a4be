//! Eigenvalues of a symmetric matrix, by Jacobi's rotations: additions and products in a fixed order, so that the bits are
//! the same on any machine.

use faer::Mat;

/// Most sweeps over all pairs; matrices of some hundred rows need about ten.
const SWEEPS: usize = 60;

/// The eigenvalues of a symmetric matrix, from the least on, each within some roundings of the largest by magnitude.
///
/// # Errors
/// Entries that are not finite, and rotations that do not come to an end.
///
/// Implements: EVD-047.
pub fn eigenvalues(mut matrix: Mat<f64>) -> Result<Vec<f64>, String> {
    let n = matrix.nrows();
    let squares = matrix.col_iter().flat_map(|column| column.iter());
    let size: f64 = squares.map(|entry| entry * entry).sum();
    if !size.is_finite() {
        return Err("eigenvalues of a matrix with an entry that is not finite or too large".into());
    }
    for _ in 0..SWEEPS {
        let mut beside = 0.0;
        for p in 0..n {
            for q in p + 1..n {
                beside += matrix[(p, q)] * matrix[(p, q)];
                rotate(&mut matrix, p, q);
            }
        }
        // Their sum of squares bounds each eigenvalue's error squared.
        if beside <= size * (f64::EPSILON * f64::EPSILON) {
            let mut values: Vec<f64> = (0..n).map(|k| matrix[(k, k)]).collect();
            values.sort_by(f64::total_cmp);
            return Ok(values);
        }
    }
    Err(format!("eigenvalues not found in {SWEEPS} sweeps"))
}

/// Turns the plane of p and q so that their entry vanishes: the angle's tangent is the smaller root of t² + 2θt − 1 = 0.
fn rotate(matrix: &mut Mat<f64>, p: usize, q: usize) {
    let entry = matrix[(p, q)];
    if entry == 0.0 {
        return;
    }
    let theta = (matrix[(q, q)] - matrix[(p, p)]) / (2.0 * entry);
    let t = 1.0 / (theta.abs() + libm::sqrt(theta * theta + 1.0));
    let t = if theta < 0.0 { -t } else { t };
    let cos = 1.0 / libm::sqrt(t * t + 1.0);
    let sin = t * cos;
    for k in 0..matrix.nrows() {
        let (a, b) = (matrix[(k, p)], matrix[(k, q)]);
        matrix[(k, p)] = cos * a - sin * b;
        matrix[(k, q)] = sin * a + cos * b;
    }
    for k in 0..matrix.nrows() {
        let (a, b) = (matrix[(p, k)], matrix[(q, k)]);
        matrix[(p, k)] = cos * a - sin * b;
        matrix[(q, k)] = sin * a + cos * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: EVD-047.
    #[test]
    fn eigenvalues_are_those_of_another_program() {
        // Entries of mixed size and sign, and eigenvalues that repeat.
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.min(j) as f64, i.max(j) as f64);
            (3.0 * i - j * j) / (1.0 + i + j) + if i == j { 5.0 } else { 0.0 }
        };
        for n in [1, 2, 3, 7, 30] {
            let ours = eigenvalues(Mat::from_fn(n, n, entry)).unwrap();
            let theirs = nalgebra::DMatrix::from_fn(n, n, entry).symmetric_eigenvalues();
            let mut theirs = theirs.as_slice().to_vec();
            theirs.sort_by(f64::total_cmp);
            let size = theirs
                .iter()
                .fold(0.0, |size: f64, value| size.max(value.abs()));
            for (ours, theirs) in ours.iter().zip(&theirs) {
                // Both are within n roundings or so of the largest.
                assert!(
                    (ours - theirs).abs() <= 1e-14 * n as f64 * size,
                    "{n}: {ours} {theirs}"
                );
            }
        }
        assert_eq!(eigenvalues(Mat::zeros(3, 3)), Ok(vec![0.0; 3]));
        assert!(eigenvalues(Mat::from_fn(2, 2, |_, _| f64::NAN)).is_err());
    }
}
