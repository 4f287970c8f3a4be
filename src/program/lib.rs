//! The program `palpate` (`spec/command-line.md`).
//!
//! Read `arguments.rs` first, which lists the commands, then `output.rs` (formats of answers, files) and `error.rs` (messages, exit codes).
//! Each command has a file or a folder of its name, in all 5,500 lines of code.
//!
//! Only the project's own programs and tests use this crate as a library.

pub mod arguments;
mod bank;
mod calibrate;
mod comparison;
pub mod config;
mod deformed;
mod demo;
mod detect;
mod devices;
mod error;
mod experiment;
mod import;
mod input;
mod layout;
mod manual;
pub mod numbers;
mod oracle;
pub mod output;
mod path;
mod platform;
mod play;
mod playback;
pub mod progress;
mod psychophysics;
mod reach;
mod run;
mod simulate;
mod solve;
mod study;
mod theories;
mod timing;
mod watch;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use arguments::{Command, CommandLine};
pub use error::CliError;
use output::Format;

/// Runs the program with the given arguments, the first of which is its name.
///
/// ```
/// use std::ffi::OsString;
/// use std::process::ExitCode;
///
/// // Prints the version.
/// let code = palpate_program::main(["palpate", "--version"].map(OsString::from));
/// assert_eq!(code, ExitCode::SUCCESS);
/// // Says on standard error what is wrong.
/// let code = palpate_program::main(["palpate", "--deth"].map(OsString::from));
/// assert_ne!(code, ExitCode::SUCCESS);
/// ```
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    platform::keep_memory();
    let given: Vec<OsString> = arguments.into_iter().collect();
    program(given.clone(), |arguments: CommandLine| {
        arguments::check_outputs(&given)?;
        output::be_quiet(arguments.quiet);
        match arguments.command {
            Command::Run(arguments) => run::run(&arguments),
            Command::Demo(arguments) => demo::demo(&arguments),
            Command::Solve(arguments) => solve::solve(&arguments),
            Command::ImportMap(arguments) => import::import(&arguments),
            Command::Calibrate(arguments) => calibrate::calibrate(&arguments),
            Command::Bank(arguments) => bank::bank(&arguments),
            Command::Detect(arguments) => detect::detect(&arguments),
            Command::Simulate(arguments) => simulate::simulate(&arguments),
            Command::Watch(arguments) => watch::watch(&arguments),
            Command::Reach(arguments) => reach::reach(&arguments),
            Command::Study(arguments) => study::study(&arguments),
            Command::Play(arguments) => play::play(&arguments),
            Command::Devices(arguments) => devices::devices(&arguments),
            Command::Experiment(arguments) => experiment::experiment(&arguments),
            Command::Psychophysics(arguments) => psychophysics::psychophysics(&arguments),
            Command::Timing(arguments) => timing::timing(&arguments),
            Command::Oracle(arguments) => oracle::oracle(&arguments),
            Command::Completions(arguments) => manual::completions(&arguments),
            Command::Man(arguments) => manual::man(&arguments),
        }
    })
}

/// The commands and arguments of `palpate`, for completions and manual pages.
fn command() -> clap::Command {
    <CommandLine as clap::CommandFactory>::command()
}

/// Runs a program that takes arguments `A`: prints help or version, reports a failure in one line on standard error, and returns the exit
/// code. The companions of `palpate` use it too.
///
/// Implements: CLI-001, CLI-002, CLI-003.
pub fn program<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    act: impl FnOnce(A) -> Result<(), CliError>,
) -> ExitCode {
    let result = arguments::read(arguments).and_then(|asked| match asked {
        Ok(arguments) => act(arguments),
        Err(text) => output::print(&text),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::say(format_args!("{}: {error}\n", A::command().get_name()));
            ExitCode::from(error.exit_code())
        }
    }
}
