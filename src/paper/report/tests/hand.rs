//! γ where a hand tracks the path, on gels that are springs.

use super::run::*;
use crate::report::{Run, findings};
use palpate_asserts::assert_near;

/// The normal force at 4 mm of the map of a triangle of 0.3 N, and the lateral one, at x (m).
fn with(x: f64) -> [f64; 2] {
    let lateral = if x.abs() < 5e-3 {
        x / 5e-3
    } else {
        x.signum() * (2.0 - x.abs() / 5e-3)
    };
    [0.1 * lateral, 1.48 + 0.3 * (1.0 - x.abs() / 10e-3)]
}

// Verifies: REP-017.
#[test]
fn a_hand_loses_what_the_gel_pushes_it_back() {
    let found = findings(&paper_run()).unwrap();
    let of = found.maps[2].gamma_of_hand.unwrap();
    // Forces grow with the depth, so that a hand of 500 N/m at rest stands at 4 mm · 500/(500 + k), k the force at 4 mm over 4 mm.
    let depth = |normal: f64| 4e-3 * 500.0 / (500.0 + normal / 4e-3);
    let mut squares = [0.0; 3];
    for sample in 0..5 {
        let [lateral, normal] = with(-9.5e-3 + 4.75e-3 * f64::from(sample));
        let [light, heavy] = [1.48, normal].map(|normal| depth(normal) / 4e-3);
        let signal = [
            normal - 1.48,
            heavy * (normal - 1.48),
            heavy * normal - light * 1.48,
        ];
        let along = [lateral, heavy * lateral, heavy * lateral];
        for (case, square) in squares.iter_mut().enumerate() {
            *square += (signal[case] * signal[case] + along[case] * along[case]) / 0.01;
        }
    }
    let [followed, tracked, felt] = squares.map(f64::sqrt);
    assert_near(of.followed, followed, 1e-12);
    // The damper holds it back by 5 · 10 mm/s/500 = 0.1 mm, and the lateral force pushes it as far: 0.2 of 10 mm of the triangle's slope.
    assert_near(of.tracked, tracked, 0.02 * tracked);
    assert_near(of.felt, felt, 0.02 * felt);
    assert_near(of.mean_depth_m, depth(1.48), 1e-9);
    assert!(felt < 0.7 * tracked && tracked < 0.7 * followed);
}

// Verifies: REP-017.
#[test]
fn maps_that_a_hand_leaves_have_no_gamma_of_it() {
    let depths = [4e-3];
    let map = |name: &str, normal: f64| {
        let phantom = palpate::phantom::Phantom::builtin(name).ok();
        super::run::map(phantom, &depths, move |_| normal, |_| 0.0)
    };
    let run = Run {
        reference: map("none", 0.0),
        maps: vec![map("6.6", 0.1)],
        ..paper_run()
    };
    let found = findings(&run).unwrap();
    assert_eq!(found.maps[0].gamma_of_hand, None);
    assert!(!made(&run).page.contains("table-hand"));
    assert!(made(&paper_run()).page.contains("table-hand"));
}
