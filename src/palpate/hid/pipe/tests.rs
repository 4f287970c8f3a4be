use std::io::{ErrorKind, PipeReader, PipeWriter, Read, pipe};
use std::sync::mpsc::channel;
use std::thread::spawn;

use super::*;
use crate::hid::simulated::PAPER;
use crate::hid::tests::begin;
use crate::hid::{Cycle, End, button};
use crate::servo::Fault;

/// What the loop wrote: reports 2 by themselves, reports 4 as they were encoded.
#[derive(Debug, PartialEq)]
enum Written {
    Force(ForceReport),
    Control(u8),
}

/// The reports in `bytes`, which hold nothing else.
fn written(mut bytes: &[u8]) -> Vec<Written> {
    let mut reports = Vec::new();
    while let Some(&number) = bytes.first() {
        // The numbers and lengths of the table in spec/hid.md.
        let (report, rest) = bytes.split_at(match number {
            2 => 8,
            4 => 2,
            _ => panic!("{bytes:?}"),
        });
        reports.push(match number {
            2 => Written::Force(ForceReport::decode(report).unwrap()),
            _ => Written::Control(report[1]),
        });
        bytes = rest;
    }
    reports
}

/// A hand that takes the deadman at the third report, 4 mm deep, 1 mm to the side for each report.
fn position(sequence: u16) -> PositionReport {
    PositionReport {
        lateral: 1000 * (sequence % 8) as i16,
        normal: -4000,
        buttons: button::DEADMAN * u8::from(sequence > 3),
        sequence,
        ..PositionReport::default()
    }
}

/// A device of so long a period that the positions come in time on a busy machine too.
const SLOW: Capabilities = Capabilities {
    period_us: 20_000,
    watchdog_ms: 50,
    ..PAPER
};

/// A bridge that sends so many positions, each after a force report, and then none, until the loop has ended; all that the loop wrote.
fn bridge(mut to: PipeWriter, mut from: PipeReader, positions: u16) -> Vec<u8> {
    to.write_all(&SLOW.encode()).unwrap();
    let (mut sequence, mut all, mut bytes) = (0, Vec::new(), [0; 8]);
    loop {
        let length = match from.read_exact(&mut bytes[..1]) {
            Err(_) => return all,
            Ok(()) if bytes[0] == 2 => 8,
            Ok(()) => 2,
        };
        from.read_exact(&mut bytes[1..length]).unwrap();
        all.extend(&bytes[..length]);
        if bytes[0] == 2 && sequence < positions {
            sequence += 1;
            match to.write_all(&position(sequence).encode()) {
                // The last force comes when the loop has ended, and nobody reads another position.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => {}
                sent => sent.unwrap(),
            }
        }
    }
}

/// A session with that bridge, to its end: its cycles, how it ended, and what the loop wrote.
fn session(positions: u16, most: usize) -> (Vec<Cycle>, End, Vec<Written>) {
    let ((input, to), (from, output)) = (pipe().unwrap(), pipe().unwrap());
    let other_end = spawn(move || bridge(to, from, positions));
    let mut cycles = Vec::new();
    let end = begin(PipeDevice::open(input, output).unwrap()).run(|cycle, _| {
        cycles.push(*cycle);
        cycles.len() < most
    });
    (cycles, end, written(&other_end.join().unwrap()))
}

// Verifies: HID-110.
#[test]
fn positions_and_forces_come_through_a_pipe_as_they_were_sent() {
    let (cycles, end, written) = session(u16::MAX, 200);
    assert_eq!(end, End::Asked);
    assert!(
        cycles
            .iter()
            .any(|cycle| cycle.playing && cycle.force.normal > 1000)
    );
    for report in cycles.iter().filter_map(|cycle| cycle.position) {
        assert_eq!(report, position(report.sequence));
    }
    let forces = cycles.iter().map(|cycle| Written::Force(cycle.force));
    let zero = ForceReport {
        sequence: 201,
        ..ForceReport::default()
    };
    // Clear faults, enable; each cycle; stop.
    let expected = [Written::Control(2), Written::Control(1)]
        .into_iter()
        .chain(forces);
    let expected = expected.chain([Written::Control(0), Written::Force(zero)]);
    assert_eq!(written, expected.collect::<Vec<_>>());
}

// Verifies: HID-112.
#[test]
fn the_force_is_released_and_the_device_stopped_when_positions_cease() {
    let (cycles, end, written) = session(100, 10_000);
    assert_eq!(end, End::Fault(Fault::Watchdog));
    let last = cycles
        .iter()
        .rposition(|cycle| cycle.position.is_some())
        .unwrap();
    assert_eq!(cycles[last].position.unwrap().sequence, 100);
    assert!(cycles[last].force.normal > 1000, "{:?}", cycles[last]);
    // Ten cycles without a position are allowed, the eleventh is the fault; the force falls by a tenth of its limit a cycle.
    let after = cycles.len() - 1 - last;
    assert!((11..=11 + 10).contains(&after), "{after}");
    let [
        ..,
        Written::Force(released),
        Written::Control(0),
        Written::Force(zero),
    ] = &written[..]
    else {
        panic!("{written:?}")
    };
    assert_eq!(
        [released.normal, released.lateral, zero.normal, zero.lateral],
        [0; 4]
    );
}

// Verifies: HID-112.
#[test]
fn a_device_that_is_silent_before_the_loop_is_armed_ends_the_session() {
    // With no position at all, or with one: the loop arms with the second at the earliest.
    for positions in [0, 1] {
        let (cycles, end, written) = session(positions, 10_000);
        assert_eq!(end, End::Fault(Fault::Watchdog));
        // A cycle waits 40 ms for a position, and longer on a busy machine.
        assert!((5..=30).contains(&cycles.len()), "{}", cycles.len());
        let silent = cycles.last().unwrap().woke - cycles[0].received;
        assert!(silent.as_secs_f64() > 0.9, "{silent:?}");
        assert!(cycles.iter().all(|cycle| cycle.force
            == ForceReport {
                sequence: cycle.force.sequence,
                flags: cycle.force.flags,
                ..ForceReport::default()
            }));
        let [.., Written::Control(0), Written::Force(_)] = &written[..] else {
            panic!("{written:?}")
        };
    }
}

/// Takes note of what is written after it is dropped.
struct Noting(std::sync::mpsc::Sender<u8>);

impl Write for Noting {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        bytes.iter().for_each(|&byte| self.0.send(byte).unwrap());
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

// Verifies: HID-112.
#[test]
fn an_input_that_ends_or_is_none_of_a_bridge_stops_the_device() {
    let (about, report) = (PAPER.encode(), position(1).encode());
    let input = |bytes: &[u8]| {
        let (input, mut to) = pipe().unwrap();
        to.write_all(bytes).unwrap();
        input
    };
    let opened = |bytes| PipeDevice::open(input(bytes), Vec::new()).err();
    // More positions than the loop takes, and then what must be first.
    let late = [report.repeat(64), about.to_vec()].concat();
    for (bytes, message) in [
        (
            &about[..0],
            "pipe: read: the input ended where a report must begin",
        ),
        (&about[..16], "pipe: read: the input ended within a report"),
        (&report[..], "pipe: read: report number 1, which must be 3"),
        (&late, "pipe: read: report number 1, which must be 3"),
        (
            b"hello, palpate, here is a device",
            "pipe: read: report number 104, which must be 3",
        ),
    ] {
        assert_eq!(opened(bytes).unwrap().message, message);
    }
    for (bytes, message) in [
        (
            &report[..0],
            "pipe: read: the input ended where a report must begin",
        ),
        (&report[..10], "pipe: read: the input ended within a report"),
        (
            &[1, 0, 0][..],
            "pipe: read: the input ended within a report",
        ),
        (&about[..], "pipe: read: report number 3, which must be 1"),
        (&[0; 20][..], "pipe: read: report number 0, which must be 1"),
    ] {
        let input = input(&[&about[..], &report, &report, bytes].concat());
        let (sender, sent) = channel();
        let device = PipeDevice::open(input, Noting(sender)).unwrap();
        let End::Device(error) = begin(device).run(|_, _| true) else {
            panic!("{bytes:?}")
        };
        assert_eq!(error.message, message);
        let sent = written(&sent.iter().collect::<Vec<_>>());
        let [.., Written::Control(0), Written::Force(zero)] = sent[..] else {
            panic!("{sent:?}")
        };
        assert_eq!([zero.lateral, zero.normal], [0, 0]);
    }
}

// Verifies: HID-112.
#[test]
fn an_output_that_nobody_reads_ends_the_session() {
    let ((input, mut to), (from, output)) = (pipe().unwrap(), pipe().unwrap());
    to.write_all(&PAPER.encode()).unwrap();
    let device = PipeDevice::open(input, output).unwrap();
    drop(from);
    let end = begin(device).run(|_, _| true).to_string();
    assert!(end.starts_with("stopped: pipe: write: "), "{end}");
}

// Verifies: HID-110.
#[test]
fn a_force_leaves_at_once_through_an_output_that_buffers() {
    let (sender, sent) = channel();
    let output = std::io::BufWriter::new(Noting(sender));
    let (input, mut to) = pipe().unwrap();
    to.write_all(&PAPER.encode()).unwrap();
    let mut device = PipeDevice::open(input, output).unwrap();
    device.write(&ForceReport::default()).unwrap();
    let sent: Vec<u8> = sent.try_iter().collect();
    assert_eq!(sent, ForceReport::default().encode());
}

// Elsewhere a thread reads, when it may.
// Verifies: HID-111.
#[cfg(unix)]
#[test]
fn the_newest_reports_are_taken_after_a_stall() {
    let (input, mut to) = pipe().unwrap();
    to.write_all(&PAPER.encode()).unwrap();
    let mut device = PipeDevice::open(input, Vec::new()).unwrap();
    // With half a report behind them, which is taken when it is whole.
    let sent: Vec<u8> = (1..=201)
        .flat_map(|sequence| position(sequence).encode())
        .collect();
    let (whole, rest) = sent.split_at(sent.len() - 5);
    to.write_all(whole).unwrap();
    let mut read = || match device.read(Duration::ZERO).unwrap() {
        Received::Report(report) => Some(report.sequence),
        _ => None,
    };
    let taken: Vec<u16> = std::iter::from_fn(&mut read).collect();
    assert_eq!(taken, (200 - 62..=200).collect::<Vec<_>>());
    to.write_all(rest).unwrap();
    assert_eq!(read(), Some(201));
}
