//! `palpate timing`: the budget of the servo loop on this machine (`spec/command-line.md`).

use std::path::PathBuf;
use std::time::Duration;

use askama::Template;
use clap::{Args, ValueEnum};

use super::output::{self, print};
use super::playback::{limits, loaded_map};
use super::{CliError, Format};
use palpate::file;
use palpate::hid::simulated::PAPER;
use palpate::hid::timing::{Budget, BudgetOutcome, Judged, Timing, judge_log, measure, paper};

/// Arguments of `palpate timing`.
#[derive(Debug, Args)]
pub struct TimingArguments {
    /// Time budget of a cycle, in µs
    #[arg(long, value_name = "T", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    budget_us: u64,
    /// Percentile of the response times that must be within the budget
    #[arg(long, value_name = "P", default_value_t = 99.9)]
    percentile: f64,
    /// Confidence level of the verdict, in percent
    #[arg(long, value_name = "C", default_value_t = 95.0)]
    confidence_percent: f64,
    /// Number of cycles that may exceed the budget [default: as many as the percentile allows]
    #[arg(long, value_name = "N")]
    allowed_misses: Option<u64>,
    /// Number of consecutive cycles that may exceed the budget [default: any number]
    #[arg(long, value_name = "N")]
    allowed_run: Option<u64>,
    /// Judges the log of another loop, CSV or JSON lines, instead of measuring
    #[arg(long, value_name = "FILE", conflicts_with_all = ["cycles", "paced", "map"])]
    from: Option<PathBuf>,
    /// Number of cycles to measure
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1000..=100_000_000))]
    cycles: u64,
    /// Runs the cycles at 1 kHz, so that the wake-up latency of the system counts too
    #[arg(long)]
    paced: bool,
    /// Force map to render [default: a table of 9 × 41 poses]
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Printed::Table)]
    format: Printed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Printed {
    /// For people.
    Table,
    /// For programs; keys carry the unit.
    Json,
    /// For spreadsheets: a line for each value, with its key.
    Csv,
    /// For CI: JUnit XML.
    Junit,
}

/// Runs the command.
///
/// Implements: CLI-060, CLI-003, CLI-017.
pub fn timing(arguments: &TimingArguments) -> Result<(), CliError> {
    let cycle = Duration::from_micros(arguments.budget_us);
    let mut budget = Budget::new(cycle, arguments.percentile, arguments.confidence_percent)?;
    budget.allowed_misses = arguments.allowed_misses;
    budget.allowed_run = arguments.allowed_run;
    match &arguments.from {
        Some(path) => {
            let judged = file::read(path, |text, file| {
                judge_log(text, budget).map_err(|refusal| refusal.in_file(file))
            })?;
            let source = format!("of {}", path.display());
            tell(arguments, &judged, None, &source)
        }
        None => {
            let timing = measured(arguments, budget)?;
            let source = if timing.paced {
                "on the simulated device, at 1 kHz, with the system's wake-up latency"
            } else {
                "on the simulated device, back to back"
            };
            tell(arguments, &timing.judged, Some(&timing), source)
        }
    }
}

/// The times of this machine.
fn measured(arguments: &TimingArguments, budget: Budget) -> Result<Timing, CliError> {
    let loaded = match &arguments.map {
        Some(path) => loaded_map(path)?,
        None => paper::table()?,
    };
    let table = loaded.table();
    let limits = limits(4.0, &PAPER)?;
    let cycles = arguments.cycles;
    let device = paper::device(cycles);
    let period = arguments.paced.then(|| PAPER.period());
    if let Some(period) = period {
        let seconds = cycles as f64 * period.as_secs_f64();
        output::tell(&format!("measuring {cycles} cycles takes {seconds:.0} s"));
    }
    Ok(measure(device, table, limits, cycles, budget, period)?)
}

/// Prints the times and the verdict, which sets the exit code. `timing` holds the rest of what was measured if it was measured here.
fn tell(
    arguments: &TimingArguments,
    judged: &Judged,
    timing: Option<&Timing>,
    source: &str,
) -> Result<(), CliError> {
    let reason = reason(arguments, judged);
    let (outcome, failure) = match judged.outcome {
        BudgetOutcome::Kept => ("kept", None),
        BudgetOutcome::Broken => ("broken", Some(CliError::Check(reason))),
        BudgetOutcome::Undecided => ("undecided", Some(CliError::Usage(reason))),
    };
    let text = Text {
        judged,
        timing,
        source,
        outcome,
    };
    // Writing to a String does not fail.
    let text = text.render().unwrap_or_default();
    match (arguments.format, timing) {
        (Printed::Table, _) => print(&text),
        (Printed::Json, timing) => print_values(Format::Json, judged, timing),
        (Printed::Csv, timing) => print_values(Format::Csv, judged, timing),
        (Printed::Junit, _) => {
            let reason = failure.as_ref().map(CliError::to_string);
            let junit = Junit {
                judged,
                outcome,
                reason,
                text: &text,
            };
            print(&junit.render().unwrap_or_default())
        }
    }?;
    failure.map_or(Ok(()), Err)
}

/// Prints all that was measured here, or else what was judged, for programs.
fn print_values(format: Format, judged: &Judged, timing: Option<&Timing>) -> Result<(), CliError> {
    match timing {
        Some(timing) => format.print(timing, String::new),
        None => format.print(judged, String::new),
    }
}

/// Why a budget is not kept.
fn reason(arguments: &TimingArguments, judged: &Judged) -> String {
    let (cycles, misses, run) = (judged.cycles, judged.misses, judged.longest_run);
    let (percentile, budget) = (judged.percentile, judged.budget_us);
    if judged.outcome == BudgetOutcome::Undecided {
        return format!(
            "timing: {cycles} cycles are too few to decide whether p{percentile} ≤ {budget} µs ({misses} were slower); measure more"
        );
    }
    let slower = format!("timing: {misses} of {cycles} cycles were slower than {budget} µs");
    match (arguments.allowed_misses, arguments.allowed_run) {
        (Some(most), _) if misses > most => format!("{slower}; at most {most} are allowed"),
        (_, Some(most)) if run > most => {
            format!("{slower}, {run} of them in a row; at most {most} are allowed")
        }
        _ => {
            let least = judged.at_least_us.unwrap_or_default();
            format!("{slower}: p{percentile} is at least {least} µs; the budget is {budget} µs")
        }
    }
}

/// The figures for people.
#[derive(Template)]
#[template(path = "cli.txt", block = "timing")]
struct Text<'a> {
    judged: &'a Judged,
    timing: Option<&'a Timing>,
    source: &'a str,
    outcome: &'a str,
}

/// The verdict for CI.
#[derive(Template)]
#[template(path = "cli.txt", block = "junit", escape = "xml")]
struct Junit<'a> {
    judged: &'a Judged,
    outcome: &'a str,
    reason: Option<String>,
    text: &'a str,
}
