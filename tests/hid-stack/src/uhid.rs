//! A HID device made by a program: Linux' `/dev/uhid` (`linux/uhid.h`), whose messages are packed structures
//! that begin with their type.

use std::fs::File;
use std::io::{self, Read, Write};

use crate::link::{Answer, Board, Link};

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
        let device = Uhid(File::options().read(true).write(true).open("/dev/uhid")?);
        let text = |text: &str, length: usize| {
            let mut bytes = text.as_bytes().to_vec();
            bytes.resize(length, 0);
            bytes
        };
        let numbers = [u32::from(vendor), u32::from(product), 0, 0].map(u32::to_ne_bytes);
        let parts: [&[u8]; 7] = [
            &text(name, 128),
            &text("", 64), // physical path
            &text(serial, 64),
            &(descriptor.len() as u16).to_ne_bytes(),
            &BUS_USB.to_ne_bytes(),
            numbers.as_flattened(), // and version, country
            descriptor,
        ];
        device.send(CREATE2, &parts)?;
        Ok(device)
    }

    fn send(&self, kind: u32, parts: &[&[u8]]) -> io::Result<()> {
        let message = [&kind.to_ne_bytes(), &*parts.concat()].concat();
        (&self.0).write_all(&message)
    }
}

impl Link for Uhid {
    fn input(&self, report: &[u8]) -> io::Result<()> {
        self.send(INPUT2, &[&(report.len() as u16).to_ne_bytes(), report])
    }

    fn frame(&self) -> io::Result<()> {
        Ok(())
    }

    fn unplug(&self) -> io::Result<()> {
        self.send(DESTROY, &[])
    }

    fn serve(&self, board: &dyn Board) -> io::Result<()> {
        loop {
            let mut message = [0; 2 * DATA];
            if (&self.0).read(&mut message)? == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let word = |at: usize| u32::from_ne_bytes([0, 1, 2, 3].map(|byte| message[at + byte]));
            // The data at one place, whose size is at another.
            let data = |at: usize, size_at: usize| {
                let size = u16::from_ne_bytes([message[size_at], message[size_at + 1]]);
                &message[at..at + usize::from(size)]
            };
            let id = &message[4..8];
            match word(0) {
                STOP => return Ok(()),
                START | OPEN | CLOSE => {}
                // data, size, type
                OUTPUT => {
                    board.output(data(4, 4 + DATA));
                }
                // id, number, type
                GET_REPORT => {
                    let (error, report) = match board.get(message[8]) {
                        Answer::Report(report) => (0, report),
                        Answer::Error => (EIO, vec![]),
                        Answer::Nothing => continue,
                    };
                    let [error, size] = [error, report.len() as u16].map(u16::to_ne_bytes);
                    self.send(GET_REPORT_REPLY, &[id, &error, &size, &report])?;
                }
                // id, number, type, size, data
                SET_REPORT => {
                    let error = if board.set(data(12, 10)) { 0 } else { EIO };
                    self.send(SET_REPORT_REPLY, &[id, &error.to_ne_bytes()])?;
                }
                other => return Err(io::Error::other(format!("uhid event {other}"))),
            }
        }
    }
}
