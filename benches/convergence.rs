//! Richardson study of the paper's forces (requirements FEM-021, FEM-025, FEM-028):
//! `cargo bench --bench convergence`.
//!
//! A mesh of 1.5 mm is refined uniformly three times (2, 4, 8; the last has some 250 000 nodes). Where the
//! differences of the three shrink as they should, their observed order, kept between 1 and 4, gives the
//! limit; else the order is taken as 1, the worst that a corner leaves. The default mesh is compared with it, and
//! its bands are counted that hold the limit. Takes some minutes and 1 GB on one core.

use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, MeshOptions, Model};
use palpate::force_map::{ForceMap, Matrix};
use palpate::phantom::{BUILTIN_NAMES, Phantom};

const COARSEST: f64 = 1.5e-3;

/// The largest error of one kind of force, its pose in mm, and how many lie in their bands.
#[derive(Default)]
struct Errors {
    largest: f64,
    depth: f64,
    lateral: f64,
    within: usize,
}

fn main() {
    let depths: Vec<f64> = (1..=8).map(|k| f64::from(k) * 0.5e-3).collect();
    let laterals: Vec<f64> = (0..=20).map(|k| f64::from(k) * 0.5e-3).collect();
    println!(
        "phantom  nodes (default, finest)  largest error of the default mesh: normal force, lateral force (forces in their bands)"
    );
    for name in BUILTIN_NAMES {
        let phantom = Phantom::builtin(name).expect("a built-in name");
        let model = |size: f64, refinement: usize| {
            let options = MeshOptions {
                size,
                refinement,
                ..MeshOptions::default()
            };
            Model::new(&phantom, &options, Contact::default()).expect("a model")
        };
        let default = model(MeshOptions::default().size, 1);
        let map = certified_map(&default, &depths, &laterals, &|_| ()).expect("a map");
        let levels = [2, 4, 8].map(|refinement| {
            let model = model(COARSEST, refinement);
            let map = model.map(&depths, &laterals, &|_| ()).expect("a map");
            (model.mesh().nodes.len(), map)
        });
        let bands = map
            .certificate()
            .and_then(|c| c.discretization.as_ref())
            .expect("bands");
        // Normal forces in per cent of the force, lateral ones in mN.
        let errors = |force: fn(&ForceMap) -> &Matrix, bands: &Matrix, relative: bool| {
            let mut errors = Errors::default();
            for (row, column, found) in force(&map).entries() {
                let of_level = |(_, map): &(usize, ForceMap)| force(map).row(row)[column];
                let converged = limit(levels.each_ref().map(of_level));
                let error = (found - converged).abs();
                errors.within += usize::from(error <= bands.row(row)[column]);
                let scaled = if relative {
                    100.0 * error / converged
                } else {
                    1e3 * error
                };
                if scaled > errors.largest {
                    errors.largest = scaled;
                    (errors.depth, errors.lateral) = (1e3 * depths[row], 1e3 * laterals[column]);
                }
            }
            errors
        };
        let normal = errors(ForceMap::normal_force, &bands.normal_force_band, true);
        let lateral = errors(ForceMap::lateral_force, &bands.lateral_force_band, false);
        println!(
            "{name:>7}  {:>6} {:>8}  {:.3} % at d = {} mm, x = {} mm ({} of {});  {:.2} mN at d = {} mm, x = {} mm ({})",
            default.mesh().nodes.len(),
            levels[2].0,
            normal.largest,
            normal.depth,
            normal.lateral,
            normal.within,
            depths.len() * laterals.len(),
            lateral.largest,
            lateral.depth,
            lateral.lateral,
            lateral.within,
        );
    }
}

/// The limit of three values on meshes of which each halves the cells of the one before.
fn limit([coarse, middle, fine]: [f64; 3]) -> f64 {
    if fine == middle {
        return fine;
    }
    let ratio = (middle - coarse) / (fine - middle);
    let factor = if ratio >= 2.0 { ratio.min(16.0) } else { 2.0 };
    fine + (fine - middle) / (factor - 1.0)
}
