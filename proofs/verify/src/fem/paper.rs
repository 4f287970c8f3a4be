//! Calculation verification: how good the forces of the paper's poses are on the default mesh.

use super::full_contact::symmetry;
use super::{Measured, largest, least};
use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, MESH_SIZE, Model, Pose};
use palpate::phantom::{BUILTIN_NAMES, Phantom};

/// Depths and lateral positions of the poses, m.
const DEPTHS: [f64; 3] = [1e-3, 2.5e-3, 4e-3];
const LATERALS: [f64; 5] = [-10e-3, -3e-3, 0.0, 3e-3, 10e-3];

/// The largest relative residual of a linear solve (FEM-008).
const RESIDUAL: f64 = 1e-8;
/// How far a contact point of the surface may be inside the probe, m (FEM-009).
const PENETRATION: f64 = 1e-12;

fn model(name: &str) -> Measured<Model> {
    let phantom = Phantom::builtin(name)?;
    Ok(Model::new(&phantom, MESH_SIZE, Contact::default())?)
}

pub fn reference() -> Measured {
    let force = |name| -> Measured<f64> {
        let pose = Pose {
            depth: 4e-3,
            lateral: 0.0,
        };
        let solution = model(name)?.solve(pose)?;
        Ok(solution.force.normal)
    };
    let none = force("none")?;
    let inclusion = force("6.6")?;
    Ok(figures! {
        "no inclusion: normal force, N" => within(none, 1.475, 1.485);
        "6.6 mm: normal force above that without inclusion, N" => within(inclusion - none, 0.305, 0.315);
    })
}

pub fn certificates() -> Measured {
    let mut figures = Vec::new();
    for name in BUILTIN_NAMES {
        let model = model(name)?;
        let map = certified_map(&model, &DEPTHS, &LATERALS, &|_| true)?;
        let certificate = map.certificate().ok_or("the map has no certificate")?;
        let bands = certificate.discretization.as_ref();
        let bands = bands.ok_or("the map has no bands")?;
        let forces = map.table().normal().values();
        let relative = bands.normal_force_band.values().iter().zip(forces);
        let lateral = bands.lateral_force_band.values();
        let relative = 100.0 * largest(relative.map(|(band, force)| band / force));
        figures.extend(figures! {
            "{name}: normal force at 4 mm, x = 0, N" => told(map.table().normal().row(2)[2]);
            "{name}: largest half band of a normal force, %" => told(relative);
            "{name}: largest half band of a lateral force, N" => told(largest(lateral.iter().copied()));
            "{name}: largest relative residual" => at_most(certificate.worst_relative_residual, RESIDUAL);
            "{name}: largest imbalance of forces, N" => told(certificate.worst_force_balance);
            "{name}: largest penetration, m" => at_most(certificate.largest_penetration, PENETRATION);
            "{name}: smallest det(I + ∇u)" => told(least(certificate.min_det.values().iter().copied()));
        });
        figures.extend(symmetry(name, &map));
    }
    Ok(figures)
}
