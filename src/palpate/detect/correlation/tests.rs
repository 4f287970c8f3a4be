use super::*;
use crate::stats::random::Generator;

/// White noise.
fn white(samples: u64, stream: u64) -> Vec<f64> {
    let generator = Generator::new(20_261_122, stream);
    (0..samples).map(|i| generator.normal(0, i)).collect()
}

// Verifies: NUI-020.
#[test]
fn the_test_for_white_noise() {
    let series: Vec<f64> = (0..40_u32)
        .map(|i| f64::from((i * i * 7 + 3 * i) % 11) / 4.0 - 1.0)
        .collect();
    // SciPy: chi2.sf of the same sum.
    let expected = 9.408_746_991_682_236e-9;
    assert!((ljung_box(&series, 5).unwrap() / expected - 1.0).abs() < 1e-12);
    assert!(ljung_box(&series, 0).is_err());
    assert!(ljung_box(&series, 40).is_err());
    // At most as many as 5 % of 400 and five standard deviations.
    let rejected = (0..400).filter(|&stream| ljung_box(&white(200, stream), 20).unwrap() < 0.05);
    assert!((2..=42).contains(&rejected.count()));
}

// Verifies: NUI-021.
#[test]
fn the_length_of_a_correlation() {
    let noise = white(20_000, 1);
    assert!(correlation_length(&noise) < 1.1);
    // Each value ten times: Σ over |k| < 10 of (10 − |k|)/10 is 10. The estimate has a standard deviation of about √(2 · 51/20000) of it.
    let held: Vec<f64> = noise
        .iter()
        .take(2_000)
        .flat_map(|&value| [value; 10])
        .collect();
    assert!((correlation_length(&held) / 10.0 - 1.0).abs() < 0.36);
    // A low pass with ρ_k = 0.8^k has (1 + 0.8)/(1 − 0.8) = 9.
    let mut state = 0.0;
    let low_pass = noise.iter().map(|value| {
        state = 0.8 * state + value;
        state
    });
    let low_pass: Vec<f64> = low_pass.collect();
    assert!((correlation_length(&low_pass) / 9.0 - 1.0).abs() < 0.36);
    assert_eq!(correlation_length(&[0.0; 5]), 1.0);
    assert_eq!(correlation_length(&[1.0, -1.0, 1.0, -1.0]), 1.0);
    assert_eq!(correlation_length(&[]), 1.0);
}
