//! What the checks found: all of them, the ledger of the battery, and the detector's diagnostic accuracy.

use crate::evidence::{Evidence, PARTS};
use crate::statistics::{Row, battery};
use crate::{Figure, Outcome, statistics};
use palpate::report::html::table::{Group, Layout, Table};
use palpate::report::text::{escape, scientific, trimmed};

/// What each part is about.
fn title(part: &str) -> &'static str {
    match part {
        "statistics" => "Statistics of the detector",
        "diagnosis" => "Diagnostic accuracy",
        "vectors" => "Vectors of other programs",
        "fem" => "Finite elements",
        "kernel" => "Servo kernel, every input",
        "timing" => "Time, on this machine",
        _ => "Other checks",
    }
}

/// Every check with its figures, part by part.
///
/// Implements: EVD-002, EVD-006, EVD-013.
pub fn results(evidence: &Evidence) -> String {
    let group = |part: &str| Group {
        heading: escape(title(part)),
        rows: evidence.part(part).map(row).collect(),
    };
    let groups = PARTS.into_iter().map(group);
    let table = Table {
        id: "results-table",
        caption: "Each check, what it claims, the requirements it serves, and what it measured. A bound stands behind its figure \
                  in brackets; a figure without one is told, not judged",
        layout: Layout::Stack,
        head: &[
            ("Check", "check"),
            ("Result", "result"),
            ("Claim", "claim"),
            ("Figures", ""),
            ("Requirements", "places"),
        ],
        groups: groups.filter(|group| !group.rows.is_empty()).collect(),
    };
    soak(evidence) + &table.markup()
}

fn row(outcome: &Outcome) -> Vec<String> {
    let (class, word) = match outcome.passed() {
        true => ("passed", "passed"),
        false => ("failed", "FAILED"),
    };
    let failure = outcome.failure.as_deref().map(escape).unwrap_or_default();
    vec![
        format!("<code>{}</code>", breakable(&outcome.name)),
        format!("<span class=\"{class}\">{word}</span>"),
        escape(outcome.claim),
        format!("{failure}{}", figures(outcome)),
        escape(&outcome.requirements.join(", ")),
    ]
}

/// A name of several words, which may be broken between them.
pub fn breakable(name: &str) -> String {
    escape(name)
        .replace('.', ".<wbr>")
        .replace('_', "_<wbr>")
        .replace("::", "::<wbr>")
}

/// The figures of a check, those outside their bounds in red.
pub fn figures(outcome: &Outcome) -> String {
    let entry = |figure: &Figure| {
        let text = escape(&format!(
            "{}: {}{}",
            figure.what,
            number(figure.value),
            bounds(figure)
        ));
        match figure.passes() {
            true => format!("<li>{text}</li>"),
            false => format!("<li class=\"failed\"><strong>{text}</strong></li>"),
        }
    };
    let entries: String = outcome.figures.iter().map(entry).collect();
    match entries.as_str() {
        "" => entries,
        _ => format!("<ul class=\"figures-of-check\">{entries}</ul>"),
    }
}

fn bounds(
    Figure {
        at_least, at_most, ..
    }: &Figure,
) -> String {
    match (at_least.is_finite(), at_most.is_finite()) {
        (true, true) => format!(" (from {} to {})", number(*at_least), number(*at_most)),
        (true, false) => format!(" (at least {})", number(*at_least)),
        (false, true) => format!(" (at most {})", number(*at_most)),
        (false, false) => String::new(),
    }
}

/// A number for people: whole ones as they are, the others with four or five digits that count.
fn number(value: f64) -> String {
    let size = value.abs();
    match value {
        value if value.is_nan() || value.is_infinite() => format!("{value}"),
        value if value.fract() == 0.0 && size < 1e10 => grouped(value),
        value if (1e-2..1e5).contains(&size) => trimmed(value, 5),
        value => scientific(value),
    }
}

/// A whole number with its digits in threes.
fn grouped(value: f64) -> String {
    let digits = trimmed(value.abs(), 0);
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    if value < 0.0 {
        format!("−{text}")
    } else {
        text
    }
}

/// Batteries with fresh seeds.
fn soak(evidence: &Evidence) -> String {
    let Some(soak) = &evidence.soak else {
        return String::new();
    };
    let result = match &soak.failure {
        None => "<span class=\"passed\">passed</span>".into(),
        Some(failure) => format!("<span class=\"failed\">FAILED: {}</span>", escape(failure)),
    };
    format!(
        "<p>Soak: {} batteries with seeds from {} on: {result}. A detector without defect fails them with probability {} at \
         most.</p>\n",
        soak.batteries,
        soak.seed,
        scientific(soak.false_failure)
    )
}

/// Each check of the battery with its α and its power against named defects.
///
/// Implements: EVD-006.
pub fn ledger(_evidence: &Evidence) -> String {
    let rows = battery().filter_map(|check| check.row(statistics::FIXED_SEED).ok());
    let row = |row: Row| {
        let powers = row
            .powers
            .iter()
            .map(|(defect, power)| format!("{}: {power}", defect.replace('_', " ")));
        vec![
            breakable(row.name),
            escape(&scientific(row.alpha)),
            grouped(row.trials as f64),
            escape(&powers.collect::<Vec<_>>().join("; ")),
        ]
    };
    let total = statistics::total_alpha().map_or_else(
        |error| escape(&error),
        |total| format!("{total:.2e}").replace('-', "−"),
    );
    let table = Table {
        id: "ledger-table",
        caption: "α: the largest probability that a detector without defect fails the check. Power: the probability that the check \
                  fails for a detector with the defect; those of 0.999 and more are shown by planting it",
        layout: Layout::Stack,
        head: &[
            ("Check", "check"),
            ("α", "number"),
            ("Trials", "number"),
            ("Power against", "claim"),
        ],
        groups: Group::plain(rows.map(row).collect()),
    };
    format!(
        "<p>All α add up to {total}: that is the largest probability that a detector without defect fails the battery.</p>\n{}",
        table.markup()
    )
}

/// A share; one that would round to 1 as what it lacks.
fn share(value: f64) -> String {
    let text = trimmed(value, 5);
    match text.as_str() {
        "1" if value < 1.0 => format!("1 − {}", scientific(1.0 - value)),
        _ => text,
    }
}

/// Sensitivity, specificity and area under the curve, with what was counted.
///
/// Implements: EVD-012.
pub fn diagnostic_accuracy(evidence: &Evidence) -> String {
    let row = |outcome: &Outcome| {
        let inclusion = outcome
            .name
            .trim_start_matches("diagnosis.")
            .replace('_', " ");
        let mut cells = vec![escape(&inclusion)];
        cells.extend(outcome.figures.iter().map(|figure| {
            let is_share = figure.at_most <= 1.0;
            let value = if is_share {
                share(figure.value)
            } else {
                trimmed(figure.value, 3)
            };
            escape(&format!("{value}{}", bounds(figure)))
        }));
        cells
    };
    let table = Table {
        id: "accuracy-table",
        caption: "Probe 4 mm deep, 41 samples from −10 to 10 mm, white noise of 0.235 N in each sample of both channels, or four times that, at \
                  most 5 % false alarms. By the closed form, and in brackets the interval of Clopper and Pearson around what was counted in \
                  100,000 simulated records, which a detector without defect misses with probability 1e−9 at most",
        layout: Layout::Stack,
        head: &[
            ("Inclusion at", ""),
            ("γ", ""),
            ("Threshold η", ""),
            ("Specificity", ""),
            ("Sensitivity", ""),
            ("Area under the curve", ""),
        ],
        groups: Group::plain(evidence.part("diagnosis").map(row).collect()),
    };
    format!(
        "<p>Index test: the matched filter at the position of the inclusion. Reference standard: the force map that a record was \
         simulated from. There are no patients, no tissue and no operator in it: records are simulated from computed forces with the \
         noise that the detector presumes, so these figures verify the arithmetic from record to decision, and are an upper limit \
         of what the detector could do on such a phantom.</p>\n{}",
        table.markup()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: EVD-002.
    #[test]
    fn numbers_are_short_and_keep_what_counts() {
        for (value, text) in [
            (0.0, "0"),
            (4_294_967_296.0, "4,294,967,296"),
            (-120.0, "−120"),
            (1000.0, "1,000"),
            (0.187_3, "0.1873"),
            (-3.5e-13, "−3.5e−13"),
            (1.5e12, "1.5e12"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
