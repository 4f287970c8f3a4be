//! Tests of finite strain, against closed forms, small strain, and relations that hold of any gel; one file a topic.

mod forces;
mod friction;
mod hertz;
mod law;
mod manufactured;
mod newton;
mod refused;
mod sphere;

use super::law::UNKNOWNS;
use super::system::System;
use super::{Equilibrium, FiniteModel, Friction};
use crate::fem::Pose;
use crate::fem::element::NODES;
use crate::fem::mesh::{Mesh, Region};
use crate::phantom::{Geometry, Material, Phantom, Strain};

fn finite(phantom: &Phantom) -> Phantom {
    phantom
        .changed(|parts| parts.strain = Strain::Finite)
        .unwrap()
}

/// The unknowns of a system that are pressures.
fn pressure_unknowns(system: &System) -> Vec<usize> {
    let of = |(_, _, unknowns): &(_, _, [u32; UNKNOWNS])| unknowns[2 * NODES..].to_vec();
    let pressures = system.elements.iter().flat_map(of);
    pressures.map(|unknown| unknown as usize).collect()
}

fn builtin(name: &str) -> Phantom {
    finite(&Phantom::builtin(name).unwrap())
}

/// A model whose mesh has a quarter of the default's nodes or so.
fn coarse(phantom: &Phantom, friction: Friction) -> FiniteModel {
    FiniteModel::new(phantom, &Mesh::new(phantom, 1e-3).unwrap(), friction).unwrap()
}

fn pose(depth_mm: f64, lateral_mm: f64) -> Pose {
    Pose {
        depth: depth_mm * 1e-3,
        lateral: lateral_mm * 1e-3,
    }
}

/// The last of some poses (depth and lateral position, mm), from above the first.
fn at(model: &FiniteModel, poses: &[[f64; 2]]) -> Equilibrium {
    path(model, poses).pop().unwrap()
}

fn path(model: &FiniteModel, poses: &[[f64; 2]]) -> Vec<Equilibrium> {
    let above = model.untouched(poses[0][1] * 1e-3);
    let poses: Vec<Pose> = poses.iter().map(|&[d, x]| pose(d, x)).collect();
    model.path(above, &poses).unwrap()
}

/// A material with every term of the energy.
fn rich() -> Material {
    Material {
        yeoh_c20: 700.0,
        fibre_modulus: 4e3,
        fibre_angle_deg: 33.0,
        ..Material::isotropic(5e3, 0.45)
    }
}

/// A phantom under a probe of this length, m.
fn long(length: f64) -> Phantom {
    let phantom = Phantom::builtin("none").unwrap();
    phantom
        .changed(|parts| parts.probe.length = length)
        .unwrap()
}

/// A thick layer of gel under a sphere of this radius, m, deep and half as wide as `height`, m.
fn sphere(radius: f64, height: f64) -> Phantom {
    let phantom = Phantom::builtin("none").unwrap().changed(|parts| {
        parts.geometry = Geometry::Axisymmetric;
        parts.layers.remove(0);
        parts.layers[0].thickness = height;
        parts.well.width = 4.0 * height;
        (parts.probe.radius, parts.probe.length) = (radius, 2.0 * radius);
    });
    phantom.unwrap()
}

/// A bent element, m.
const BENT: [[f64; 2]; NODES] = [
    [0.0, 0.0],
    [2e-3, 0.2e-3],
    [0.3e-3, 1.5e-3],
    [1e-3, -0.1e-3],
    [1.2e-3, 0.9e-3],
    [0.1e-3, 0.7e-3],
];

/// A square of cells (columns, rows), two elements each, every node of which `place` puts from the unit square into its place; held
/// at floor and walls.
fn lattice([columns, rows]: [usize; 2], place: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let wide = 2 * columns + 1;
    let node = |i: usize, j: usize| (j * wide + i) as u32;
    let mut mesh = Mesh::default();
    for (j, i) in (0..=2 * rows).flat_map(|j| (0..wide).map(move |i| (j, i))) {
        let at = |k: usize, of: usize| k as f64 / (2 * of) as f64;
        mesh.nodes.push(place([at(i, columns), at(j, rows)]));
        mesh.held.push([i == 0 || i == 2 * columns || j == 0; 2]);
    }
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let of = |[x, y]: [usize; 2]| node(2 * i + x, 2 * j + y);
        // The diagonals point to the middle, so that no element has two edges held.
        let parts = if (2 * i < columns) == (2 * j < rows) {
            [
                [[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]],
                [[0, 0], [2, 2], [0, 2], [1, 1], [1, 2], [0, 1]],
            ]
        } else {
            [
                [[0, 0], [2, 0], [0, 2], [1, 0], [1, 1], [0, 1]],
                [[2, 0], [2, 2], [0, 2], [2, 1], [1, 2], [1, 1]],
            ]
        };
        for part in parts {
            mesh.connectivity.extend(part.map(of));
            mesh.regions.push(Region::Layer(0));
        }
    }
    mesh.surface = (0..wide).map(|i| node(i, 2 * rows) as usize).collect();
    mesh
}
