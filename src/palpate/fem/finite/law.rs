//! What a material stores at finite strain, and the forces and stiffness of one element that follow from it.
//!
//! Bonet and Wood's compressible neo-Hookean law, W = μ/2 (I₁ − 3 − 2 ln J) + λ/2 (ln J)², with the pressure p = λ ln J
//! interpolated on its own: λ/2 (ln J)² is written p ln J − p²/(2λ) + α/2 (ln J − p/λ)², which is stationary in p and has the same
//! value there. Yeoh's second term adds C₂₀ (I₁ − 3)², and fibres along a, of which E_f is the modulus, add E_f/8 (I₄ − 1)² with
//! I₄ = |F a|².

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

use crate::fem::element::{
    CORNERS, NODES, PerNode, gradients, lame, parent_gradients, quadrature, revolved,
};
use crate::phantom::{Geometry, Material, Phantom};

/// Unknowns of an element: both displacements of each node, then the pressure at each corner.
pub(super) const UNKNOWNS: usize = 2 * NODES + CORNERS;

/// The name of the law of a phantom's materials, for every output.
///
/// Implements: FIN-008.
pub fn name(phantom: &Phantom) -> String {
    let has = |modulus: fn(&Material) -> f64| phantom.materials().any(|of| modulus(of) != 0.0);
    [
        (true, "neo-Hookean (Bonet and Wood)"),
        (has(|of| of.yeoh_c20), ", Yeoh's second term"),
        (has(|of| of.fibre_modulus), ", fibres"),
    ]
    .into_iter()
    .map(|(is_there, part)| if is_there { part } else { "" })
    .collect()
}

/// The constants of a law, Pa.
///
/// Implements: FIN-001, FIN-013.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    lambda: f64,
    mu: f64,
    c20: f64,
    fibre_modulus: f64,
    fibres: Vector2<f64>,
}

/// p ln J − p²/(2λ) + α r²/2 with r = ln J − p/λ and α = p²/(4μ) under tension, 0 else; and its derivatives by ln J and p.
///
/// Implements: FIN-014.
struct Volumetric {
    energy: f64,
    by_ln_det: f64,
    by_pressure: f64,
    by_ln_det_twice: f64,
    by_both: f64,
    by_pressure_twice: f64,
}

impl Volumetric {
    fn new(ln_det: f64, pressure: f64, (lambda, mu): (f64, f64)) -> Volumetric {
        let rest = ln_det - pressure / lambda;
        let tension = pressure.max(0.0);
        let alpha = tension * tension / (4.0 * mu);
        let slope = tension / (2.0 * mu);
        let turn = if pressure > 0.0 { 0.5 / mu } else { 0.0 };
        Volumetric {
            energy: pressure * (ln_det - pressure / (2.0 * lambda)) + 0.5 * alpha * rest * rest,
            by_ln_det: pressure + alpha * rest,
            by_pressure: rest * (1.0 - alpha / lambda + 0.5 * slope * rest),
            by_ln_det_twice: alpha,
            by_both: 1.0 - alpha / lambda + slope * rest,
            by_pressure_twice: (alpha / lambda - 1.0 - 2.0 * slope * rest) / lambda
                + 0.5 * turn * rest * rest,
        }
    }
}

impl From<&Material> for Law {
    fn from(material: &Material) -> Law {
        let (lambda, mu) = lame(material);
        Law {
            lambda,
            mu,
            c20: material.yeoh_c20,
            fibre_modulus: material.fibre_modulus,
            fibres: material.fibre_direction().into(),
        }
    }
}

/// A quadrature point of an undeformed element.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// ∂N_a/∂X, 1/m.
    gradients: PerNode,
    /// N_a/X of a revolved element, 1/m; 0 in plane strain.
    hoop: [f64; NODES],
    /// The pressure's shape functions.
    pressures: [f64; CORNERS],
    /// The volume that it stands for, m³.
    volume: f64,
}

/// The quadrature points of an element of a `phantom`, or the Jacobian that is not positive.
pub(super) fn points(positions: &[[f64; 2]], phantom: &Phantom) -> Result<Vec<Point>, f64> {
    let point = |([r, s], weight): ([f64; 2], f64)| {
        let g = gradients(&parent_gradients([r, s]), positions);
        // A NaN is refused as well.
        if g.jacobian.is_nan() || g.jacobian <= 0.0 {
            return Err(g.jacobian);
        }
        let (length, hoop) = match phantom.geometry() {
            Geometry::Plane => (phantom.probe().length, [0.0; NODES]),
            Geometry::Axisymmetric => revolved([r, s], positions),
        };
        Ok(Point {
            gradients: g.of_node,
            hoop,
            pressures: [1.0 - r - s, r, s],
            volume: weight * g.jacobian * length,
        })
    };
    quadrature().map(point).collect()
}

/// What one element does at one state.
///
/// Implements: FIN-003.
#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Stored energy, J.
    pub energy: f64,
    /// Forces of the nodes, N, and what is left of p = λ ln J, m³.
    pub force: SVector<f64, UNKNOWNS>,
    /// Their derivatives, symmetric.
    pub tangent: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    /// The smallest J = det F.
    pub least_det: f64,
}

impl Law {
    /// Energy, forces and stiffness of an element under `state`; `None` where it is turned inside out.
    ///
    /// With the spatial gradients g_a = F⁻ᵀ∇N_a, q_a = F∇N_a, f_a = ∇N_a·a, c = p − μ, m = μ + 4 C₂₀ (I₁ − 3) and
    /// t = E_f (I₄ − 1)/2, the force on node a is m q_a + t f_a F a + c g_a, and its derivative by the displacement of node b
    /// (m ∇N_a·∇N_b + t f_a f_b) I + 8 C₂₀ q_a q_bᵀ + E_f f_a f_b (F a)(F a)ᵀ − c g_b g_aᵀ + α g_a g_bᵀ, where c also has
    /// α (ln J − p/λ) under tension. Turned about an axis, with h_a = N_a/X and
    /// the stretch s of the circle, q_a grows by s h_a e_x, the g_a of the force by (h_a/s) e_x, and the derivative by
    /// h_a h_b (m − c/s²) e_x e_xᵀ.
    pub(super) fn element(
        &self,
        points: &[Point],
        state: &SVector<f64, UNKNOWNS>,
    ) -> Option<Element> {
        let displacements = PerNode::from_column_slice(&state.as_slice()[..2 * NODES]);
        let mut element = Element {
            energy: 0.0,
            force: SVector::zeros(),
            tangent: SMatrix::zeros(),
            least_det: f64::INFINITY,
        };
        for point in points {
            let gradient = Matrix2::identity() + displacements * point.gradients.transpose();
            let along = (0..NODES).map(|a| point.hoop[a] * displacements[(0, a)]);
            let hoop = 1.0 + along.sum::<f64>();
            let det = gradient.determinant() * hoop;
            // A NaN is refused as well.
            if det.is_nan() || det <= 0.0 || hoop <= 0.0 {
                return None;
            }
            element.least_det = element.least_det.min(det);
            let pressure = (0..CORNERS).map(|k| point.pressures[k] * state[2 * NODES + k]);
            self.add(&mut element, point, (&gradient, hoop), pressure.sum());
        }
        for row in 0..UNKNOWNS {
            for column in 0..row {
                element.tangent[(row, column)] = element.tangent[(column, row)];
            }
        }
        Some(element)
    }

    /// Cauchy stress (σ_xx, σ_yy, σ_zz, σ_xy), Pa, under the displacement gradient `gradient[i][j]` = ∂u_i/∂X_j and a pressure, Pa:
    /// J σ = m F Fᵀ + t (F a)(F a)ᵀ + c I.
    pub(super) fn stress(&self, gradient: [[f64; 2]; 2], pressure: f64) -> [f64; 4] {
        let [[xx, xy], [yx, yy]] = gradient;
        let gradient = Matrix2::identity() + Matrix2::new(xx, xy, yx, yy);
        let stiff = self.mu + 4.0 * self.c20 * (gradient.norm_squared() - 2.0);
        let stretched = gradient * self.fibres;
        let tension = self.fibre_modulus * (stretched.norm_squared() - 1.0) / 2.0;
        let excess = pressure - self.mu;
        let plane = gradient * gradient.transpose() * stiff
            + stretched * tension * stretched.transpose()
            + Matrix2::from_diagonal_element(excess);
        let components = [plane[(0, 0)], plane[(1, 1)], stiff + excess, plane[(0, 1)]];
        components.map(|component| component / gradient.determinant())
    }

    /// Adds one point to the upper triangle of an element.
    fn add(
        &self,
        element: &mut Element,
        point: &Point,
        (gradient, hoop): (&Matrix2<f64>, f64),
        pressure: f64,
    ) {
        let Law {
            lambda, mu, c20, ..
        } = *self;
        let volume = point.volume;
        let [[xx, yx], [xy, yy]] = gradient.data.0;
        let spatial = Matrix2::new(yy, -yx, -xy, xx) / gradient.determinant() * point.gradients;
        // With the stretch of the circle that a point is turned on.
        let (mut moved, mut dilation) = (gradient * point.gradients, spatial);
        for (a, of) in point.hoop.iter().enumerate() {
            moved[(0, a)] += hoop * of;
            dilation[(0, a)] += of / hoop;
        }
        let (along, stretched) = (point.gradients.tr_mul(&self.fibres), gradient * self.fibres);
        let ln_det = libm::log(gradient.determinant() * hoop);
        let growth = gradient.norm_squared() + hoop * hoop - 3.0;
        let stretch = stretched.norm_squared() - 1.0;
        let isochoric = 0.5 * mu * (growth - 2.0 * ln_det) + c20 * growth * growth;
        let fibrous = self.fibre_modulus / 8.0 * stretch * stretch;
        let volumetric = Volumetric::new(ln_det, pressure, (lambda, mu));
        element.energy += volume * (isochoric + fibrous + volumetric.energy);
        let excess = volume * (volumetric.by_ln_det - mu);
        let stiff = volume * (mu + 4.0 * c20 * growth);
        let tension = volume * self.fibre_modulus * stretch / 2.0;
        for b in 0..NODES {
            let (of_b, spatial_b) = (point.gradients.column(b), spatial.column(b));
            let (moved_b, dilation_b) = (moved.column(b), dilation.column(b));
            let force: Vector2<f64> =
                moved_b * stiff + stretched * (tension * along[b]) + dilation_b * excess;
            let mut rows = element.force.fixed_rows_mut::<2>(2 * b);
            rows += force;
            for a in 0..=b {
                let both = along[a] * along[b];
                let isotropic = stiff * point.gradients.column(a).dot(&of_b) + tension * both;
                let mut block = element.tangent.fixed_view_mut::<2, 2>(2 * a, 2 * b);
                block += Matrix2::from_diagonal_element(isotropic)
                    + moved.column(a) * (8.0 * volume * c20) * moved_b.transpose()
                    + stretched * (volume * self.fibre_modulus * both) * stretched.transpose()
                    - spatial_b * excess * spatial.column(a).transpose()
                    + dilation.column(a)
                        * (volume * volumetric.by_ln_det_twice)
                        * dilation_b.transpose();
                let circles = point.hoop[a] * point.hoop[b];
                block[(0, 0)] += circles * (stiff - excess / (hoop * hoop));
            }
            for (k, shape) in point.pressures.iter().enumerate() {
                let column = 2 * NODES + k;
                let mut block = element.tangent.fixed_view_mut::<2, 1>(2 * b, column);
                block += dilation_b * (volume * shape * volumetric.by_both);
            }
        }
        for (k, shape) in point.pressures.iter().enumerate() {
            let weight = volume * shape;
            element.force[2 * NODES + k] += weight * volumetric.by_pressure;
            for (l, other) in point.pressures.iter().enumerate().skip(k) {
                element.tangent[(2 * NODES + k, 2 * NODES + l)] +=
                    weight * other * volumetric.by_pressure_twice;
            }
        }
    }
}
