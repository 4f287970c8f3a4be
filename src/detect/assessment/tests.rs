//! Expected values: whole numbers by hand, and Φ by mpmath 1.4.1.

use super::*;
use crate::detect::{Force, theta_of_record};
use crate::stats::tests::assert_ulps;

const UNIT: Force<f64> = Force::new(1.0, 1.0);
const F0: Force<&[f64]> = Force::new(&[0.0, 1.0], &[1.0, 1.0]);
const F1: Force<&[f64]> = Force::new(&[1.0, 1.0], &[2.0, 3.0]);
const OBSERVED: Force<&[f64]> = Force::new(&[1.0, 5.0], &[1.0, 2.0]);

fn judged(prior_h1: f64, eta: f64) -> Result<Assessment, DetectError> {
    assess(theta_of_record(OBSERVED, F0, F1, UNIT)?, prior_h1, eta)
}

// Verifies: DET-031.
#[test]
fn record_at_a_known_position() {
    // Δ = (1, 0; 1, 2), r = (1, 4; 0, 1): Σ rΔ = 3, γ² = 6, θ = 0.
    let found = judged(0.25, -0.5).unwrap();
    let Assessment {
        statistic,
        decision,
        ..
    } = found;
    assert_eq!((statistic.theta, decision), (0.0, Decision::Inclusion));
    assert_ulps(found.posterior, 0.25, 4.0);
    assert_eq!(found.rates, error_rates(libm::sqrt(6.0), -0.5).unwrap());
    let found = judged(0.25, 0.5).unwrap();
    assert_eq!(found.decision, Decision::NoInclusion);
}

// Verifies: DET-009.
#[test]
fn what_is_refused_is_never_a_decision() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(theta_of_record(OBSERVED, F0, F1, Force::new(bad, 1.0)).is_err());
        assert!(judged(bad, 0.0).is_err() && judged(0.5, bad).is_err());
    }
    assert!(theta_of_record(Force::new(&[1.0], &[1.0, 2.0]), F0, F1, UNIT).is_err());
}
