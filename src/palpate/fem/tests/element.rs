use crate::fem::Mesh;
use crate::fem::element::{Stiffness, StiffnessRule, gradients, parent_gradients, stress};
use crate::fem::field::determinant;
use crate::fem::vtu::von_mises;
use crate::phantom::{Geometry, Material};
use palpate_asserts::{assert_near, numbers_of};

use super::builtin;

/// E = 1, ν = ¼: λ = μ = 2/5.
const QUARTER: Material = Material::isotropic(1.0, 0.25);

fn assert_close(stiffness: &Stiffness, expected: impl Fn(usize, usize) -> f64, unknowns: usize) {
    for row in 0..unknowns {
        for column in 0..unknowns {
            let (found, expected) = (stiffness[(row, column)], expected(row, column));
            // A few tens of rounded sums of numbers of size 3.
            assert_near(found, expected, 1e-14);
            assert_eq!(found, stiffness[(column, row)], "not symmetric to the bit");
        }
    }
}

// Verifies: FEM-005.
#[test]
fn triangle_matches_exact_rationals() {
    let corners = [[0.0, 0.0], [3.0, 1.0], [1.0, 2.0]];
    let middle = |a: usize, b: usize| [0, 1].map(|k| 0.5 * (corners[a][k] + corners[b][k]));
    let middles = [middle(0, 1), middle(1, 2), middle(2, 0)];
    let positions = [corners, middles].concat();
    let stiffness = StiffnessRule::default().integrate(&positions, &QUARTER, Geometry::Plane);
    let exact = numbers_of::<12>("tables/fem.txt", "stiffness of a triangle");
    let exact = |row: usize, column: usize| exact[row][column] / 75.0;
    assert_close(&stiffness.unwrap(), exact, 12);
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
    let material = Material::isotropic(1.0, 0.49);
    let rule = StiffnessRule::default();
    let mut force = vec![[0.0; 2]; mesh.nodes.len()];
    for nodes in mesh.elements() {
        let stiffness = rule
            .integrate(&mesh.positions(nodes), &material, Geometry::Plane)
            .unwrap();
        for (a, &node) in nodes.iter().enumerate() {
            for (b, &other) in nodes.iter().enumerate() {
                let displacement = u(mesh.nodes[other as usize]);
                for i in 0..2 {
                    for j in 0..2 {
                        force[node as usize][i] +=
                            stiffness[(2 * a + i, 2 * b + j)] * displacement[j];
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
    let phantom = builtin("2.6");
    let mesh = Mesh::new(&phantom, 2e-3).unwrap();
    let border = |node: usize| {
        let [x, y] = mesh.nodes[node];
        x.abs() == 0.5 * phantom.well().width || y == 0.0 || y == phantom.levels()[2]
    };
    // Entries of the stiffness go up to 20 (λ/E = 16.4 at ν = 0.49), displacements to 0.05: sums of about
    // 40 products of size 1 are off by 40 ε ≈ 1e-14 at most.
    let stretch = internal_force(&mesh, |[x, y]| [0.7 * x - 1.1 * y, 0.4 * x + 0.9 * y]);
    let inside = (0..mesh.nodes.len()).filter(|&node| !border(node));
    let largest = |forces: &[[f64; 2]]| {
        forces
            .iter()
            .flatten()
            .fold(0.0, |a: f64, b| a.max(b.abs()))
    };
    let inside: Vec<_> = inside.map(|node| stretch[node]).collect();
    let worst = largest(&inside);
    assert!(worst < 1e-14, "linear field leaves {worst:e}");
    assert!(largest(&stretch) > 1e-4, "the field is not seen at all");
    // A rigid motion loads nothing, border included.
    let turn = internal_force(&mesh, |[x, y]| [0.01 - y, 0.02 + x]);
    let worst = largest(&turn);
    assert!(worst < 1e-14, "rigid motion leaves {worst:e}");
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

// Verifies: FEM-005.
#[test]
fn parent_gradients_are_those_of_shape_functions() {
    // Shape functions are 1 at their own node and 0 at the others: a field that is x or y at every node has their
    // gradients, and constants none. On the parent element itself space is the parent's.
    let nodes = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [0.5, 0.0],
        [0.5, 0.5],
        [0.0, 0.5],
    ];
    for at in [[0.2, 0.3], [0.6, 0.1]] {
        let parent = parent_gradients(at);
        let found = gradients(&parent, &nodes);
        assert!((found.jacobian - 1.0).abs() < 1e-15);
        let sum = |of: &dyn Fn([f64; 2]) -> f64, k: usize| -> f64 {
            (0..nodes.len())
                .map(|a| of(nodes[a]) * found.of_node[(k, a)])
                .sum()
        };
        for k in 0..2 {
            assert!(sum(&|_| 1.0, k).abs() < 1e-15);
            for i in 0..2 {
                let expected = if i == k { 1.0 } else { 0.0 };
                assert!((sum(&|node| node[i], k) - expected).abs() < 1e-15);
            }
            // Quadratic fields.
            let expected = at[1 - k];
            assert!((sum(&|[x, y]| x * y, k) - expected).abs() < 1e-15);
            let expected = if k == 0 { 2.0 * at[0] } else { 0.0 };
            assert!((sum(&|[x, _]| x * x, k) - expected).abs() < 1e-15);
        }
    }
}
