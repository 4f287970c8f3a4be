//! A force table of the paper's size, in flash.

use palpate_core::force::Force;
use palpate_core::servo::{Axis, Table};

const DEPTHS: usize = 9;
const LATERALS: usize = 41;

/// What a table is made from, with the reciprocals that the loop does not compute.
#[derive(Debug)]
pub struct Stored {
    depths: [f32; DEPTHS],
    heights: [f32; DEPTHS - 1],
    laterals: [f32; LATERALS],
    widths: [f32; LATERALS - 1],
    forces: [Force<f32>; DEPTHS * LATERALS],
}

/// 9 depths from 0 to 4 mm, 41 lateral positions from −10 to 10 mm; forces up to 2.4 N, uneven enough that nothing cancels.
pub static PAPER: Stored = {
    let depths = knots(0.0);
    let laterals = knots(-20.0);
    let mut forces = [Force::ZERO; DEPTHS * LATERALS];
    let mut index = 0;
    while index < forces.len() {
        let (row, column) = (index / LATERALS, index % LATERALS);
        forces[index] = Force {
            lateral: 3e-3 * row as f32 * ((column * 37 % 101) as f32 - 50.0),
            normal: 3e-3 * row as f32 * (column * 61 % 101) as f32,
        };
        index += 1;
    }
    Stored {
        depths,
        heights: reciprocals(&depths),
        laterals,
        widths: reciprocals(&laterals),
        forces,
    }
};

/// Knots 0.5 mm apart, from `first` half millimetres on.
const fn knots<const N: usize>(first: f32) -> [f32; N] {
    let mut knots = [0.0; N];
    let mut index = 0;
    while index < N {
        knots[index] = (first + index as f32) * 0.5e-3;
        index += 1;
    }
    knots
}

/// As [`Axis::reciprocal_width`] has them.
const fn reciprocals<const N: usize, const CELLS: usize>(knots: &[f32; N]) -> [f32; CELLS] {
    let mut reciprocals = [0.0; CELLS];
    let mut cell = 0;
    while cell < CELLS {
        reciprocals[cell] = 1.0 / (knots[cell + 1] - knots[cell]);
        cell += 1;
    }
    reciprocals
}

impl Stored {
    /// The table, if the kernel takes it.
    pub fn table(&self) -> Option<Table<'_>> {
        let depths = Axis::new(&self.depths, &self.heights).ok()?;
        let laterals = Axis::new(&self.laterals, &self.widths).ok()?;
        Table::new(depths, laterals, &self.forces).ok()
    }
}
