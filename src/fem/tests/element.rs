use crate::fem::assembly::StiffnessMatrix;
use crate::fem::cholesky::check_residual;
use crate::fem::element::{Stiffness, StiffnessRule, stress};
use crate::fem::field::determinant;
use crate::fem::mesh::Region;
use crate::fem::vtu::von_mises;
use crate::fem::{Element, FemError, Mesh, MeshOptions};
use crate::phantom::Material;

use super::builtin;

/// E = 1, ν = ¼: λ = μ = 2/5.
const QUARTER: Material = Material {
    youngs_modulus: 1.0,
    poisson_ratio: 0.25,
};

fn assert_close(stiffness: &Stiffness, expected: impl Fn(usize, usize) -> f64, unknowns: usize) {
    for row in 0..unknowns {
        for column in 0..unknowns {
            let (found, expected) = (stiffness[row][column], expected(row, column));
            // A few tens of rounded sums of numbers of size 3.
            assert!(
                (found - expected).abs() < 1e-14,
                "[{row}][{column}] = {found}, expected {expected}"
            );
            assert_eq!(found, stiffness[column][row], "not symmetric to the bit");
        }
    }
}

/// 75 times the stiffness of the straight triangle (0,0), (3,1), (1,2), in exact rational arithmetic: the
/// gradients' products are quadratic, so that the rule at the three edge midpoints integrates them exactly.
const TRIANGLE_75: [[i32; 12]; 12] = [
    [21, 12, 4, 3, 3, 1, -16, -12, 0, 0, -12, -4],
    [12, 39, 3, -4, 1, 17, -12, 16, 0, 0, -4, -68],
    [4, 3, 39, -12, 9, -7, -16, -12, -36, 28, 0, 0],
    [3, -4, -12, 21, -7, 11, -12, 16, 28, -44, 0, 0],
    [3, 1, 9, -7, 36, -18, 0, 0, -36, 28, -12, -4],
    [1, 17, -7, 11, -18, 84, 0, 0, 28, -44, -4, -68],
    [-16, -12, -16, -12, 0, 0, 128, -24, -24, -8, -72, 56],
    [-12, 16, -12, 16, 0, 0, -24, 192, -8, -136, 56, -88],
    [0, 0, -36, 28, -36, 28, -24, -8, 128, -24, -32, -24],
    [0, 0, 28, -44, 28, -44, -8, -136, -24, 192, -24, 32],
    [-12, -4, 0, 0, -12, -4, -72, 56, -32, -24, 128, -24],
    [-4, -68, 0, 0, -4, -68, 56, -88, -24, 32, -24, 192],
];

// Verifies: FEM-005.
#[test]
fn triangle_matches_exact_rationals() {
    let corners = [[0.0, 0.0], [3.0, 1.0], [1.0, 2.0]];
    let middle = |a: usize, b: usize| [0, 1].map(|k| 0.5 * (corners[a][k] + corners[b][k]));
    let positions = [
        corners[0],
        corners[1],
        corners[2],
        middle(0, 1),
        middle(1, 2),
        middle(2, 0),
    ];
    let stiffness = StiffnessRule::new(Element::T6)
        .integrate(&positions, &QUARTER)
        .unwrap();
    assert_close(
        &stiffness,
        |row, column| f64::from(TRIANGLE_75[row][column]) / 75.0,
        12,
    );
}

// Verifies: FEM-005.
#[test]
fn square_matches_the_published_closed_form() {
    // The unit square in plane stress (O. Sigmund, A 99 line topology optimization code, 2001), whose
    // constants in plane strain are E/(1 − ν²) and ν/(1 − ν).
    let (e, nu) = (1.0 / (1.0 - 0.0625), 0.25 / 0.75);
    let k: [f64; 8] = [
        0.5 - nu / 6.0,
        0.125 + nu / 8.0,
        -0.25 - nu / 12.0,
        -0.125 + 3.0 * nu / 8.0,
        -0.25 + nu / 12.0,
        -0.125 - nu / 8.0,
        nu / 6.0,
        0.125 - 3.0 * nu / 8.0,
    ];
    let pattern = [
        [0, 1, 2, 3, 4, 5, 6, 7],
        [1, 0, 7, 6, 5, 4, 3, 2],
        [2, 7, 0, 5, 6, 3, 4, 1],
        [3, 6, 5, 0, 7, 2, 1, 4],
        [4, 5, 6, 7, 0, 1, 2, 3],
        [5, 4, 3, 2, 1, 0, 7, 6],
        [6, 3, 4, 1, 2, 7, 0, 5],
        [7, 2, 1, 4, 3, 6, 5, 0],
    ];
    let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let stiffness = StiffnessRule::new(Element::Q4Full)
        .integrate(&positions, &QUARTER)
        .unwrap();
    assert_close(
        &stiffness,
        |row, column| e / (1.0 - nu * nu) * k[pattern[row][column]],
        8,
    );
}

// Verifies: FEM-005.
#[test]
fn stress_obeys_hooke() {
    // ε_x = 2, ε_y = −1, γ_xy = 3 with λ = μ = 2/5: σ = λ tr ε + 2 μ ε.
    let sigma = stress(&QUARTER, [[2.0, 1.0], [2.0, -1.0]]);
    for (found, expected) in sigma.iter().zip([2.0, -0.4, 0.4, 1.2]) {
        assert!((found - expected).abs() < 1e-15, "{sigma:?}");
    }
}

/// Internal force at each node under the displacement `u`, with one material everywhere.
fn internal_force(mesh: &Mesh, u: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
    let material = Material {
        youngs_modulus: 1.0,
        poisson_ratio: 0.49,
    };
    let rule = StiffnessRule::new(mesh.element);
    let mut force = vec![[0.0; 2]; mesh.nodes.len()];
    for nodes in mesh.elements() {
        let stiffness = rule.integrate(&mesh.positions(nodes), &material).unwrap();
        for (a, &node) in nodes.iter().enumerate() {
            for (b, &other) in nodes.iter().enumerate() {
                let displacement = u(mesh.nodes[other as usize]);
                for i in 0..2 {
                    for j in 0..2 {
                        force[node as usize][i] +=
                            stiffness[2 * a + i][2 * b + j] * displacement[j];
                    }
                }
            }
        }
    }
    force
}

// Verifies: FEM-005.
#[test]
fn linear_fields_and_rigid_motions_leave_the_inside_in_balance() {
    for element in [Element::T6, Element::Q4Full] {
        let options = MeshOptions {
            size: 2e-3,
            refinement: 1,
            element,
        };
        let mesh = Mesh::new(&builtin("2.6"), &options).unwrap();
        let border = |node: usize| {
            let last = mesh.rows.len() - 1;
            let row = mesh
                .rows
                .iter()
                .position(|row| row.contains(&node))
                .unwrap();
            row == 0
                || row == last
                || node == mesh.rows[row].start
                || node + 1 == mesh.rows[row].end
        };
        // Entries of the stiffness go up to 20 (λ/E = 16.4 at ν = 0.49), displacements to 0.05: sums of about
        // 40 products of size 1 are off by 40 ε ≈ 1e-14 at most.
        let stretch = internal_force(&mesh, |[x, y]| [0.7 * x - 1.1 * y, 0.4 * x + 0.9 * y]);
        let inside = (0..mesh.nodes.len()).filter(|&node| !border(node));
        let worst = inside
            .flat_map(|node| stretch[node])
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(worst < 1e-14, "{element:?}: linear field leaves {worst:e}");
        let border_force = stretch
            .iter()
            .flatten()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(
            border_force > 1e-4,
            "{element:?}: the field is not seen at all"
        );
        // A rigid motion loads nothing, border included.
        let turn = internal_force(&mesh, |[x, y]| [0.01 - y, 0.02 + x]);
        let worst = turn.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(worst < 1e-14, "{element:?}: rigid motion leaves {worst:e}");
    }
}

// Verifies: FEM-017.
#[test]
fn an_element_turned_inside_out_is_an_error_that_says_where() {
    let phantom = builtin("none");
    let mut mesh = Mesh::new(
        &phantom,
        &MeshOptions {
            size: 2e-3,
            ..MeshOptions::default()
        },
    )
    .unwrap();
    let node = mesh.connectivity[6 * 100] as usize;
    let row = mesh.rows.iter().find(|row| row.contains(&node)).unwrap();
    let image = row.start + row.end - 1 - node;
    assert_ne!(node, image);
    for node in [node, image] {
        mesh.nodes[node][1] += 0.01;
    }
    let error = StiffnessMatrix::assemble(&mesh, &phantom).unwrap_err();
    assert!(
        matches!(error, FemError::Degenerate { jacobian, .. } if jacobian <= 0.0),
        "{error}"
    );
    assert!(error.to_string().contains("near x = "), "{error}");
}

// Verifies: FEM-029.
#[test]
fn a_mesh_that_is_not_its_own_mirror_image_is_refused() {
    let phantom = builtin("4.6");
    let options = MeshOptions {
        size: 2e-3,
        ..MeshOptions::default()
    };
    let mesh = Mesh::new(&phantom, &options).unwrap();
    assert!(StiffnessMatrix::assemble(&mesh, &phantom).is_ok());
    // A surface node a nanometre off; a triangle of another region; one that runs through other nodes.
    let mut moved = mesh.clone();
    let node = moved.surface().start + 3;
    moved.nodes[node][0] += 1e-9;
    let mut harder = mesh.clone();
    harder.regions[100] = Region::Skin;
    let mut twisted = mesh.clone();
    twisted.connectivity[600..606].rotate_left(1);
    twisted.connectivity.swap(601, 1207);
    for (what, mesh) in [("moved", moved), ("harder", harder), ("twisted", twisted)] {
        let error = StiffnessMatrix::assemble(&mesh, &phantom)
            .map(drop)
            .unwrap_err();
        assert!(
            matches!(error, FemError::Asymmetric { .. }),
            "{what}: {error}"
        );
        assert!(error.to_string().contains("near x = "), "{error}");
    }
}

// Verifies: FEM-013.
#[test]
fn determinant_is_that_of_the_deformation() {
    // I + ∇u = [[3, 1], [5, 4]].
    assert_eq!(determinant([[2.0, 1.0], [5.0, 3.0]]), 7.0);
    assert_eq!(determinant([[0.0; 2]; 2]), 1.0);
}

// Verifies: FEM-016.
#[test]
fn von_mises_is_the_stress_of_the_pulled_bar() {
    assert_eq!(von_mises([7.0, 0.0, 0.0, 0.0]), 7.0);
    assert_eq!(von_mises([5.0, 5.0, 5.0, 0.0]), 0.0);
    // Pure shear τ yields at τ √3.
    assert!((von_mises([0.0, 0.0, 0.0, 2.0]) - 2.0 * 3f64.sqrt()).abs() < 1e-15);
}

// Verifies: FEM-008.
#[test]
fn a_residual_above_the_limit_is_an_error() {
    assert_eq!(check_residual(1e-8), Ok(()));
    for residual in [1.1e-8, f64::INFINITY, f64::NAN] {
        assert!(
            matches!(check_residual(residual), Err(FemError::Residual { .. })),
            "{residual}"
        );
    }
}

// Verifies: FEM-008.
#[test]
fn the_residual_told_is_the_one_left() {
    let phantom = builtin("2.6");
    let mesh = Mesh::new(&phantom, &MeshOptions::default()).unwrap();
    let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
    let factor = crate::fem::cholesky::Factor::new(&matrix).unwrap();
    let mut force = vec![0.0; matrix.numbering.unknowns()];
    for (k, force) in force
        .iter_mut()
        .enumerate()
        .skip(matrix.numbering.first_surface_unknown())
    {
        *force = (k % 7) as f64 - 3.0;
    }
    let (u, refined) = factor.solve(&matrix, &force).unwrap();
    let mut rest: Vec<[f64; 1]> = force.iter().map(|&f| [f]).collect();
    let single: Vec<[f64; 1]> = u.iter().map(|&u| [u]).collect();
    matrix.subtract_product(&single, &mut rest);
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    let left = norm(&mut rest.iter().map(|r| r[0])) / norm(&mut force.iter().copied());
    assert!(
        (left / refined - 1.0).abs() < 0.5,
        "the residual told, {refined:e}, is not the one left, {left:e}"
    );
}
