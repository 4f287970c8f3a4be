//! The checks of `palpate_verify`, but those of the kernel (`exhaustive.rs`) and the battery (`statistics.rs`), as
//! `palpate-verify` runs them (`spec/verification-plan.md`). Run with `--nocapture` to see the figures.

use std::collections::BTreeSet;

use palpate_verify::{Outcome, checks, claims, program};
use rayon::prelude::*;

/// Carries out all checks of a part.
fn outcomes(part: &str) -> Vec<Outcome> {
    let of_part = |name: &str| name.split_once('.').is_some_and(|(of, _)| of == part);
    let found: Vec<_> = checks().filter(|check| of_part(check.claim.name)).collect();
    found.into_par_iter().map(Outcome::of).collect()
}

/// Carries them out, and fails with the figures that break their bounds.
fn pass(part: &str) {
    let outcomes = outcomes(part);
    for Outcome { name, figures, .. } in &outcomes {
        figures
            .iter()
            .for_each(|figure| println!("{name}: {figure}"));
    }
    let broken: Vec<String> = outcomes.iter().filter_map(Outcome::complaint).collect();
    assert!(
        !outcomes.is_empty() && broken.is_empty(),
        "{}",
        broken.join("\n")
    );
}

/// Whether a text says how limits were derived, and ends with the version in which they were fixed.
fn limits(text: &str) -> bool {
    let fixed = text.split_once(" Fixed in ");
    fixed.is_some_and(|(derived, version)| {
        derived.len() > 10 && ["0.1.0.", "0.2.0."].contains(&version)
    })
}

#[test]
fn every_check_is_of_a_part_and_has_a_name_of_its_own_a_claim_and_requirements() {
    let (mut names, mut parts) = (BTreeSet::new(), Vec::new());
    let mut served: BTreeSet<&str> = BTreeSet::new();
    for claim in claims() {
        assert!(names.insert(claim.name), "{} twice", claim.name);
        let (part, _) = claim.name.split_once('.').expect("a name has a part");
        parts.push(part);
        served.extend(claim.requirements);
        assert!(limits(claim.limits), "{}: {}", claim.name, claim.limits);
        let served = part == "tests" || !claim.requirements.is_empty();
        let told = claim.text.ends_with('.') && served;
        assert!(told, "{}", claim.name);
    }
    parts.dedup();
    // Each part is run by a test: the kernel's by `exhaustive.rs`.
    assert_eq!(
        parts,
        ["rates", "fem", "kernel", "timing", "program", "tests"]
    );
    for id in ["FEM-050", "FEM-059", "FEM-060", "FEM-062"] {
        assert!(served.contains(id), "{id}: {served:?}");
    }
}

// Verifies: FEM-008, FEM-009, FEM-014, FEM-013, FEM-020, FEM-026, FEM-050, FEM-059, FEM-060, FEM-062.
#[test]
#[ignore = "slow, and rarely breaks"]
fn the_solver_agrees_with_exact_solutions_and_other_programs() {
    pass("fem");
}

#[test]
fn simulated_records_agree_with_the_closed_form() {
    pass("rates");
}

#[test]
#[ignore = "slow, and rarely breaks"]
fn the_program_that_was_built_is_right_from_outside() {
    let test = std::env::current_exe().expect("a test has a path");
    let program = test.with_file_name("../palpate");
    if !program.exists() {
        let required = std::env::var_os("PALPATE_REQUIRE_WITNESSES").is_some();
        assert!(!required, "{} is not built", program.display());
        println!("SKIPPED: {} is not built", program.display());
        return;
    }
    let outcomes: Vec<Outcome> = program::CHECKS
        .par_iter()
        .map(|check| Outcome::measured(&check.claim, || (check.run)(&program)))
        .collect();
    let broken: Vec<String> = outcomes.iter().filter_map(Outcome::complaint).collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

// What was timed, not how long it took: no test depends on the speed of this machine.
#[test]
fn times_are_taken_of_work_that_was_done() {
    for Outcome {
        name,
        figures,
        failure,
        ..
    } in outcomes("timing")
    {
        // The first figure counts the work.
        assert!(
            failure.is_none() && figures[0].at_least > 0.0 && figures[0].passes(),
            "{name}: {figures:?}"
        );
        for figure in &figures {
            assert!(figure.value.is_finite() && figure.value >= 0.0, "{figure}");
        }
        assert!(figures.iter().any(|figure| figure.what.ends_with('s')));
    }
}
