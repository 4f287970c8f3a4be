//! γ of a tactile array under the probe, beside γ of the total force.
//!
//! The array is n elements of equal width, side by side over the probe's width, which move with the probe. Each element reads the force
//! normal to the probe with the noise s/√n, so that all n together have the noise s of one force sensor. Then
//! γ² = Σ n (p₁ − p₀)²/s² over the positions of a sweep and the elements, for forces p₁ with and p₀ without the inclusion.
//!
//! ```text
//! cargo run --release -p palpate --example tactile_array
//! ```

use std::error::Error;

use palpate::fem::{Contact, MESH_SIZE, Model, Pose, PoseSolution};
use palpate::phantom::Phantom;

/// Noise of one force sensor, N: the paper's estimate for its subjects.
const NOISE_SD_N: f64 = 0.235;
const DEPTH_M: f64 = 4e-3;
const ELEMENTS: [usize; 6] = [1, 2, 4, 8, 16, FINEST];
/// The largest number of elements, which all others divide.
const FINEST: usize = 32;

/// What is read at one position, N: the lateral and the normal force on the probe, and the force on each element of the finest array.
type Reading = ([f64; 2], [f64; FINEST]);

/// The readings as the probe sweeps over `phantom`.
fn sweep(phantom: &Phantom) -> Result<Vec<Reading>, Box<dyn Error>> {
    let model = Model::new(phantom, MESH_SIZE, Contact::default())?;
    let laterals = (-20..=20).map(|half_mm| f64::from(half_mm) / 2e3);
    let read = |lateral| {
        let depth = DEPTH_M;
        let solution = model.solve(Pose { depth, lateral })?;
        let total = [solution.force.lateral, solution.force.normal];
        Ok((total, elements(&model, &solution)?))
    };
    laterals.map(read).collect()
}

/// The force on each element. An edge at the surface carries the force of its two contact points, spread evenly over its deformed
/// length; what lies beyond an end of the array counts to the last element there.
fn elements(model: &Model, solution: &PoseSolution) -> Result<[f64; FINEST], Box<dyn Error>> {
    let (mesh, radius) = (model.mesh(), model.phantom().probe().radius);
    let displacements = model.field(solution)?.displacements;
    // Every other node at the surface is the middle of an edge.
    let corners = mesh.surface.iter().step_by(2);
    let corners = corners
        .map(|&node| mesh.nodes[node][0] + displacements[node][0] - solution.pose.lateral)
        .collect::<Vec<f64>>();
    let mut forces = [0.0; FINEST];
    let contact = solution
        .contact()
        .ok_or("an array on a gel at finite strain")?;
    for &point in &contact.active {
        let [left, right] = [0, 1].map(|end: usize| corners[point / 2 + end]);
        // The part of the edge left of border k.
        let part = |k: usize| match k {
            0 => 0.0,
            FINEST => 1.0,
            k => {
                let border = radius * (2.0 * k as f64 / FINEST as f64 - 1.0);
                ((border - left) / (right - left)).clamp(0.0, 1.0)
            }
        };
        for (k, force) in forces.iter_mut().enumerate() {
            *force += contact.pressures[point] * (part(k + 1) - part(k));
        }
    }
    Ok(forces)
}

/// γ of what pairs of readings differ by, with neighbours merged `by` so many, each sum in noise of `noise_sd_n`.
fn gamma<'a>(pairs: impl Iterator<Item = [&'a [f64]; 2]>, by: usize, noise_sd_n: f64) -> f64 {
    let squares = pairs.flat_map(|[with, without]| {
        let merged = with.chunks(by).zip(without.chunks(by));
        merged.map(|(with, without)| {
            let difference = with.iter().sum::<f64>() - without.iter().sum::<f64>();
            difference * difference
        })
    });
    squares.sum::<f64>().sqrt() / noise_sd_n
}

fn main() -> Result<(), Box<dyn Error>> {
    let without = sweep(&Phantom::builtin("none")?)?;
    println!("inclusion  total force  arrays of {ELEMENTS:?} elements");
    for name in ["2.6", "4.6", "6.6", "8.6"] {
        let with = sweep(&Phantom::builtin(name)?)?;
        let pairs = || with.iter().zip(&without);
        let totals = pairs().map(|(a, b)| [&a.0[..], &b.0[..]]);
        print!("{name} mm {:16.3}", gamma(totals, 1, NOISE_SD_N));
        for n in ELEMENTS {
            let arrays = pairs().map(|(a, b)| [&a.1[..], &b.1[..]]);
            let noise_sd_n = NOISE_SD_N / (n as f64).sqrt();
            print!("  {:.3}", gamma(arrays, FINEST / n, noise_sd_n));
        }
        println!();
    }
    Ok(())
}
