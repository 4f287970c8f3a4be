//! What the scenarios share: boards, a run of the loop, and what must hold of every board afterwards.

use std::time::Duration;

use palpate::hid::{Control, Counters, End, Session};

use crate::board::{Act, Answers, Board, CAPABILITIES, Make, Record, Script};
use crate::link::{Completion, Kind};
use crate::schedule::{self, Fifo};
use crate::servo::{FORCE_LIMIT, Watched, open, with_session};

/// A scenario: what was measured, or what was wrong.
pub type Scenario = fn() -> Result<String, String>;

/// The board stops its force by itself when the host is silent for so long, and a tick later at most.
pub const WATCHDOG: Duration = Duration::from_millis(CAPABILITIES.watchdog_ms as u64);

/// Fails with what was found unless `holds`.
macro_rules! ensure {
    ($holds:expr, $($found:tt)*) => {
        if !$holds {
            return Err(format!("not true that {}: {}", stringify!($holds), format!($($found)*)));
        }
    };
}
pub(crate) use ensure;

/// An error as text.
pub fn text(error: impl ToString) -> String {
    error.to_string()
}

/// A good board.
pub fn make(kind: Kind, script: Script) -> Make {
    Make {
        kind,
        script,
        answers: Answers::Good,
        takes: Completion::Now,
    }
}

/// Plugs a good board in.
pub fn plug(kind: Kind, serial: &str, script: Script) -> Result<Board, String> {
    Board::plug(serial, make(kind, script)).map_err(text)
}

/// Nothing but reports.
pub fn reports(_: u32) -> Act {
    Act::Report
}

/// A run of the loop.
pub struct Run {
    /// Why it ended.
    pub end: End,
    /// The counters after 100 cycles.
    pub settled: Counters,
    /// The counters in the end.
    pub counters: Counters,
    /// From the report at hand to the force written, each cycle.
    pub responses: Vec<Duration>,
    /// How long the write took, each cycle.
    pub writes: Vec<Duration>,
}

/// Runs the shipped loop on the board `serial` for at most `cycles` cycles.
pub fn run(serial: &str, cycles: u64) -> Result<Run, String> {
    schedule::fifo(Fifo::Loop).map_err(text)?;
    let device = open(serial).map_err(text)?;
    let burn = Duration::ZERO;
    let mut run = Run {
        end: End::Asked,
        settled: Counters::default(),
        counters: Counters::default(),
        responses: Vec::with_capacity(cycles as usize),
        writes: Vec::with_capacity(cycles as usize),
    };
    run.end = with_session(Watched { device, burn }, |mut session: Session<_>| {
        session.run(|cycle, counters| {
            run.counters = *counters;
            if counters.cycles <= 100 {
                run.settled = *counters;
            }
            run.responses.push(cycle.written - cycle.woke);
            run.writes.push(cycle.written - cycle.computed);
            counters.cycles < cycles
        })
    })?;
    Ok(run)
}

/// Whatever happened, the board made no force that was too large or too early, and was sent nothing that is no
/// report.
pub fn safe(record: &Record) -> Result<(), String> {
    let limit = (FORCE_LIMIT / 500e-6) as u16;
    ensure!(record.largest_force <= limit, "{}", record.largest_force);
    ensure!(record.too_early == 0, "{}", record.too_early);
    ensure!(record.invalid == 0, "{}", record.invalid);
    ensure!(record.out_of_order == 0, "{}", record.out_of_order);
    Ok(())
}

/// [`safe`], and the board was sent a force of zero and the control `stop` in the end.
pub fn stopped(record: &Record) -> Result<(), String> {
    safe(record)?;
    let controls = &record.controls;
    ensure!(controls.last() == Some(&Control::Stop), "{controls:?}");
    let zero = record
        .last
        .is_some_and(|last| (last.lateral, last.normal, last.flags) == (0, 0, 0));
    ensure!(zero, "{:?}", record.last);
    ensure!(record.motors == [0, 0], "{:?}", record.motors);
    Ok(())
}

/// The middle and the largest of some times.
pub fn largest(mut times: Vec<Duration>) -> Result<String, String> {
    times.sort();
    let last = times.last().ok_or("no times")?;
    let middle = times[times.len() / 2];
    Ok(format!(
        "p50 {} µs, max {} µs",
        middle.as_micros(),
        last.as_micros()
    ))
}
