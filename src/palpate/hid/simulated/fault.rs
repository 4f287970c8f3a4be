//! What goes wrong.

use std::time::Duration;

use crate::hid::InvalidReport;

/// What can go wrong between a device and the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// The cable is pulled.
    Unplug,
    /// No report is sent for this long.
    Silence(Duration),
    /// The device takes no report for this long: a write blocks, and fails after 5.19 s.
    Stall(Duration),
    /// The device reports a fault in itself for this long.
    DeviceFault(Duration),
    /// The deadman is let go for this long.
    DeadmanReleased(Duration),
    /// A read is interrupted by a signal.
    Interrupt,
    /// This many reports repeat the sequence number of the one before.
    Repeat(u16),
    /// The sequence goes back by this much, and counts on from there.
    SequenceBack(u16),
    /// One report is garbage.
    Garbage(InvalidReport),
    /// One report has its positions off by this many counts.
    Glitch(i16),
    /// The device's clock jumps ahead: the reports of this time never come.
    ClockJump(Duration),
}
