//! A device over a pipe: reports of the vendor profile, one after the other, from and to a bridge in any language.

use std::io::{Error, ErrorKind, Read, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use super::device::pass_over;
use super::{
    Capabilities, Control, DeviceError, DeviceState, ForceReport, HapticDevice, InvalidReport,
    PositionReport, Received,
};

/// Reports that wait for the loop: as many as the system keeps of a HID device.
const QUEUE: usize = 63;

/// What the input brings: reports, and at last why it brings no more.
type Brought = Result<PositionReport, DeviceError>;

/// A device that reports through `input` and is sent its forces through `output`.
///
/// Neither reading nor writing allocates. A write waits while the pipe is full.
///
/// ```
/// use palpate::hid::pipe::PipeDevice;
/// use palpate::hid::simulated::PAPER;
/// use palpate::hid::{Control, ForceReport, HapticDevice, PositionReport, Received};
/// use std::time::Duration;
///
/// let report = PositionReport { normal: -1200, sequence: 7, ..PositionReport::default() };
/// let sent = [&PAPER.encode()[..], &report.encode()].concat();
/// let mut device = PipeDevice::open(std::io::Cursor::new(sent), Vec::new())?;
/// assert_eq!(device.capabilities()?, PAPER);
/// # Ok::<(), palpate::hid::DeviceError>(())
/// ```
///
/// Implements: HID-110.
pub struct PipeDevice<R, W> {
    capabilities: Capabilities,
    /// The input until the device is enabled, and where its reports will go.
    unread: Option<(R, SyncSender<Brought>)>,
    reports: Receiver<Brought>,
    output: W,
    opened: Instant,
}

impl<R: Read, W: Write> PipeDevice<R, W> {
    /// Waits for the bridge to say what the device is.
    ///
    /// # Errors
    /// What the input holds instead of feature report 3.
    ///
    /// Implements: HID-110, HID-112.
    pub fn open(mut input: R, output: W) -> Result<PipeDevice<R, W>, DeviceError> {
        let bytes = report::<{ Capabilities::LENGTH }>(&mut input, Capabilities::NUMBER)?;
        let capabilities = Capabilities::decode(&bytes).map_err(invalid)?;
        let (sender, reports) = sync_channel(QUEUE);
        Ok(PipeDevice {
            capabilities,
            unread: Some((input, sender)),
            reports,
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

/// The next report, of this length with its number.
///
/// Implements: HID-112.
fn report<const LENGTH: usize>(
    input: &mut impl Read,
    expected: u8,
) -> Result<[u8; LENGTH], DeviceError> {
    let failed = |ended: &str, error: Error| match error.kind() {
        ErrorKind::UnexpectedEof => gone(format!("pipe: read: the input ended {ended}")),
        _ => gone(format!("pipe: read: {error}")),
    };
    let mut bytes = [0; LENGTH];
    let (first, rest) = bytes.split_at_mut(1);
    let read = input.read_exact(first);
    read.map_err(|error| failed("where a report must begin", error))?;
    let found = first[0];
    if found != expected {
        return Err(invalid(InvalidReport::Number { found, expected }));
    }
    let read = input.read_exact(rest);
    read.map_err(|error| failed("within a report", error))?;
    Ok(bytes)
}

/// Passes on the reports of `input` until it ends or nobody waits for them any more.
///
/// Implements: HID-111, HID-112.
fn pass_on(mut input: impl Read, reports: &SyncSender<Brought>) {
    loop {
        let bytes = report::<{ PositionReport::LENGTH }>(&mut input, PositionReport::NUMBER);
        let brought = bytes.and_then(|bytes| PositionReport::decode(&bytes).map_err(invalid));
        if brought.is_err() {
            // If nobody waits for it, nobody needs it.
            let _ = reports.send(brought);
            return;
        }
        if let Err(TrySendError::Disconnected(_)) = reports.try_send(brought) {
            return;
        }
    }
}

impl<R: Read + Send + 'static, W: Write> HapticDevice for PipeDevice<R, W> {
    fn capabilities(&mut self) -> Result<Capabilities, DeviceError> {
        Ok(self.capabilities)
    }

    fn read(&mut self, timeout: Duration) -> Result<Received, DeviceError> {
        match self.reports.recv_timeout(timeout) {
            Ok(brought) => brought.map(Received::Report),
            Err(RecvTimeoutError::Timeout) => Ok(Received::Nothing),
            Err(RecvTimeoutError::Disconnected) => Err(gone("pipe: read: the input has ended")),
        }
    }

    fn write(&mut self, report: &ForceReport) -> Result<(), DeviceError> {
        self.send(&report.encode())
    }

    /// Enabling begins to read, in a thread that has the priority of the caller's where the system passes it on (Linux, macOS).
    fn control(&mut self, control: Control) -> Result<(), DeviceError> {
        self.send(&control.encode())?;
        if control != Control::Enable {
            return Ok(());
        }
        if let Some((input, reports)) = self.unread.take() {
            let reader = Builder::new().spawn(move || pass_on(input, &reports));
            reader.map_err(|error| gone(format!("pipe: read: {error}")))?;
        }
        let time = 2 * self.capabilities.period();
        pass_over(self, time)
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

#[cfg(test)]
mod tests;
