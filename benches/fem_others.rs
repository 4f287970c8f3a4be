//! palpate's half of the comparison with other programs: see `fem_others.py`, which runs it.
//!
//! Writes the mesh, the surface, loads on it and the displacements that palpate finds into the file that the
//! argument names, with the times of its own steps.

use std::fmt::Write;
use std::time::Instant;

use palpate::fem::assembly::{StiffnessMatrix, material_of};
use palpate::fem::cholesky::Factor;
use palpate::fem::{Mesh, MeshOptions};
use palpate::phantom::Phantom;

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
    let mut best = [f64::INFINITY; 3];
    let mut last = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        let mesh = Mesh::new(&phantom, &MeshOptions::default()).expect("a mesh");
        let matrix = StiffnessMatrix::assemble(&mesh, &phantom).expect("a matrix");
        let assembled = start.elapsed().as_secs_f64();
        let factor = Factor::new(&matrix).expect("a factor");
        let factorised = start.elapsed().as_secs_f64();
        let compliance = factor.surface_compliance();
        let times = [assembled, factorised, start.elapsed().as_secs_f64()];
        for (best, time) in best.iter_mut().zip(times) {
            *best = best.min(time);
        }
        last = Some((mesh, compliance));
    }
    let Some((mesh, compliance)) = last else {
        return;
    };
    let unknowns = compliance.order();
    // A bump around x = 3 mm that pushes down and to the right, N.
    let surface = mesh.surface();
    let load: Vec<f64> = (surface.clone())
        .flat_map(|node| {
            let bump =
                libm::exp(-(mesh.nodes[node][0] - 3e-3) * (mesh.nodes[node][0] - 3e-3) / 8e-6);
            [0.003 * bump, -0.01 * bump]
        })
        .collect();
    let displacement = |row: usize| -> f64 {
        (0..unknowns)
            .map(|column| compliance[(row, column)] * load[column])
            .sum()
    };
    let mut text = String::new();
    let list = |text: &mut String, name: &str, values: &mut dyn Iterator<Item = String>| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name} {}", values.collect::<Vec<_>>().join(" "));
    };
    list(&mut text, "times_s", &mut best.iter().map(f64::to_string));
    list(
        &mut text,
        "length_m",
        &mut [phantom.probe.length.to_string()].into_iter(),
    );
    list(
        &mut text,
        "nodes_m",
        &mut mesh.nodes.as_flattened().iter().map(f64::to_string),
    );
    list(
        &mut text,
        "connectivity",
        &mut mesh.connectivity.iter().map(u32::to_string),
    );
    let materials = mesh
        .regions
        .iter()
        .map(|&region| material_of(&phantom, region));
    list(
        &mut text,
        "youngs_modulus_pa",
        &mut materials.clone().map(|m| m.youngs_modulus.to_string()),
    );
    list(
        &mut text,
        "poisson_ratio",
        &mut materials.map(|m| m.poisson_ratio.to_string()),
    );
    let fixed = mesh
        .free()
        .into_iter()
        .map(|free| u8::from(!free).to_string());
    list(&mut text, "fixed", &mut fixed.into_iter());
    list(
        &mut text,
        "surface",
        &mut surface.map(|node| node.to_string()),
    );
    list(&mut text, "load_n", &mut load.iter().map(f64::to_string));
    list(
        &mut text,
        "displacement_m",
        &mut (0..unknowns).map(|row| displacement(row).to_string()),
    );
    std::fs::write(&path, text).expect("a file that can be written");
}
