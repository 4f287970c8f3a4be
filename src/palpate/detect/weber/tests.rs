//! Expected values: mpmath 1.4.1 at 40 digits. θ is the logarithm of the quotient of the densities.

use super::*;
use crate::detect::theta_of_record;
use palpate_asserts::assert_near;

const OBSERVED: Force<&[f64]> = Force::new(&[0.1, 0.5, -0.2], &[1.7, 1.9, 1.3]);
const F0: Force<&[f64]> = Force::new(&[0.0, 0.1, 0.2], &[1.6, 1.5, 1.4]);
const F1: Force<&[f64]> = Force::new(&[0.3, -0.2, 0.25], &[1.94, 1.8, 1.55]);
const NOISE: Force<WeberNoise> = Force::new(weber(0.07, 0.2), weber(0.1, 0.125));

const fn weber(floor: f64, fraction: f64) -> WeberNoise {
    WeberNoise { floor, fraction }
}

// Verifies: DET-080.
#[test]
fn likelihood_ratio_of_forces_with_noise_in_proportion() {
    // Six terms of up to 20 with about six roundings each.
    let theta = theta_weber(OBSERVED, F0, F1, NOISE).unwrap();
    assert_near(theta, -25.296744225015495, 1e-13);
}

// Verifies: DET-080.
#[test]
fn constant_noise_is_the_special_case_of_fraction_zero() {
    let noise = NOISE.map(|noise| weber(noise.floor, 0.0));
    let expected = theta_of_record(OBSERVED, F0, F1, noise.map(|noise| noise.floor)).unwrap();
    let theta = theta_weber(OBSERVED, F0, F1, noise).unwrap();
    assert_near(theta, expected.theta, 1e-12);
}

// Verifies: DET-080.
#[test]
fn exchanging_the_hypotheses_changes_the_sign() {
    let forth = theta_weber(OBSERVED, F0, F1, NOISE).unwrap();
    let back = theta_weber(OBSERVED, F1, F0, NOISE).unwrap();
    assert_near(forth, -back, 1e-13);
}

// Verifies: DET-005, DET-008.
#[test]
fn what_cannot_be_judged_is_refused() {
    let names = ["observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y"];
    let all = [OBSERVED, F0, F1].map(Force::into_array);
    let judge = |series: [[&[f64]; 2]; 3]| {
        let [observed, f0, f1] = series.map(|[x, y]| Force::new(x, y));
        theta_weber(observed, f0, f1, NOISE).unwrap_err()
    };
    for (position, what) in names.into_iter().enumerate() {
        let bad = [1.0, f64::NAN, 1.0];
        let mut series = all;
        let changed = &mut series[position / 2][position % 2];
        let short = &changed[..2];
        *changed = &bad;
        assert_eq!(judge(series), DetectError::NotFinite { what, index: 1 });
        series[position / 2][position % 2] = short;
        assert!(matches!(judge(series), DetectError::LengthMismatch { .. }));
    }
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    for (floor, fraction) in [(0.0, 0.1), (-1.0, 0.1), (0.1, -0.1), (nan, 0.1), (0.1, inf)] {
        let noise = Force::new(weber(floor, fraction), NOISE.normal);
        assert!(theta_weber(OBSERVED, F0, F1, noise).is_err());
        // Nor where every force is so far from 0 that its noise has a finite size without the floor.
        let [here, there] = [[1.0; 3], [2.0; 3]];
        let [f0, f1] = [&here, &there].map(|force| Force::new(&force[..], &force[..]));
        assert!(theta_weber(f0, f0, f1, noise).is_err());
    }
    let far = Force::new(&[1e200, 0.0, 0.0][..], F0.normal);
    let beyond = theta_weber(far, F0, F1, NOISE).unwrap_err();
    assert_eq!(beyond, DetectError::Overflow { what: "theta" });
}
