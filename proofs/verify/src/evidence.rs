//! All that a run of `palpate-verify` found, and its file for programs.

use serde::Serialize;
use serde_json::{Value, json};

use palpate::version::Build;

use super::build::lock_sha256;
use super::record::{self, Record};
use super::supply::Component;
use super::system::System;
use super::traceability::Requirement;
use super::{Figure, Outcome};

/// The value of the key `schema`.
const SCHEMA: &str = "palpate-evidence";
/// The value of the key `schema_version`.
const SCHEMA_VERSION: u32 = 2;

/// The parts of the verification, in the order in which they are told.
pub const PARTS: [&str; 7] = [
    "statistics",
    "rates",
    "program",
    "fem",
    "kernel",
    "timing",
    "record",
];

/// What a run found.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// What was built.
    pub build: Build,
    /// Where and when the checks were made, and by whom.
    pub system: System,
    /// The executables that were judged: path and SHA-256.
    pub executables: Vec<(String, String)>,
    /// The records of test runs that were given.
    pub records: Vec<Record>,
    /// Parts that were not asked for.
    pub left_out: Vec<&'static str>,
    /// Every check that was carried out, in the order of [`PARTS`].
    pub outcomes: Vec<Outcome>,
    /// Batteries with fresh seeds, where they were asked for.
    pub soak: Option<Soak>,
    /// The trace.
    pub requirements: Vec<Requirement>,
    /// The crates in the program.
    pub components: Vec<Component>,
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

    /// The evidence of each requirement, in their order.
    pub fn joined(&self) -> Vec<record::Joined> {
        record::join(&self.requirements, &self.outcomes, &self.records)
    }

    /// How many requirements have evidence, by its kind.
    pub fn counts(&self) -> Counts {
        let joined = self.joined();
        let count = |has: fn(&record::Joined) -> bool| joined.iter().filter(|row| has(row)).count();
        Counts {
            requirements: joined.len(),
            checks: count(|row| !row.checks.is_empty()),
            tests: count(|row| !row.tests.is_empty()),
            proofs: count(|row| !row.proofs.is_empty()),
            inspection: count(|row| row.inspection.is_some()),
            none: count(|row| !row.is_there()),
        }
    }

    /// What is unusual about the build itself.
    pub fn anomalies(&self) -> Vec<String> {
        let build = &self.build;
        let mut anomalies = Vec::new();
        if build.known_commit().is_none() {
            anomalies.push(format!(
                "its sources are not known to be those of a commit ({})",
                build.commit
            ));
        }
        if build.profile != "release" {
            anomalies.push(format!(
                "it was built with the profile {}, not for release",
                build.profile
            ));
        }
        if build.debug_assertions {
            anomalies.push("debug assertions are on".into());
        }
        anomalies
    }

    /// The file for programs; ends in a line feed. Times, and what else belongs to this one run, are in `measured_here`.
    pub fn to_json(&self) -> String {
        let (checks, others): (Vec<&Outcome>, Vec<&Outcome>) =
            self.outcomes.iter().partition(|outcome| outcome.repeatable);
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
            "components": self.components,
            "measured_here": {
                "system": self.system,
                "executables": self.executables,
                "records": self.records.iter().map(head).collect::<Vec<_>>(),
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

/// What is told of a record beside its entries, which stand in a file of their own.
fn head(record: &Record) -> Value {
    let Record {
        commit,
        began,
        ended,
        system,
        log_sha256,
        ..
    } = record;
    json!({"commit": commit, "began": began, "ended": ended, "system": system, "log_sha256": log_sha256, "entries": record.entries.len()})
}

/// How many requirements have evidence in a dossier, by its kind. One may have several kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// All requirements.
    pub requirements: usize,
    /// Those that a check of this run serves.
    pub checks: usize,
    /// Those with a test that passed in the records.
    pub tests: usize,
    /// Those with a proof that passed in the records.
    pub proofs: usize,
    /// Those that a person inspects.
    pub inspection: usize,
    /// Those with none of these.
    pub none: usize,
}
