//! Where the probe is sent, as `simulate` and `reach` take it.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::numbers::{List, at_least_0, passes, position, velocity};
use palpate::simulation::Path;

/// Where the probe is sent.
#[derive(Debug, Args)]
#[group(skip)]
pub struct PathArguments {
    /// Depths of the probe in mm, with one pass at each, in alternate directions: a,b,c in any order or from:to:step
    #[arg(long = "depths-mm", value_name = "LIST", value_parser = passes, allow_hyphen_values = true, group = "way")]
    depths: Option<List>,
    /// Lateral position where the first pass begins, in mm
    #[arg(long = "from-mm", value_name = "X", value_parser = position, allow_hyphen_values = true, default_value = "-8", requires = "depths")]
    from: f64,
    /// Lateral position where the first pass ends and the second begins, in mm
    #[arg(long = "to-mm", value_name = "X", value_parser = position, allow_hyphen_values = true, default_value = "8", requires = "depths")]
    to: f64,
    /// Speed of a pass in mm/s
    #[arg(long = "speed-mm-s", value_name = "V", value_parser = velocity, allow_hyphen_values = true, default_value = "10", requires = "depths")]
    speed: f64,
    /// Any other path: a CSV file with time_s, position_mm and depth_mm of waypoints
    #[arg(long, value_name = "FILE", conflicts_with_all = ["depths", "from", "to", "speed"], group = "way")]
    path: Option<PathBuf>,
    /// Samples per second
    #[arg(long, value_name = "HZ", value_parser = at_least_0, allow_hyphen_values = true, default_value = "100", requires = "way")]
    rate_hz: f64,
}

impl PathArguments {
    /// The path; none if none was given.
    pub fn path(&self) -> Result<Option<Path>, CliError> {
        if let Some(file) = &self.path {
            let path = |text: &str, name: &str| Path::from_csv(text, name, self.rate_hz);
            return Ok(Some(palpate::file::read(file, path)?));
        }
        let Some(depths) = &self.depths else {
            return Ok(None);
        };
        let ends = [self.from, self.to];
        Ok(Some(Path::passes(depths, ends, self.speed, self.rate_hz)?))
    }
}
