//! One cycle: from the bytes of a position report to those of a force report.

use palpate_core::hid::{Capabilities, Control, ForceReport, PositionReport, Units};
use palpate_core::servo::{Command, Input, Limits, Request, State, Table, step};

/// What a cycle is given: a control report, of which `enable` asks to arm and `stop` to disarm, and a position report. Bytes that
/// are no report stand for none.
pub type Frame = [u8; Control::LENGTH + PositionReport::LENGTH];

/// What stays from cycle to cycle.
#[derive(Debug, Clone, Copy)]
pub struct Device<'a> {
    table: Table<'a>,
    limits: Limits,
    units: Units,
    /// The kernel's memory.
    pub state: State,
    sequence: u16,
}

impl<'a> Device<'a> {
    /// The device at rest; none if the kernel refuses its numbers.
    pub fn new(table: Table<'a>, capabilities: &Capabilities) -> Option<Device<'a>> {
        Some(Device {
            table,
            // 4 N at most, growing by 250 N/s and falling by 0.5 N a cycle; more than 20 cycles without a fresh report are a fault.
            limits: Limits::for_playback(4.0, capabilities.period_us).ok()?,
            units: Units::new(capabilities).ok()?,
            state: State::default(),
            sequence: 0,
        })
    }

    /// What the kernel is told by a frame.
    pub fn input(&self, frame: &Frame) -> Input {
        let (control, position) = frame.split_at(Control::LENGTH);
        let position = PositionReport::decode(position);
        Input {
            sample: position.ok().map(|report| self.units.sample(&report)),
            request: match Control::decode(control) {
                Ok(Control::Enable) => Request::Arm,
                Ok(Control::Stop) => Request::Disarm,
                _ => Request::None,
            },
        }
    }

    /// One step of the kernel.
    #[inline]
    pub fn step(&mut self, input: Input) -> Command {
        let (state, command) = step(&self.table, &self.limits, self.state, input);
        self.state = state;
        command
    }

    /// One cycle.
    pub fn cycle(&mut self, frame: &Frame) -> [u8; ForceReport::LENGTH] {
        let command = self.step(self.input(frame));
        assert!(
            !cfg!(feature = "planted-panic") || self.sequence < 12345,
            "planted"
        );
        self.sequence = self.sequence.wrapping_add(1);
        self.units.report(&command, self.sequence).encode()
    }
}
