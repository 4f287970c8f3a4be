//! The dossier: one page for a reviewer, from what a run found and from the chapters of `spec/`. What it says stands in the
//! templates `templates/`, one for each section; here is what they choose from. Text is escaped by the template engine.
//!
//! | file | holds |
//! |---|---|
//! | `chapter.rs` | chapters of `spec/` as parts of the page |
//! | `text.rs` | names and numbers |
//! | `style.css` | what the report's style lacks |

mod chapter;
mod text;

use std::collections::BTreeMap;

use askama::Template;

use super::components::lock_sha256;
use super::evidence::{Counts, Evidence, PARTS, Verdict};
use super::statistics::{self, Row};
use super::system::System;
use palpate_paper::report::html::STYLE;
use palpate_program::output::csv_line;

const VERSION: &str = env!("CARGO_PKG_VERSION");
const OWN_STYLE: &str = include_str!("style.css");
const CONTEXT: &str = include_str!("../../../../spec/context-of-use.md");
const CREDIBILITY: &str = include_str!("../../../../spec/credibility.md");
const SOFTWARE: &str = include_str!("../../../../spec/software.md");
const PROOFS: &str = include_str!("../../../../spec/proof-scope.md");
const RISK: &str = include_str!("../../../../spec/risk.md");
const KANI: &str = include_str!("../../../kani-results.md");
const PLAN: &str = include_str!("../../../../spec/verification-plan.md");
const LIMITS: &str = include_str!("../../../../spec/limits.md");
const SUPPLY_CHAIN: &str = include_str!("../../../../spec/supply-chain.md");

/// The sections in their order: what the contents link to, and their headings.
const SECTIONS: [(&str, &str); 15] = [
    ("context", "Context of use and claims"),
    ("evidence", "Evidence by requirement"),
    ("results", "Results of the checks"),
    ("risk", "Risk management"),
    ("model", "Computational model: credibility"),
    ("rates", "Error rates in simulated records"),
    ("ledger", "Ledger of the statistics battery"),
    ("power", "Power of the tests"),
    ("proofs", "Scope of the proofs"),
    ("kani", "Results of Kani"),
    ("plan", "Verification plan"),
    ("software", "Software life cycle"),
    ("build", "Build and machine"),
    ("components", "Components (SOUP)"),
    ("limits", "Known limits"),
];

/// What each of [`PARTS`] is about, and who judges it.
const TITLES: [(&str, &str); 7] = [
    ("Statistics of the detector", CALLS),
    ("Error rates in simulated records", CALLS),
    (
        "The shipped program, from outside",
        "palpate-verify runs the program palpate; the expected values are other programs'",
    ),
    ("Finite elements", CALLS),
    ("Servo kernel, every input", CALLS),
    ("Time, on this machine", CALLS),
    (
        "Test runs",
        "cargo-nextest, Gappa and the scripts of .ci/run, by their exit codes; palpate-verify reads what they found",
    ),
];

/// Who judges the checks that use the library.
const CALLS: &str =
    "palpate-verify, a program apart that calls the public interface of the library";

/// What the page is made of.
#[derive(Template)]
#[template(path = "dossier.html")]
struct Page<'a> {
    found: &'a Evidence,
}

/// The page.
pub fn dossier(evidence: &Evidence) -> String {
    // Neither writing to a String nor any of our formats fails.
    let page = Page { found: evidence }
        .render()
        .expect("a page of text and numbers");
    page.replace(|c: char| c.is_control() && c != '\n', "\u{fffd}")
}

/// The file `requirements.csv`: each requirement with its code, what checks it and which of that passed.
pub fn requirements(found: &Evidence) -> String {
    let heads = "requirement,chapter,text,code,tests,proofs,vectors,checks_passed_here,tests_passed,proofs_passed,left_to_another_run,not_passed\n";
    let rows = found.requirements.iter().map(|row| {
        let requirement = &row.requirement;
        let lists = [
            &requirement.code,
            &requirement.tests,
            &requirement.proofs,
            &requirement.vectors,
            &row.checks,
            &row.tests,
            &row.proofs,
            &row.left,
            &row.missing,
        ];
        let texts = [&requirement.id, &requirement.chapter, &requirement.text];
        let lists = lists.map(|list| list.join("; "));
        csv_line(texts.into_iter().cloned().chain(lists))
    });
    [heads.to_string()].into_iter().chain(rows).collect()
}

/// The file `test-runs.csv`: each test, proof and step of the test runs, its result and how long it took.
pub fn test_runs(found: &Evidence) -> String {
    let heads = "commit,results_sha256,name,result,seconds\n";
    let rows = found.test_runs.iter().flat_map(|run| {
        run.entries.iter().map(|entry| {
            let seconds = entry.seconds.map(|seconds| seconds.to_string());
            csv_line([
                run.commit.clone(),
                run.results_sha256.clone(),
                entry.name.clone(),
                format!("{:?}", entry.result).to_lowercase(),
                seconds.unwrap_or_default(),
            ])
        })
    });
    [heads.to_string()].into_iter().chain(rows).collect()
}

impl Page<'_> {
    /// The class of the verdict, and its words.
    fn verdict(&self) -> (&'static str, String) {
        let all = self.found.outcomes.len();
        let failed = self.found.failed().count();
        let checks = if all == 1 { "check" } else { "checks" };
        match self.found.verdict() {
            Verdict::Passed => ("passed", format!("All {all} {checks} passed")),
            Verdict::Partial => (
                "partial",
                format!(
                    "{all} {checks} passed; not run: {}. This is therefore no verdict on the build",
                    self.found.left_out.join(", ")
                ),
            ),
            Verdict::Failed if failed == 0 => ("failed", "The soak failed".into()),
            Verdict::Failed => ("failed", format!("{failed} of {all} {checks} failed")),
        }
    }

    /// What was built, from what, by what.
    fn build(&self) -> [(&'static str, String); 10] {
        let build = &self.found.build;
        let flags = if build.flags.is_empty() {
            "none"
        } else {
            build.flags
        };
        let assertions = if build.debug_assertions { "on" } else { "off" };
        [
            ("Version", build.version.into()),
            ("Commit", build.commit.into()),
            ("Compiler", build.compiler.into()),
            ("Target", build.target.into()),
            ("Profile", build.profile.into()),
            ("Optimisation", build.optimisation.into()),
            ("Debug assertions", assertions.into()),
            ("Flags beside the profile's", flags.into()),
            (
                "Instructions taken for granted",
                build.processor_features.into(),
            ),
            ("SHA-256 of Cargo.lock", lock_sha256()),
        ]
    }

    /// When, by whom and where the checks were made, and what was judged.
    fn run(&self) -> Vec<(&'static str, String)> {
        let System {
            began,
            operator,
            operating_system,
            c_library,
            processor,
        } = &self.found.system;
        let mut run = vec![
            ("Date and time (UTC)", began.clone()),
            (
                "Operator",
                operator
                    .clone()
                    .unwrap_or_else(|| "not named (--operator)".into()),
            ),
            ("Commit", self.found.build.commit.into()),
            ("Operating system", operating_system.clone()),
            ("C library", c_library.clone()),
            ("Processor", processor.clone()),
        ];
        let executables = self.found.executables.iter();
        run.extend(executables.map(|(path, sha256)| {
            let name = path.rsplit('/').next().unwrap_or_default();
            ("SHA-256 of an executable", format!("{name}: {sha256}"))
        }));
        let bill = self.found.bill_of_materials.iter();
        run.extend(bill.map(|sha256| ("SHA-256 of the bill of materials", sha256.clone())));
        run.extend(self.found.test_runs.iter().map(|run| {
            let (sha256, entries) = (&run.results_sha256, run.entries.len());
            (
                "SHA-256 of a test run's results",
                format!("{sha256} ({}, {entries} entries)", run.ended),
            )
        }));
        run
    }

    /// Each check of the battery with its α and its power against named defects.
    fn ledger(&self) -> impl Iterator<Item = &'static Row> {
        statistics::battery().map(|check| check.row())
    }

    /// Σα of the battery.
    fn total_alpha(&self) -> String {
        format!("{:.2e}", statistics::total_alpha()).replace('-', "−")
    }

    /// The chapters by their names: how many requirements each has, and how many of them have a check here, tests, proofs and none
    /// of these.
    fn chapters(&self) -> BTreeMap<&str, Counts> {
        let mut chapters: BTreeMap<&str, Counts> = BTreeMap::new();
        for row in &self.found.requirements {
            chapters
                .entry(&row.requirement.chapter)
                .or_default()
                .add(row);
        }
        chapters
    }
}

#[cfg(test)]
mod tests;
