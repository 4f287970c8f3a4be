//! A session in a file that can be played again to the bit: lines of JSON.
//!
//! ```text
//! {"format":"palpate-session 2","capabilities":{"version":1,…},"limits":{"force_n":2.0,…}}
//! {"received_us":1000,"written_us":1000,"position":{"lateral":0,…},"force":{"lateral":0,…},"playing":false}
//! ```
//! The first line says what was played on, each of the others what a cycle did; a cycle without a report has the
//! position `null`. Reports have the fields of `report.rs`.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{
    Capabilities, Control, Cycle, DeviceError, DeviceState, ForceReport, HapticDevice,
    PositionReport, Received, Session,
};
use crate::file::message;
use crate::journal::line;
use crate::refusal::{Refusal, shortened};
use crate::servo::{Limits, Table};

/// The first line of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    format: Format,
    capabilities: Capabilities,
    limits: Within,
}

#[derive(Serialize, Deserialize)]
enum Format {
    #[serde(rename = "palpate-session 2")]
    Second,
}

/// The limits of a session: each f32 is written so that it reads back to the same bits.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Within {
    force_n: f32,
    slew_n: f32,
    release_n: f32,
    watchdog_cycles: u16,
}

/// A recorded session.
///
/// ```
#[doc = include_str!("simulated/probing.example")]
/// use palpate::hid::{RecordedCycle, Recording, Session};
///
/// let mut cycles = Vec::new();
/// Session::begin(device, table, limits)?.run(|cycle, _| {
///     cycles.push(RecordedCycle::from(cycle));
///     cycles.len() < 600
/// });
/// let recording = Recording { capabilities: PAPER, limits, cycles };
/// assert!(recording.cycles[599].playing);
///
/// let read = Recording::parse(&recording.to_text())?;
/// assert_eq!(read, recording);
/// assert_eq!(read.replay(table), Ok(600)); // every force the same to the bit
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What the device said of itself.
    pub capabilities: Capabilities,
    /// The limits that it was played within.
    pub limits: Limits,
    /// What each cycle did.
    pub cycles: Vec<RecordedCycle>,
}

/// What a cycle took and gave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedCycle {
    /// When the queue was drained, on the device's clock, µs.
    pub received_us: u64,
    /// When the force was written, µs.
    pub written_us: u64,
    /// The report that it used.
    pub position: Option<PositionReport>,
    /// The report that it sent.
    pub force: ForceReport,
    /// The force followed the table.
    pub playing: bool,
}

impl From<&Cycle> for RecordedCycle {
    fn from(cycle: &Cycle) -> RecordedCycle {
        RecordedCycle {
            received_us: cycle.received.as_micros() as u64,
            written_us: cycle.written.as_micros() as u64,
            position: cycle.position,
            force: cycle.force,
            playing: cycle.playing,
        }
    }
}

fn shown(force: &ForceReport, playing: bool) -> String {
    let playing = if playing { "playing" } else { "not playing" };
    let (lateral, normal) = (force.lateral, force.normal);
    let (number, flags) = (force.sequence, force.flags);
    format!("({lateral}, {normal}) with number {number}, flags {flags}, {playing}")
}

impl Recording {
    /// The text of the file.
    ///
    /// Implements: HID-050.
    pub fn to_text(&self) -> String {
        let header = Header {
            format: Format::Second,
            capabilities: self.capabilities,
            limits: Within {
                force_n: self.limits.force(),
                slew_n: self.limits.slew(),
                release_n: self.limits.release(),
                watchdog_cycles: self.limits.watchdog(),
            },
        };
        let mut text = line(&header);
        text.extend(self.cycles.iter().map(line));
        text
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// The line that cannot be read, what stands there, and what would be right.
    ///
    /// Implements: HID-050.
    pub fn parse(text: &str) -> Result<Recording, Refusal> {
        let mut lines = (1..).zip(text.lines());
        let (at, first) = lines.next().unwrap_or((1, ""));
        let what = "a recording that begins with format, capabilities and limits";
        let header: Header = read(at, first, what)?;
        let of = &header.limits;
        let limits = Limits::new(of.force_n, of.slew_n, of.release_n, of.watchdog_cycles);
        let what = "the times, position, force and playing of a cycle";
        let cycles = lines.map(|(at, line)| read(at, line, what));
        Ok(Recording {
            capabilities: header.capabilities,
            limits: limits.map_err(|error| refused(at, first, &error.to_string()))?,
            cycles: cycles.collect::<Result<_, _>>()?,
        })
    }

    /// Plays the recorded positions again, on `table`; the number of cycles, whose forces were all
    /// the same to the bit.
    ///
    /// # Errors
    /// No cycle that played the table; the first cycle with another force report; cycles after those that end the session; a device that
    /// [`Session::begin`] refuses.
    ///
    /// Implements: HID-052.
    pub fn replay(&self, table: Table) -> Result<usize, Refusal> {
        let mut session = Session::begin(Recorded::new(self), table, self.limits)?;
        let recorded = self.cycles.len();
        // Forces that no table gave say nothing of this one.
        let is_none_played = self.cycles.iter().all(|cycle| !cycle.playing);
        let nothing = format!("{recorded} cycles, of which none played the table");
        Refusal::state(nothing, "record a session that does").when(is_none_played)?;
        let (mut same, mut difference) = (0, None);
        let end = session.run(|cycle, _| {
            let recorded = &self.cycles[same];
            if (cycle.force, cycle.playing) == (recorded.force, recorded.playing) {
                same += 1;
                return same < self.cycles.len();
            }
            difference = Some(format!(
                "cycle {same}: the recording has the force {}, and this table and program give {}",
                shown(&recorded.force, recorded.playing),
                shown(&cycle.force, cycle.playing)
            ));
            false
        });
        if same == recorded {
            return Ok(same);
        }
        let early = || {
            format!("{recorded} cycles, but these positions end the session after {same}: {end}")
        };
        Err(Refusal::state(difference.unwrap_or_else(early), ""))
    }
}

/// Reads a line of JSON; `what` it should be.
fn read<'a, T: Deserialize<'a>>(at: usize, line: &'a str, what: &str) -> Result<T, Refusal> {
    serde_json::from_str(line)
        .map_err(|error| refused(at, line, &format!("give {what}: {}", message(&error))))
}

fn refused(at: usize, line: &str, why: &str) -> Refusal {
    Refusal::state(format_args!("{:?}", shortened(line)), why).at(at)
}

/// A device that reports what was recorded.
struct Recorded<'a> {
    recording: &'a Recording,
    cycle: usize,
    given: bool,
}

impl<'a> Recorded<'a> {
    fn new(recording: &'a Recording) -> Recorded<'a> {
        Recorded {
            recording,
            cycle: 0,
            given: false,
        }
    }

    /// The cycle that is played.
    fn now_played(&self) -> Option<&'a RecordedCycle> {
        self.recording.cycles.get(self.cycle)
    }
}

impl HapticDevice for Recorded<'_> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        Ok(self.recording.capabilities)
    }

    fn read(&mut self, _: Duration) -> Result<Received, DeviceError> {
        let over = || DeviceError::new(DeviceState::Gone, "the recording is over");
        match self.now_played().ok_or_else(over)?.position {
            Some(report) if !std::mem::replace(&mut self.given, true) => {
                Ok(Received::Report(report))
            }
            _ => Ok(Received::Nothing),
        }
    }

    fn write(&mut self, _: &ForceReport) -> Result<(), DeviceError> {
        self.cycle += 1;
        self.given = false;
        Ok(())
    }

    fn control(&mut self, _: Control) -> Result<(), DeviceError> {
        Ok(())
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.now_played().map_or(0, |cycle| cycle.received_us))
    }
}

#[cfg(test)]
mod tests;
