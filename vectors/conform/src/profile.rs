//! The working precision in which another program is judged.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::case::{Case, Expected, Question};
use super::suite::Invalid;

/// A working precision: what one rounding costs, and the range of its normal numbers.
///
/// ```
/// use palpate_conform::Profile;
///
/// let single = Profile::named("f32")?;
/// assert_eq!(single.unit_roundoff, 2.0_f64.powi(-24));
/// assert!(Profile::named("f16").is_err(), "no such name, and no such file");
/// # Ok::<(), palpate_conform::Invalid>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// What a verdict calls it.
    pub name: String,
    /// Half the distance from 1 to the next larger number; 0 for the tolerances as they are stated.
    pub unit_roundoff: f64,
    /// The smallest normal number.
    pub smallest: f64,
    /// The largest number.
    pub largest: f64,
}

impl Profile {
    fn new(name: &str, unit_roundoff: f64, smallest: f64, largest: f64) -> Profile {
        let name = name.into();
        Profile {
            name,
            unit_roundoff,
            smallest,
            largest,
        }
    }

    /// The stated tolerances: no case is extreme.
    pub fn exact() -> Profile {
        Profile::new("exact", 0.0, f64::MIN_POSITIVE, f64::MAX)
    }

    /// `exact`, `f64`, `f32`, or a file of JSON with the fields of this type.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no profile that can be.
    ///
    /// Implements: ORA-046.
    pub fn named(name: &str) -> Result<Profile, Invalid> {
        let single = (f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX));
        match name {
            "exact" => Ok(Profile::exact()),
            "f64" => Ok(Profile::new(
                "f64",
                f64::EPSILON / 2.0,
                f64::MIN_POSITIVE,
                f64::MAX,
            )),
            "f32" => Ok(Profile::new(
                "f32",
                f64::from(f32::EPSILON) / 2.0,
                single.0,
                single.1,
            )),
            file => Profile::read(Path::new(file)),
        }
    }

    fn read(path: &Path) -> Result<Profile, Invalid> {
        let wrong = |message: String| Invalid::new(path.display(), message);
        let text = std::fs::read_to_string(path)
            .map_err(|error| wrong(format!("{error}; expected exact, f64, f32 or a file")))?;
        let profile: Profile =
            serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        let Profile {
            unit_roundoff,
            smallest,
            largest,
            ..
        } = profile;
        if !(0.0..=0.25).contains(&unit_roundoff) {
            return Err(wrong(format!(
                "unit_roundoff = {unit_roundoff}, expected 0 to 0.25"
            )));
        }
        if !(0.0 < smallest && smallest < 1.0 && 1.0 < largest) {
            return Err(wrong(format!(
                "smallest = {smallest} and largest = {largest}, expected 0 < smallest < 1 < largest"
            )));
        }
        Ok(profile)
    }

    /// Whether a case is beyond what a careful program of this precision can answer: an argument whose square leaves the range, an
    /// answer outside it, or a case that says itself that so coarse a precision cannot see what it asks.
    ///
    /// Implements: VEC-018, ORA-067.
    pub fn is_extreme(&self, case: &Case) -> bool {
        if self.unit_roundoff == 0.0 {
            return false;
        }
        let outside = |least: f64, most: f64| {
            move |value: f64| value != 0.0 && !(least..=most).contains(&value.abs())
        };
        let beyond = outside(self.smallest.sqrt(), self.largest.sqrt());
        let arguments = match &case.question {
            Question::Arguments(arguments) => arguments.values().any(|value| any(value, &beyond)),
            Question::Line(_) => false,
        };
        let beyond = outside(self.smallest, self.largest);
        let answers = match &case.expected {
            Expected::Values(values) => values.iter().any(|wanted| any(&wanted.value, &beyond)),
            Expected::Refusal { .. } => false,
        };
        arguments || answers || case.roundoff.is_some_and(|most| self.unit_roundoff > most)
    }
}

/// Whether a number of the value, or of its lists, is one that `wanted` finds.
fn any(value: &Value, wanted: &impl Fn(f64) -> bool) -> bool {
    match value {
        Value::Array(values) => values.iter().any(|value| any(value, wanted)),
        value => value.as_f64().is_some_and(wanted),
    }
}
