//! What uncertain inputs do to every number: a study computes the phantoms, and what follows from them, for many values of the inputs
//! (`spec/study.md`).
//!
//! | file | content |
//! |---|---|
//! | `mod.rs` | what is varied |
//! | `distribution.rs` | what is known of an input |
//! | `design.rs` | the samples |
//! | `sample.rs` | what is computed of each |
//! | `indices.rs` | Sobol' indices |
//! | `bands.rs` | quantiles of a sample |
//! | `results.rs` | what a study found |

mod bands;
mod design;
mod distribution;
mod indices;
mod results;
mod sample;
#[cfg(test)]
pub mod tests;

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

pub use bands::{Band, band};
pub use design::{Correlation, Design, MOST_INPUTS, Role};
pub use distribution::Distribution;
pub use indices::{Estimate, Index, indices};
pub use results::{Conclusion, Failure, QuantityResult, Slope, StudyResults};
pub use sample::{Kind, Quantity, Sampler};

use crate::settings::Settings;
use palpate::detect::map_threshold;
use palpate::fem::Contact;
use palpate::phantom::Phantom;
use palpate::refusal::Refusal;

/// The depth of the probe, as the key of an input.
const PROBE_DEPTH: &str = "probe_depth_mm";
/// The noise of a sample, as the key of an input.
const NOISE_SD: &str = "noise_sd_n";

/// What the value of an input does to a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Takes its place.
    #[default]
    Value,
    /// Is added to it.
    Offset,
    /// Multiplies it.
    Factor,
}

/// In a word.
impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl Change {
    /// The number that `own` becomes.
    fn of(self, own: f64, value: f64) -> f64 {
        match self {
            Change::Value => value,
            Change::Offset => own + value,
            Change::Factor => own * value,
        }
    }
}

/// An input that is not known exactly.
///
/// Implements: STU-001.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// What it is called in tables.
    pub name: String,
    /// The key of a number of the phantoms' files, `probe_depth_mm` or `noise_sd_n`. A phantom without that key is not changed.
    pub key: String,
    /// What the value does to the number.
    #[serde(default)]
    pub change: Change,
    /// How likely each value is, in the unit of the key.
    pub distribution: Distribution,
    /// Where this is known from.
    pub source: String,
}

/// What a study varies, and what it computes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyPlan {
    /// The phantom without inclusion.
    pub reference: Phantom,
    /// The phantoms that are compared with it, each with a name of its own.
    pub phantoms: Vec<Phantom>,
    /// The depth of the probe, m.
    #[serde(rename = "probe_depth_m")]
    pub probe_depth: f64,
    /// Lateral positions of the probe, m.
    #[serde(rename = "laterals_m")]
    pub laterals: Vec<f64>,
    /// The mesh size, m.
    #[serde(rename = "mesh_size_m")]
    pub mesh_size: f64,
    /// How the gap to the probe is measured.
    pub contact: Contact,
    /// What the detector assumes.
    #[serde(flatten)]
    pub settings: Settings,
    /// The inputs.
    pub inputs: Vec<Input>,
    /// Which inputs go together.
    pub correlations: Vec<Correlation>,
    /// Rows of each of the two samples.
    pub rows: usize,
    /// The seed of the sequence.
    pub seed: u32,
}

impl StudyPlan {
    /// The reference, then the phantoms that are compared with it.
    pub fn all_phantoms(&self) -> impl Iterator<Item = &Phantom> {
        std::iter::once(&self.reference).chain(&self.phantoms)
    }

    /// A phantom with the values of the inputs, of those whose keys it has.
    ///
    /// # Errors
    /// As [`Phantom::set`].
    ///
    /// Implements: STU-001.
    fn changed(&self, phantom: &Phantom, values: &[f64]) -> Result<Phantom, Refusal> {
        let mut numbers: BTreeMap<&str, f64> = BTreeMap::new();
        for (Input { key, change, .. }, &value) in self.inputs.iter().zip(values) {
            let own = numbers.get(&**key).copied();
            if let Some(own) = own.or_else(|| phantom.number(key)) {
                numbers.insert(key, change.of(own, value));
            }
        }
        phantom.set(numbers)
    }

    /// The samples of this plan.
    ///
    /// # Errors
    /// Phantoms of which two have the same name; an input without a name of its own, a source, or a key that the study or one of the
    /// phantoms has; a distribution that does not exist; rates that cannot be kept; as [`Design::new`].
    ///
    /// Implements: STU-001, STU-011.
    pub fn design(&self) -> Result<Design, Refusal> {
        self.settings.required_gamma()?;
        map_threshold(self.settings.prior_h1)?;
        let phantoms: Vec<&str> = self.all_phantoms().map(|phantom| phantom.name()).collect();
        let names: Vec<&str> = self.inputs.iter().map(|input| &*input.name).collect();
        for (key, names) in [("phantoms", &phantoms), ("input.name", &names)] {
            if let Some(twice) = first_repeated(names) {
                let found = format!("{twice:?} twice");
                return Err(Refusal::value(key, found, "another name for each"));
            }
        }
        for (at, input) in self.inputs.iter().enumerate() {
            let of_input = |refusal: Refusal| refusal.under(&format!("input[{at}]"));
            self.check(input).map_err(of_input)?;
            let is_replaced = self.inputs[..at].iter().any(|of| of.key == input.key);
            let expected =
                "a key of no earlier input, whose value this one replaces; or give another change";
            let wrong = Refusal::value("key", format!("{:?}", input.key), expected);
            let wrong = wrong.when(is_replaced && input.change == Change::Value);
            wrong.map_err(of_input)?;
        }
        Design::new(&names, &self.correlations, self.rows, self.seed)
    }

    fn check(&self, input: &Input) -> Result<(), Refusal> {
        for (key, text) in [("name", &input.name), ("source", &input.source)] {
            if text.trim().is_empty() {
                return Err(Refusal::value(
                    key,
                    format!("{text:?}"),
                    "a text that is not blank",
                ));
            }
        }
        let distribution = input.distribution.check();
        distribution.map_err(|refusal| refusal.under("distribution"))?;
        if [PROBE_DEPTH, NOISE_SD].contains(&&*input.key) {
            return Ok(());
        }
        let has_key = |phantom: &Phantom| phantom.number(&input.key).is_some();
        if self.all_phantoms().any(has_key) {
            return Ok(());
        }
        let expected = format!(
            "the key of a number of one of the phantoms, such as layer[0].thickness_mm, {PROBE_DEPTH} or {NOISE_SD}"
        );
        Err(Refusal::value("key", format!("{:?}", input.key), expected))
    }
}

/// The first of `names` that is there before.
fn first_repeated<'a>(names: &[&'a str]) -> Option<&'a str> {
    let mut places = names.iter().enumerate();
    let repeated = places.find(|(at, name)| names[..*at].contains(name));
    repeated.map(|(_, name)| *name)
}
