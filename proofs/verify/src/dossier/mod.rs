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

use askama::Template;

use super::build::lock_sha256;
use super::evidence::{Evidence, PARTS, Verdict};
use super::statistics::{self, Row};
use super::traceability::Requirement;
use palpate::report::html::STYLE;

const VERSION: &str = env!("CARGO_PKG_VERSION");
const OWN_STYLE: &str = include_str!("style.css");
const CONTEXT: &str = include_str!("../../../../spec/context-of-use.md");
const CREDIBILITY: &str = include_str!("../../../../spec/credibility.md");
const SOFTWARE: &str = include_str!("../../../../spec/software.md");
const SERVO: &str = include_str!("../../../../spec/servo.md");
const PROOFS: &str = include_str!("../../../../spec/proof-scope.md");
const LIMITS: &str = include_str!("../../../../spec/limits.md");

/// The sections in their order: what the contents link to, and their headings.
const SECTIONS: [(&str, &str); 11] = [
    ("context", "Context of use and claims"),
    ("build", "Build"),
    ("results", "Results"),
    ("ledger", "Ledger of the statistics battery"),
    ("accuracy", "Diagnostic accuracy of the detector"),
    ("model", "Computational model: credibility"),
    ("software", "Detector: software life cycle"),
    ("components", "Components (SOUP)"),
    ("proofs", "Scope of the proofs"),
    ("limits", "Known limits and anomalies"),
    ("trace", "Trace of the requirements"),
];

/// What each of [`PARTS`] is about.
const TITLES: [&str; 6] = [
    "Statistics of the detector",
    "Diagnostic accuracy",
    "Vectors of other programs",
    "Finite elements",
    "Servo kernel, every input",
    "Time, on this machine",
];

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
    fn build(&self) -> [(&'static str, String); 12] {
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
            ("Features of the package", build.features.into()),
            (
                "Instructions taken for granted",
                build.processor_features.into(),
            ),
            ("SHA-256 of Cargo.lock", lock_sha256()),
            ("Processor", self.found.processor.clone()),
        ]
    }

    /// Each check of the battery with its α and its power against named defects.
    fn ledger(&self) -> impl Iterator<Item = Row> {
        statistics::battery().filter_map(|check| check.row(statistics::FIXED_SEED).ok())
    }

    /// Σα of the battery.
    fn total_alpha(&self) -> String {
        statistics::total_alpha().map_or_else(
            |error| error,
            |total| format!("{total:.2e}").replace('-', "−"),
        )
    }

    /// The requirements of each chapter.
    fn chapters(&self) -> impl Iterator<Item = &[Requirement]> {
        let rows = &self.found.requirements;
        rows.chunk_by(|one, next| one.chapter == next.chapter)
    }
}

#[cfg(test)]
mod tests;
