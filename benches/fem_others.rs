//! palpate's half of the comparison with other programs: see `fem_others.py`, which runs it.
//!
//! Writes the mesh, a load on the surface and the displacements there that palpate finds, as JSON into the file that
//! the argument names, with the times of its own steps.

use std::time::Instant;

use palpate::fem::assembly::StiffnessMatrix;
use palpate::fem::cholesky::Factor;
use palpate::fem::{MESH_SIZE, Mesh};
use palpate::phantom::{Material, Phantom};
use serde_json::json;

const RUNS: usize = 5;

fn main() {
    let Some(path) = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with("--"))
    else {
        // `cargo bench` runs every bench; this one has nothing to say by itself.
        println!("fem_others: run benches/fem_others.py");
        return;
    };
    let phantom = Phantom::builtin("2.6").expect("a built-in name");
    let mesh = Mesh::new(&phantom, MESH_SIZE).expect("a mesh");
    let run = || {
        let start = Instant::now();
        let matrix = StiffnessMatrix::assemble(&mesh, &phantom).expect("a matrix");
        let assembled = start.elapsed().as_secs_f64();
        let factor = Factor::new(&matrix).expect("a factor");
        let factorised = start.elapsed().as_secs_f64();
        let compliance = factor.surface_compliance(&matrix).expect("a compliance");
        let times = [assembled, factorised, start.elapsed().as_secs_f64()];
        (times, compliance)
    };
    let (mut best, compliance) = run();
    for _ in 1..RUNS {
        for (best, time) in best.iter_mut().zip(run().0) {
            *best = best.min(time);
        }
    }
    // A bump around x = 3 mm that pushes down and to the right, N; the walls hold the outermost nodes.
    let places = 1..mesh.surface.len() - 1;
    let surface = &mesh.surface[places.clone()];
    let load = |&node: &usize| {
        let x = mesh.nodes[node][0] - 3e-3;
        let bump = (-x * x / 8e-6).exp();
        [0.003 * bump, -0.01 * bump]
    };
    let load: Vec<f64> = surface.iter().flat_map(load).collect();
    let displacement = |row: usize| -> f64 {
        let columns = 2 * places.start..2 * places.end;
        let products = columns
            .zip(&load)
            .map(|(column, load)| compliance[(row, column)] * load);
        products.sum()
    };
    let moduli = |of: fn(&Material) -> f64| -> Vec<f64> {
        let regions = mesh.regions.iter();
        regions
            .map(|region| of(region.material(&phantom)))
            .collect()
    };
    let answer = json!({
        "times_s": best,
        "length_m": phantom.probe().length,
        "nodes_m": mesh.nodes,
        "connectivity": mesh.connectivity,
        "youngs_modulus_pa": moduli(|material| material.youngs_modulus),
        "poisson_ratio": moduli(|material| material.poisson_ratio),
        "held": mesh.held.iter().map(|held| held[0]).collect::<Vec<_>>(),
        "surface": surface,
        "load_n": load,
        "displacement_m": (2 * places.start..2 * places.end).map(displacement).collect::<Vec<_>>(),
    });
    std::fs::write(&path, answer.to_string()).expect("a file that can be written");
}
