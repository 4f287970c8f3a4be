//! What walls and floor do to the whole phantom.

use crate::fem::assembly::StiffnessMatrix;
use crate::fem::cholesky::Factor;
use crate::fem::element::lame;
use crate::fem::{Contact, Mesh};
use crate::phantom::{Material, Phantom, Support};

use super::{builtin, coarse, off_centre, pose, small};

/// The supports that hold a phantom in place.
pub const SUPPORTS: [(Support, Support); 6] = [
    (Support::Fixed, Support::Fixed),
    (Support::Fixed, Support::Sliding),
    (Support::Fixed, Support::Free),
    (Support::Sliding, Support::Fixed),
    (Support::Sliding, Support::Sliding),
    (Support::Free, Support::Fixed),
];

pub fn held_by(phantom: Phantom, (walls, floor): (Support, Support)) -> Phantom {
    let held = phantom.changed(|parts| (parts.well.walls, parts.well.floor) = (walls, floor));
    held.expect("supports that hold")
}

// Verifies: FEM-004.
#[test]
fn a_shift_of_everything_costs_nothing() {
    for supports in SUPPORTS {
        let phantom = held_by(small(0.4), supports);
        let mesh = Mesh::new(&phantom, 2e-3).unwrap();
        let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
        let n = matrix.unknowns();
        for direction in 0..2 {
            // Free displacements of 1 and held ones of 1, whose forces on the free ones are the reactions' rows.
            let mut shift = vec![[[0.0]]; n];
            for unknown in (0..mesh.nodes.len()).filter_map(|k| matrix.unknown(k, direction)) {
                shift[unknown] = [[1.0]];
            }
            let mut rest: Vec<[[f64; 1]; 1]> = (matrix.reaction[direction].iter())
                .map(|&reaction| [[-reaction]])
                .collect();
            matrix.residual(&shift, &mut rest, 0);
            let left = rest.iter().fold(0.0, |a: f64, [[f]]| a.max(f.abs()));
            let diagonal = (0..n).map(|k| matrix.upper.val_of_col(k).last().copied().unwrap());
            // Rows of some thirty entries of at most the largest diagonal.
            let largest = diagonal.fold(0.0, f64::max);
            let holds = left < 1e-14 * largest;
            assert!(holds, "{supports:?}, {direction}: {left:e}");
        }
    }
}

// Verifies: FEM-004.
#[test]
fn a_slab_between_lubricated_walls_is_squeezed_as_a_column() {
    // Under a uniform pressure p each layer yields by p t/M with M = λ + 2μ, and nothing moves sideways.
    let held = held_by(builtin("none"), (Support::Sliding, Support::Sliding));
    let soft = Material::isotropic(2e3, 0.3);
    let below = held.changed(|parts| {
        parts.layers.push(parts.layers[1].clone());
        parts.layers[2].material = soft;
    });
    let phantom = below.unwrap();
    let pressure = 100.0;
    let mesh = Mesh::new(&phantom, 2e-3).unwrap();
    let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
    let mut force = vec![0.0; matrix.unknowns()];
    let shares = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
    for edge in mesh.surface.windows(3).step_by(2) {
        let width = mesh.nodes[edge[2]][0] - mesh.nodes[edge[0]][0];
        for (&node, share) in edge.iter().zip(shares) {
            let unknown = matrix.unknown(node, 1).expect("free to slide down");
            force[unknown] -= pressure * width * phantom.probe().length * share;
        }
    }
    let (u, _) = Factor::new(&matrix)
        .unwrap()
        .solve(&matrix, &force)
        .unwrap();
    let levels = phantom.levels();
    let exact = |y: f64| -> f64 {
        let yields = |k: usize| {
            let (lambda, mu) = lame(&phantom.layers()[k].material);
            pressure * (y.min(levels[k]) - levels[k + 1]).max(0.0) / (lambda + 2.0 * mu)
        };
        -(0..phantom.layers().len()).map(yields).sum::<f64>()
    };
    let top = exact(0.0).abs();
    for (node, &[_, y]) in mesh.nodes.iter().enumerate() {
        let moved = [0, 1].map(|k| matrix.unknown(node, k).map_or(0.0, |at| u[at]));
        // The residual, 1e-14, times the condition of K, some 1e6.
        assert!(moved[0].abs() < 1e-8 * top, "{y}: {moved:?}");
        assert!((moved[1] - exact(y)).abs() < 1e-8 * top, "{y}: {moved:?}");
    }
}

// Verifies: FEM-004.
#[test]
fn what_holds_less_pushes_back_less() {
    let pose = pose(3e-3, 8e-3);
    for (chain, at_least) in [
        // The walls go first, then the floor.
        (vec![0, 3, 4], 0.02),
        (vec![0, 3, 5], 0.01),
        (vec![0, 1, 2], 0.002),
    ] {
        let force = |&k: &usize| {
            let phantom = held_by(off_centre(6.6, 2.0), SUPPORTS[k]);
            let model = coarse(&phantom, Contact::VerticalGap);
            let solution = model.solve(pose).unwrap();
            let check = model.checks(std::slice::from_ref(&solution)).unwrap()[0];
            // Forces on the gel that a support without friction cannot take are none.
            assert!(check.imbalance < 1e-9 && check.residual < 1e-8, "{check:?}");
            solution.force.normal
        };
        let forces: Vec<f64> = chain.iter().map(force).collect();
        let less = |a: &f64, b: &f64| *b < (1.0 - at_least) * a;
        assert!(forces.is_sorted_by(less), "{chain:?}: {forces:?}");
    }
}

// Verifies: FEM-004.
#[test]
fn the_surface_s_ends_move_where_no_wall_holds_them() {
    for supports in SUPPORTS {
        let model = coarse(&held_by(builtin("none"), supports), Contact::default());
        let matrix = &model.matrix;
        let compliance = model.factor.surface_compliance(matrix).unwrap();
        let last = compliance.nrows() - 2;
        let expected = match supports.0 {
            Support::Fixed => [false, false],
            Support::Sliding => [false, true],
            Support::Free => [true, true],
        };
        for end in [0, last] {
            let moves = [0, 1].map(|k| compliance[(end + k, end + k)] > 0.0);
            assert_eq!(moves, expected, "{supports:?}");
        }
    }
}
