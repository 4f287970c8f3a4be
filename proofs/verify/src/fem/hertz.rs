//! Line contact of the probe with a thick homogeneous layer (Hertz).

use std::f64::consts::PI;

use palpate::fem::{Contact, Model, Pose};
use palpate::phantom::{Layer, Material, Phantom, PhantomParts, Probe, Well};
use palpate::refusal::Refusal;

use super::layer::BondedLayer;
use super::problem::{Exact, lame, material};
use super::{Figure, Measured, largest};

const MATERIAL: Material = material(5e3, 0.49);
const HEIGHT: f64 = 0.02;
const RADIUS: f64 = 0.0299;
/// The mesh size, m. Edges at the surface are two fifths of it long.
const SIZE: f64 = 0.6e-3;

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

/// What one pose gives: the contact's half-width a, m; a² by the second moment of the contact forces, a² = 4 Σ f x²/Σ f, over
/// Hertz's; and the largest difference of a pressure λ/(length · probe's length) from Hertz's at its point, over the largest.
///
/// Hertz: a² = 4 F R (1 − ν²)/(π E) for the force F per length, ∫ p x² dx = F a²/4, and p = 2F/(πa) √(1 − x²/a²). The layer's
/// base adds the curvature c r²/h² to the surface, which leaves the pressure elliptic and takes c a²/h² off a².
fn compare(model: &Model, depth: f64, curvature: f64) -> Measured<[f64; 3]> {
    let pose = Pose {
        depth,
        lateral: 0.0,
    };
    let solution = model.solve(pose)?;
    let (surface, state) = (model.surface(), solution.contact().expect("small strain"));
    let place = |point: usize| surface.positions[point][0] + state.displacements[point][0];
    let (mut force, mut moment) = (0.0, 0.0);
    for (point, [_, down]) in surface.forces(state, pose) {
        let x = place(point);
        force -= down;
        moment -= down * x * x;
    }
    let square = 4.0 * moment / force;
    let compliance =
        (1.0 - MATERIAL.poisson_ratio * MATERIAL.poisson_ratio) / MATERIAL.youngs_modulus;
    let hertz = 4.0 * solution.force.normal * RADIUS * compliance / PI;
    let base = 1.0 - curvature * square / (HEIGHT * HEIGHT);
    let highest = 2.0 * solution.force.normal / (PI * square.sqrt() * surface.probe.length);
    let off = (0..surface.positions.len()).map(|point| {
        let x = place(point);
        let exact = highest * (1.0 - x * x / square).max(0.0).sqrt();
        let found = state.pressures[point] / (surface.lengths[point] * surface.probe.length);
        (found - exact).abs() / highest
    });
    Ok([square.sqrt(), square / (hertz * base), largest(off)])
}

/// A homogeneous block under a large probe.
fn block() -> Result<Phantom, Refusal> {
    Phantom::new(PhantomParts {
        name: "block".into(),
        strain: Default::default(),
        geometry: Default::default(),
        well: Well {
            width: 3.0 * HEIGHT,
            walls: Default::default(),
            floor: Default::default(),
        },
        layers: vec![Layer {
            name: "block".into(),
            thickness: HEIGHT,
            material: MATERIAL,
        }],
        inclusions: Vec::new(),
        probe: Probe {
            radius: RADIUS,
            length: 1.0,
            friction: 0.0,
        },
    })
}

pub fn line_contact() -> Measured {
    let curvature = curvature_of_the_base();
    // SciPy's quad of the kernel L(m) = (2κ sinh 2m − 4m)/(2κ cosh 2m + 1 + κ² + 4m²), κ = 3 − 4ν.
    let off = (curvature - 0.998_093_74).abs();
    let mut figures = vec![Figure::at_most("error of the base's curvature", off, 1e-6)];
    for contact in [Contact::VerticalGap, Contact::DeformedNormal] {
        let model = Model::new(&block()?, SIZE, contact)?;
        let places = &model.surface().positions;
        let near = places.windows(2).filter(|pair| pair[0][0].abs() < 1e-2);
        let spacing = largest(near.map(|pair| pair[1][0] - pair[0][0]));
        let (mut mean, mut left_out) = (0.0, 0.0);
        let (mut shares, mut pressures) = (Vec::new(), Vec::new());
        let poses = 16;
        for k in 0..poses {
            let [a, ratio, pressure] = compare(&model, 6e-5 * 1.12f64.powi(k), curvature)?;
            // An edge that cannot lie between points misplaces the pressure on the last spacing s, which is 0.6 (s/a)^{3/2} of
            // the force, by s; on both sides and in a², 10 (s/a)^{5/2} at most. Left out are the next term of the base,
            // 0.38 · 1.5 (a/h)⁴, and the circle's and the deformed contact's, (a/R)².
            let edge = 10.0 * libm::pow(spacing / a, 2.5);
            let rest = 0.57 * (a / HEIGHT).powi(4) + (a / RADIUS).powi(2);
            shares.push((ratio - 1.0).abs() / (edge + rest));
            // The pressure within a spacing of the edge may go to the wrong side of it: √(2 s/a) of the highest at most.
            pressures.push(pressure / (2.0 * spacing / a).sqrt());
            mean += ratio / f64::from(poses);
            left_out += rest / f64::from(poses);
        }
        let contact = contact.name();
        // Forces are to be within 0.3 % (FEM-021), and a² goes with the force; the closed form leaves out the rest.
        figures.extend(figures! {
            "{contact}, {poses} loads: largest error of a² over its bound" => at_most(largest(shares), 1.0);
            "{contact}, {poses} loads: largest error of a pressure over its bound" => at_most(largest(pressures), 1.0);
            "{contact}: relative error of a² in the mean" => at_most((mean - 1.0).abs(), 3e-3 + left_out);
        });
    }
    Ok(figures)
}
