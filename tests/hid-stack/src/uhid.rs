//! A HID device made by a program: Linux' `/dev/uhid` (`linux/uhid.h`), whose messages are packed structures
//! that begin with their type.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};

const DESTROY: u32 = 1;
const START: u32 = 2;
const STOP: u32 = 3;
const OPEN: u32 = 4;
const CLOSE: u32 = 5;
const OUTPUT: u32 = 6;
const GET_REPORT: u32 = 9;
const GET_REPORT_REPLY: u32 = 10;
const CREATE2: u32 = 11;
const INPUT2: u32 = 12;
const SET_REPORT: u32 = 13;
const SET_REPORT_REPLY: u32 = 14;

/// Without it the device is not listed as one on USB.
const BUS_USB: u16 = 3;

/// Longest data of a message.
const DATA: usize = 4096;

/// The error that a device answers with.
const EIO: u16 = 5;

/// What the system wants of the device.
#[derive(Debug)]
pub enum Event {
    /// The driver is bound.
    Start,
    /// The driver is gone: the last event.
    Stop,
    /// Somebody reads now.
    Open,
    /// Nobody reads any more.
    Close,
    /// An output report, with its number.
    Output(Vec<u8>),
    /// Report `number` is asked for; to be answered with `id`.
    GetReport {
        /// Of the question.
        id: u32,
        /// Of the report.
        number: u8,
    },
    /// A report was set; to be answered with `id`.
    SetReport {
        /// Of the question.
        id: u32,
        /// The report with its number.
        report: Vec<u8>,
    },
}

/// A device. The system destroys it when it is dropped.
#[derive(Debug)]
pub struct Uhid(File);

impl Uhid {
    /// Creates a device on a bus that is called USB.
    pub fn create(
        name: &str,
        serial: &str,
        [vendor, product]: [u16; 2],
        descriptor: &[u8],
    ) -> io::Result<Uhid> {
        let mut message = CREATE2.to_ne_bytes().to_vec();
        let mut text = |text: &str, length: usize| {
            let end = message.len() + length;
            message.extend(text.as_bytes());
            message.resize(end, 0);
        };
        text(name, 128);
        text("", 64); // physical path
        text(serial, 64);
        message.extend((descriptor.len() as u16).to_ne_bytes());
        message.extend(BUS_USB.to_ne_bytes());
        for number in [u32::from(vendor), u32::from(product), 0, 0] {
            message.extend(number.to_ne_bytes()); // and version, country
        }
        message.extend(descriptor);
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .open("/dev/uhid")?;
        let device = Uhid(file);
        device.send(&message)?;
        Ok(device)
    }

    /// Pulls the cable.
    pub fn destroy(&self) -> io::Result<()> {
        self.send(&DESTROY.to_ne_bytes())
    }

    /// Sends an input report, whatever its bytes.
    pub fn send_input(&self, report: &[u8]) -> io::Result<()> {
        let mut message = INPUT2.to_ne_bytes().to_vec();
        message.extend((report.len() as u16).to_ne_bytes());
        message.extend(report);
        self.send(&message)
    }

    /// Answers [`Event::GetReport`] with a report, or with an error.
    pub fn answer_get(&self, id: u32, report: Option<&[u8]>) -> io::Result<()> {
        let data = report.unwrap_or_default();
        let mut message = GET_REPORT_REPLY.to_ne_bytes().to_vec();
        message.extend(id.to_ne_bytes());
        message.extend(report.map_or(EIO, |_| 0).to_ne_bytes());
        message.extend((data.len() as u16).to_ne_bytes());
        message.extend(data);
        self.send(&message)
    }

    /// Answers [`Event::SetReport`]: done, or an error.
    pub fn answer_set(&self, id: u32, done: bool) -> io::Result<()> {
        let mut message = SET_REPORT_REPLY.to_ne_bytes().to_vec();
        message.extend(id.to_ne_bytes());
        message.extend(if done { 0 } else { EIO }.to_ne_bytes());
        self.send(&message)
    }

    fn send(&self, message: &[u8]) -> io::Result<()> {
        (&self.0).write_all(message)
    }

    /// Waits for the next event.
    pub fn event(&self) -> io::Result<Event> {
        let mut message = [0; 2 * DATA];
        let length = (&self.0).read(&mut message)?;
        let message = &message[..length];
        Ok(match word(message, 0)? {
            START => Event::Start,
            STOP => Event::Stop,
            OPEN => Event::Open,
            CLOSE => Event::Close,
            // data, size, type
            OUTPUT => Event::Output(data(message, 4, 4 + DATA)?),
            // id, number, type
            GET_REPORT => Event::GetReport {
                id: word(message, 4)?,
                number: bytes::<1>(message, 8)?[0],
            },
            // id, number, type, size, data
            SET_REPORT => Event::SetReport {
                id: word(message, 4)?,
                report: data(message, 12, 10)?,
            },
            other => return Err(io::Error::other(format!("uhid event {other}"))),
        })
    }
}

fn bytes<const LENGTH: usize>(message: &[u8], at: usize) -> io::Result<[u8; LENGTH]> {
    let found = message.get(at..at + LENGTH);
    let found = found.and_then(|found| found.try_into().ok());
    found.ok_or_else(|| io::Error::other("a uhid event that is cut off"))
}

fn word(message: &[u8], at: usize) -> io::Result<u32> {
    Ok(u32::from_ne_bytes(bytes(message, at)?))
}

/// The data at one place, whose size is at another.
fn data(message: &[u8], at: usize, size_at: usize) -> io::Result<Vec<u8>> {
    let size = usize::from(u16::from_ne_bytes(bytes(message, size_at)?));
    let found = message.get(at..at + size);
    let found = found.ok_or_else(|| io::Error::other("a uhid event that is cut off"))?;
    Ok(found.to_vec())
}
