//! What is refused.

use nalgebra::Vector2;

use super::super::system::System;
use super::super::{Friction, crosses_itself};
use super::{at, builtin, coarse, pose, pressure_unknowns};
use crate::fem::element::CORNERS;
use crate::fem::{Contact, FemError, Mesh, Model, Pose};
use palpate_asserts::assert_near;

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
        Pose {
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
    for pressure in pressure_unknowns(&system) {
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
    for &pressure in &pressure_unknowns(&system)[CORNERS * deepest..][..CORNERS] {
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

// Verifies: FIN-009.
#[test]
fn a_vertical_gap_is_refused() {
    let error = Model::new(&builtin("none"), 2e-3, Contact::VerticalGap).unwrap_err();
    assert!(error.to_string().contains("finite strain"), "{error}");
}

// Verifies: FIN-007.
#[test]
fn each_guard_refuses_a_solution_by_itself() {
    let model = coarse(&builtin("none"), Friction::None);
    let solved = at(&model, &[[1.0, 0.0]]);
    let accept = |pose: Pose, state: &[f64], least_det: f64, forces: Vec<[f64; 2]>| {
        let mut trial = model.trial(&solved, solved.state.clone()).unwrap();
        trial.equations.least_det = least_det;
        (trial.state, trial.forces) = (state.to_vec(), forces);
        model.accept(pose, trial, 1)
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
