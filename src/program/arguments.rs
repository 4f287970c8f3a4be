//! What a command line may say.

use std::ffi::OsString;

use clap::{Parser, Subcommand, ValueEnum};
use serde::Serialize;

use palpate::version::LONG_VERSION;

use super::error::CliError;
use super::output::print;
use super::{
    bank, demo, detect, devices, experiment, import, oracle, play, psychophysics, reach, run,
    solve, study, timing,
};

/// Inclusion probing after Yan, Scott and Fearing (1999): forces on a probe, detection of an inclusion.
#[derive(Debug, Parser)]
#[command(name = "palpate", bin_name = "palpate", version, long_version = LONG_VERSION, about, disable_help_subcommand = true)]
pub struct CommandLine {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Computes the whole paper: force maps of the phantoms, signals, detection and a report.
    Run(run::RunArguments),
    /// Writes example files for the other commands: maps, recorded sweeps, a measured map, a configuration.
    Demo(demo::DemoArguments),
    /// Computes the forces on the probe over depths and lateral positions of one phantom.
    Solve(solve::SolveArguments),
    /// Checks a measured force map in CSV and writes it as JSON.
    ImportMap(import::ImportArguments),
    /// Computes a bank: the forces for every inclusion that may be there, for 'palpate detect' and 'palpate reach'.
    Bank(bank::BankArguments),
    /// Decides whether a recorded sweep shows an inclusion, and where, by two force maps or a bank.
    Detect(detect::DetectArguments),
    /// Computes how deep and how small an inclusion of a bank may be and still be found.
    Reach(reach::ReachArguments),
    /// Carries uncertain inputs through to every number: samples, on one machine or many, and their analysis.
    Study(study::StudyArguments),
    /// Plays a force map to a hand, through a haptic device or a simulated one.
    Play(play::PlayArguments),
    /// Lists the HID devices of this machine, and which of them can play a force map.
    Devices(devices::DevicesArguments),
    /// Runs the paper's experiment: a subject feels pairs of samples and says which has the inclusion.
    Experiment(experiment::ExperimentArguments),
    /// Analyses the right answers of subjects: shares, differences, noise, and which part of the force they used.
    Psychophysics(psychophysics::PsychophysicsArguments),
    /// Measures the servo loop on the simulated device against its time budget.
    Timing(timing::TimingArguments),
    /// Answers questions in lines of JSON, so that other implementations can be compared.
    Oracle(oracle::OracleArguments),
}

/// How an answer is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people.
    Table,
    /// For programs; keys carry the unit.
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
