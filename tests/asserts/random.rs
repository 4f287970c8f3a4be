//! Numbers at random, the same in every run.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// The cases of a seed.
pub fn seeded(seed: u64) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// A finite number of any size.
pub fn finite() -> impl Strategy<Value = f64> {
    let any = any::<u64>().prop_map(f64::from_bits);
    any.prop_filter("finite", |value| value.is_finite())
}

/// The positions after `from` by these steps.
pub fn axis(from: f64, steps: &[f64]) -> Vec<f64> {
    let mut position = from;
    let next = |step: &f64| {
        position += step;
        position
    };
    steps.iter().map(next).collect()
}
