//! Links only if no function below has a path to a panic left after optimisation: `no_panic` puts an
//! undefined symbol onto every such path. Built by `tests/link_time.rs`.

use std::hint::black_box;

use no_panic::no_panic;
use palpate_core::force::Force;
use palpate_core::hid::{
    Capabilities, Control, ForceReport, InvalidReport, PositionReport, Units, count,
};
use palpate_core::servo::{
    Axis, Cell, Command, Input, Limits, Request, Sample, State, Table, limit,
};

/// Functions that call one of the core each, and have no path to a panic.
macro_rules! without_panic {
    ($($name:ident($($argument:ident: $of:ty),+) -> $answer:ty = $call:expr;)+) => {$(
        #[no_panic]
        fn $name($($argument: $of),+) -> $answer {
            $call
        }
    )+};
}

without_panic! {
    force(table: &Table, depth: f32, lateral: f32) -> Force<f32> = table.force(depth, lateral);
    force_in(table: &Table, depth: Cell, lateral: Cell) -> Force<f32> = table.force_in(depth, lateral);
    locate(axis: &Axis, position: f32) -> Cell = axis.locate(position);
    limited(value: f32, largest: f32) -> f32 = limit(value, largest);
    limits(force: f32, slew: f32, release: f32, watchdog: u16) -> Option<Limits> =
        Limits::new(force, slew, release, watchdog).ok();
    decode_position(bytes: &[u8]) -> Result<PositionReport, InvalidReport> = PositionReport::decode(bytes);
    decode_force(bytes: &[u8]) -> Result<ForceReport, InvalidReport> = ForceReport::decode(bytes);
    decode_capabilities(bytes: &[u8]) -> Result<Capabilities, InvalidReport> = Capabilities::decode(bytes);
    decode_control(bytes: &[u8]) -> Result<Control, InvalidReport> = Control::decode(bytes);
    encode_position(report: &PositionReport) -> [u8; 11] = report.encode();
    encode_force(report: &ForceReport) -> [u8; 8] = report.encode();
    encode_capabilities(report: &Capabilities) -> [u8; 17] = report.encode();
    encode_control(report: Control) -> [u8; 2] = report.encode();
    units(capabilities: &Capabilities) -> Option<Units> = Units::new(capabilities).ok();
    sample(units: &Units, report: &PositionReport) -> Sample = units.sample(report);
    report(units: &Units, command: &Command, sequence: u16) -> ForceReport = units.report(command, sequence);
    counted(value: f32) -> i16 = count(value);
}

#[no_panic]
fn step(table: &Table, limits: &Limits, state: State, input: Input) -> (State, Command) {
    #[cfg(planted_panic)]
    assert!(state.missed != 12345, "planted");
    palpate_core::servo::step(table, limits, state, input)
}

#[no_panic]
fn axis<'a>(knots: &'a [f32], reciprocals: &'a [f32]) -> Option<Axis<'a>> {
    Axis::new(knots, reciprocals).ok()
}

#[no_panic]
fn table<'a>(depths: Axis<'a>, laterals: Axis<'a>, forces: &'a [Force<f32>]) -> Option<Table<'a>> {
    Table::new(depths, laterals, forces).ok()
}

/// Calls everything with values that the compiler cannot know, so that nothing is left out.
fn main() {
    let knots = black_box([0.0, 0.25, 1.0]);
    let reciprocals = black_box([4.0, 1.0 / 0.75]);
    let forces = black_box([Force::ZERO; 9]);
    let limits = limits(
        black_box(2.0),
        black_box(0.01),
        black_box(0.2),
        black_box(5),
    );
    let (Some(axis), Some(limits)) = (axis(&knots, &reciprocals), limits) else {
        return;
    };
    let Some(table) = table(axis, axis, &forces) else {
        return;
    };
    let cell = locate(&axis, black_box(0.5));
    black_box(force(&table, black_box(0.5), black_box(0.5)));
    black_box(force_in(&table, cell, black_box(cell)));
    black_box(limited(black_box(3.0), black_box(2.0)));
    black_box(counted(black_box(3.0)));

    let bytes = black_box(vec![1; 11]);
    let (Ok(position), Ok(played), Ok(capabilities), Ok(control)) = (
        decode_position(&bytes),
        decode_force(&black_box([2; 8])),
        decode_capabilities(&black_box([3; 17])),
        decode_control(&black_box([4, 1])),
    ) else {
        return;
    };
    black_box((encode_position(&position), encode_force(&played)));
    black_box((encode_capabilities(&capabilities), encode_control(control)));
    let Some(units) = units(&black_box(capabilities)) else {
        return;
    };
    let input = Input {
        sample: black_box(Some(sample(&units, &position))),
        request: black_box(Request::Arm),
    };
    let (state, command) = step(&table, &limits, black_box(State::default()), input);
    black_box(state);
    black_box(report(&units, &command, black_box(1)));
}
