//! The command line.

use std::ffi::OsString;

use clap::{Parser, Subcommand};

use palpate::version::LONG_VERSION;

use super::error::CliError;
use super::{
    bank, calibrate, demo, detect, devices, experiment, import, oracle, play, psychophysics, reach,
    run, solve, study, timing, watch,
};

/// Inclusion probing after Yan, Scott and Fearing (1999): contact forces by finite elements, detection of an inclusion, haptic playback
#[derive(Debug, Parser)]
#[command(name = "palpate", bin_name = "palpate", version, long_version = LONG_VERSION, disable_help_subcommand = true)]
pub struct CommandLine {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Reproduces the paper: force maps of its phantoms, signals, detection, and a report
    Run(run::RunArguments),
    /// Writes example files for the other commands: force maps, recorded sweeps, a measured map, a configuration
    Demo(demo::DemoArguments),
    /// Computes the force map of a phantom: the forces on the probe over depth and lateral position
    Solve(solve::SolveArguments),
    /// Checks a measured force map in CSV and converts it to JSON
    ImportMap(import::ImportArguments),
    /// Fits recorded indentations of a gel: where the probe touched it, its moduli, how it relaxes
    Calibrate(calibrate::CalibrateArguments),
    /// Computes a bank of force maps, one for each candidate inclusion, for 'palpate detect' and 'palpate reach'
    Bank(bank::BankArguments),
    /// Decides whether a recorded sweep shows an inclusion, using two force maps or a bank; a bank also locates it
    Detect(Box<detect::DetectArguments>),
    /// Judges a sweep against a bank while it is taken: samples in, answers out, until the error rates allow a decision
    Watch(watch::WatchArguments),
    /// Computes the greatest depth and the smallest size that can still be detected
    Reach(reach::ReachArguments),
    /// Propagates input uncertainty to every result, on one machine or a cluster
    Study(study::StudyArguments),
    /// Renders a force map on a real or simulated haptic device
    Play(play::PlayArguments),
    /// Lists the HID devices of this machine and whether they can render a force map
    Devices(devices::DevicesArguments),
    /// Runs the paper's two-alternative forced-choice experiment: which of two samples has the inclusion?
    Experiment(experiment::ExperimentArguments),
    /// Analyses the answers of such an experiment: proportions correct, differences, noise, and which force explains them
    Psychophysics(psychophysics::PsychophysicsArguments),
    /// Measures the servo loop on the simulated device against a time budget
    Timing(timing::TimingArguments),
    /// Answers questions in JSON lines, to check other implementations
    Oracle(oracle::OracleArguments),
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
