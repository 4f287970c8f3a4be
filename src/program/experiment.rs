//! `palpate experiment`: two-alternative forced choice (`spec/command-line.md`).

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;

use clap::{Args, ValueEnum};
use sha2::{Digest, Sha256};

use super::CliError;
use super::error::refuse;
use super::input::{lines, next};
use super::numbers::newtons;
use super::output::{print, say, warn};
use super::platform::{raise_priority, stop_on_signals};
use super::playback::{DeviceArguments, limits, played_map};
use super::progress::bar;
use palpate::decimal::mm;
use palpate::force_map::{ForceMap, Hypotheses};
use palpate::hid::simulated::Trajectory;
use palpate::hid::{HapticDevice, check_device};
use palpate::journal::Journal;
use palpate::servo::{Limits, LoadedTable};
use palpate_paper::psychophysics::{
    Answer, Experiment, Felt, IdealObserver, Interval, Setup, Trial, depth_unlike_name, present,
};

/// The force limit of each component, N.
const LARGEST_FORCE: f32 = 4.0;

/// How long a person may take to press the deadman.
const PATIENCE: Duration = Duration::from_secs(600);

/// Arguments of `palpate experiment`.
#[derive(Debug, Args)]
pub struct ExperimentArguments {
    /// The force map without inclusion
    #[arg(long, value_name = "FILE")]
    reference: PathBuf,
    /// A force map with an inclusion, and its name in the results: 6.6=map.json; give it once for each
    #[arg(long, value_name = "NAME=FILE", required = true, value_parser = named_file)]
    inclusion: Vec<(String, PathBuf)>,
    /// The file of the answers; an aborted experiment continues from it
    #[arg(long, value_name = "FILE")]
    journal: PathBuf,
    /// Name of the subject
    #[arg(long, value_name = "NAME", default_value = "1", value_parser = plain_name)]
    subject: String,
    /// Name of the condition in the results
    #[arg(long, value_name = "NAME", default_value = "FEM data", value_parser = plain_name)]
    condition: String,
    /// Number of pairs for each inclusion
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=1000))]
    trials: u64,
    /// The seed of the order of the pairs and of the ideal observer's noise
    #[arg(long, value_name = "S")]
    seed: u64,
    /// How long each sample is played, in s
    #[arg(long, value_name = "S", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=60))]
    seconds: u64,
    #[command(flatten)]
    device: DeviceArguments,
    /// Who answers: a person at the keyboard, or the ideal observer on the simulated device
    #[arg(long, value_enum, default_value_t = Observer::Person)]
    observer: Observer,
    /// The ideal observer's noise on each sample of each channel, in N
    #[arg(long, value_name = "N", required_if_eq("observer", "ideal"), value_parser = newtons)]
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
    let parts = text.split_once('=');
    let wrong = || format!("{text:?} is not NAME=FILE; write for example 6.6=map.json");
    let (name, file) = parts.ok_or_else(wrong)?;
    Ok((plain_name(name)?, file.into()))
}

/// Warns of a map whose inclusion has another depth than its name.
///
/// Implements: CLI-240.
pub(super) fn warn_of_depth(name: &str, path: &Path, map: &ForceMap) {
    if let Some(depth) = depth_unlike_name(name, map) {
        let (path, depth) = (path.display(), mm(depth));
        warn(&format!(
            "{path}: the inclusion of the map named {name:?} is {depth} mm deep"
        ));
    }
}

/// A name that a row of the results can hold.
fn plain_name(text: &str) -> Result<String, String> {
    let text = text.trim();
    let plain = |c: char| c.is_alphanumeric() || " .-_".contains(c);
    if text.is_empty() || !text.chars().all(plain) {
        return Err(format!(
            "{text:?} is not a name; use letters, digits, spaces, points, - and _"
        ));
    }
    Ok(text.to_string())
}

/// Runs the command.
///
/// Implements: CLI-070, CLI-071, CLI-072, HID-016, HID-055.
pub fn experiment(arguments: &ExperimentArguments) -> Result<(), CliError> {
    arguments.device.check()?;
    if arguments.device.is_pipe() {
        refuse!(
            "--device pipe takes standard input, where the answers come from; it is for play alone"
        );
    }
    if arguments.observer == Observer::Ideal && !arguments.device.is_simulated() {
        refuse!("--observer ideal has no hand; use --device sim");
    }
    if arguments.observer == Observer::Person && arguments.noise.is_some() {
        refuse!("--noise is of the ideal observer; add --observer ideal, or leave --noise out");
    }
    let mut setup = arguments.setup();
    setup.check_names()?;
    let pairs = Pairs::read(arguments)?;
    setup.maps_sha256 = pairs.sums();
    let mut experiment = Experiment::new(setup.clone())?;
    let path = arguments.journal.clone();
    let take = |line: &str| experiment.take(line);
    let journal = Journal::open(path, &setup, "palpate experiment", take)?;
    for ((name, path), (map, _)) in arguments.inclusion.iter().zip(&pairs.inclusions) {
        warn_of_depth(name, path, map);
    }
    let total = arguments.pairs();
    let bar = match arguments.observer {
        Observer::Ideal => bar(total, "pairs"),
        Observer::Person => indicatif::ProgressBar::hidden(),
    };
    if !arguments.device.is_simulated() {
        raise_priority();
    }
    while let Some((number, trial)) = experiment.next() {
        let Some(chosen) = pairs.judge(number, trial)? else {
            return print(&format!(
                "{number} of {total} pairs answered; the same command goes on with the next\n"
            ));
        };
        let right = chosen == trial.with_inclusion;
        let answer = Answer { right };
        journal.append(&answer)?;
        experiment.answer(answer)?;
        bar.set_position(number as u64 + 1);
    }
    bar.finish_and_clear();
    print(&experiment.table_row().unwrap_or_default())
}

impl ExperimentArguments {
    /// The number of pairs.
    fn pairs(&self) -> usize {
        self.inclusion.len() * self.trials as usize
    }

    /// All but the maps, which are not read yet.
    fn setup(&self) -> Setup {
        let names = self.inclusion.iter().map(|(name, _)| name.clone());
        let observer = match self.observer {
            Observer::Person => "person",
            Observer::Ideal => "ideal",
        };
        Setup {
            schema_version: 2,
            seed: self.seed,
            trials: self.trials as usize,
            subject: self.subject.clone(),
            condition: self.condition.clone(),
            inclusions: names.collect(),
            observer: observer.into(),
            noise_sd: self.noise,
            seconds: self.seconds,
            maps_sha256: Vec::new(),
        }
    }
}

/// A map, and the table that plays it.
type Sample = (ForceMap, LoadedTable);

/// The pairs and who judges them.
struct Pairs<'a> {
    arguments: &'a ExperimentArguments,
    limits: Limits,
    reference: Sample,
    inclusions: Vec<Sample>,
    /// Set by a signal.
    stop: Arc<AtomicBool>,
    /// What a person types.
    keyboard: Option<Receiver<io::Result<String>>>,
}

impl<'a> Pairs<'a> {
    /// The samples without an inclusion and with each one, of the same gel, checked against the device.
    fn read(arguments: &'a ExperimentArguments) -> Result<Pairs<'a>, CliError> {
        let capabilities = open(arguments)?.capabilities();
        let capabilities = capabilities.map_err(CliError::refused("device"))?;
        // A weaker device plays what it can.
        let largest = f32::from(capabilities.largest_force_mn) / 1e3;
        let limits = limits(largest.min(LARGEST_FORCE), &capabilities)?;
        check_device(&capabilities, &limits).map_err(CliError::refused("device"))?;
        let damping = arguments.device.damping(&capabilities);
        let sample = |path: &Path| {
            let map = played_map(path)?;
            let table = LoadedTable::passive(map.table(), &damping, &limits);
            let table = table.map_err(CliError::refused(path.display()))?;
            Ok::<Sample, CliError>((map, table))
        };
        let reference = sample(&arguments.reference)?;
        let inclusions = arguments.inclusion.iter().map(|(_, path)| sample(path));
        let pairs = Pairs {
            arguments,
            limits,
            reference,
            inclusions: inclusions.collect::<Result<_, _>>()?,
            stop: stop_on_signals()?,
            keyboard: (arguments.observer == Observer::Person).then(lines),
        };
        for number in 0..pairs.inclusions.len() {
            pairs.hypotheses(number)?;
        }
        Ok(pairs)
    }

    /// SHA-256 of each map as it is written, the one without an inclusion first.
    ///
    /// Implements: CLI-072.
    fn sums(&self) -> Vec<String> {
        let samples = std::iter::once(&self.reference).chain(&self.inclusions);
        let sum = |(map, _): &Sample| {
            let digest = Sha256::digest(map.to_json());
            digest.iter().map(|byte| format!("{byte:02x}")).collect()
        };
        samples.map(sum).collect()
    }

    /// The forces without the inclusion of this number, and with it.
    fn hypotheses(&self, number: usize) -> Result<Hypotheses<'_>, CliError> {
        let path = &self.arguments.inclusion[number].1;
        let hypotheses = Hypotheses::new(&self.reference.0, &self.inclusions[number].0);
        hypotheses.map_err(CliError::refused(path.display()))
    }

    /// The answer to the pair with a number; `None` if the person or a signal stops.
    fn judge(&self, number: usize, trial: Trial) -> Result<Option<Interval>, CliError> {
        let mut samples = [&self.reference.1, &self.inclusions[trial.inclusion].1];
        if trial.with_inclusion == Interval::First {
            samples.reverse();
        }
        let Some(noise_sd) = self.arguments.noise else {
            return self.ask(number, samples);
        };
        let observer = IdealObserver {
            hypotheses: self.hypotheses(trial.inclusion)?,
            noise_sd,
            seed: self.arguments.seed,
        };
        let [first, second] = samples.map(|sample| self.felt(sample));
        let (Some(first), Some(second)) = (first?, second?) else {
            return Ok(None);
        };
        let chosen = observer.choose(&first, &second, number as u64);
        let chosen = chosen.map_err(CliError::refused("the ideal observer"));
        Ok(Some(chosen?))
    }

    /// A sample as it is felt; `None` after a signal.
    fn felt(&self, table: &LoadedTable) -> Result<Option<Felt>, CliError> {
        let table = table.table();
        let duration = Duration::from_secs(self.arguments.seconds);
        let device = open(self.arguments)?;
        let stop = || self.stop.load(Ordering::Relaxed);
        present(device, table, self.limits, duration, PATIENCE, stop)
            .map_err(|error| CliError::Check(error.to_string()))
    }

    /// Lets a person feel both samples of the pair with a number, and answer.
    fn ask(&self, number: usize, samples: [&LoadedTable; 2]) -> Result<Option<Interval>, CliError> {
        let (pair, total) = (number + 1, self.arguments.pairs());
        for (name, sample) in ["first", "second"].into_iter().zip(samples) {
            let prompt = format!(
                "pair {pair} of {total}, {name} sample: let go of the deadman, press Enter (q ends), then hold it "
            );
            let is_asked = self.line(&prompt).is_some_and(|line| line != "q");
            if !is_asked || self.felt(sample)?.is_none() {
                return Ok(None);
            }
        }
        loop {
            let answer = self.line("which sample had the inclusion? 1 or 2 (q ends) ");
            match answer.as_deref() {
                Some("1") => return Ok(Some(Interval::First)),
                Some("2") => return Ok(Some(Interval::Second)),
                Some("q") | None => return Ok(None),
                Some(_) => say("press 1, 2 or q, then Enter\n"),
            }
        }
    }

    /// A line from the keyboard; `None` at its end, or after a signal.
    fn line(&self, prompt: &str) -> Option<String> {
        say(prompt);
        let line = next(self.keyboard.as_ref()?, &self.stop)?.ok()?;
        // More than a line is no person.
        (line.len() < LONGEST_ANSWER).then(|| line.trim().to_string())
    }
}

/// The device; the simulated one is in a hand that presses for as long as a sample lasts.
fn open(arguments: &ExperimentArguments) -> Result<Box<dyn HapticDevice + Send>, CliError> {
    let sweep = Duration::from_secs(arguments.seconds) / 2;
    let hand = Trajectory::probing(4e-3, 9e-3, sweep);
    let device = arguments.device.open(hand);
    device.map_err(CliError::refused("device"))
}

/// A line from the keyboard that is as long is no answer, bytes.
const LONGEST_ANSWER: usize = 1024;
