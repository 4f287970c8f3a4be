//! What only a bus can do wrong: transfers that take their time, or are never taken.

use palpate::hid::{Control, End};

use crate::board::{Act, Board, Make, PERIOD};
use crate::checks::{Run, Scenario, WATCHDOG, ensure, largest, make, reports, run, safe, text};
use crate::link::{Completion, Kind};
use crate::scenarios::{cycles, protocol, unplug};

/// All of them.
pub const ALL: &[(&str, Scenario)] = &[
    ("usb protocol", || protocol(Kind::Usb)),
    ("usb cycles", || cycles(Kind::Usb)),
    ("usb blocking write", blocking_write),
    ("usb unplug", || unplug(Kind::Usb)),
    ("usb refusal", refusal),
    (
        "palpate play, usb refusal",
        crate::program_scenarios::held_up,
    ),
];

/// Verifies: HID-091.
fn blocking_write() -> Result<String, String> {
    let takes = Completion::NextFrame;
    let make = Make {
        takes,
        ..make(Kind::Usb, reports)
    };
    let board = Board::plug("blocking", make).map_err(text)?;
    let Run {
        end,
        settled,
        counters,
        responses,
        mut writes,
    } = run("blocking", 1100)?;
    let record = board.unplug().map_err(text)?;
    ensure!(end == End::Asked, "{end}");
    safe(&record)?;
    let missed = counters.missed - settled.missed;
    let late = responses.iter().filter(|&&time| time > PERIOD).count();
    let summary = largest(writes.clone())?;
    writes.sort();
    let middle = writes[writes.len() / 2];
    ensure!(
        middle > PERIOD * 8 / 10 && middle <= PERIOD * 11 / 10,
        "{summary}"
    );
    Ok(format!(
        "write {summary}; of 1000 cycles {missed} without a fresh sample, {late} longer than a period"
    ))
}

/// Verifies: HID-092.
fn refusal() -> Result<String, String> {
    let board = Board::plug(
        "refusal",
        make(Kind::Usb, |tick| match tick {
            300 => Act::Refuse,
            _ => Act::Report,
        }),
    )
    .map_err(text)?;
    let Run { end, .. } = run("refusal", 10_000)?;
    let record = board.unplug().map_err(text)?;
    // It takes the stop, which has an endpoint of its own, but not the force report of zero.
    let End::Unstopped(end, unstopped) = end else {
        return Err(format!("the loop went on, or the zero came through: {end}"));
    };
    let error = end.to_string();
    ensure!(
        matches!(*end, End::Device(_)) && unstopped.is_stalled(),
        "{error}"
    );
    ensure!(error.contains("serial refusal"), "{error}");
    let dropped = record
        .dropped_after
        .ok_or("the board did not drop the force")?;
    ensure!(dropped <= WATCHDOG + 2 * PERIOD, "{dropped:?}");
    ensure!(record.motors == [0, 0], "{:?}", record.motors);
    ensure!(
        record.controls.last() == Some(&Control::Stop),
        "{:?}",
        record.controls
    );
    safe(&record)?;
    let stopped = record.stopped_after.ok_or("no control")?;
    Ok(format!(
        "the board dropped the force after {} µs, was told to stop after {} ms; \"{error}\"",
        dropped.as_micros(),
        stopped.as_millis()
    ))
}
