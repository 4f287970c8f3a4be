//! What the commands around playback share.

use std::path::Path;

use super::CliError;
use crate::force_map::{ForceMap, ForceTable, Matrix};
use crate::servo::LoadedTable;

/// The table of a map's file.
///
/// Implements: CLI-062.
pub fn loaded_map(path: &Path) -> Result<LoadedTable, CliError> {
    let map = ForceMap::read(path)?;
    LoadedTable::new(map.forces())
        .map_err(|error| CliError::Playback(format!("{}: {error}", path.display())))
}

/// A table on the poses of the paper's force maps, 9 depths × 41 lateral positions, with forces of
/// the same size, to be timed with.
pub fn paper_table() -> Result<LoadedTable, CliError> {
    let depths: Vec<f64> = (0..9).map(|row| f64::from(row) * 0.5e-3).collect();
    let laterals: Vec<f64> = (-20..=20)
        .map(|column| f64::from(column) * 0.5e-3)
        .collect();
    let normal = Matrix::from_fn(9, 41, |row, _| 0.18 * row as f64);
    let lateral = Matrix::from_fn(9, 41, |row, column| {
        1e-3 * row as f64 * (column as f64 - 20.0)
    });
    let failed = |error: &dyn std::fmt::Display| CliError::Playback(error.to_string());
    let forces =
        ForceTable::new(depths, laterals, normal, lateral).map_err(|error| failed(&error))?;
    LoadedTable::new(&forces).map_err(|error| failed(&error))
}
