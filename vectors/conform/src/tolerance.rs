//! How far an answer may be off.

use std::fmt;

use serde_json::Value;

/// How far a number may be off.
///
/// Implements: VEC-004.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Units in the last place of the expected value.
    Ulp(f64),
    /// In the unit of the number.
    Absolute(f64),
    /// Relative to the expected value.
    Relative(f64),
    /// Not at all.
    Exact,
}

/// The distance of |value| to the next larger f64, 2⁻¹⁰⁷⁴ for zero.
pub fn ulp(value: f64) -> f64 {
    value.abs().next_up() - value.abs()
}

impl Tolerance {
    /// Whether `found` is near enough to `expected`, with the tolerance taken `times`.
    pub fn accepts(self, expected: f64, found: f64, times: f64) -> bool {
        let distance = (found - expected).abs();
        match self {
            Tolerance::Ulp(count) => distance <= times * count * ulp(expected),
            Tolerance::Absolute(bound) => distance <= times * bound,
            Tolerance::Relative(bound) => distance <= times * bound * expected.abs(),
            Tolerance::Exact => found == expected,
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Tolerance::Ulp(count) => write!(f, "{count} ulp"),
            Tolerance::Absolute(bound) => write!(f, "{bound:e}"),
            Tolerance::Relative(bound) => write!(f, "{bound:e} of it"),
            Tolerance::Exact => f.write_str("exactly"),
        }
    }
}

/// Where and how an answer differs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The key, with the place in lists.
    pub place: String,
    /// What is expected there and what was found.
    pub text: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {}", self.place, self.text)
    }
}

/// Whether the value at `place` is within `times` the tolerance of what is expected.
///
/// # Errors
/// The first difference.
///
/// Implements: ORA-046.
pub fn compare(
    place: &str,
    expected: &Value,
    found: &Value,
    tolerance: Tolerance,
    times: f64,
) -> Result<(), Difference> {
    let differs = |text: String| {
        let place = place.to_string();
        Err(Difference { place, text })
    };
    match (expected, found) {
        (Value::Array(expected), Value::Array(found)) => {
            if expected.len() != found.len() {
                return differs(format!(
                    "has {} entries, expected {}",
                    found.len(),
                    expected.len()
                ));
            }
            expected
                .iter()
                .zip(found)
                .enumerate()
                .try_for_each(|(index, (expected, found))| {
                    let place = format!("{place}[{index}]");
                    compare(&place, expected, found, tolerance, times)
                })
        }
        (Value::Number(expected), Value::Number(found)) => {
            // Without the feature for any precision every number has an f64.
            let (Some(e), Some(a)) = (expected.as_f64(), found.as_f64()) else {
                return differs(format!("is {found}, expected {expected}"));
            };
            if tolerance.accepts(e, a, times) && a.is_finite() {
                return Ok(());
            }
            let distance = (a - e).abs();
            let ulps = match distance / ulp(e) {
                ulps if ulps < 1e6 => format!(", {ulps:.1} ulp"),
                ulps if ulps.is_finite() => format!(", {ulps:.1e} ulp"),
                _ => String::new(),
            };
            differs(format!(
                "is {found}, expected {expected} within {tolerance}: off by {distance:.2e}{ulps}"
            ))
        }
        _ if expected == found => Ok(()),
        _ => differs(format!("is {}, expected {expected}", shortened(found))),
    }
}

/// A value as text, cut if it is long.
pub fn shortened(value: &Value) -> String {
    cut(&value.to_string())
}

/// A text of at most some 200 characters, without those that control a terminal.
pub fn cut(text: &str) -> String {
    const MOST: usize = 200;
    let plain = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let mut cut: String = text.chars().take(MOST).map(plain).collect();
    if text.chars().nth(MOST).is_some() {
        cut.push('…');
    }
    cut
}
