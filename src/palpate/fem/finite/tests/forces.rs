//! Forces without friction, and what a map and a field say of them.

use super::super::{Equilibrium, FiniteModel, Friction, Touch, law_of};
use super::{at, builtin, coarse, finite, path, pose, rich};
use crate::fem::element::CORNERS;
use crate::fem::tests::off_centre;
use crate::fem::{Contact, Mesh, Model, State};
use crate::phantom::Phantom;
use palpate_asserts::assert_near;

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

// Verifies: FEM-085, FIN-005.
#[test]
fn a_needle_between_two_nodes_has_no_force() {
    let needle = builtin("none").changed(|parts| parts.probe.radius = 0.1e-3);
    let model = Model::new(&needle.unwrap(), 2e-3, Contact::default()).unwrap();
    for depth in [0.0, 0.002] {
        let solution = model.solve(pose(depth, 0.125)).unwrap();
        assert_eq!(solution.force.normal, 0.0, "{depth}");
    }
}

// Verifies: FIN-008, MAP-006.
#[test]
fn a_map_says_its_law_and_is_symmetric_without_friction() {
    let phantom = builtin("6.6");
    let model = Model::new(&phantom, 2e-3, Contact::default()).unwrap();
    let laterals = [-2e-3, 0.0, 2e-3];
    let map = model.map(&[1e-3, 2e-3], &laterals, &|_| true).unwrap();
    let certificate = map.certificate().unwrap();
    let law = "neo-Hookean (Bonet and Wood)";
    assert_eq!(certificate.law.as_deref(), Some(law));
    let rich = phantom.changed(|parts| parts.inclusions[0].material = rich());
    let named = format!("{law}, Yeoh's second term, fibres");
    assert_eq!(law_of(&rich.unwrap()), named);
    assert!(certificate.worst_relative_residual <= 1e-9 * 1.1);
    let row = map.table().row(2e-3).unwrap();
    assert_eq!(row.lateral[0], -row.lateral[2]);
    assert_eq!(row.normal[0], row.normal[2]);
    // A sweep, where each position starts the next, has the same forces.
    let sweep = model.sweep(&[2e-3], &laterals).unwrap();
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

// Verifies: FIN-008, FEM-008.
#[test]
fn where_the_probe_has_left_the_gel_the_residual_is_a_force() {
    let model = Model::new(&builtin("none"), 1e-3, Contact::default()).unwrap();
    let poses = [0.3, 0.6, 0.3, 0.0].map(|depth| pose(depth, 0.0));
    let (path, checks) = model.path(&poses).unwrap();
    assert_eq!(path[3].force.normal, 0.0);
    assert!(path[2].force.normal > 0.01);
    // Rounding, N.
    assert!(checks[3].residual <= 1e-11, "{checks:?}");
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
