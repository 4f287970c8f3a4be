use crate::fem::{Contact, ContactState, FemError, Model, Pose, PoseSolution};

use super::coarse;

const CONTACTS: [Contact; 2] = [Contact::DeformedNormal, Contact::VerticalGap];

fn solve(model: &Model, depth_mm: f64, lateral_mm: f64) -> PoseSolution {
    model
        .solve(Pose {
            depth: depth_mm * 1e-3,
            lateral: lateral_mm * 1e-3,
        })
        .unwrap()
}

// Verifies: FEM-009, FEM-010.
#[test]
fn nothing_is_inside_the_probe_and_nothing_is_pulled() {
    let model = coarse("2.6", Contact::DeformedNormal);
    let solution = solve(&model, 3.0, 2.2);
    let centre = [2.2e-3, 6.5e-3 - 3e-3];
    assert!(solution.state.active.len() > 10);
    for (i, ([x, y], [ux, uy])) in model
        .surface()
        .positions
        .iter()
        .zip(&solution.state.displacements)
        .enumerate()
    {
        let distance = (x + ux - centre[0]).hypot(y + uy - centre[1]) - 6.5e-3;
        let pressure = solution.state.pressures[i];
        // Newton stops below steps of 1e-13 m, whose square over the radius is beyond rounding.
        if solution.state.active.contains(&i) {
            assert!(
                distance.abs() < 1e-15 && pressure >= 0.0,
                "{i}: gap {distance}, force {pressure}"
            );
        } else {
            assert!(
                distance > -1e-12 && pressure == 0.0,
                "{i}: gap {distance}, force {pressure}"
            );
        }
    }
}

// Verifies: FEM-007, FEM-008, FEM-013.
#[test]
fn condensed_contact_is_the_full_solve() {
    for contact in CONTACTS {
        let model = coarse("4.6", contact);
        let solution = solve(&model, 3.5, 4.0);
        let field = model.field(&solution).unwrap();
        let surface = model.mesh().surface();
        for (u, full) in solution
            .state
            .displacements
            .iter()
            .zip(&field.displacements[surface])
        {
            // The bound of the issue, 1e-9 N, at the surface's stiffness of some 10³ N/m.
            assert!(
                (u[0] - full[0]).abs() < 1e-12 && (u[1] - full[1]).abs() < 1e-12,
                "{u:?} {full:?}"
            );
        }
        let check = model.checks(std::slice::from_ref(&solution))[0];
        assert!(check.residual < 1e-8 && check.imbalance < 1e-9, "{check:?}");
        assert!(check.min_det > 0.1 && check.min_det < 1.0, "{check:?}");
    }
}

// Verifies: FEM-013, CON-004.
#[test]
fn reaction_of_floor_and_walls_is_the_force_on_the_probe() {
    let model = coarse("6.6", Contact::DeformedNormal);
    let solution = solve(&model, 2.0, 5.0);
    let field = model.field(&solution).unwrap();
    // Traction of the field at the fixed nodes, from the elements themselves.
    let mesh = model.mesh();
    let rule = crate::fem::element::StiffnessRule::new(mesh.element);
    let free = mesh.free();
    let mut reaction = [0.0; 2];
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        let material = crate::fem::assembly::material_of(model.phantom(), region);
        let stiffness = rule.integrate(&mesh.positions(nodes), &material).unwrap();
        for (a, &node) in nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| !free[**node as usize])
        {
            assert_eq!(field.displacements[node as usize], [0.0, 0.0]);
            for (b, &other) in nodes.iter().enumerate() {
                let u = field.displacements[other as usize];
                for i in 0..2 {
                    reaction[i] += 0.030
                        * (stiffness[2 * a + i][2 * b] * u[0]
                            + stiffness[2 * a + i][2 * b + 1] * u[1]);
                }
            }
        }
    }
    // The gel is pushed down by the probe and held up by the floor.
    assert!(
        (reaction[1] - solution.normal_force).abs() < 1e-9,
        "{reaction:?} {solution:?}"
    );
    assert!((reaction[0] - solution.lateral_force).abs() < 1e-9);
    assert!(solution.normal_force > 0.1);
}

// Verifies: FEM-012.
#[test]
fn forces_are_the_slopes_of_the_strain_energy() {
    // Central differences with step h are off by h² F''/6 ≈ 1e-14·10⁵ N and by the rounding 2 ε U/2h ≈
    // 1e-13 N; a node that meets the probe within the step adds at most its stiffness times h²/2h.
    let h = 1e-7;
    for contact in CONTACTS {
        let model = coarse("2.6", contact);
        for (depth_mm, lateral_mm) in [(0.7, 1.3), (2.1, 3.7), (3.9, 0.4), (3.3, 9.1)] {
            let at = |depth: f64, lateral: f64| model.solve(Pose { depth, lateral }).unwrap();
            let (d, x) = (depth_mm * 1e-3, lateral_mm * 1e-3);
            let here = at(d, x);
            let normal = (at(d + h, x).energy - at(d - h, x).energy) / (2.0 * h);
            let lateral = -(at(d, x + h).energy - at(d, x - h).energy) / (2.0 * h);
            assert!(
                (normal - here.normal_force).abs() < 1e-5,
                "{contact:?} F_n {} dU/dd {normal}",
                here.normal_force
            );
            assert!(
                (lateral - here.lateral_force).abs() < 1e-5,
                "{contact:?} F_x {} -dU/dx {lateral}",
                here.lateral_force
            );
            assert!(
                here.lateral_force.abs() > 1e-4,
                "{contact:?}: nothing to compare"
            );
        }
    }
}

// Verifies: FEM-009.
#[test]
fn the_contact_laws_agree_where_the_gel_hardly_moves() {
    let (deformed, vertical) = (coarse("none", CONTACTS[0]), coarse("none", CONTACTS[1]));
    let ratio = |depth_mm: f64| {
        solve(&deformed, depth_mm, 1.0).normal_force / solve(&vertical, depth_mm, 1.0).normal_force
            - 1.0
    };
    // Slopes at the contact's edge are √(2d/R): the laws differ by their square, some per cent at 1 mm.
    let (shallow, deep) = (ratio(0.001).abs(), ratio(3.0).abs());
    assert!(shallow < 2.0 * 0.001 / 6.5 * 2.0, "{shallow}");
    assert!(
        deep > 10.0 * shallow,
        "{deep} against {shallow}: the option does nothing"
    );
}

// Verifies: FEM-011.
#[test]
fn a_pose_that_does_not_converge_is_an_error_that_names_it() {
    let mut surface = coarse("none", Contact::DeformedNormal).surface().clone();
    let pose = Pose {
        depth: 2.5e-3,
        lateral: 1.5e-3,
    };
    let untouched = ContactState::untouched(surface.positions.len());
    surface
        .solve(pose, &untouched)
        .expect("the sound surface converges");
    // Neither not-a-number nor a surface that answers a push by moving against it may pass.
    for spoil in [|_: f64| f64::NAN, |c: f64| -c] {
        for entry in surface.compliance.as_mut_slice() {
            *entry = spoil(*entry);
        }
        let error = surface.solve(pose, &untouched).unwrap_err();
        assert!(matches!(error, FemError::NoConvergence { .. }), "{error}");
        let message = error.to_string();
        assert!(
            message.contains("depth 2.5 mm") && message.contains("lateral 1.5 mm"),
            "{message}"
        );
        surface = coarse("none", Contact::DeformedNormal).surface().clone();
    }
}

// Verifies: FEM-019.
#[test]
fn poses_where_the_probe_cannot_stand_are_refused() {
    let model = coarse("none", Contact::DeformedNormal);
    for (depth, lateral) in [
        (-1e-3, 0.0),
        (0.0156, 0.0),
        (4e-3, 12e-3),
        (f64::NAN, 0.0),
        (1e-3, f64::INFINITY),
    ] {
        let error = model.solve(Pose { depth, lateral }).unwrap_err();
        assert!(matches!(error, FemError::Pose(_)), "{error}");
    }
    let still = model
        .solve(Pose {
            depth: 0.0,
            lateral: 3e-3,
        })
        .unwrap();
    assert_eq!(
        [still.normal_force, still.lateral_force, still.energy],
        [0.0; 3]
    );
}

// Verifies: FEM-022.
#[test]
fn the_curvature_term_makes_newton_fast() {
    let model = coarse("2.6", Contact::DeformedNormal);
    let start = solve(&model, 3.0, 2.0).state;
    let pose = Pose {
        depth: 3.0005e-3,
        lateral: 2e-3,
    };
    let next = model.surface().solve(pose, &start).unwrap();
    assert_eq!(
        next.active, start.active,
        "the test wants a step without change of contact"
    );
    // Steps of 5e-7 m over a radius of 6.5e-3 m: quadratic convergence goes 1e-4, 1e-8, 1e-16 of it; with a
    // normal that does not turn, each step leaves about a tenth of the one before.
    assert!(next.iterations <= 4, "{} iterations", next.iterations);
}
