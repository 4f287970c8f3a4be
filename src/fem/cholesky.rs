//! Sparse Cholesky factor of the stiffness matrix by faer, its condensation to the surface, and solves
//! whose residual is checked.
//!
//! The simplicial algorithm is used throughout: its bits do not depend on threads or on the width of
//! the processor's vector registers (requirement CON-006).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::simplicial::{
    SimplicialLltRef, SymbolicSimplicialCholesky, factorize_simplicial_numeric_llt,
    factorize_simplicial_numeric_llt_scratch, factorize_simplicial_symbolic_cholesky,
    factorize_simplicial_symbolic_cholesky_scratch, prefactorize_symbolic_cholesky,
    prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use nalgebra::DMatrix;

use super::FemError;
use super::assembly::StiffnessMatrix;

/// The largest relative residual ‖f − K u‖ / ‖f‖ that a solve may leave.
pub const RESIDUAL_LIMIT: f64 = 1e-8;

/// K = L Lᵀ.
#[derive(Debug, Clone)]
pub struct Factor {
    symbolic: SymbolicSimplicialCholesky<u32>,
    values: Vec<f64>,
    first_surface_unknown: usize,
}

fn scratch(request: faer::dyn_stack::StackReq) -> Result<MemBuffer, FemError> {
    MemBuffer::try_new(request).map_err(|_| FemError::OutOfMemory)
}

impl Factor {
    /// Factorises the stiffness matrix.
    ///
    /// Implements: FEM-006.
    ///
    /// # Errors
    /// [`FemError::NotPositiveDefinite`] with the unknown at which the factorisation stopped.
    pub fn new(matrix: &StiffnessMatrix) -> Result<Factor, FemError> {
        let n = matrix.numbering.unknowns();
        let pattern = SymbolicSparseColMatRef::new_checked(
            n,
            n,
            &matrix.column_starts,
            None,
            &matrix.row_indices,
        );
        let symbolic = analyse(pattern)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let mut memory = scratch(factorize_simplicial_numeric_llt_scratch::<u32, f64>(n))?;
        factorize_simplicial_numeric_llt(
            &mut values,
            SparseColMatRef::new(pattern, &matrix.values),
            Default::default(),
            &symbolic,
            MemStack::new(&mut memory),
        )
        .map_err(|_| FemError::NotPositiveDefinite)?;
        Ok(Factor {
            symbolic,
            values,
            first_surface_unknown: matrix.numbering.first_surface_unknown(),
        })
    }

    /// Number of entries in L.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Rows and values of column `j` of L, the diagonal first.
    fn column(&self, j: usize) -> (&[u32], &[f64]) {
        let starts = self.symbolic.col_ptr();
        let range = starts[j] as usize..starts[j + 1] as usize;
        (&self.symbolic.row_idx()[range.clone()], &self.values[range])
    }

    /// The factor of the surface stiffness S = L_ss L_ssᵀ, with the interior condensed out: since the
    /// surface unknowns come last, it is the lower right corner of L. Square, over the surface unknowns.
    ///
    /// Implements: FEM-007.
    pub fn surface_factor(&self) -> DMatrix<f64> {
        let first = self.first_surface_unknown;
        let n = self.symbolic.ncols() - first;
        let mut corner = DMatrix::zeros(n, n);
        for j in 0..n {
            let (rows, values) = self.column(first + j);
            for (&i, &value) in rows.iter().zip(values) {
                corner[(i as usize - first, j)] = value;
            }
        }
        corner
    }

    /// Solves K u = f with one step of iterative refinement; returns u and the relative residual.
    ///
    /// Implements: FEM-008.
    ///
    /// # Errors
    /// [`FemError::Residual`] above [`RESIDUAL_LIMIT`].
    pub fn solve(
        &self,
        matrix: &StiffnessMatrix,
        force: &[f64],
    ) -> Result<(Vec<f64>, f64), FemError> {
        let mut u = force.to_vec();
        self.solve_in_place(&mut u);
        let mut correction = residual(matrix, &u, force);
        self.solve_in_place(&mut correction);
        for (u, correction) in u.iter_mut().zip(&correction) {
            *u += correction;
        }
        let left = relative(&residual(matrix, &u, force), force);
        check_residual(left)?;
        Ok((u, left))
    }

    fn solve_in_place(&self, rhs: &mut [f64]) {
        let n = rhs.len();
        SimplicialLltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, 1),
            Par::Seq,
            MemStack::new(&mut []),
        );
    }

    /// Given the surface displacements in the last rows of `u`, fills in the interior's, which carry no
    /// load: L_iiᵀ u_i = −L_siᵀ u_s. `W` displacement fields at once, one row of `W` numbers per unknown.
    ///
    /// Implements: FEM-007.
    pub fn extend_to_interior<const W: usize>(&self, u: &mut [[f64; W]]) {
        for j in (0..self.first_surface_unknown).rev() {
            let (rows, values) = self.column(j);
            let mut sum = [0.0; W];
            for (&i, &value) in rows[1..].iter().zip(&values[1..]) {
                let u = &u[i as usize];
                for w in 0..W {
                    sum[w] += value * u[w];
                }
            }
            u[j] = sum.map(|sum| -sum / values[0]);
        }
    }
}

fn analyse(
    pattern: SymbolicSparseColMatRef<'_, u32>,
) -> Result<SymbolicSimplicialCholesky<u32>, FemError> {
    let n = pattern.ncols();
    let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
    let mut memory = scratch(prefactorize_symbolic_cholesky_scratch::<u32>(
        n,
        pattern.compute_nnz(),
    ))?;
    let tree =
        prefactorize_symbolic_cholesky(&mut tree, &mut counts, pattern, MemStack::new(&mut memory));
    let mut memory = scratch(factorize_simplicial_symbolic_cholesky_scratch::<u32>(n))?;
    factorize_simplicial_symbolic_cholesky(pattern, tree, &counts, MemStack::new(&mut memory))
        .map_err(|_| FemError::OutOfMemory)
}

/// f − K u.
fn residual(matrix: &StiffnessMatrix, u: &[f64], force: &[f64]) -> Vec<f64> {
    let single = |x: &[f64]| x.iter().map(|&x| [x]).collect::<Vec<_>>();
    let mut out = single(force);
    matrix.subtract_product(&single(u), &mut out);
    out.into_iter().map(|[x]| x).collect()
}

fn relative(residual: &[f64], force: &[f64]) -> f64 {
    let norm = |v: &[f64]| libm::sqrt(v.iter().map(|x| x * x).sum());
    let (residual, force) = (norm(residual), norm(force));
    if force == 0.0 {
        residual
    } else {
        residual / force
    }
}

/// Refuses a residual above the limit, or one that is not a number.
pub fn check_residual(residual: f64) -> Result<(), FemError> {
    if residual <= RESIDUAL_LIMIT {
        Ok(())
    } else {
        Err(FemError::Residual { residual })
    }
}
