//! Tests of finite strain, against closed forms, small strain, and relations that hold of any gel.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use super::law::{Law, UNKNOWNS, points};
use super::system::System;
use super::{Equilibrium, FiniteModel, Friction, Touch, crosses_itself};
use crate::fem::element::{CORNERS, NODES, StiffnessRule, stress};
use crate::fem::tests::off_centre;
use crate::fem::{Contact, FemError, Mesh, Model, Pose, State};
use crate::phantom::{Geometry, Material, Phantom, Strain};
use palpate_asserts::assert_near;

fn finite(phantom: &Phantom) -> Phantom {
    phantom
        .changed(|parts| parts.strain = Strain::Finite)
        .unwrap()
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
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if across(middle) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
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
        [plain, fibrous].map(|material| rule.integrate(&BENT, &material).unwrap());
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

// Verifies: FIN-005, FIN-012.
#[test]
fn the_forces_are_those_of_the_study() {
    // An independent program on other meshes, whose numbers are given to these digits: 2.33 N without friction, and with μ = 0.3
    // a lateral force of −1.0 N.
    let phantom = builtin("none");
    let mesh = Mesh::new(&phantom, 0.5e-3).unwrap();
    let steps: [[f64; 2]; 4] = [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]];
    let model = FiniteModel::new(&phantom, &mesh, Friction::None).unwrap();
    let solved = path(&model, &steps);
    assert_near(solved[3].force.normal, 2.33, 0.005 + 0.005 * 2.33);
    assert!(solved[3].force.lateral.abs() < 1e-9);
    let iterations: usize = solved.iter().map(|e| e.iterations).sum();
    assert!(iterations <= 30, "{iterations}");
    let model = FiniteModel::new(&phantom, &mesh, Friction::Steady(0.3)).unwrap();
    assert_near(at(&model, &steps).force.lateral, -1.0, 0.05);
}

// Verifies: FIN-005.
#[test]
fn forces_are_slopes_of_the_energy() {
    let model = coarse(&finite(&off_centre(4.6, 2.0)), Friction::None);
    let solved = path(&model, &[[1.0, 1.0], [2.0, 1.0]]).pop().unwrap();
    let near = |d: f64, x: f64| model.lead(&solved, None, pose(d, x)).unwrap();
    // Differences over h = 2 µm: U is quadratic in the change of contact at its edge, so that the slope errs by h over the
    // contact's width, 1e-3 at most, and symmetric differences by its square.
    let h = 2e-3;
    let slope = |a: Equilibrium, b: Equilibrium| (b.energy - a.energy) / (2.0 * h * 1e-3);
    let down = slope(near(2.0 - h, 1.0), near(2.0 + h, 1.0));
    let across = slope(near(2.0, 1.0 - h), near(2.0, 1.0 + h));
    assert_near(solved.force.normal, down, 1e-4 * down.abs());
    assert_near(solved.force.lateral, -across, 1e-4 * down.abs());
    // And the probe takes what floor and walls give.
    assert!(solved.check.imbalance < 1e-9 && solved.check.residual <= 1.1e-9);
}

// Verifies: FIN-006.
#[test]
fn small_depths_have_the_forces_of_small_strain() {
    // The force at finite strain exceeds that at small strain by a part that grows as the square of the depth: four times as much
    // at twice the depth, to leading order.
    let phantom = builtin("none");
    let model = FiniteModel::new(
        &phantom,
        &Mesh::new(&phantom, 0.5e-3).unwrap(),
        Friction::None,
    )
    .unwrap();
    let small = Model::new(
        &Phantom::builtin("none").unwrap(),
        0.5e-3,
        Contact::default(),
    )
    .unwrap();
    let depths = [0.25, 0.5, 1.0];
    let forces = path(&model, &depths.map(|d| [d, 0.0]));
    let excess = depths.iter().zip(forces).map(|(&d, finite)| {
        finite.force.normal / small.solve(pose(d, 0.0)).unwrap().force.normal - 1.0
    });
    let excess: Vec<f64> = excess.collect();
    for (part, twice) in excess.iter().zip(&excess[1..]) {
        assert!((2.8..5.0).contains(&(twice / part)), "{excess:?}");
    }
    assert!(excess[0] < 0.01, "{excess:?}");
}

// Verifies: FIN-002.
#[test]
fn nothing_locks_towards_incompressibility() {
    // From ν = 0.499 to 0.4999 the force grows by what compressibility leaves, and a mesh of twice the size changes it no more than
    // at ν = 0.49.
    let force = |nu: f64, size: f64| {
        let phantom = builtin("none").changed(|parts| parts.layers[1].material.poisson_ratio = nu);
        let phantom = phantom.unwrap();
        let mesh = Mesh::new(&phantom, size).unwrap();
        let model = FiniteModel::new(&phantom, &mesh, Friction::None).unwrap();
        at(&model, &[[1.0, 0.0], [2.0, 0.0]]).force.normal
    };
    let change = |nu: f64| force(nu, 1e-3) / force(nu, 0.5e-3) - 1.0;
    let (usual, nearly) = (change(0.49), change(0.4999));
    assert!(
        usual.abs() < 0.005 && nearly.abs() < 0.005,
        "{usual} {nearly}"
    );
}

// Verifies: FIN-010, FIN-011.
#[test]
fn friction_obeys_coulomb_and_its_work_adds_up() {
    let mu = 0.3;
    let model = coarse(&builtin("6.6"), Friction::Path(mu));
    let down = (1..=8).map(|k| [0.25 * f64::from(k), -2.0]);
    let across = (1..=60).map(|k| [2.0, -2.0 + 0.05 * f64::from(k)]);
    let poses: Vec<[f64; 2]> = down.chain(across).collect();
    let solved = path(&model, &poses);
    let radius = 6.5e-3;
    let mut sticking = 0;
    for state in &solved {
        let whole: f64 = state.forces.iter().map(|f| f[0].abs() + f[1].abs()).sum();
        let nodes = state
            .touches
            .iter()
            .zip(&state.forces)
            .zip(&model.mesh.surface);
        for ((touch, force), &node) in nodes {
            let u = state.displacements[node];
            let x = model.mesh.nodes[node][0] + u[0] - state.pose.lateral;
            let y = model.mesh.nodes[node][1] + u[1] - (radius - state.pose.depth);
            let r = libm::sqrt(x * x + y * y);
            assert!(r > radius - 1e-11, "inside the probe by {}", radius - r);
            let pressure = (force[0] * x + force[1] * y) / r;
            let drag = (-force[0] * y + force[1] * x) / r;
            let off = match touch {
                Touch::Apart => pressure.abs() + drag.abs(),
                Touch::Slips(way) => (drag + way * mu * pressure).abs() + (r - radius).abs(),
                Touch::Sticks => {
                    sticking += 1;
                    (drag.abs() - mu * pressure).max(0.0) + (r - radius).abs()
                }
            };
            assert!(
                off < 1e-8 * whole && pressure > -1e-8 * whole,
                "{touch:?} {off:e} of {whole}"
            );
        }
    }
    assert!(sticking > 0);
    // Work of the probe = growth of the energy + Σ μ λ |Δs|, by trapezoids.
    let (mut work, mut heat) = (0.0, 0.0);
    for pair in solved[8..].windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        work -= 0.5 * (a.force.lateral + b.force.lateral) * (b.pose.lateral - a.pose.lateral);
        let [before, now] = [a, b].map(|state| model.places(&state.state, state.pose));
        for (at, (before, now)) in before.iter().zip(&now).enumerate() {
            let pressure = |state: &Equilibrium, normal: Vector2<f64>| {
                normal.dot(&Vector2::from(state.forces[at]))
            };
            let mean = 0.5 * (pressure(a, before.normal) + pressure(b, now.normal));
            if !matches!(
                (a.touches[at], b.touches[at]),
                (Touch::Apart, _) | (_, Touch::Apart)
            ) {
                heat += mu * mean * (now.arc - before.arc).abs();
            }
        }
    }
    let stored = solved[67].energy - solved[8].energy;
    // Nodes that come and go at the edge of the contact have next to no pressure.
    assert!(
        heat > 0.1 * work && (work - heat - stored).abs() < 0.01 * work,
        "{work} {heat} {stored}"
    );
}

// Verifies: FIN-012.
#[test]
fn a_path_ends_in_steady_sliding_and_has_its_mirror_image() {
    let phantom = builtin("6.6");
    let path_model = coarse(&phantom, Friction::Path(0.3));
    let indented: Vec<[f64; 2]> = (1..=6).map(|k| [0.5 * f64::from(k), -2.0]).collect();
    let slid: Vec<[f64; 2]> = (1..=6).map(|k| [3.0, -2.0 + 0.5 * f64::from(k)]).collect();
    let there = path(&path_model, &[indented, slid].concat());
    let steady = coarse(&phantom, Friction::Steady(0.3));
    let same = at(&steady, &[[1.0, 1.0], [2.0, 1.0], [3.0, 1.0]]).force;
    let end = there[11].force;
    assert_near(end.normal, same.normal, 1e-3 * same.normal);
    assert_near(end.lateral, same.lateral, 1e-3 * same.normal);
    // Not so at the first step, half a millimetre after the turn.
    let early = there[6].force;
    assert!(
        early.lateral - same.lateral > 0.05 * same.normal,
        "{early:?}"
    );
    let mirrored: Vec<[f64; 2]> = there
        .iter()
        .map(|e| [e.pose.depth * 1e3, -e.pose.lateral * 1e3])
        .collect();
    for (state, image) in there.iter().zip(path(&path_model, &mirrored)) {
        assert_near(image.force.normal, state.force.normal, 1e-8);
        assert_near(image.force.lateral, -state.force.lateral, 1e-8);
    }
}

// Verifies: FIN-007.
#[test]
fn what_does_not_converge_is_an_error_with_its_pose() {
    // So much friction jams the probe.
    let model = coarse(&builtin("none"), Friction::Steady(1.5));
    let error = model
        .path(model.untouched(0.0), &[pose(2.0, 0.0), pose(4.0, 0.0)])
        .unwrap_err();
    let FemError::NoConvergence { pose, .. } = error else {
        panic!("{error}")
    };
    assert!(pose.depth > 0.0 && pose.depth <= 4e-3 && pose.lateral == 0.0);
    let wide = model.lead(
        &model.untouched(0.0),
        None,
        super::Pose {
            depth: 1e-3,
            lateral: 16e-3,
        },
    );
    assert!(matches!(wide, Err(FemError::Pose(_))));
}

// Verifies: FIN-004.
#[test]
fn a_tangent_with_other_pivots_is_refused() {
    let phantom = builtin("none");
    let mesh = Mesh::new(&phantom, 2e-3).unwrap();
    let system = System::new(&mesh, &phantom).unwrap();
    let middle = mesh.surface[mesh.surface.len() / 2];
    let first = system.unknown(middle, 0).unwrap();
    let at_rest = system.equations(&vec![0.0; system.unknowns()]).unwrap();
    assert!(
        system
            .condense(&at_rest, first..first + 2)
            .unwrap()
            .is_some()
    );
    // A pressure of a thousand times the modulus that nothing balances: the gel would buckle.
    let mut state = vec![0.0; system.unknowns()];
    for pressure in system.pressure_unknowns() {
        state[pressure] = -1e7;
    }
    let pressed = system.equations(&state).unwrap();
    assert!(
        system
            .condense(&pressed, first..first + 2)
            .unwrap()
            .is_none()
    );
    // Only at the corners of one element near the floor, far from the probe, whose own stiffness stays positive.
    let depth = |nodes: &[u32]| {
        mesh.positions(&nodes[..CORNERS])
            .iter()
            .map(|p| p[1])
            .sum::<f64>()
    };
    let deepest = mesh
        .elements()
        .enumerate()
        .min_by(|a, b| depth(a.1).total_cmp(&depth(b.1)));
    let deepest = deepest.unwrap().0;
    let mut state = vec![0.0; system.unknowns()];
    for &pressure in &system.pressure_unknowns()[CORNERS * deepest..][..CORNERS] {
        state[pressure] = -1e7;
    }
    let pressed = system.equations(&state).unwrap();
    assert!(
        system
            .condense(&pressed, first..first + 2)
            .unwrap()
            .is_none()
    );
}

// Verifies: FIN-007.
#[test]
fn a_surface_that_crosses_itself_is_seen() {
    let line = |points: &[[f64; 2]]| {
        points
            .iter()
            .map(|&p| p.into())
            .collect::<Vec<Vector2<f64>>>()
    };
    // An overhang is no fold.
    assert!(!crosses_itself(&line(&[
        [0.0, 0.0],
        [2.0, 0.0],
        [1.5, 1.0],
        [3.0, 1.0]
    ])));
    assert!(crosses_itself(&line(&[
        [0.0, 0.0],
        [2.0, 0.0],
        [1.5, 1.0],
        [1.4, -1.0],
        [3.0, 1.0]
    ])));
}

// Verifies: FIN-008, MAP-006.
#[test]
fn a_map_says_its_law_and_is_symmetric_without_friction() {
    let phantom = builtin("6.6");
    let model = Model::new(&phantom, 2e-3, Contact::default()).unwrap();
    let laterals = [-2e-3, 0.0, 2e-3];
    let map = model.map(&[1e-3, 2e-3], &laterals, &|_| ()).unwrap();
    let certificate = map.certificate().unwrap();
    let law = "neo-Hookean (Bonet and Wood)";
    assert_eq!(certificate.law.as_deref(), Some(law));
    let rich = phantom.changed(|parts| parts.inclusions[0].material = rich());
    let named = format!("{law}, Yeoh's second term, fibres");
    assert_eq!(super::law_of(&rich.unwrap()), named);
    assert!(certificate.worst_relative_residual <= 1e-9 * 1.1);
    let row = map.table().row(2e-3).unwrap();
    assert_eq!(row.lateral[0], -row.lateral[2]);
    assert_eq!(row.normal[0], row.normal[2]);
    // A sweep, where each position starts the next, has the same forces.
    let sweep = model.sweep(2e-3, &laterals).unwrap();
    let other = sweep.table().row(2e-3).unwrap();
    for k in 0..3 {
        assert_near(other.normal[k], row.normal[k], 1e-8);
        assert_near(other.lateral[k], row.lateral[k], 1e-8);
    }
    // So has one pose, whose field ends where its checks begin.
    let solution = model.solve(pose(2.0, 2.0)).unwrap();
    assert_near(solution.force.normal, row.normal[2], 1e-8);
    assert!(matches!(solution.state, State::Finite(_)) && solution.contact().is_none());
    let field = model.field(&solution).unwrap();
    let moved = field.displacements.iter().map(|u| u[1]).fold(0.0, f64::min);
    assert!(moved < -1.9e-3);
    let text = model.vtu(&solution).unwrap();
    assert!(text.contains("von_mises_pa"));
}

// Verifies: FIN-009.
#[test]
fn a_vertical_gap_is_refused() {
    let error = Model::new(&builtin("none"), 2e-3, Contact::VerticalGap).unwrap_err();
    assert!(error.to_string().contains("finite strain"), "{error}");
}

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
        let small = rule.integrate_revolved(&positions, &material).unwrap() * moved;
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
    let (mut low, mut high) = (0.0, 0.999);
    for _ in 0..60 {
        let a = 0.5 * (low + high);
        if 0.5 * a * logarithm(a) < depth {
            low = a
        } else {
            high = a
        }
    }
    0.5 * (1.0 + low * low) * logarithm(low) - low
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

// Verifies: FIN-007.
#[test]
fn each_guard_refuses_a_solution_by_itself() {
    let model = coarse(&builtin("none"), Friction::None);
    let solved = at(&model, &[[1.0, 0.0]]);
    let accept = |pose: Pose, state: &[f64], least_det: f64, forces: Vec<[f64; 2]>| {
        let mut equations = model.system.equations(&solved.state).unwrap();
        equations.least_det = least_det;
        let touches = solved.touches.clone();
        model.accept(pose, state.to_vec(), &equations, touches, forces, 1)
    };
    let forces = || solved.forces.clone();
    assert!(accept(solved.pose, &solved.state, 0.9, forces()).is_some());
    assert!(accept(solved.pose, &solved.state, 0.04, forces()).is_none());
    // The probe a tenth of a millimetre deeper, the gel as before.
    assert!(accept(pose(1.1, 0.0), &solved.state, 0.9, forces()).is_none());
    // Two nodes far from the probe, carried beyond the next one, one above the surface and one below it.
    let mut folded = solved.state.clone();
    let place = |at: usize| model.mesh.nodes[model.mesh.surface[at]][0];
    for (at, height) in [(2, 0.1e-3), (3, -0.1e-3)] {
        let node = model.mesh.surface[at];
        let [x, y] = [0, 1].map(|k| model.system.unknown(node, k).unwrap());
        (folded[x], folded[y]) = (0.5 * (place(4) + place(5)) - place(at), height);
    }
    assert!(accept(solved.pose, &folded, 0.9, forces()).is_none());
    // Half the contact's force leaves half the reaction of floor and walls.
    let half = forces().iter().map(|f| f.map(|f| 0.5 * f)).collect();
    let half = accept(solved.pose, &solved.state, 0.9, half).unwrap();
    assert_near(half.check.imbalance, 0.5 * solved.force.normal, 1e-9);
}

// Verifies: FIN-008.
#[test]
fn iterations_of_all_steps_are_counted() {
    let model = coarse(&builtin("none"), Friction::None);
    let steps = path(&model, &[[1.0, 0.0], [2.0, 0.0]]);
    let at_once = at(&model, &[[2.0, 0.0]]);
    assert_eq!(
        at_once.iterations,
        steps[0].iterations + steps[1].iterations
    );
}

// Verifies: FEM-081, FEM-013.
#[test]
fn what_is_nearly_incompressible_keeps_its_volume_when_turned() {
    let gel = sphere(3e-3, 6e-3).changed(|parts| parts.layers[0].material.poisson_ratio = 0.4995);
    let model = Model::new(&gel.unwrap(), 1e-3, Contact::default()).unwrap();
    let solution = model.solve(pose(0.1, 0.0)).unwrap();
    let det = model.checks(&[solution]).unwrap()[0].min_det;
    // Strains are some hundredths: their squares change a volume by some thousandths, in the cross-section alone the strain itself does.
    assert!((0.985..1.0).contains(&det), "{det}");
}

// Verifies: FEM-016, FIN-001.
#[test]
fn the_stress_under_the_probe_is_its_pressure() {
    let block = builtin("none").changed(|parts| {
        parts.layers.remove(0);
    });
    let model = Model::new(&block.unwrap(), 1e-3, Contact::default()).unwrap();
    let solution = model.solve(pose(2.0, 0.0)).unwrap();
    let State::Finite(rest) = &solution.state else {
        panic!("finite strain")
    };
    let touching = model.mesh().surface.iter().zip(&rest.touches);
    let touching = touching.filter(|(_, touch)| **touch != Touch::Apart);
    let x = touching.map(|(&node, _)| model.mesh().nodes[node][0] + rest.displacements[node][0]);
    let (low, high) = x.fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
    // Hertz's pressure in the middle is 4/π of its mean; that of a layer at finite strain is between the mean and a parabola's 3/2.
    let mean = solution.force.normal / ((high - low) * 0.03);
    let text = model.vtu(&solution).unwrap();
    let stresses = text
        .split("Name=\"stress_xx_yy_zz_xy_pa\"")
        .nth(1)
        .unwrap()
        .lines()
        .skip(1);
    let of_middle = model.mesh().elements().zip(stresses).filter(|(nodes, _)| {
        let corners = model.mesh().positions(&nodes[..CORNERS]);
        corners
            .iter()
            .all(|[x, y]| x.abs() < 0.8e-3 && *y > -0.6e-3)
    });
    let normal =
        of_middle.map(|(_, line)| -line.split(' ').nth(1).unwrap().parse::<f64>().unwrap());
    let normal: Vec<f64> = normal.collect();
    assert!(!normal.is_empty());
    for stress in normal {
        assert!((1.0..1.5).contains(&(stress / mean)), "{stress} of {mean}");
    }
}

/// Below the 8.6 mm disc lies half a millimetre of gel, which is under tension of some 4 kPa at one side of it.
// Verifies: FIN-014.
#[test]
fn a_thin_gap_under_tension_keeps_its_volume() {
    let forces = [1.5e-3, 1e-3].map(|size| {
        let model = Model::new(&builtin("8.6"), size, Contact::default()).unwrap();
        let solution = model.solve(pose(4.0, 5.0)).unwrap();
        let check = model.checks(std::slice::from_ref(&solution)).unwrap();
        assert!(check[0].min_det > 0.75, "{}", check[0].min_det);
        solution.force.normal
    });
    // The forces of meshes that differ so much are within 0.5 % of each other.
    assert_near(forces[0], forces[1], 0.005 * forces[1]);
}
