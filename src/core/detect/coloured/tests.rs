//! Expected values: mpmath 1.4.1 at 50 digits, γ² = ΔᵀK⁻¹Δ and θ = ΔᵀK⁻¹(r − Δ/2) by LU, for the
//! exact binary64 arguments; or closed forms, where named.

use super::super::{Force, MatchedFilter};
use super::*;
use crate::stats::random::Generator;
use palpate_asserts::assert_near;
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

// Verifies: DET-043.
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

// Verifies: DET-005, DET-046.
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
}

const LONG_TEMPLATE: Force<&[f64]> = Force::new(
    &[0.1, 0.3, -0.2, 0.5, 0.4, -0.1, 0.05],
    &[0.0, 0.2, 0.34, 0.31, 0.2, 0.1, 0.0],
);
const LONG_RESIDUAL: Force<&[f64]> = Force::new(
    &[0.2, 0.1, -0.3, 0.6, 0.2, 0.0, -0.1],
    &[0.1, 0.1, 0.4, 0.2, 0.3, -0.1, 0.05],
);

/// Deviates for a record: any numbers will do.
fn numbers(stream: u64, count: usize) -> Vec<f64> {
    let mut numbers = vec![0.0; count];
    Generator::new(99, stream).normals(0, 0, &mut numbers);
    numbers
}

// Verifies: DET-040.
#[test]
fn exponential_autocovariance_has_a_closed_form() {
    // ρ(k) = v aᵏ is a first-order autoregression: white are n₀/√v and (nᵢ − a nᵢ₋₁)/√(v(1−a²)).
    const SAMPLES: usize = 200;
    let (template, residual) = (numbers(0, 2 * SAMPLES), numbers(1, 2 * SAMPLES));
    let (variance, memory) = ([0.3, 2.0], [0.8_f64, -0.5]);
    let mut covariance = vec![0.0; 4 * SAMPLES * SAMPLES];
    let mut expected = (0.0, 0.0);
    for channel in 0..2 {
        let (v, a, first) = (variance[channel], memory[channel], channel * SAMPLES);
        for i in first..first + SAMPLES {
            for j in first..first + SAMPLES {
                covariance[i * 2 * SAMPLES + j] = v * a.powi(i.abs_diff(j) as i32);
            }
            let white = |n: &[f64]| match i == first {
                true => n[i] / v.sqrt(),
                false => (n[i] - a * n[i - 1]) / (v * (1.0 - a * a)).sqrt(),
            };
            let (t, r) = (white(&template), white(&residual));
            expected.0 += t * t;
            expected.1 += t * (r - 0.5 * t);
        }
    }
    let found = dense(&residual, &template, &covariance).unwrap();
    let gamma = expected.0.sqrt();
    assert_near(found.gamma, gamma, TOLERANCE * gamma);
    assert_near(found.theta, expected.1, TOLERANCE * expected.0);
}

// Verifies: DET-041.
#[test]
fn white_noise_is_a_special_case() {
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
    let found = dense(&residual, &template, covariance.as_flattened()).unwrap();
    // s² and a division round where white noise does not.
    let gamma = expected.gamma;
    assert_near(found.gamma, gamma, 8.0 * f64::EPSILON * gamma);
    let tolerance = 8.0 * f64::EPSILON * gamma * gamma;
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
    }
}

// Verifies: DET-043.
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

// Verifies: DET-048, DET-005.
#[test]
fn the_evidence_is_that_of_either_whole_covariance() {
    let (record, signal, covariance) = ([1.0, -0.5], [0.75, 2.0], [2.0, 0.5, 0.5, 1.0]);
    let scratch = &mut [0.0; coloured_scratch(2)];
    // ln of the density of y with covariance (a, b; b, c), by the inverse in closed form, and its distance squared.
    let density = |[x, y]: [f64; 2], [a, b, c]: [f64; 3]| {
        let determinant = a * c - b * b;
        let distance = (c * x * x - 2.0 * b * x * y + a * y * y) / determinant;
        [-0.5 * (distance + determinant.ln()), distance]
    };
    for sd in [0.0, 0.4, 3.0] {
        let found = evidence_coloured(&record, &signal, &covariance, sd, scratch).unwrap();
        let more = |i: usize, j: usize| sd * sd * signal[i] * signal[j];
        let without = density(record, [2.0, 0.5, 1.0]);
        let whole = [2.0 + more(0, 0), 0.5 + more(0, 1), 1.0 + more(1, 1)];
        let with = density([record[0] - signal[0], record[1] - signal[1]], whole);
        let found_all = [
            [found.without, found.distance_without],
            [found.with, found.distance_with],
        ];
        for (found, expected) in found_all
            .iter()
            .flatten()
            .zip([without, with].as_flattened())
        {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
    // A record that is the signal, but for a rounding.
    let alike = ColouredEvidence::of_white(0.0, [0.1, 0.1], 0.1_f64.next_up(), 0.4);
    assert_eq!(alike.distance_with, 0.0);
    for sd in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(evidence_coloured(&record, &signal, &covariance, sd, scratch).is_err());
    }
    // A signal whose square no number holds changes the evidence with it alone.
    let found = evidence_coloured(&record, &[1e200, 0.0], &covariance, 0.4, scratch);
    assert_eq!(found, Err(DetectError::Overflow { what: "with" }));
}
