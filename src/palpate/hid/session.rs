//! A playback session: begins with what the device says of itself, and ends with a stopped device,
//! whatever happens in between. A cycle of its loop: read, drain, step, write.

use std::fmt;
use std::time::Duration;

use super::{
    Capabilities, Control, DeviceError, DeviceState, ForceReport, HapticDevice, PositionReport,
    Received, Units,
};
use crate::force::Force;
use crate::refusal::Refusal;
use crate::servo::{Fault, Input, Limits, MOST_AHEAD, Mode, Request, State, Table, step};

/// The longest that a device may go on playing a force without a report.
const LONGEST_WATCHDOG_MS: u16 = 100;

/// Reports that one cycle takes from the queue at most: what the kernel of the system keeps.
const QUEUE: usize = 64;

/// How long a device that plays nothing yet may be silent.
const LONGEST_SILENCE: Duration = Duration::from_secs(1);

/// How often a stop is sent to a device that does not take it.
const STOP_TRIES: usize = 5;

/// A device that plays a table, until it is dropped: also by a panic.
///
/// ```
#[doc = include_str!("simulated/probing.example")]
/// use palpate::hid::{End, Session};
/// use palpate::servo::Mode;
///
/// let mut session = Session::begin(device, table, limits)?;
/// assert_eq!(session.capabilities().watchdog_ms, 15);
/// let end = session.run(|_, counters| counters.cycles < 800);
/// assert_eq!((end, session.mode()), (End::Asked, Mode::Disarmed));
/// assert!(session.counters().played > 500);
/// assert_eq!(session.device().motor_force(), [0.0, 0.0]); // the device is stopped
/// # Ok::<(), palpate::refusal::Refusal>(())
/// ```
///
/// Implements: HID-016, HID-017, HID-083.
pub struct Session<'a, D: HapticDevice> {
    device: D,
    capabilities: Capabilities,
    units: Units,
    table: Table<'a>,
    limits: Limits,
    stage: Stage,
    state: State,
    /// Number of the last force report.
    sequence: u16,
    counters: Counters,
}

/// How far a session is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The first cycle will enable the device.
    Begun,
    /// The device was told to play.
    Enabled,
    /// A stop was asked for.
    Ended,
    /// The device has taken the stop.
    Stopped,
}

/// What happened in all cycles so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Counters {
    /// Cycles.
    pub cycles: u64,
    /// Cycles in which the force followed the table.
    pub played: u64,
    /// Cycles without a fresh sample.
    pub missed: u64,
    /// Reports that never came, by the gaps between sequence numbers.
    pub skipped: u64,
    /// Reports that had come with a newer one, and were passed over.
    pub passed_over: u64,
    /// Reports that did not decode.
    pub garbage: u64,
    /// Stops, and reports of zero that go with them, that the device refused.
    pub stops_refused: u64,
}

/// What one cycle did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cycle {
    /// The report that it used.
    pub position: Option<PositionReport>,
    /// The report that it sent.
    pub force: ForceReport,
    /// The force follows the table.
    pub playing: bool,
    /// When the wait for a report ended, on the device's clock.
    pub woke: Duration,
    /// When the queue was drained.
    pub received: Duration,
    /// When the force was computed.
    pub computed: Duration,
    /// When it was written.
    pub written: Duration,
}

/// Why a session ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// It was asked to.
    Asked,
    /// The servo kernel found a fault; the force has been released, or is zero at once where the session was asked to end.
    Fault(Fault),
    /// The device failed.
    Device(DeviceError),
    /// The end, and why stopping the device failed.
    Unstopped(Box<End>, DeviceError),
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            End::Asked => f.write_str("ended as asked"),
            End::Fault(fault) => write!(f, "stopped by a fault: {fault}"),
            End::Device(error) => write!(f, "stopped: {error}"),
            End::Unstopped(end, error) => write!(
                f,
                "{end}; stopping the device failed ({error}): its own watchdog must drop the force"
            ),
        }
    }
}

/// A refusal that says all by itself.
fn as_it_is(error: impl fmt::Display) -> Refusal {
    Refusal::state(error, "")
}

/// The units of a device; refuses one that could leave a force on the hand, or that does not make these limits.
///
/// # Errors
/// What is wrong with the device, or with the limits on it.
///
/// Implements: HID-017.
pub fn check_device(capabilities: &Capabilities, limits: &Limits) -> Result<Units, Refusal> {
    let units = Units::new(capabilities).map_err(as_it_is)?;
    let (watchdog_ms, period_us) = (capabilities.watchdog_ms, capabilities.period_us);
    Refusal::state("the device reports every 0 µs, not every 1 µs or more", "")
        .when(period_us == 0)?;
    let waits_us = u32::from(watchdog_ms) * 1000;
    let found = format!("the device drops its force after {watchdog_ms} ms without a report");
    let found = format!(
        "{found}, not after more than its period of {period_us} µs and at most {LONGEST_WATCHDOG_MS} ms: \
         a blocked write would leave the force on the hand"
    );
    let is_wrong = waits_us <= u32::from(period_us) || watchdog_ms > LONGEST_WATCHDOG_MS;
    Refusal::state(found, "").when(is_wrong)?;
    let (unit, slew) = (f32::from(capabilities.force_unit_un) / 1e6, limits.slew());
    let found = format!("the device's force unit is {unit} N");
    let found = format!("{found}, above the slew limit of {slew} N");
    Refusal::state(found, "").when(unit > slew)?;
    let largest = f32::from(capabilities.largest_force_mn) / 1e3;
    let found = format!("a force limit of {} N", limits.force());
    let remedy = format!("give at most {largest} N, the device's largest force");
    Refusal::state(found, remedy).when(limits.force() > largest)?;
    Ok(units)
}

impl<'a, D: HapticDevice> Session<'a, D> {
    /// Asks the device what it is; the first cycle enables it.
    ///
    /// # Errors
    /// What is wrong with the device, or with the limits on it.
    ///
    /// Implements: HID-017.
    pub fn begin(
        mut device: D,
        table: Table<'a>,
        limits: Limits,
    ) -> Result<Session<'a, D>, Refusal> {
        let capabilities = device.capabilities().map_err(as_it_is)?;
        let units = check_device(&capabilities, &limits)?;
        Ok(Session {
            device,
            capabilities,
            units,
            table,
            limits,
            stage: Stage::Begun,
            state: State::default(),
            sequence: 0,
            counters: Counters::default(),
        })
    }

    /// The device.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// What the device said of itself.
    pub fn capabilities(&self) -> &Capabilities {
        &self.capabilities
    }

    /// What happened so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Whether there may be a force.
    pub fn mode(&self) -> Mode {
        self.state.mode
    }

    /// One cycle: waits for a report, takes the newest of the queue, steps the kernel with the
    /// `request` and writes the force. The first enables the device; after a stop none arms.
    ///
    /// # Errors
    /// [`DeviceError`], after the device was told to stop.
    ///
    /// Implements: HID-027.
    pub fn cycle(&mut self, request: Request) -> Result<Cycle, DeviceError> {
        let cycle = match self.stage {
            Stage::Begun => self.enable().and_then(|()| self.play(request)),
            Stage::Enabled => self.play(request),
            Stage::Ended | Stage::Stopped => self.play(Request::None),
        };
        if cycle.is_err() {
            // The error that counts is the first.
            let _ = self.stop();
        }
        cycle
    }

    /// Clears the device's faults and enables it, which starts its watchdog: so this is left to the
    /// first cycle, however long its thread took to prepare.
    ///
    /// Implements: HID-018.
    fn enable(&mut self) -> Result<(), DeviceError> {
        self.stage = Stage::Enabled;
        self.device.control(Control::ClearFault)?;
        self.device.control(Control::Enable)
    }

    /// Reads, steps the kernel, writes.
    ///
    /// Implements: HID-013.
    fn play(&mut self, request: Request) -> Result<Cycle, DeviceError> {
        let (position, woke) = self.newest()?;
        let received = self.device.now();
        let input = Input {
            sample: position.map(|report| self.units.sample(&report)),
            request,
        };
        let (state, command) = step(&self.table, &self.limits, self.state, input);
        self.state = state;
        self.sequence = self.sequence.wrapping_add(1);
        let force = self.units.report(&command, self.sequence);
        self.counters.missed += u64::from(state.missed > 0);
        self.counters.played += u64::from(command.playing);
        let computed = self.device.now();
        self.device.write(&force)?;
        Ok(Cycle {
            position,
            force,
            playing: command.playing,
            woke,
            received,
            computed,
            written: self.device.now(),
        })
    }

    /// Waits for a report and takes what the queue holds besides: the newest, and the time when the wait
    /// was over. Garbage ends the wait, since a cycle must not last. Counts the cycle, the reports that it
    /// passed over, and those that never came.
    ///
    /// Implements: HID-013.
    fn newest(&mut self) -> Result<(Option<PositionReport>, Duration), DeviceError> {
        let (mut newest, mut passed_over) = (None, 0);
        let mut received = self.device.read(2 * self.capabilities.period())?;
        let woke = self.device.now();
        for left in (0..QUEUE).rev() {
            match received {
                Received::Report(report) => {
                    passed_over += u64::from(newest.replace(report).is_some());
                }
                Received::Garbage(_) => self.counters.garbage += 1,
                Received::Nothing => break,
            }
            // What else has come is for the next cycle.
            if left > 0 {
                received = self.device.read(Duration::ZERO)?;
            }
        }
        self.counters.cycles += 1;
        self.counters.passed_over += passed_over;
        if let (Some(report), Some(last)) = (newest, self.state.sequence) {
            let ahead = report.sequence.wrapping_sub(last);
            if (1..=MOST_AHEAD).contains(&ahead) {
                self.counters.skipped += u64::from(ahead - 1).saturating_sub(passed_over);
            }
        }
        Ok((newest, woke))
    }

    /// Cycles until `each` says that it is enough (`false`), a fault has released the force, the device fails, or sends no position for
    /// a second before the kernel, whose watchdog is quicker, is armed; then stops the device. Arms once, as soon as the kernel allows.
    ///
    /// Implements: HID-016, HID-019, HID-024, HID-025, HID-085, HID-089.
    pub fn run(&mut self, mut each: impl FnMut(&Cycle, &Counters) -> bool) -> End {
        let mut ask = false;
        let mut heard = self.device.now();
        let end = loop {
            ask = !ask && self.mode() == Mode::Disarmed;
            let request = if ask { Request::Arm } else { Request::None };
            match self.cycle(request) {
                Err(error) => break End::Device(error),
                Ok(cycle) => {
                    let is_enough = !each(&cycle, &self.counters);
                    heard = cycle.position.map_or(heard, |_| cycle.woke);
                    let is_silent = cycle.woke.saturating_sub(heard) >= LONGEST_SILENCE;
                    match self.mode() {
                        // A fault is the cause, even if it was enough before the force was released.
                        Mode::Faulted(fault) if is_enough || self.state.force == Force::ZERO => {
                            break End::Fault(fault);
                        }
                        Mode::Disarmed if is_silent => break End::Fault(Fault::Watchdog),
                        _ if is_enough => break End::Asked,
                        _ => {}
                    }
                }
            }
        };
        match (self.stop(), end) {
            (Ok(()), end) => end,
            (Err(error), end) if error.state != DeviceState::Gone => {
                End::Unstopped(Box::new(end), error)
            }
            (Err(error), End::Asked) => End::Device(error),
            (_, end) => end,
        }
    }

    /// Stops the device: tries everything even if it fails. Once it has taken that, does nothing. No cycle
    /// arms any more, even if it has not.
    ///
    /// # Errors
    /// The first [`DeviceError`].
    ///
    /// Implements: HID-016, HID-025, HID-085.
    pub fn stop(&mut self) -> Result<(), DeviceError> {
        if self.stage == Stage::Stopped {
            return Ok(());
        }
        self.stage = Stage::Ended;
        self.state.mode = Mode::Disarmed;
        self.state.force = Force::ZERO;
        self.sequence = self.sequence.wrapping_add(1);
        let zero = ForceReport {
            sequence: self.sequence,
            ..ForceReport::default()
        };
        // First what a device takes that no longer takes forces: a blocked write would hold it up.
        let stopped = self.tried(STOP_TRIES, |device| device.control(Control::Stop));
        // Once the device is stopped, a force report is a courtesy.
        let tries = if stopped.is_ok() { 1 } else { STOP_TRIES };
        let written = self.tried(tries, |device| device.write(&zero));
        stopped.and(written)?;
        self.stage = Stage::Stopped;
        Ok(())
    }

    /// Sends until the device takes it, is gone or takes nothing in time, or was asked so many times; the last answer. Counts
    /// what was refused.
    fn tried(
        &mut self,
        tries: usize,
        send: impl Fn(&mut D) -> Result<(), DeviceError>,
    ) -> Result<(), DeviceError> {
        let mut last = Ok(());
        for _ in 0..tries {
            last = send(&mut self.device);
            let Err(error) = &last else { break };
            self.counters.stops_refused += 1;
            if matches!(error.state, DeviceState::Gone | DeviceState::Stalled) {
                break;
            }
        }
        last
    }
}

impl<D: HapticDevice> Drop for Session<'_, D> {
    /// Stops the device, also when a panic unwinds the loop.
    ///
    /// Implements: HID-085.
    fn drop(&mut self) {
        // Nobody is left to be told.
        let _ = self.stop();
    }
}
