//! Bodies of revolution under a sphere.

use nalgebra::{SVector, Vector2};

use super::super::law::{Law, UNKNOWNS, points};
use super::{finite, pose, sphere};
use crate::fem::element::{NODES, StiffnessRule};
use crate::fem::{Contact, Mesh, Model};
use crate::phantom::{Material, Strain};
use crate::stats::tails::halved;

// Verifies: FEM-081, PHA-033.
#[test]
fn a_revolved_gel_stretched_alike_everywhere_has_no_force_inside() {
    // u = (a x, b y): the circles are stretched as the radius is, and every strain is constant.
    let phantom = sphere(3e-3, 6e-3);
    let mesh = Mesh::new(&phantom, 2e-3).unwrap();
    let (rule, material) = (StiffnessRule::default(), Material::isotropic(5e3, 0.45));
    let law = Law::from(&Material {
        yeoh_c20: 700.0,
        ..material
    });
    let [a, b] = [0.2, -0.1];
    let mut forces = vec![[Vector2::<f64>::zeros(); 2]; mesh.nodes.len()];
    let mut scale = [0.0f64; 2];
    for nodes in mesh.elements() {
        let positions = mesh.positions(nodes);
        let state = SVector::<f64, UNKNOWNS>::from_fn(|k, _| match k {
            k if k >= 2 * NODES => 400.0,
            k => [a, b][k % 2] * positions[k / 2][k % 2],
        });
        let moved = state.fixed_rows::<{ 2 * NODES }>(0).into_owned();
        let small = rule
            .integrate(&positions, &material, phantom.geometry())
            .unwrap()
            * moved;
        let finite = law
            .element(&points(&positions, &phantom).unwrap(), &state)
            .unwrap()
            .force;
        for (at, &node) in nodes.iter().enumerate() {
            let pair = [
                small.fixed_rows::<2>(2 * at).into_owned(),
                finite.fixed_rows::<2>(2 * at).into_owned(),
            ];
            for (theory, force) in pair.into_iter().enumerate() {
                scale[theory] = scale[theory].max(force.amax());
                forces[node as usize][theory] += force;
            }
        }
    }
    let (side, floor) = (0.5 * phantom.well().width, -phantom.height());
    let inside = mesh
        .nodes
        .iter()
        .zip(&forces)
        .filter(|([x, y], _)| x.abs() < side - 1e-9 && *y < -1e-9 && *y > floor + 1e-9);
    for (_, of_node) in inside {
        for theory in 0..2 {
            assert!(
                of_node[theory].amax() < 1e-12 * scale[theory],
                "{theory}: {of_node:?}"
            );
        }
    }
}

/// The force of a sphere on a half-space (Sneddon 1965), over E/(1 − ν²) R², at a depth of this part of its radius; the contact's
/// radius a by bisection of d = a/2 ln((R + a)/(R − a)).
fn sneddon(depth: f64) -> f64 {
    let logarithm = |a: f64| libm::log((1.0 + a) / (1.0 - a));
    let is_less = |a: f64| Ok::<_, ()>(0.5 * a * logarithm(a) < depth);
    let [a, _] = halved(60, [0.0, 0.999], is_less).unwrap();
    0.5 * (1.0 + a * a) * logarithm(a) - a
}

/// By how much a layer that is bonded below is stiffer than a half-space, to the fourth power of χ = √(R d)/h (Dimitriadis et al.
/// 2002).
fn dimitriadis(chi: f64, nu: f64) -> f64 {
    let pi = std::f64::consts::PI;
    let a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
    let b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1.0 - nu);
    let x = 2.0 * a * chi / pi;
    let cube = |factor: f64| a * a * a + factor * pi * pi * b;
    1.0 - x + x * x - 8.0 / (pi * pi * pi) * cube(4.0 / 15.0) * chi * chi * chi
        + 16.0 * a / (pi * pi * pi * pi) * cube(3.0 / 5.0) * chi * chi * chi * chi
}

// Verifies: FEM-081, PHA-033.
#[test]
fn a_sphere_on_a_layer_has_the_force_of_theory() {
    let (radius, height, nu) = (3e-3, 15e-3, 0.49);
    let force = |strain, contact, size| {
        let phantom = sphere(radius, height)
            .changed(|parts| parts.strain = strain)
            .unwrap();
        let model = Model::new(&phantom, size, contact).unwrap();
        model.solve(pose(0.3, 0.0)).unwrap().force.normal
    };
    let layer = dimitriadis(libm::sqrt(0.1) * radius / height, nu);
    let theory = 5e3 / (1.0 - nu * nu) * radius * radius * sneddon(0.1) * layer;
    let off = |strain, contact| force(strain, contact, 0.5e-3) / theory - 1.0;
    // The theory moves the surface down and lets no force act across: a vertical gap. Five edges under the sphere's half.
    let vertical = off(Strain::Small, Contact::VerticalGap);
    assert!(vertical.abs() < 0.005, "{vertical}");
    // The true normal pushes the gel aside; small and finite strain, with other elements and other contact points, agree on how much
    // that takes.
    let [small, finite] =
        [Strain::Small, Strain::Finite].map(|strain| off(strain, Contact::DeformedNormal));
    assert!(
        (small - finite).abs() < 0.005 && small < vertical - 0.01,
        "{small} {finite}"
    );
}

// Verifies: FIN-007, FEM-008.
#[test]
fn a_light_touch_is_as_balanced_as_a_firm_one() {
    let gel = sphere(3e-3, 15e-3).changed(|parts| parts.well.width = 40e-3);
    let model = Model::new(&finite(&gel.unwrap()), 2e-3, Contact::default()).unwrap();
    // Down to micronewtons, as `palpate calibrate` asks.
    let depths = [5e-6, 1e-5, 2e-5, 5e-5];
    let map = model.map(&depths, &[0.0], &|_| true).unwrap();
    let certificate = map.certificate().unwrap();
    let worst = certificate.worst_relative_residual;
    assert!(worst <= 1e-8, "{worst:e}");
    // At 0 there is no load.
    assert!(model.map(&[0.0, 1e-6], &[0.0], &|_| true).is_ok());
    // However light a touch is, the iterations end.
    for depth in [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7] {
        let solution = model.solve(pose(1e3 * depth, 0.0)).unwrap();
        let check = model.checks(&[solution]).unwrap()[0];
        assert!(check.residual < 1e-3, "{depth:e}: {check:?}");
    }
}

// Verifies: FEM-081, FEM-013.
#[test]
fn what_is_nearly_incompressible_keeps_its_volume_when_turned() {
    let gel = sphere(3e-3, 6e-3).changed(|parts| parts.layers[0].material.poisson_ratio = 0.4995);
    let model = Model::new(&gel.unwrap(), 0.5e-3, Contact::default()).unwrap();
    let solution = model.solve(pose(0.1, 0.0)).unwrap();
    let det = model.checks(&[solution]).unwrap()[0].min_det;
    // Strains are some hundredths: their squares change a volume by some thousandths, in the cross-section alone the strain itself does.
    assert!((0.985..1.0).contains(&det), "{det}");
}
