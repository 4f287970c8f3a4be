//! The pose whose deformed mesh a report shows.

use palpate::fem::{FemError, Model, Pose};
use palpate::force_map::ForceMap;
use palpate::phantom::{Inclusion, Phantom};
use palpate_paper::report::DeformedMesh;

/// The place of the phantom that the deformed mesh shows: that of the first inclusion, or the reference where there is none.
pub fn shown(phantoms: &[Phantom]) -> usize {
    usize::from(phantoms.len() > 1)
}

/// The mesh at the deepest pose, at the lateral position nearest to the middle of the first inclusion, or to x = 0.
pub fn deformed_mesh(model: &Model, map: &ForceMap) -> Result<DeformedMesh, FemError> {
    let depth = map.table().depths().iter().fold(0.0, |a: f64, &b| a.max(b));
    let first = model.phantom().inclusions().first();
    let [left, right, ..] = first.map_or([0.0; 4], Inclusion::extent);
    let distance = |x: f64| (x - 0.5 * (left + right)).abs();
    let laterals = map.table().laterals().iter().copied();
    let nearest = laterals.min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let lateral = nearest.unwrap_or(0.0);
    DeformedMesh::solve(model, Pose { depth, lateral })
}
