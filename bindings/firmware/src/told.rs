//! What both the target and the machine that compares must say, line by line.

use core::fmt::Write;

use crate::device::{CAPABILITIES, Device};
use crate::scenario::{self, Outcome};
use crate::table::PAPER;
use crate::vectors;

/// All vectors of the table in `bytes`, and the scenario. False if one was not right, or the scenario left out what it is for.
pub fn all(bytes: &[u8], text: &mut impl Write) -> bool {
    let right = vectors::all(bytes, text);
    let Some(mut device) = PAPER
        .table()
        .and_then(|table| Device::new(table, &CAPABILITIES))
    else {
        return false;
    };
    let Outcome {
        hash,
        playing,
        faults,
    } = scenario::run(&mut device, Device::step);
    let cycles = scenario::CYCLES;
    // Text that is lost changes no verdict.
    let _ = writeln!(
        text,
        "scenario: {cycles} cycles, {playing} playing, in fault by position, device, watchdog, state {faults:?}, commands {hash:016x}"
    );
    right && playing > cycles / 10 && faults.iter().all(|&cycles| cycles > 0)
}
