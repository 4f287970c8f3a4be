//! The checks of `palpate::verify` that no other test runs, and that all of them are run by one
//! (`spec/self-verification.md`).

use std::collections::BTreeSet;

use palpate::verify::{self, Figure};

/// Runs the check of this name, and gives its figures.
fn figures(name: &str) -> Vec<Figure> {
    let check = verify::find(name).unwrap_or_else(|| panic!("{name} is no check"));
    let figures = (check.run)().unwrap_or_else(|error| panic!("{name}: {error}"));
    figures
        .iter()
        .for_each(|figure| println!("{name}: {figure}"));
    figures
}

// Verifies: EVD-040, EVD-042.
#[test]
fn every_check_is_of_a_part_and_has_a_name_of_its_own_a_claim_and_requirements() {
    let mut names = BTreeSet::new();
    let mut parts = Vec::new();
    for check in verify::checks() {
        assert!(names.insert(check.name), "{} twice", check.name);
        let (part, _) = check.name.split_once('.').expect("a name has a part");
        parts.push(part);
        assert!(
            check.claim.ends_with('.') && !check.requirements.is_empty(),
            "{}",
            check.name
        );
        assert_eq!(check.repeatable, part != "timing", "{}", check.name);
    }
    parts.dedup();
    assert_eq!(parts, ["kernel", "fem", "vectors", "timing"]);
}

// Verifies: EVD-043.
#[test]
fn every_check_is_run_by_a_test() {
    let tests = [
        include_str!("self_verification.rs"),
        include_str!("fem_verification/main.rs"),
        include_str!("../proofs/tests/exhaustive.rs"),
    ];
    for check in verify::checks() {
        let quoted = format!("(\"{}\")", check.name);
        assert!(
            tests.iter().any(|test| test.contains(&quoted)),
            "{} is not run",
            check.name
        );
    }
}

// Verifies: EVD-050.
#[test]
fn the_own_oracle_answers_every_vector() {
    for figure in figures("vectors.oracle") {
        assert!(figure.passes(), "{figure}");
    }
}

// What was timed, not how long it took: no test depends on the speed of this machine.
// Verifies: EVD-051, EVD-052.
#[test]
fn times_are_taken_of_work_that_was_done() {
    for figures in [
        figures("timing.step"),
        figures("timing.loop"),
        figures("timing.force_map"),
    ] {
        // The first figure counts the work.
        assert!(
            figures[0].at_least > 0.0 && figures[0].passes(),
            "{}",
            figures[0]
        );
        for figure in &figures {
            assert!(figure.value.is_finite() && figure.value >= 0.0, "{figure}");
        }
        let times = figures.iter().filter(|figure| figure.what.ends_with("s"));
        assert!(times.clone().count() > 0);
    }
}
