//! A USB device made by a program: Linux' virtual host controller `vhci-hcd`, which sends its transfers through
//! a socket (the USB/IP protocol of the kernel's documentation). Here the other end is in the same process, so
//! that there is neither a network nor a tool.

use std::fs;
use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard};

use crate::link::{Answer, Board, Completion, Link};

const CONTROLLER: &str = "/sys/devices/platform/vhci_hcd.0";

const SUBMIT: u32 = 1;
const UNLINK: u32 = 2;
const SUBMITTED: u32 = 3;
const UNLINKED: u32 = 4;

/// Every message begins with as much.
const HEADER: usize = 48;

const FULL_SPEED: u32 = 2;

/// No such request: the device stalls the endpoint.
const EPIPE: i32 = 32;
const ECONNRESET: i32 = 104;

/// Ports of the controller for full speed.
const PORTS: u32 = 8;

/// Each device takes the next port, since one that was pulled is not free at once.
static NEXT_PORT: AtomicU32 = AtomicU32::new(0);

/// A device in a port.
pub struct Usb {
    socket: UnixStream,
    /// Transfers that are not complete, by number, in the order in which they came.
    pending: Mutex<Vec<(u32, Waits)>>,
    descriptors: Descriptors,
}

/// What completes a transfer.
#[derive(PartialEq)]
enum Waits {
    /// An input report.
    Input,
    /// The next frame, which takes so many bytes.
    Frame(usize),
    /// Nothing.
    Never,
}

struct Descriptors {
    device: Vec<u8>,
    configuration: Vec<u8>,
    report: Vec<u8>,
    strings: [Vec<u8>; 3],
}

impl Descriptors {
    fn new(name: &str, serial: &str, [vendor, product]: [u16; 2], report: &[u8]) -> Descriptors {
        // USB 1.1, 64 bytes a control packet, release 1.0, strings 1 and 2, one configuration.
        let mut device = vec![18, 1, 0x10, 0x01, 0, 0, 0, 64];
        device.extend(vendor.to_le_bytes());
        device.extend(product.to_le_bytes());
        device.extend([0, 1, 0, 1, 2, 1]);
        let [low, high] = (report.len() as u16).to_le_bytes();
        let configuration = [
            &[9, 2, 41, 0, 1, 1, 0, 0x80, 50][..], // one interface
            &[9, 4, 0, 0, 2, 3, 0, 0, 0],          // HID, two endpoints
            &[9, 0x21, 0x11, 0x01, 0, 1, 0x22, low, high],
            &[7, 5, 0x81, 3, 64, 0, 1], // interrupt in, each frame
            &[7, 5, 0x02, 3, 64, 0, 1], // interrupt out, each frame
        ];
        let string = |text: &str| {
            let units = text.encode_utf16().flat_map(u16::to_le_bytes);
            let mut string = vec![0, 3];
            string.extend(units);
            string[0] = string.len() as u8;
            string
        };
        Descriptors {
            device,
            configuration: configuration.concat(),
            report: report.to_vec(),
            strings: [vec![4, 3, 0x09, 0x04], string(name), string(serial)],
        }
    }

    fn get(&self, kind: u8, index: u8) -> Option<&[u8]> {
        match kind {
            1 => Some(&self.device),
            2 => Some(&self.configuration),
            3 => self.strings.get(usize::from(index)).map(Vec::as_slice),
            0x22 => Some(&self.report),
            _ => None,
        }
    }
}

/// A transfer: the header of a message and what follows it.
struct Transfer {
    command: u32,
    number: u32,
    into_host: bool,
    endpoint: u32,
    length: usize,
    setup: [u8; 8],
    unlinks: u32,
    data: Vec<u8>,
}

impl Usb {
    /// Plugs a device in.
    pub fn attach(name: &str, serial: &str, numbers: [u16; 2], report: &[u8]) -> io::Result<Usb> {
        let (socket, theirs) = UnixStream::pair()?;
        let port = NEXT_PORT.fetch_add(1, Ordering::Relaxed) % PORTS;
        let device = (1 << 16) | (port + 2);
        let line = format!("{port} {} {device} {FULL_SPEED}", theirs.as_raw_fd());
        fs::write(format!("{CONTROLLER}/attach"), line)?;
        Ok(Usb {
            socket,
            pending: Mutex::default(),
            descriptors: Descriptors::new(name, serial, numbers, report),
        })
    }

    fn pending(&self) -> MutexGuard<'_, Vec<(u32, Waits)>> {
        self.pending.lock().expect("the transfers")
    }

    /// Takes back the first pending transfer that fits.
    fn withdraw(&self, fits: impl Fn(&(u32, Waits)) -> bool) -> Option<u32> {
        let mut pending = self.pending();
        let at = pending.iter().position(fits)?;
        Some(pending.remove(at).0)
    }

    /// The next message; `None` once the cable is pulled.
    fn receive(&self) -> io::Result<Option<Transfer>> {
        let mut header = [0; HEADER];
        if let Err(error) = (&self.socket).read_exact(&mut header) {
            let pulled = error.kind() == io::ErrorKind::UnexpectedEof;
            return if pulled { Ok(None) } else { Err(error) };
        }
        let word = |index: usize| {
            let bytes = [0, 1, 2, 3].map(|byte| header[4 * index + byte]);
            u32::from_be_bytes(bytes)
        };
        let mut transfer = Transfer {
            command: word(0),
            number: word(1),
            into_host: word(3) == 1,
            endpoint: word(4),
            unlinks: word(5),
            length: word(6) as usize,
            setup: [0, 1, 2, 3, 4, 5, 6, 7].map(|byte| header[40 + byte]),
            data: Vec::new(),
        };
        if transfer.command == SUBMIT && !transfer.into_host {
            transfer.data.resize(transfer.length, 0);
            (&self.socket).read_exact(&mut transfer.data)?;
        }
        Ok(Some(transfer))
    }

    /// Says how transfer `number` ended: with so many bytes, of which `data` go into the host.
    fn complete(&self, number: u32, status: i32, length: usize, data: &[u8]) -> io::Result<()> {
        let header = [SUBMITTED, number, 0, 0, 0, -status as u32, length as u32];
        self.send(&header, data)
    }

    /// Takes transfer `transfer.unlinks` back, if it is not complete.
    fn unlink(&self, transfer: &Transfer) -> io::Result<()> {
        let withdrawn = self.withdraw(|&(number, _)| number == transfer.unlinks);
        let status = withdrawn.map_or(0, |_| -ECONNRESET);
        let header = [UNLINKED, transfer.number, 0, 0, 0, status as u32];
        self.send(&header, &[])
    }

    fn send(&self, header: &[u32], data: &[u8]) -> io::Result<()> {
        let mut message: Vec<u8> = header.iter().flat_map(|word| word.to_be_bytes()).collect();
        message.resize(HEADER, 0);
        message.extend(data);
        (&self.socket).write_all(&message)
    }

    /// A request on the control endpoint.
    fn control(&self, transfer: &Transfer, board: &dyn Board) -> io::Result<()> {
        let [kind, request, low, high, _, _, _, _] = transfer.setup;
        let done = |data: &[u8]| {
            let sent = &data[..data.len().min(transfer.length)];
            self.complete(transfer.number, 0, sent.len(), sent)
        };
        let stall = || self.complete(transfer.number, EPIPE, 0, &[]);
        match (kind, request) {
            // Get descriptor, of the device or its interface.
            (0x80 | 0x81, 6) => self.descriptors.get(high, low).map_or_else(stall, done),
            // Set configuration, interface, idle rate, protocol.
            (0x00, 9) | (0x01, 11) | (0x21, 10 | 11) => done(&[]),
            // Get status.
            (0x80..=0x82, 0) => done(&[0, 0]),
            // Get report.
            (0xA1, 1) => match board.get(low) {
                Answer::Report(report) => done(&report),
                Answer::Error => stall(),
                Answer::Nothing => self.wait(transfer.number, Waits::Never),
            },
            // Set report.
            (0x21, 9) if board.set(&transfer.data) => {
                self.complete(transfer.number, 0, transfer.length, &[])
            }
            _ => stall(),
        }
    }

    fn wait(&self, number: u32, until: Waits) -> io::Result<()> {
        self.pending().push((number, until));
        Ok(())
    }

    fn submit(&self, transfer: &Transfer, board: &dyn Board) -> io::Result<()> {
        let (number, length) = (transfer.number, transfer.length);
        match (transfer.endpoint, transfer.into_host) {
            (0, _) => self.control(transfer, board),
            (1, true) => self.wait(number, Waits::Input),
            (2, false) => match board.output(&transfer.data) {
                Completion::Now => self.complete(number, 0, length, &[]),
                Completion::NextFrame => self.wait(number, Waits::Frame(length)),
                Completion::Never => self.wait(number, Waits::Never),
            },
            _ => self.complete(number, EPIPE, 0, &[]),
        }
    }
}

impl Link for Usb {
    fn input(&self, report: &[u8]) -> io::Result<()> {
        // Without a transfer that waits the report is lost, as on a bus that nobody polls.
        let waiting = self.withdraw(|(_, until)| *until == Waits::Input);
        waiting.map_or(Ok(()), |number| {
            self.complete(number, 0, report.len(), report)
        })
    }

    fn frame(&self) -> io::Result<()> {
        let is_due = |transfer: &mut (u32, Waits)| matches!(transfer.1, Waits::Frame(_));
        let due: Vec<_> = self.pending().extract_if(.., is_due).collect();
        due.into_iter().try_for_each(|(number, until)| match until {
            Waits::Frame(length) => self.complete(number, 0, length, &[]),
            _ => Ok(()),
        })
    }

    fn unplug(&self) -> io::Result<()> {
        self.socket.shutdown(Shutdown::Both)
    }

    fn serve(&self, board: &dyn Board) -> io::Result<()> {
        while let Some(transfer) = self.receive()? {
            match transfer.command {
                SUBMIT => self.submit(&transfer, board)?,
                UNLINK => self.unlink(&transfer)?,
                other => return Err(io::Error::other(format!("USB/IP command {other}"))),
            }
        }
        Ok(())
    }
}
