//! The command line.

use std::ffi::OsString;
use std::fs::canonicalize;
use std::path::Path;

use clap::{Parser, Subcommand};

use palpate::version::LONG_VERSION;

use super::error::{CliError, refuse};
use super::{
    bank, calibrate, demo, detect, devices, experiment, import, manual, oracle, play,
    psychophysics, reach, run, simulate, solve, study, timing, watch,
};

/// Inclusion probing after Yan, Scott and Fearing (1999): contact forces by finite elements, detection of an inclusion, haptic playback
#[derive(Debug, Parser)]
#[command(name = "palpate", bin_name = "palpate", version, long_version = LONG_VERSION, after_help = "Examples:\n  palpate run --out paper\n  palpate help detect")]
pub struct CommandLine {
    /// Prints neither progress nor notes; warnings and errors stay
    #[arg(short, long, global = true, display_order = 998)]
    pub(super) quiet: bool,
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Reproduces the paper: force maps of its phantoms, signals, detection, and a report
    #[command(
        after_help = "Examples:\n  palpate run --out paper\n  palpate run --config run.toml --compare-theories"
    )]
    Run(run::RunArguments),
    /// Writes example files for the other commands: force maps, recorded sweeps, a measured map, a configuration
    #[command(after_help = "Example:\n  palpate demo demo")]
    Demo(demo::DemoArguments),
    /// Computes the force map of a phantom: the forces on the probe over depth and lateral position
    #[command(
        after_help = "Examples:\n  palpate solve --phantom 4.6 --depths-mm 1:4:1 --laterals-mm=-8:8:0.4 --format json > map.json\n  palpate solve --phantom gel.toml --depths-mm 3 --laterals-mm 0 --vtu pose.vtu"
    )]
    Solve(solve::SolveArguments),
    /// Checks a measured force map in CSV and converts it to JSON
    #[command(
        after_help = "Examples:\n  palpate import-map measured.csv --phantom 4.6 --out gel.json\n  palpate import-map rig.csv --columns 'depth=Z(mm), position=X(mm), normal=-Fz[mN]' --skip-rows 3"
    )]
    ImportMap(import::ImportArguments),
    /// Fits recorded indentations of a gel: where the probe touched it, its moduli, how it relaxes
    #[command(
        after_help = "Example:\n  palpate calibrate curve.csv --phantom none --out gel.toml --figure curve.svg"
    )]
    Calibrate(calibrate::CalibrateArguments),
    /// Computes a bank of force maps, one for each candidate inclusion, for 'palpate detect' and 'palpate reach'
    #[command(
        after_help = "Example:\n  palpate bank --phantom 4.6 --offsets-mm=-6:6:1 --depths-mm 2.6:6.6:0.5 --probe-depth-mm 4 --laterals-mm=-8:8:1 --out bank.json"
    )]
    Bank(bank::BankArguments),
    /// Simulates records of a probe that a stage or a hand leads over a gel, to plan an experiment
    #[command(
        after_help = "Examples:\n  palpate simulate --phantom 4.6 --depths-mm 4 --noise-sd-n 0.1 > sweep.csv\n  palpate simulate --map map.json --depths-mm 1,2,3,4 --hand 0.05,5,500 --tremor-mm 0.05 --noise-sd-n 0.1 --records 100 --out records"
    )]
    Simulate(Box<simulate::SimulateArguments>),
    /// Decides whether a recorded sweep shows an inclusion, using two force maps or a bank; a bank also locates it
    #[command(
        after_help = "Examples:\n  palpate detect sweep.csv --reference none.json --inclusion inclusion.json --depth-mm 4\n  palpate detect sweeps/ --bank bank.json --format csv"
    )]
    Detect(Box<detect::DetectArguments>),
    /// Judges a sweep against a bank while it is taken: samples in, answers out, until the error rates allow a decision
    Watch(watch::WatchArguments),
    /// Computes the greatest depth and the smallest size that can still be detected
    #[command(
        after_help = "Example:\n  palpate reach --bank bank.json --noise-sd-n 0.1 --figure reach.svg"
    )]
    Reach(reach::ReachArguments),
    /// Propagates input uncertainty to every result, on one machine or a cluster
    #[command(
        after_help = "Examples:\n  palpate study run study.toml --out samples\n  palpate study merge samples --out study.json"
    )]
    Study(study::StudyArguments),
    /// Renders a force map on a real or simulated haptic device
    #[command(
        after_help = "Examples:\n  palpate play --map map.json\n  palpate play --map map.json --device hid --scale --seconds 60 --record session.jsonl"
    )]
    Play(play::PlayArguments),
    /// Lists the HID devices of this machine and whether they can render a force map
    #[command(after_help = "Example:\n  palpate devices --format json")]
    Devices(devices::DevicesArguments),
    /// Runs the paper's two-alternative forced-choice experiment: which of two gels has the inclusion?
    #[command(
        after_help = "Example:\n  palpate experiment --reference none.json --inclusion 4.6=map.json --journal answers.txt --seed 1"
    )]
    Experiment(experiment::ExperimentArguments),
    /// Analyses the answers of two-alternative forced-choice experiments: proportions correct, differences, noise, and which force explains them
    #[command(
        after_help = "Examples:\n  palpate psychophysics\n  palpate psychophysics counts.csv --format json"
    )]
    Psychophysics(psychophysics::PsychophysicsArguments),
    /// Measures the servo loop on the simulated device against a time budget
    #[command(
        after_help = "Examples:\n  palpate timing --budget-us 1000\n  palpate timing --from log.csv --format junit"
    )]
    Timing(timing::TimingArguments),
    /// Answers questions in JSON lines, to check other implementations
    Oracle(oracle::OracleArguments),
    /// Prints completions of commands and options for a shell
    #[command(
        after_help = "Example:\n  palpate completions bash > ~/.local/share/bash-completion/completions/palpate"
    )]
    Completions(manual::CompletionsArguments),
    /// Prints the manual page, or writes one for each command
    #[command(
        after_help = "Examples:\n  palpate man > palpate.1\n  palpate man ~/.local/share/man/man1"
    )]
    Man(manual::ManArguments),
}

/// The options that name a file to write.
const OUTPUTS: &str = "--out --uncertainty-out --figure --record --journal --vtu --pvd";

/// Refuses a file to write that another argument names too, so that no file is read and then lost, and none is written twice.
///
/// Implements: CLI-236.
pub fn check_outputs(arguments: &[OsString]) -> Result<(), CliError> {
    // An option and its value, or a name and a file, may be one argument.
    let apart = |argument: &OsString| {
        let text = argument.to_string_lossy();
        let (name, value) = text.split_once('=').unwrap_or(("", &text));
        [name, value].map(String::from)
    };
    let arguments: Vec<_> = arguments.iter().map(apart).collect();
    let option = |at: usize| {
        let before = at.checked_sub(1).map_or("", |before| &arguments[before][1]);
        let mut outputs = OUTPUTS.split(' ');
        outputs.find(|of| [&arguments[at][0], before].contains(of))
    };
    // A file that is not there yet is that of its name in its folder, if it is to be written: any other word is no file.
    let file = |at: usize| {
        let path = Path::new(&arguments[at][1]);
        let new = option(at).and_then(|_| {
            let folder = path.parent().filter(|of| !of.as_os_str().is_empty());
            let folder = canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
            Some(folder.join(path.file_name()?))
        });
        let file = canonicalize(path).ok().or(new);
        file.filter(|file| file.is_file() || !file.exists())
    };
    let files: Vec<_> = (0..arguments.len()).map(file).collect();
    for (at, [_, value]) in arguments.iter().enumerate() {
        let Some(option) = option(at) else {
            continue;
        };
        let same = files
            .iter()
            .filter(|file| file.is_some() && **file == files[at]);
        if same.count() > 1 {
            refuse!(
                "{value} is named twice in this command, which would overwrite it; choose another {option}"
            );
        }
    }
    Ok(())
}

/// Reads a command line, the first entry of which is the program's name; runs nothing. A text to print, help or the version, may
/// take the place of arguments.
///
/// # Errors
/// [`CliError::Usage`].
///
/// Implements: CLI-001, CLI-002, CLI-220, CLI-221, CLI-222.
pub fn read<A: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<Result<A, String>, CliError> {
    match A::try_parse_from(arguments) {
        Ok(arguments) => Ok(Ok(arguments)),
        Err(error) if !error.use_stderr() => Ok(Err(error.to_string())),
        Err(error) => Err(CliError::usage(&error)),
    }
}
