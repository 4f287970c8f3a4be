//! How a board is connected.

use std::io;
use std::sync::Arc;

use palpate::hid::DESCRIPTOR;

use crate::uhid::Uhid;
use crate::usb::Usb;

/// Vendor and product, of the numbers that pid.codes keeps for tests.
pub const NUMBERS: [u16; 2] = [0x1209, 0x0001];

/// What a board calls itself.
pub const NAME: &str = "palpate test display";

/// What a board does when the system wants something of it.
pub trait Board {
    /// An output report came. Says when the bus may say that it did.
    fn output(&self, report: &[u8]) -> Completion;
    /// A feature report is asked for.
    fn get(&self, number: u8) -> Answer;
    /// A feature report came; whether it is one.
    fn set(&self, report: &[u8]) -> bool;
}

/// When a transfer is complete; `uhid` has no bus, and there it always is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completion {
    /// At once.
    Now,
    /// With the next frame of the bus.
    NextFrame,
    /// Never: the device does not take it.
    Never,
}

/// The answer to a question for a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// These bytes.
    Report(Vec<u8>),
    /// There is none.
    Error,
    /// None comes.
    Nothing,
}

/// The board's side of a cable.
pub trait Link: Send + Sync {
    /// Sends an input report, whatever its bytes.
    fn input(&self, report: &[u8]) -> io::Result<()>;
    /// A frame of the bus begins.
    fn frame(&self) -> io::Result<()>;
    /// Pulls the cable.
    fn unplug(&self) -> io::Result<()>;
    /// Lets `board` answer the system until the cable is pulled.
    fn serve(&self, board: &dyn Board) -> io::Result<()>;
}

/// Which kind of link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A HID device without a bus.
    Uhid,
    /// A USB device on a virtual host controller.
    Usb,
}

/// Plugs in a cable of this kind.
pub fn plug(kind: Kind, serial: &str) -> io::Result<Arc<dyn Link>> {
    Ok(match kind {
        Kind::Uhid => Arc::new(Uhid::create(NAME, serial, NUMBERS, &DESCRIPTOR)?),
        Kind::Usb => Arc::new(Usb::attach(NAME, serial, NUMBERS, &DESCRIPTOR)?),
    })
}
