//! `palpate watch`: a sweep against a bank while it is taken (`spec/sequential.md`).

use std::io::{Write, stdout};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::detect::arguments::{Known, NoiseSd};
use super::error::refuse;
use super::input::{lines, next};
use super::layout::LayoutArguments;
use super::numbers::probability;
use super::output::{self, Envelope, printed, svg_file};
use super::platform::stop_on_signals;
use palpate::bank::{Bank, WatchAnswer, WatchQuestion, Watcher};
use palpate::chart::coverage_figure;
use palpate::detect::sequential::Wald;
use palpate::detect::{Decision, required_gamma};
use palpate::trace::{LiveSamples, Unknown, reasons, refused};

/// Arguments of `palpate watch`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  palpate watch --bank bank.json --noise-sd-n 0.1 < sweep.csv | tail -1\n\
    Samples come on standard input, a line each: CSV with the header position_mm,lateral_force_n,normal_force_n, and depth_mm if\n\
    the depth varies, or JSON objects with these keys. Answers are lines of JSON. Exit code 0: answered; 3: undecided when the input ended."
)]
pub struct WatchArguments {
    /// Bank of inclusions from 'palpate bank'
    #[arg(long, value_name = "BANK")]
    bank: PathBuf,
    #[command(flatten)]
    noise_sd: NoiseSd,
    /// Quantities to take as known instead of fitting: a list of offset, drift, gain and depth, or 'all' or 'none'
    #[arg(long, value_name = "LIST", value_parser = Known::parse, default_value = "depth")]
    known: Known,
    /// The sensor was set to zero on the gel, so that the forces say nothing of contact
    #[arg(long)]
    zeroed: bool,
    /// Probability of each inclusion of the bank, given that there is one: a CSV file as for 'palpate detect' [default: all equal]
    #[arg(long, value_name = "FILE")]
    prior: Option<PathBuf>,
    /// Prior probability of an inclusion
    #[arg(long, value_name = "P", value_parser = probability, allow_hyphen_values = true, default_value = "0.5")]
    prior_h1: f64,
    /// Highest rate of false answers "inclusion", however often you look
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true, default_value = "0.01")]
    max_false_alarm: f64,
    /// Rate of false answers "no inclusion", for an inclusion at any place of the bank
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true, default_value = "0.05")]
    max_miss: f64,
    /// Least time between two answers in ms; a new decision and the last answer are always written
    #[arg(long, value_name = "N", default_value_t = 0)]
    every_ms: u64,
    /// Writes a figure as SVG when the sweep is over: which inclusions of the bank are open, excluded or not covered
    #[arg(long, value_name = "FILE.svg", value_parser = svg_file())]
    figure: Option<PathBuf>,
    #[command(flatten)]
    layout: LayoutArguments,
}

/// A line of the output.
#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    answer: &'a WatchAnswer,
    is_last: bool,
    /// γ² that a test of one place with these rates needs: of fixed length, and in the mean without and with an inclusion.
    #[serde(skip_serializing_if = "Option::is_none")]
    fixed_length_gamma_squared: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_gamma_squared: Option<[f64; 2]>,
}

/// Runs the command.
///
/// Implements: CLI-183, CLI-184, CLI-233.
pub fn watch(arguments: &WatchArguments) -> Result<(), CliError> {
    let bank = Bank::read(&arguments.bank)?;
    let question = question(arguments, &bank)?;
    let mut watcher = Watcher::new(&bank, &question)?;
    let mut samples = LiveSamples::new("-", arguments.layout.get()?);
    let (mut answer, mut written) = (None, None::<(Instant, Option<Decision>)>);
    let mut is_read = true;
    let (stop, lines) = (stop_on_signals()?, lines());
    while let Some(line) = next(&lines, &stop) {
        let line = line.map_err(CliError::refused("-: cannot be read"))?;
        let sample = samples.sample(&line)?;
        (samples.notes.drain(..)).for_each(|text| output::note("-", &text));
        let Some(sample) = sample else {
            continue;
        };
        let pushed = watcher.push(sample.position, sample.depth, sample.lateral, sample.normal);
        let found = pushed.and_then(|()| watcher.answer());
        let found = found.map_err(|error| samples.refused(refused(error)))?;
        let decision = found.decision;
        let is_due = written.is_none_or(|(at, before)| {
            at.elapsed() >= Duration::from_millis(arguments.every_ms) || before != decision
        });
        if is_due {
            written = Some((Instant::now(), decision));
            is_read = write(&found, None)?;
        }
        answer = Some(found);
        if !is_read {
            break;
        }
    }
    let Some(answer) = answer else {
        refuse!(
            "-: standard input has no samples; give a header and at least one row, or JSON objects"
        );
    };
    // Without a reader, the figure of what came so far is still asked for.
    let is_read = is_read && write(&answer, Some(&question.test))?;
    if let Some(path) = &arguments.figure {
        output::write(path, &coverage_figure(&watcher.places())?)?;
    }
    match is_read && answer.decision.is_none() {
        true => Err(CliError::Unjudged(why_undecided(&answer))),
        false => Ok(()),
    }
}

/// What is known of the sweep, and what is asked.
fn question(arguments: &WatchArguments, bank: &Bank) -> Result<WatchQuestion, CliError> {
    let prior = arguments.prior.as_ref();
    let Some(noise_sd) = arguments.noise_sd.get() else {
        refuse!(
            "the noise cannot be estimated while a sweep is taken; give --noise-sd-n, or one for each force"
        );
    };
    let unknown = arguments.known.unknown.iter().copied();
    Ok(WatchQuestion {
        unknown: unknown.filter(|of| *of != Unknown::Variance).collect(),
        noise_sd,
        is_zeroed: arguments.zeroed,
        prior_h1: arguments.prior_h1,
        prior: prior.map(|file| bank.read_prior(file)).transpose()?,
        test: Wald::new(arguments.max_false_alarm, arguments.max_miss).map_err(refused)?,
    })
}

/// Implements: CLI-184.
fn why_undecided(answer: &WatchAnswer) -> String {
    let WatchAnswer {
        causes,
        places,
        covered,
        excluded,
        ..
    } = answer;
    if causes.is_empty() {
        let [open, uncovered] = [places - excluded, places - covered];
        return format!(
            "-: undecided: an inclusion is not excluded at {open} of {places} places; the path has not covered {uncovered} of them"
        );
    }
    format!("-: cannot be judged: {}", reasons(causes))
}

/// Writes an answer, the last one with what `test` needs; whether somebody still reads.
///
/// Implements: CLI-183, CLI-184.
fn write(answer: &WatchAnswer, test: Option<&Wald>) -> Result<bool, CliError> {
    let needed = test.map(|test| {
        let gamma = required_gamma(test.rates().false_alarm, test.rates().miss);
        gamma.map(|gamma| gamma * gamma).map_err(refused)
    });
    let truths = [Decision::NoInclusion, Decision::Inclusion];
    let line = Line {
        answer,
        is_last: test.is_some(),
        fixed_length_gamma_squared: needed.transpose()?,
        mean_gamma_squared: test.map(|test| truths.map(|truth| test.mean_gamma_squared(truth))),
    };
    // Keys are strings, and nothing else could fail.
    let line = serde_json::to_string(&Envelope::new("palpate-watch", 1, line)).unwrap_or_default();
    let mut out = stdout().lock();
    let written = writeln!(out, "{line}").and_then(|()| out.flush());
    let is_read = written.is_ok();
    printed(written).map(|()| is_read)
}
