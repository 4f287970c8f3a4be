//! Text of the report: names of maps and of files, rates and probabilities.

use std::borrow::Borrow;
use std::collections::HashSet;

use palpate::force_map::{ForceMap, Source};
use palpate::stats::Bounds;
pub use palpate::text::*;

/// What to call a map: its phantom's name, or else the file that it was measured in. Untrusted text.
pub(super) fn name_of_map(map: &ForceMap) -> String {
    match (map.phantom(), map.source()) {
        (Some(phantom), _) => phantom.name().to_owned(),
        (None, Source::Measured(measurement)) => measurement.file.clone(),
        (None, Source::FiniteElements { .. }) => "unnamed".into(),
    }
}

/// Text in which no line breaks between a number and its unit, nor around `=`.
pub(super) fn prose(text: impl AsRef<str>) -> String {
    let mut joined = String::new();
    let mut before = "";
    for (k, word) in text.as_ref().split(' ').enumerate() {
        let after_number = before.ends_with(|c: char| c.is_ascii_digit());
        let is_unit = ["N", "mN", "mm", "%"]
            .contains(&word.trim_matches(|c: char| !c.is_alphabetic() && c != '%'));
        let stays = (after_number && is_unit) || word == "=" || before == "=";
        if k > 0 {
            joined.push(if stays { '\u{a0}' } else { ' ' });
        }
        joined.push_str(word);
        before = word;
    }
    joined
}

/// The first `most` characters of a name, so that a long one does not run out of its figure.
pub(super) fn shortened(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.into();
    }
    let short = name.chars().take(most.saturating_sub(1));
    short.chain(['…']).collect()
}

/// Gives out file names that are safe on any system and never the same twice, not even where case is ignored.
#[derive(Debug, Default)]
pub struct FileNames {
    used: HashSet<String>,
}

impl FileNames {
    /// `prefix`, then what is safe of `name`, then a number if that is taken, then `.extension`.
    ///
    /// Implements: REP-031.
    pub fn unique(&mut self, prefix: &str, name: &str, extension: &str) -> String {
        let short: String = name.chars().take(40).collect();
        let safe = short.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "_");
        let hyphen = if safe.is_empty() { "" } else { "-" };
        let stem = format!("{prefix}{hyphen}{safe}");
        let mut candidate = format!("{stem}.{extension}");
        for number in 2.. {
            if self.used.insert(candidate.to_ascii_lowercase()) {
                break;
            }
            candidate = format!("{stem}-{number}.{extension}");
        }
        candidate
    }
}

/// The first and the last of positions (m), in mm: "0 to 4 mm".
pub(super) fn range(axis: &[f64]) -> String {
    match axis {
        [first, .., last] => format!("{} to {} mm", millimetres(first), millimetres(last)),
        [only] => format!("{} mm", millimetres(only)),
        [] => String::new(),
    }
}

/// A force in N.
pub(super) fn newtons(force: f64) -> String {
    fixed(force, 3)
}

/// A force (N) in mN.
pub(super) fn millinewtons(force: impl Borrow<f64>) -> String {
    trimmed(1e3 * force.borrow(), 1)
}

/// A probability in per cent; what would round to 0 or 100 % is given as a bound.
pub fn percent(probability: impl Borrow<f64>) -> String {
    let probability = *probability.borrow();
    let percent = 100.0 * probability;
    if probability > 0.0 && percent < 0.05 {
        "< 0.1 %".into()
    } else if probability < 1.0 && percent >= 99.95 {
        "> 99.9 %".into()
    } else {
        format!("{} %", fixed(percent, 1))
    }
}

/// A rate that was asked for, in per cent.
pub(super) fn rate(rate: impl Borrow<f64>) -> String {
    format!("{}\u{a0}%", in_percent(rate))
}

/// An error rate: small ones by their power of ten.
pub(super) fn error_rate(probability: impl Borrow<f64>) -> String {
    match *probability.borrow() {
        rate if rate > 0.0 && rate < 1e-3 => scientific(rate),
        rate => percent(rate),
    }
}

/// A number beside the one that it must reach: two decimals, or five where these hide that it does not.
pub(super) fn against(value: impl Borrow<f64>, needed: impl Borrow<f64>) -> String {
    let (value, needed) = (*value.borrow(), *needed.borrow());
    let short = fixed(value, 2);
    let is_hidden = value < needed && short == fixed(needed, 2);
    if is_hidden { fixed(value, 5) } else { short }
}

/// A p-value: small ones by their power of ten.
pub(super) fn p_value(p: impl Borrow<f64>) -> String {
    match *p.borrow() {
        p if p > 0.0 && p < 1e-3 => scientific(p),
        p => fixed(p, 3),
    }
}

/// A difference of shares in percentage points, with its sign.
pub(super) fn points(share: impl Borrow<f64>) -> String {
    let share = *share.borrow();
    let sign = if share > 0.0 { "+" } else { "" };
    format!("{sign}{}", fixed(100.0 * share, 1))
}

/// "93.1 to 97.9 %".
pub(super) fn percents(Bounds { lower, upper }: &Bounds) -> String {
    let [lower, upper] = [lower, upper].map(|end| fixed(100.0 * end, 1));
    format!("{lower} to {upper} %")
}

/// A number with one decimal.
pub(super) fn tenths(value: f64) -> String {
    fixed(value, 1)
}

/// A number in its format, or other words where there is none.
pub(super) fn or(value: impl Borrow<Option<f64>>, none: &str, format: fn(f64) -> String) -> String {
    value.borrow().map_or(none.into(), format)
}

/// `items` with `separator` between them.
pub(super) fn joined(items: impl IntoIterator<Item = String>, separator: &str) -> String {
    items.into_iter().collect::<Vec<_>>().join(separator)
}
