//! Functions whose maxima and crossings are known.

use super::*;
use crate::stats::tests::assert_near;

// Verifies: PSY-040.
#[test]
fn maxima_inside_and_at_the_ends() {
    // The bracket of two cells shrinks by 4·10⁻⁶.
    let (at, value) = maximum(|x| 3.0 - (x - 0.3) * (x - 0.3), -2.0, 5.0, 7);
    assert_near(at, 0.3, 8e-6);
    assert_near(value, 3.0, 1e-10);
    assert_eq!(maximum(|x| x, -1.0, 2.0, 3).0, 2.0);
    assert_eq!(maximum(|x| -x, -1.0, 2.0, 3).0, -1.0);
    // Of two hills the higher one.
    let hills = |x: f64| (-(x - 1.0) * (x - 1.0)).exp() + 1.1 * (-(x - 7.0) * (x - 7.0)).exp();
    assert_near(maximum(hills, 0.0, 10.0, 10).0, 7.0, 1e-5);
}

// Verifies: PSY-040.
#[test]
fn crossings_in_either_direction_and_from_infinity() {
    let root = std::f64::consts::LN_2;
    assert_near(crossing(|x| 2.0 - x.exp(), 0.0, 40.0), root, 1e-9);
    assert_near(crossing(|x| x.exp() - 2.0, 3.0, -1.0), root, 1e-9);
    assert_near(crossing(|x| 2.0 + x.ln(), 1.0, 0.0), (-2.0_f64).exp(), 1e-9);
    let root = change(|x| x * x < 2.0, 0.0, 2.0);
    assert_near(root, std::f64::consts::SQRT_2, 4e-13);
}
