//! The head of the page: verdict, what failed, in short; then the build.

use crate::build::lock_sha256;
use crate::evidence::{Evidence, Verdict};
use palpate::report::html::table::{Group, Layout, Table};
use palpate::report::text::escape;

use super::results::figures;

/// What the page is not, told before anything else.
const NO_CERTIFICATE: &str = "This is no certification, and no validation of a device: it is evidence that this build computes \
     what its specification says.";

/// Verdict, failures and the numbers that tell the most.
///
/// Implements: EVD-003, EVD-004, EVD-006.
pub fn opening(evidence: &Evidence) -> String {
    let all = evidence.outcomes.len();
    let failed = evidence.failed().count();
    let checks = if all == 1 { "check" } else { "checks" };
    let (class, words) = match evidence.verdict() {
        Verdict::Passed => ("passed", format!("All {all} {checks} passed")),
        Verdict::Partial => (
            "partial",
            format!(
                "{all} {checks} passed; not run: {}. This is therefore no verdict on the build",
                evidence.left_out.join(", ")
            ),
        ),
        Verdict::Failed if failed == 0 => ("failed", "The soak failed".into()),
        Verdict::Failed => ("failed", format!("{failed} of {all} {checks} failed")),
    };
    format!(
        "<p class=\"verdict {class}\" id=\"verdict\">{}.</p>\n{}<p class=\"warning\">{NO_CERTIFICATE}</p>\n{}",
        escape(&words),
        failures(evidence),
        highlights(evidence)
    )
}

/// Every failed check with its figures.
fn failures(evidence: &Evidence) -> String {
    let checks = evidence.failed().map(|outcome| {
        format!(
            "<li><code>{}</code>: {} {}{}</li>\n",
            escape(&outcome.name),
            escape(outcome.claim),
            outcome.failure.as_deref().map(escape).unwrap_or_default(),
            figures(outcome)
        )
    });
    let soak = evidence
        .soak
        .iter()
        .filter_map(|soak| soak.failure.as_deref());
    let soak = soak.map(|failure| format!("<li><code>soak</code>: {}</li>\n", escape(failure)));
    let entries: String = checks.chain(soak).collect();
    if entries.is_empty() {
        return entries;
    }
    format!(
        "<div class=\"failures\" role=\"alert\">\n<h2>What failed</h2>\n<ul>\n{entries}</ul>\n</div>\n"
    )
}

fn highlights(evidence: &Evidence) -> String {
    let trace = crate::traceability::summary(&evidence.requirements);
    let mut cards = vec![
        (
            evidence.outcomes.len().to_string(),
            "checks carried out on this machine",
        ),
        (
            trace.requirements.to_string(),
            "requirements, each traced to its code and its test, proof or inspection",
        ),
        (
            evidence.components.len().to_string(),
            "components of other makers in the program",
        ),
        (
            evidence.anomalies().len().to_string(),
            "anomalies of this build",
        ),
    ];
    if let Some(soak) = &evidence.soak {
        cards.push((
            soak.batteries.to_string(),
            "batteries of the statistics on fresh seeds",
        ));
    }
    let cards: String = cards
        .iter()
        .map(|(number, words)| format!("<li><strong>{}</strong> {words}</li>\n", escape(number)))
        .collect();
    format!("<ul class=\"numbers\">\n{cards}</ul>\n")
}

/// What was built, from what, by what.
///
/// Implements: EVD-008.
pub fn build(evidence: &Evidence) -> String {
    let build = &evidence.build;
    let lock = lock_sha256();
    let rows = [
        ("Version", build.version),
        ("Commit", build.commit),
        ("Compiler", build.compiler),
        ("Target", build.target),
        ("Profile", build.profile),
        ("Optimisation", build.optimisation),
        (
            "Debug assertions",
            if build.debug_assertions { "on" } else { "off" },
        ),
        (
            "Flags beside the profile's",
            if build.flags.is_empty() {
                "none"
            } else {
                build.flags
            },
        ),
        ("Features of the package", build.features),
        ("Instructions taken for granted", build.processor_features),
        ("SHA-256 of Cargo.lock", &lock),
        ("Processor", &evidence.processor),
    ];
    let row =
        |(name, value): (&str, &str)| vec![name.into(), format!("<code>{}</code>", escape(value))];
    let rows = rows.into_iter().map(row).collect();
    let table = Table {
        id: "build-table",
        caption: "What was built, from what and how; the processor is that of the machine that ran it",
        layout: Layout::Rows,
        head: &[("What", ""), ("Value", "")],
        groups: Group::plain(rows),
    };
    table.markup() + &anomalies(evidence)
}

/// What is unusual about the build.
///
/// Implements: EVD-009.
pub fn anomalies(evidence: &Evidence) -> String {
    let anomalies = evidence.anomalies();
    if anomalies.is_empty() {
        return "<p>This build has no anomalies: a release build of a commit whose sources were not changed.</p>\n".into();
    }
    let entries: String = anomalies
        .iter()
        .map(|anomaly| {
            format!(
                "<p class=\"warning\">Anomaly of this build: {}.</p>\n",
                escape(anomaly)
            )
        })
        .collect();
    entries
}
