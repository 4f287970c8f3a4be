//! How far an answer may be off.

use std::fmt;

use serde::Deserialize;
use serde_json::Value;

use super::outcome::Class;
use super::text::{ensure, shortened};

/// How far a number may be off in exact arithmetic.
///
/// Implements: VEC-004.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "ToleranceText")]
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

/// A tolerance as a file of vectors has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ToleranceText {
    ulp: Option<f64>,
    absolute: Option<f64>,
    unit: Option<String>,
    relative: Option<f64>,
    exact: Option<bool>,
    reason: String,
}

impl TryFrom<ToleranceText> for Tolerance {
    type Error = String;

    fn try_from(text: ToleranceText) -> Result<Tolerance, String> {
        let exact = text.exact == Some(true);
        let given = [
            text.ulp.map(Tolerance::Ulp),
            text.absolute.map(Tolerance::Absolute),
            text.relative.map(Tolerance::Relative),
            exact.then_some(Tolerance::Exact),
        ];
        let &[tolerance] = &given.into_iter().flatten().collect::<Vec<_>>()[..] else {
            return Err("a tolerance needs one of ulp, absolute, relative, exact: true".into());
        };
        let size = text.ulp.or(text.absolute).or(text.relative);
        let size = size.unwrap_or(0.0);
        ensure!(is_size(size), "the tolerance {size} is below 0");
        ensure!(
            text.absolute.is_none() || text.unit.is_some(),
            "an absolute tolerance needs a unit"
        );
        ensure!(!text.reason.trim().is_empty(), "a tolerance needs a reason");
        Ok(tolerance)
    }
}

fn is_size(size: f64) -> bool {
    (0.0..f64::INFINITY).contains(&size)
}

/// The distance of |value| to the next larger f64, 2⁻¹⁰⁷⁴ for zero.
fn ulp(value: f64) -> f64 {
    value.abs().next_up() - value.abs()
}

impl Tolerance {
    /// The largest distance from `expected` that passes.
    fn allowed(self, expected: f64) -> f64 {
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
    /// The condition of an entry; 0 for one that the expected value does not have, but the answer of a bug.
    fn entry(&self, index: usize) -> &Condition {
        match self {
            Condition::All(_) => self,
            Condition::Each(entries) => entries.get(index).unwrap_or(&Condition::All(0.0)),
        }
    }

    /// Whether it has the shape of the value and all its numbers are finite and at least 0.
    pub fn fits(&self, value: &Value) -> bool {
        match (self, value) {
            (Condition::All(size), _) => is_size(*size),
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
    /// In exact arithmetic.
    pub tolerance: Tolerance,
    /// The factor by which that is multiplied.
    pub times: f64,
    /// What one unit roundoff adds.
    pub condition: &'a Condition,
    /// The unit roundoff.
    pub unit_roundoff: f64,
}

impl Limit<'_> {
    /// A multiple of the stated tolerance, without roundoff.
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
        let is_near = found == expected || (found - expected).abs() <= self.allowed(expected);
        is_near && found.is_finite()
    }

    /// The limit, and by how much `found` is off.
    fn excess(&self, expected: f64, found: f64) -> String {
        let within = if self.unit_roundoff > 0.0 {
            format!("{:.2e}", self.allowed(expected))
        } else {
            self.tolerance.to_string()
        };
        let distance = (found - expected).abs();
        let ulps = match distance / ulp(expected) {
            ulps if ulps < 1e6 => format!(", {ulps:.1} ulp"),
            ulps if ulps.is_finite() => format!(", {ulps:.1e} ulp"),
            _ => String::new(),
        };
        format!("within {within}: off by {distance:.2e}{ulps}")
    }
}

/// Where and how an answer differs.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place} {text}")]
pub struct Difference {
    /// The key, with the indices in lists.
    pub place: String,
    /// What was found there, and what should be there.
    pub text: String,
    /// Mathematics for a wrong value, protocol for one of another type.
    pub class: Class,
}

/// Compares the value at `place` with the expected one.
///
/// # Errors
/// Of the differences that exceed the limit, the first of the most serious class.
///
/// Implements: ORA-046.
pub fn compare(
    place: &str,
    expected: &Value,
    found: &Value,
    limit: Limit,
) -> Result<(), Difference> {
    let (class, text) = match (expected, found) {
        (Value::Array(expected), Value::Array(found)) if expected.len() == found.len() => {
            let pairs = expected.iter().zip(found).enumerate();
            let differences = pairs.filter_map(|(index, (expected, found))| {
                let condition = limit.condition.entry(index);
                let limit = Limit { condition, ..limit };
                compare(&format!("{place}[{index}]"), expected, found, limit).err()
            });
            return differences.min_by_key(|of| of.class).map_or(Ok(()), Err);
        }
        (Value::Array(expected), Value::Array(found)) => {
            let (found, expected) = (found.len(), expected.len());
            let text = format!("has {found} entries instead of {expected}");
            (Class::Mathematics, text)
        }
        (Value::Number(expected), Value::Number(found)) => {
            // Every number has an f64, unless serde_json reads any precision.
            let [e, f] = [expected, found].map(|number| number.as_f64().unwrap_or(f64::NAN));
            if limit.accepts(e, f) {
                return Ok(());
            }
            let excess = limit.excess(e, f);
            let text = format!("is {found}, but should be {expected} {excess}");
            (Class::Mathematics, text)
        }
        _ if expected == found => return Ok(()),
        _ => {
            let class = match (expected, found) {
                (Value::Number(_), Value::Null) => Class::Range,
                (Value::String(_), Value::String(_)) | (Value::Bool(_), Value::Bool(_)) => {
                    Class::Mathematics
                }
                _ => Class::Protocol,
            };
            let text = format!("is {}, but should be {expected}", shortened(found));
            (class, text)
        }
    };
    let place = place.to_string();
    Err(Difference { place, text, class })
}
