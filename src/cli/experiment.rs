//! `palpate experiment`: two-alternative forced choice (`spec/playback-command.md`).

use std::fmt::Display;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueEnum};

use super::CliError;
use super::output::{print, read};
use super::playback::{DeviceArguments, limits};
use super::progress::bar;
use crate::force_map::ForceMap;
use crate::hid::HapticDevice;
use crate::hid::simulated::Trajectory;
use crate::psychophysics::{Felt, IdealObserver, Interval, Journal, Setup, Trial, present};
use crate::servo::{Damping, Limits, LoadedTable};

/// How long a person may take to press the deadman.
const PATIENCE: Duration = Duration::from_secs(600);

/// Arguments of `palpate experiment`.
#[derive(Debug, Args)]
pub struct ExperimentArguments {
    /// The force map without inclusion
    #[arg(long, value_name = "FILE")]
    reference: PathBuf,
    /// A force map with an inclusion, and its name in the results: 6.6=map.json; once for each
    #[arg(long, value_name = "NAME=FILE", required = true, value_parser = named_file)]
    inclusion: Vec<(String, PathBuf)>,
    /// Keeps the answers; an experiment that was aborted goes on
    #[arg(long, value_name = "FILE")]
    journal: PathBuf,
    /// Who answers
    #[arg(long, value_name = "NAME", default_value = "1", value_parser = plain_name)]
    subject: String,
    /// What is played, as the results call it
    #[arg(long, value_name = "NAME", default_value = "FEM data", value_parser = plain_name)]
    condition: String,
    /// Pairs for each inclusion
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=1000))]
    trials: u64,
    /// The seed of the order of the pairs and of the ideal observer's noise
    #[arg(long, value_name = "S")]
    seed: u64,
    /// How long each sample is felt, in s
    #[arg(long, value_name = "S", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=60))]
    seconds: u64,
    #[command(flatten)]
    device: DeviceArguments,
    /// Who answers: a person at the keyboard, or the ideal observer on the simulated device
    #[arg(long, value_enum, default_value_t = Observer::Person)]
    observer: Observer,
    /// The ideal observer's noise on each sample of each channel, in N
    #[arg(long, value_name = "N", required_if_eq("observer", "ideal"), value_parser = noise)]
    noise: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Observer {
    /// Answers by key.
    Person,
    /// Answers by Θ.
    Ideal,
}

pub(super) fn named_file(text: &str) -> Result<(String, PathBuf), String> {
    let (name, file) = text
        .split_once('=')
        .ok_or_else(|| format!("{text:?}: expected NAME=FILE, such as 6.6=map.json"))?;
    Ok((plain_name(name)?, file.into()))
}

/// A name that a row of the results can hold.
fn plain_name(text: &str) -> Result<String, String> {
    let plain = |c: char| c.is_alphanumeric() || " .-_".contains(c);
    if text.is_empty() || !text.chars().all(plain) {
        return Err(format!(
            "{text:?}: expected letters, digits, spaces, points, - and _ alone"
        ));
    }
    Ok(text.to_string())
}

fn noise(text: &str) -> Result<f64, String> {
    let value = text.parse().ok();
    value
        .filter(|&value: &f64| value > 0.0 && value.is_finite())
        .ok_or_else(|| format!("{text:?}: expected N above 0, such as 6"))
}

/// A map, and the table that plays it.
struct Sample {
    map: ForceMap,
    table: LoadedTable,
}

impl Sample {
    /// The map in a file, for a device of this damping.
    fn read(path: &Path, damping: &Damping, limits: &Limits) -> Result<Sample, CliError> {
        let map = ForceMap::read(path)?;
        let table = LoadedTable::passive(map.forces(), damping, limits)
            .map_err(|error| failed(path.display(), error))?;
        Ok(Sample { map, table })
    }
}

fn failed(what: impl Display, error: impl Display) -> CliError {
    CliError::Playback(format!("{what}: {error}"))
}

/// Runs the command.
///
/// Implements: CLI-070, CLI-071, CLI-072, CLI-073.
pub fn experiment(arguments: &ExperimentArguments) -> Result<(), CliError> {
    arguments.device.check()?;
    if arguments.observer == Observer::Ideal && !arguments.device.is_simulated() {
        let message = "--observer ideal has no hand: expected --device sim";
        return Err(CliError::Usage(message.into()));
    }
    let capabilities = open(arguments)?
        .capabilities()
        .map_err(|error| failed("device", error))?;
    let damping = arguments.device.damping(&capabilities);
    let limits = limits(4.0)?;
    let reference = Sample::read(&arguments.reference, &damping, &limits)?;
    let mut inclusions = Vec::new();
    for (_, path) in &arguments.inclusion {
        let inclusion = Sample::read(path, &damping, &limits)?;
        let checked = inclusion.map.check_reference(&reference.map);
        checked.map_err(|error| failed(path.display(), error))?;
        inclusions.push(inclusion);
    }
    let (mut journal, mut file) = open_journal(arguments)?;
    let pairs = Pairs {
        arguments,
        reference,
        inclusions,
        limits,
    };
    let total = arguments.inclusion.len() * arguments.trials as usize;
    let bar = match arguments.observer {
        Observer::Ideal => bar(total, "pairs"),
        Observer::Person => indicatif::ProgressBar::hidden(),
    };
    while let Some((number, trial)) = journal.next() {
        let Some(answer) = pairs.judge(number, total, trial)? else {
            return print(&format!(
                "{number} of {total} pairs answered; the same command goes on with the next\n"
            ));
        };
        let line = journal.answer(answer == trial.with_inclusion);
        file.write_all(line.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|error| journal_failed(arguments, "write", error))?;
        bar.set_position(number as u64 + 1);
    }
    bar.finish_and_clear();
    print(&journal.table_row().unwrap_or_default())
}

fn journal_failed(
    arguments: &ExperimentArguments,
    action: &'static str,
    error: std::io::Error,
) -> CliError {
    CliError::File {
        action,
        path: arguments.journal.display().to_string(),
        error,
    }
}

/// The journal so far, and the file to go on with.
fn open_journal(arguments: &ExperimentArguments) -> Result<(Journal, File), CliError> {
    let setup = Setup {
        seed: arguments.seed,
        trials: arguments.trials as usize,
        subject: arguments.subject.clone(),
        condition: arguments.condition.clone(),
        inclusions: arguments
            .inclusion
            .iter()
            .map(|(name, _)| name.clone())
            .collect(),
    };
    let path = &arguments.journal;
    let journal = if path.exists() {
        let journal =
            Journal::parse(&read(path)?).map_err(|error| failed(path.display(), error))?;
        if *journal.setup() != setup {
            let found = journal.setup();
            return Err(failed(
                path.display(),
                format!("another experiment ({found}) than asked for ({setup})"),
            ));
        }
        journal
    } else {
        Journal::new(setup)
    };
    // Written anew, since an abort may have left part of a line.
    let write = |error| journal_failed(arguments, "write", error);
    super::output::write(path, &journal.to_text())?;
    let file = OpenOptions::new().append(true).open(path).map_err(write)?;
    Ok((journal, file))
}

/// The pairs and who judges them.
struct Pairs<'a> {
    arguments: &'a ExperimentArguments,
    reference: Sample,
    inclusions: Vec<Sample>,
    limits: Limits,
}

impl Pairs<'_> {
    /// The answer to a pair; `None` if the person stops.
    fn judge(
        &self,
        number: usize,
        total: usize,
        trial: Trial,
    ) -> Result<Option<Interval>, CliError> {
        let with = &self.inclusions[trial.inclusion];
        let [first, second] = match trial.with_inclusion {
            Interval::First => [with, &self.reference],
            Interval::Second => [&self.reference, with],
        };
        match self.arguments.noise {
            Some(noise_sd) if self.arguments.observer == Observer::Ideal => {
                let observer = IdealObserver {
                    reference: self.reference.map.forces(),
                    inclusion: with.map.forces(),
                    noise_sd,
                    seed: self.arguments.seed,
                };
                let (first, second) = (self.felt(first)?, self.felt(second)?);
                let answer = observer.choose(&first, &second, number as u64);
                answer
                    .map(Some)
                    .map_err(|error| failed("the ideal observer", error))
            }
            _ => self.ask(number, total, first, second),
        }
    }

    /// A sample as it is felt.
    fn felt(&self, sample: &Sample) -> Result<Felt, CliError> {
        let table = sample
            .table
            .table()
            .map_err(|error| failed("servo", error))?;
        let duration = Duration::from_secs(self.arguments.seconds);
        let device = open(self.arguments)?;
        present(device, table, self.limits, duration, PATIENCE)
            .map_err(|error| CliError::Check(error.to_string()))
    }

    /// Lets a person feel both samples, and answer.
    fn ask(
        &self,
        number: usize,
        total: usize,
        first: &Sample,
        second: &Sample,
    ) -> Result<Option<Interval>, CliError> {
        for (name, sample) in [("first", first), ("second", second)] {
            let prompt = format!(
                "pair {} of {total}, {name} sample: let go of the deadman, press Enter (q ends), then hold it ",
                number + 1
            );
            match line(&prompt) {
                None => return Ok(None),
                Some(text) if text == "q" => return Ok(None),
                Some(_) => self.felt(sample)?,
            };
        }
        loop {
            match line("which sample had the inclusion? 1 or 2 (q ends) ").as_deref() {
                Some("1") => return Ok(Some(Interval::First)),
                Some("2") => return Ok(Some(Interval::Second)),
                Some("q") | None => return Ok(None),
                Some(_) => eprintln!("expected 1, 2 or q"),
            }
        }
    }
}

/// The device; the simulated one is in a hand that presses for as long as a sample lasts.
fn open(arguments: &ExperimentArguments) -> Result<Box<dyn HapticDevice + Send>, CliError> {
    let sweep = Duration::from_secs(arguments.seconds) / 2;
    let device = arguments
        .device
        .open(Trajectory::probing(4e-3, 9e-3, sweep));
    device.map_err(|error| failed("device", error))
}

/// The longest line that is read from the keyboard, bytes.
const LONGEST_LINE: u64 = 1024;

/// A line from the keyboard; `None` at its end.
fn line(prompt: &str) -> Option<String> {
    eprint!("{prompt}");
    let mut text = String::new();
    let mut keyboard = std::io::stdin().lock().take(LONGEST_LINE);
    match keyboard.read_line(&mut text) {
        // More than a line is no person.
        Ok(length) if length == 0 || length as u64 == LONGEST_LINE => None,
        Err(_) => None,
        Ok(_) => Some(text.trim().to_string()),
    }
}
