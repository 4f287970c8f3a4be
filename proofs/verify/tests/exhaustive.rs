//! Functions of one f32 on all 2³² of them: proofs by enumeration, by the checks of `palpate_verify::kernel`, which
//! `palpate-verify` runs too. In debug builds they take minutes: `cargo test --release -p palpate-proofs -p palpate-verify -- --ignored`.

use palpate_verify::{self as verify, Outcome};

/// Runs the checks that `picked` says, and fails with the first input that breaks one.
fn run(picked: fn(&str) -> bool) {
    let broken: Vec<String> = verify::kernel::CHECKS
        .iter()
        .filter(|check| picked(check.claim.name))
        .filter_map(|check| Outcome::of(check).complaint())
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

// Proves: HID-010, HID-011, SRV-002, SRV-004, SRV-010, SRV-011, SRV-013, SRV-020, SRV-031.
#[test]
#[ignore = "all 2³² inputs"]
fn functions_of_one_number_are_right_everywhere() {
    run(|name| name != "kernel.freshness");
}

// Verifies: SRV-040.
#[test]
#[ignore = "16 million cycles"]
fn freshness_depends_on_the_distance_alone() {
    run(|name| name == "kernel.freshness");
}
