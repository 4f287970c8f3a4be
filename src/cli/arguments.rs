//! What a command line may say.

use std::ffi::OsString;

use clap::{Parser, Subcommand, ValueEnum};
use serde::Serialize;

use super::error::CliError;
use super::output::print;
use super::{
    bank, demo, detect, devices, experiment, import, oracle, play, psychophysics, reach, run,
    solve, study, timing,
};

/// The version, and which build this is.
const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit ",
    env!("PALPATE_BUILD_COMMIT"),
    "\n",
    env!("PALPATE_BUILD_COMPILER"),
    " for ",
    env!("PALPATE_BUILD_TARGET")
);

/// Inclusion probing after Yan, Scott and Fearing (1999): forces on a probe, detection of an inclusion.
#[derive(Debug, Parser)]
#[command(version, long_version = LONG_VERSION, about, disable_help_subcommand = true)]
pub struct CommandLine {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// The whole paper: force maps of the phantoms, signals, detection, report.
    Run(run::RunArguments),
    /// Files to try the other commands on: maps, recorded sweeps, a measured map, a configuration.
    Demo(demo::DemoArguments),
    /// Forces on the probe over depths and lateral positions of one phantom.
    Solve(solve::SolveArguments),
    /// A measured force map in CSV, checked and written as JSON.
    ImportMap(import::ImportArguments),
    /// The forces for every inclusion that may be there: a bank, for 'palpate detect' and 'palpate reach'.
    Bank(bank::BankArguments),
    /// A recorded sweep against two force maps or a bank: is there an inclusion, and where.
    Detect(detect::DetectArguments),
    /// How deep an inclusion of a bank may lie, and how small it may be, to be found.
    Reach(reach::ReachArguments),
    /// What uncertain inputs do to every number: samples, on one machine or many, and their analysis.
    Study(study::StudyArguments),
    /// A force map to a hand, through a haptic device or a simulated one.
    Play(play::PlayArguments),
    /// The HID devices of this machine, and which of them can play a force map.
    Devices(devices::DevicesArguments),
    /// The paper's experiment: pairs of samples, of which a subject says where the inclusion is.
    Experiment(experiment::ExperimentArguments),
    /// Right answers of subjects: shares, differences, noise, and what of the force they used.
    Psychophysics(psychophysics::PsychophysicsArguments),
    /// The time budget of the servo loop, on the simulated device.
    Timing(timing::TimingArguments),
    /// Answers questions in lines of JSON, for other implementations to compare with.
    Oracle(oracle::OracleArguments),
}

/// How an answer is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Table,
    /// For programs; each key ends with its unit.
    Json,
}

impl Format {
    /// Prints an answer.
    pub(super) fn print<A: Serialize>(
        self,
        answer: &A,
        table: impl FnOnce(&A) -> String,
    ) -> Result<(), CliError> {
        print(&match self {
            Format::Table => table(answer),
            // Keys are strings, and nothing else could fail.
            Format::Json => serde_json::to_string_pretty(answer).unwrap_or_default() + "\n",
        })
    }
}

/// Reads a command line, the first entry of which is the program's name; runs nothing. A text to print, help or the version, may
/// take the place of arguments.
///
/// # Errors
/// [`CliError::Usage`].
///
/// Implements: CLI-001, CLI-002.
pub fn read<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<Result<A, String>, CliError> {
    match A::try_parse_from(arguments) {
        Ok(arguments) => Ok(Ok(arguments)),
        Err(error) if !error.use_stderr() => Ok(Err(error.to_string())),
        Err(error) => Err(CliError::usage(&error)),
    }
}
