//! Boundary-value problems of plane strain with known solutions, on meshes made for them. Element stiffness,
//! gradients and stress are the library's; loads, solver and error norms are the checks' own.

use faer::Col;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use palpate::fem::element::{NODES, PerNode, StiffnessRule, gradients, parent_gradients, stress};
use palpate::phantom::{Geometry, Material};

use super::Measured;

/// The displacement u at a place and its gradient, `gradient[i][j]` = ∂u_i/∂x_j.
pub type Field = ([f64; 2], [[f64; 2]; 2]);

/// A solution that is known everywhere.
pub trait Exact {
    fn field(&self, at: [f64; 2]) -> Field;

    fn displacement(&self, at: [f64; 2]) -> [f64; 2] {
        self.field(at).0
    }
}

/// A mesh of triangles with a material for each element.
pub struct Problem {
    pub nodes: Vec<[f64; 2]>,
    pub elements: Vec<[usize; NODES]>,
    pub materials: Vec<Material>,
}

/// Relative errors ‖u_h − u‖/‖u‖, ‖∇u_h − ∇u‖/‖∇u‖ and ‖σ_h − σ‖/‖σ‖ in L2.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    pub displacement: f64,
    pub gradient: f64,
    pub stress: f64,
}

/// Points and weights of Gauss and Legendre on (0, 1), exact to degree 9.
pub const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// A rule of 25 points, far finer than that of the stiffness, on the parent element: the square folded onto the triangle.
fn fine_rule() -> impl Iterator<Item = ([f64; 2], f64)> {
    let pairs = GAUSS.iter().flat_map(|a| GAUSS.iter().map(move |b| (a, b)));
    pairs.map(|(&(a, wa), &(b, wb))| ([a, b * (1.0 - a)], wa * wb * (1.0 - a)))
}

/// Shape functions at a point of the parent element.
fn shape([r, s]: [f64; 2]) -> [f64; NODES] {
    let q = 1.0 - r - s;
    let corner = |a: f64| a * (2.0 * a - 1.0);
    [
        corner(q),
        corner(r),
        corner(s),
        4.0 * q * r,
        4.0 * r * s,
        4.0 * s * q,
    ]
}

/// A material of a Young's modulus, Pa, and Poisson's ratio.
pub const fn material(youngs_modulus: f64, poisson_ratio: f64) -> Material {
    Material::isotropic(youngs_modulus, poisson_ratio)
}

/// Lamé's constants (λ, μ), Pa: the checks' own, as Hooke's law below is.
pub fn lame(material: &Material) -> (f64, f64) {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let mu = e / (2.0 + 2.0 * nu);
    (2.0 * mu * nu / (1.0 - 2.0 * nu), mu)
}

/// σ_xx, σ_yy, σ_zz, σ_xy in plane strain.
fn hooke(material: &Material, g: [[f64; 2]; 2]) -> [f64; 4] {
    let (lambda, mu) = lame(material);
    let all = lambda * (g[0][0] + g[1][1]);
    [
        all + 2.0 * mu * g[0][0],
        all + 2.0 * mu * g[1][1],
        all,
        mu * (g[0][1] + g[1][0]),
    ]
}

impl Problem {
    /// A lattice of `cells` (columns, rows) over the unit square, every node of which `map` puts in its place. Cells
    /// are cut along the rising diagonal where `rising` says so for their centre.
    pub fn lattice(
        cells: [usize; 2],
        map: impl Fn([f64; 2]) -> [f64; 2],
        rising: impl Fn([f64; 2]) -> bool,
        material: impl Fn([f64; 2]) -> Material,
    ) -> Problem {
        let points = cells.map(|n| 2 * n + 1);
        let at =
            |i: usize, j: usize| [(i, 0), (j, 1)].map(|(k, d)| k as f64 / (points[d] - 1) as f64);
        let number = |i: usize, j: usize| i * points[1] + j;
        let mut nodes = vec![[0.0; 2]; points[0] * points[1]];
        for i in 0..points[0] {
            for j in 0..points[1] {
                nodes[number(i, j)] = map(at(i, j));
            }
        }
        let (mut elements, mut materials) = (Vec::new(), Vec::new());
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                let centre = [(i, 0), (j, 1)]
                    .map(|(k, d): (usize, usize)| (k as f64 + 0.5) / cells[d] as f64);
                let node = |[a, b]: [usize; 2]| number(2 * i + a, 2 * j + b);
                let corners = if rising(centre) {
                    [[[0, 0], [2, 0], [2, 2]], [[0, 0], [2, 2], [0, 2]]]
                } else {
                    [[[0, 0], [2, 0], [0, 2]], [[2, 0], [2, 2], [0, 2]]]
                };
                for corners in corners {
                    elements.push(triangle(corners).map(node));
                    materials.push(material(centre));
                }
            }
        }
        Problem {
            nodes,
            elements,
            materials,
        }
    }

    pub fn positions(&self, nodes: &[usize; NODES]) -> [[f64; 2]; NODES] {
        nodes.map(|node| self.nodes[node])
    }

    /// Displacements under `loads`, two numbers a node, where `held(node, direction)` gives the displacements that are
    /// prescribed; and the force K u at each node.
    ///
    /// # Errors
    /// An element turned inside out, or a singular matrix.
    pub fn solve(
        &self,
        mut loads: Vec<f64>,
        held: impl Fn(usize, usize) -> Option<f64>,
    ) -> Measured<(Vec<f64>, Vec<f64>)> {
        let held: Vec<Option<f64>> = (0..loads.len()).map(|k| held(k / 2, k % 2)).collect();
        let mut entries = Vec::new();
        self.visit(|row, column, value| match (held[row], held[column]) {
            (None, None) => entries.push(Triplet::new(row, column, value)),
            (None, Some(u)) => loads[row] -= value * u,
            _ => {}
        })?;
        for (k, u) in held.iter().enumerate() {
            if let Some(u) = u {
                entries.push(Triplet::new(k, k, 1.0));
                loads[k] = *u;
            }
        }
        let u = solved(&entries, &loads)?;
        let mut force = vec![0.0; u.len()];
        self.visit(|row, column, value| force[row] += value * u[column])?;
        Ok((u, force))
    }

    /// Hands every entry of every element's stiffness to `visit(row, column, value)`.
    ///
    /// # Errors
    /// An element turned inside out.
    pub fn visit(&self, mut visit: impl FnMut(usize, usize, f64)) -> Measured<()> {
        let rule = StiffnessRule::default();
        for (nodes, material) in self.elements.iter().zip(&self.materials) {
            let stiffness = rule
                .integrate(&self.positions(nodes), material, Geometry::Plane)
                .map_err(inside_out)?;
            for (a, na) in nodes.iter().enumerate() {
                for (b, nb) in nodes.iter().enumerate() {
                    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        visit(2 * na + i, 2 * nb + j, stiffness[(2 * a + i, 2 * b + j)]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Calls `visit(element, position, weight × Jacobian, shape functions, their gradients)` at the points of the fine rule.
    fn integrate(&self, mut visit: impl FnMut(usize, [f64; 2], f64, &[f64], &PerNode)) {
        let rule: Vec<_> = fine_rule()
            .map(|(at, weight)| (weight, shape(at), parent_gradients(at)))
            .collect();
        for (element, nodes) in self.elements.iter().enumerate() {
            let positions = self.positions(nodes);
            for (weight, shape, parent) in &rule {
                let g = gradients(parent, &positions);
                let mut at = [0.0; 2];
                for (n, position) in shape.iter().zip(&positions) {
                    at = [at[0] + n * position[0], at[1] + n * position[1]];
                }
                visit(element, at, weight * g.jacobian, shape, &g.of_node);
            }
        }
    }

    /// Nodal loads of a body force, N/m³.
    pub fn body_loads(&self, force: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
        let mut loads = vec![0.0; 2 * self.nodes.len()];
        self.integrate(|element, at, volume, shape, _| {
            let f = force(at);
            for (node, n) in self.elements[element].iter().zip(shape) {
                for i in 0..2 {
                    loads[2 * node + i] += volume * n * f[i];
                }
            }
        });
        loads
    }

    /// Adds the nodal loads of a traction t(x, n ds) to those element edges all of whose nodes are `on` the loaded line.
    /// n ds points out of the element.
    pub fn add_traction(
        &self,
        loads: &mut [f64],
        on: impl Fn([f64; 2]) -> bool,
        traction: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
    ) {
        let edges = |nodes: &[usize; NODES]| {
            [[0, 1, 3], [1, 2, 4], [2, 0, 5]].map(|edge| edge.map(|k: usize| nodes[k]))
        };
        for edge in self.elements.iter().flat_map(edges) {
            if !edge.iter().all(|&node| on(self.nodes[node])) {
                continue;
            }
            for (s, weight) in GAUSS {
                let shape = [
                    (1.0 - s) * (1.0 - 2.0 * s),
                    s * (2.0 * s - 1.0),
                    4.0 * s * (1.0 - s),
                ];
                let slope = [4.0 * s - 3.0, 4.0 * s - 1.0, 4.0 - 8.0 * s];
                let sum = |of: [f64; 3]| {
                    let part = |i: usize| {
                        of.iter()
                            .zip(&edge)
                            .map(move |(n, &k)| n * self.nodes[k][i])
                    };
                    [part(0).sum::<f64>(), part(1).sum::<f64>()]
                };
                let (at, [dx, dy]) = (sum(shape), sum(slope));
                let t = traction(at, [dy * weight, -dx * weight]);
                for (n, node) in shape.iter().zip(&edge) {
                    for i in 0..2 {
                        loads[2 * node + i] += n * t[i];
                    }
                }
            }
        }
    }

    /// Errors of the nodal displacements `u`.
    pub fn errors(&self, u: &[f64], exact: &impl Exact) -> Errors {
        self.errors_in(u, exact, |_| true)
    }

    /// Errors in the elements of the materials that `keep` picks.
    pub fn errors_in(
        &self,
        u: &[f64],
        exact: &impl Exact,
        keep: impl Fn(&Material) -> bool,
    ) -> Errors {
        let mut sums = [[0.0; 2]; 3];
        self.integrate(|element, at, volume, shape, of_node| {
            if !keep(&self.materials[element]) {
                return;
            }
            let (mut value, mut gradient) = ([0.0; 2], [[0.0; 2]; 2]);
            let columns = of_node.column_iter();
            for ((&node, n), g) in self.elements[element].iter().zip(shape).zip(columns) {
                for i in 0..2 {
                    value[i] += n * u[2 * node + i];
                    for j in 0..2 {
                        gradient[i][j] += g[j] * u[2 * node + i];
                    }
                }
            }
            let (displacement, truth) = exact.field(at);
            let material = &self.materials[element];
            // σ_xy stands for σ_yx as well; it is only a norm.
            for (sum, found, expected) in [
                (0, value.to_vec(), displacement.to_vec()),
                (1, gradient.concat(), truth.concat()),
                (
                    2,
                    stress(material, gradient).to_vec(),
                    hooke(material, truth).to_vec(),
                ),
            ] {
                for (found, expected) in found.iter().zip(expected) {
                    sums[sum][0] += volume * (found - expected) * (found - expected);
                    sums[sum][1] += volume * expected * expected;
                }
            }
        });
        let [displacement, gradient, stress] = sums.map(|[error, norm]| (error / norm).sqrt());
        Errors {
            displacement,
            gradient,
            stress,
        }
    }
}

/// x of A x = b, where the entries of A at the same place add up; by elimination with pivots (LU), since A need not be definite.
///
/// # Errors
/// A singular matrix.
pub fn solved(entries: &[Triplet<usize, usize, f64>], b: &[f64]) -> Measured<Vec<f64>> {
    let matrix = SparseColMat::try_new_from_triplets(b.len(), b.len(), entries)
        .map_err(|error| format!("no matrix: {error:?}"))?;
    let factors = matrix
        .sp_lu()
        .map_err(|error| format!("a singular matrix: {error:?}"))?;
    let mut x = Col::from_fn(b.len(), |k| b[k]);
    factors.solve_in_place(&mut x);
    Ok(x.iter().copied().collect())
}

/// What is said of an element whose Jacobian is not positive.
pub fn inside_out(jacobian: f64) -> String {
    format!("an element has the Jacobian {jacobian:e}, which must be above 0")
}

/// The triangle with these corners of a cell and the points half-way between them.
fn triangle([a, b, c]: [[usize; 2]; 3]) -> [[usize; 2]; NODES] {
    let middle = |p: [usize; 2], q: [usize; 2]| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
    [a, b, c, middle(a, b), middle(b, c), middle(c, a)]
}
