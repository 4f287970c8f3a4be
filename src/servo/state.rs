//! What a cycle is given, remembers and commands.

use core::fmt;

/// A force on the probe, N: lateral along +x, normal positive out of the gel.
///
/// ```
/// use palpate::servo::Force;
///
/// let up = Force { normal: 1.5, ..Force::ZERO };
/// assert_eq!(up.lateral, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force {
    /// Along +x.
    pub lateral: f32,
    /// Out of the gel.
    pub normal: f32,
}

impl Force {
    /// No force.
    pub const ZERO: Force = Force {
        lateral: 0.0,
        normal: 0.0,
    };
}

/// One report of the device.
///
/// ```
/// use palpate::servo::{Input, Request, Sample};
///
/// // 2 mm deep and 1 mm left of the middle, in a hand that holds on.
/// let sample = Sample { sequence: 7, deadman: true, device_fault: false, depth: 2e-3, lateral: -1e-3 };
/// let input = Input { sample: Some(sample), ..Input::default() };
/// assert_eq!(input.request, Request::None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its number, modulo 65536.
    pub sequence: u16,
    /// The deadman switch is held.
    pub deadman: bool,
    /// The device says that something is wrong with it.
    pub device_fault: bool,
    /// Depth of the probe, m.
    pub depth: f32,
    /// Lateral position of the probe, m.
    pub lateral: f32,
}

/// What the person at the controls asks for.
///
/// ```
/// # use palpate::servo::{Axis, Force, Input, Limits, Mode, Request, Sample, State, Table, step};
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let table = Table::new(axis, axis, &[Force::ZERO; 4]).expect("a table");
/// # let limits = Limits::new(2.0, 0.05, 0.2, 10).expect("limits");
/// let arm = Input { request: Request::Arm, ..Input::default() };
/// // Without a fresh sample, asking is not enough.
/// let (state, _) = step(&table, &limits, State::default(), arm);
/// assert_eq!(state.mode, Mode::Disarmed);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Request {
    /// Nothing.
    #[default]
    None,
    /// To arm, also after a fault.
    Arm,
    /// To disarm.
    Disarm,
}

/// What happened since the last cycle.
///
/// ```
/// # use palpate::servo::{Axis, Force, Input, Limits, State, Table, step};
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let table = Table::new(axis, axis, &[Force::ZERO; 4]).expect("a table");
/// # let limits = Limits::new(2.0, 0.05, 0.2, 10).expect("limits");
/// // Nothing came and nothing is asked for.
/// let (state, command) = step(&table, &limits, State::default(), Input::default());
/// assert_eq!((state.missed, command.force), (1, Force::ZERO));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// The newest report, if one came.
    pub sample: Option<Sample>,
    /// What is asked for.
    pub request: Request,
}

/// Why there is no force.
///
/// ```
/// # use palpate::servo::{Axis, Fault, Force, Input, Limits, Mode, Request, Sample, State, Table, step};
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let table = Table::new(axis, axis, &[Force::ZERO; 4]).expect("a table");
/// # let limits = Limits::new(2.0, 0.05, 0.2, 10).expect("limits");
/// let sample = Sample { sequence: 1, deadman: true, device_fault: false, depth: f32::NAN, lateral: 0.0 };
/// let input = Input { sample: Some(sample), request: Request::None };
/// let (state, _) = step(&table, &limits, State::default(), input);
/// assert_eq!(state.mode, Mode::Faulted(Fault::NotFinite));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A position that is NaN or infinite.
    NotFinite,
    /// The device reported a fault.
    Device,
    /// Too many cycles without a fresh sample.
    Watchdog,
    /// A state that no step can have left: memory was overwritten.
    State,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Fault::NotFinite => "a position is not a finite number",
            Fault::Device => "the device reports a fault",
            Fault::Watchdog => "no fresh report for too long",
            Fault::State => "the servo's memory was overwritten",
        })
    }
}

/// Whether there may be a force.
///
/// ```
/// use palpate::servo::{Fault, Mode, State};
///
/// assert_eq!(State::default().mode, Mode::Disarmed);
/// let message = match Mode::Faulted(Fault::Device) {
///     Mode::Faulted(fault) => fault.to_string(),
///     _ => unreachable!(),
/// };
/// assert_eq!(message, "the device reports a fault");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Not yet.
    #[default]
    Disarmed,
    /// Yes, while the deadman is held and samples are fresh.
    Armed,
    /// Not until it is armed again.
    Faulted(Fault),
}

/// What one cycle leaves to the next. The default is the state to begin with.
///
/// ```
/// # use palpate::servo::{Axis, Fault, Force, Input, Limits, Mode, State, Table, step};
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let table = Table::new(axis, axis, &[Force::ZERO; 4]).expect("a table");
/// # let limits = Limits::new(2.0, 0.05, 0.2, 10).expect("limits");
/// let armed = State { mode: Mode::Armed, missed: 10, ..State::default() };
/// // The eleventh cycle without a report is one more than these limits allow.
/// let (state, _) = step(&table, &limits, armed, Input::default());
/// assert_eq!(state.mode, Mode::Faulted(Fault::Watchdog));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Whether there may be a force.
    pub mode: Mode,
    /// The last command, N.
    pub force: Force,
    /// The sequence number of the last sample taken over.
    pub sequence: Option<u16>,
    /// Cycles since the last fresh sample.
    pub missed: u16,
    /// The last cycle had a request to arm.
    pub arming: bool,
}

/// What one cycle tells the device.
///
/// ```
/// # use palpate::servo::{Axis, Command, Force, Input, Limits, Mode, Request, Sample, State, Table, step};
/// # let axis = Axis::new(&[0.0, 0.5], &[2.0]).expect("an axis");
/// # let table = Table::new(axis, axis, &[Force::ZERO; 4]).expect("a table");
/// # let limits = Limits::new(2.0, 0.05, 0.25, 10).expect("limits");
/// let pressed = Force { lateral: 0.0, normal: 1.0 };
/// let state = State { mode: Mode::Armed, force: pressed, sequence: Some(1), ..State::default() };
/// // The deadman is let go: the force is released, as quickly as the limits allow.
/// let sample = Sample { sequence: 2, deadman: false, device_fault: false, depth: 0.1, lateral: 0.0 };
/// let (_, command) = step(&table, &limits, state, Input { sample: Some(sample), request: Request::None });
/// assert_eq!(command, Command { force: Force { normal: 0.75, ..pressed }, playing: false });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// The force to play, N.
    pub force: Force,
    /// The force follows the table; otherwise it is on its way to zero.
    pub playing: bool,
}
