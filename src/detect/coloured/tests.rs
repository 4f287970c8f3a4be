//! Expected values: mpmath 1.4.1 at 50 digits, γ² = ΔᵀK⁻¹Δ and θ = ΔᵀK⁻¹(r − Δ/2) by LU, for the
//! exact binary64 arguments; or closed forms, where named.

use super::super::stationary::{banded_scratch, theta_banded, theta_stationary};
use super::super::{Force, MatchedFilter};
use super::*;
use crate::stats::random::Generator;
use crate::stats::tests::assert_near;
extern crate std;
use std::{format, vec, vec::Vec};

const COVARIANCE: [[f64; 6]; 6] = [
    [0.04, 0.01, 0.002, 0.005, 0.0, 0.001],
    [0.01, 0.05, 0.01, 0.004, 0.003, 0.0],
    [0.002, 0.01, 0.04, 0.002, 0.001, 0.006],
    [0.005, 0.004, 0.002, 0.09, 0.03, 0.01],
    [0.0, 0.003, 0.001, 0.03, 0.08, 0.02],
    [0.001, 0.0, 0.006, 0.01, 0.02, 0.07],
];
const TEMPLATE: [f64; 6] = [0.25, -0.5, 0.125, 0.34, 0.31, 0.22];
const RESIDUAL: [f64; 6] = [0.3, -0.4, 0.2, 0.4, 0.1, 0.3];

fn dense(
    residual: &[f64],
    template: &[f64],
    covariance: &[f64],
) -> Result<ColouredStatistic, DetectError> {
    let scratch = &mut vec![0.0; coloured_scratch(template.len())];
    theta_coloured(residual, template, covariance, scratch)
}

/// The condition number of every covariance here is below 100, and each of the orders ≤ 200 of
/// steps of the factor rounds a few times: 100 · 200 · 4u.
const TOLERANCE: f64 = 1e-11;

// Verifies: DET-040, DET-041.
#[test]
fn dense_covariance_with_both_channels_correlated() {
    let found = dense(&RESIDUAL, &TEMPLATE, COVARIANCE.as_flattened()).unwrap();
    assert_near(found.gamma, 3.4182453330542018, 1e-14);
    assert_near(found.theta, 5.00985322113691, 2e-14);
}

// Verifies: DET-041.
#[test]
fn forces_in_other_units_give_the_same_statistic() {
    let expected = dense(&RESIDUAL, &TEMPLATE, COVARIANCE.as_flattened()).unwrap();
    for unit in [2_f64.powi(-500), 2_f64.powi(500)] {
        let scaled = |of: &[f64], unit: f64| -> Vec<f64> { of.iter().map(|v| v * unit).collect() };
        let [residual, template] = [RESIDUAL, TEMPLATE].map(|of| scaled(&of, unit));
        let covariance = scaled(COVARIANCE.as_flattened(), unit * unit);
        assert_eq!(dense(&residual, &template, &covariance), Ok(expected));
    }
}

// Verifies: DET-042, DET-043.
#[test]
fn covariances_that_are_none_are_refused() {
    let change = |changes: &[(usize, usize, f64)]| {
        let mut covariance = COVARIANCE;
        for &(row, column, value) in changes {
            covariance[row][column] = value;
        }
        dense(&RESIDUAL, &TEMPLATE, covariance.as_flattened()).unwrap_err()
    };
    use DetectError::{NotFinite, NotPositiveDefinite, NotSymmetric};
    let (what, index) = ("covariance", 14);
    for (changes, expected) in [
        (&[(0, 3, 0.0051)][..], NotSymmetric { row: 3, column: 0 }),
        // Correlation above 1, a variance of 0 and below 0, and two samples that are one.
        (
            &[(0, 1, 0.05), (1, 0, 0.05)],
            NotPositiveDefinite { pivot: 1 },
        ),
        (&[(4, 4, 0.0)], NotPositiveDefinite { pivot: 4 }),
        (&[(4, 4, -1.0)], NotPositiveDefinite { pivot: 4 }),
        (&[(2, 2, f64::NAN)], NotFinite { what, index }),
    ] {
        assert_eq!(change(changes), expected);
    }
    let singular = [0.1, 0.3, 0.3, 0.9].map(|v: f64| v / 3.0);
    let found = dense(&[0.0, 1.0], &[1.0, 0.0], &singular).unwrap_err();
    assert_eq!(found, NotPositiveDefinite { pivot: 1 });
}

// Verifies: DET-005, DET-007, DET-046.
#[test]
fn arguments_that_do_not_fit_are_refused() {
    let covariance = COVARIANCE.as_flattened();
    assert!(dense(&[], &[], &[]).is_err());
    assert!(dense(&RESIDUAL[..5], &TEMPLATE, covariance).is_err());
    assert!(dense(&RESIDUAL, &TEMPLATE, &covariance[..35]).is_err());
    for found in [47, 49] {
        let scratch = &mut vec![0.0; found];
        let wrong = theta_coloured(&RESIDUAL, &TEMPLATE, covariance, scratch).unwrap_err();
        let (what, expected) = ("scratch", 48);
        assert_eq!(
            wrong,
            DetectError::LengthMismatch {
                what,
                expected,
                found
            }
        );
    }
    let mut bad = RESIDUAL;
    bad[3] = f64::INFINITY;
    let (what, index) = ("residual", 3);
    let expected = DetectError::NotFinite { what, index };
    assert_eq!(dense(&bad, &TEMPLATE, covariance), Err(expected));
    fn both(v: &[f64]) -> Force<&[f64]> {
        Force::new(v, v)
    }
    let (two, one) = ([1.0, 0.5], [1.0]);
    let two = both(&two[..]);
    assert!(theta_stationary(two, two, both(&one), &mut [0.0; 4]).is_err());
    assert!(theta_stationary(two, two, two, &mut [0.0; 3]).is_err());
    assert!(theta_banded(two, two, both(&[]), &mut []).is_err());
    assert!(theta_banded(two, two, both(&[1.0, 0.1, 0.0]), &mut [0.0; 18]).is_err());
    let uneven = Force::new(&one[..], &[1.0, 0.5]);
    for (residual, template) in [(both(&one), two), (uneven, two), (two, uneven)] {
        let stationary = theta_stationary(residual, template, two, &mut [0.0; 4]);
        let banded = theta_banded(residual, template, two, &mut [0.0; 10]);
        for found in [stationary, banded] {
            assert!(matches!(found, Err(DetectError::LengthMismatch { .. })));
        }
    }
    for bad in [[-1.0, 0.0], [1.0, 1.0], [1.0, f64::NAN]] {
        assert!(theta_stationary(two, two, both(&bad), &mut [0.0; 4]).is_err());
        assert!(theta_banded(two, two, both(&bad), &mut [0.0; 10]).is_err());
    }
}

const LONG_TEMPLATE: Force<&[f64]> = Force::new(
    &[0.1, 0.3, -0.2, 0.5, 0.4, -0.1, 0.05],
    &[0.0, 0.2, 0.34, 0.31, 0.2, 0.1, 0.0],
);
const LONG_RESIDUAL: Force<&[f64]> = Force::new(
    &[0.2, 0.1, -0.3, 0.6, 0.2, 0.0, -0.1],
    &[0.1, 0.1, 0.4, 0.2, 0.3, -0.1, 0.05],
);

// Verifies: DET-044, DET-045.
#[test]
fn stationary_noise_by_either_method() {
    let lags: Force<&[f64]> = Force::new(&[0.05, 0.02, -0.005], &[0.08, -0.03, 0.01]);
    // What was in the scratch has no say.
    let scratch = &mut vec![f64::NAN; banded_scratch(3)];
    let banded = theta_banded(LONG_RESIDUAL, LONG_TEMPLATE, lags, scratch).unwrap();
    let padded = lags.map(|lags| {
        let mut padded = [0.0; 7];
        padded[..3].copy_from_slice(lags);
        padded
    });
    let padded = Force::new(&padded.lateral[..], &padded.normal[..]);
    let levinson =
        theta_stationary(LONG_RESIDUAL, LONG_TEMPLATE, padded, &mut [f64::NAN; 14]).unwrap();
    for found in [banded, levinson] {
        assert_near(found.gamma, 5.233014428250506, 2e-14);
        assert_near(found.theta, 13.81510961793283, 5e-14);
    }
}

/// Deviates for a record: any numbers will do.
fn numbers(stream: u64, count: usize) -> Vec<f64> {
    let mut numbers = vec![0.0; count];
    Generator::new(99, stream).normals(0, 0, &mut numbers);
    numbers
}

// Verifies: DET-044.
#[test]
fn exponential_autocovariance_has_a_closed_form() {
    // ρ(k) = v aᵏ is a first-order autoregression: white are n₀/√v and (nᵢ − a nᵢ₋₁)/√(v(1−a²)).
    const SAMPLES: usize = 200;
    let (template, residual) = (numbers(0, 2 * SAMPLES), numbers(1, 2 * SAMPLES));
    let (variance, memory) = (Force::new(0.3, 2.0), Force::new(0.8, -0.5));
    let lags = variance.zip(memory).map(|(v, a): (f64, f64)| {
        let lags = (0..SAMPLES as i32).map(|lag| v * a.powi(lag));
        lags.collect::<Vec<_>>()
    });
    let split = |v: &'static [f64]| Force::new(&v[..SAMPLES], &v[SAMPLES..]);
    let (template, residual) = (split(Vec::leak(template)), split(Vec::leak(residual)));
    let mut expected = (0.0, 0.0);
    let noise = variance.zip(memory);
    for ((t, r), (v, a)) in template.zip(residual).zip(noise).into_array() {
        for i in 0..SAMPLES {
            let white = |n: &[f64]| match i {
                0 => n[0] / v.sqrt(),
                _ => (n[i] - a * n[i - 1]) / (v * (1.0 - a * a)).sqrt(),
            };
            expected.0 += white(t) * white(t);
            expected.1 += white(t) * (white(r) - 0.5 * white(t));
        }
    }
    let lags = Force::new(&lags.lateral[..], &lags.normal[..]);
    let found = theta_stationary(residual, template, lags, &mut [0.0; 2 * SAMPLES]).unwrap();
    let gamma = expected.0.sqrt();
    assert_near(found.gamma, gamma, TOLERANCE * gamma);
    assert_near(found.theta, expected.1, TOLERANCE * expected.0);
}

// Verifies: DET-041, DET-044, DET-045.
#[test]
fn white_noise_is_a_special_case_of_every_colour() {
    let sd = Force::new(0.3, 0.2);
    let filter = MatchedFilter::new(LONG_TEMPLATE, sd).unwrap();
    let expected = filter.statistic(LONG_RESIDUAL).unwrap();
    let mut covariance = [[0.0; 14]; 14];
    for (i, row) in covariance.iter_mut().enumerate() {
        let sd = if i < 7 { sd.lateral } else { sd.normal };
        row[i] = sd * sd;
    }
    let join = |c: Force<&[f64]>| [c.lateral, c.normal].concat();
    let (residual, template) = (join(LONG_RESIDUAL), join(LONG_TEMPLATE));
    let mut found = vec![dense(&residual, &template, covariance.as_flattened()).unwrap()];
    let variance = sd.map(|sd| [sd * sd]);
    let lags = Force::new(&variance.lateral[..], &variance.normal[..]);
    found.push(theta_banded(LONG_RESIDUAL, LONG_TEMPLATE, lags, &mut [0.0; 4]).unwrap());
    let padded = variance.map(|v| [v[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let lags = Force::new(&padded.lateral[..], &padded.normal[..]);
    found.push(theta_stationary(LONG_RESIDUAL, LONG_TEMPLATE, lags, &mut [0.0; 14]).unwrap());
    for found in found {
        // s² and a division round where white noise does not.
        let gamma = expected.gamma;
        assert_near(found.gamma, gamma, 8.0 * f64::EPSILON * gamma);
        let tolerance = 8.0 * f64::EPSILON * gamma * gamma;
        assert_near(found.theta, expected.theta, tolerance);
    }
}

// Verifies: DET-045.
#[test]
fn a_long_record_in_banded_noise_agrees_with_its_dense_covariance() {
    const SAMPLES: usize = 100;
    let (template, residual) = (numbers(2, 2 * SAMPLES), numbers(3, 2 * SAMPLES));
    let lags = [1.0, 0.5, 0.2, -0.1];
    let mut covariance = vec![0.0; 4 * SAMPLES * SAMPLES];
    for i in 0..2 * SAMPLES {
        for j in 0..2 * SAMPLES {
            if (i < SAMPLES) == (j < SAMPLES) && i.abs_diff(j) < 4 {
                covariance[i * 2 * SAMPLES + j] = lags[i.abs_diff(j)];
            }
        }
    }
    let expected = dense(&residual, &template, &covariance).unwrap();
    let channels = |v: &'static [f64]| Force::new(&v[..SAMPLES], &v[SAMPLES..]);
    let (residual, template) = (channels(Vec::leak(residual)), channels(Vec::leak(template)));
    let lags = Force::new(&lags[..], &lags[..]);
    let found = theta_banded(residual, template, lags, &mut vec![0.0; banded_scratch(4)]).unwrap();
    assert_near(found.gamma, expected.gamma, TOLERANCE * expected.gamma);
    let tolerance = TOLERANCE * expected.gamma * expected.gamma;
    assert_near(found.theta, expected.theta, tolerance);
}

/// The covariance of two samples a channel: unit variance times `power`, correlated by
/// `correlation` in the first channel.
fn pair(correlation: f64, power: f64) -> [f64; 16] {
    let (p, c) = (power, power * correlation);
    #[rustfmt::skip]
    let covariance = [
        p,   c,   0.0, 0.0,
        c,   p,   0.0, 0.0,
        0.0, 0.0, p,   0.0,
        0.0, 0.0, 0.0, p,
    ];
    covariance
}

// Verifies: DET-043.
#[test]
fn a_pivot_counts_as_positive_beyond_what_rounding_explains() {
    // With correlation 1 − δ the second pivot is 2δ − δ². In doubt are those to 4 (order + 2) ε.
    const E: f64 = f64::EPSILON;
    for power in [1.0, 1e-6, 1e6] {
        let dense = |delta: f64| dense(&[0.0; 4], &[1.0; 4], &pair(1.0 - delta, power));
        assert!(dense(14.0 * E).is_ok(), "28 ε, beyond 4 (4 + 2) ε");
        let refused = Err(DetectError::NotPositiveDefinite { pivot: 1 });
        assert_eq!(dense(11.0 * E), refused);
        // Three samples, so 4 (3 + 2) ε; an autoregression, whose third pivot equals the second.
        let stationary = |delta: f64| {
            let lags = [power, power * (1.0 - delta), power * (1.0 - delta).powi(2)];
            let white = [power, 0.0, 0.0];
            let channels = Force::new(&lags[..], &white);
            let nothing = Force::new(&[0.0; 3][..], &[0.0; 3]);
            theta_stationary(nothing, nothing, channels, &mut [0.0; 6])
        };
        assert!(stationary(11.0 * E).is_ok(), "22 ε, beyond 20 ε");
        assert_eq!(stationary(9.0 * E), refused);
    }
}

// Verifies: DET-042.
#[test]
fn asymmetry_counts_beyond_what_rounding_explains() {
    // Three unlike variances, so that each has its own tolerance 1e-12 of the two deviations.
    let variance = [1.0, 1e4, 1e-8, 1e-2];
    for row in 0..4 {
        for column in 0..row {
            let size = libm::sqrt(variance[row] * variance[column]);
            for (share, symmetric) in [(0.5, true), (2.0, false), (-2.0, false)] {
                let mut covariance = [0.0; 16];
                for i in 0..4 {
                    covariance[5 * i] = variance[i];
                }
                covariance[4 * row + column] = 0.25 * size + share * 1e-12 * size;
                covariance[4 * column + row] = 0.25 * size;
                let found = dense(&[0.0; 4], &[1.0; 4], &covariance);
                let expected = Err(DetectError::NotSymmetric { row, column });
                let case = format!("{row} {column} {share}: {found:?}");
                assert_eq!(found == expected, !symmetric, "{case}");
            }
        }
    }
}

// Verifies: DET-045.
#[test]
fn as_many_lags_as_samples_are_a_band() {
    let lags = Force::new(&[1.0, 0.5][..], &[1.0, 0.5]);
    let ones = Force::new(&[1.0, 1.0][..], &[1.0, 1.0]);
    let found = theta_banded(ones, ones, lags, &mut [0.0; banded_scratch(2)]).unwrap();
    // Each channel: 1ᵀK⁻¹1 = 2/1.5; γ² twice that, and θ half of it.
    assert_near(found.theta, 4.0 / 3.0, 16.0 * f64::EPSILON);
}
