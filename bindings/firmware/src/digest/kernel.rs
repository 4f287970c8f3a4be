//! Questions to the servo kernel and the units: tables of 5 × 5 nodes, a few of which are refused.

use core::array::from_fn;

use palpate_core::force::Force;
use palpate_core::hid::{
    Capabilities, ForceReport, InvalidCapabilities, PAPER, PositionReport, Units,
};
use palpate_core::servo::{
    Axis, Cell, Command, Fault, Input, Limits, Mode, Request, Sample, State, Table, step, stiffness,
};

use super::draw::Draw;

type Knots = ([f32; 5], [f32; 4]);

fn knots(draw: &mut Draw) -> Knots {
    let mut next = draw.between(-0.01, 0.0) as f32;
    let knots = [(); 5].map(|()| {
        next += if draw.once_in(64) {
            draw.single(0.0, 0.0)
        } else {
            draw.between(1e-4, 5e-3) as f32
        };
        next
    });
    (
        knots,
        from_fn(|cell| Axis::reciprocal_width(knots[cell], knots[cell + 1])),
    )
}

fn axis((knots, reciprocals): &Knots) -> Option<Axis<'_>> {
    Axis::new(knots, reciprocals).ok()
}

fn place(draw: &mut Draw) -> f32 {
    draw.single(-0.02, 0.03)
}

pub fn located(draw: &mut Draw) -> Option<Cell> {
    Some(axis(&knots(draw))?.locate(place(draw)))
}

fn with_table<T>(draw: &mut Draw, ask: impl FnOnce(&mut Draw, &Table) -> T) -> Option<T> {
    let (depths, laterals) = (knots(draw), knots(draw));
    let mut forces =
        [Force::ZERO; 25].map(|force| force.map(|_: f32| draw.between(-3.0, 3.0) as f32));
    if draw.once_in(16) {
        forces[0].normal = draw.single(-99.0, 99.0);
    }
    let table = Table::new(axis(&depths)?, axis(&laterals)?, &forces).ok()?;
    Some(ask(draw, &table))
}

pub fn force(draw: &mut Draw) -> Option<Force<f32>> {
    with_table(draw, |draw, table| table.force(place(draw), place(draw)))
}

pub fn stiffest(draw: &mut Draw) -> Option<f64> {
    with_table(draw, |_, table| stiffness(table))
}

/// A cycle from any state, also one that no step leaves.
pub fn stepped(draw: &mut Draw) -> Option<(State, Command)> {
    const FAULTS: [Fault; 4] = [
        Fault::NotFinite,
        Fault::Device,
        Fault::Watchdog,
        Fault::State,
    ];
    let limits = Limits::new(
        draw.single(1.0, 9.0),
        draw.between(0.0, 0.4) as f32,
        draw.between(0.4, 3.0) as f32,
        9,
    );
    let any = draw.word();
    let state = State {
        mode: match any % 16 {
            0 => Mode::Disarmed,
            fault @ 1..5 => Mode::Faulted(FAULTS[fault as usize - 1]),
            _ => Mode::Armed,
        },
        force: Force::new(0.0, 0.0).map(|_: f64| {
            if any & 16 == 0 {
                draw.single(-2.0, 2.0)
            } else {
                0.0
            }
        }),
        sequence: (any & 0xE0 != 0).then_some((any >> 8) as u16),
        missed: (any >> 24) as u16 % 12,
        arming: any & 1 << 40 != 0,
    };
    let sample = Sample {
        sequence: ((any >> 8) as u16)
            .wrapping_add([1, 1, 1, 2, 0, 9, 40_000, 65_535][(any >> 41) as usize % 8]),
        deadman: any & 3 << 44 != 0,
        device_fault: any >> 46 & 15 == 0,
        depth: place(draw),
        lateral: place(draw),
    };
    let request =
        [Request::None, Request::Arm, Request::Disarm, Request::None][(any >> 50) as usize % 4];
    let sample = (any >> 52 & 7 != 0).then_some(sample);
    with_table(draw, |_, table| {
        Some(step(table, &limits.ok()?, state, Input { sample, request }))
    })?
}

/// A report in metres, and a command in counts, on any device.
pub fn converted(draw: &mut Draw) -> Result<(Sample, ForceReport), InvalidCapabilities> {
    let units = Units::new(&Capabilities {
        position_unit_nm: draw.word() as u16,
        force_unit_un: draw.word() as u16,
        ..PAPER
    })?;
    let [lateral, normal] = [(); 2].map(|()| draw.word() as i16);
    let report = PositionReport {
        lateral,
        normal,
        buttons: draw.word() as u8,
        status: draw.word() as u8,
        ..PositionReport::default()
    };
    let force = Force::new(draw.single(-20.0, 20.0), draw.single(-20.0, 20.0));
    let command = Command {
        force,
        playing: true,
    };
    Ok((
        units.sample(&report),
        units.report(&command, draw.word() as u16),
    ))
}
