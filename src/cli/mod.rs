//! The command line (`spec/command-line.md`).

pub(crate) mod arguments;
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

use arguments::{Asked, Command, ContactName, Format};
use error::CliError;

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
