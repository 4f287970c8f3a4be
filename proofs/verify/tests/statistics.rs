//! The battery of `palpate_verify::statistics`. Seeds are fixed, so nothing here is flaky; with
//! `PALPATE_SEED=<number>` the same battery runs on fresh seeds, and its checks fail by chance with
//! at most the probability that the ledger adds up to. (`palpate-verify --soak` is the way to run
//! many.)

use palpate_verify::statistics::{Check, FIXED_SEED, battery};
use rayon::prelude::*;

/// Runs all checks, and fails with what they say.
fn run(check: impl Fn(&Check, u64) -> Result<(), String> + Sync) {
    let seed = match std::env::var("PALPATE_SEED") {
        Ok(seed) => seed.parse().expect("PALPATE_SEED is a whole number"),
        Err(_) => FIXED_SEED,
    };
    let checks: Vec<&Check> = battery().collect();
    let checks = checks.into_par_iter();
    let failures: Vec<String> = checks.filter_map(|of| check(of, seed).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

// Verifies: DET-015, DET-013, DET-022, DET-025, DET-026, DET-040, DET-041, DET-050, DET-052, DET-053, DET-054, DET-070, DET-080,
// DET-111, DET-110, DET-113, DET-130, NUI-001, NUI-003, NUI-008, NUI-014, NUI-013, NUI-016, NUI-020, ROB-031, ROB-032, SEQ-001,
// SEQ-010, SEQ-012.
#[test]
fn the_detector_obeys_its_laws() {
    run(Check::run);
}

#[test]
#[ignore = "slow, and rarely breaks"]
fn planted_defects_are_seen() {
    run(Check::run_negative_controls);
}
