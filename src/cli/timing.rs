//! `palpate timing`: the budget of the servo loop on this machine (`spec/playback-command.md`).

use std::fmt::Display;
use std::path::PathBuf;
use std::time::Duration;

use askama::Template;
use clap::Args;

use super::playback::{limits, loaded_map};
use super::{CliError, Format};
use crate::hid::simulated::PAPER;
use crate::hid::timing::{Timing, measure, paper};

/// Arguments of `palpate timing`.
#[derive(Debug, Args)]
pub struct TimingArguments {
    /// The time that a cycle may take, in µs
    #[arg(long, value_name = "T", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    budget_us: u64,
    /// How many cycles are measured
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1000..=100_000_000))]
    cycles: u64,
    /// Lets the cycles come at 1 kHz, so that the wake-up by the system counts too
    #[arg(long)]
    paced: bool,
    /// A force map to play [default: a table of 9 × 41 poses]
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// How the figures are printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Runs the command.
///
/// Implements: CLI-060, CLI-061.
pub fn timing(arguments: &TimingArguments) -> Result<(), CliError> {
    let loaded = match &arguments.map {
        Some(path) => loaded_map(path)?,
        None => paper::table()?,
    };
    let table = loaded.table().map_err(defect)?;
    let limits = limits(4.0)?;
    let budget = Duration::from_micros(arguments.budget_us);
    let device = paper::device(arguments.cycles);
    let paced = arguments.paced.then(|| PAPER.period());
    let timing = measure(device, table, limits, arguments.cycles, budget, paced);
    let timing = timing.map_err(defect)?;
    arguments.format.print(&timing, describe)?;
    if timing.passed {
        return Ok(());
    }
    Err(CliError::Check(format!(
        "timing: {} of {} cycles took longer than {} µs, expected at most 1 in 1000",
        timing.misses, timing.cycles, arguments.budget_us
    )))
}

fn defect(error: impl Display) -> CliError {
    CliError::Check(format!("timing: {error}"))
}

/// The figures for people.
#[derive(Template)]
#[template(path = "cli/timing.txt")]
struct Text<'a> {
    timing: &'a Timing,
}

fn describe(timing: &Timing) -> String {
    // Writing to a String does not fail.
    Text { timing }.render().unwrap_or_default()
}
