//! One servo thread that plays, and a supervisor that watches it: the heartbeat, the wish to stop, and
//! what is shown to a person.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::timing::{Budget, Times, Timing};
use super::{Counters, DeviceState, End, HapticDevice, RecordedCycle, Session};

/// How often the supervisor looks.
const LOOK: Duration = Duration::from_millis(20);

/// After this long without a heartbeat, the servo thread is held up: longer than any watchdog that a
/// device should have, so that its force is gone by then.
pub const HELD_UP: Duration = Duration::from_millis(100);

/// What the servo thread and its supervisor show each other while it runs; neither waits for the other.
#[derive(Default)]
struct Board {
    /// Set to end the session.
    stop: AtomicBool,
    /// As last shown.
    counters: Mutex<Counters>,
}

/// Ends the session when the supervisor is done, also by a panic: the scope waits for the servo thread.
struct Supervised<'a>(&'a Board);

impl Drop for Supervised<'_> {
    fn drop(&mut self) {
        self.0.stop.store(true, Ordering::Relaxed);
    }
}

/// What a session was.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// Why it ended.
    pub end: End,
    /// What happened.
    pub counters: Counters,
    /// How long the cycles took, on the clock of the device; `None` for fewer than one.
    pub timing: Option<Timing>,
    /// Longest time without a heartbeat that the supervisor saw, if longer than [`HELD_UP`].
    pub held_up: Option<Duration>,
    /// The cycles, if they were to be recorded: at most as many as asked for.
    pub cycles: Vec<RecordedCycle>,
}

/// How a session is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayOptions {
    /// Ends after this much of the device's time.
    pub duration: Option<Duration>,
    /// Cycles to record at most; room for them is made before the first.
    pub record: usize,
}

/// Plays `session` in a thread of its own until it ends by itself, `stop` says so, or its time is
/// over. `look` is called by the supervisor some 50 times a second, with the counters and the time
/// since the last heartbeat.
///
/// `prepare` is called once on the servo thread, before the first cycle: for its priority.
///
/// The servo thread neither allocates nor locks. Returns `None` if it panicked, after the device was
/// stopped.
///
/// Implements: HID-016, HID-053, HID-054, HID-055.
pub fn play<D: HapticDevice + Send>(
    session: Session<D>,
    options: &PlayOptions,
    prepare: impl FnOnce() + Send,
    stop: impl Fn() -> bool,
    mut look: impl FnMut(&Counters, Duration),
) -> Option<Played> {
    let board = &Board::default();
    std::thread::scope(|scope| {
        let _ends = Supervised(board);
        let servo = scope.spawn(move || {
            prepare();
            servo_loop(session, options, board)
        });
        let mut heartbeat = (0, Instant::now());
        let (mut counters, mut held_up) = (Counters::default(), None);
        while !servo.is_finished() {
            if stop() {
                board.stop.store(true, Ordering::Relaxed);
            }
            if let Ok(shown) = board.counters.try_lock() {
                counters = *shown;
            }
            if counters.cycles != heartbeat.0 {
                heartbeat = (counters.cycles, Instant::now());
            }
            let silent = heartbeat.1.elapsed();
            if silent > HELD_UP {
                held_up = held_up.max(Some(silent));
            }
            look(&counters, silent);
            std::thread::park_timeout(LOOK);
        }
        let played = servo.join().ok()?;
        Some(Played { held_up, ..played })
    })
}

/// The servo thread.
fn servo_loop<D: HapticDevice>(
    mut session: Session<D>,
    options: &PlayOptions,
    board: &Board,
) -> Played {
    let is_stopped = || board.stop.load(Ordering::Relaxed);
    let mut cycles = Vec::with_capacity(options.record);
    // A cycle's budget is its period.
    let period = session.capabilities().period();
    let mut times = Times::new(Budget::of(period), Some(period));
    let end = session.run(|cycle, counters| {
        if let Ok(mut shown) = board.counters.try_lock() {
            *shown = *counters;
        }
        times.record(cycle, Duration::ZERO);
        if cycles.len() < cycles.capacity() {
            cycles.push(RecordedCycle::from(cycle));
        }
        let time = options.duration.unwrap_or(Duration::MAX);
        cycle.written < time && !is_stopped()
    });
    Played {
        end: match end {
            // A signal that interrupts a read is the wish to stop, where there is one.
            End::Device(error) if error.state == DeviceState::Interrupted && is_stopped() => {
                End::Asked
            }
            end => end,
        },
        counters: session.counters(),
        timing: times.timing(),
        held_up: None,
        cycles,
    }
}

#[cfg(test)]
mod tests;
