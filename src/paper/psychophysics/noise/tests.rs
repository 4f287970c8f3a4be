//! The paper's print, and closed forms.

use super::*;
use crate::psychophysics::Bounds;
use palpate_asserts::{assert_has, assert_near};

// Verifies: PSY-060.
#[test]
fn noise_is_the_image_of_gamma() {
    let of = |correct| noise_bounds(2.0, Rate::new(correct, 30).unwrap().gamma);
    let rate = Rate::new(26, 30).unwrap();
    let (noise, bounds) = of(26);
    let ends = rate.gamma.bounds;
    for (found, gamma) in [
        (noise, rate.gamma.gamma),
        (bounds.lower, ends.upper),
        (bounds.upper, ends.lower),
    ] {
        assert_near(found.unwrap(), 2.0 / gamma.unwrap(), 1e-15);
    }
    // All right: no noise can be named, and none is too small.
    let (noise, bounds) = of(30);
    assert_eq!((noise, bounds.lower), (None, Some(0.0)));
    assert!(bounds.upper.is_some());
    // Guesses: no noise is too large.
    let (noise, bounds) = of(14);
    assert_eq!((noise, bounds.upper), (None, None));
    let (lower, upper) = (0.2, 1.0);
    let half = GammaEstimate::of(0.5, Bounds { lower, upper }).unwrap();
    let (lower, upper) = (Some(0.0), None);
    assert_eq!(noise_bounds(2.0, half).1, OpenBounds { lower, upper });
}

// Verifies: PSY-061.
#[test]
fn the_levels_of_section_5() {
    let found = paper_noise_levels().unwrap();
    let noise: Vec<f64> = found.levels.iter().map(|level| level.noise_n).collect();
    let expected = [
        340.0 / 1.45,
        // mpmath: 340/(√2 Φ⁻¹(253/300)).
        238.44854542424173,
        (140.0_f64 * 140.0 + 93.0 * 93.0 + 0.25).sqrt(),
        (200.0_f64 * 200.0 + 93.0 * 93.0).sqrt(),
        (140.0_f64 * 140.0 + 93.0 * 93.0 + 0.25 + 400.0).sqrt(),
    ];
    for (noise, expected) in noise.into_iter().zip(expected) {
        assert_near(noise, 1e-3 * expected, 1e-15);
    }
    // What the paper prints is within its rounding of ours, but for the γ that it read off.
    let printed: Vec<_> = found.levels.iter().map(|level| level.printed_n).collect();
    assert_eq!(printed, [Some(0.235), None, Some(0.17), Some(0.22), None]);
    assert_eq!(found.levels[2].formula, "√(0.5² + 140² + 93²) mN");
    let mut assumptions = found.levels.iter().map(|level| level.assumption);
    assert!(assumptions.all(|words| !words.is_empty()));
}

// Table 2's 168 mN against 0.34 N/γ at the ends of 253/300: scipy gives shares of 0.7972 to 0.8826 pooled, so γ = 1.176
// to 1.680 and 202 to 289 mN; 0.7415 to 0.9452 with the subjects as the sample, so 150 to 371 mN.
// Verifies: PSY-061.
#[test]
fn table_2_is_within_the_honest_interval_only() {
    let found = paper_noise_levels().unwrap();
    let answers = &found.levels[1];
    let lower = |bounds: Option<OpenBounds>| bounds.unwrap().lower.unwrap();
    assert_near(lower(answers.pooled_bounds_n), 0.2024, 5e-5);
    assert_near(lower(answers.clustered_bounds_n), 0.1503, 5e-5);
    // The words follow the numbers.
    let by = |noise: f64| agreement(answers, noise);
    let words = "It lies outside the 95 % interval of all answers pooled|and inside the 95 % interval of the subjects";
    assert_has(&found.agreement, words);
    assert_has(&by(0.25), "It lies inside the 95 % interval of all answers");
    assert_has(&by(0.05), "outside the 95 % interval of the subjects");
}
