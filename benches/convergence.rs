//! Richardson study of the paper's forces (requirement FEM-021): `cargo bench --bench convergence`.
//!
//! A mesh of 1.5 mm is refined uniformly three times (1, 2, 4, 8; the last has some 100 000 nodes). Where the
//! differences of the last three shrink as they should, their observed order, kept between 1 and 4, gives the
//! limit; else the order is taken as 1, the worst that a corner leaves. The default mesh is compared with it.
//! Takes about two minutes and 1 GB on one core.

use palpate::fem::{Contact, MeshOptions, Model};
use palpate::force_map::ForceMap;
use palpate::phantom::{BUILTIN_NAMES, Phantom};

const COARSEST: f64 = 1.5e-3;

fn main() {
    let depths: Vec<f64> = (1..=8).map(|k| f64::from(k) * 0.5e-3).collect();
    let laterals: Vec<f64> = (0..=20).map(|k| f64::from(k) * 0.5e-3).collect();
    println!(
        "phantom  nodes (default, finest)  largest error of the default mesh: normal force, lateral force"
    );
    for name in BUILTIN_NAMES {
        let phantom = Phantom::builtin(name).expect("a built-in name");
        let solve = |size: f64, refinement: usize| -> (usize, ForceMap) {
            let options = MeshOptions {
                size,
                refinement,
                ..MeshOptions::default()
            };
            let model = Model::new(&phantom, &options, Contact::default()).expect("a model");
            (
                model.mesh().nodes.len(),
                model.map(&depths, &laterals, &|_| ()).expect("a map"),
            )
        };
        let (nodes, default) = solve(MeshOptions::default().size, 1);
        let levels = [2, 4, 8].map(|refinement| solve(COARSEST, refinement));
        let (coarsest_nodes, coarsest) = solve(COARSEST, 1);
        let mut worst_normal = (0.0f64, 0.0, 0.0);
        let mut worst_lateral = (0.0f64, 0.0, 0.0);
        let mut coarse_worst = 0.0f64;
        for (row, depth) in depths.iter().enumerate() {
            for (column, lateral) in laterals.iter().enumerate() {
                let normal = |map: &ForceMap| map.normal_force().row(row)[column];
                let along = |map: &ForceMap| map.lateral_force().row(row)[column];
                let converged = limit(levels.each_ref().map(|(_, map)| normal(map)));
                let error = 100.0 * (normal(&default) / converged - 1.0).abs();
                coarse_worst =
                    coarse_worst.max(100.0 * (normal(&coarsest) / converged - 1.0).abs());
                if error > worst_normal.0 {
                    worst_normal = (error, depth * 1e3, lateral * 1e3);
                }
                let error = 1e3
                    * (along(&default) - limit(levels.each_ref().map(|(_, map)| along(map)))).abs();
                if error > worst_lateral.0 {
                    worst_lateral = (error, depth * 1e3, lateral * 1e3);
                }
            }
        }
        let [(error, depth, x), (lateral_error, lateral_depth, lateral_x)] =
            [worst_normal, worst_lateral];
        println!(
            "{name:>7}  {nodes:>6} {:>8}  {error:.3} % at d = {depth} mm, x = {x} mm;  {lateral_error:.2} mN at d = {lateral_depth} mm, x = {lateral_x} mm  ({coarsest_nodes} nodes: {coarse_worst:.2} %)",
            levels[2].0
        );
    }
}

/// The limit of three values on meshes of which each halves the cells of the one before.
fn limit([coarse, middle, fine]: [f64; 3]) -> f64 {
    let ratio = (middle - coarse) / (fine - middle);
    let factor = if ratio >= 2.0 { ratio.min(16.0) } else { 2.0 };
    fine + (fine - middle) / (factor - 1.0)
}
