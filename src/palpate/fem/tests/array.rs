use crate::fem::{Contact, MESH_SIZE, Model};
use crate::phantom::Phantom;
use palpate_asserts::assert_near;

use super::{builtin, coarse, off_centre, pose};

const DEPTH: f64 = 4e-3;

fn model(phantom: &Phantom) -> Model {
    coarse(phantom, Contact::default())
}

fn array(model: &Model, lateral: f64, elements: usize) -> Vec<f64> {
    model.array(&model.solve(pose(DEPTH, lateral)).unwrap(), elements)
}

fn assert_all_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert_near(*a, *b, tolerance);
    }
}

// The parts of each force add up to 1 within an ulp for each element: 1e-14 of 2 N for 32 elements and some 50 points.
// Verifies: FEM-083.
#[test]
fn the_elements_together_carry_the_whole_force() {
    for contact in [Contact::DeformedNormal, Contact::VerticalGap] {
        let model = coarse(&off_centre(2.6, 3.0), contact);
        let solution = model.solve(pose(DEPTH, -2.2e-3)).unwrap();
        let forces = model.surface().forces(&solution.state, solution.pose);
        let total: f64 = forces.iter().map(|(_, [x, y])| x.hypot(*y)).sum();
        assert!(total > 1.0);
        for elements in [1, 2, 5, 32] {
            let forces = model.array(&solution, elements);
            assert!(forces.iter().all(|&force| force >= 0.0), "{forces:?}");
            assert_all_near(&[forces.iter().sum()], &[total], 1e-13);
            // A finer array divides each element of a coarser one.
            let finer = model.array(&solution, 3 * elements);
            let merged: Vec<f64> = finer.chunks(3).map(|of| of.iter().sum()).collect();
            assert_all_near(&merged, &forces, 1e-13);
        }
        assert_eq!(model.array(&solution, 0), [0.0; 0]);
    }
}

/// Frictionless: the force on an element points to the middle of the circle, from where the element stands. Within half an
/// element, 1/64 of R, and what an even spread moves a force on an edge of 0.2 mm, 0.06 mm or 0.009 of R, the forces on all elements
/// add up to the force on the probe.
// Verifies: FEM-083.
#[test]
fn elements_stand_where_the_force_acts() {
    let elements = 64;
    let model = Model::new(&off_centre(2.6, 3.0), MESH_SIZE, Contact::default()).unwrap();
    for lateral in [-6e-3, 0.0, 5e-3] {
        let solution = model.solve(pose(DEPTH, lateral)).unwrap();
        let forces = model.array(&solution, elements);
        let sine = |k: usize| (2 * k + 1) as f64 / elements as f64 - 1.0;
        let (mut across, mut along, mut total) = (0.0, 0.0, 0.0);
        for (k, force) in forces.iter().enumerate() {
            across -= force * sine(k);
            along += force * (1.0 - sine(k) * sine(k)).sqrt();
            total += force;
        }
        assert_near(across, solution.force.lateral, 0.025 * total);
        assert_near(along, solution.force.normal, 0.025 * total);
    }
}

// 1e-12: mirrored poses agree to rounding alone, and the sums of an array come in another order.
// Verifies: FEM-083, FEM-014.
#[test]
fn an_array_under_a_symmetric_phantom_is_symmetric() {
    let model = model(&builtin("4.6"));
    let mut forces = array(&model, 0.0, 7);
    let found = forces.clone();
    forces.reverse();
    assert!(found[3] > 0.1);
    assert_all_near(&found, &forces, 1e-12);
    let laterals = [-3e-3, -1e-3, 0.0, 1e-3];
    let sweep = model.array_sweep(DEPTH, &laterals, 7).unwrap();
    assert_eq!(sweep.len(), laterals.len());
    for (of, &lateral) in sweep.iter().zip(&laterals) {
        assert_all_near(of, &array(&model, lateral, 7), 1e-12);
    }
    let mirrored: Vec<f64> = sweep[3].iter().rev().copied().collect();
    assert_eq!(sweep[1], mirrored);
}

// Verifies: FEM-014.
#[test]
fn a_sweep_over_what_is_not_symmetric_is_solved_on_both_sides() {
    let model = model(&off_centre(2.6, 3.0));
    let laterals = [-2e-3, 0.0, 2e-3];
    let sweep = model.array_sweep(DEPTH, &laterals, 4).unwrap();
    for (of, &lateral) in sweep.iter().zip(&laterals) {
        assert_eq!(of, &array(&model, lateral, 4));
    }
    let far = model.array_sweep(DEPTH, &[12e-3], 4);
    assert!(far.is_err());
}

/// A contact's edge that moves over the borders of elements must not make a force jump: within 0.02 mm it changes by a force of
/// the size of pressure times 0.02 mm, some 0.5 N/mm × 0.02 mm = 10 mN, where a point that hops carries some 100 mN here.
// Verifies: FEM-083.
#[test]
fn forces_change_smoothly_with_the_pose() {
    let model = model(&builtin("2.6"));
    let mut before = array(&model, 0.0, 32);
    for step in 1..=40 {
        let now = array(&model, f64::from(step) * 2e-5, 32);
        let jump = now.iter().zip(&before).map(|(a, b)| (a - b).abs());
        let jump = jump.fold(0.0, f64::max);
        assert!(jump < 0.02, "step {step}: {jump}");
        before = now;
    }
}
