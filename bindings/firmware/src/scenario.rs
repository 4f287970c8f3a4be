//! 10,000 cycles of a hand that probes, a switch that is let go, reports that are lost and repeated, faults and overwritten
//! memory, the same on every machine.

use core::fmt::Write;

use palpate_core::force::Force;
use palpate_core::hid::{Control, PAPER, PositionReport, button, status};
use palpate_core::servo::{Command, Input, Mode, State};
use palpate_core::stats::random::Generator;

use crate::device::{Device, Frame};
use crate::hash::Digest;
use crate::table;

/// How many cycles.
pub const CYCLES: u32 = 10_000;

const GENERATOR: Generator = Generator::new(1999, 33);

/// What is drawn for a cycle: numbers from 0 to 65535.
fn draw(cycle: u32) -> [u16; 8] {
    let [a, b, ..] = GENERATOR.words([u64::from(cycle), 0, 0, 0]);
    let word = |word: u64, place: u32| (word >> (16 * place)) as u16;
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| word(if k < 4 { a } else { b }, k % 4))
}

/// A position that goes from −`reach` to `reach` and back in `period` cycles, counts.
fn swing(cycle: u32, period: u32, reach: i32) -> i32 {
    let at = (cycle % period) as i32;
    let half = period as i32 / 2;
    let up = if at < half { at } else { 2 * half - at };
    2 * reach * up / half - reach
}

/// The frame of a cycle. In a stretch of 500 the switch is let go, the kernel asked to arm, the switch held, and now and then
/// something goes wrong.
pub fn frame(cycle: u32) -> Frame {
    let [event, noise, far, ahead, spare @ ..] = draw(cycle);
    let within = cycle % 500;
    let lateral = swing(cycle, 1777, 11_500) + i32::from(noise % 41);
    let depth = swing(cycle, 613, 2_600) + 1_900 + i32::from(noise / 41 % 41);
    let beyond = far % 50 == 0;
    let report = PositionReport {
        lateral: if beyond {
            spare[0] as i16
        } else {
            lateral as i16
        },
        normal: if beyond {
            spare[1] as i16
        } else {
            -depth as i16
        },
        buttons: if (20..470).contains(&within) && event % 97 != 0 {
            button::DEADMAN
        } else {
            0
        },
        status: if event % 1009 == 0 { status::FAULT } else { 0 },
        // Now and then one that was there before, or one far ahead.
        sequence: match ahead % 800 {
            0 => (cycle as u16).wrapping_add(ahead),
            k if k % 40 == 1 => (cycle as u16).wrapping_sub(1),
            _ => cycle as u16,
        },
        force_sequence: 0,
    };
    let control = match within {
        10..13 | 15 => Control::Enable,
        480 => Control::Stop,
        _ => Control::ClearFault,
    };
    let mut frame = [0; 13];
    frame[..2].copy_from_slice(&control.encode());
    // Lost: now and then one, and once in a while thirty in a row.
    let lost = event % 23 == 1 || (within > 300 && within < 330 && cycle / 500 % 4 == 3);
    if !lost {
        frame[2..].copy_from_slice(&report.encode());
    }
    frame
}

/// What the scenario came to.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Of all commands and modes.
    pub digest: Digest,
    /// Cycles in which the force followed the table.
    pub playing: u32,
    /// Cycles with a fault of the position, the device, the watchdog and the state.
    pub faults: [u32; 4],
}

/// The outcome on the paper's display.
pub fn outcome() -> Option<Outcome> {
    let mut device = Device::new(table::PAPER.table()?, &PAPER)?;
    Some(run(&mut device, Device::step))
}

/// Runs all cycles; `stepped` steps the kernel, and may measure.
///
/// Implements: FIR-003.
pub fn run<'a>(
    device: &mut Device<'a>,
    mut stepped: impl FnMut(&mut Device<'a>, Input) -> Command,
) -> Outcome {
    let mut outcome = Outcome::default();
    for cycle in 0..CYCLES {
        let mut input = device.input(&frame(cycle));
        spoil(cycle, &mut input, &mut device.state);
        let command = stepped(device, input);
        let mode = device.state.mode;
        if let Mode::Faulted(fault) = mode {
            outcome.faults[fault as usize] += 1;
        }
        outcome.playing += u32::from(command.playing);
        let _ = write!(outcome.digest, "{command:?} {mode:?}"); // a digest takes every text
    }
    outcome
}

/// What no report can hold: positions that are no numbers, and memory that was overwritten.
fn spoil(cycle: u32, input: &mut Input, state: &mut State) {
    if let (Some(sample), 333) = (&mut input.sample, cycle % 1000) {
        sample.depth = [f32::NAN, f32::INFINITY][(cycle / 1000 % 2) as usize];
    }
    if cycle % 3000 == 2700 {
        state.force = Force::new(f32::from_bits(0x7FC0_1234), 1e30);
    }
}
