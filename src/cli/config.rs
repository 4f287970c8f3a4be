//! The configuration of `palpate run`: which phantoms, where the probe goes, what the detector assumes.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::lists::{Positions, positions};
use super::output::read;
use super::solve::phantom;
use super::{CliError, ContactName};
use crate::csv::one_line;
use crate::fem::MESH_SIZE;
use crate::input::line_of;
use crate::phantom::{BUILTIN_NAMES, Phantom};
use crate::report::Settings;

/// The paper's run, or what a file says instead.
///
/// Implements: CLI-031.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Config {
    /// The phantom without inclusion: built in or a file.
    pub reference: String,
    /// The phantoms that are compared with it.
    pub phantoms: Vec<String>,
    /// Files of measured force maps, shown beside the computed ones.
    pub measured: Vec<PathBuf>,
    /// Depths of the probe.
    #[serde(deserialize_with = "list")]
    pub depths_mm: Positions,
    /// Lateral positions of the probe.
    #[serde(deserialize_with = "list")]
    pub laterals_mm: Positions,
    /// How the forces are computed.
    pub mesh: Mesh,
    /// What the detector assumes.
    pub detection: Detection,
}

/// How the forces are computed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mesh {
    /// Mesh size, mm: 0.5 gives the element sizes of spec/fem.md, another scales them.
    #[serde(deserialize_with = "positive")]
    pub size_mm: f64,
    /// How the gap to the probe is measured.
    pub contact: ContactName,
}

/// What the detector assumes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Detection {
    /// Standard deviation of the noise on a sample, N.
    #[serde(deserialize_with = "positive")]
    pub noise_sd_n: f64,
    /// Largest false-alarm rate.
    #[serde(deserialize_with = "probability")]
    pub max_false_alarm: f64,
    /// Largest miss rate.
    #[serde(deserialize_with = "probability")]
    pub max_miss: f64,
    /// Prior probability of an inclusion.
    #[serde(deserialize_with = "probability")]
    pub prior_h1: f64,
}

impl Default for Config {
    fn default() -> Self {
        let half_millimetres = |first: i32, last: i32| {
            // Halves of a millimetre from their decimal text, as a file would give them.
            Positions(
                (first..=last)
                    .map(|k| f64::from(5 * k) / 10_000.0)
                    .collect(),
            )
        };
        Config {
            reference: BUILTIN_NAMES[0].into(),
            phantoms: BUILTIN_NAMES[1..].iter().map(|&name| name.into()).collect(),
            measured: Vec::new(),
            depths_mm: half_millimetres(0, 8),
            laterals_mm: half_millimetres(-20, 20),
            mesh: Mesh::default(),
            detection: Detection::default(),
        }
    }
}

impl Default for Mesh {
    fn default() -> Self {
        Mesh {
            size_mm: MESH_SIZE * 1e3,
            contact: ContactName::DeformedNormal,
        }
    }
}

impl Default for Detection {
    fn default() -> Self {
        let Settings {
            max_false_alarm,
            max_miss,
            prior_h1,
            noise_sd,
        } = Settings::default();
        Detection {
            noise_sd_n: noise_sd,
            max_false_alarm,
            max_miss,
            prior_h1,
        }
    }
}

impl Config {
    /// Reads a file; keys that it leaves out are the paper's.
    pub fn read(path: &Path) -> Result<Config, CliError> {
        Config::from_toml(&read(path)?, &path.display().to_string())
    }

    /// The configuration in `text`, the content of `file`.
    ///
    /// # Errors
    /// [`CliError::Usage`] with file, line and key.
    ///
    /// Implements: CLI-031.
    pub fn from_toml(text: &str, file: &str) -> Result<Config, CliError> {
        let refused = |at: Option<usize>, message: &str| {
            // What the parser has no place for, such as too deep a nesting, it found up to the end.
            let line = line_of(text, at.unwrap_or(text.len()));
            CliError::Usage(format!("{file}:{line}: {}", one_line(message)))
        };
        let start = |error: &toml::de::Error| error.span().map(|span| span.start);
        let document = toml::Deserializer::parse(text)
            .map_err(|error| refused(start(&error), error.message()))?;
        serde_path_to_error::deserialize(document).map_err(|error| {
            let (path, error) = (error.path().to_string(), error.into_inner());
            let key = if path == "." {
                String::new()
            } else {
                path + ": "
            };
            refused(start(&error), &(key + error.message()))
        })
    }

    /// The reference, then the phantoms that are compared with it. `file` is that of the configuration.
    ///
    /// # Errors
    /// As [`phantom`], and if the probe cannot stand at one of the poses; with file, line and key.
    pub fn read_phantoms(&self, file: Option<&Path>) -> Result<Vec<Phantom>, CliError> {
        let names = std::iter::once(&self.reference).chain(&self.phantoms);
        let read = |(index, name): (usize, &String)| {
            self.read_phantom(name).map_err(|error| match error {
                CliError::Usage(message) => {
                    let place = file.and_then(|file| place_of_phantom(file, index));
                    CliError::Usage(place.unwrap_or_default() + &message)
                }
                other => other,
            })
        };
        names.enumerate().map(read).collect()
    }

    fn read_phantom(&self, name: &str) -> Result<Phantom, CliError> {
        let phantom = phantom(name)?;
        for &depth in &self.depths_mm.0 {
            for &lateral in &self.laterals_mm.0 {
                let pose = phantom.check_pose(depth, lateral);
                pose.map_err(|error| CliError::Usage(format!("phantom {name:?}: {error}")))?;
            }
        }
        Ok(phantom)
    }

    /// Settings of the detector.
    pub fn settings(&self) -> Settings {
        let Detection {
            noise_sd_n,
            max_false_alarm,
            max_miss,
            prior_h1,
        } = self.detection;
        Settings {
            max_false_alarm,
            max_miss,
            prior_h1,
            noise_sd: noise_sd_n,
        }
    }
}

/// File, line and key of a phantom in a configuration, 0 for the reference.
fn place_of_phantom(file: &Path, index: usize) -> Option<String> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Places {
        reference: Option<Spanned<String>>,
        phantoms: Vec<Spanned<String>>,
    }
    let text = crate::input::read(file).ok()?;
    let places: Places = toml::from_str(&text).ok()?;
    let (key, name) = match index.checked_sub(1) {
        None => ("reference".into(), places.reference.as_ref()?),
        Some(k) => (format!("phantoms[{k}]"), places.phantoms.get(k)?),
    };
    let line = line_of(&text, name.span().start);
    Some(format!("{}:{line}: {key}: ", file.display()))
}

fn list<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Positions, D::Error> {
    let text = String::deserialize(deserializer)?;
    positions(&text).map_err(serde::de::Error::custom)
}

/// Refused here, with its line, rather than after all maps are solved.
fn positive<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let is_positive = |number: f64| number.is_finite() && number > 0.0;
    number(deserializer, is_positive, "a number above 0")
}

fn probability<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let is_probability = |number: f64| number > 0.0 && number < 1.0;
    number(
        deserializer,
        is_probability,
        "a probability strictly between 0 and 1",
    )
}

fn number<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
    allowed: impl Fn(f64) -> bool,
    expected: &str,
) -> Result<f64, D::Error> {
    let number = f64::deserialize(deserializer)?;
    if allowed(number) {
        Ok(number)
    } else {
        Err(serde::de::Error::custom(format!(
            "{number}, expected {expected}"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Verifies: CLI-031.
    #[test]
    fn a_number_out_of_its_range_is_refused_with_its_line() {
        let file = std::env::temp_dir().join(format!("palpate-config-{}.toml", std::process::id()));
        for (key, value, expected) in [
            ("[mesh]\nsize_mm", "-1.0", "-1, expected a number above 0"),
            ("[mesh]\nsize_mm", "inf", "inf, expected"),
            (
                "[detection]\nnoise_sd_n",
                "0.0",
                "0, expected a number above 0",
            ),
            ("[detection]\nnoise_sd_n", "nan", "NaN, expected"),
            (
                "[detection]\nmax_false_alarm",
                "1.0",
                "1, expected a probability",
            ),
            ("[detection]\nmax_miss", "0.0", "0, expected a probability"),
            (
                "[detection]\nprior_h1",
                "1.5",
                "1.5, expected a probability",
            ),
        ] {
            std::fs::write(&file, format!("{key} = {value}\n")).unwrap();
            let error = Config::read(&file).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{error}");
            let error = error.to_string();
            assert!(
                error.contains(".toml:2: ") && error.contains(expected),
                "{error}"
            );
            let key = key.trim_start_matches('[').replace("]\n", ".");
            assert!(error.contains(&format!(":2: {key}: ")), "{error}");
        }
        std::fs::remove_file(&file).unwrap();
    }
}
