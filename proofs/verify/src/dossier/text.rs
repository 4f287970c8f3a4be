//! Names and numbers as the page shows them.

use crate::Figure;
pub use palpate::text::scientific;
use palpate::text::{escape, trimmed};

/// Markup of a name of several words, which may be broken between them.
pub fn breakable(name: &str) -> String {
    escape(name)
        .replace('.', ".<wbr>")
        .replace('_', "_<wbr>")
        .replace("::", "::<wbr>")
}

/// A figure with its bounds.
pub fn told(figure: &Figure) -> String {
    format!(
        "{}: {}{}",
        figure.what,
        number(figure.value),
        bounds(figure)
    )
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

/// A figure of the diagnostic accuracy without its name: a share that would round to 1 as what it lacks.
pub fn share(figure: &Figure) -> String {
    let value = figure.value;
    let text = match trimmed(value, 5).as_str() {
        _ if figure.at_most > 1.0 => trimmed(value, 3),
        "1" if value < 1.0 => format!("1 − {}", scientific(1.0 - value)),
        text => text.into(),
    };
    text + &bounds(figure)
}

/// A share in percent.
pub fn percent(share: &f64) -> String {
    format!("{} %", trimmed(100.0 * share, 1))
}

/// A count.
pub fn count(value: &usize) -> String {
    number(*value as f64)
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

#[cfg(test)]
mod tests {
    use super::*;

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
