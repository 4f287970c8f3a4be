//! All that a run of `palpate-verify` found, and its file for programs.

use serde::Serialize;
use serde_json::{Value, json};

use palpate::build::Build;

use super::build::lock_sha256;
use super::supply::Component;
use super::traceability::{Requirement, Summary, summary};
use super::{Figure, Outcome};

/// The value of the key `schema`.
const SCHEMA: &str = "palpate-evidence";
/// The value of the key `schema_version`.
const SCHEMA_VERSION: u32 = 1;

/// The parts of the verification, in the order in which they are told.
pub const PARTS: [&str; 6] = [
    "statistics",
    "diagnosis",
    "vectors",
    "fem",
    "kernel",
    "timing",
];

/// What a run found.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// What was built.
    pub build: Build,
    /// The processor that ran it.
    pub processor: String,
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
            "traceability": Trace { summary: summary(&self.requirements), rows: &self.requirements },
            "components": self.components,
            "measured_here": {"processor": self.processor, "checks": all(others), "seconds": seconds},
        });
        format!("{evidence:#}\n")
    }
}

fn check(outcome: &Outcome) -> Value {
    json!({
        "name": outcome.name,
        "claim": outcome.claim,
        "requirements": outcome.requirements,
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

/// How many requirements there are, and each of them.
#[derive(Serialize)]
struct Trace<'a> {
    #[serde(flatten)]
    summary: Summary,
    rows: &'a [Requirement],
}
