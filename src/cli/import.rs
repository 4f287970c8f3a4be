//! `palpate import-map`: a measured force map in CSV, checked and written as JSON.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::output::{print, read, write};
use super::solve::phantom;
use crate::force_map::ForceMap;

/// Arguments of `palpate import-map`.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// The forces: a header with depth_mm, lateral_mm, normal_force_n, lateral_force_n, and a row for each pose
    #[arg(value_name = "FILE")]
    csv: PathBuf,
    /// What was measured, kept in the map
    #[arg(long, default_value = "")]
    note: String,
    /// The phantom that was measured: built in or a file
    #[arg(long, value_name = "NAME|FILE")]
    phantom: Option<String>,
    /// Writes the map there instead of to standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs the command.
///
/// Implements: CLI-020.
pub fn import(arguments: &ImportArguments) -> Result<(), CliError> {
    let phantom = arguments.phantom.as_deref().map(phantom).transpose()?;
    let text = read(&arguments.csv)?;
    let file = arguments.csv.display().to_string();
    let map = ForceMap::from_csv(&text, &file, &arguments.note, phantom)?;
    match &arguments.out {
        Some(path) => write(path, &map.to_json()),
        None => print(&map.to_json()),
    }
}
