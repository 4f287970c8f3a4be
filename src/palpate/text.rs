//! Text for people and for files: untrusted names made safe, numbers made short.
//!
//! Formats take a number or a reference to one, which is what templates have.

use std::borrow::Borrow;

/// `text` without the characters that XML 1.0 cannot hold even escaped.
pub fn printable(text: &str) -> String {
    let allowed = |c: char| c == '\n' || !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.replace(|c| !allowed(c), "\u{fffd}")
}

/// `text` as the content of an element or of a quoted attribute, in HTML and in XML.
///
/// Implements: REP-042.
pub fn escape(text: &str) -> String {
    printable(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// The least and the greatest of finite values; `None` without any.
pub fn extremes(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let ends = values.into_iter().map(|value| [value, value]);
    ends.reduce(|[least, greatest], [value, _]| [least.min(value), greatest.max(value)])
}

/// A length (m) in mm, to a nanometre, without trailing zeros.
pub fn millimetres(length: impl Borrow<f64>) -> String {
    trimmed(length.borrow() * 1e3, 6)
}

/// `value` with at most `decimals` decimals and no trailing zeros, with a true minus sign.
pub fn trimmed(value: impl Borrow<f64>, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.borrow());
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    with_minus(if text == "-0" { "0" } else { text })
}

/// `value` with exactly `decimals` decimals and a true minus sign.
pub fn fixed(value: impl Borrow<f64>, decimals: usize) -> String {
    with_minus(&format!("{:.decimals$}", value.borrow()))
}

/// `value` as `1.2e−9`: for residuals.
pub fn scientific(value: impl Borrow<f64>) -> String {
    with_minus(&format!("{:.1e}", value.borrow()))
}

/// A rate that was asked for, in per cent, without its sign: in full, or by its power of ten where it is below 1e−12 %.
pub fn in_percent(rate: impl Borrow<f64>) -> String {
    match 100.0 * rate.borrow() {
        percent if percent > 0.0 && percent < 1e-12 => scientific(percent),
        percent => trimmed(percent, 12),
    }
}

/// Four digits, whatever the size.
pub fn digits(value: impl Borrow<f64>) -> String {
    let value = *value.borrow();
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => {
            let decimals = 3 - libm::floor(libm::log10(size)) as i32;
            fixed(value, decimals.max(0) as usize)
        }
        _ => format!("{value:.3e}"),
    }
}

/// The same of a number that may be missing.
pub fn digits_or_dash(value: &Option<f64>) -> String {
    value.map_or("–".into(), digits)
}

fn with_minus(text: &str) -> String {
    text.replace('-', "−")
}
