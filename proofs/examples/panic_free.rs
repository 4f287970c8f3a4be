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

#[no_panic]
fn step(table: &Table, limits: &Limits, state: State, input: Input) -> (State, Command) {
    #[cfg(planted_panic)]
    assert!(state.missed != 12345, "planted");
    palpate_core::servo::step(table, limits, state, input)
}

#[no_panic]
fn force(table: &Table, depth: f32, lateral: f32) -> Force<f32> {
    table.force(depth, lateral)
}

#[no_panic]
fn force_in(table: &Table, depth: Cell, lateral: Cell) -> Force<f32> {
    table.force_in(depth, lateral)
}

#[no_panic]
fn locate(axis: &Axis, position: f32) -> Cell {
    axis.locate(position)
}

#[no_panic]
fn limited(value: f32, largest: f32) -> f32 {
    limit(value, largest)
}

#[no_panic]
fn axis<'a>(knots: &'a [f32], reciprocals: &'a [f32]) -> Option<Axis<'a>> {
    Axis::new(knots, reciprocals).ok()
}

#[no_panic]
fn table<'a>(depths: Axis<'a>, laterals: Axis<'a>, forces: &'a [Force<f32>]) -> Option<Table<'a>> {
    Table::new(depths, laterals, forces).ok()
}

#[no_panic]
fn limits(force: f32, slew: f32, release: f32, watchdog: u16) -> Option<Limits> {
    Limits::new(force, slew, release, watchdog).ok()
}

#[no_panic]
fn decode_position(bytes: &[u8]) -> Result<PositionReport, InvalidReport> {
    PositionReport::decode(bytes)
}

#[no_panic]
fn decode_force(bytes: &[u8]) -> Result<ForceReport, InvalidReport> {
    ForceReport::decode(bytes)
}

#[no_panic]
fn decode_capabilities(bytes: &[u8]) -> Result<Capabilities, InvalidReport> {
    Capabilities::decode(bytes)
}

#[no_panic]
fn decode_control(bytes: &[u8]) -> Result<Control, InvalidReport> {
    Control::decode(bytes)
}

#[no_panic]
fn encode(
    position: &PositionReport,
    force: &ForceReport,
    capabilities: &Capabilities,
    control: Control,
) -> ([u8; 11], [u8; 8], [u8; 17], [u8; 2]) {
    (
        position.encode(),
        force.encode(),
        capabilities.encode(),
        control.encode(),
    )
}

#[no_panic]
fn units(capabilities: &Capabilities) -> Option<Units> {
    Units::new(capabilities).ok()
}

#[no_panic]
fn sample(units: &Units, report: &PositionReport) -> Sample {
    units.sample(report)
}

#[no_panic]
fn report(units: &Units, command: &Command, sequence: u16) -> ForceReport {
    units.report(command, sequence)
}

#[no_panic]
fn counted(value: f32) -> i16 {
    count(value)
}

/// Calls everything with values that the compiler cannot know, so that nothing is left out.
fn main() {
    let knots = black_box([0.0, 0.25, 1.0]);
    let reciprocals = black_box([4.0, 1.0 / 0.75]);
    let forces = black_box([Force::ZERO; 9]);
    let Some(axis) = axis(&knots, &reciprocals) else {
        return;
    };
    let Some(table) = table(axis, axis, &forces) else {
        return;
    };
    let Some(limits) = limits(
        black_box(2.0),
        black_box(0.01),
        black_box(0.2),
        black_box(5),
    ) else {
        return;
    };
    let cell = locate(&axis, black_box(0.5));
    black_box(force(&table, black_box(0.5), black_box(0.5)));
    black_box(force_in(&table, cell, black_box(cell)));
    black_box(limited(black_box(3.0), black_box(2.0)));
    black_box(counted(black_box(3.0)));

    let bytes = black_box(vec![1; 11]);
    let Ok(position) = decode_position(&bytes) else {
        return;
    };
    let (Ok(played), Ok(capabilities), Ok(control)) = (
        decode_force(&black_box([2; 8])),
        decode_capabilities(&black_box([3; 17])),
        decode_control(&black_box([4, 1])),
    ) else {
        return;
    };
    black_box(encode(&position, &played, &capabilities, control));
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
