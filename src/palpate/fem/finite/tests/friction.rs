//! Friction along paths.

use faer::Mat;
use nalgebra::Vector2;

use super::super::contact::Patch;
use super::super::{Equilibrium, Friction, Touch};
use super::{at, builtin, coarse, path, pose};
use palpate_asserts::assert_near;

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

// Verifies: FIN-012.
#[test]
fn a_path_at_a_depth_of_4_mm_is_steady_after_3_mm() {
    let phantom = builtin("6.6");
    let down = (1..=4).map(|k| [f64::from(k), 0.0]);
    let across = (1..=6).map(|k| [4.0, 0.5 * f64::from(k)]);
    let poses: Vec<[f64; 2]> = down.clone().chain(across).collect();
    let slid = path(&coarse(&phantom, Friction::Path(0.3)), &poses);
    let sliding = coarse(&phantom, Friction::Steady(0.3));
    // After 2 mm and after 3 mm.
    let [early, end] = [2.0, 3.0].map(|x| {
        let poses: Vec<[f64; 2]> = down.clone().map(|[depth, _]| [depth, x]).collect();
        let (steady, along) = (at(&sliding, &poses).force, &slid[3 + 2 * x as usize]);
        assert_near(along.pose.lateral, 1e-3 * x, 1e-15);
        [
            along.force.normal - steady.normal,
            along.force.lateral - steady.lateral,
        ]
    });
    assert!(end[0].abs() < 1e-8 && end[1].abs() < 1e-8, "{end:?}");
    assert!(early[0] > 0.01 && early[1] > 0.2, "{early:?}");
}

// A node on the probe's lowest point that is held by 0.05 N upwards.
// Verifies: FIN-005.
#[test]
fn a_node_that_the_probe_would_have_to_pull_comes_off() {
    let stiffness = Mat::from_fn(2, 2, |a, b| if a == b { 100.0 } else { 0.0 });
    let patch = Patch {
        pose: pose(1.0, 0.0),
        radius: 6.5e-3,
        friction: Friction::None,
        positions: &[[0.0, 0.0]],
        displacements: &[0.0, -1e-3],
        forces: &[0.0, 0.05],
        stiffness: &stiffness,
        arcs: &[0.0],
    };
    let settled = patch.settle(&[Touch::Slips(0.0)]).unwrap();
    assert_eq!(settled.touches, [Touch::Apart]);
    assert_eq!(settled.forces, [0.0, 0.0]);
    // Let go, over 100 N/m.
    assert_near(settled.displacements[1], -1.5e-3, 1e-15);
}
