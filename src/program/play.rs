//! `palpate play`: a force map rendered on a haptic device (`spec/command-line.md`).

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use askama::Template;
use clap::Args;
use serde::Serialize;

use super::error::refuse;
use super::output::{note, print, read, say, shows_progress, tell, write};
use super::platform::{PROMISE, raise_priority, stop_on_signals};
use super::playback::{DeviceArguments, limits, loaded_map, played_map};
use super::{CliError, Format};
use palpate::file::check_writable;
use palpate::hid::simulated::Trajectory;
use palpate::hid::supervise::{HELD_UP, PlayOptions, play as supervised};
use palpate::hid::timing::Timing;
use palpate::hid::{Capabilities, Counters, End, HapticDevice, Recording, Session, check_device};
use palpate::servo::{Limits, LoadedTable};

/// Most cycles that are recorded: as many as can be read again.
const MOST_RECORDED: u32 = 1_000_000;

/// Arguments of `palpate play`.
#[derive(Debug, Args)]
pub struct PlayArguments {
    /// Force map to render
    #[arg(long, value_name = "FILE")]
    map: PathBuf,
    #[command(flatten)]
    device: DeviceArguments,
    /// Ends after S seconds on the device's clock [default: one indentation on the simulated device]
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..=86_400))]
    seconds: Option<u64>,
    /// Force limit of each component, in N
    #[arg(long, value_name = "N", default_value_t = 4.0)]
    max_force: f32,
    /// Scales down a map that is too stiff for the device instead of refusing it
    #[arg(long)]
    scale: bool,
    /// Records the session to a file
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Replays a recorded session and compares every force with the recording
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seconds", "record", "max_force", "format"])]
    replay: Option<PathBuf>,
    /// Output format of the summary
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
}

/// Runs the command.
///
/// Implements: CLI-063, CLI-064, CLI-065, CLI-066, CLI-067, HID-094, HID-101, HID-110.
pub fn play(arguments: &PlayArguments) -> Result<(), CliError> {
    arguments.device.check()?;
    if let Some(file) = &arguments.replay {
        return replay(arguments, file);
    }
    let probing = Trajectory::probing(4e-3, 9e-3, Duration::from_millis(1500));
    let seconds = arguments.seconds.map(Duration::from_secs);
    let is_simulated = arguments.device.is_simulated();
    let duration = seconds.or(is_simulated.then_some(probing.duration()));
    let hand = probing.repeated(duration.unwrap_or_default());
    let device = arguments.device.open(hand).map_err(failed)?;
    session(arguments, device, duration)
}

fn failed(error: impl Display) -> CliError {
    CliError::Usage(error.to_string())
}

/// The table for this device, and the factor by which its forces are scaled.
fn table(
    arguments: &PlayArguments,
    capabilities: &Capabilities,
    limits: &Limits,
) -> Result<(LoadedTable, f64), CliError> {
    let path = &arguments.map;
    let map = played_map(path)?;
    let both = map.table().both();
    both.map_err(CliError::refused(path.display()))?;
    let damping = arguments.device.damping(capabilities);
    let file = path.display();
    if arguments.scale {
        let scaled = LoadedTable::scaled_to_be_passive(map.table(), &damping, limits);
        return scaled.map_err(CliError::refused(file));
    }
    let loaded = LoadedTable::passive(map.table(), &damping, limits);
    let helps = || LoadedTable::scaled_to_be_passive(map.table(), &damping, limits).is_ok();
    let refused = |error| {
        let remedy = if helps() { " (or use --scale)" } else { "" };
        failed(format_args!("{file}: {error}{remedy}"))
    };
    Ok((loaded.map_err(refused)?, 1.0))
}

/// Plays on `device` and prints the summary.
fn session(
    arguments: &PlayArguments,
    mut device: Box<dyn HapticDevice + Send>,
    duration: Option<Duration>,
) -> Result<(), CliError> {
    let capabilities = device.capabilities().map_err(failed)?;
    let limits = limits(arguments.max_force, &capabilities)?;
    check_device(&capabilities, &limits).map_err(failed)?;
    let (loaded, scale) = table(arguments, &capabilities, &limits)?;
    let options = PlayOptions {
        duration,
        record: recorded_cycles(arguments, &capabilities, duration)?,
    };
    if let Some(path) = &arguments.record {
        check_writable(path).map_err(CliError::file("write", path))?;
    }
    let stop = stop_on_signals()?;
    let is_simulated = arguments.device.is_simulated();
    if !is_simulated {
        tell(PROMISE);
    }
    let session = Session::begin(device, loaded.table(), limits).map_err(failed)?;
    let stop = || stop.load(Ordering::Relaxed);
    // A virtual clock stands still with the loop: nothing is held up, and no cycle takes time.
    let look = live(!is_simulated);
    let played = supervised(session, &options, raise_priority, stop, look);
    if shows_progress() {
        say("\r\x1b[K"); // the summary begins on an empty line
    }
    let panicked = "the servo thread panicked; the device was told to stop";
    let played = played.ok_or(CliError::Check(panicked.into()))?;
    let recording = Recording {
        capabilities,
        limits,
        cycles: played.cycles,
    };
    let path = arguments.record.as_ref();
    let (kept, all) = (recording.cycles.len() as u64, played.counters.cycles);
    if let Some(path) = path.filter(|_| kept < all) {
        let faster = "the device reported more often than it says";
        note(
            path.display(),
            &format!("holds the first {kept} of {all} cycles: {faster}"),
        );
    }
    let recorded = path.map_or(Ok(()), |path| write(path, &recording.to_text()));
    let held_up = played.held_up.filter(|_| !is_simulated);
    let summary = Summary {
        end: played.end.to_string(),
        counters: played.counters,
        held_up_ms: held_up.map(|time| time.as_millis() as u64),
        rounding_position_m: loaded.rounding().position_m,
        rounding_force_n: loaded.rounding().force_n,
        scale,
        timing: played.timing.filter(|_| !is_simulated),
    };
    let text = summary.text(arguments.format);
    if arguments.device.is_pipe() {
        say(text); // standard output is the device
    } else {
        print(&text)?;
    }
    recorded?;
    match played.end {
        End::Asked => Ok(()),
        _ => Err(CliError::Check(summary.end)),
    }
}

/// How many cycles to record at most.
fn recorded_cycles(
    arguments: &PlayArguments,
    capabilities: &Capabilities,
    duration: Option<Duration>,
) -> Result<usize, CliError> {
    let (period, longest) = (capabilities.period(), MOST_RECORDED * capabilities.period());
    match (&arguments.record, duration) {
        (None, _) => Ok(0),
        (Some(_), Some(time)) if time <= longest => {
            Ok((time.as_micros() / period.as_micros()) as usize + 64)
        }
        _ => refuse!("--record needs --seconds of at most {}", longest.as_secs()),
    }
}

/// What the supervisor shows while it plays: the counters on one line of a terminal and, of a loop on the `wall_clock`, that it stalls.
fn live(wall_clock: bool) -> impl FnMut(&Counters, Duration) {
    let terminal = shows_progress();
    let mut told = false;
    move |counters, silent| {
        if wall_clock && silent > HELD_UP && !told {
            told = true;
            say(format_args!(
                "the servo thread has been held up for {} ms: the device's own watchdog must drop the force\n",
                silent.as_millis()
            ));
        }
        told &= silent > HELD_UP;
        if terminal {
            say(format_args!("\r{}\x1b[K", counted(counters)));
        }
    }
}

fn counted(counters: &Counters) -> String {
    let refused = match counters.stops_refused {
        0 => String::new(),
        refused => format!(", {refused} stops refused"),
    };
    format!(
        "{} cycles, {} played, {} missed, {} skipped, {} passed over, {} garbage{refused}",
        counters.cycles,
        counters.played,
        counters.missed,
        counters.skipped,
        counters.passed_over,
        counters.garbage
    )
}

/// The summary.
#[derive(Template, Serialize)]
#[template(path = "cli.txt", block = "play")]
struct Summary {
    end: String,
    #[serde(flatten)]
    counters: Counters,
    held_up_ms: Option<u64>,
    rounding_position_m: f64,
    rounding_force_n: f64,
    scale: f64,
    timing: Option<Timing>,
}

impl Summary {
    fn text(&self, format: Format) -> String {
        // With its keys sorted; neither this nor writing to a String fails.
        let sorted = serde_json::to_value(self).unwrap_or_default();
        format.text(&sorted, || self.render().unwrap_or_default())
    }
}

/// Plays a recording again.
fn replay(arguments: &PlayArguments, file: &Path) -> Result<(), CliError> {
    let text = read(file)?;
    let recording = Recording::parse(&text).map_err(CliError::refused(file.display()))?;
    let loaded = if arguments.scale {
        table(arguments, &recording.capabilities, &recording.limits)?.0
    } else {
        loaded_map(&arguments.map)?
    };
    let alike = "give --map, --scale and --device as they were when it was recorded";
    let failed = |error| CliError::Check(format!("{}: {error}; {alike}", file.display()));
    let cycles = recording.replay(loaded.table()).map_err(failed)?;
    print(&format!(
        "{cycles} cycles, all forces the same to the bit\n"
    ))
}

#[cfg(test)]
mod tests {
    use super::MOST_RECORDED;
    use palpate::hid::simulated::PAPER;
    use palpate::hid::{ForceReport, PositionReport, RecordedCycle, Recording};
    use palpate::servo::Limits;

    // Verifies: CLI-008, CLI-067.
    #[test]
    fn the_longest_recording_can_be_read() {
        let least = i16::MIN;
        let cycle = RecordedCycle {
            // As long as the slowest device records.
            received_us: 65_535_000_000,
            written_us: 65_535_000_000,
            position: Some(PositionReport {
                lateral: least,
                normal: least,
                buttons: 255,
                status: 255,
                sequence: 65_535,
                force_sequence: 65_535,
            }),
            force: ForceReport {
                lateral: least,
                normal: least,
                sequence: 65_535,
                flags: 255,
            },
            playing: false,
        };
        let recording = Recording {
            capabilities: PAPER,
            limits: Limits::for_playback(4.0, PAPER.period_us).unwrap(),
            cycles: vec![cycle; 1000],
        };
        let bytes = recording.to_text().len() * MOST_RECORDED as usize / 1000;
        assert!(bytes <= 256 << 20, "{bytes}");
    }
}
