//! The working precision in which another program is judged.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::case::{Case, Question};
use super::text::{Invalid, ensure};

/// A working precision: its unit roundoff, and the range of its normal numbers.
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
    /// Its name in a verdict.
    pub name: String,
    /// Half the distance from 1 to the next larger number; 0 for the tolerances as they are stated.
    pub unit_roundoff: f64,
    /// The smallest normal number.
    pub smallest: f64,
    /// The largest number.
    pub largest: f64,
}

impl Profile {
    /// A profile with the range of f64.
    fn wide(name: &str, unit_roundoff: f64) -> Profile {
        Profile {
            name: name.into(),
            unit_roundoff,
            smallest: f64::MIN_POSITIVE,
            largest: f64::MAX,
        }
    }

    /// The stated tolerances; no case is extreme.
    pub fn exact() -> Profile {
        Profile::wide("exact", 0.0)
    }

    /// `exact`, `f64`, `f32`, or a JSON file with the fields of this type.
    ///
    /// # Errors
    /// A file that cannot be read or does not hold a valid profile.
    ///
    /// Implements: ORA-046.
    pub fn named(name: &str) -> Result<Profile, Invalid> {
        match name {
            "exact" => Ok(Profile::exact()),
            "f64" => Ok(Profile::wide("f64", f64::EPSILON / 2.0)),
            "f32" => Ok(Profile {
                name: "f32".into(),
                unit_roundoff: (f32::EPSILON / 2.0).into(),
                smallest: f32::MIN_POSITIVE.into(),
                largest: f32::MAX.into(),
            }),
            file => Profile::read(Path::new(file)).map_err(|message| Invalid::new(file, message)),
        }
    }

    fn read(path: &Path) -> Result<Profile, String> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("{error}; a profile is exact, f64, f32 or a JSON file"))?;
        let profile: Profile = serde_json::from_str(&text).map_err(|error| error.to_string())?;
        ensure!(
            !["exact", "f64", "f32"].contains(&&*profile.name),
            "name = {:?} is that of another profile; give a name of its own",
            profile.name
        );
        let (u, smallest, largest) = (profile.unit_roundoff, profile.smallest, profile.largest);
        ensure!(
            (0.0..=0.25).contains(&u),
            "unit_roundoff = {u} is not from 0 to 0.25"
        );
        ensure!(
            0.0 < smallest && smallest < 1.0 && 1.0 <= largest,
            "smallest = {smallest} and largest = {largest}, but 0 < smallest < 1 <= largest must hold"
        );
        Ok(profile)
    }

    /// Its name and unit roundoff.
    pub(crate) fn in_words(&self) -> String {
        match self.unit_roundoff {
            0.0 => self.name.clone(),
            u => format!("{} (unit roundoff {u:.2e})", self.name),
        }
    }

    /// Whether a case is beyond what a careful program of this precision can answer: an argument whose square leaves the range, an
    /// answer outside it, or a case that needs a finer precision.
    ///
    /// Implements: VEC-018, ORA-067.
    pub fn is_extreme(&self, case: &Case) -> bool {
        if self.unit_roundoff == 0.0 {
            return false;
        }
        let leaves = |value: &Value, smallest: f64, largest: f64| {
            any(value, &|number| {
                number != 0.0 && !(smallest..=largest).contains(&number.abs())
            })
        };
        let (smallest, largest) = (self.smallest, self.largest);
        let is_large = |value| leaves(value, smallest.sqrt(), largest.sqrt());
        let arguments = match &case.question {
            Question::Arguments(arguments) => arguments.values().any(is_large),
            Question::Line(_) => false,
        };
        let mut values = case.expected.values().iter();
        let answers = values.any(|wanted| leaves(&wanted.value, smallest, largest));
        arguments || answers || case.roundoff.is_some_and(|most| self.unit_roundoff > most)
    }
}

/// Whether the condition holds for a number of the value, or of its lists.
fn any(value: &Value, condition: &impl Fn(f64) -> bool) -> bool {
    match value {
        Value::Array(values) => values.iter().any(|value| any(value, condition)),
        value => value.as_f64().is_some_and(condition),
    }
}
