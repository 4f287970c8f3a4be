//! Shape functions, quadrature and element stiffness in plane strain.

use nalgebra::{Matrix2, SMatrix, Vector2};

use crate::phantom::{Geometry, Material};

/// Corners of an element: its first nodes.
pub const CORNERS: usize = 3;
/// Nodes of an element: corners counter-clockwise, then those in the middle of the edges 01, 12, 20.
pub const NODES: usize = 6;

/// One column for each node.
pub type PerNode = SMatrix<f64, 2, NODES>;

/// Stiffness of one element, in a plane per metre of thickness, Pa: `[(2a + i, 2b + j)]` couples direction i of node a with
/// direction j of node b. Exactly symmetric.
///
/// Implements: FEM-005, FEM-050.
pub type Stiffness = SMatrix<f64, { 2 * NODES }, { 2 * NODES }>;

/// The points at which strains and stresses are sampled, in parent coordinates: where they are most accurate.
pub(super) const SAMPLES: [[f64; 2]; 3] = symmetric_points(1.0 / 6.0);

/// The three images of barycentric coordinates (a, a, 1 − 2a), in parent coordinates.
const fn symmetric_points(a: f64) -> [[f64; 2]; 3] {
    let b = 1.0 - 2.0 * a;
    [[a, a], [b, a], [a, b]]
}

/// Derivatives of the shape functions with respect to the parent coordinates, a column for each node.
pub fn parent_gradients([r, s]: [f64; 2]) -> PerNode {
    let q = 1.0 - r - s;
    PerNode::from([
        [1.0 - 4.0 * q, 1.0 - 4.0 * q],
        [4.0 * r - 1.0, 0.0],
        [0.0, 4.0 * s - 1.0],
        [4.0 * (q - r), -4.0 * r],
        [4.0 * s, 4.0 * r],
        [-4.0 * s, 4.0 * (q - s)],
    ])
}

/// The shape functions at a point in parent coordinates.
pub(super) fn shapes([r, s]: [f64; 2]) -> [f64; NODES] {
    let q = 1.0 - r - s;
    let corner = |q: f64| q * (2.0 * q - 1.0);
    [
        corner(q),
        corner(r),
        corner(s),
        4.0 * q * r,
        4.0 * r * s,
        4.0 * s * q,
    ]
}

/// What a point of a revolved element needs beside the gradients: the way, m, on which it is turned, of which either half of the
/// cross-section goes half a circle, and N_a/x, 1/m, by which displacements along x stretch that circle.
pub(super) fn revolved(at: [f64; 2], positions: &[[f64; 2]]) -> (f64, [f64; NODES]) {
    let shapes = shapes(at);
    let x: f64 = positions.iter().zip(shapes).map(|(p, n)| n * p[0]).sum();
    (std::f64::consts::PI * x.abs(), shapes.map(|n| n / x))
}

/// Gradients of the shape functions in space at one point of an element, and the Jacobian.
#[derive(Debug, Clone, Copy)]
pub struct Gradients {
    /// ∂N_a/∂x, ∂N_a/∂y, 1/m, a column for each node.
    pub of_node: PerNode,
    /// det ∂(x, y)/∂(parent): positive in a valid element.
    pub jacobian: f64,
}

/// Maps parent gradients to space for an element with corners and midsides at `positions`.
pub fn gradients(parent: &PerNode, positions: &[[f64; 2]]) -> Gradients {
    let nodes = positions.iter().zip(parent.column_iter());
    let parts = nodes.map(|(&at, gradient)| Vector2::from(at) * gradient.transpose());
    let map: Matrix2<f64> = parts.sum();
    let jacobian = map[(0, 0)] * map[(1, 1)] - map[(0, 1)] * map[(1, 0)];
    let cofactors = Matrix2::new(map[(1, 1)], -map[(1, 0)], -map[(0, 1)], map[(0, 0)]);
    let of_node = cofactors * parent / jacobian;
    Gradients { of_node, jacobian }
}

/// Lamé's constants (λ, μ), Pa.
pub(super) fn lame(material: &Material) -> (f64, f64) {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    (lambda, e / (2.0 * (1.0 + nu)))
}

/// Cauchy stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa, in plane strain from a displacement gradient
/// `gradient[i][j] = ∂u_i/∂x_j`.
///
/// Implements: FEM-050.
pub fn stress(material: &Material, gradient: [[f64; 2]; 2]) -> [f64; 4] {
    let (lambda, mu) = lame(material);
    let pressure = lambda * (gradient[0][0] + gradient[1][1]);
    let shear = gradient[0][1] + gradient[1][0];
    let [a, b] = material.fibre_direction();
    let stretch = gradient[0][0] * a * a + gradient[1][1] * b * b + shear * a * b;
    let tension = material.fibre_modulus * stretch;
    [
        pressure + 2.0 * mu * gradient[0][0] + tension * a * a,
        pressure + 2.0 * mu * gradient[1][1] + tension * b * b,
        pressure,
        mu * shear + tension * a * b,
    ]
}

/// The quadrature of an element's stiffness, exact to degree 4, so that bent elements are integrated well too: Cowper's 6
/// points: where they are, parent gradients there, and weights.
#[derive(Debug, Clone)]
pub struct StiffnessRule(Vec<([f64; 2], PerNode, f64)>);

/// Where its points lie on the medians, and their weights, which add up to the parent's area with three points each: ½.
const COWPER: [(f64, f64); 2] = [
    (0.445_948_490_915_964_9, 0.223_381_589_678_011_47 / 2.0),
    (0.091_576_213_509_770_74, 0.109_951_743_655_321_87 / 2.0),
];

/// The points in parent coordinates, and their weights.
pub(super) fn quadrature() -> impl Iterator<Item = ([f64; 2], f64)> {
    let medians = COWPER.iter();
    medians.flat_map(|&(a, weight)| symmetric_points(a).map(|at| (at, weight)))
}

impl Default for StiffnessRule {
    fn default() -> StiffnessRule {
        let points = quadrature().map(|(at, weight)| (at, parent_gradients(at), weight));
        StiffnessRule(points.collect())
    }
}

impl StiffnessRule {
    /// Stiffness of an element with nodes at `positions`, or the Jacobian that is not positive. In a plane it is that of 1 m of length,
    /// Pa. Turned about the axis x = 0 it is that of half a turn, N/m: the mirror image is turned by the other half.
    ///
    /// With h_a = 0 in a plane, N_a/x about the axis, and d_a = ∇N_a + h_a e_x, the block of nodes a, b is ∫ λ d_a d_bᵀ + μ ∇N_b ∇N_aᵀ +
    /// μ (∇N_a·∇N_b) I + 2 μ h_a h_b e_x e_xᵀ, and for fibres along f with the modulus E_f ∫ E_f (∇N_a·f)(∇N_b·f) f fᵀ more.
    ///
    /// Implements: FEM-017, FEM-081.
    pub fn integrate(
        &self,
        positions: &[[f64; 2]],
        material: &Material,
        geometry: Geometry,
    ) -> Result<Stiffness, f64> {
        let (lambda, mu) = lame(material);
        let fibres = Vector2::from(material.fibre_direction());
        let mut stiffness = Stiffness::zeros();
        for (at, parent, weight) in &self.0 {
            let g = gradients(parent, positions);
            // A NaN is refused as well.
            if g.jacobian.is_nan() || g.jacobian <= 0.0 {
                return Err(g.jacobian);
            }
            let (way, hoop) = match geometry {
                Geometry::Plane => (1.0, [0.0; NODES]),
                Geometry::Axisymmetric => revolved(*at, positions),
            };
            let volume = weight * g.jacobian * way;
            for a in 0..NODES {
                let ga = g.of_node.column(a) * volume;
                let ha = hoop[a] * volume * Vector2::x();
                for b in 0..=a {
                    let (gb, hb) = (g.of_node.column(b), hoop[b] * Vector2::x());
                    let mut block = stiffness.fixed_view_mut::<2, 2>(2 * a, 2 * b);
                    block += lambda * (ga + ha) * (gb + hb).transpose()
                        + mu * gb * ga.transpose()
                        + Matrix2::from_diagonal_element(mu * ga.dot(&gb))
                        + 2.0 * mu * ha * hb.transpose();
                    if material.fibre_modulus > 0.0 {
                        let both = material.fibre_modulus * ga.dot(&fibres) * gb.dot(&fibres);
                        block += both * fibres * fibres.transpose();
                    }
                }
            }
        }
        stiffness.fill_upper_triangle_with_lower_triangle();
        Ok(stiffness)
    }
}
