//! `palpate demo`: example files for the other commands.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::output::{make_folder, print, write};
use palpate::calibration::{Relaxation, relaxed};
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::phantom::Phantom;
use palpate::stats::random::Generator;

/// Arguments of `palpate demo`.
#[derive(Debug, Args)]
pub struct DemoArguments {
    /// Output folder
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Depths of the maps, m.
const DEPTHS: [f64; 5] = [0.0, 2e-3, 3.7e-3, 4e-3, 4.3e-3];
/// The depth of the sweeps, m.
const SWEPT: f64 = 4e-3;
/// Positions of the maps to either side of x = 0.
const LATERALS: i32 = 20;
/// Their distance, m.
const STEP: f64 = 0.4e-3;
/// Samples of a sweep, from one end of the maps to the other.
const SAMPLES: u64 = 401;
/// Noise of a sample, N.
const NOISE: f64 = 0.1;
/// Noise of a measured map, N.
const MAP_NOISE: f64 = 0.01;
/// An indentation: how far the probe goes from above the gel, where it touches it, m; its speed, m/s; the time between samples and how
/// long it stays, s; how much stiffer than the paper's the gel is; noise of a sample, N.
const WAY: f64 = 4.6e-3;
const TOUCHED: f64 = 0.8e-3;
const SPEED: f64 = 2e-3;
const PERIOD: f64 = 0.025;
const HELD: f64 = 5.0;
const STIFFER: f64 = 1.2;
const CURVE_NOISE: f64 = 0.005;
/// Seed of all noise.
const SEED: u64 = 1999;

const RUN: &str = "\
# For palpate run --config run.toml: the gel without and with one inclusion, against a measured map.
reference = \"none\"
phantoms = [\"4.6\"]
depths_mm = \"0,2,3.7,4,4.3\"
laterals_mm = \"-8:8:0.4\"
measured = [\"measured.csv\"]
";

/// A sensor over a gel: gain; offset and drift from the first to the last sample of the lateral and the normal force, N.
struct Sensor(f64, [[f64; 2]; 2]);

const EXACT: Sensor = Sensor(1.0, [[0.0; 2]; 2]);
/// A sensor that drifts, over a gel that is 10 % stiffer.
const DISTURBED: Sensor = Sensor(1.1, DRIFT);
/// The same sensor without a gel.
const BLANK: Sensor = Sensor(0.0, DRIFT);
const DRIFT: [[f64; 2]; 2] = [[0.05, -0.05], [0.3, 0.1]];

/// Runs the command.
///
/// Implements: CLI-130.
pub fn demo(arguments: &DemoArguments) -> Result<(), CliError> {
    let folder = &arguments.folder;
    make_folder(folder)?;
    let (none, inclusion) = (map("none")?, map("4.6")?);
    let (without, with) = (none.table().row(SWEPT)?, inclusion.table().row(SWEPT)?);
    let files = [
        ("run.toml", RUN.into()),
        ("none.json", none.to_json()),
        ("inclusion.json", inclusion.to_json()),
        ("sweep-without.csv", sweep(without, EXACT, 1)),
        ("sweep-with.csv", sweep(with, EXACT, 2)),
        ("sweep-disturbed.csv", sweep(with, DISTURBED, 3)),
        ("blank.csv", sweep(without, BLANK, 4)),
        ("measured.csv", measured(inclusion.table())?),
        ("curve.csv", curve()?),
    ];
    for (name, text) in files {
        write(&folder.join(name), &text)?;
        print(&format!("{}\n", folder.join(name).display()))?;
    }
    Ok(())
}

/// The forces of a built-in phantom.
fn map(name: &str) -> Result<ForceMap, CliError> {
    let laterals = (-LATERALS..=LATERALS).map(|k| STEP * f64::from(k));
    let laterals: Vec<f64> = laterals.collect();
    let phantom = Phantom::builtin(name)?;
    let model = Model::new(&phantom, MESH_SIZE, Contact::default());
    let map = model.and_then(|model| model.map(&DEPTHS, &laterals, &|_| true));
    map.map_err(CliError::fem(name))
}

/// A record of the forces over the positions of the maps, with noise.
fn sweep(row: Force<&[f64]>, Sensor(gain, drifts): Sensor, stream: u64) -> String {
    let generator = Generator::new(SEED, stream);
    let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for sample in 0..SAMPLES {
        let share = sample as f64 / (SAMPLES - 1) as f64;
        let place = share * f64::from(2 * LATERALS);
        let cell = (place as usize).min(row.normal.len() - 2);
        let share_of_cell = place - cell as f64;
        let force = |channel: u64, row: &[f64], [offset, drift]: [f64; 2]| {
            let exact = (1.0 - share_of_cell) * row[cell] + share_of_cell * row[cell + 1];
            let noise = NOISE * generator.normal(channel, sample);
            gain * exact + offset + share * drift + noise
        };
        let (lateral, normal) = (
            force(0, row.lateral, drifts[0]),
            force(1, row.normal, drifts[1]),
        );
        let position = (place - f64::from(LATERALS)) * STEP * 1e3;
        // A string takes all that is written.
        let _ = writeln!(text, "{position:.3},{lateral:.4},{normal:.4}");
    }
    text
}

/// The map as a rig would measure it, row by row.
fn measured(map: &ForceTable) -> Result<String, CliError> {
    let generator = Generator::new(SEED, 5);
    let mut text = String::from("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n");
    let Force { lateral, normal } = map.both()?;
    for (sample, (row, column, force)) in (0..).zip(normal.entries()) {
        let noise = [0, 1].map(|channel| MAP_NOISE * generator.normal(channel, sample));
        let (normal, along) = (force + noise[1], lateral.row(row)[column] + noise[0]);
        let (depth, x) = (map.depths()[row] * 1e3, map.laterals()[column] * 1e3);
        let _ = writeln!(text, "{depth:.1},{x:.1},{normal:.4},{along:.4}");
    }
    Ok(text)
}

/// An indentation of a stiffer gel that relaxes, (1 + t/1 s)^(−0.135).
fn curve() -> Result<String, CliError> {
    let generator = Generator::new(SEED, 6);
    let samples = ((WAY / SPEED + HELD) / PERIOD) as u32;
    let times: Vec<f64> = (0..samples).map(|k| PERIOD * f64::from(k)).collect();
    let depths: Vec<f64> = times.iter().map(|time| WAY.min(SPEED * time)).collect();
    let phantom = Phantom::builtin("none")?;
    let model = Model::new(&phantom, MESH_SIZE, Contact::default());
    let model = model.map_err(CliError::fem("none"))?;
    let mut below: Vec<f64> = depths.iter().map(|depth| depth - TOUCHED).collect();
    below.retain(|depth| *depth > 0.0);
    below.dedup();
    let map = model.map(&below, &[0.0], &|_| true);
    let map = map.map_err(CliError::fem("none"))?;
    let force = |depth: &f64| {
        let solved = map.table().row(depth - TOUCHED);
        solved.map_or(0.0, |forces| STIFFER * forces.normal[0])
    };
    let elastic: Vec<f64> = depths.iter().map(force).collect();
    let relaxation = Relaxation::PowerLaw.terms(&[0.0, -2.0]);
    let forces = relaxed(&relaxation, &times, &elastic);
    let mut text = String::from("time_s,depth_mm,normal_force_n\n");
    for (sample, (time, depth)) in (0..).zip(times.iter().zip(&depths)) {
        let force = forces[sample as usize] + 0.12 - 0.002 * time;
        let force = force + CURVE_NOISE * generator.normal(0, sample);
        let _ = writeln!(text, "{time:.3},{:.3},{force:.4}", 1e3 * depth);
    }
    Ok(text)
}
