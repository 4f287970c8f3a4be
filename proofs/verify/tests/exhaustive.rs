//! Functions of one f32 on all 2³² of them: proofs by enumeration, by the checks of `palpate_verify::kernel`, which
//! `palpate-verify` runs too. In debug builds they take minutes: `cargo test --release -p palpate-proofs -p palpate-verify -- --ignored`.

use palpate_verify as verify;

/// Runs the check of this name, which prints its figures and fails with the first input that breaks it.
fn check(name: &str) {
    let check = verify::find(name).unwrap_or_else(|| panic!("{name} is no check"));
    let figures = check.judge().unwrap_or_else(|broken| panic!("{broken}"));
    figures
        .iter()
        .for_each(|figure| println!("{name}: {figure}"));
}

// Verifies: EVD-043.
#[test]
fn every_check_runs_here() {
    let here = include_str!("exhaustive.rs");
    for check in verify::kernel::CHECKS {
        let call = format!("check(\"{}\");", check.name);
        assert!(here.contains(&call), "{} is not run", check.name);
    }
}

// Proves: SRV-002, SRV-004, SRV-005, SRV-006.
#[test]
#[ignore = "all 2³² inputs"]
fn locate_on_an_axis_that_is_not_uniform() {
    check("kernel.locate_uneven");
}

// Proves: SRV-004, SRV-005, SRV-006.
#[test]
#[ignore = "all 2³² inputs"]
fn locate_on_a_uniform_axis() {
    check("kernel.locate_even");
}

// Proves: SRV-005, SRV-006.
#[test]
#[ignore = "all widths"]
fn no_width_carries_its_last_knot_beyond_one() {
    check("kernel.last_knot");
}

// Proves: SRV-020.
#[test]
#[ignore = "all 2³² inputs"]
fn limit_is_right_everywhere() {
    check("kernel.limit");
}

// Proves: HID-010, HID-011.
#[test]
#[ignore = "all 2³² inputs"]
fn count_is_right_everywhere() {
    check("kernel.count");
}

// Proves: SRV-010, SRV-011, SRV-013.
#[test]
#[ignore = "all 2³² inputs"]
fn blend_is_in_the_hull_everywhere() {
    check("kernel.blend");
}

// Proves: SRV-031.
#[test]
#[ignore = "all force limits"]
fn every_force_is_released_in_time() {
    check("kernel.release");
}

// Verifies: SRV-040.
#[test]
#[ignore = "16 million cycles"]
fn freshness_depends_on_the_distance_alone() {
    check("kernel.freshness");
}
