//! All that a run of `palpate-verify` found, and its file for programs.

use serde::Serialize;
use serde_json::{Value, json};

use palpate::version::Build;

use super::components::{Component, lock_sha256};
use super::planted::Planted;
use super::system::System;
use super::test_run::{Evidenced, TestRun};
use super::{Figure, Outcome};

/// The value of the key `schema`.
const SCHEMA: &str = "palpate-evidence";
/// The value of the key `schema_version`.
const SCHEMA_VERSION: u32 = 3;

/// The parts of the verification, in the order in which they are told.
pub const PARTS: [&str; 7] = [
    "statistics",
    "rates",
    "program",
    "fem",
    "kernel",
    "timing",
    "tests",
];

/// The parts that a run leaves out: those that `only` does not name, and `tests` without a test run. A test run that is given is
/// always checked, because the dossier counts its tests.
pub fn left_out(only: Option<&[String]>, has_test_run: bool) -> Vec<&'static str> {
    let is_asked = |part: &str| only.is_none_or(|only| only.iter().any(|asked| asked == part));
    let runs = |part: &str| match part {
        "tests" => has_test_run,
        _ => is_asked(part),
    };
    PARTS.into_iter().filter(|part| !runs(part)).collect()
}

/// What a run found.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// What was built.
    pub build: Build,
    /// Where and when the checks were made, and by whom.
    pub system: System,
    /// The executables that were judged: path and SHA-256.
    pub executables: Vec<(String, String)>,
    /// The test runs that were given.
    pub test_runs: Vec<TestRun>,
    /// Parts that did not run ([`left_out`]).
    pub left_out: Vec<&'static str>,
    /// Every check that was carried out, in the order of [`PARTS`].
    pub outcomes: Vec<Outcome>,
    /// Batteries with fresh seeds, where they were asked for.
    pub soak: Option<Soak>,
    /// The requirements of the test runs with their evidence; none without a test run.
    pub requirements: Vec<Evidenced>,
    /// The components of the program, or all packages of the lock file.
    pub components: Vec<Component>,
    /// SHA-256 of the bill of materials that lists these components, if one was given.
    pub bill_of_materials: Option<String>,
    /// How much the tests find, if that was given.
    pub planted: Option<Planted>,
}

/// Batteries with fresh seeds.
#[derive(Debug, Clone, Serialize)]
pub struct Soak {
    /// How many.
    pub batteries: u32,
    /// The seed of the first; the next ones count on from it.
    pub seed: u64,
    /// The largest probability that a detector without defect fails them.
    pub false_failure: f64,
    /// The first failure, with the command that repeats it.
    pub failure: Option<String>,
}

/// What can be said of the build.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every check of every part passed.
    Passed,
    /// Every check passed, of some parts.
    Partial,
    /// At least one check failed.
    Failed,
}

impl Evidence {
    /// The verdict.
    pub fn verdict(&self) -> Verdict {
        let soaked = self.soak.iter().all(|soak| soak.failure.is_none());
        match self.failed().next() {
            None if soaked && !self.outcomes.is_empty() && self.left_out.is_empty() => {
                Verdict::Passed
            }
            None if soaked => Verdict::Partial,
            _ => Verdict::Failed,
        }
    }

    /// The checks that failed.
    pub fn failed(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter().filter(|outcome| !outcome.passed())
    }

    /// The checks of a part.
    pub fn part(&self, part: &str) -> impl Iterator<Item = &Outcome> {
        self.outcomes
            .iter()
            .filter(move |outcome| outcome.part() == part)
    }

    /// How many requirements have evidence, by its kind; `None` without a test run, which lists the requirements.
    pub fn counts(&self) -> Option<Counts> {
        let mut counts = Counts::default();
        self.requirements.iter().for_each(|row| counts.add(row));
        (!self.test_runs.is_empty()).then_some(counts)
    }

    /// What is unusual about the build itself.
    pub fn anomalies(&self) -> Vec<String> {
        let build = &self.build;
        let (commit, profile) = (build.commit, build.profile);
        let unknown = format!("its sources are not known to be those of a commit ({commit})");
        let other = format!("it was built with the profile {profile}, not for release");
        let anomalies = [
            build.known_commit().is_none().then_some(unknown),
            (profile != "release").then_some(other),
            build
                .debug_assertions
                .then(|| "debug assertions are on".into()),
        ];
        anomalies.into_iter().flatten().collect()
    }

    /// The file for programs; ends in a line feed. Times, and what else belongs to this one run, are in `measured_here`.
    pub fn to_json(&self) -> String {
        let (checks, others): (Vec<&Outcome>, Vec<&Outcome>) = self
            .outcomes
            .iter()
            .partition(|outcome| outcome.is_repeatable());
        let all = |outcomes: Vec<&Outcome>| outcomes.into_iter().map(check).collect::<Vec<_>>();
        let time = |outcome: &Outcome| json!({"name": outcome.name, "seconds": outcome.seconds});
        let seconds: Vec<Value> = self.outcomes.iter().map(time).collect();
        let evidence = json!({
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "verdict": self.verdict(),
            "parts_left_out": self.left_out,
            "build": self.build,
            "lock_sha256": lock_sha256(),
            "anomalies": self.anomalies(),
            "checks": all(checks),
            "soak": self.soak,
            "requirements": self.counts(),
            "bill_of_materials_sha256": self.bill_of_materials,
            "components": self.components,
            "measured_here": {
                "system": self.system,
                "executables": self.executables,
                "test_runs": self.test_runs.iter().map(head).collect::<Vec<_>>(),
                "planted": self.planted,
                "checks": all(others),
                "seconds": seconds,
            },
        });
        format!("{evidence:#}\n")
    }
}

fn check(outcome: &Outcome) -> Value {
    json!({
        "name": outcome.name,
        "claim": outcome.claim,
        "requirements": outcome.requirements,
        "limits": outcome.limits,
        "passed": outcome.passed(),
        "failure": outcome.failure,
        "figures": outcome.figures.iter().map(figure).collect::<Vec<_>>(),
    })
}

/// A figure; a number that is not finite, and a bound that is none, are null.
fn figure(figure: &Figure) -> Value {
    json!({
        "what": figure.what,
        "value": figure.value,
        "at_least": figure.at_least,
        "at_most": figure.at_most,
        "passed": figure.passes(),
    })
}

/// A test run without its requirements and entries, which have files of their own.
fn head(run: &TestRun) -> Value {
    json!({
        "commit": run.commit,
        "began": run.began,
        "ended": run.ended,
        "system": run.system,
        "results_sha256": run.results_sha256,
        "entries": run.entries.len(),
    })
}

/// How many requirements have evidence in a dossier, by its kind. One may have several kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// All requirements.
    pub requirements: usize,
    /// Those that a check of this run serves.
    pub checks: usize,
    /// Those with a test that passed in the test runs.
    pub tests: usize,
    /// Those with a proof that passed in the test runs.
    pub proofs: usize,
    /// Those with none of these.
    pub none: usize,
}

impl Counts {
    /// Counts one more requirement.
    pub fn add(&mut self, row: &Evidenced) {
        self.requirements += 1;
        self.checks += usize::from(!row.checks.is_empty());
        self.tests += usize::from(!row.tests.is_empty());
        self.proofs += usize::from(!row.proofs.is_empty());
        self.none += usize::from(!row.is_shown());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tests_are_left_out_if_and_only_if_there_is_no_test_run() {
        let only = |part: &str| [part.to_string()];
        assert_eq!(left_out(None, false), ["tests"]);
        assert!(left_out(None, true).is_empty());
        let [others @ .., _] = PARTS;
        for part in ["soak", "tests"] {
            assert_eq!(left_out(Some(&only(part)), true), others, "{part}");
        }
        assert_eq!(left_out(Some(&only("soak")), false), PARTS);
        let but_rates = ["statistics", "program", "fem", "kernel", "timing"];
        assert_eq!(left_out(Some(&only("rates")), true), but_rates);
        let without = [&but_rates[..], &["tests"]].concat();
        assert_eq!(left_out(Some(&only("rates")), false), without);
    }
}
