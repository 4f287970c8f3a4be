use nalgebra::{Cholesky, DMatrix};

use crate::fem::assembly::StiffnessMatrix;
use crate::fem::cholesky::Factor;
use crate::fem::{Element, FemError, Mesh, MeshOptions, SquareMatrix};

use super::builtin;

/// On a mesh with `quarters`/4 of the cells of one of 4 mm: some 900 nodes for two quarters.
fn assembled(name: &str, quarters: usize, element: Element) -> StiffnessMatrix {
    let options = MeshOptions {
        size: 4e-3,
        element,
        ..MeshOptions::default()
    };
    let mesh = Mesh::with_quarters(&builtin(name), &options, quarters).unwrap();
    StiffnessMatrix::assemble(&mesh, &builtin(name)).unwrap()
}

/// The whole matrix, to be factorised by nalgebra.
fn dense(matrix: &StiffnessMatrix) -> DMatrix<f64> {
    let n = matrix.numbering.unknowns();
    let mut dense = DMatrix::zeros(n, n);
    for j in 0..n {
        let (rows, values) = matrix.column(j);
        for (&i, &value) in rows.iter().zip(values) {
            dense[(i as usize, j)] = value;
            dense[(j, i as usize)] = value;
        }
    }
    dense
}

/// Ours as nalgebra's.
fn as_dense(matrix: &SquareMatrix) -> DMatrix<f64> {
    DMatrix::from_column_slice(matrix.order(), matrix.order(), matrix.as_slice())
}

#[test]
fn an_entry_stands_where_its_row_and_column_say() {
    let entry = |row: usize, column: usize| (10 * row + column) as f64;
    let (ours, theirs) = (
        SquareMatrix::from_fn(3, entry),
        DMatrix::from_fn(3, 3, entry),
    );
    assert_eq!(as_dense(&ours), theirs);
    assert_eq!((ours.order(), ours[(2, 1)], ours[(1, 2)]), (3, 21.0, 12.0));
}

// Verifies: FEM-006, FEM-007.
#[test]
fn the_surface_stiffness_is_the_schur_complement_of_a_dense_factor() {
    for (name, quarters, element) in [("2.6", 2, Element::T6), ("8.6", 2, Element::Q4Full)] {
        let matrix = assembled(name, quarters, element);
        let factor = Factor::new(&matrix).unwrap();
        let (n, first) = (
            matrix.numbering.unknowns(),
            matrix.numbering.first_surface_unknown(),
        );
        let lower = Cholesky::new(dense(&matrix)).unwrap().unpack();
        let corner = lower.view((first, first), (n - first, n - first));
        let schur = corner * corner.transpose();
        let stiffness = as_dense(&factor.surface_stiffness());
        assert_eq!(stiffness.nrows(), n - first);
        let relative = (&stiffness - &schur).norm() / schur.norm();
        // Cholesky is off by at most some 10 n ε relative to ‖K‖, here 1e-12; the skin's ‖S‖ is about ‖K‖.
        assert!(relative < 1e-12, "{name}: off by {relative:e}");
        let identity = as_dense(&factor.surface_compliance()) * &schur;
        let error = (identity - DMatrix::identity(n - first, n - first)).norm();
        // 1e-12 times the condition of S, some 1e3 between the skin's stretching and the gel's yielding.
        assert!(error < 1e-9, "{name}: C S is off by {error:e}");
    }
}

// Verifies: FEM-007, FEM-008.
#[test]
fn a_load_anywhere_has_the_displacements_of_a_dense_solve() {
    let matrix = assembled("4.6", 2, Element::T6);
    let n = matrix.numbering.unknowns();
    // On either side, on the axis, inside and on the surface, with nothing symmetric about it.
    let force: Vec<f64> = (0..n)
        .map(|k| ((k * k + 3 * k) % 17) as f64 - 8.0)
        .collect();
    let (u, residual) = Factor::new(&matrix)
        .unwrap()
        .solve(&matrix, &force)
        .unwrap();
    assert!(residual < 1e-8, "{residual:e}");
    let reference = Cholesky::new(dense(&matrix))
        .unwrap()
        .solve(&DMatrix::from_column_slice(n, 1, &force));
    let error = u
        .iter()
        .zip(reference.iter())
        .fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    // The dense solve without refinement is off by n ε times the condition, some 1e5, of K.
    assert!(
        error < 1e-8 * reference.amax(),
        "{error:e} of {:e}",
        reference.amax()
    );
}

// Verifies: FEM-023.
#[test]
fn the_surface_compliance_is_mirror_symmetric_to_the_bit() {
    let matrix = assembled("2.6", 3, Element::T6);
    let compliance = Factor::new(&matrix).unwrap().surface_compliance();
    let n = compliance.order();
    let mirror = |unknown: usize| n - 2 - 2 * (unknown / 2) + unknown % 2;
    for row in 0..n {
        for column in 0..n {
            let sign = if row % 2 == column % 2 { 1.0 } else { -1.0 };
            let image = sign * compliance[(mirror(row), mirror(column))];
            // +0 and −0 are the same compliance.
            assert_eq!(compliance[(row, column)], image, "{row}, {column}");
            assert_eq!(compliance[(row, column)], compliance[(column, row)]);
        }
    }
}

// Verifies: FEM-008.
#[test]
fn a_matrix_that_is_not_positive_definite_is_an_error() {
    for spoil in [|x: f64| -x, |_: f64| f64::NAN] {
        let mut matrix = assembled("2.6", 2, Element::T6);
        let diagonal = matrix.column_starts[401] as usize - 1;
        matrix.values[diagonal] = spoil(matrix.values[diagonal]);
        let error = Factor::new(&matrix).unwrap_err();
        assert_eq!(error, FemError::NotPositiveDefinite);
    }
}
