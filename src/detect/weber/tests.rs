//! Expected values: mpmath 1.4.1 at 40 digits. θ is the logarithm of the quotient of the densities.

use super::super::theta_of_record;
use super::*;
use crate::stats::tests::assert_near;

const OBSERVED: Force<&[f64]> = Force::new(&[0.1, 0.5, -0.2], &[1.7, 1.9, 1.3]);
const F0: Force<&[f64]> = Force::new(&[0.0, 0.1, 0.2], &[1.6, 1.5, 1.4]);
const F1: Force<&[f64]> = Force::new(&[0.3, -0.2, 0.25], &[1.94, 1.8, 1.55]);
const NOISE: Force<WeberNoise> = Force {
    lateral: WeberNoise {
        floor: 0.07,
        fraction: 0.2,
    },
    normal: WeberNoise {
        floor: 0.1,
        fraction: 0.125,
    },
};

// Verifies: DET-080, DET-081.
#[test]
fn likelihood_ratio_of_forces_with_noise_in_proportion() {
    // Six terms of up to 20 with about six roundings each.
    assert_near(
        theta_weber(OBSERVED, F0, F1, NOISE).unwrap(),
        -25.296744225015495,
        1e-13,
    );
}

// Verifies: DET-081.
#[test]
fn constant_noise_is_the_special_case_of_fraction_zero() {
    let noise = NOISE.map(|noise| WeberNoise {
        fraction: 0.0,
        ..noise
    });
    let expected = theta_of_record(OBSERVED, F0, F1, noise.map(|noise| noise.floor)).unwrap();
    assert_near(
        theta_weber(OBSERVED, F0, F1, noise).unwrap(),
        expected.theta,
        1e-12,
    );
}

// Verifies: DET-081.
#[test]
fn exchanging_the_hypotheses_changes_the_sign() {
    let forth = theta_weber(OBSERVED, F0, F1, NOISE).unwrap();
    let back = theta_weber(OBSERVED, F1, F0, NOISE).unwrap();
    assert_near(forth, -back, 1e-13);
}

// Verifies: DET-005, DET-006, DET-007, DET-008.
#[test]
fn what_cannot_be_judged_is_refused() {
    let names = ["observed_x", "observed_y", "f0_x", "f0_y", "f1_x", "f1_y"];
    let all = [
        OBSERVED.lateral,
        OBSERVED.normal,
        F0.lateral,
        F0.normal,
        F1.lateral,
        F1.normal,
    ];
    let judge = |series: [&[f64]; 6]| {
        let [ox, oy, ax, ay, bx, by] = series;
        let channels = |x, y| Force::new(x, y);
        theta_weber(channels(ox, oy), channels(ax, ay), channels(bx, by), NOISE).unwrap_err()
    };
    for (position, what) in names.into_iter().enumerate() {
        let bad = [1.0, f64::NAN, 1.0];
        let mut series = all;
        series[position] = &bad;
        assert_eq!(judge(series), DetectError::NotFinite { what, index: 1 });
        series[position] = &all[position][..2];
        assert!(matches!(judge(series), DetectError::LengthMismatch { .. }));
    }
    for noise in [
        (0.0, 0.1),
        (-1.0, 0.1),
        (0.1, -0.1),
        (f64::NAN, 0.1),
        (0.1, f64::INFINITY),
    ] {
        let noise = Force {
            lateral: WeberNoise {
                floor: noise.0,
                fraction: noise.1,
            },
            ..NOISE
        };
        assert!(theta_weber(OBSERVED, F0, F1, noise).is_err());
        // Nor where every force is so far from 0 that its noise has a finite size without the floor.
        let [here, there] = [[1.0; 3], [2.0; 3]];
        let [f0, f1] = [&here, &there].map(|force| Force::new(&force[..], &force[..]));
        assert!(theta_weber(f0, f0, f1, noise).is_err());
    }
    let far = Force::new(&[1e200, 0.0, 0.0][..], F0.normal);
    assert_eq!(
        theta_weber(far, F0, F1, NOISE),
        Err(DetectError::Overflow { what: "theta" })
    );
}
