//! The checks of `palpate_verify` that no other test runs, and that all of them are run by one
//! (`spec/self-verification.md`).

use std::collections::BTreeSet;

use palpate_verify::{self as verify, Figure};

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
    assert_eq!(parts, ["diagnosis", "vectors", "fem", "kernel", "timing"]);
}

// Verifies: EVD-045.
#[test]
fn the_code_verification_of_the_solver_is_among_the_checks() {
    let checks = verify::checks().filter(|check| check.name.starts_with("fem."));
    let served: BTreeSet<&str> = checks
        .flat_map(|check| check.requirements.iter().copied())
        .collect();
    for number in 50..=62 {
        let id = format!("FEM-0{number}");
        assert!(served.contains(id.as_str()), "{id}: {served:?}");
    }
}

// Verifies: EVD-043.
#[test]
fn every_check_is_run_by_a_test() {
    let tests = [
        include_str!("self_verification.rs"),
        include_str!("fem_verification/main.rs"),
        include_str!("exhaustive.rs"),
    ];
    for check in verify::checks() {
        let quoted = format!("\"{}\"", check.name);
        assert!(
            tests.iter().any(|test| test.contains(&quoted)),
            "{} is not run",
            check.name
        );
    }
}

// Verifies: EVD-012.
#[test]
fn simulated_records_agree_with_the_closed_form() {
    for name in [
        "diagnosis.2.6_mm",
        "diagnosis.2.6_mm_loud",
        "diagnosis.4.6_mm",
        "diagnosis.4.6_mm_loud",
        "diagnosis.6.6_mm",
        "diagnosis.6.6_mm_loud",
        "diagnosis.8.6_mm",
        "diagnosis.8.6_mm_loud",
    ] {
        for figure in figures(name) {
            assert!(figure.passes(), "{figure}");
        }
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
