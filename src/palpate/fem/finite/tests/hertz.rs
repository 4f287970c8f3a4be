//! Line contact with friction on a block so large that it is a half-space (Hertz 1882, Cattaneo 1938, Mindlin 1949).

use nalgebra::Vector2;

use super::super::{Equilibrium, FiniteModel, Friction, Place, Touch};
use super::{lattice, long, path};
use crate::phantom::{Material, Strain};
use palpate_asserts::assert_near;

const PI: f64 = std::f64::consts::PI;
const MU: f64 = 0.3;
const RADIUS: f64 = 24e-3;
const SIZE: f64 = 25e-3;
const LENGTH: f64 = 0.03;
/// So nearly incompressible, a gel that is pressed down does not move along the surface (Dundurs' β under a rigid probe is
/// (1 − 2ν)/(2 − 2ν) = 1e-4), so that pressures and drags do not act on each other, as Cattaneo and Mindlin assume.
const GEL: Material = Material::isotropic(5e3, 0.4999);

/// A block, its elements small under the probe: their edges there are a hundredth of the block's half-width and less.
fn block() -> FiniteModel {
    let phantom = long(LENGTH).changed(|parts| {
        parts.strain = Strain::Finite;
        parts.layers.remove(0);
        (parts.layers[0].material, parts.layers[0].thickness) = (GEL, SIZE);
        (parts.well.width, parts.probe.radius) = (2.0 * SIZE, RADIUS);
    });
    let graded = |t: f64| SIZE * libm::sinh(5.0 * t) / libm::sinh(5.0);
    let mesh = lattice([60, 20], |[x, y]| [graded(2.0 * x - 1.0), -graded(1.0 - y)]);
    FiniteModel::new(&phantom.unwrap(), &mesh, Friction::Path(MU)).unwrap()
}

/// A node that touches: its arc, m, and the force on it along normal and tangent, N.
struct Node {
    arc: f64,
    pressure: f64,
    drag: f64,
    touch: Touch,
}

/// The nodes that touch, from left to right.
fn touching(model: &FiniteModel, at: &Equilibrium) -> Vec<Node> {
    let places = model.places(&at.state, at.pose);
    let nodes = places.iter().zip(&at.forces).zip(&at.touches);
    let node = |((place, &force), &touch): ((&Place, &[f64; 2]), &Touch)| Node {
        arc: place.arc,
        pressure: Vector2::from(force).dot(&place.normal),
        drag: Vector2::from(force).dot(&place.tangent()),
        touch,
    };
    let touching = nodes.filter(|(_, touch)| **touch != Touch::Apart);
    touching.map(node).collect()
}

/// ∫ √(1 − x²/a²) dx from −a to x.
fn semicircle(x: f64, a: f64) -> f64 {
    let x = (x / a).clamp(-1.0, 1.0);
    0.5 * a * (x * libm::sqrt(1.0 - x * x) + libm::asin(x) + 0.5 * PI)
}

// Verifies: FIN-005, FIN-010, FIN-011.
#[test]
fn a_light_probe_presses_as_hertz_and_drags_as_mindlin() {
    let model = block();
    let down = [0.01, 0.02, 0.03, 0.04, 0.05].map(|d| [d, 0.0]);
    let aside = [0.005, 0.01].map(|x| [0.05, x]);
    let solved = path(&model, &[&down[..], &aside].concat());
    for (state, least) in solved[4..].iter().zip([-0.01, 0.2, 0.4]) {
        let nodes = touching(&model, state);
        let sum = |of: &dyn Fn(&Node) -> f64| nodes.iter().map(of).sum::<f64>();
        let (force, drag) = (sum(&|n| n.pressure), sum(&|n| n.drag));
        // How much of the friction is used; none before the probe moves aside.
        let used = drag / (MU * force);
        assert!((least..least + 0.2).contains(&used), "{used}");
        // The half-widths of the contact, by its second moment, and of the part that sticks.
        let a = libm::sqrt(4.0 * sum(&|n| n.pressure * n.arc * n.arc) / force);
        let c = a * libm::sqrt(1.0 - used.max(0.0));
        let softness = (1.0 - GEL.poisson_ratio * GEL.poisson_ratio) / GEL.youngs_modulus;
        let hertz = 4.0 * (force / LENGTH) * RADIUS * softness / PI;
        // The slope of the probe's face at the edge and the floor change a² by (a/R)² = (a/h)² = 0.0013 or so each.
        assert_near(a * a / hertz, 1.0, 0.004);
        let spacing = nodes
            .windows(2)
            .map(|n| n[1].arc - n[0].arc)
            .fold(0.0, f64::max);
        for node in nodes.iter().filter(|n| (n.arc.abs() - c).abs() > spacing) {
            let sticks = node.arc.abs() < c;
            assert_eq!(node.touch == Touch::Sticks, sticks, "{} of {c}", node.arc);
        }
        // The forces left of a node, with half its own, against the tractions left of it. A node stands for half a spacing on either
        // side, where the traction is the highest at most, 2 P/(π a) or μ times that: half a spacing of that is (spacing/(π a)) P.
        let near = spacing / (PI * a);
        let highest = 2.0 / (PI * a);
        let mut left = [0.0; 2];
        for node in &nodes {
            let here = [0.5 * node.pressure, 0.5 * node.drag];
            let [pressed, dragged] = [0, 1].map(|k| left[k] + here[k]);
            let pressure = semicircle(node.arc, a);
            let sticking = c / a * semicircle(node.arc, c);
            assert_near(pressed / force, highest * pressure, near);
            assert_near(
                dragged / (MU * force),
                highest * (pressure - sticking),
                near,
            );
            left = [0, 1].map(|k| left[k] + 2.0 * here[k]);
        }
    }
}
