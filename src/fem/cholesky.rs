//! Multifrontal Cholesky factor of the stiffness matrix, its condensation to the surface, and solves
//! whose residual is checked.
//!
//! The mesh is mirror-symmetric, so that every field is the sum of a symmetric and an antisymmetric one, each
//! given by its right half: with u_x = 0 on the axis for the one, u_y = 0 for the other. Right of the axis
//! both have the same matrix, which is factorised once; axis and surface are left to two dense
//! roots of half the size.

use super::FemError;
use super::assembly::{Numbering, StiffnessMatrix};
use super::dense::SquareMatrix;
use super::elimination::{Eliminated, eliminate_right_half};
use super::front::{Front, Strip, inverse, padded, substitute_back, substitute_forward};

/// The largest relative residual ‖f − K u‖ / ‖f‖ that a solve may leave.
pub const RESIDUAL_LIMIT: f64 = 1e-8;

/// Symmetric fields move up and down on the axis, antisymmetric ones from side to side.
const AXIS_DIRECTION: [usize; 2] = [1, 0];

/// The sign of a displacement component in the mirror image.
const MIRROR: [f64; 2] = [-1.0, 1.0];

/// K = L Lᵀ, in the symmetric and the antisymmetric half.
///
/// ```
#[doc = include_str!("coarse.example")]
/// use palpate::fem::cholesky::Factor;
///
/// let factor = Factor::new(model.matrix())?;
/// let (stiffness, compliance) = (factor.surface_stiffness(), factor.surface_compliance());
/// // Stiffness times compliance is the unit matrix.
/// let product = |row, column| -> f64 {
///     (0..stiffness.order()).map(|k| stiffness[(row, k)] * compliance[(k, column)]).sum()
/// };
/// assert!((product(7, 7) - 1.0).abs() < 1e-9 && product(7, 8).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Factor {
    numbering: Numbering,
    pieces: Vec<Eliminated>,
    values: Vec<Strip>,
    roots: [Root; 2],
}

/// Axis and surface of one kind of field.
#[derive(Debug, Clone)]
struct Root {
    /// The axis' unknowns, one each.
    axis: usize,
    /// The surface's unknowns: one on the axis, two at each node right of it.
    surface: usize,
    panels: Vec<Strip>,
    stiffness: Vec<Strip>,
    compliance: Vec<Strip>,
}

impl Factor {
    /// Factorises the stiffness matrix of a mirror-symmetric mesh.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// use palpate::fem::{FemError, cholesky::Factor};
    ///
    /// let mut matrix = model.matrix().clone();
    /// matrix.values.iter_mut().for_each(|value| *value = -*value);
    /// assert!(matches!(Factor::new(&matrix), Err(FemError::NotPositiveDefinite)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-006, FEM-023.
    ///
    /// # Errors
    /// [`FemError::NotPositiveDefinite`].
    pub fn new(matrix: &StiffnessMatrix) -> Result<Factor, FemError> {
        let numbering = matrix.numbering.clone();
        let (pieces, values, whole) = eliminate_right_half(matrix)?;
        let roots = [0, 1].map(|parity| Root::new(&whole, &numbering, AXIS_DIRECTION[parity]));
        let [symmetric, antisymmetric] = roots;
        Ok(Factor {
            numbering,
            pieces,
            values,
            roots: [symmetric?, antisymmetric?],
        })
    }

    /// The surface stiffness S: the stiffness matrix with the interior condensed out. Square, over the
    /// surface unknowns.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let stiffness = model.factor().surface_stiffness();
    /// // Each node of the surface resists in both directions.
    /// assert_eq!(stiffness.order(), 2 * model.mesh().surface().len());
    /// assert!((0..stiffness.order()).all(|k| stiffness[(k, k)] > 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-007.
    pub fn surface_stiffness(&self) -> SquareMatrix {
        // A symmetric field bends both halves: on the axis it meets the stiffness of both.
        self.both_halves(|root| &root.stiffness, 2.0)
    }

    /// S⁻¹, m/N; symmetric, and mirror-symmetric to the bit.
    ///
    /// ```
    #[doc = include_str!("coarse.example")]
    /// let compliance = model.factor().surface_compliance();
    /// assert!((0..compliance.order()).all(|k| compliance[(k, 5)] == compliance[(5, k)]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Implements: FEM-007.
    pub fn surface_compliance(&self) -> SquareMatrix {
        self.both_halves(|root| &root.compliance, 1.0)
    }

    /// The matrix over the whole surface from those of symmetric and antisymmetric fields, A and B: (A + B)/2 on
    /// one side, (A − B)/2 across, turned for the left, and where the axis stands times `on_axis`.
    fn both_halves(&self, of: impl Fn(&Root) -> &Vec<Strip>, on_axis: f64) -> SquareMatrix {
        let size = self.roots[0].surface;
        let parts = self.roots.each_ref().map(|root| (of(root), padded(size)));
        let entry = |parity: usize, a: usize, b: usize| {
            let (row, column) = (a.max(b), a.min(b));
            let (strips, width) = parts[parity];
            strips[row / 4 * width + column][row % 4]
        };
        // The unknown of a node `away` nodes from the axis, or `None` where the field leaves it at rest.
        let unknown = |parity: usize, away: usize, direction: usize| match away {
            0 => (direction == AXIS_DIRECTION[parity]).then_some(0),
            _ => Some(2 * away - 1 + direction),
        };
        let weight = |away: usize| if away == 0 { on_axis } else { 1.0 };
        let middle = size / 2;
        let block = |k: usize, i: usize, l: usize, j: usize| {
            let (a, b) = (k.abs_diff(middle), l.abs_diff(middle));
            let part = |parity| match (unknown(parity, a, i), unknown(parity, b, j)) {
                (Some(row), Some(column)) => entry(parity, row, column),
                _ => 0.0,
            };
            let sign = if (k < middle) == (l < middle) {
                1.0
            } else {
                -1.0
            };
            let turned = |node: usize, direction: usize| {
                if node < middle {
                    MIRROR[direction]
                } else {
                    1.0
                }
            };
            let sum = part(0) + sign * part(1);
            0.5 * weight(a) * weight(b) * turned(k, i) * turned(l, j) * sum
        };
        SquareMatrix::from_fn(2 * size, |row, column| {
            block(row / 2, row % 2, column / 2, column % 2)
        })
    }

    /// Solves K u = f with one step of iterative refinement; returns u and the relative residual.
    ///
    /// Implements: FEM-008.
    ///
    /// # Errors
    /// [`FemError::Residual`] above [`RESIDUAL_LIMIT`].
    pub(super) fn solve(
        &self,
        matrix: &StiffnessMatrix,
        force: &[f64],
    ) -> Result<(Vec<f64>, f64), FemError> {
        let mut u = self.solve_once(force);
        let correction = self.solve_once(&residual(matrix, &u, force));
        for (u, correction) in u.iter_mut().zip(&correction) {
            *u += correction;
        }
        let left = relative(&residual(matrix, &u, force), force);
        check_residual(left)?;
        Ok((u, left))
    }

    fn solve_once(&self, force: &[f64]) -> Vec<f64> {
        let single: Vec<[f64; 1]> = force.iter().map(|&f| [f]).collect();
        let mut halves = self.halves(&single, 0);
        let on_axis =
            2 * self.numbering.right..2 * (self.numbering.right + self.numbering.axis + 1);
        for (parity, (half, root)) in halves.iter_mut().zip(&self.roots).enumerate() {
            // Either half carries its own share of a load on the axis.
            for [load] in &mut half[on_axis.clone()] {
                *load *= 0.5;
            }
            self.forward(half);
            root.solve(&mut half[on_axis.start..], parity);
            self.back(half);
        }
        let mut u = vec![[0.0]; force.len()];
        self.join(&halves, &mut u, 0);
        u.into_iter().map(|[u]| u).collect()
    }

    /// Given the surface displacements in the last rows of `u`, fills in the interior's, which carry no
    /// load: L_iiᵀ u_i = −L_siᵀ u_s. `W` displacement fields at once, one row of `W` numbers per unknown.
    ///
    /// Implements: FEM-007.
    pub(super) fn extend_to_interior<const W: usize>(&self, u: &mut [[f64; W]]) {
        let below = self.numbering.right + self.numbering.axis;
        let mut halves = self.halves(u, below);
        for parity in 0..2 {
            let half = &mut halves[parity];
            self.roots[parity].extend(&mut half[2 * self.numbering.right..], parity);
            self.back(half);
        }
        self.join(&halves, u, self.numbering.half_nodes() - below);
    }

    /// The symmetric and the antisymmetric part of `u` on the right half, from node `from` of the half on.
    fn halves<const W: usize>(&self, u: &[[f64; W]], from: usize) -> [Vec<[f64; W]>; 2] {
        let nodes = self.numbering.half_nodes();
        let mut halves = [(); 2].map(|()| vec![[0.0; W]; 2 * nodes]);
        for half in from..nodes {
            let [right, left] = self.numbering.pair(half);
            for direction in 0..2 {
                let (right, left) = (&u[2 * right + direction], &u[2 * left + direction]);
                for w in 0..W {
                    let image = MIRROR[direction] * left[w];
                    halves[0][2 * half + direction][w] = 0.5 * (right[w] + image);
                    halves[1][2 * half + direction][w] = 0.5 * (right[w] - image);
                }
            }
        }
        halves
    }

    /// Puts the parts together again, but for the last `but` nodes of the half.
    fn join<const W: usize>(&self, halves: &[Vec<[f64; W]>; 2], u: &mut [[f64; W]], but: usize) {
        for half in 0..self.numbering.half_nodes() - but {
            let [right, left] = self.numbering.pair(half);
            for direction in 0..2 {
                let [symmetric, antisymmetric] =
                    [0, 1].map(|parity| halves[parity][2 * half + direction]);
                for w in 0..W {
                    u[2 * left + direction][w] =
                        MIRROR[direction] * (symmetric[w] - antisymmetric[w]);
                    u[2 * right + direction][w] = symmetric[w] + antisymmetric[w];
                }
            }
        }
    }

    /// Takes what the pieces' loads leave from those of axis and surface.
    fn forward<const W: usize>(&self, half: &mut [[f64; W]]) {
        let mut local = Vec::new();
        for piece in &self.pieces {
            piece.gather(half, &mut local);
            substitute_forward(&self.values[piece.start..], piece.own(), &mut local);
            half[2 * piece.first..][..2 * piece.nodes].copy_from_slice(&local[..2 * piece.nodes]);
            for (&node, rows) in piece
                .border
                .iter()
                .zip(local[piece.own()..].chunks_exact(2))
            {
                half[2 * node as usize..][..2].copy_from_slice(rows);
            }
        }
    }

    /// From the surface and the axis down through the pieces.
    fn back<const W: usize>(&self, half: &mut [[f64; W]]) {
        let mut local = Vec::new();
        for piece in self.pieces.iter().rev() {
            piece.gather(half, &mut local);
            substitute_back(
                &self.values[piece.start..piece.end()],
                piece.own(),
                &mut local,
            );
            half[2 * piece.first..][..2 * piece.nodes].copy_from_slice(&local[..2 * piece.nodes]);
        }
    }
}

impl Root {
    /// From axis and surface with both components, of which only `direction` moves on the axis.
    fn new(whole: &Front, numbering: &Numbering, direction: usize) -> Result<Root, FemError> {
        let axis = numbering.axis;
        let surface_nodes = numbering.half_nodes() - numbering.right - axis;
        let surface = 2 * surface_nodes - 1;
        let moving: Vec<usize> = (0..=axis)
            .map(|node| 2 * node + direction)
            .chain(2 * (axis + 1)..2 * (axis + surface_nodes))
            .collect();
        let mut front = Front::new(axis, surface);
        let place = |k: usize| if k < axis { k } else { front.own + (k - axis) };
        let places: Vec<usize> = (0..moving.len()).map(place).collect();
        for (k, &row) in moving.iter().enumerate() {
            for (l, &column) in moving[..=k].iter().enumerate() {
                *front.entry(places[k], places[l]) =
                    whole.update[row / 4 * whole.border + column][row % 4];
            }
        }
        front.pad_diagonal(axis);
        front.eliminate(|_| 0)?;
        let width = front.border;
        let compliance = inverse(surface, |row, column| {
            front.update[row / 4 * width + column][row % 4]
        })?;
        Ok(Root {
            axis,
            surface,
            panels: front.panels,
            stiffness: front.update,
            compliance,
        })
    }

    /// The moving unknowns of a field on axis and surface (both components), axis first.
    fn gather<const W: usize>(&self, field: &[[f64; W]], parity: usize) -> Vec<[f64; W]> {
        let mut local = Vec::with_capacity(padded(self.axis) + padded(self.surface));
        let axis = field[..2 * self.axis].iter().skip(AXIS_DIRECTION[parity]);
        local.extend(axis.step_by(2));
        local.resize(padded(self.axis), [0.0; W]);
        local.push(field[2 * self.axis + AXIS_DIRECTION[parity]]);
        local.extend_from_slice(&field[2 * self.axis + 2..]);
        local.resize(padded(self.axis) + padded(self.surface), [0.0; W]);
        local
    }

    /// Fills in the axis' displacements, which carry no load, from the surface's.
    fn extend<const W: usize>(&self, field: &mut [[f64; W]], parity: usize) {
        let mut local = self.gather(field, parity);
        substitute_back(&self.panels, padded(self.axis), &mut local);
        for (k, row) in local[..self.axis].iter().enumerate() {
            field[2 * k + AXIS_DIRECTION[parity]] = *row;
        }
    }

    /// Solves for axis and surface.
    fn solve<const W: usize>(&self, field: &mut [[f64; W]], parity: usize) {
        let mut local = self.gather(field, parity);
        let own = padded(self.axis);
        substitute_forward(&self.panels, own, &mut local);
        let loads = local[own..].to_vec();
        let width = padded(self.surface);
        for row in 0..self.surface {
            let mut sum = [0.0; W];
            for (column, load) in loads[..self.surface].iter().enumerate() {
                let (low, high) = (row.min(column), row.max(column));
                let entry = self.compliance[high / 4 * width + low][high % 4];
                for w in 0..W {
                    sum[w] += entry * load[w];
                }
            }
            local[own + row] = sum;
        }
        substitute_back(&self.panels, own, &mut local);
        field.fill([0.0; W]);
        for (k, row) in local[..self.axis].iter().enumerate() {
            field[2 * k + AXIS_DIRECTION[parity]] = *row;
        }
        field[2 * self.axis + AXIS_DIRECTION[parity]] = local[own];
        field[2 * self.axis + 2..].copy_from_slice(&local[own + 1..own + self.surface]);
    }
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
pub(super) fn check_residual(residual: f64) -> Result<(), FemError> {
    if residual <= RESIDUAL_LIMIT {
        Ok(())
    } else {
        Err(FemError::Residual { residual })
    }
}
