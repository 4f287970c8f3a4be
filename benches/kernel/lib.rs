//! What both benches of the servo kernel step: a table of the paper's size and a state to start from.

use palpate_core::force::Force;
use palpate_core::servo::{Axis, InvalidAxis, Mode, Sample, State, Table};

const DEPTHS: usize = 9;
const LATERALS: usize = 41;

/// 9 depths × 41 lateral positions, 2⁻¹¹ m (0.49 mm) apart.
#[derive(Debug)]
pub struct PaperTable {
    depths: [f32; DEPTHS],
    laterals: [f32; LATERALS],
    reciprocal_widths: [f32; LATERALS - 1],
    forces: Vec<Force<f32>>,
}

impl Default for PaperTable {
    /// Forces in both components, uneven enough that nothing cancels.
    fn default() -> PaperTable {
        let force = |node: usize, phase: f32| {
            let (row, column) = ((node / LATERALS) as f32, (node % LATERALS) as f32);
            0.15 * row * (1.0 + (0.37 * (column - 20.0) + phase).sin())
        };
        let forces =
            (0..DEPTHS * LATERALS).map(|node| Force::new(force(node, 1.0), force(node, 0.0)));
        PaperTable {
            depths: std::array::from_fn(|row| row as f32 / 2048.0),
            laterals: std::array::from_fn(|column| (column as f32 - 20.0) / 2048.0),
            reciprocal_widths: [2048.0; LATERALS - 1],
            forces: forces.collect(),
        }
    }
}

impl PaperTable {
    /// The table that the kernel reads.
    ///
    /// # Errors
    /// Never.
    pub fn table(&self) -> Result<Table<'_>, InvalidAxis> {
        let widths = &self.reciprocal_widths;
        let depths = Axis::new(&self.depths, &widths[..DEPTHS - 1])?;
        let laterals = Axis::new(&self.laterals, widths)?;
        Ok(Table::new(depths, laterals, &self.forces).expect("a force for each node"))
    }
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
