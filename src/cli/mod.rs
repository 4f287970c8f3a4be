//! The command line (`spec/command-line.md`).

pub(crate) mod config;
mod conform;
mod detect;
mod detection;
mod devices;
mod error;
mod experiment;
mod import;
pub(crate) mod lists;
mod oracle;
mod output;
mod play;
mod playback;
mod progress;
mod psychophysics;
mod psychophysics_text;
mod run;
mod solve;
mod timing;
mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

use error::CliError;

use crate::fem::{Contact, Element};

/// Inclusion probing after Yan, Scott and Fearing (1999): forces on a probe, detection of an inclusion.
#[derive(Debug, Parser)]
#[command(version, about, disable_help_subcommand = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The whole paper: force maps of the phantoms, signals, detection, report.
    Run(run::RunArguments),
    /// Forces on the probe over depths and lateral positions of one phantom.
    Solve(solve::SolveArguments),
    /// A measured force map in CSV, checked and written as JSON.
    ImportMap(import::ImportArguments),
    /// A recorded sweep against two force maps: is there an inclusion, and where.
    Detect(detect::DetectArguments),
    /// The statistics battery of the detector, once or with fresh seeds.
    Verify(verify::VerifyArguments),
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
    /// Asks another program the questions of the vectors, and says what it gets wrong.
    Conform(conform::ConformArguments),
}

/// How an answer is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Table,
    /// For programs, in SI.
    Json,
}

/// How the gap to the probe is measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactName {
    /// Distance of the deformed surface from the circle; force along its normal.
    #[default]
    DeformedNormal,
    /// Height of the circle over the undeformed point; vertical force on the gel.
    VerticalGap,
}

impl From<ContactName> for Contact {
    fn from(name: ContactName) -> Contact {
        match name {
            ContactName::DeformedNormal => Contact::DeformedNormal,
            ContactName::VerticalGap => Contact::VerticalGap,
        }
    }
}

/// The shape of the elements.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ElementName {
    /// Triangles with 6 nodes.
    #[default]
    T6,
    /// Fully integrated quadrilaterals with 4 nodes, which lock: forces come out some per cent high.
    Q4Full,
}

impl From<ElementName> for Element {
    fn from(name: ElementName) -> Element {
        match name {
            ElementName::T6 => Element::T6,
            ElementName::Q4Full => Element::Q4Full,
        }
    }
}

/// What a command line asks for.
#[derive(Debug)]
pub enum Asked {
    /// To run a command.
    Command(Box<Arguments>),
    /// To print a text: help, or the version.
    Text(String),
}

impl Asked {
    /// Reads a command line, the first entry of which is the program's name; runs nothing.
    ///
    /// # Errors
    /// [`CliError::Usage`].
    ///
    /// Implements: CLI-001, CLI-002.
    pub fn read(arguments: impl IntoIterator<Item = OsString>) -> Result<Asked, CliError> {
        match Arguments::try_parse_from(arguments) {
            Ok(arguments) => Ok(Asked::Command(Box::new(arguments))),
            Err(error) if !error.use_stderr() => Ok(Asked::Text(error.to_string())),
            Err(error) => Err(CliError::usage(&error)),
        }
    }
}

/// Runs the program with the given arguments, the first of which is its name.
///
/// ```
/// use std::ffi::OsString;
/// use std::process::ExitCode;
///
/// // Prints the version.
/// let code = palpate::cli::main(["palpate", "--version"].map(OsString::from));
/// assert_eq!(code, ExitCode::SUCCESS);
/// // Says on the standard error what would be right.
/// let code = palpate::cli::main(["palpate", "--deth"].map(OsString::from));
/// assert_ne!(code, ExitCode::SUCCESS);
/// ```
///
/// Implements: CLI-001, CLI-002, CLI-003.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let result = match Asked::read(arguments) {
        Ok(Asked::Command(arguments)) => match arguments.command {
            Command::Run(arguments) => run::run(&arguments),
            Command::Solve(arguments) => solve::solve(&arguments),
            Command::ImportMap(arguments) => import::import(&arguments),
            Command::Detect(arguments) => detect::detect(&arguments),
            Command::Verify(arguments) => verify::verify(&arguments),
            Command::Play(arguments) => play::play(&arguments),
            Command::Devices(arguments) => devices::devices(&arguments),
            Command::Experiment(arguments) => experiment::experiment(&arguments),
            Command::Psychophysics(arguments) => psychophysics::psychophysics(&arguments),
            Command::Timing(arguments) => timing::timing(&arguments),
            Command::Oracle(arguments) => oracle::oracle(&arguments),
            Command::Conform(arguments) => conform::conform(&arguments),
        },
        Ok(Asked::Text(text)) => output::print(&text),
        Err(error) => Err(error),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("palpate: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
