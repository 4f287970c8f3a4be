//! A session in a file that can be played again to the bit.
//!
//! ```text
//! palpate-session 1
//! capabilities 0301 …            report 3, hexadecimal
//! limits 40800000 3d4ccccd …     force, slew, release as f32 bits, hexadecimal; watchdog
//! 1 received_us written_us position force playing
//! ```
//! One line a cycle: position and force are the reports' bytes in hexadecimal, `-` for no position.

use std::fmt::Write;

use super::{
    Capabilities, Control, Cycle, DeviceError, End, ForceReport, HapticDevice, PositionReport,
    Received, Session, SessionError,
};
use crate::servo::{Limits, Table};
use std::time::Duration;

/// First line of the file.
const HEADER: &str = "palpate-session 1";

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
///
/// ```
#[doc = include_str!("simulated/probing.example")]
/// use palpate::hid::{RecordedCycle, Session};
/// use palpate::servo::Request;
///
/// let mut session = Session::begin(device, table, limits)?;
/// let recorded = RecordedCycle::from(&session.cycle(Request::None)?);
/// assert_eq!((recorded.written_us, recorded.playing), (1000, false)); // the device reports every millisecond
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// Why a text is no recording, or does not play again.
///
/// ```
/// use palpate::hid::{Recording, RecordingError};
///
/// let error = Recording::parse("palpate-session 2").unwrap_err();
/// assert!(matches!(error, RecordingError::Line { line: 1, .. }));
/// assert_eq!(error.to_string(), r#"line 1: "palpate-session 2", expected palpate-session 1"#);
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// A line can not be read.
    #[error("line {line}: {found:?}, expected {expected}")]
    Line {
        /// Which line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What would be right.
        expected: &'static str,
    },
    /// The device of the recording is refused.
    #[error("{0}")]
    Session(#[from] SessionError),
    /// The same positions gave another force report.
    #[error(
        "cycle {cycle}: the recording has the force {}, and this table and program give {}",
        shown(*recorded), shown(*found)
    )]
    Differs {
        /// Which cycle, from 0.
        cycle: usize,
        /// As recorded: the report, and whether it followed the table.
        recorded: (ForceReport, bool),
        /// As played again.
        found: (ForceReport, bool),
    },
    /// The recording goes on after what ends a session.
    #[error("{recorded} cycles, but these positions end the session after {cycles}: {end}")]
    Ends {
        /// Cycles of the recording.
        recorded: usize,
        /// Cycles of the session.
        cycles: usize,
        /// Why it ends.
        end: End,
    },
}

fn shown((force, playing): (ForceReport, bool)) -> String {
    format!(
        "({}, {}) with number {}, flags {}, {}",
        force.lateral,
        force.normal,
        force.sequence,
        force.flags,
        if playing { "playing" } else { "not playing" }
    )
}

impl Recording {
    /// The text of the file.
    ///
    /// ```
    /// use palpate::hid::{Recording, simulated::PAPER};
    /// use palpate::servo::Limits;
    ///
    /// let limits = Limits::new(2.0, 0.05, 0.25, 10)?;
    /// let text = Recording { capabilities: PAPER, limits, cycles: vec![] }.to_text();
    /// assert_eq!(text.lines().last(), Some("limits 40000000 3d4ccccd 3e800000 10"));
    /// # Ok::<(), palpate::servo::InvalidLimits>(())
    /// ```
    ///
    /// Implements: HID-050.
    pub fn to_text(&self) -> String {
        let hex = |bytes: &[u8]| {
            bytes.iter().fold(String::new(), |mut text, byte| {
                let _ = write!(text, "{byte:02x}"); // a String takes everything
                text
            })
        };
        let limits = &self.limits;
        let bits = [limits.force(), limits.slew(), limits.release()].map(f32::to_bits);
        let mut text = format!(
            "{HEADER}\ncapabilities {}\nlimits {:08x} {:08x} {:08x} {}\n",
            hex(&self.capabilities.encode()),
            bits[0],
            bits[1],
            bits[2],
            limits.watchdog()
        );
        for cycle in &self.cycles {
            let position = cycle
                .position
                .map_or("-".into(), |report| hex(&report.encode()));
            let _ = writeln!(
                text,
                "{} {} {position} {} {}",
                cycle.received_us,
                cycle.written_us,
                hex(&cycle.force.encode()),
                u8::from(cycle.playing)
            );
        }
        text
    }

    /// Reads the text of a file.
    ///
    /// ```
    /// use palpate::hid::Recording;
    ///
    /// let text = "palpate-session 1\n\
    ///     capabilities 030100e803f401401fe8030f0058028c00\n\
    ///     limits 40000000 3d4ccccd 3e800000 10\n\
    ///     1000 1000 - 0200000000010001 0\n";
    /// let recording = Recording::parse(text)?;
    /// assert_eq!((recording.limits.force(), recording.cycles.len()), (2.0, 1));
    /// assert_eq!(recording.cycles[0].position, None);
    /// # Ok::<(), palpate::hid::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordingError::Line`].
    ///
    /// Implements: HID-050, HID-051.
    pub fn parse(text: &str) -> Result<Recording, RecordingError> {
        let mut lines = text.lines().enumerate();
        let mut next = |expected| {
            let missing = (text.lines().count(), "");
            let (at, found) = lines.next().unwrap_or(missing);
            (found, move || RecordingError::Line {
                line: at + 1,
                found: found.chars().take(80).collect(),
                expected,
            })
        };
        let (line, wrong) = next("palpate-session 1");
        if line != HEADER {
            return Err(wrong());
        }
        let (line, wrong) = next("capabilities and 17 bytes in hexadecimal");
        let capabilities = line
            .strip_prefix("capabilities ")
            .and_then(bytes)
            .and_then(|bytes| Capabilities::decode(&bytes).ok())
            .ok_or_else(wrong)?;
        let (line, wrong) = next("limits, three f32 in hexadecimal and the watchdog's cycles");
        let limits = limits(line).ok_or_else(wrong)?;
        let cycles = lines.map(|(at, line)| {
            recorded_cycle(line).ok_or_else(|| RecordingError::Line {
                line: at + 1,
                found: line.chars().take(80).collect(),
                expected: "two times in µs, a position report or -, a force report, 0 or 1",
            })
        });
        Ok(Recording {
            capabilities,
            limits,
            cycles: cycles.collect::<Result<_, _>>()?,
        })
    }

    /// Plays the recorded positions again, on `table`; the number of cycles, whose forces were all
    /// the same to the bit.
    ///
    /// ```
    #[doc = include_str!("simulated/probing.example")]
    /// use palpate::hid::{Recording, RecordingError};
    ///
    /// let text = "palpate-session 1\n\
    ///     capabilities 030100e803f401401fe8030f0058028c00\n\
    ///     limits 40000000 3d4ccccd 3e800000 10\n\
    ///     1000 1000 - 0200000500010001 0\n";
    /// // A force of 5 counts, where no report of the device had come yet.
    /// let replayed = Recording::parse(text)?.replay(table);
    /// assert!(matches!(replayed, Err(RecordingError::Differs { cycle: 0, .. })));
    /// # Ok::<(), RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordingError::Differs`], [`RecordingError::Session`].
    ///
    /// Implements: HID-052, HID-056.
    pub fn replay(&self, table: Table) -> Result<usize, RecordingError> {
        let device = Recorded {
            recording: self,
            cycle: 0,
            given: false,
        };
        let mut session = Session::begin(device, table, self.limits)?;
        let mut at = 0;
        let mut difference = None;
        if self.cycles.is_empty() {
            return Ok(0);
        }
        let end = session.run(|cycle, _| {
            let recorded = &self.cycles[at];
            let found = (cycle.force, cycle.playing);
            let recorded = (recorded.force, recorded.playing);
            if found != recorded {
                difference = Some(RecordingError::Differs {
                    cycle: at,
                    recorded,
                    found,
                });
            }
            at += 1;
            difference.is_none() && at < self.cycles.len()
        });
        match difference {
            Some(difference) => Err(difference),
            None if at < self.cycles.len() => Err(RecordingError::Ends {
                recorded: self.cycles.len(),
                cycles: at,
                end,
            }),
            None => Ok(at),
        }
    }
}

/// The bytes of a hexadecimal text.
fn bytes(text: &str) -> Option<Vec<u8>> {
    if !text.len().is_multiple_of(2) || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let pair = |at| u8::from_str_radix(text.get(at..at + 2)?, 16).ok();
    (0..text.len()).step_by(2).map(pair).collect()
}

fn limits(line: &str) -> Option<Limits> {
    let mut fields = line.strip_prefix("limits ")?.split(' ');
    let mut force = || {
        let bits = u32::from_str_radix(fields.next()?, 16).ok()?;
        Some(f32::from_bits(bits))
    };
    let (force, slew, release) = (force()?, force()?, force()?);
    let watchdog = fields.next()?.parse().ok()?;
    let limits = Limits::new(force, slew, release, watchdog).ok()?;
    fields.next().is_none().then_some(limits)
}

fn recorded_cycle(line: &str) -> Option<RecordedCycle> {
    let fields: Vec<&str> = line.split(' ').collect();
    let &[received, written, position, force, playing] = &fields[..] else {
        return None;
    };
    let position = match position {
        "-" => None,
        text => Some(PositionReport::decode(&bytes(text)?).ok()?),
    };
    Some(RecordedCycle {
        received_us: received.parse().ok()?,
        written_us: written.parse().ok()?,
        position,
        force: ForceReport::decode(&bytes(force)?).ok()?,
        playing: match playing {
            "0" => false,
            "1" => true,
            _ => return None,
        },
    })
}

/// A device that reports what was recorded.
struct Recorded<'a> {
    recording: &'a Recording,
    cycle: usize,
    given: bool,
}

impl HapticDevice for Recorded<'_> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        Ok(self.recording.capabilities)
    }

    fn read(&mut self, _: Duration) -> Result<Received, DeviceError> {
        let cycle = self.recording.cycles.get(self.cycle);
        let cycle = cycle.ok_or(DeviceError::Gone)?;
        match cycle.position {
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
        let cycle = self.recording.cycles.get(self.cycle);
        Duration::from_micros(cycle.map_or(0, |cycle| cycle.received_us))
    }
}

#[cfg(test)]
mod tests;
