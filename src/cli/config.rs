//! The configuration of `palpate run`: which phantoms, where the probe goes, what the detector assumes.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::lists::{Positions, positions};
use super::output::read;
use super::{CliError, ContactName, ElementName};
use crate::fem::MeshOptions;
use crate::phantom::BUILTIN_NAMES;
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
    #[serde(deserialize_with = "list")]
    pub depths_mm: Positions,
    #[serde(deserialize_with = "list")]
    pub laterals_mm: Positions,
    pub mesh: Mesh,
    pub detection: Detection,
}

/// How the forces are computed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mesh {
    pub size_mm: f64,
    pub element: ElementName,
    pub contact: ContactName,
}

/// What the detector assumes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Detection {
    pub noise_sd_n: f64,
    pub max_false_alarm: f64,
    pub max_miss: f64,
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
            size_mm: MeshOptions::default().size * 1e3,
            element: ElementName::T6,
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
        let text = read(path)?;
        toml::from_str(&text).map_err(|error| {
            let line = error
                .span()
                .map(|span| 1 + text[..span.start].matches('\n').count());
            let place = line.map_or(String::new(), |line| format!(":{line}"));
            let message = error
                .message()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ");
            CliError::Usage(format!("{}{place}: {message}", path.display()))
        })
    }

    /// Options of the mesh.
    pub fn mesh_options(&self) -> MeshOptions {
        MeshOptions {
            size: self.mesh.size_mm / 1e3,
            element: self.mesh.element.into(),
            ..MeshOptions::default()
        }
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

fn list<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Positions, D::Error> {
    let text = String::deserialize(deserializer)?;
    positions(&text).map_err(serde::de::Error::custom)
}
