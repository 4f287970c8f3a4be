//! How far an answer may be off.

use std::fmt;

use serde::Deserialize;
use serde_json::Value;

use super::text::shortened;
use super::verdict::Class;

/// How far a number may be off in exact work.
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
fn ulp(value: f64) -> f64 {
    value.abs().next_up() - value.abs()
}

impl Tolerance {
    /// The largest distance from `expected` that passes.
    pub fn allowed(self, expected: f64) -> f64 {
        match self {
            Tolerance::Ulp(count) => count * ulp(expected),
            Tolerance::Absolute(bound) => bound,
            Tolerance::Relative(bound) => bound * expected.abs(),
            Tolerance::Exact => 0.0,
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Tolerance::Ulp(count) => write!(f, "{count} ulp"),
            Tolerance::Absolute(bound) => write!(f, "{bound:e}"),
            Tolerance::Relative(bound) => write!(f, "{bound:e} of it"),
            Tolerance::Exact => f.write_str("0"),
        }
    }
}

/// What one unit roundoff of the working precision adds to the tolerance: one number for a whole value, or one for each entry of a list.
///
/// Implements: VEC-016.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Condition {
    /// For every number of the value.
    All(f64),
    /// For each entry.
    Each(Vec<Condition>),
}

impl Condition {
    /// The one of an entry; there is one, as [`Condition::fits`] found.
    fn entry(&self, index: usize) -> &Condition {
        match self {
            Condition::All(_) => self,
            Condition::Each(entries) => &entries[index],
        }
    }

    /// Whether it has the shape of the value, and all its numbers can be.
    pub fn fits(&self, value: &Value) -> bool {
        match (self, value) {
            (Condition::All(size), _) => (0.0..f64::INFINITY).contains(size),
            (Condition::Each(entries), Value::Array(values)) => {
                let mut pairs = entries.iter().zip(values);
                entries.len() == values.len() && pairs.all(|(entry, value)| entry.fits(value))
            }
            _ => false,
        }
    }
}

/// How far a value may be off in a working precision.
#[derive(Debug, Clone, Copy)]
pub struct Limit<'a> {
    /// In exact work.
    pub tolerance: Tolerance,
    /// So many times that is allowed.
    pub times: f64,
    /// What a unit roundoff adds.
    pub condition: &'a Condition,
    /// The unit roundoff.
    pub unit_roundoff: f64,
}

impl Limit<'_> {
    /// The tolerance as it is stated, so many times.
    pub fn stated(tolerance: Tolerance, times: f64) -> Limit<'static> {
        Limit {
            tolerance,
            times,
            condition: &Condition::All(0.0),
            unit_roundoff: 0.0,
        }
    }

    /// The largest distance from `expected` that passes.
    fn allowed(&self, expected: f64) -> f64 {
        let added = match self.condition {
            Condition::All(condition) => self.unit_roundoff * condition,
            Condition::Each(_) => 0.0,
        };
        self.times * self.tolerance.allowed(expected) + added
    }

    /// Whether `found` is near enough to `expected`.
    pub fn accepts(&self, expected: f64, found: f64) -> bool {
        found == expected || (found - expected).abs() <= self.allowed(expected)
    }
}

/// Where and how an answer differs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The key, with the place in lists.
    pub place: String,
    /// What is expected there and what was found.
    pub text: String,
    /// Mathematics for a wrong value, protocol for one of another kind.
    pub class: Class,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {}", self.place, self.text)
    }
}

/// Whether the value at `place` is within the limit of what is expected.
///
/// # Errors
/// The first difference.
///
/// Implements: ORA-046.
pub fn compare(
    place: &str,
    expected: &Value,
    found: &Value,
    limit: Limit,
) -> Result<(), Difference> {
    let differs = |class, text: String| {
        let place = place.to_string();
        Err(Difference { place, text, class })
    };
    match (expected, found) {
        (Value::Array(expected), Value::Array(found)) => {
            if expected.len() != found.len() {
                let (found, expected) = (found.len(), expected.len());
                let text = format!("has {found} entries, expected {expected}");
                return differs(Class::Mathematics, text);
            }
            let pairs = expected.iter().zip(found).enumerate();
            pairs
                .into_iter()
                .try_for_each(|(index, (expected, found))| {
                    let condition = limit.condition.entry(index);
                    let limit = Limit { condition, ..limit };
                    compare(&format!("{place}[{index}]"), expected, found, limit)
                })
        }
        (Value::Number(expected), Value::Number(found)) => {
            // Without the feature for any precision every number has an f64.
            let (Some(e), Some(a)) = (expected.as_f64(), found.as_f64()) else {
                return differs(Class::Protocol, format!("is {found}, expected {expected}"));
            };
            if limit.accepts(e, a) && a.is_finite() {
                return Ok(());
            }
            let within = match limit.allowed(e) {
                allowed if limit.unit_roundoff > 0.0 => format!("{allowed:.2e}"),
                _ => limit.tolerance.to_string(),
            };
            let distance = (a - e).abs();
            let ulps = match distance / ulp(e) {
                ulps if ulps < 1e6 => format!(", {ulps:.1} ulp"),
                ulps if ulps.is_finite() => format!(", {ulps:.1e} ulp"),
                _ => String::new(),
            };
            differs(
                Class::Mathematics,
                format!(
                    "is {found}, expected {expected} within {within}: off by {distance:.2e}{ulps}"
                ),
            )
        }
        _ if expected == found => Ok(()),
        _ => {
            let class = match (expected, found) {
                (Value::Number(_), Value::Null) => Class::Range,
                (Value::String(_), Value::String(_)) | (Value::Bool(_), Value::Bool(_)) => {
                    Class::Mathematics
                }
                _ => Class::Protocol,
            };
            differs(
                class,
                format!("is {}, expected {expected}", shortened(found)),
            )
        }
    }
}
