//! Force maps for the tests.

use palpate::force::Force;
use palpate::force_map::{
    Certificate, ForceMap, ForceTable, Matrix, Measurement, SmallestDet, Source,
};
use palpate::phantom::Phantom;

/// A table of the forces, lateral and normal, that `force` gives for a depth and a lateral position.
pub fn table_of(
    depths: &[f64],
    laterals: &[f64],
    force: impl Fn(f64, f64) -> [f64; 2],
) -> ForceTable {
    let matrix = |channel: usize| {
        let at = |row: usize, column: usize| force(depths[row], laterals[column])[channel];
        Matrix::from_fn(depths.len(), laterals.len(), at)
    };
    let forces = Force::new(matrix(0), matrix(1));
    ForceTable::new(depths.into(), laterals.into(), forces).unwrap()
}

/// A measured map, of a phantom if it is known.
pub fn measured(phantom: Option<Phantom>, table: ForceTable) -> ForceMap {
    let source = Source::Measured(Measurement::new("gel.csv", ""));
    ForceMap::new(source, phantom, table).unwrap()
}

/// A certificate with plausible numbers.
pub fn certificate(min_det: Matrix, smallest_det: SmallestDet) -> Certificate {
    Certificate {
        worst_relative_residual: 1e-13,
        worst_force_balance: 2e-10,
        largest_penetration: 3e-12,
        newton_iterations: 40,
        mesh_size: 0.0005,
        nodes: 6000,
        elements: 3000,
        element: "t6".into(),
        contact: "deformed-normal".into(),
        law: None,
        arithmetic: "other".into(),
        smallest_det,
        min_det,
        discretization: None,
    }
}
