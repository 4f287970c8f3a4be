//! A playback session: begins with what the device says of itself, and ends with a stopped device,
//! whatever happens in between.

use std::fmt;
use std::time::Duration;

use super::{Capabilities, Control, Counters, Cycle, DeviceError, HapticDevice, Playback, Units};
use crate::force::Force;
use crate::refusal::Refusal;
use crate::servo::{Fault, Limits, Mode, Request, Table};

/// The longest that a device may go on playing a force without a report.
const LONGEST_WATCHDOG_MS: u16 = 100;

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
    playback: Playback<'a>,
    stage: Stage,
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

/// Why a session ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// It was asked to.
    Asked,
    /// The servo kernel found a fault; the force has been released.
    Fault(Fault),
    /// The device failed.
    Device(DeviceError),
    /// The end, and why stopping the device failed.
    Unstopped(Box<End>, DeviceError),
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            End::Asked => write!(f, "ended as asked"),
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

/// Refuses a device that could leave a force on the hand, or that does not make these limits.
fn check(capabilities: &Capabilities, limits: &Limits) -> Result<(), Refusal> {
    let (watchdog_ms, period_us) = (capabilities.watchdog_ms, capabilities.period_us);
    if period_us == 0 {
        let found = "the device reports every 0 µs";
        return Err(Refusal::state(found, "at least 1"));
    }
    let waits_us = u32::from(watchdog_ms) * 1000;
    if waits_us <= u32::from(period_us) || watchdog_ms > LONGEST_WATCHDOG_MS {
        return Err(Refusal::state(
            format_args!("the device drops its force after {watchdog_ms} ms without a report"),
            format!(
                "more than its period of {period_us} µs and at most {LONGEST_WATCHDOG_MS} ms: \
                 a blocked write would leave the force on the hand"
            ),
        ));
    }
    let (unit, slew) = (f32::from(capabilities.force_unit_un) / 1e6, limits.slew());
    if unit > slew {
        let found = format_args!("the device's force unit is {unit} N");
        let expected = format!("at most the slew limit of {slew} N");
        return Err(Refusal::state(found, expected));
    }
    let largest = f32::from(capabilities.largest_force_mn) / 1e3;
    if limits.force() > largest {
        let found = format_args!("a force limit of {} N", limits.force());
        let expected = format!("at most {largest} N, the device's largest force");
        return Err(Refusal::state(found, expected));
    }
    Ok(())
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
        let units = Units::new(&capabilities).map_err(as_it_is)?;
        check(&capabilities, &limits)?;
        let period = Duration::from_micros(u64::from(capabilities.period_us));
        Ok(Session {
            device,
            capabilities,
            playback: Playback::new(table, limits, units, period),
            stage: Stage::Begun,
        })
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
        self.playback.counters()
    }

    /// Whether there may be a force.
    pub fn mode(&self) -> Mode {
        self.playback.state().mode
    }

    /// One cycle: see [`Playback::cycle`].
    ///
    /// # Errors
    /// [`DeviceError`], after the device was told to stop.
    ///
    /// Implements: HID-027.
    pub fn cycle(&mut self, request: Request) -> Result<Cycle, DeviceError> {
        let (request, enabled) = match self.stage {
            Stage::Begun => (request, self.enable()),
            Stage::Enabled => (request, Ok(())),
            Stage::Ended | Stage::Stopped => (Request::None, Ok(())),
        };
        let cycle = enabled.and_then(|()| self.playback.cycle(&mut self.device, request));
        if cycle.is_err() {
            // The error that counts is the first.
            let _ = self.stop();
        }
        cycle
    }

    /// Cycles until `each` says that it is enough (`false`), a fault has released the force, or the
    /// device fails; then stops the device. Arms once, as soon as the kernel allows.
    ///
    /// Implements: HID-016, HID-019, HID-024, HID-026, HID-085, HID-087, HID-088, HID-092.
    pub fn run(&mut self, mut each: impl FnMut(&Cycle, &Counters) -> bool) -> End {
        self.run_watched(|_, cycle, counters| each(cycle, counters))
    }

    /// [`Session::run`] with a look at the device after each cycle.
    pub fn run_watched(&mut self, mut each: impl FnMut(&D, &Cycle, &Counters) -> bool) -> End {
        let mut ask = false;
        let end = loop {
            ask = !ask && self.mode() == Mode::Disarmed;
            let request = if ask { Request::Arm } else { Request::None };
            let cycle = match self.cycle(request) {
                Ok(cycle) => cycle,
                Err(error) => break End::Device(error),
            };
            let state = self.playback.state();
            if !each(&self.device, &cycle, &self.counters()) {
                break End::Asked;
            }
            if let Mode::Faulted(fault) = state.mode
                && state.force == Force::ZERO
            {
                break End::Fault(fault);
            }
        };
        match (self.stop(), end) {
            (Err(error), End::Asked) if error.is_gone() => End::Device(error),
            (Err(error), end) if !error.is_gone() => End::Unstopped(Box::new(end), error),
            (_, end) => end,
        }
    }

    /// Stops the device; once it has taken that, does nothing. No cycle arms any more, even if it has not.
    ///
    /// # Errors
    /// [`DeviceError`].
    ///
    /// Implements: HID-090.
    pub fn stop(&mut self) -> Result<(), DeviceError> {
        if self.stage != Stage::Stopped {
            self.stage = Stage::Ended;
            self.playback.stop(&mut self.device)?;
            self.stage = Stage::Stopped;
        }
        Ok(())
    }
}

impl<D: HapticDevice> Drop for Session<'_, D> {
    /// Stops the device, also when a panic unwinds the loop.
    ///
    /// Implements: HID-090.
    fn drop(&mut self) {
        // Nobody is left to be told.
        let _ = self.stop();
    }
}
