//! The configuration of `palpate run`: phantoms, poses of the probe, assumptions of the detector.

use std::path::{Path, PathBuf};

use serde::de::Error;
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use super::CliError;
use super::numbers::{List, positions};
use super::solve::phantom;
use palpate::csv::Layout;
use palpate::fem::{Contact, MESH_SIZE};
use palpate::file::{from_toml, line_of};
use palpate::phantom::{BUILTIN_NAMES, Phantom};
use palpate::refusal::Refusal;
use palpate_paper::report::Settings;

/// The paper's run, or what a file says instead.
///
/// Implements: CLI-031.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Config {
    /// The phantom without inclusion: built in or a file.
    pub reference: Spanned<String>,
    /// The phantoms that are compared with it.
    pub phantoms: Vec<Spanned<String>>,
    /// Files of measured force maps, shown beside the computed ones.
    pub measured: Vec<PathBuf>,
    /// Which columns of those in CSV hold what.
    pub columns: Layout,
    /// Depths of the probe, m.
    #[serde(rename = "depths_mm", deserialize_with = "list")]
    pub depths: List,
    /// Lateral positions of the probe, m.
    #[serde(rename = "laterals_mm", deserialize_with = "list")]
    pub laterals: List,
    /// How the forces are computed.
    pub mesh: MeshConfig,
    /// What the detector assumes.
    #[serde(with = "Detection")]
    pub detection: Settings,
    /// The file and its text; empty for the paper's run.
    #[serde(skip)]
    source: [String; 2],
}

/// How the forces are computed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MeshConfig {
    /// Mesh size, mm: 0.5 gives the element sizes of spec/fem.md, another scales them as that states.
    #[serde(deserialize_with = "positive")]
    pub size_mm: f64,
    /// Contact law.
    pub contact: Contact,
}

/// [`Settings`] in the keys of the file.
#[derive(Deserialize)]
#[serde(
    remote = "Settings",
    deny_unknown_fields,
    default = "Settings::default"
)]
struct Detection {
    #[serde(deserialize_with = "positive")]
    noise_sd_n: f64,
    #[serde(deserialize_with = "probability")]
    max_false_alarm: f64,
    #[serde(deserialize_with = "probability")]
    max_miss: f64,
    #[serde(deserialize_with = "probability")]
    prior_h1: f64,
}

impl Default for Config {
    fn default() -> Self {
        // As a file would give them.
        let list = |text| positions(text).expect("a list of positions");
        let name = |name: &str| Spanned::new(0..0, name.into());
        Config {
            reference: name(BUILTIN_NAMES[0]),
            phantoms: BUILTIN_NAMES[1..].iter().copied().map(name).collect(),
            measured: Vec::new(),
            columns: Layout::default(),
            depths: list("0:4:0.5"),
            laterals: list("-10:10:0.5"),
            mesh: MeshConfig::default(),
            detection: Settings::default(),
            source: Default::default(),
        }
    }
}

impl Default for MeshConfig {
    fn default() -> Self {
        MeshConfig {
            size_mm: MESH_SIZE * 1e3,
            contact: Contact::DeformedNormal,
        }
    }
}

impl Config {
    /// The configuration in `text`, the content of `file`; keys that it leaves out are the paper's.
    ///
    /// # Errors
    /// What is wrong, with file, line and key.
    ///
    /// Implements: CLI-031.
    pub fn from_toml(text: &str, file: &str) -> Result<Config, Refusal> {
        let config: Config = from_toml(text, file)?;
        Ok(config.from_source(text, file))
    }

    /// The configuration as a part of `text`, the content of `file`.
    pub fn from_source(self, text: &str, file: &str) -> Config {
        let source = [file.into(), text.into()];
        Config { source, ..self }
    }

    /// The reference, then the phantoms that are compared with it.
    ///
    /// # Errors
    /// A phantom that is refused, or whose probe cannot reach one of the poses; with file, line and key.
    pub fn read_phantoms(&self) -> Result<Vec<Phantom>, CliError> {
        let read = |(key, name): (String, &Spanned<String>)| {
            let read = self.read_phantom(name.as_ref());
            read.map_err(|error| match error {
                CliError::Usage(message) => self.refused(&key, name, &message),
                other => other,
            })
        };
        self.names().map(read).collect()
    }

    /// Refuses what [`Config::read_phantoms`] gives where a phantom has another theory than the reference: their difference would be
    /// no inclusion's.
    ///
    /// Implements: CLI-031.
    pub fn check_theory(&self, phantoms: &[Phantom]) -> Result<(), CliError> {
        let theory = |phantom: &Phantom| {
            let friction = phantom.probe().friction;
            format!("strain = \"{}\" with friction {friction}", phantom.strain())
        };
        let expected = theory(&phantoms[0]);
        for ((key, name), phantom) in self.names().zip(phantoms) {
            let found = theory(phantom);
            if found != expected {
                let message = format!(
                    "{found}, but the reference has {expected}; give one that has the same as reference"
                );
                return Err(self.refused(&key, name, &message));
            }
        }
        Ok(())
    }

    /// The phantoms' keys and names, the reference first.
    fn names(&self) -> impl Iterator<Item = (String, &Spanned<String>)> {
        let keys = (0..self.phantoms.len()).map(|at| format!("phantoms[{at}]"));
        let keys = std::iter::once("reference".into()).chain(keys);
        keys.zip(std::iter::once(&self.reference).chain(&self.phantoms))
    }

    /// The refusal of the phantom under `key`, with file and line if it stands in one.
    fn refused(&self, key: &str, name: &Spanned<String>, message: &str) -> CliError {
        let [file, text] = &self.source;
        let place = match name.span() {
            span if span.is_empty() => String::new(),
            span => format!("{file}:{}: {key}: ", line_of(text, span.start)),
        };
        CliError::Usage(place + message)
    }

    /// The path of a file that the configuration names.
    ///
    /// Implements: CLI-031.
    pub fn file(&self, name: &Path) -> PathBuf {
        let [source, _] = &self.source;
        let folder = Path::new(source).parent();
        folder.unwrap_or(Path::new("")).join(name)
    }

    fn read_phantom(&self, name: &str) -> Result<Phantom, CliError> {
        let phantom = if BUILTIN_NAMES.contains(&name) {
            phantom(name)?
        } else {
            phantom(&self.file(Path::new(name)).to_string_lossy())?
        };
        for &depth in &self.depths {
            for &lateral in &self.laterals {
                let pose = phantom.check_pose(depth, lateral);
                pose.map_err(|error| CliError::Usage(format!("phantom {name:?}: {error}")))?;
            }
        }
        Ok(phantom)
    }
}

fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<List, D::Error> {
    positions(&String::deserialize(deserializer)?).map_err(D::Error::custom)
}

/// A number above 0. Refused here, with its line, rather than after all maps are solved.
fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    number(deserializer, f64::MAX, "a number above 0")
}

fn probability<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let must_be = "a probability strictly between 0 and 1";
    number(deserializer, 1f64.next_down(), must_be)
}

/// A number above 0 and at most `most`.
fn number<'de, D: Deserializer<'de>>(
    deserializer: D,
    most: f64,
    must_be: &str,
) -> Result<f64, D::Error> {
    let number = f64::deserialize(deserializer)?;
    if number > 0.0 && number <= most {
        return Ok(number);
    }
    Err(D::Error::custom(format!("{number} must be {must_be}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-031.
    #[test]
    fn a_number_out_of_its_range_is_refused_with_its_line() {
        let (above, rate) = ("a number above 0", "a probability strictly between 0 and 1");
        for (table, key, value, expected) in [
            ("mesh", "size_mm", -1.0, above),
            ("mesh", "size_mm", f64::INFINITY, above),
            ("detection", "noise_sd_n", 0.0, above),
            ("detection", "noise_sd_n", f64::NAN, above),
            ("detection", "max_false_alarm", 1.0, rate),
            ("detection", "max_miss", 0.0, rate),
            ("detection", "prior_h1", 1.5, rate),
        ] {
            let text = format!("[{table}]\n{key} = {value:?}\n").replace("NaN", "nan");
            let error = Config::from_toml(&text, "run.toml").unwrap_err();
            let expected = format!("run.toml:2: {table}.{key}: {value} must be {expected}");
            assert_eq!(error.to_string(), expected);
            assert_eq!(CliError::from(error).exit_code(), 2);
        }
    }
}
