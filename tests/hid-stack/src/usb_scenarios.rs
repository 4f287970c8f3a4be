//! What only a bus can do wrong: transfers that take their time, or are never taken.

use palpate::hid::{DeviceState, End};

use crate::Scenario;
use crate::board::{Act, Board, Make, PERIOD, REPORTS};
use crate::checks::{Run, dropped, ended, largest, run, safe};
use crate::link::{Completion, Kind};
use crate::program_scenarios::held_up;
use crate::scenarios::{cycles, protocol, unplug};

/// All of them.
pub const ALL: &[Scenario] = &[
    ("usb protocol", || protocol(Kind::Usb)),
    ("usb cycles", || cycles(Kind::Usb)),
    ("usb blocking write", blocking_write),
    ("usb unplug", || unplug(Kind::Usb)),
    ("usb refusal", refusal),
    ("palpate play, usb refusal", held_up),
];

/// Verifies: HID-091.
fn blocking_write() -> String {
    let takes = Completion::NextFrame;
    let make = Make {
        takes,
        ..Make::new(Kind::Usb, REPORTS)
    };
    let board = Board::plug("blocking", make);
    let mut run = run("blocking", 1100);
    safe(&board.unplug());
    assert_eq!(run.end, End::Asked);
    let missed = run.counters.missed - run.settled.missed;
    let late = run.responses.iter().filter(|&&time| time > PERIOD).count();
    let summary = largest(&mut run.writes);
    let middle = run.writes[run.writes.len() / 2];
    let about_a_period = PERIOD * 8 / 10..=PERIOD * 11 / 10;
    assert!(about_a_period.contains(&middle), "{summary}");
    format!(
        "write {summary}; of 1000 cycles {missed} without a fresh sample, {late} longer than a period"
    )
}

/// Verifies: HID-089.
fn refusal() -> String {
    let board = Board::good(Kind::Usb, "refusal", &[(300, Act::Refuse)]);
    let Run { end, .. } = run("refusal", 10_000);
    let record = board.unplug();
    // It takes the stop, which has an endpoint of its own, but not the force report of zero.
    let End::Unstopped(end, unstopped) = end else {
        panic!("the loop went on, or the zero came through: {end}");
    };
    assert!(matches!(*end, End::Device(_)), "{end}");
    assert_eq!(unstopped.state, DeviceState::Stalled);
    let error = end.to_string();
    assert!(error.contains("serial refusal"), "{error}");
    let dropped = dropped(&record).as_micros();
    ended(&record);
    let stopped = record.stopped_after.expect("a control").as_millis();
    format!(
        "the board dropped the force after {dropped} µs, was told to stop after {stopped} ms; \"{error}\""
    )
}
