//! What the scenarios share: a run of the loop, and what must hold of every board afterwards.

use std::time::Duration;

use palpate::hid::{Control, Counters, End};

use crate::board::{CAPABILITIES, Record};
use crate::schedule::{self, Fifo};
use crate::servo::{FORCE_LIMIT, Watched, begin, open};

/// The board stops its force by itself when the host is silent for so long, and a tick later at most.
pub const WATCHDOG: Duration = Duration::from_millis(CAPABILITIES.watchdog_ms as u64);

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
pub fn run(serial: &str, cycles: u64) -> Run {
    schedule::fifo(Fifo::Loop);
    let device = open(serial);
    let mut run = Run {
        end: End::Asked,
        settled: Counters::default(),
        counters: Counters::default(),
        responses: Vec::with_capacity(cycles as usize),
        writes: Vec::with_capacity(cycles as usize),
    };
    let burn = Duration::ZERO;
    run.end = begin(Watched { device, burn }).run(|cycle, counters| {
        run.counters = *counters;
        if counters.cycles <= 100 {
            run.settled = *counters;
        }
        run.responses.push(cycle.written - cycle.woke);
        run.writes.push(cycle.written - cycle.computed);
        counters.cycles < cycles
    });
    run
}

/// Whatever happened, the board made no force that was too large or too early, and was sent nothing that is no
/// report.
pub fn safe(record: &Record) {
    let limit = (FORCE_LIMIT / 500e-6) as u16;
    let largest = record.largest_force;
    assert!(largest <= limit, "{largest}");
    let wrong = (record.too_early, record.invalid, record.out_of_order);
    assert_eq!(wrong, (0, 0, 0), "too early, invalid, out of order");
}

/// [`safe`], and the board was sent a force of zero and the control `stop` in the end.
pub fn stopped(record: &Record) {
    safe(record);
    let last = record.last.expect("a force report");
    assert_eq!((last.lateral, last.normal, last.flags), (0, 0, 0));
    ended(record);
}

/// The board was sent the control `stop` last, and makes no force.
pub fn ended(record: &Record) {
    let controls = &record.controls;
    assert_eq!(controls.last(), Some(&Control::Stop), "{controls:?}");
    assert_eq!(record.motors, [0, 0]);
}

/// [`safe`], and the board dropped the force by itself, after as long as it should.
pub fn dropped(record: &Record) -> Duration {
    safe(record);
    let dropped = record.dropped_after.expect("the board drops the force");
    assert!(
        dropped <= WATCHDOG + 2 * CAPABILITIES.period(),
        "{dropped:?}"
    );
    dropped
}

/// The middle and the largest of some times.
pub fn largest(times: &mut [Duration]) -> String {
    times.sort();
    let [middle, last] = [times.len() / 2, times.len() - 1].map(|at| times[at].as_micros());
    format!("p50 {middle} µs, max {last} µs")
}
