//! From every requirement to its code, tests, proofs and vectors (`spec/traceability.md`), from the annotations in the
//! sources.
//!
//! `PALPATE_WRITE_TRACEABILITY=1 cargo test -p palpate-verify --test traceability` renews `spec/traceability.csv`; with
//! `PALPATE_TEST_LOG=FILE[:FILE…]` the tests of the trace are looked for in the output of test runs.

mod annotation;
mod crates;
mod elsewhere;
mod log;
mod planted;
mod problem;
mod rust;
mod scenarios;
mod sources;
mod spec;
mod table;
mod trace;

use std::fs;
use std::io::Write;
use std::path::Path;

use palpate_verify::traceability;
use sources::Repository;
use trace::Trace;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Whether the table is to be renewed.
fn writes() -> bool {
    std::env::var_os("PALPATE_WRITE_TRACEABILITY").is_some_and(|value| value == "1")
}

fn repository() -> Repository {
    Repository::read(Path::new(ROOT))
}

// Verifies: EVD-020, EVD-021, EVD-022, EVD-023, EVD-024, EVD-029, EVD-034.
#[test]
fn every_requirement_has_code_and_a_test_or_proof() {
    let mut trace = Trace::of(&repository());
    trace.problems.sort();
    let (all, problems) = (trace.requirements.len(), trace.problems.len());
    println!("{all} requirements");
    assert!(all > 500, "{all} requirements: are the chapters read?");
    // Straight to standard error, since what a passing test prints is not shown.
    let set = |variable: &str| std::env::var_os(variable).is_some_and(|value| value == "1");
    let unchecked = elsewhere::unchecked(&trace, set);
    std::io::stderr()
        .write_all(unchecked.as_bytes())
        .expect("standard error");
    let listed = problem::listed(&trace.problems);
    assert!(
        problems == 0,
        "{problems} problems (spec/traceability.md says what an annotation is):{listed}"
    );
}

// Verifies: EVD-030.
#[test]
fn the_committed_table_is_that_of_the_sources() {
    let path = Path::new(ROOT).join(table::PATH);
    let current = table::csv(&Trace::of(&repository()));
    if writes() {
        fs::write(&path, &current).expect("the table can be written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == current,
        "{} is not that of the sources; to renew it: PALPATE_WRITE_TRACEABILITY=1 cargo test -p palpate-verify --test traceability\n{}",
        table::PATH,
        table::differences(&committed, &current).join("\n")
    );
}

// Verifies: EVD-031.
#[test]
fn every_test_of_the_trace_ran() {
    let Some(paths) = std::env::var_os("PALPATE_TEST_LOG") else {
        println!("SKIPPED: PALPATE_TEST_LOG names no output of a test run");
        return;
    };
    let mut log = log::Log::default();
    for path in std::env::split_paths(&paths) {
        let output = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        log.read(&String::from_utf8_lossy(&output));
    }
    let trace = Trace::of(&repository());
    let missing = log.missing(&trace);
    println!("{} tests and proofs of the trace", trace.evidence.len());
    assert!(
        missing.is_empty(),
        "{} of {} tests and proofs of the trace have not passed:\n{}",
        missing.len(),
        trace.evidence.len(),
        missing.join("\n")
    );
}

// Verifies: EVD-032.
#[test]
fn the_built_in_table_says_what_the_sources_say() {
    if writes() {
        println!("SKIPPED: this program was built with the table before");
        return;
    }
    let built_in = traceability::requirements().expect("the built-in table is well formed");
    let trace = Trace::of(&repository());
    assert_eq!(
        built_in.len(),
        trace.requirements.len(),
        "renew the table, then build again"
    );
    for (ours, theirs) in trace.requirements.iter().zip(&built_in) {
        let row = &trace.rows[&ours.id];
        assert_eq!(theirs.id, ours.id);
        assert_eq!(theirs.chapter, ours.chapter);
        assert_eq!(theirs.text, ours.text);
        assert!(theirs.code.iter().eq(&row.code), "{}", ours.id);
        assert!(theirs.tests.iter().eq(&row.tests), "{}", ours.id);
        assert!(theirs.proofs.iter().eq(&row.proofs), "{}", ours.id);
        assert!(theirs.vectors.iter().eq(&row.vectors), "{}", ours.id);
        assert_eq!(theirs.inspection, ours.inspection);
    }
}
