//! Expected values: mpmath 1.4.1 at 50 digits, ½ erfc(−x/√2), exp(−x²/2)/√(2π), and Halley's
//! iteration on the former, for the exact binary64 argument, rounded once.

use super::*;
use palpate_asserts::assert_ulps;

// Verifies: DET-001.
#[test]
fn distribution_is_within_four_ulps_from_the_far_tail_to_one() {
    for (x, expected) in [
        (-38.0, 2.88542835e-316),
        (-30.0, 4.906713927148187e-198),
        (-20.5, 1.0764673258790961e-93),
        (-10.0, 7.619853024160525e-24),
        (-5.0, 2.866515718791939e-07),
        (-2.0, 0.02275013194817921),
        (-1.0, 0.15865525393145705),
        (-0.1, 0.460172162722971),
        (0.0, 0.5),
        (0.3, 0.6179114221889527),
        (1.0, 0.8413447460685429),
        (2.5, 0.9937903346742238),
        (6.0, 0.9999999990134123),
        (9.0, 1.0),
    ] {
        assert_ulps(cdf(x).unwrap(), expected, 4.0);
        assert_ulps(upper_tail(-x).unwrap(), expected, 4.0);
    }
}

// Verifies: DET-001.
#[test]
fn distribution_reaches_its_limits_without_nan() {
    for x in [-f64::MAX, -1e3, -40.1, -39.0] {
        assert_eq!((cdf(x), upper_tail(x)), (Ok(0.0), Ok(1.0)));
        assert_eq!((upper_tail(-x), cdf(-x)), (Ok(0.0), Ok(1.0)));
    }
    assert_eq!(lower_tail(f64::NEG_INFINITY), 0.0);
    assert_eq!(lower_tail(f64::INFINITY), 1.0);
}

// Verifies: DET-001.
#[test]
fn density_is_within_four_ulps() {
    for (x, expected) in [
        (0.0, 0.3989422804014327),
        (0.5, 0.35206532676429947),
        (-1.0, 0.24197072451914334),
        (3.0, 0.0044318484119380075),
        (10.0, 7.694598626706419e-23),
        (-25.0, 7.653929736419392e-137),
        (37.0, 2.1200065515246056e-298),
        // Arguments whose squares have 106 bits.
        (-20.3, 1.308288554681529e-90),
        (10.1, 2.8165665442762395e-23),
        (-9.844350969631765, 3.604959390922063e-22),
        (37.1, 5.215262198831984e-300),
    ] {
        assert_ulps(density(x).unwrap(), expected, 4.0);
    }
    assert_eq!(density(1e200), Ok(0.0));
}

// Verifies: DET-001.
#[test]
fn quantile_is_within_four_ulps_for_every_kind_of_probability() {
    for (p, expected) in [
        (1e-300, -37.0470962993612),
        (1e-290, -36.420731673207996),
        (1e-100, -21.273453560965326),
        (1e-16, -8.222082216130435),
        (1e-06, -4.753424308822899),
        (0.025, -1.9599639845400543),
        (0.07499, -1.4396021182393162),
        (0.0751, -1.43882539275254),
        (0.3, -0.5244005127080408),
        (0.49999, -2.5066282748960008e-05),
        (0.5, 0.0),
        // Where AS 241 alone, or a step on Φ in place of erf, is off by more than 4 ulps.
        (1.7692010562770948e-212, -31.08764161824259),
        (1.4580732568474343e-195, -29.809799709094683),
        (0.3165007032347811, -0.47750662210106154),
        (0.4999939918139252, -1.5060289094967413e-05),
        (0.4999999774154372, -5.661110362320961e-08),
        (0.5000000000000002, 5.565832849343534e-16),
        (0.84, 0.994457883209753),
        (0.95, 1.6448536269514722),
        (0.999, 3.090232306167813),
        (0.9999999999999999, 8.209536151601387),
    ] {
        assert_ulps(quantile(p).unwrap(), expected, 4.0);
    }
}

// Verifies: DET-001.
#[test]
fn quantile_is_within_six_ulps_for_the_smallest_probabilities() {
    for (p, expected) in [
        (5e-324, -38.467405617144344),
        (5e-323, -38.407541387272424),
        // The worst of 8 million, 4.5 ulps; and one where a Newton step would make it 11.
        (1.19876776e-313, -37.841110136898),
        (1.220852427803e-312, -37.779772046199525),
        (1e-310, -37.663060331949524),
        (f64::MIN_POSITIVE, -37.5193793471445),
    ] {
        assert_ulps(quantile(p).unwrap(), expected, 6.0);
    }
}

// Verifies: DET-001.
#[test]
fn quantile_never_decreases_between_neighbours_at_its_seams() {
    for seam in [
        1e-306,
        0.075,
        0.5 - 0.425,
        0.5 + 0.425,
        1.388_794_386_496_402e-11,
    ] {
        let mut p: f64 = seam;
        for _ in 0..200 {
            p = p.next_down();
        }
        // Both sides are off by 4 ulps at most, so a step down larger than that is a seam.
        let mut largest = quantile(p).unwrap();
        for _ in 0..400 {
            p = p.next_up();
            let x = quantile(p).unwrap();
            let holds = x >= largest - 8.0 * f64::EPSILON * x.abs();
            assert!(holds, "a step down at p = {p:e}");
            largest = largest.max(x);
        }
    }
}

// Verifies: DET-005.
#[test]
fn values_outside_the_domain_are_refused() {
    let refused = |what, value, range| Err(NumericError::OutOfRange { what, value, range });
    for p in [0.0, 1.0, -0.1, 1.1, f64::INFINITY, f64::NEG_INFINITY, -0.0] {
        assert_eq!(quantile(p), refused("p", p, "strictly between 0 and 1"));
    }
    assert!(quantile(f64::NAN).is_err());
    for x in [f64::INFINITY, f64::NEG_INFINITY] {
        for found in [cdf(x), upper_tail(x), density(x)] {
            assert_eq!(found, refused("x", x, "finite"));
        }
    }
    assert!(cdf(f64::NAN).is_err() && upper_tail(f64::NAN).is_err() && density(f64::NAN).is_err());
}
