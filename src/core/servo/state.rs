//! What a cycle is given, remembers and commands.

use core::fmt;

use super::Force;

/// One report of the device.
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

/// What the program that runs the loop asks of the kernel in a cycle.
#[repr(u8)]
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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// The newest report, if one came.
    pub sample: Option<Sample>,
    /// What is asked for.
    pub request: Request,
}

/// Why there is no force.
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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Whether there may be a force.
    pub mode: Mode,
    /// The last command, N.
    pub force: Force<f32>,
    /// The sequence number of the last sample taken over.
    pub sequence: Option<u16>,
    /// Cycles since the last fresh sample.
    pub missed: u16,
    /// The last cycle had a request to arm.
    pub arming: bool,
}

/// What one cycle tells the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// The force to play, N.
    pub force: Force<f32>,
    /// The force follows the table; otherwise it is on its way to zero.
    pub playing: bool,
}
