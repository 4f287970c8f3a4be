//! Sparse Cholesky factor of the stiffness matrix by faer, its condensation to the surface, and solves whose
//! residual is checked.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::inverse::{inverse, inverse_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::reborrow::ReborrowMut;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLltRef, SupernodeRef, SymbolicSupernodalCholesky,
};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par, Side};

use super::FemError;
use super::assembly::StiffnessMatrix;
use crate::refusal::Refusal;

/// The largest relative residual ‖f − K u‖ / ‖f‖ that a solve may leave.
pub const RESIDUAL_LIMIT: f64 = 1e-8;

/// K = L Lᵀ, the unknowns at the surface last.
///
/// Implements: FEM-006.
#[derive(Debug, Clone)]
pub struct Factor {
    pub(super) symbolic: Arc<SymbolicCholesky<u32>>,
    values: Vec<f64>,
    /// The corner of L over the surface unknowns.
    pub(super) surface: Mat<f64>,
}

pub(super) fn scratch(request: faer::dyn_stack::StackReq) -> Result<MemBuffer, FemError> {
    MemBuffer::try_new(request).map_err(|_| FemError::OutOfMemory)
}

/// The pattern of the factor, by supernodes, of a matrix with this upper triangle, whose unknowns stand in the order of elimination.
pub(super) fn eliminated(
    upper: SymbolicSparseColMatRef<'_, u32>,
) -> Result<SymbolicCholesky<u32>, FemError> {
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    // Without a permutation faer reads the upper triangle.
    let identity = SymmetricOrdering::Identity;
    let symbolic = factorize_symbolic_cholesky(upper, Side::Upper, identity, params);
    symbolic.map_err(|_| FemError::OutOfMemory)
}

/// The corner of a factor from unknown `first` on, with what stands on its diagonal.
pub(super) fn corner<'a>(
    symbolic: &SymbolicSupernodalCholesky<u32>,
    supernode: impl Fn(usize) -> SupernodeRef<'a, u32, f64>,
    first: usize,
) -> Mat<f64> {
    let size = symbolic.nrows() - first;
    let mut corner = Mat::zeros(size, size);
    for s in 0..symbolic.n_supernodes() {
        let supernode = supernode(s);
        let (start, columns) = (supernode.start(), supernode.val());
        if start + columns.ncols() <= first {
            continue;
        }
        let diagonal = (start..start + columns.ncols())
            .chain(supernode.pattern().iter().map(|&row| row as usize));
        for (i, row) in diagonal.enumerate() {
            for j in first.max(start)..(row + 1).min(start + columns.ncols()) {
                corner[(row - first, j - first)] = columns[(i, j - start)];
            }
        }
    }
    corner
}

impl Factor {
    /// Factorises the stiffness matrix.
    ///
    /// Implements: FEM-006, FEM-017.
    ///
    /// # Errors
    /// [`FemError::Refused`] if it is not positive definite in double precision, [`FemError::OutOfMemory`].
    pub fn new(matrix: &StiffnessMatrix) -> Result<Factor, FemError> {
        Factor::of(Arc::new(eliminated(matrix.upper.symbolic())?), matrix)
    }

    /// The factor of a matrix whose factor has this pattern.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub(super) fn of(
        symbolic: Arc<SymbolicCholesky<u32>>,
        matrix: &StiffnessMatrix,
    ) -> Result<Factor, FemError> {
        let mut values = vec![0.0; symbolic.len_val()];
        let mut memory =
            scratch(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()))?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix.upper.as_ref(),
                Side::Upper,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| {
                let found = "the stiffness matrix is not positive definite in double precision: moduli or sizes differ by too many orders of magnitude";
                Refusal::state(found, "")
            })?;
        let mut factor = Factor {
            symbolic,
            values,
            surface: Mat::new(),
        };
        let first = matrix.first_surface_unknown;
        factor.surface = corner(
            factor.factor().symbolic(),
            |s| factor.factor().supernode(s),
            first,
        );
        Ok(factor)
    }

    fn factor(&self) -> SupernodalLltRef<'_, u32, f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => SupernodalLltRef::new(raw, &self.values),
            SymbolicCholeskyRaw::Simplicial(_) => unreachable!("supernodes were asked for"),
        }
    }

    /// The surface compliance S⁻¹, m/N, with S = L_ss L_ssᵀ the stiffness with the interior condensed out, over both displacement components of each node at the surface from left to
    /// right: 0 for those that a wall holds. Symmetric to the bit.
    ///
    /// # Errors
    /// [`FemError::OutOfMemory`].
    ///
    /// Implements: FEM-007.
    pub fn surface_compliance(&self, matrix: &StiffnessMatrix) -> Result<Mat<f64>, FemError> {
        let (first, free) = (matrix.first_surface_unknown, self.surface.nrows());
        let mut lower = Mat::zeros(free, free);
        let mut memory = scratch(inverse_scratch::<f64>(free, Par::Seq))?;
        inverse(
            lower.as_mut(),
            self.surface.as_ref(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        let size = matrix.surface.len();
        let mut compliance = Mat::zeros(size, size);
        for (place, unknown) in matrix.surface.iter().enumerate() {
            let Some(column) = unknown else { continue };
            let column = lower.col_as_slice(column - first);
            let to = compliance.col_as_slice_mut(place)[place..].iter_mut();
            for (to, unknown) in to.zip(&matrix.surface[place..]) {
                *to = unknown.map_or(0.0, |row| column[row - first]);
            }
        }
        reflect(&mut compliance);
        Ok(compliance)
    }

    /// Solves K u = f with one step of iterative refinement; returns u and the relative residual.
    ///
    /// Implements: FEM-008.
    ///
    /// # Errors
    /// [`FemError::Residual`] above [`RESIDUAL_LIMIT`], [`FemError::OutOfMemory`].
    pub(super) fn solve(
        &self,
        matrix: &StiffnessMatrix,
        force: &[f64],
    ) -> Result<(Vec<f64>, f64), FemError> {
        let force = force.as_chunks::<1>().0.as_chunks::<1>().0;
        let (mut u, mut correction, mut rest) = (force.to_vec(), force.to_vec(), force.to_vec());
        self.solve_once(u.as_flattened_mut().as_flattened_mut())?;
        matrix.residual(&u, &mut correction, 0);
        self.solve_once(correction.as_flattened_mut().as_flattened_mut())?;
        for ([[u]], [[correction]]) in u.iter_mut().zip(&correction) {
            *u += correction;
        }
        let [[left]] = matrix.residual(&u, &mut rest, 0);
        check_residual(left)?;
        Ok((u.into_flattened().into_flattened(), left))
    }

    fn solve_once(&self, rhs: &mut [f64]) -> Result<(), FemError> {
        let factor = self.factor();
        let mut memory = scratch(factor.symbolic().solve_in_place_scratch::<f64>(1, Par::Seq))?;
        let n = rhs.len();
        factor.solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }

    /// Given the surface displacements in the last rows of `u`, fills in the interior's, which carry no
    /// load: Lᵀ u = (0, L_ssᵀ u_s). `B` × `L` displacement fields at once, one row for each unknown.
    ///
    /// Implements: FEM-007.
    pub(super) fn extend_to_interior<const L: usize, const B: usize>(
        &self,
        u: &mut [[[f64; L]; B]],
    ) -> Result<(), FemError> {
        let (n, fields) = (u.len(), B * L);
        let first = n - self.surface.nrows();
        u[..first].fill([[0.0; L]; B]);
        let at_surface = u[first..].to_vec();
        let at_surface = at_surface.as_flattened().as_flattened();
        let at_surface = MatRef::from_row_major_slice(at_surface, n - first, fields);
        let u = u.as_flattened_mut().as_flattened_mut();
        let mut u = MatMut::from_row_major_slice_mut(u, n, fields);
        matmul(
            u.rb_mut().split_at_row_mut(first).1,
            BlockStructure::Rectangular,
            Accum::Replace,
            self.surface.transpose(),
            BlockStructure::TriangularUpper,
            at_surface,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        let factor = self.factor();
        let mut memory = scratch(
            factor
                .symbolic()
                .solve_in_place_scratch::<f64>(fields, Par::Seq),
        )?;
        factor.l_transpose_solve_with_conj(Conj::No, u, Par::Seq, MemStack::new(&mut memory));
        Ok(())
    }
}

/// Makes a square matrix symmetric: what stands below its diagonal, above it too.
pub(super) fn reflect(matrix: &mut Mat<f64>) {
    /// Columns that are read at once, so that what is written lies together.
    const TILE: usize = 8;
    for first in (0..matrix.ncols()).step_by(TILE) {
        for row in first + 1..matrix.nrows() {
            for column in first..row.min(first + TILE) {
                matrix[(column, row)] = matrix[(row, column)];
            }
        }
    }
}

/// Refuses a residual above the limit, or one that is not a number.
pub(super) fn check_residual(residual: f64) -> Result<(), FemError> {
    if residual <= RESIDUAL_LIMIT {
        Ok(())
    } else {
        Err(FemError::Residual { residual })
    }
}
