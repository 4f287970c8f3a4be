//! `palpate-conform`: another program against the vectors (`spec/oracle.md`).

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, ValueEnum};

use palpate::cli::output::print;
use palpate::cli::progress::bar;
use palpate::cli::{CliError, program};
use palpate_conform::{ConformError, Settings, Suite, junit, run, table};

/// Asks another program the questions of the vectors, and says what it gets wrong.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Arguments {
    /// A folder of vectors instead of those in this program
    #[arg(long, value_name = "DIR")]
    vectors: Option<PathBuf>,
    /// Asks the cases of this group alone; may be given several times
    #[arg(long, value_name = "GROUP")]
    only: Vec<String>,
    /// How the verdict is printed
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// How long the program may take for one answer, in seconds
    #[arg(long, value_name = "T", value_parser = seconds, default_value = "10")]
    timeout_s: Duration,
    /// The program that answers lines of JSON on its standard output, with its arguments
    #[arg(last = true, required = true, value_name = "CMD ARGS")]
    command: Vec<OsString>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Table,
    /// For programs.
    Json,
    /// For CI: JUnit's XML.
    Junit,
}

fn seconds(text: &str) -> Result<Duration, String> {
    text.parse()
        .ok()
        .filter(|seconds| (0.01..=86_400.0).contains(seconds))
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("{text:?}: expected seconds from 0.01 to 86400, such as 10"))
}

fn main() -> ExitCode {
    program(std::env::args_os(), |arguments: Arguments| {
        conform(&arguments)
    })
}

/// Asks, and prints the verdict.
///
/// Implements: ORA-040, ORA-048, ORA-049, ORA-050, ORA-051.
fn conform(arguments: &Arguments) -> Result<(), CliError> {
    let suite = match &arguments.vectors {
        Some(folder) => Suite::read(folder),
        None => Suite::embedded(),
    };
    let suite = suite.map_err(|error| CliError::Usage(error.to_string()))?;
    let settings = Settings {
        command: arguments.command.clone(),
        only: arguments.only.clone(),
        timeout: arguments.timeout_s,
    };
    let bar = bar(suite.only(&settings.only).cases(), "cases");
    let verdict = run(&suite, &settings, || bar.inc(1)).map_err(|error| match error {
        ConformError::Capabilities { .. } => CliError::Check(error.to_string()),
        _ => CliError::Usage(error.to_string()),
    })?;
    bar.finish_and_clear();
    print(&match arguments.format {
        Format::Table => table(&verdict),
        // A verdict holds nothing that JSON has not.
        Format::Json => serde_json::to_string_pretty(&verdict).unwrap_or_default() + "\n",
        Format::Junit => junit(&verdict, &suite),
    })?;
    match verdict.failure() {
        Some(failure) => Err(CliError::Check(failure)),
        None => Ok(()),
    }
}
