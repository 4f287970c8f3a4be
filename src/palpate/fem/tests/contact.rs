use crate::fem::field::Checker;
use crate::fem::{Contact, ContactState, FemError, MESH_SIZE, Model, Pose, PoseSolution};
use crate::force::Force;
use crate::phantom::{Geometry, Phantom};
use palpate_asserts::assert_near;

use super::{builtin, off_centre, pose};

fn coarse(name: &str, contact: Contact) -> Model {
    super::coarse(&builtin(name), contact)
}

const CONTACTS: [Contact; 2] = [Contact::DeformedNormal, Contact::VerticalGap];

fn solve(model: &Model, depth_mm: f64, lateral_mm: f64) -> PoseSolution {
    let pose = pose(depth_mm * 1e-3, lateral_mm * 1e-3);
    model.solve(pose).unwrap()
}

/// Values at the contact points from those at the surface's nodes: of the parabola through an edge's three at two Gauss points.
fn at_contact_points(values: &[f64]) -> Vec<f64> {
    let g = 1.0 / 3f64.sqrt();
    let parabola = |v: &[f64], t: f64| {
        v[1] + 0.5 * t * (v[2] - v[0]) + 0.5 * t * t * (v[0] - 2.0 * v[1] + v[2])
    };
    let at_points = |v| [-g, g].map(|t| parabola(v, t));
    values.windows(3).step_by(2).flat_map(at_points).collect()
}

// Verifies: FEM-085. The contact points at the skin are 0.21 and 0.29 mm apart.
#[test]
fn a_probe_on_too_few_contact_points_is_refused() {
    let of_radius = |radius: f64| {
        let phantom = builtin("none").changed(|parts| parts.probe.radius = radius);
        super::coarse(&phantom.unwrap(), Contact::default())
    };
    let (small, paper) = (of_radius(0.1e-3), of_radius(6.5e-3));
    let (deep, light) = (pose(0.05e-3, 0.0), pose(0.002e-3, 0.0));
    let expected = "the mesh has 0 contact points under the probe at depth 0.05 mm, lateral 0.0 mm, too few for a force; give a smaller mesh size or a larger probe";
    let error = small.solve(deep).unwrap_err();
    assert_eq!(error.to_string(), expected);
    let map = small.map(&[light.depth, deep.depth], &[0.0], &|_| true);
    assert_eq!(map.unwrap_err().to_string(), expected);
    assert_eq!(small.path(&[deep]).unwrap_err().to_string(), expected);
    // R/50, and just beyond it with 2.6 mm of the surface below the chord.
    assert!(small.solve(light).is_ok());
    assert!(paper.solve(pose(0.1301e-3, 0.0)).is_ok());
}

// Verifies: FEM-085.
#[test]
fn a_sphere_needs_twice_as_many_contact_points_as_a_cylinder() {
    // The whole chord, 1.83 mm, lies on elements of 0.53 to 0.64 mm.
    let plane = builtin("none").changed(|parts| {
        parts.layers.remove(0);
        parts.well.width = 40e-3;
        (parts.probe.radius, parts.probe.length) = (1e-3, 2e-3);
    });
    let plane = plane.unwrap();
    let sphere = plane.changed(|parts| parts.geometry = Geometry::Axisymmetric);
    let deep = pose(0.6e-3, 0.0);
    let model = |phantom: &Phantom, size| Model::new(phantom, size, Contact::default()).unwrap();
    assert!(model(&plane, 1.6e-3).solve(deep).is_ok());
    let sphere = sphere.unwrap();
    let said = model(&sphere, 1.6e-3).solve(deep).unwrap_err().to_string();
    assert!(said.contains("contact points under the probe"), "{said}");
    // The bound of the requirement.
    let [coarse, fine] =
        [0.7e-3, 0.25e-3].map(|size| model(&sphere, size).solve(deep).unwrap().force.normal);
    assert!((coarse / fine - 1.0).abs() < 0.08, "{coarse} {fine}");
}

// Verifies: FEM-009.
#[test]
fn contact_points_are_the_gauss_points_of_the_edges() {
    let model = super::coarse(&builtin("2.6"), Contact::default());
    let (mesh, surface) = (model.mesh(), model.surface());
    let x = mesh.surface.iter().map(|&node| mesh.nodes[node][0]);
    let expected = at_contact_points(&x.collect::<Vec<_>>());
    assert_eq!(surface.positions.len(), expected.len());
    for (&[x, y], expected) in surface.positions.iter().zip(&expected) {
        assert!((x - expected).abs() < 1e-17 && y == 0.0, "{x} {expected}");
    }
    // Two points integrate a parabola exactly: ∫ x² dx over the width w is w³/12.
    let integral = |power: i32| -> f64 {
        let points = surface.positions.iter().zip(&surface.lengths);
        points.map(|([x, _], length)| length * x.powi(power)).sum()
    };
    let width = model.phantom().well().width;
    assert!((integral(0) / width - 1.0).abs() < 1e-14);
    assert!((integral(2) / (width.powi(3) / 12.0) - 1.0).abs() < 1e-14);
}

// Verifies: FEM-009.
#[test]
fn nothing_is_inside_the_probe_and_nothing_is_pulled() {
    for phantom in [builtin("2.6"), off_centre(2.6, 3.0)] {
        let model = super::coarse(&phantom, Contact::DeformedNormal);
        let pose = pose(3e-3, 2.2e-3);
        let solution = model.solve(pose).unwrap();
        let centre = [2.2e-3, 6.5e-3 - 3e-3];
        let state = solution.contact().expect("small strain");
        assert!(state.active.len() > 10);
        let mut forces = model.surface().forces(state, pose).into_iter().peekable();
        let points = model.surface().positions.iter().zip(&state.displacements);
        for (i, ([x, y], [ux, uy])) in points.enumerate() {
            let arm = [x + ux - centre[0], y + uy - centre[1]];
            let distance = arm[0].hypot(arm[1]) - 6.5e-3;
            let pressure = state.pressures[i];
            let force = forces.next_if(|(point, _)| *point == i);
            // Newton stops below steps of 1e-13 m, whose square over the radius is beyond rounding.
            if state.active.contains(&i) {
                let touches = distance.abs() < 1e-15 && pressure >= 0.0;
                assert!(touches, "{i}: gap {distance}, force {pressure}");
                let (_, force) = force.expect("a force");
                for (force, arm) in force.iter().zip(arm) {
                    // Away from the probe's middle.
                    assert!((force - pressure * arm / 6.5e-3).abs() <= 1e-12 * pressure);
                }
            } else {
                let free = distance > -1e-12 && pressure == 0.0 && force.is_none();
                assert!(free, "{i}: gap {distance}, force {pressure}");
            }
        }
        assert_eq!(forces.count(), 0);
    }
}

// Verifies: FEM-009, FEM-012.
#[test]
fn the_vertical_gap_is_the_height_of_the_circle_above_the_undeformed_place() {
    let model = coarse("6.6", Contact::VerticalGap);
    let solution = solve(&model, 3.0, 2.2);
    let state = solution.contact().expect("small strain");
    let mut slopes = 0.0;
    let points = model.surface().positions.iter().zip(&state.displacements);
    for (i, ([x, y], [_, uy])) in points.enumerate() {
        let offset = x - 2.2e-3;
        let drop = (6.5e-3f64 * 6.5e-3 - offset * offset).max(0.0).sqrt();
        let gap = 6.5e-3 - 3e-3 - drop - (y + uy);
        let pressure = state.pressures[i];
        if state.active.contains(&i) {
            let touches = gap.abs() < 1e-13 && pressure >= 0.0;
            assert!(touches, "{i}: {gap}, {pressure}");
            slopes += pressure * offset / drop;
        } else {
            let beside = drop == 0.0;
            assert!((beside || gap > -1e-12) && pressure == 0.0, "{i}: {gap}");
        }
    }
    let forces = model.surface().forces(state, solution.pose);
    let down: f64 = forces.iter().map(|(_, force)| -force[1]).sum();
    assert!(forces.iter().all(|(_, force)| force[0] == 0.0));
    assert!((down - solution.force.normal).abs() < 1e-12);
    // The pressure on the circle's right flank pushes the probe to the left.
    assert!((slopes + solution.force.lateral).abs() < 1e-12);
    assert!(solution.force.lateral.abs() > 1e-3);
}

// Verifies: FEM-007, FEM-008, FEM-013, FEM-009.
#[test]
fn condensed_contact_is_the_full_solve() {
    for (phantom, contact) in [
        (builtin("4.6"), CONTACTS[0]),
        (builtin("4.6"), CONTACTS[1]),
        (off_centre(4.6, 2.0), CONTACTS[0]),
    ] {
        let model = super::coarse(&phantom, contact);
        let solution = solve(&model, 3.5, 4.0);
        let field = model.field(&solution).unwrap();
        for k in 0..2 {
            let nodes = &model.mesh().surface;
            let nodes: Vec<f64> = nodes.iter().map(|&n| field.displacements[n][k]).collect();
            let full = at_contact_points(&nodes);
            for (u, full) in solution
                .contact()
                .expect("small strain")
                .displacements
                .iter()
                .zip(full)
            {
                // The bound of the requirement, 1e-9 N, at the surface's stiffness of some 10³ N/m.
                assert!((u[k] - full).abs() < 1e-12, "{u:?} {full}");
            }
        }
        let check = model.checks(std::slice::from_ref(&solution)).unwrap()[0];
        assert!(check.residual < 1e-8 && check.imbalance < 1e-9, "{check:?}");
        assert!(check.min_det > 0.1 && check.min_det < 1.0, "{check:?}");
    }
}

// Verifies: FEM-013.
#[test]
fn a_force_that_nothing_answers_is_an_imbalance_in_either_direction() {
    let model = coarse("4.6", CONTACTS[0]);
    let solution = solve(&model, 3.0, 2.0);
    let (displacements, forces) = model
        .surface()
        .at_nodes(solution.contact().expect("small strain"), solution.pose);
    let extra = [[0.0, 0.0], [2e-3, 0.0], [0.0, -3e-3], [-2e-3, 1e-3]];
    let poses = extra.map(|extra| {
        let mut forces = forces.clone();
        let middle = forces.len() / 2;
        (0..2).for_each(|k| forces[middle][k] += extra[k]);
        (displacements.clone(), forces)
    });
    let mut checker = Checker::new(&model.matrix, &model.factor, &model.samples);
    for (check, extra) in checker.check(&poses).unwrap().iter().zip(extra) {
        let expected = extra[0].abs().max(extra[1].abs());
        assert_near(check.imbalance, expected, 1e-9);
    }
}

// Verifies: FEM-013.
#[test]
fn the_penetration_is_the_depth_of_the_deepest_point_inside_the_probe() {
    for contact in CONTACTS {
        let model = coarse("4.6", contact);
        let surface = model.surface();
        let untouched = ContactState::untouched(surface.positions.len());
        let (depth, lateral, radius) = (2e-3, 1.3e-3, 6.5e-3);
        let pose = |depth: f64| Pose { depth, lateral };
        // The gel is flat: of the points those nearest to the probe's axis are the deepest.
        let offsets = surface.positions.iter().map(|[x, _]| (x - lateral).abs());
        let offset = offsets.fold(f64::INFINITY, f64::min);
        let expected = match contact {
            Contact::DeformedNormal => radius - offset.hypot(radius - depth),
            Contact::VerticalGap => (radius * radius - offset * offset).sqrt() - (radius - depth),
        };
        let found = surface.penetration(&untouched, pose(depth));
        assert_near(found, expected, 1e-15);
        // A probe above the surface is in no point.
        assert_eq!(surface.penetration(&untouched, pose(-1e-3)), 0.0);
    }
}

// Verifies: FEM-013, CON-004.
#[test]
fn reaction_of_floor_and_walls_is_the_force_on_the_probe() {
    let model = coarse("6.6", Contact::DeformedNormal);
    let solution = solve(&model, 2.0, 5.0);
    let field = model.field(&solution).unwrap();
    // Traction of the field at the held nodes, from the elements themselves.
    let mesh = model.mesh();
    let rule = crate::fem::element::StiffnessRule::default();
    let mut reaction = [0.0; 2];
    for (nodes, region) in mesh.elements().zip(&mesh.regions) {
        let material = region.material(model.phantom());
        let stiffness = rule
            .integrate(&mesh.positions(nodes), material, model.phantom().geometry())
            .unwrap();
        for (row, &node) in nodes.iter().enumerate() {
            if mesh.held[node as usize] != [true; 2] {
                continue;
            }
            assert_eq!(field.displacements[node as usize], [0.0, 0.0]);
            for (column, &other) in nodes.iter().enumerate() {
                let u = field.displacements[other as usize];
                for i in 0..2 {
                    let [by_x, by_y] = [0, 1].map(|j| stiffness[(2 * row + i, 2 * column + j)]);
                    reaction[i] += 0.030 * (by_x * u[0] + by_y * u[1]);
                }
            }
        }
    }
    // The gel is pushed down by the probe and held up by the floor.
    assert_near(reaction[1], solution.force.normal, 1e-9);
    assert!((reaction[0] - solution.force.lateral).abs() < 1e-9);
    assert!(solution.force.normal > 0.1);
}

// Verifies: FEM-012.
#[test]
fn forces_are_the_slopes_of_the_strain_energy() {
    // Central differences with step h are off by h² F''/6 ≈ 1e-14·10⁵ N and by the rounding 2 ε U/2h ≈
    // 1e-13 N; a node that meets the probe within the step adds at most its stiffness times h²/2h.
    let h = 1e-7;
    for contact in CONTACTS {
        let model = super::coarse(&off_centre(2.6, 1.0), contact);
        for (depth_mm, lateral_mm) in [(0.7, 1.3), (2.1, 3.7), (3.9, 0.4), (3.3, 9.1)] {
            let at = |depth: f64, lateral: f64| model.solve(Pose { depth, lateral }).unwrap();
            let (d, x) = (depth_mm * 1e-3, lateral_mm * 1e-3);
            let here = at(d, x);
            let normal = (at(d + h, x).energy - at(d - h, x).energy) / (2.0 * h);
            let lateral = -(at(d, x + h).energy - at(d, x - h).energy) / (2.0 * h);
            assert_near(normal, here.force.normal, 1e-5);
            assert_near(lateral, here.force.lateral, 1e-5);
            let compared = here.force.lateral.abs() > 1e-4;
            assert!(compared, "{contact:?}: nothing to compare");
        }
    }
}

// Verifies: FEM-009.
#[test]
fn the_contact_laws_agree_where_the_gel_hardly_moves() {
    let (deformed, vertical) = (coarse("none", CONTACTS[0]), coarse("none", CONTACTS[1]));
    let ratio = |depth_mm: f64| {
        let [a, b] = [&deformed, &vertical].map(|model| solve(model, depth_mm, 1.0).force.normal);
        a / b - 1.0
    };
    // Slopes at the contact's edge are √(2d/R): the laws differ by their square, some per cent at 1 mm.
    let (shallow, deep) = (ratio(0.001).abs(), ratio(3.0).abs());
    assert!(shallow < 2.0 * 0.001 / 6.5 * 2.0, "{shallow}");
    let differs = deep > 10.0 * shallow;
    assert!(differs, "{deep} against {shallow}: the option does nothing");
}

// Verifies: FEM-011.
#[test]
fn a_pose_that_does_not_converge_is_an_error_that_names_it() {
    let mut surface = coarse("none", Contact::DeformedNormal).surface().clone();
    let pose = pose(2.5e-3, 1.5e-3);
    let untouched = ContactState::untouched(surface.positions.len());
    assert!(surface.solve(pose, &untouched).is_ok(), "the sound surface");
    // Neither not-a-number nor a surface that answers a push by moving against it may pass.
    for spoil in [|_: f64| f64::NAN, |c: f64| -c] {
        let sound = surface.compliance.clone();
        let size = sound.nrows();
        surface.compliance = faer::Mat::from_fn(size, size, |i, j| spoil(sound[(i, j)]));
        let error = surface.solve(pose, &untouched).unwrap_err();
        assert!(matches!(error, FemError::NoConvergence { .. }), "{error}");
        let message = error.to_string();
        for part in ["depth 2.500 mm", "lateral 1.500 mm"] {
            assert!(message.contains(part), "{message}");
        }
        surface.compliance = sound;
    }
}

// Verifies: PHA-011.
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
    let still = model.solve(pose(0.0, 3e-3)).unwrap();
    let Force { lateral, normal } = still.force;
    assert_eq!([normal, lateral, still.energy], [0.0; 3]);
}

// Verifies: FEM-022.
#[test]
fn the_curvature_term_makes_newton_fast() {
    let model = coarse("2.6", Contact::DeformedNormal);
    let solution = solve(&model, 3.0, 2.0);
    let start = solution.contact().expect("small strain");
    let pose = pose(3.0005e-3, 2e-3);
    let next = model.surface().solve(pose, start).unwrap();
    // The test wants a step without change of contact.
    assert_eq!(next.active, start.active);
    // Steps of 5e-7 m over a radius of 6.5e-3 m: quadratic convergence goes 1e-4, 1e-8, 1e-16 of it; with a
    // normal that does not turn, each step leaves about a tenth of the one before. The last iteration only looks for points far
    // from the probe.
    assert!(next.iterations <= 5, "{} iterations", next.iterations);
}

// Verifies: FEM-011.
#[test]
fn poses_converge_with_every_contact() {
    let mut failed = Vec::new();
    for phantom in [builtin("none"), builtin("2.6"), off_centre(6.6, 5.0)] {
        for contact in CONTACTS {
            let model = Model::new(&phantom, MESH_SIZE, contact).unwrap();
            let depths = [1e-3, 2.5e-3, 4e-3, 6e-3].into_iter();
            for (depth, lateral) in
                depths.flat_map(|depth| [-9e-3, 0.0, 3.3e-3].map(|x| (depth, x)))
            {
                if let Err(error) = model.solve(Pose { depth, lateral }) {
                    failed.push(format!("{}, {contact:?}, {error}", phantom.name()));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
