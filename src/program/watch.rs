//! `palpate watch`: a sweep against a bank while it is taken (`spec/sequential.md`).

use std::io::{BufRead, Read, Write, stdin, stdout};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::detect::arguments::{Known, NoiseSd};
use super::error::refuse;
use super::layout::LayoutArguments;
use super::numbers::probability;
use super::output::{Envelope, printed};
use super::play::stop_on_signals;
use palpate::bank::{Bank, WatchAnswer, WatchQuestion, Watcher};
use palpate::detect::sequential::Wald;
use palpate::detect::{Decision, required_gamma};
use palpate::trace::{LiveSamples, Unknown, reasons, refused};

/// The longest line, bytes.
const LONGEST_LINE: u64 = 1 << 16;
/// Lines that wait at most: beyond, the writer waits.
const WAITING: usize = 1024;
/// How long a signal waits at most.
const LOOK: Duration = Duration::from_millis(20);

/// Arguments of `palpate watch`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: palpate watch --bank bank.json --noise-sd-n 0.1 < sweep.csv | tail -1\n\
    Samples come on standard input, a line each: CSV with the header position_mm,lateral_force_n,normal_force_n, or JSON objects with\n\
    these keys. Answers are lines of JSON. Exit code 0: answered; 3: undecided when the input ended."
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
    /// Rate of false answers "inclusion", however often you look
    #[arg(long, value_name = "A", value_parser = probability, allow_hyphen_values = true, default_value = "0.01")]
    max_false_alarm: f64,
    /// Rate of false answers "no inclusion", for an inclusion at any place of the bank
    #[arg(long, value_name = "B", value_parser = probability, allow_hyphen_values = true, default_value = "0.05")]
    max_miss: f64,
    /// Least time between two answers in ms; a new decision and the last answer are always written
    #[arg(long, value_name = "N", default_value_t = 0)]
    every_ms: u64,
    #[command(flatten)]
    layout: LayoutArguments,
}

/// A line of the output.
#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    answer: &'a WatchAnswer,
    is_last: bool,
    /// With the last line.
    #[serde(flatten)]
    needed: Option<Needed>,
}

/// How much signal a test of one place with these rates needs.
#[derive(Serialize)]
struct Needed {
    /// By a test of fixed length, γ².
    fixed_length_gamma_squared: f64,
    /// By the sequential test in the mean, γ², without an inclusion and with it.
    mean_gamma_squared: [f64; 2],
}

/// Runs the command.
///
/// Implements: CLI-180, CLI-181.
pub fn watch(arguments: &WatchArguments) -> Result<(), CliError> {
    let bank = Bank::read(&arguments.bank)?;
    let prior = arguments.prior.as_ref();
    let prior = prior.map(|file| bank.read_prior(file)).transpose()?;
    let Some(noise_sd) = arguments.noise_sd.get() else {
        refuse!(
            "the noise cannot be estimated while a sweep is taken; give --noise-sd-n, or one for each force"
        );
    };
    let test = Wald::new(arguments.max_false_alarm, arguments.max_miss).map_err(refused)?;
    let unknown = arguments.known.unknown.iter().copied();
    let unknown: Vec<_> = unknown.filter(|of| *of != Unknown::Variance).collect();
    let question = WatchQuestion {
        unknown: &unknown,
        noise_sd,
        has_lateral: false,
        is_zeroed: arguments.zeroed,
        prior_h1: arguments.prior_h1,
        prior: prior.as_deref(),
        test,
    };
    // What is wrong with the question is told before the first sample.
    Watcher::new(&bank, &question)?;
    let (mut samples, mut watcher) = (LiveSamples::new("-", arguments.layout.get()?), None);
    let mut out = Answers {
        every: Duration::from_millis(arguments.every_ms),
        last: None,
    };
    let (stop, lines) = (stop_on_signals()?, lines());
    while let Some(line) = next(&lines, &stop) {
        let Some((position, forces)) = samples.sample(&line?)? else {
            continue;
        };
        let watcher = match &mut watcher {
            Some(watcher) => watcher,
            none => {
                let has_lateral = samples.has_lateral();
                none.insert(Watcher::new(
                    &bank,
                    &WatchQuestion {
                        has_lateral,
                        ..question
                    },
                )?)
            }
        };
        let pushed = watcher
            .push(position, forces)
            .and_then(|()| watcher.answer());
        let answer = pushed.map_err(|error| samples.refused(refused(error)))?;
        if out.is_due(&answer) && !out.write(&answer, None)? {
            return Ok(());
        }
    }
    let Some(watcher) = watcher else {
        refuse!(
            "-: standard input has no samples; give a header and at least one row, or JSON objects"
        );
    };
    let answer = watcher.answer().map_err(refused)?;
    if !out.write(&answer, Some(needed(&test)?))? || answer.decision.is_some() {
        return Ok(());
    }
    Err(CliError::Unjudged(why_undecided(&answer)))
}

fn needed(test: &Wald) -> Result<Needed, CliError> {
    let rates = test.rates();
    let gamma = required_gamma(rates.false_alarm, rates.miss).map_err(refused)?;
    let truths = [Decision::NoInclusion, Decision::Inclusion];
    Ok(Needed {
        fixed_length_gamma_squared: gamma * gamma,
        mean_gamma_squared: truths.map(|truth| test.mean_gamma_squared(truth)),
    })
}

/// Implements: CLI-181.
fn why_undecided(answer: &WatchAnswer) -> String {
    if answer.causes.is_empty() {
        let (open, places) = (answer.places - answer.excluded, answer.places);
        let uncovered = places - answer.covered;
        return format!(
            "-: undecided: an inclusion is open at {open} of {places} places, of which the path has not covered {uncovered}"
        );
    }
    format!("-: cannot be judged: {}", reasons(&answer.causes))
}

/// The lines of standard input, which another thread reads, so that a signal need not wait for the next one.
fn lines() -> Receiver<Result<String, CliError>> {
    let (to, lines) = sync_channel(WAITING);
    thread::spawn(move || {
        let mut input = stdin().lock();
        loop {
            let mut line = Vec::new();
            let read = input
                .by_ref()
                .take(LONGEST_LINE + 1)
                .read_until(b'\n', &mut line);
            let text = match read {
                Ok(0) => return,
                Ok(length) if length as u64 > LONGEST_LINE => {
                    Err(format!("a line is longer than {LONGEST_LINE} bytes"))
                }
                Ok(_) => String::from_utf8(line).map_err(|_| "a line is no UTF-8".into()),
                Err(error) => Err(error.to_string()),
            };
            let is_over = text.is_err();
            let text = text.map_err(|error| CliError::Usage(format!("-: standard input: {error}")));
            // Nobody listens any more, or nothing more can be read.
            if to.send(text).is_err() || is_over {
                return;
            }
        }
    });
    lines
}

/// The next line; none at the end of the input, or after a signal.
fn next(
    lines: &Receiver<Result<String, CliError>>,
    stop: &AtomicBool,
) -> Option<Result<String, CliError>> {
    while !stop.load(Ordering::Relaxed) {
        match lines.recv_timeout(LOOK) {
            Ok(line) => return Some(line),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
    None
}

/// What is written, and when.
struct Answers {
    every: Duration,
    /// When the last answer was written, and its decision.
    last: Option<(Instant, Option<Decision>)>,
}

impl Answers {
    /// Implements: CLI-180.
    fn is_due(&self, answer: &WatchAnswer) -> bool {
        self.last
            .is_none_or(|(at, decision)| at.elapsed() >= self.every || answer.decision != decision)
    }

    /// Writes a line; whether somebody still reads.
    ///
    /// Implements: CLI-180, CLI-181.
    fn write(&mut self, answer: &WatchAnswer, needed: Option<Needed>) -> Result<bool, CliError> {
        let is_last = needed.is_some();
        let line = Envelope::new(
            "palpate-watch",
            1,
            Line {
                answer,
                is_last,
                needed,
            },
        );
        // Keys are strings, and nothing else could fail.
        let line = serde_json::to_string(&line).unwrap_or_default() + "\n";
        let mut out = stdout().lock();
        let written = out.write_all(line.as_bytes()).and_then(|()| out.flush());
        self.last = Some((Instant::now(), answer.decision));
        let is_read = written.is_ok();
        printed(written).map(|()| is_read)
    }
}
