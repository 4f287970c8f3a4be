//! Line contact of the probe with a thick homogeneous layer (Hertz).

use std::f64::consts::PI;

use crate::fem::{Contact, Element, MeshOptions, Model, Pose};
use crate::phantom::{Gel, Material, Phantom, Probe, Skin};

use super::layer::BondedLayer;
use super::problem::{Exact, lame};
use super::{Check, Figure, Figures, largest, said};

const MATERIAL: Material = Material {
    youngs_modulus: 5e3,
    poisson_ratio: 0.49,
};
const HEIGHT: f64 = 0.02;
const RADIUS: f64 = 0.0299;
/// Distance of the nodes along the surface, m: a quarter of the mesh's size, whose cells are halved there.
const SPACING: f64 = 1.25e-4;

/// ½ ∫ m (1 − L(m)) dm, where L is the compliance of the bonded layer at the wave number m over its height, over that of the
/// half-space, (1 − ν)/(μ k).
///
/// A line load on the layer lowers its surface by 2 (1 − ν²)/(π E) (−ln r + const + c r²/h² + …), c being this number.
fn curvature_of_the_base() -> f64 {
    let softness = |m: f64| {
        let layer = BondedLayer {
            number: m,
            thickness: 1.0,
            material: MATERIAL,
        };
        let half_space = (1.0 - MATERIAL.poisson_ratio) / (lame(&MATERIAL).1 * m);
        -layer.displacement([0.0, 1.0])[1] / half_space
    };
    // Simpson's rule; 1 − L falls as m² exp(−2m), to 1e-12 at m = 16.
    let (cells, end) = (400, 16.0);
    let step = end / f64::from(cells);
    let weight = |k: i32| match k {
        0 => 1.0,
        k if k == cells => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let term = |k: i32| {
        let m = f64::from(k) * step;
        if k == 0 {
            0.0
        } else {
            weight(k) * m * (1.0 - softness(m))
        }
    };
    0.5 * step / 3.0 * (0..=cells).map(term).sum::<f64>()
}

/// Half-width squared by the second moment of the contact forces, a² = 4 Σ f x²/Σ f, over Hertz's.
///
/// Hertz: a² = 4 F R (1 − ν²)/(π E) for the force F per length, and ∫ p x² dx = F a²/4. The layer's base adds the curvature
/// c r²/h² to the surface, which leaves the pressure elliptic and takes c a²/h² off a².
fn ratio(model: &Model, depth: f64, curvature: f64) -> Result<(f64, f64), String> {
    let solution = model
        .solve(Pose {
            depth,
            lateral: 0.0,
        })
        .map_err(said)?;
    let surface = model.surface();
    let (mut force, mut moment) = (0.0, 0.0);
    for (node, [_, down]) in surface.nodal_forces(&solution.state, solution.pose) {
        let x = surface.positions[node][0] + solution.state.displacements[node][0];
        force -= down;
        moment -= down * x * x;
    }
    let square = 4.0 * moment / force;
    let compliance =
        (1.0 - MATERIAL.poisson_ratio * MATERIAL.poisson_ratio) / MATERIAL.youngs_modulus;
    let hertz = 4.0 * solution.normal_force * RADIUS * compliance / PI;
    let base = 1.0 - curvature * square / (HEIGHT * HEIGHT);
    Ok((square.sqrt(), square / (hertz * base)))
}

/// Line contact.
pub const HERTZ: Check = Check {
    name: "fem.hertz",
    claim: "Load and half-width of the probe's contact with a thick layer obey Hertz, with both contact laws.",
    requirements: &["FEM-057"],
    repeatable: true,
    run: line_contact,
};

/// A homogeneous block under a large probe.
fn block() -> Phantom {
    let skin = 0.001;
    Phantom {
        name: "block".into(),
        gel: Gel {
            width: 3.0 * HEIGHT,
            height: HEIGHT - skin,
            material: MATERIAL,
        },
        skin: Skin {
            thickness: skin,
            material: MATERIAL,
        },
        inclusion: None,
        probe: Probe {
            radius: RADIUS,
            length: 1.0,
        },
    }
}

fn line_contact() -> Figures {
    let curvature = curvature_of_the_base();
    // SciPy's quad of the kernel L(m) = (2κ sinh 2m − 4m)/(2κ cosh 2m + 1 + κ² + 4m²), κ = 3 − 4ν.
    let off = (curvature - 0.998_093_74).abs();
    let mut figures = vec![Figure::at_most("error of the base's curvature", off, 1e-6)];
    let options = MeshOptions {
        size: 4.0 * SPACING,
        refinement: 1,
        element: Element::T6,
    };
    for contact in [Contact::VerticalGap, Contact::DeformedNormal] {
        let model = Model::new(&block(), &options, contact).map_err(said)?;
        let (mut mean, mut shares) = (0.0, Vec::new());
        let poses = 16;
        for k in 0..poses {
            let (a, ratio) = ratio(&model, 6e-5 * 1.12f64.powi(k), curvature)?;
            // An edge that cannot lie between nodes misplaces the pressure on the last spacing s, which is 0.6 (s/a)^{3/2} of
            // the force, by s; on both sides and in a², 10 (s/a)^{5/2} at most. Left out are the next term of the base,
            // 0.38 · 1.5 (a/h)⁴, and the circle's and the deformed contact's, (a/R)².
            let edge = 10.0 * libm::pow(SPACING / a, 2.5);
            let rest = 0.57 * (a / HEIGHT).powi(4) + (a / RADIUS).powi(2);
            shares.push((ratio - 1.0).abs() / (edge + rest));
            mean += ratio / f64::from(poses);
        }
        let contact = contact.name();
        figures.push(Figure::at_most(
            format!("{contact}, {poses} loads: largest error of a² over its bound"),
            largest(shares),
            1.0,
        ));
        // The edges fall on all parts of a spacing: what is left is less than half of the smallest contact's bound.
        figures.push(Figure::at_most(
            format!("{contact}: relative error of a² in the mean"),
            (mean - 1.0).abs(),
            5e-3,
        ));
    }
    Ok(figures)
}
