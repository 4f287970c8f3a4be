//! Expected values: whole numbers by hand, and Φ by mpmath 1.4.1.

use super::*;
use crate::detect::theta_of_record;
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

// Verifies: DET-053, DET-057, DET-059.
#[test]
fn record_at_an_unknown_position() {
    let template: Force<&[f64]> = Force::new(&[0.0], &[2.0]);
    let scan = Scan::new(3, template, UNIT).unwrap();
    let (mut gamma, mut angle) = ([0.0; 3], [0.0; 3]);
    let law = MaximumLaw::new(&scan, 0, &mut gamma, &mut angle).unwrap();
    let residual: Force<&[f64]> = Force::new(&[9.0, 9.0, 9.0], &[0.0, 3.0, 1.0]);
    let found = assess_scan(&scan, &law, residual, 2.0).unwrap();
    assert_eq!((found.maximum.shift, found.maximum.theta), (1, 4.0));
    assert_eq!(found.decision, Decision::Inclusion);
    // γ = 2, η = 2: a miss is Φ(0), and the bound is at most 3 Φ(−2).
    assert_eq!(found.miss_bound, 0.5);
    assert!(found.false_alarm_bound <= 3.0 * 0.022_750_131_948_179_2 * (1.0 + 2e-9));
    let found = assess_scan(&scan, &law, residual, 4.1).unwrap();
    assert_eq!(found.decision, Decision::NoInclusion);
    let bad: Force<&[f64]> = Force::new(&[9.0, f64::NAN, 9.0], residual.normal);
    assert!(assess_scan(&scan, &law, bad, 2.0).is_err());
    assert!(assess_scan(&scan, &law, residual, f64::NAN).is_err());
}
