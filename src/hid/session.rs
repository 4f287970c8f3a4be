//! A playback session: begins with what the device says of itself, and ends with a stopped device,
//! whatever happens in between.

use std::fmt;
use std::time::Duration;

use super::{
    Capabilities, Control, Counters, Cycle, DeviceError, HapticDevice, InvalidCapabilities,
    Playback, Units,
};
use crate::servo::{Fault, Force, Limits, Mode, Request, Table};

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
/// # Ok::<(), palpate::hid::SessionError>(())
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

/// Why a session does not begin.
///
/// ```
#[doc = include_str!("simulated/probing.example")]
/// use palpate::hid::{Session, SessionError};
///
/// let strong = Limits::new(10.0, 0.05, 1.0, 10).expect("limits");
/// let refused = Session::begin(device, table, strong).err();
/// assert_eq!(refused, Some(SessionError::Force { limit: 10.0, largest: 8.0 }));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SessionError {
    /// The device fails.
    #[error("{0}")]
    Device(#[from] DeviceError),
    /// The device's numbers have no meaning.
    #[error("{0}")]
    Capabilities(#[from] InvalidCapabilities),
    /// The device says that it reports without end.
    #[error("the device reports every 0 µs, expected at least 1")]
    Period,
    /// The device has no watchdog of its own, one that does not wait for the next force, or one that waits too long.
    #[error(
        "the device drops its force after {watchdog_ms} ms without a report, expected more than its period of {period_us} µs \
         and at most {LONGEST_WATCHDOG_MS} ms: a blocked write would leave the force on the hand"
    )]
    Watchdog {
        /// The device's watchdog, ms; 0 for none.
        watchdog_ms: u16,
        /// Its period, µs.
        period_us: u16,
    },
    /// A count of the device's force is more than the force may change in a cycle.
    #[error("the device's force unit is {unit} N, expected at most the slew limit of {slew} N")]
    Coarse {
        /// The device's force unit, N.
        unit: f32,
        /// The slew limit, N a cycle.
        slew: f32,
    },
    /// The force limit exceeds what the device makes.
    #[error("a force limit of {limit} N, expected at most {largest} N, the device's largest force")]
    Force {
        /// The limit, N.
        limit: f32,
        /// The device's largest force, N.
        largest: f32,
    },
}

/// Why a session ended.
///
/// ```
/// use palpate::hid::End;
/// use palpate::servo::Fault;
///
/// let end = End::Fault(Fault::Watchdog);
/// assert_eq!(end.to_string(), "stopped by a fault: no fresh report for too long");
/// ```
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

impl<'a, D: HapticDevice> Session<'a, D> {
    /// Asks the device what it is; the first cycle enables it.
    ///
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// use palpate::hid::{Capabilities, Session, SessionError};
    ///
    /// let alone = Capabilities { watchdog_ms: 0, ..PAPER };
    /// let trajectory = Trajectory::new(vec![]);
    /// let device = SimulatedDevice::new(alone, Mechanics::PAPER, trajectory, Duration::ZERO, vec![]);
    /// let refused = SessionError::Watchdog { watchdog_ms: 0, period_us: 1000 };
    /// assert_eq!(Session::begin(device, table, limits).err(), Some(refused));
    /// ```
    ///
    /// # Errors
    /// [`SessionError`].
    ///
    /// Implements: HID-017.
    pub fn begin(
        mut device: D,
        table: Table<'a>,
        limits: Limits,
    ) -> Result<Session<'a, D>, SessionError> {
        let capabilities = device.capabilities()?;
        let units = Units::new(&capabilities)?;
        if capabilities.period_us == 0 {
            return Err(SessionError::Period);
        }
        let (watchdog_ms, period_us) = (capabilities.watchdog_ms, capabilities.period_us);
        let waits_us = u32::from(watchdog_ms) * 1000;
        if waits_us <= u32::from(period_us) || watchdog_ms > LONGEST_WATCHDOG_MS {
            return Err(SessionError::Watchdog {
                watchdog_ms,
                period_us,
            });
        }
        let (unit, slew) = (f32::from(capabilities.force_unit_un) / 1e6, limits.slew());
        if unit > slew {
            return Err(SessionError::Coarse { unit, slew });
        }
        let largest = f32::from(capabilities.largest_force_mn) / 1e3;
        let limit = limits.force();
        if limit > largest {
            return Err(SessionError::Force { limit, largest });
        }
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
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// use palpate::hid::Session;
    /// use palpate::servo::Request;
    ///
    /// let mut session = Session::begin(device, table, limits)?;
    /// let cycle = session.cycle(Request::None)?;
    /// // A millimetre above the surface, in counts of 1 µm.
    /// assert_eq!(cycle.position.map(|report| report.normal), Some(1000));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// use palpate::hid::{End, Session};
    ///
    /// let mut session = Session::begin(device, table, limits)?;
    /// let mut largest = 0;
    /// let end = session.run(|cycle, counters| {
    ///     largest = largest.max(cycle.force.normal);
    ///     counters.cycles < 800
    /// });
    /// // A hand of 500 N/m wants 4 mm against 400 N/m: 0.89 N, or 1778 counts of 0.5 mN. Friction and
    /// // backlash hold it back by 134 counts at most.
    /// assert!(end == End::Asked && (1644..=1778).contains(&largest));
    /// # Ok::<(), palpate::hid::SessionError>(())
    /// ```
    ///
    /// Implements: HID-016, HID-019, HID-024, HID-026, HID-085, HID-087, HID-088, HID-092.
    pub fn run(&mut self, mut each: impl FnMut(&Cycle, &Counters) -> bool) -> End {
        self.run_watched(|_, cycle, counters| each(cycle, counters))
    }

    /// [`Session::run`] with a look at the device after each cycle.
    ///
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// use palpate::hid::Session;
    ///
    /// let mut session = Session::begin(device, table, limits)?;
    /// session.run_watched(|device, _, _| !device.finished());
    /// assert!(session.counters().cycles > 1900);
    /// # Ok::<(), palpate::hid::SessionError>(())
    /// ```
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
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// # use palpate::hid::Session;
    /// # use palpate::servo::Request;
    /// let mut session = Session::begin(device, table, limits)?;
    /// session.cycle(Request::None)?;
    /// assert_eq!((session.stop(), session.stop()), (Ok(()), Ok(())));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
