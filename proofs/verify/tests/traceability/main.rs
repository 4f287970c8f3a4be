//! From every requirement to its code, tests, proofs and vectors (`spec/verification-plan.md`), from the annotations in the
//! sources.
//!
//! With `PALPATE_TEST_RUN=FOLDER` the tests and proofs are looked for in the results of a test run, which `.ci/run` keeps in that
//! folder, and the file `test-run.json` is written there for `palpate-verify`.

mod annotations;
mod planted;
mod repository;
mod results;
mod rust;
mod spec;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use annotations::{Problems, Traceability};
use palpate_verify::served_requirements;
use repository::Repository;
use results::Results;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn repository() -> Repository {
    Repository::read(Path::new(ROOT))
}

/// All problems, one a line.
fn listed(problems: &Problems) -> String {
    let lines = problems
        .iter()
        .map(|(path, line, message)| format!("\n{path}:{line}: {message}"));
    lines.collect()
}

/// The words of a text that are ids of requirements, of these topics.
fn ids<'a>(text: &'a str, topics: &BTreeSet<&str>) -> impl Iterator<Item = &'a str> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words.filter(|word| spec::is_id(word) && topics.contains(&word[..3]))
}

/// The first letters of all ids.
fn topics(traceability: &Traceability) -> BTreeSet<&str> {
    let rows = traceability.requirements.iter();
    rows.map(|row| &row.id[..3]).collect()
}

#[test]
fn every_requirement_has_code_and_a_test_or_proof() {
    let traceability = Traceability::of(&repository());
    let (all, problems) = (traceability.requirements.len(), traceability.problems.len());
    println!("{all} requirements");
    assert!(all > 400, "{all} requirements: are the chapters read?");
    assert!(
        problems == 0,
        "{problems} problems (spec/verification-plan.md says what an annotation is):{}",
        listed(&traceability.problems)
    );
}

#[test]
fn every_requirement_that_a_chapter_or_a_check_names_is_defined() {
    let repository = repository();
    let traceability = Traceability::of(&repository);
    let rows = traceability.requirements.iter();
    let defined: BTreeSet<&str> = rows.map(|row| row.id.as_str()).collect();
    let topics = topics(&traceability);
    let mut named = 0;
    let chapters = repository.files.iter();
    for (path, text) in chapters.filter(|(path, _)| path.starts_with("spec/")) {
        for id in ids(text, &topics) {
            named += 1;
            assert!(defined.contains(id), "{path}: {id} is no requirement");
        }
    }
    assert!(named > 800, "{named}: are the chapters read?");
    for id in served_requirements() {
        assert!(
            defined.contains(id),
            "{id}, which a check of palpate-verify names, is no requirement"
        );
    }
}

/// Controls of hazards that only one test shows, and why.
const ALONE: [(&str, &str); 1] = [("FIR-001", "only the microcontroller can show it")];

#[test]
fn a_control_of_a_hazard_has_two_tests_proofs_or_checks() {
    let repository = repository();
    let traceability = Traceability::of(&repository);
    let topics = topics(&traceability);
    let controls: BTreeSet<&str> = ids(&repository.files["spec/risk.md"], &topics).collect();
    assert!(controls.len() > 40, "{controls:?}");
    let rows = traceability.requirements.iter();
    let rows: BTreeMap<&str, _> = rows.map(|row| (row.id.as_str(), row)).collect();
    for id in controls {
        let (tests, proofs) = (&rows[id].tests, &rows[id].proofs);
        let served = served_requirements().any(|served| served == id);
        let pieces = tests.len() + proofs.len() + usize::from(served);
        let is_alone = ALONE.iter().any(|(alone, _)| *alone == id);
        assert_eq!(pieces < 2, is_alone, "{id}: {tests:?}");
    }
}

#[test]
fn every_test_of_the_requirements_ran() {
    let Some(folder) = std::env::var_os("PALPATE_TEST_RUN") else {
        println!("SKIPPED: PALPATE_TEST_RUN names no folder of a test run");
        return;
    };
    let folder = Path::new(&folder);
    let results = Results::read(folder).unwrap_or_else(|error| panic!("{error}"));
    let traceability = Traceability::of(&repository());
    let run = serde_json::to_string_pretty(&results.test_run(&traceability));
    let run = run.expect("a test run is text and numbers");
    fs::write(folder.join("test-run.json"), run).expect("the folder of a test run can be written");
    let (missing, all) = (results.missing(&traceability), traceability.evidence.len());
    println!("{all} tests and proofs");
    assert!(
        missing.is_empty(),
        "{} of {all} tests and proofs have not passed:\n{}",
        missing.len(),
        missing.join("\n")
    );
}
