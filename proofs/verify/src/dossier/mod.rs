//! The dossier: one page for a reviewer, from what a run found and from the chapters of `spec/`.
//!
//! | file | holds |
//! |---|---|
//! | `chapter.rs` | chapters of `spec/` as parts of the page |
//! | `opening.rs` | verdict, failures, build |
//! | `results.rs` | checks, ledger, diagnostic accuracy |
//! | `lists.rs` | components, trace |
//! | `style.css` | what the report's style lacks |

mod chapter;
mod lists;
mod opening;
mod results;

use super::evidence::Evidence;
use chapter::{chapter, part};
use palpate::report::html::{STYLE, section};

const OWN_STYLE: &str = include_str!("style.css");
const CONTEXT: &str = include_str!("../../../../spec/context-of-use.md");
const CREDIBILITY: &str = include_str!("../../../../spec/credibility.md");
const SOFTWARE: &str = include_str!("../../../../spec/software.md");
const SERVO: &str = include_str!("../../../../spec/servo.md");
const PROOFS: &str = include_str!("../../../../spec/proof-scope.md");
const LIMITS: &str = include_str!("../../../../spec/limits.md");

/// A section of the page.
struct Section {
    id: &'static str,
    heading: &'static str,
    markup: fn(&Evidence) -> String,
}

/// The sections in their order.
const SECTIONS: [Section; 11] = [
    Section {
        id: "context",
        heading: "Context of use and claims",
        markup: |_| chapter(CONTEXT),
    },
    Section {
        id: "build",
        heading: "Build",
        markup: opening::build,
    },
    Section {
        id: "results",
        heading: "Results",
        markup: results::results,
    },
    Section {
        id: "ledger",
        heading: "Ledger of the statistics battery",
        markup: results::ledger,
    },
    Section {
        id: "accuracy",
        heading: "Diagnostic accuracy of the detector",
        markup: results::diagnostic_accuracy,
    },
    Section {
        id: "model",
        heading: "Computational model: credibility",
        markup: |_| chapter(CREDIBILITY),
    },
    Section {
        id: "software",
        heading: "Detector: software life cycle",
        markup: |_| chapter(SOFTWARE) + "<h3>Hazards of playback</h3>\n" + &part(SERVO, "Hazards"),
    },
    Section {
        id: "components",
        heading: "Components (SOUP)",
        markup: lists::components,
    },
    Section {
        id: "proofs",
        heading: "Scope of the proofs",
        markup: |_| chapter(PROOFS),
    },
    Section {
        id: "limits",
        heading: "Known limits and anomalies",
        markup: |evidence| opening::anomalies(evidence) + &chapter(LIMITS),
    },
    Section {
        id: "trace",
        heading: "Trace of the requirements",
        markup: lists::trace,
    },
];

/// The page. Text that is not ours, which is the build's and the machine's, is escaped.
///
/// Implements: EVD-003, EVD-004, EVD-006, EVD-008.
pub fn dossier(evidence: &Evidence) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let contents: String = SECTIONS
        .iter()
        .map(|Section { id, heading, .. }| format!("<li><a href=\"#{id}\">{heading}</a></li>\n"))
        .collect();
    let body: String = SECTIONS
        .iter()
        .map(|part| section(part.id, part.heading, &(part.markup)(evidence)))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Verification dossier of palpate {version}</title>\n<style>\n{STYLE}{OWN_STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>Verification dossier of palpate {version}</h1>\n\
         <p class=\"lead\">Inclusion probing after Yan, Scott and Fearing (1999): what this build computes, checked on the \
         machine where it ran.</p>\n{}</header>\n<main>\n\
         <nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n{contents}</ol>\n</nav>\n{body}</main>\n\
         <footer class=\"soft\">Written by <code>palpate-verify</code>, version {version}; the same results for programs are in \
         <code>evidence.json</code>.</footer>\n</body>\n</html>\n",
        opening::opening(evidence),
    )
}

#[cfg(test)]
mod tests;
