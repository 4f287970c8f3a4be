use faer::Mat;
use nalgebra::{Cholesky, DMatrix};

use crate::fem::assembly::StiffnessMatrix;
use crate::fem::cholesky::{Factor, check_residual};
use crate::fem::{Contact, FemError, Mesh};
use crate::phantom::Phantom;
use palpate_asserts::assert_near;

use super::{builtin, coarse, off_centre, small};

fn assembled(phantom: &Phantom) -> StiffnessMatrix {
    let mesh = Mesh::new(phantom, 2e-3).unwrap();
    StiffnessMatrix::assemble(&mesh, phantom).unwrap()
}

/// The whole matrix, to be factorised by nalgebra.
fn dense(matrix: &StiffnessMatrix) -> DMatrix<f64> {
    let n = matrix.unknowns();
    let mut dense = DMatrix::zeros(n, n);
    for column in 0..n {
        let rows = matrix.upper.row_idx_of_col(column);
        for (row, &value) in rows.zip(matrix.upper.val_of_col(column)) {
            dense[(row, column)] = value;
            dense[(column, row)] = value;
        }
    }
    dense
}

fn as_dense(matrix: &Mat<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
}

// Verifies: FEM-006, FEM-007.
#[test]
fn the_surface_stiffness_is_the_schur_complement_of_a_dense_factor() {
    for centre_x in [0.0, 0.4] {
        let matrix = assembled(&small(centre_x));
        let factor = Factor::new(&matrix).unwrap();
        let (n, first) = (matrix.unknowns(), matrix.first_surface_unknown);
        let size = n - first;
        let lower = Cholesky::new(dense(&matrix)).unwrap().unpack();
        let corner = lower.view((first, first), (size, size));
        let schur = corner * corner.transpose();
        let stiffness = as_dense(&(&factor.surface * factor.surface.transpose()));
        let relative = (&stiffness - &schur).norm() / schur.norm();
        // Cholesky is off by at most some 10 n ε relative to ‖K‖, here 1e-12; the skin's ‖S‖ is about ‖K‖.
        assert!(relative < 1e-12, "off by {relative:e}");
        // The wall holds both ends, which have no compliance.
        let compliance = as_dense(&factor.surface_compliance(&matrix).unwrap());
        assert_eq!(compliance.nrows(), size + 4);
        for held in [0, 1, size + 2, size + 3] {
            assert!(compliance.row(held).iter().all(|&entry| entry == 0.0));
            assert!(compliance.column(held).iter().all(|&entry| entry == 0.0));
        }
        let identity = compliance.view((2, 2), (size, size)) * &schur;
        let error = (identity - DMatrix::identity(size, size)).norm();
        // 1e-12 times the condition of S, some 1e3 between the skin's stretching and the gel's yielding.
        assert!(error < 1e-9, "C S is off by {error:e}");
        assert_eq!(compliance, compliance.transpose());
    }
}

// Verifies: FEM-007, FEM-008.
#[test]
fn a_load_anywhere_has_the_displacements_of_a_dense_solve() {
    let matrix = assembled(&small(0.4));
    let n = matrix.unknowns();
    // Inside and on the surface, with nothing symmetric about it.
    let force: Vec<f64> = (0..n)
        .map(|k| ((k * k + 3 * k) % 17) as f64 - 8.0)
        .collect();
    let factor = Factor::new(&matrix).unwrap();
    let (u, residual) = factor.solve(&matrix, &force).unwrap();
    assert!(residual < 1e-8, "{residual:e}");
    let reference = Cholesky::new(dense(&matrix))
        .unwrap()
        .solve(&DMatrix::from_column_slice(n, 1, &force));
    let off = u.iter().zip(reference.iter()).map(|(a, b)| (a - b).abs());
    let error = off.fold(0.0, f64::max);
    // The dense solve without refinement is off by n ε times the condition, some 1e5, of K.
    let holds = error < 1e-8 * reference.amax();
    assert!(holds, "{error:e} of {:e}", reference.amax());
}

// Verifies: FEM-007.
#[test]
fn fields_are_filled_in_from_the_surface() {
    let matrix = assembled(&small(0.4));
    let factor = Factor::new(&matrix).unwrap();
    let (n, first) = (matrix.unknowns(), matrix.first_surface_unknown);
    let mut force = vec![0.0; n];
    for (k, force) in force.iter_mut().enumerate().skip(first) {
        *force = (k % 7) as f64 - 3.0;
    }
    let (u, _) = factor.solve(&matrix, &force).unwrap();
    // Two fields at once, the second of three times the first's size; whatever stood below the surface is replaced.
    let mut fields: Vec<[[f64; 1]; 2]> = u.iter().map(|&u| [[u], [3.0 * u]]).collect();
    fields[..first].fill([[7.0], [f64::NAN]]);
    factor.extend_to_interior(&mut fields).unwrap();
    let largest = u.iter().fold(0.0, |a: f64, u| a.max(u.abs()));
    for (u, found) in u.iter().zip(&fields) {
        for (factor, found) in [1.0, 3.0].into_iter().zip(found.as_flattened()) {
            // As in the solve above.
            assert_near(factor * u, *found, 1e-8 * largest);
        }
    }
}

// Verifies: FEM-014.
#[test]
fn the_surface_compliance_is_mirror_symmetric_to_the_bit() {
    for (phantom, symmetric) in [(builtin("2.6"), true), (off_centre(2.6, 2.0), false)] {
        let model = coarse(&phantom, Contact::default());
        let compliance = &model.surface().compliance;
        let n = compliance.nrows();
        assert_eq!(n, 2 * model.surface().positions.len());
        let mirror = |place: usize| n - 2 - 2 * (place / 2) + place % 2;
        let mut unlike = 0;
        for row in 0..n {
            for column in 0..n {
                let sign = if row % 2 == column % 2 { 1.0 } else { -1.0 };
                let image = sign * compliance[(mirror(row), mirror(column))];
                // +0 and −0 are the same compliance.
                unlike += usize::from(compliance[(row, column)] != image);
                assert_eq!(compliance[(row, column)], compliance[(column, row)]);
            }
        }
        assert_eq!(unlike == 0, symmetric, "{unlike}");
    }
}

// Verifies: FEM-017.
#[test]
fn a_matrix_that_is_not_positive_definite_is_an_error() {
    for spoil in [|x: f64| -x, |_: f64| f64::NAN] {
        let mut matrix = assembled(&small(0.0));
        let diagonal = matrix.upper.val_of_col_mut(200).last_mut().unwrap();
        *diagonal = spoil(*diagonal);
        let error = Factor::new(&matrix).unwrap_err();
        let said = error.to_string();
        assert!(said.contains("is not positive definite"), "{said}");
    }
}

// Verifies: FEM-008.
#[test]
fn a_residual_above_the_limit_is_an_error() {
    assert_eq!(check_residual(1e-8), Ok(()));
    for residual in [1.1e-8, f64::INFINITY, f64::NAN] {
        let holds = matches!(check_residual(residual), Err(FemError::Residual { .. }));
        assert!(holds, "{residual}");
    }
}

// Verifies: FEM-008.
#[test]
fn the_residual_told_is_the_one_left() {
    let phantom = off_centre(2.6, 2.0);
    let mesh = Mesh::new(&phantom, 1e-3).unwrap();
    let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
    let factor = Factor::new(&matrix).unwrap();
    let first = matrix.first_surface_unknown;
    let load = |k: usize| if k < first { 0.0 } else { (k % 7) as f64 - 3.0 };
    let force: Vec<f64> = (0..matrix.unknowns()).map(load).collect();
    let (u, refined) = factor.solve(&matrix, &force).unwrap();
    let mut rest = force.clone();
    for column in 0..matrix.unknowns() {
        let rows = matrix.upper.row_idx_of_col(column);
        for (row, value) in rows.zip(matrix.upper.val_of_col(column)) {
            rest[row] -= value * u[column];
            if row != column {
                rest[column] -= value * u[row];
            }
        }
    }
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let left = norm(&rest) / norm(&force);
    // Both are the rounding of the product itself.
    assert_near(left / refined, 1.0, 0.5);
    // A factor of another matrix leaves what no refinement mends.
    let harder = phantom.changed(|parts| parts.layers[1].material.youngs_modulus *= 1.5);
    let other = StiffnessMatrix::assemble(&mesh, &harder.unwrap());
    let error = factor.solve(&other.unwrap(), &force).unwrap_err();
    assert!(matches!(error, FemError::Residual { residual } if residual > 1e-8));
}
