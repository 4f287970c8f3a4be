//! `palpate demo`: files to try the other commands on.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::output::{make_folder, print, write};
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable};
use palpate::phantom::Phantom;
use palpate::stats::random::Generator;

/// Arguments of `palpate demo`.
#[derive(Debug, Args)]
pub struct DemoArguments {
    /// The folder to write to
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Depths of the maps, m.
const DEPTHS: [f64; 5] = [0.0, 2e-3, 3.7e-3, 4e-3, 4.3e-3];
/// The row of the sweeps.
const SWEPT: f64 = 4e-3;
/// Positions of the maps to either side.
const LATERALS: i32 = 20;
/// Their distance, m.
const STEP: f64 = 0.4e-3;
/// Samples of a sweep, from one end of the maps to the other.
const SAMPLES: u64 = 401;
/// Noise of a sample, N.
const NOISE: f64 = 0.1;
/// Noise of a measured map, N.
const MAP_NOISE: f64 = 0.01;

const RUN: &str = "\
# For palpate run --config run.toml: the gel without and with one inclusion, against a measured map.
reference = \"none\"
phantoms = [\"4.6\"]
depths_mm = \"0,2,3.7,4,4.3\"
laterals_mm = \"-8:8:0.4\"
measured = [\"measured.csv\"]
";

/// Runs the command.
///
/// Implements: CLI-130.
pub fn demo(arguments: &DemoArguments) -> Result<(), CliError> {
    let folder = &arguments.folder;
    make_folder(folder)?;
    let (none, inclusion) = (map("none")?, map("4.6")?);
    let (without, with) = (none.row(SWEPT)?, inclusion.row(SWEPT)?);
    let exact = Disturbance {
        offset: Force::new(0.0, 0.0),
        drift: Force::new(0.0, 0.0),
        gain: 1.0,
    };
    let disturbed = Disturbance {
        offset: Force::new(0.05, 0.3),
        drift: Force::new(-0.05, 0.1),
        gain: 1.1,
    };
    let blank = Disturbance {
        gain: 0.0,
        ..disturbed
    };
    let files = [
        ("run.toml", RUN.into()),
        ("none.json", none.to_json()),
        ("inclusion.json", inclusion.to_json()),
        ("sweep-without.csv", sweep(without, exact, 1)),
        ("sweep-with.csv", sweep(with, exact, 2)),
        ("sweep-disturbed.csv", sweep(with, disturbed, 3)),
        ("blank.csv", sweep(without, blank, 4)),
        ("measured.csv", measured(inclusion.table())),
    ];
    for (name, text) in files {
        write(&folder.join(name), &text)?;
        print(&format!("{}\n", folder.join(name).display()))?;
    }
    Ok(())
}

/// The forces of a built-in phantom.
fn map(name: &str) -> Result<ForceMap, CliError> {
    let laterals: Vec<f64> = (-LATERALS..=LATERALS)
        .map(|k| STEP * f64::from(k))
        .collect();
    let failed = CliError::fem(name);
    let model = Model::new(&Phantom::builtin(name)?, MESH_SIZE, Contact::default());
    let map = model.map_err(&failed)?.map(&DEPTHS, &laterals, &|_| ());
    map.map_err(&failed)
}

/// What a sensor and another gel make of forces.
#[derive(Clone, Copy)]
struct Disturbance {
    /// N.
    offset: Force<f64>,
    /// From the first to the last sample, N.
    drift: Force<f64>,
    gain: f64,
}

/// A record of the forces over the positions of the maps, with noise.
fn sweep(row: Force<&[f64]>, disturbance: Disturbance, stream: u64) -> String {
    let generator = Generator::new(SEED, stream);
    let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for sample in 0..SAMPLES {
        let share = sample as f64 / (SAMPLES - 1) as f64;
        let place = share * f64::from(2 * LATERALS);
        let channels = row
            .zip(disturbance.offset.zip(disturbance.drift))
            .into_array();
        let mut force = [0.0; 2];
        for (channel, (force, (row, (offset, drift)))) in (0..).zip(force.iter_mut().zip(channels))
        {
            let cell = (place as usize).min(row.len() - 2);
            let share_of_cell = place - cell as f64;
            let exact = (1.0 - share_of_cell) * row[cell] + share_of_cell * row[cell + 1];
            let noise = NOISE * generator.normal(channel, sample);
            *force = disturbance.gain * exact + offset + share * drift + noise;
        }
        let position = (place - f64::from(LATERALS)) * STEP * 1e3;
        let [lateral, normal] = force;
        // A string takes all that is written.
        let _ = writeln!(text, "{position:.3},{lateral:.4},{normal:.4}");
    }
    text
}

/// The map as a rig would measure it, row by row.
fn measured(map: &ForceTable) -> String {
    let generator = Generator::new(SEED, 5);
    let mut text = String::from("depth_mm,lateral_mm,normal_force_n,lateral_force_n\n");
    let mut sample = 0;
    for (row, depth) in map.depths().iter().enumerate() {
        for (column, lateral) in map.laterals().iter().enumerate() {
            let force = map.forces().as_ref().map(|force| force.row(row)[column]);
            let [x, y] = [0, 1].map(|channel| MAP_NOISE * generator.normal(channel, sample));
            let (normal, along) = (force.normal + y, force.lateral + x);
            let (depth, lateral) = (depth * 1e3, lateral * 1e3);
            let _ = writeln!(text, "{depth:.1},{lateral:.1},{normal:.4},{along:.4}");
            sample += 1;
        }
    }
    text
}

/// Of all the noise.
const SEED: u64 = 1999;
