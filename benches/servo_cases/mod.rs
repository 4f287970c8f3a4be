//! What both benches of the servo kernel step: a table of the paper's size and states to start from.

use palpate::force::Force;
use palpate::force_map::{ForceTable, Matrix};
use palpate::servo::{LoadedTable, Mode, Sample, State};

/// 9 depths × 41 lateral positions, both components, uneven enough that nothing cancels.
pub fn paper_table() -> LoadedTable {
    let depths: Vec<f64> = (0..9).map(|row| f64::from(row) * 0.5e-3).collect();
    let laterals: Vec<f64> = (-20..=20)
        .map(|column| f64::from(column) * 0.5e-3)
        .collect();
    let force = |row: usize, column: usize, phase: f64| {
        0.15 * row as f64 * (1.0 + (0.37 * column as f64 + phase).sin())
    };
    let normal = Matrix::from_fn(9, 41, |row, column| force(row, column, 0.0));
    let lateral = Matrix::from_fn(9, 41, |row, column| force(row, column, 1.0));
    let forces =
        ForceTable::new(depths, laterals, Force::new(lateral, normal)).expect("the axes increase");
    LoadedTable::new(&forces).expect("the servo takes it")
}

/// The kernel in the middle of playing.
pub fn armed() -> State {
    State {
        mode: Mode::Armed,
        force: Force::new(0.4, 0.9),
        sequence: Some(4711),
        missed: 0,
        arming: false,
    }
}

/// A fresh sample inside the table.
pub fn sample() -> Sample {
    Sample {
        sequence: 4712,
        deadman: true,
        device_fault: false,
        depth: 2.2e-3,
        lateral: 3.3e-3,
    }
}
