//! The image that checks: the digest, and what a step takes.
#![no_std]
#![no_main]

use core::fmt::Write;
use core::hint::black_box;

use palpate_core::detect::DetectError;
use palpate_core::detect::sequential::{Sequential, memory};
use palpate_core::force::Force;
use palpate_core::hid::PAPER as DISPLAY;
use palpate_core::servo::{Command, Input, Mode, Request, Sample, State};
use palpate_firmware::board::{self, Text, instructions, stack_of};
use palpate_firmware::device::{Device, Frame};
use palpate_firmware::digest::draw::Draw;
use palpate_firmware::table::PAPER;
use palpate_firmware::{digest, scenario};

/// The most that a step may take (FIR-005).
const MOST_INSTRUCTIONS: u32 = 1200;
const MOST_STACK: usize = 1024;

#[unsafe(no_mangle)] // the name that the start calls
#[allow(unsafe_code)]
extern "C" fn run() -> ! {
    board::start_timer();
    digest::print(&mut Text);
    let within = device().is_some_and(measured);
    board::exit(if within { 0 } else { 1 })
}

fn device() -> Option<Device<'static>> {
    // As if the table came from somewhere else: the compiler must not compute with its values.
    Device::new(black_box(&PAPER).table()?, &DISPLAY)
}

/// The step as a function that is called, so that call and return are counted.
#[inline(never)]
fn step(device: &mut Device, input: &Input) -> Command {
    device.step(*input)
}

#[inline(never)]
fn cycle(device: &mut Device, frame: &Frame) -> [u8; 8] {
    device.cycle(frame)
}

/// The least and the most of some counts.
#[derive(Clone, Copy)]
struct Range {
    least: u32,
    most: u32,
}

impl Range {
    const NOTHING: Range = Range {
        least: u32::MAX,
        most: 0,
    };

    /// Counts the instructions of `work`.
    fn of<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (count, value) = instructions(work);
        self.least = self.least.min(count);
        self.most = self.most.max(count);
        value
    }
}

/// What a step and a cycle take in the scenario and all over the table.
///
/// Implements: FIR-005.
fn measured(mut device: Device) -> bool {
    let (mut steps, mut stack) = (Range::NOTHING, 0);
    scenario::run(&mut device, |device, input| {
        let mut again = *device;
        stack = stack.max(stack_of(&mut || {
            black_box(step(&mut again, black_box(&input)));
        }));
        steps.of(|| step(device, black_box(&input)))
    });
    let places = all_over_the_table(&mut device);
    let mut cycles = Range::NOTHING;
    for number in 0..scenario::CYCLES {
        let frame = scenario::frame(number);
        cycles.of(|| black_box(cycle(&mut device, black_box(&frame))));
    }
    for (what, Range { least, most }) in [
        ("a step in the scenario", steps),
        ("a step all over the table", places),
        ("a cycle with its reports", cycles),
    ] {
        let _ = writeln!(Text, "instructions of {what}: {least} to {most}");
    }
    let most = steps.most.max(places.most);
    let _ = writeln!(
        Text,
        "a step: at most {most} instructions, at most {MOST_INSTRUCTIONS} allowed"
    );
    let _ = writeln!(
        Text,
        "a step: {stack} bytes of stack, at most {MOST_STACK} allowed"
    );
    most <= MOST_INSTRUCTIONS && stack <= MOST_STACK && pushed() && measures_right()
}

/// What a sequential detector of 16 hypotheses takes for a row, beside the nuisances of FIR-013.
///
/// Implements: FIR-013.
fn pushed() -> bool {
    pushed_beside::<5, { memory(16, 5) }>(40_000) && pushed_beside::<6, { memory(16, 6) }>(60_000)
}

/// Rows beside offset and drift of two channels, gain and, the sixth, depth.
fn pushed_beside<const NUISANCES: usize, const MEMORY: usize>(allowed: u32) -> bool {
    let Ok(mut found) = Sequential::new([0.0; MEMORY], 16, NUISANCES) else {
        return false;
    };
    let mut rows = Range::NOTHING;
    for number in 0..200 {
        let mut draw = Draw::new(number);
        let signals = [(); 16].map(|()| draw.between(-3.0, 3.0));
        let [residual, gain, depth] = [3.0, 9.0, 4.0].map(|most| draw.between(0.0, most));
        let time = (number / 2) as f64;
        let nuisances = match number % 2 {
            0 => [1.0, time, 0.0, 0.0, gain, depth],
            _ => [0.0, 0.0, 1.0, time, gain, depth],
        };
        let (nuisances, signals) = (black_box(&nuisances[..NUISANCES]), black_box(&signals));
        if rows
            .of(|| push(&mut found, residual, nuisances, signals))
            .is_err()
        {
            return false;
        }
    }
    let Range { least, most } = rows;
    let _ = writeln!(
        Text,
        "a row of 16 hypotheses beside {NUISANCES} nuisances: {least} to {most} instructions, at most {allowed} allowed"
    );
    most <= allowed
}

#[inline(never)]
fn push<const N: usize>(
    found: &mut Sequential<[f64; N]>,
    residual: f64,
    nuisances: &[f64],
    signals: &[f64],
) -> Result<(), DetectError> {
    found.push(residual, nuisances, signals)
}

/// Steps in the middle of playing at 120 × 121 places within the table and beyond its sides.
fn all_over_the_table(device: &mut Device) -> Range {
    let mut places = Range::NOTHING;
    for depth in (-10..110).map(|k| k as f32 * 0.05e-3) {
        for lateral in (-60..=60).map(|k| k as f32 * 0.2e-3) {
            device.state = State {
                mode: Mode::Armed,
                force: Force::new(0.4, 0.9),
                sequence: Some(4711),
                ..State::default()
            };
            let sample = Sample {
                sequence: 4712,
                deadman: true,
                device_fault: false,
                depth,
                lateral,
            };
            let input = Input {
                sample: Some(sample),
                request: Request::None,
            };
            places.of(|| black_box(step(device, black_box(&input))));
        }
    }
    places
}

/// A hundred and one instructions are counted as such, and 256 bytes of stack are found.
///
/// Implements: FIR-011.
fn measures_right() -> bool {
    let (counted, ()) = instructions(board::hundred_and_one);
    let stack = stack_of(&mut || {
        black_box([1_u8; 256]);
    });
    let _ = writeln!(
        Text,
        "101 instructions are counted as {counted}, 256 bytes of stack and the call as {stack}"
    );
    counted == 101 && (256..=320).contains(&stack)
}

#[panic_handler]
fn panicked(info: &core::panic::PanicInfo) -> ! {
    let _ = writeln!(Text, "{info}");
    board::exit(101)
}
