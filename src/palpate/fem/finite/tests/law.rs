//! The material law and one element of it.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use super::super::law::{Law, UNKNOWNS, points};
use super::{BENT, long, rich, sphere};
use crate::fem::Mesh;
use crate::fem::element::{CORNERS, NODES, StiffnessRule, stress};
use crate::fem::tests::off_centre;
use crate::phantom::{Geometry, Material, Phantom};
use crate::stats::tails::halved;
use palpate_asserts::assert_near;

// Verifies: FIN-003.
#[test]
fn forces_and_tangent_are_derivatives_of_the_energy() {
    // Under pressure, in part under tension, and under tension alone.
    for mean in [-4e3, 0.0, 4e3] {
        slopes(&BENT, &long(0.03), mean);
        // Turned about the axis, beside which the element stands.
        let turned = BENT.map(|[x, y]| [x + 0.5e-3, y]);
        slopes(&turned, &sphere(3e-3, 15e-3), mean);
    }
}

/// Checks forces and tangent of an element of this kind of phantom.
fn slopes(positions: &[[f64; 2]], phantom: &Phantom, mean: f64) {
    let points = points(positions, phantom).unwrap();
    let law = Law::from(&rich());
    // Displacements of some tenths of the element's size, pressures of the modulus.
    let state = SVector::<f64, UNKNOWNS>::from_fn(|k, _| {
        let varied = libm::sin(3.0 * k as f64 + 1.0);
        if k < 2 * NODES {
            2e-4 * varied
        } else {
            mean + 2e3 * varied
        }
    });
    let here = law.element(&points, &state).unwrap();
    for k in 0..UNKNOWNS {
        // Central differences over h of a function that varies over the size s of its unknown: (h/s)² of truncation, 1e-16 s/h of
        // rounding; with h = 1e-5 s both are 1e-10.
        let h = if k < 2 * NODES { 1e-8 } else { 5e-2 };
        let moved = [1.0, -1.0].map(|way| {
            let mut moved = state;
            moved[k] += way * h;
            law.element(&points, &moved).unwrap()
        });
        let slope = (moved[0].energy - moved[1].energy) / (2.0 * h);
        let scale = here.energy.abs() / if k < 2 * NODES { 1e-3 } else { 5e3 };
        assert!(
            (slope - here.force[k]).abs() < 1e-7 * scale,
            "{k}: {slope} {}",
            here.force[k]
        );
        let column = (moved[0].force - moved[1].force) / (2.0 * h);
        let largest = here.tangent.column(k).amax();
        let wrong = (column - here.tangent.column(k)).amax();
        assert!(wrong < 1e-7 * largest, "{k}: {wrong:e} of {largest:e}");
    }
    assert_eq!(here.tangent, here.tangent.transpose());
}

// Verifies: FIN-001.
#[test]
fn plane_strain_compression_has_its_closed_form() {
    // Squeezed to λ₁ along y and free along x: μ (λ₂² − 1) + λ ln(λ₁ λ₂) = 0, by bisection, and the nominal stress
    // P = μ λ₁ + (λ ln J − μ)/λ₁.
    let material = Material::isotropic(5e3, 0.49);
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let (lambda, mu) = (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    );
    let squeezed = 0.6;
    let across = |wide: f64| mu * (wide * wide - 1.0) + lambda * libm::log(squeezed * wide);
    let [low, _] = halved(60, [1.0, 2.0], |wide| Ok::<_, ()>(across(wide) < 0.0)).unwrap();
    let pressure = lambda * libm::log(squeezed * low);
    let stress = mu * squeezed + (pressure - mu) / squeezed;

    // A straight triangle under that deformation: the force on each node is V P ∇N_a.
    let corners = [[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]];
    let middle = |a: usize, b: usize| [0, 1].map(|k| 0.5 * (corners[a][k] + corners[b][k]));
    let positions = [
        corners.to_vec(),
        vec![middle(0, 1), middle(1, 2), middle(2, 0)],
    ]
    .concat();
    let state = SVector::<f64, UNKNOWNS>::from_fn(|k, _| match k {
        k if k >= 2 * NODES => pressure,
        k if k % 2 == 0 => (low - 1.0) * positions[k / 2][0],
        k => (squeezed - 1.0) * positions[k / 2][1],
    });
    let element = Law::from(&material)
        .element(&points(&positions, &long(1.0)).unwrap(), &state)
        .unwrap();
    let whole: f64 = [0, 1, 3]
        .map(|node| element.force[2 * node + 1])
        .iter()
        .sum();
    // V P ∂(N₀ + N₁ + N₃)/∂y: over a triangle the means of ∂N/∂s are 1 − 4/3, 0 and −4/3.
    let leg = 1e-3;
    let expected = leg * leg / 2.0 * stress * (-1.0 / 3.0 - 4.0 / 3.0) / leg;
    assert_near(whole, expected, 1e-12 * expected.abs());
    for node in 0..NODES {
        assert!(
            element.force[2 * node].abs() < 1e-9 * expected.abs(),
            "{}",
            element.force
        );
    }
    for k in 0..CORNERS {
        assert!(
            element.force[2 * NODES + k].abs() < 1e-20,
            "{}",
            element.force
        );
    }
    assert_near(element.least_det, squeezed * low, 1e-14);
    // Cauchy's stress: nothing across, λ₁ P/J along, which is P/λ₂.
    let gradient = [[low - 1.0, 0.0], [0.0, squeezed - 1.0]];
    let cauchy = Law::from(&material).stress(gradient, pressure);
    assert_near(cauchy[0], 0.0, 1e-9 * stress.abs());
    assert_near(cauchy[1], stress / low, 1e-12 * stress.abs());
    assert_near(
        cauchy[2],
        (mu + pressure - mu) / (squeezed * low),
        1e-12 * stress.abs(),
    );
    assert_eq!(cauchy[3], 0.0);
}

// Verifies: FIN-001.
#[test]
fn a_uniform_deformation_leaves_no_force_inside() {
    let mesh = Mesh::new(&off_centre(6.6, 3.0), 2e-3).unwrap();
    let law = Law::from(&rich());
    let gradient = Matrix2::new(0.9, 0.25, -0.1, 1.2);
    // The pressure is constant; so is everything else.
    let (mut forces, mut scale) = (vec![Vector2::zeros(); mesh.nodes.len()], 0.0f64);
    for nodes in mesh.elements() {
        let positions = mesh.positions(nodes);
        let moved = |a: usize| (gradient - Matrix2::identity()) * Vector2::from(positions[a]);
        let state = SVector::<f64, UNKNOWNS>::from_fn(|k, _| match k {
            k if k < 2 * NODES => moved(k / 2)[k % 2],
            _ => -300.0,
        });
        let element = law
            .element(&points(&positions, &long(0.03)).unwrap(), &state)
            .unwrap();
        for (a, &node) in nodes.iter().enumerate() {
            let force = element.force.fixed_rows::<2>(2 * a);
            scale = scale.max(force.amax());
            forces[node as usize] += force;
        }
    }
    let half = 0.5 * 34e-3;
    let inside = mesh
        .nodes
        .iter()
        .zip(&forces)
        .filter(|([x, y], _)| x.abs() < half - 1e-9 && *y < 0.0 && *y > -15.5e-3 + 1e-9);
    let worst = inside.map(|(_, force)| force.amax()).fold(0.0, f64::max);
    // Bent elements: their quadrature is exact to degree 4, and a constant stress needs degree 2.
    assert!(worst < 1e-12 * scale, "{worst:e} of {scale:e}");
}

// Verifies: FEM-005, FIN-001.
#[test]
fn fibres_stiffen_small_and_finite_strain_alike() {
    let (plain, fibrous) = (
        Material::isotropic(5e3, 0.45),
        Material {
            yeoh_c20: 0.0,
            ..rich()
        },
    );
    let rule = StiffnessRule::default();
    let [without, with] =
        [plain, fibrous].map(|material| rule.integrate(&BENT, &material, Geometry::Plane).unwrap());
    let points = points(&BENT, &long(1.0)).unwrap();
    let [bare, stiff] = [plain, fibrous].map(|material| {
        let element = Law::from(&material)
            .element(&points, &SVector::zeros())
            .unwrap();
        element
            .tangent
            .fixed_view::<{ 2 * NODES }, { 2 * NODES }>(0, 0)
            .into_owned()
    });
    let added: SMatrix<f64, 12, 12> = with - without;
    assert!((added - (stiff - bare)).amax() < 1e-12 * with.amax());
    // Stretched along the fibres by ε, V E_f ε²/2 more energy, and E_f ε more stress along them.
    let [a, b] = fibrous.fibre_direction();
    let stretched = [[1e-3 * a * a, 1e-3 * a * b], [1e-3 * a * b, 1e-3 * b * b]];
    let [with, without] = [fibrous, plain].map(|material| stress(&material, stretched));
    for (k, part) in [a * a, b * b, 0.0, a * b].into_iter().enumerate() {
        let expected = 1e-3 * fibrous.fibre_modulus * part;
        assert_near(with[k] - without[k], expected, 1e-12 * with[0].abs());
    }
    let along = SVector::<f64, 12>::from_fn(|k, _| {
        let [x, y] = BENT[k / 2];
        1e-3 * (a * x + b * y) * [a, b][k % 2]
    });
    let area = points_area(&BENT);
    let energy = 0.5 * along.dot(&(added * along));
    assert_near(
        energy,
        area * fibrous.fibre_modulus * 1e-6 / 2.0,
        1e-12 * energy,
    );
}

/// The area of a bent element, m², by Green's theorem along its edges, which are parabolas: Simpson's rule is exact.
fn points_area(positions: &[[f64; 2]; NODES]) -> f64 {
    let edge = |[a, b, m]: [usize; 3]| {
        let [[xa, ya], [xb, yb], [xm, ym]] = [a, b, m].map(|k| positions[k]);
        // ∫ x dy over the parabola through a, m, b.
        let slope = |t: f64| (4.0 * t - 3.0) * ya + (4.0 - 8.0 * t) * ym + (4.0 * t - 1.0) * yb;
        let x = |t: f64| {
            (1.0 - t) * (1.0 - 2.0 * t) * xa + 4.0 * t * (1.0 - t) * xm + t * (2.0 * t - 1.0) * xb
        };
        [0.0, 0.5, 1.0]
            .map(|t| x(t) * slope(t))
            .iter()
            .zip([1.0, 4.0, 1.0])
            .map(|(f, w)| f * w / 6.0)
            .sum::<f64>()
    };
    [[0, 1, 3], [1, 2, 4], [2, 0, 5]].map(edge).iter().sum()
}
