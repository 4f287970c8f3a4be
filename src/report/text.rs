//! Text for people and for files: untrusted names made safe, numbers made short.

use std::collections::HashSet;

use crate::force_map::{ForceMap, Source};

/// What to call a map: its phantom's name, or else the file that it was measured in. Untrusted text.
pub fn name_of_map(map: &ForceMap) -> String {
    match (map.phantom(), map.source()) {
        (Some(phantom), _) => phantom.name.clone(),
        (None, Source::Measured { file, .. }) => file.clone(),
        (None, Source::FiniteElements { .. }) => "unnamed".into(),
    }
}

/// `text` without the characters that XML 1.0 cannot hold even escaped.
pub fn printable(text: &str) -> String {
    let allowed = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars()
        .map(|c| if allowed(c) { c } else { '\u{fffd}' })
        .collect()
}

/// `text` as the content of an element or of a quoted attribute, in HTML and in XML.
///
/// Implements: REP-042.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// [`escape`]d text in which no line breaks between a number and its unit, nor around `=`.
pub fn prose(text: &str) -> String {
    let mut joined = String::with_capacity(text.len());
    let mut before = "";
    for (k, word) in text.split(' ').enumerate() {
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
    escape(&joined)
}

/// The first `most` characters of a name, so that a long one does not run out of its figure.
pub fn shortened(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.into();
    }
    let mut short: String = name.chars().take(most.saturating_sub(1)).collect();
    short.push('…');
    short
}

/// Gives out file names that are safe on any system and never the same twice, not even where case is ignored.
///
/// ```
/// use palpate::report::FileNames;
///
/// let mut names = FileNames::default();
/// assert_eq!(names.unique("map", "../6.6 mm", "json"), "map-.._6.6_mm.json");
/// assert_eq!(names.unique("map", "../6.6_MM", "json"), "map-.._6.6_MM-2.json");
/// ```
#[derive(Debug, Default)]
pub struct FileNames {
    used: HashSet<String>,
}

impl FileNames {
    /// `prefix`, then what is safe of `name`, then a number if that is taken, then `.extension`.
    ///
    /// ```
    /// use palpate::report::FileNames;
    ///
    /// let mut names = FileNames::default();
    /// assert_eq!(names.unique("map", "", "json"), "map.json");
    /// assert_eq!(names.unique("map", "", "json"), "map-2.json");
    /// ```
    ///
    /// Implements: REP-031.
    pub fn unique(&mut self, prefix: &str, name: &str, extension: &str) -> String {
        let safe: String = name
            .chars()
            .map(|c| {
                if c.is_ascii_alphanumeric() || c == '.' {
                    c
                } else {
                    '_'
                }
            })
            .take(40)
            .collect();
        let stem = if safe.is_empty() {
            prefix.to_string()
        } else {
            format!("{prefix}-{safe}")
        };
        let mut candidate = format!("{stem}.{extension}");
        let mut number = 2;
        while !self.used.insert(candidate.to_ascii_lowercase()) {
            candidate = format!("{stem}-{number}.{extension}");
            number += 1;
        }
        candidate
    }
}

/// A length (m) in mm, to a nanometre, without trailing zeros.
pub fn millimetres(length: f64) -> String {
    trimmed(length * 1e3, 6)
}

/// `value` with at most `decimals` decimals and no trailing zeros, with a true minus sign.
pub fn trimmed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    with_minus(if text == "-0" { "0" } else { text })
}

/// `value` with exactly `decimals` decimals and a true minus sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    with_minus(&format!("{value:.decimals$}"))
}

/// `value` as `1.2e−9`: for residuals.
pub fn scientific(value: f64) -> String {
    with_minus(&format!("{value:.1e}"))
}

/// A probability in per cent; what would round to 0 or 100 % is given as a bound.
pub fn percent(probability: f64) -> String {
    let percent = 100.0 * probability;
    if probability > 0.0 && percent < 0.05 {
        "< 0.1 %".into()
    } else if probability < 1.0 && percent >= 99.95 {
        "> 99.9 %".into()
    } else {
        format!("{percent:.1} %")
    }
}

/// A p-value: small ones by their power of ten.
pub fn p_value(p: f64) -> String {
    match p {
        p if p > 0.0 && p < 1e-3 => scientific(p),
        p => fixed(p, 3),
    }
}

fn with_minus(text: &str) -> String {
    text.replace('-', "−")
}
