use nalgebra::DMatrix;

use crate::fem::Mesh;
use crate::fem::assembly::StiffnessMatrix;
use crate::fem::element::StiffnessRule;
use crate::fem::ordering::dissection;
use crate::phantom::Phantom;

use super::supports::{SUPPORTS, held_by};
use super::{builtin, off_centre, small};

fn mesh(phantom: &Phantom) -> Mesh {
    Mesh::new(phantom, 3e-3).unwrap()
}

/// The stiffness of everything, held displacements too: displacement i of node a is row 2a + i.
fn everything(mesh: &Mesh, phantom: &Phantom) -> DMatrix<f64> {
    let rule = StiffnessRule::default();
    let n = 2 * mesh.nodes.len();
    let mut all = DMatrix::zeros(n, n);
    for (nodes, region) in mesh.elements().zip(&mesh.regions) {
        let element = rule.integrate(
            &mesh.positions(nodes),
            region.material(phantom),
            phantom.geometry(),
        );
        let element = element.unwrap();
        let place = |k: usize| 2 * nodes[k / 2] as usize + k % 2;
        for row in 0..2 * nodes.len() {
            for column in 0..2 * nodes.len() {
                all[(place(row), place(column))] += phantom.probe().length * element[(row, column)];
            }
        }
    }
    all
}

// Verifies: FEM-006.
#[test]
fn every_node_below_the_surface_is_eliminated_once() {
    for phantom in [builtin("none"), builtin("2.6"), off_centre(4.6, -2.0)] {
        let mesh = Mesh::new(&phantom, 1e-3).unwrap();
        let mut order = dissection(&mesh);
        assert!(!order.is_sorted(), "nothing is dissected");
        order.extend(&mesh.surface);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..mesh.nodes.len()));
    }
}

// Verifies: FEM-006, FEM-004, CON-004.
#[test]
fn the_matrix_is_the_sum_of_the_elements() {
    for supports in SUPPORTS {
        let phantom = held_by(small(0.4), supports);
        let mesh = mesh(&phantom);
        let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
        let all = everything(&mesh, &phantom);
        let largest = all.amax();
        // Both sides add the same some ten numbers in different orders.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14 * largest;
        // Where each unknown stands in the whole, each once, and those held have none.
        let mut place = vec![usize::MAX; matrix.unknowns()];
        for k in 0..all.nrows() {
            match matrix.unknown(k / 2, k % 2) {
                Some(unknown) => {
                    assert_eq!(std::mem::replace(&mut place[unknown], k), usize::MAX);
                }
                None => assert!(mesh.held[k / 2][k % 2]),
            }
        }
        assert!(!place.contains(&usize::MAX));
        let mut seen = DMatrix::zeros(matrix.unknowns(), matrix.unknowns());
        for column in 0..matrix.unknowns() {
            let rows = matrix.upper.row_idx_of_col(column);
            for (row, &value) in rows.zip(matrix.upper.val_of_col(column)) {
                assert!(row <= column);
                seen[(row, column)] = value;
                seen[(column, row)] = value;
            }
        }
        for (row, &a) in place.iter().enumerate() {
            for (column, &b) in place.iter().enumerate() {
                assert!(close(seen[(row, column)], all[(a, b)]), "{row}, {column}");
            }
        }
        // The surface comes last, from left to right, and reactions are the rows of what is held.
        let at_surface: Vec<_> = (mesh.surface.iter())
            .flat_map(|&node| [0, 1].map(|k| matrix.unknown(node, k)))
            .collect();
        assert_eq!(matrix.surface, at_surface);
        let free = matrix.surface.iter().flatten().copied();
        assert!(free.eq(matrix.first_surface_unknown..matrix.unknowns()));
        for direction in 0..2 {
            for (unknown, &column) in place.iter().enumerate() {
                let held = (0..mesh.nodes.len()).filter(|&node| mesh.held[node][direction]);
                let expected = held.map(|node| all[(2 * node + direction, column)]);
                let found = matrix.reaction[direction][unknown];
                assert!(close(found, expected.sum()), "{direction}, {unknown}");
            }
        }
    }
}

// Verifies: FEM-017.
#[test]
fn an_element_turned_inside_out_is_an_error_that_says_where() {
    let phantom = builtin("none");
    let mut mesh = Mesh::new(&phantom, 2e-3).unwrap();
    let node = mesh.connectivity[6 * 100] as usize;
    mesh.nodes[node][1] += 0.01;
    let error = StiffnessMatrix::assemble(&mesh, &phantom).unwrap_err();
    let said = error.to_string();
    let holds = said.contains("near x = ") && said.contains("has the Jacobian -");
    assert!(holds, "{said}");
}
