//! From every requirement to its code, tests, proofs and vectors (`spec/verification-plan.md`), from the annotations in the
//! sources.
//!
//! `PALPATE_WRITE_TRACEABILITY=1 cargo test -p palpate-verify --test traceability` renews `spec/traceability.csv`; with
//! `PALPATE_TEST_LOG=FILE[:FILE…]` the tests of the trace are looked for in the output of test runs, and with
//! `PALPATE_TEST_RECORD=FILE` what became of them is written there.

mod elsewhere;
mod log;
mod planted;
mod repository;
mod rust;
mod spec;
mod trace;

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;

use palpate_verify::traceability;
use trace::{Problems, Trace};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Whether a variable of the environment is set to 1.
fn set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| value == "1")
}

/// Whether the table is to be renewed.
fn writes() -> bool {
    set("PALPATE_WRITE_TRACEABILITY")
}

fn trace() -> Trace {
    Trace::of(&repository::read(Path::new(ROOT)))
}

/// All problems, one a line.
fn listed(problems: &Problems) -> String {
    let lines = problems
        .iter()
        .map(|(path, line, message)| format!("\n{path}:{line}: {message}"));
    lines.collect()
}

#[test]
fn every_requirement_has_code_and_a_test_or_proof() {
    let trace = trace();
    let (all, problems) = (trace.requirements.len(), trace.problems.len());
    println!("{all} requirements");
    assert!(all > 400, "{all} requirements: are the chapters read?");
    // Straight to standard error, since what a passing test prints is not shown.
    let unchecked = elsewhere::unchecked(&trace, set);
    std::io::stderr()
        .write_all(unchecked.as_bytes())
        .expect("standard error");
    assert!(
        problems == 0,
        "{problems} problems (spec/verification-plan.md says what an annotation is):{}",
        listed(&trace.problems)
    );
}

#[test]
fn every_requirement_that_the_specification_names_is_defined() {
    let (repository, trace) = (repository::read(Path::new(ROOT)), trace());
    let ids: BTreeSet<&str> = trace
        .requirements
        .iter()
        .map(|row| row.id.as_str())
        .collect();
    let topics: BTreeSet<&str> = ids.iter().map(|id| &id[..3]).collect();
    let mut named = 0;
    for (path, text) in repository
        .iter()
        .filter(|(path, _)| path.starts_with("spec/"))
    {
        let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        for id in words.filter(|word| spec::is_id(word) && topics.contains(&word[..3])) {
            named += 1;
            assert!(ids.contains(id), "{path}: {id} is no requirement");
        }
    }
    assert!(named > 800, "{named}: are the chapters read?");
}

#[test]
fn the_committed_table_is_that_of_the_sources() {
    let path = Path::new(ROOT).join("spec/traceability.csv");
    let current = traceability::csv(&trace().requirements);
    if writes() {
        fs::write(&path, &current).expect("the table can be written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    let [old, new] = [&committed, &current].map(|text| text.lines().collect::<BTreeSet<&str>>());
    let gone = old.difference(&new).map(|line| format!("- {line}\n"));
    let added = new.difference(&old).map(|line| format!("+ {line}\n"));
    assert!(
        committed == current,
        "spec/traceability.csv is not that of the sources; to renew it: \
         PALPATE_WRITE_TRACEABILITY=1 cargo test -p palpate-verify --test traceability\n{}",
        gone.chain(added).take(10).collect::<String>()
    );
}

#[test]
fn every_test_of_the_trace_ran() {
    let Some(paths) = std::env::var_os("PALPATE_TEST_LOG") else {
        println!("SKIPPED: PALPATE_TEST_LOG names no output of a test run");
        return;
    };
    let mut log = log::Log::default();
    for path in std::env::split_paths(&paths) {
        let output = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        log.read(output);
    }
    let trace = trace();
    let (missing, all) = (log.missing(&trace), trace.evidence.len());
    if let Some(path) = std::env::var_os("PALPATE_TEST_RECORD") {
        let record = serde_json::to_string_pretty(&log.record(&trace))
            .expect("a record of text and numbers");
        fs::write(path, record).expect("the record can be written");
    }
    println!("{all} tests and proofs of the trace");
    assert!(
        missing.is_empty(),
        "{} of {all} tests and proofs of the trace have not passed:\n{}",
        missing.len(),
        missing.join("\n")
    );
}

#[test]
fn the_built_in_table_says_what_the_sources_say() {
    if writes() {
        println!("SKIPPED: this program was built with the table before");
        return;
    }
    let built_in = traceability::requirements().expect("the built-in table is well formed");
    assert!(
        built_in == trace().requirements,
        "renew the table, then build again"
    );
}
