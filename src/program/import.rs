//! `palpate import-map`: a measured force map in CSV, checked and converted to JSON.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::comparison::{compare, left_out};
use super::error::refuse;
use super::layout::LayoutArguments;
use super::numbers::length;
use super::output::{note, print, read, write};
use super::solve::phantom;
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, Gridded, Measurement, Smoothed, Source};
use palpate::phantom::Phantom;

/// Arguments of `palpate import-map`.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// Measured forces: a CSV file with depth_mm, lateral_mm, normal_force_n and lateral_force_n, one row per pose
    #[arg(value_name = "FILE")]
    csv: PathBuf,
    /// Note on the measurement, stored in the map
    #[arg(long, default_value = "")]
    note: String,
    /// The phantom that was measured (built-in or file): compares the measured forces with the computed ones
    #[arg(long, value_name = "NAME|FILE")]
    phantom: Option<String>,
    /// Smooths the forces along the lateral axis by local parabolas of half-width W mm, and reports the noise
    #[arg(long = "smooth-mm", value_name = "W", value_parser = length, allow_hyphen_values = true)]
    half_width: Option<f64>,
    /// Puts samples at jittered or scattered poses on a grid with this step in mm, or with one of depth and one of lateral position
    #[arg(long = "grid-mm", value_name = "STEP[,STEP]", value_parser = length, value_delimiter = ',', allow_hyphen_values = true)]
    grid: Vec<f64>,
    #[command(flatten)]
    layout: LayoutArguments,
    /// Output file [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs the command.
///
/// Implements: CLI-020, CLI-017.
pub fn import(arguments: &ImportArguments) -> Result<(), CliError> {
    let phantom = arguments.phantom.as_deref().map(phantom).transpose()?;
    let text = read(&arguments.csv)?;
    let file = arguments.csv.display().to_string();
    let mut measurement = Measurement::new(&file, &arguments.note);
    measurement.grid = match arguments.grid[..] {
        [] => None,
        [step] => Some([step, step]),
        [depth, lateral] => Some([depth, lateral]),
        ref steps => refuse!("--grid-mm has {} steps; give one or two", steps.len()),
    };
    let layout = arguments.layout.get()?;
    let (mut forces, notes) = match measurement.grid {
        None => ForceTable::from_csv_with_notes(&text, &file, Some(&layout))?,
        Some(steps) => {
            let read = ForceTable::from_scattered_csv(&text, &file, &layout, steps)?;
            let (gridded, mut notes) = read;
            notes.push(shifts(&gridded));
            (gridded.table, notes)
        }
    };
    notes.iter().for_each(|text| note(&file, text));
    if let Some(half_width) = arguments.half_width {
        let smoothed = forces.smoothed(half_width);
        let smoothed = smoothed.map_err(|refusal| refusal.in_file(&*file))?;
        note(&file, &noise(&smoothed));
        forces = smoothed.table;
        measurement.smoothed_half_width = Some(half_width);
    }
    let phantom = phantom.and_then(|phantom| compared(&file, &forces, phantom));
    let map = ForceMap::new(Source::Measured(measurement), phantom, forces);
    let map = map.map_err(|refusal| refusal.in_file(file))?;
    match &arguments.out {
        Some(path) => write(path, &map.to_json()),
        None => print(&map.to_json()),
    }
}

/// Implements: MAP-081.
fn shifts(gridded: &Gridded) -> String {
    let [depth, lateral] = gridded.largest_shift.map(|shift| 1e3 * shift);
    let left = of_forces(gridded.residual);
    format!(
        "samples are at most {depth:.3} mm (depth) and {lateral:.3} mm (lateral) from the grid; the planes leave {left}, root mean square"
    )
}

/// Implements: CLI-020.
fn noise(smoothed: &Smoothed) -> String {
    let (sd, freedom) = (of_forces(smoothed.noise_sd), smoothed.degrees_of_freedom);
    format!(
        "noise sd of a sample, from the residuals of smoothing: {sd}, with {freedom:.1} degrees of freedom each"
    )
}

/// A number of newtons of each force that is there, in words.
fn of_forces(Force { lateral, normal }: Force<Option<f64>>) -> String {
    let forces = [(normal, "normal"), (lateral, "lateral")].into_iter();
    let there = forces.filter_map(|(newtons, name)| Some(format!("{:.4} N ({name})", newtons?)));
    there.collect::<Vec<_>>().join(" and ")
}

/// The phantom, if its probe can reach each pose; notes what stands out in the forces.
///
/// Implements: CLI-022.
fn compared(file: &str, forces: &ForceTable, phantom: Phantom) -> Option<Phantom> {
    let name = phantom.name();
    let note = |text: &str| note(file, &format!("phantom {name}: {text}"));
    match compare(forces, &phantom) {
        Ok(findings) => findings.iter().for_each(|text| note(text)),
        Err(error) => note(&format!("not compared: {error}")),
    }
    let left_out = left_out(forces, &phantom);
    if left_out == 0 {
        return Some(phantom);
    }
    let all = forces.normal().values().len();
    note(&format!(
        "the probe cannot reach {left_out} of {all} poses; the map is stored without its phantom"
    ));
    None
}
