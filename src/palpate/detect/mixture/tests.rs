//! Expected values: mpmath 1.4.1 at 40 digits from the definitions.

use super::*;
use palpate_asserts::assert_ulps;

const THETA: [f64; 4] = [1.5, -2.0, 4.0, 0.25];
const PRIOR: [f64; 4] = [0.1, 0.4, 0.2, 0.3];

// Verifies: DET-070.
#[test]
fn mixture_over_depths() {
    let theta = mixture_theta(&THETA, &PRIOR).unwrap();
    assert_ulps(theta, 2.468704488445161, 4.0);
}

// Verifies: DET-070.
#[test]
fn one_depth_is_the_plain_statistic_and_extremes_do_not_overflow() {
    assert_eq!(mixture_theta(&[3.25], &[1.0]), Ok(3.25));
    let found = mixture_theta(&[-1e6, 1e6, 1e6], &[0.5, 0.25, 0.25]);
    assert_eq!(found, Ok(1e6 + libm::log(0.5)));
    // A depth with prior 0 has no say, however large its θ.
    assert_eq!(mixture_theta(&[1e6, -5.0], &[0.0, 1.0]), Ok(-5.0));
}

// Verifies: DET-070.
#[test]
fn priors_add_up_to_one_within_a_billionth() {
    for off in [0.9e-9, -0.9e-9, 1.1e-9, -1.1e-9_f64] {
        let found = mixture_theta(&[1.0, 2.0], &[0.5, 0.5 + off]);
        assert_eq!(found.is_ok(), off.abs() < 1e-9, "{off}");
    }
}

// Verifies: DET-005, DET-070.
#[test]
fn banks_that_do_not_fit_are_refused() {
    assert!(mixture_theta(&[], &[]).is_err());
    assert!(mixture_theta(&THETA, &PRIOR[..3]).is_err());
    assert!(mixture_theta(&[1.0, f64::NAN], &[0.5, 0.5]).is_err());
    assert!(mixture_theta(&[1.0, 2.0], &[0.5, 0.6]).is_err());
    assert!(mixture_theta(&[1.0, 2.0], &[-0.5, 1.5]).is_err());
    assert!(mixture_theta(&[1.0, 2.0], &[f64::NAN, 0.5]).is_err());
}
