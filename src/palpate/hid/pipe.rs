//! A device over a pipe: reports of the vendor profile, one after the other, from and to a bridge in any language.

use std::io::Write;
use std::ops::Range;
use std::time::{Duration, Instant};

use super::device::pass_over;
use super::{
    Capabilities, Control, DeviceError, DeviceState, ForceReport, HapticDevice, InvalidReport,
    PositionReport, Received,
};
use source::{Input, Source};

#[cfg_attr(unix, path = "pipe/unix.rs")]
#[cfg_attr(not(unix), path = "pipe/thread.rs")]
mod source;

/// Reports that wait for the loop: as many as the system keeps of a HID device.
const QUEUE: usize = 63;

/// The bytes that a pipe holds on most systems.
const PIPE: usize = 1 << 16;

/// A device that reports through `input` and is sent its forces through `output`.
///
/// Neither reading nor writing allocates. A write waits while the pipe is full. On Unix the loop itself reads, elsewhere a thread.
///
/// ```
/// use palpate::hid::pipe::PipeDevice;
/// use palpate::hid::simulated::PAPER;
/// use palpate::hid::{Control, ForceReport, HapticDevice, PositionReport, Received};
/// use std::io::Write;
/// use std::time::Duration;
///
/// let report = PositionReport { normal: -1200, sequence: 7, ..PositionReport::default() };
/// let (input, mut bridge) = std::io::pipe()?;
/// bridge.write_all(&PAPER.encode())?;
/// bridge.write_all(&report.encode())?;
/// let mut device = PipeDevice::open(input, Vec::new())?;
/// assert_eq!(device.capabilities()?, PAPER);
/// assert_eq!(device.read(Duration::from_secs(1))?, Received::Report(report));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Implements: HID-110.
pub struct PipeDevice<R, W> {
    capabilities: Capabilities,
    input: Reports<R>,
    output: W,
    opened: Instant,
}

impl<R: Input, W: Write> PipeDevice<R, W> {
    /// Waits for the bridge to say what the device is.
    ///
    /// # Errors
    /// What the input holds instead of feature report 3.
    ///
    /// Implements: HID-110, HID-112.
    pub fn open(input: R, output: W) -> Result<PipeDevice<R, W>, DeviceError> {
        let mut input = Reports::of(input);
        let bytes = loop {
            let next = input.next::<{ Capabilities::LENGTH }>(Capabilities::NUMBER, None)?;
            if let Some(bytes) = next {
                break bytes;
            }
        };
        Ok(PipeDevice {
            capabilities: Capabilities::decode(&bytes).map_err(invalid)?,
            input,
            output,
            opened: Instant::now(),
        })
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        let sent = self.output.write_all(bytes);
        let sent = sent.and_then(|()| self.output.flush());
        sent.map_err(|error| gone(format!("pipe: write: {error}")))
    }
}

fn gone(message: impl Into<String>) -> DeviceError {
    DeviceError::new(DeviceState::Gone, message)
}

fn invalid(problem: InvalidReport) -> DeviceError {
    DeviceError::new(DeviceState::There, format!("pipe: read: {problem}"))
}

/// The reports in the bytes of an input.
struct Reports<R> {
    source: Source<R>,
    /// Room for all that a pipe holds.
    bytes: Box<[u8]>,
    /// Where the bytes are that have come and were not taken.
    untaken: Range<usize>,
}

impl<R: Input> Reports<R> {
    fn of(input: R) -> Reports<R> {
        Reports {
            source: Source::new(input),
            bytes: vec![0; PIPE].into(),
            untaken: 0..0,
        }
    }

    /// The next report, of this length with its number; `None` if it does not come whole within `timeout`.
    ///
    /// Implements: HID-112.
    fn next<const LENGTH: usize>(
        &mut self,
        expected: u8,
        timeout: Option<Duration>,
    ) -> Result<Option<[u8; LENGTH]>, DeviceError> {
        let began = Instant::now();
        loop {
            let untaken = &self.bytes[self.untaken.clone()];
            if let Some(&found) = untaken.first().filter(|&&found| found != expected) {
                return Err(invalid(InvalidReport::Number { found, expected }));
            }
            if let Some(report) = untaken.first_chunk() {
                self.untaken.start += LENGTH;
                return Ok(Some(*report));
            }
            let left = timeout.map(|time| time.saturating_sub(began.elapsed()));
            if !self.fill(expected, left)? && left == Some(Duration::ZERO) {
                return Ok(None);
            }
        }
    }

    /// Reads what has come, and waits for it if nothing has; whether something came. Leaves out all positions but the newest, if a position
    /// is `expected`.
    ///
    /// Implements: HID-111, HID-112.
    fn fill(&mut self, expected: u8, timeout: Option<Duration>) -> Result<bool, DeviceError> {
        self.bytes.copy_within(self.untaken.clone(), 0);
        self.untaken = 0..self.untaken.len();
        let read = self
            .source
            .read(&mut self.bytes[self.untaken.end..], timeout);
        match read.map_err(|error| gone(format!("pipe: read: {error}")))? {
            None => Ok(false),
            Some(0) if self.untaken.is_empty() => Err(gone(
                "pipe: read: the input ended where a report must begin",
            )),
            Some(0) => Err(gone("pipe: read: the input ended within a report")),
            Some(count) => {
                self.untaken.end += count;
                if [expected, self.bytes[0]] == [PositionReport::NUMBER; 2] {
                    let whole = self.untaken.len() / PositionReport::LENGTH;
                    self.untaken.start = whole.saturating_sub(QUEUE) * PositionReport::LENGTH;
                }
                Ok(true)
            }
        }
    }
}

impl<R: Input, W: Write> HapticDevice for PipeDevice<R, W> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        Ok(self.capabilities)
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        let Some(bytes) = self
            .input
            .next::<{ PositionReport::LENGTH }>(PositionReport::NUMBER, Some(timeout))?
        else {
            return Ok(Received::Nothing);
        };
        PositionReport::decode(&bytes)
            .map(Received::Report)
            .map_err(invalid)
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.send(&report.encode())
    }

    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.send(&control.encode())?;
        match control {
            Control::Enable => pass_over(self, 2 * self.capabilities.period()),
            _ => Ok(()),
        }
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

#[cfg(test)]
mod tests;
