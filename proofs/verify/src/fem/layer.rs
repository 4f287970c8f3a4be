//! A layer bonded to a rigid base, thin or thick, and a thin strip between rigid bonded plates.

use std::f64::consts::PI;

use palpate::phantom::Material;

use super::convergence::{ORDERS, ORDERS_OF_ANY_NU, convergence};
use super::problem::{Errors, Exact, Problem, lame};
use super::{Measured, largest};

/// A layer 0 ≤ y ≤ h, u = 0 at y = 0, under the traction σ_yy = −cos kx, σ_xy = 0 at y = h.
///
/// Papkovich's and Neuber's potentials ψ = (c₁ cosh ky + c₂ sinh ky) cos kx and φ = (κ c₁/k) sinh ky cos kx, κ = 3 − 4ν,
/// hold the base, and give
///
/// 2μ u_x = (κ c₁ S + ky (c₁ C + c₂ S)) sin kx, 2μ u_y = (κ c₂ S − ky (c₁ S + c₂ C)) cos kx
///
/// with C = cosh ky, S = sinh ky. No shear at the top means, with m = kh, c₁ = −t ((1 − κ) S + 2m C) and
/// c₂ = t ((1 + κ) C + 2m S), and the pressure is k t (2m² + ½ (1 + κ)² + 2κ S²).
pub struct BondedLayer {
    pub number: f64,
    pub thickness: f64,
    pub material: Material,
}

impl BondedLayer {
    /// c₁, c₂.
    fn coefficients(&self) -> [f64; 2] {
        let kappa = 3.0 - 4.0 * self.material.poisson_ratio;
        let m = self.number * self.thickness;
        let (s, c) = (libm::sinh(m), libm::cosh(m));
        let t = -1.0
            / (self.number
                * (2.0 * m * m + 0.5 * (1.0 + kappa) * (1.0 + kappa) + 2.0 * kappa * s * s));
        [
            -t * ((1.0 - kappa) * s + 2.0 * m * c),
            t * ((1.0 + kappa) * c + 2.0 * m * s),
        ]
    }
}

impl Exact for BondedLayer {
    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([a, b], k) = (self.coefficients(), self.number);
        let (mu, kappa) = (
            lame(&self.material).1,
            3.0 - 4.0 * self.material.poisson_ratio,
        );
        let (s, c) = (libm::sinh(k * y), libm::cosh(k * y));
        [
            (kappa * a * s + k * y * (a * c + b * s)) * libm::sin(k * x) / (2.0 * mu),
            (kappa * b * s - k * y * (a * s + b * c)) * libm::cos(k * x) / (2.0 * mu),
        ]
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let ([a, b], k) = (self.coefficients(), self.number);
        let (mu, kappa) = (
            lame(&self.material).1,
            3.0 - 4.0 * self.material.poisson_ratio,
        );
        let (s, c) = (libm::sinh(k * y), libm::cosh(k * y));
        let (even, odd) = (a * c + b * s, a * s + b * c);
        let (along, up) = (kappa * a * s + k * y * even, kappa * b * s - k * y * odd);
        let along_slope = kappa * a * c + even + k * y * odd;
        let up_slope = kappa * b * c - odd - k * y * even;
        let (sin, cos) = (
            k * libm::sin(k * x) / (2.0 * mu),
            k * libm::cos(k * x) / (2.0 * mu),
        );
        [
            [along * cos, along_slope * sin],
            [-up * sin, up_slope * cos],
        ]
    }
}

/// Errors of half a wave of the layer on 4 meshes of bent triangles.
fn errors(layer: &BondedLayer, columns: usize) -> Result<[Errors; 4], String> {
    let (length, h) = (PI / layer.number, layer.thickness);
    let solve = |n: usize| -> Result<Errors, String> {
        let problem = Problem::lattice(
            [columns * n, n],
            |[s, t]| {
                // Inner edges are curved, the border straight.
                let rise = 0.1 * libm::sin(PI * s) * libm::sin(PI * t);
                [length * s, h * (t + rise)]
            },
            |[x, _]| x > 0.5,
            |_| layer.material,
        );
        let mut loads = vec![0.0; 2 * problem.nodes.len()];
        problem.add_traction(
            &mut loads,
            |at| at[1] == h,
            |[x, _], n| [0.0, -libm::cos(layer.number * x) * n[1]],
        );
        let (u, _) = problem.solve(loads, |node, direction| {
            let [x, y] = problem.nodes[node];
            let held = y == 0.0 || (direction == 0 && (x == 0.0 || x == length));
            held.then_some(0.0)
        })?;
        Ok(problem.errors(&u, layer))
    };
    Ok([solve(4)?, solve(8)?, solve(16)?, solve(32)?])
}

/// A layer to solve for, with the errors of displacement and stress that are stored for four meshes, and their orders.
struct Case {
    /// Wave number times thickness, kh.
    number: f64,
    columns: usize,
    nu: f64,
    stored: [[f64; 4]; 2],
    orders: [f64; 2],
}

/// The pressure is the last to reach its order; at ν = 0.4999 the displacement is on its way too.
const CASES: [Case; 3] = [
    Case {
        number: 2.0,
        columns: 2,
        nu: 0.49,
        stored: [
            [1.127161e-2, 1.286235e-3, 1.282166e-4, 1.241168e-5],
            [2.393160e-1, 9.083377e-2, 2.860989e-2, 8.066989e-3],
        ],
        orders: [ORDERS[0], ORDERS_OF_ANY_NU[1]],
    },
    Case {
        number: 0.3,
        columns: 3,
        nu: 0.49,
        stored: [
            [1.583937e-3, 2.119906e-4, 2.384953e-5, 2.520786e-6],
            [1.419327e-2, 4.239383e-3, 1.233276e-3, 3.366325e-4],
        ],
        orders: [ORDERS[0], ORDERS_OF_ANY_NU[1]],
    },
    Case {
        number: 0.3,
        columns: 3,
        nu: 0.4999,
        stored: [
            [5.665095e-3, 9.418422e-4, 1.404146e-4, 2.078253e-5],
            [3.628944e-1, 1.323208e-1, 5.547951e-2, 1.910465e-2],
        ],
        orders: ORDERS_OF_ANY_NU,
    },
];

pub fn bonded() -> Measured {
    let mut figures = Vec::new();
    for Case {
        number,
        columns,
        nu,
        stored,
        orders,
    } in CASES
    {
        let layer = BondedLayer {
            number,
            thickness: 1.0,
            material: Material {
                youngs_modulus: 1.0,
                poisson_ratio: nu,
            },
        };
        // The closed form itself: no shear and the pressure cos kx at the top, where 2μ ∂u_y/∂y + λ div u = −cos kx.
        let (lambda, mu) = lame(&layer.material);
        let g = layer.gradient([0.7, 1.0]);
        let pressure = -(lambda * (g[0][0] + g[1][1]) + 2.0 * mu * g[1][1]);
        let what = format!("kh = {number}, ν = {nu}");
        let shear = (g[0][1] + g[1][0]).abs();
        figures.extend(figures! {
            "{what}: error of the closed form's pressure" => at_most((pressure - libm::cos(0.7 * number)).abs(), 1e-9);
            "{what}: shear strain of the closed form at the free surface" => at_most(shear, 1e-12);
        });
        let errors = errors(&layer, columns)?;
        figures.extend(convergence(
            &format!("{what}, displacement"),
            errors.map(|e| e.displacement),
            stored[0],
            orders[0],
        ));
        figures.extend(convergence(
            &format!("{what}, stress"),
            errors.map(|e| e.stress),
            stored[1],
            orders[1],
        ));
    }
    Ok(figures)
}

/// Force over that of a wide strip, F t/(2b M δ), on a strip of half-width b and thickness t between rigid bonded plates
/// that come closer by δ, M = λ + 2μ, with the modulus chosen so that β b = 2 (see the check).
fn strip(slenderness: usize) -> Result<f64, String> {
    let b = slenderness as f64;
    // β² = 12 μ/(M t²), t = 1, and M/μ = 2 (1 − ν)/(1 − 2ν).
    let ratio = 12.0 * b * b / 4.0;
    let material = Material {
        youngs_modulus: 1.0,
        poisson_ratio: (ratio - 2.0) / (2.0 * ratio - 2.0),
    };
    // A quarter, 0 ≤ x ≤ b and 0 ≤ y ≤ t/2; cells shrink towards the free side, where the corner is singular.
    let problem = Problem::lattice(
        [5 * slenderness, 8],
        |[s, t]| {
            [
                b * (1.0 - (1.0 - s) * (1.0 - s)),
                0.5 * (1.0 - (1.0 - t) * (1.0 - t)),
            ]
        },
        |_| true,
        |_| material,
    );
    let plate = |node: usize| problem.nodes[node][1] == 0.5;
    let (_, force) = problem.solve(vec![0.0; 2 * problem.nodes.len()], |node, direction| {
        if plate(node) {
            Some([0.0, -0.5][direction])
        } else {
            (problem.nodes[node][direction] == 0.0).then_some(0.0)
        }
    })?;
    let down: f64 = (0..problem.nodes.len())
        .filter(|&node| plate(node))
        .map(|node| -force[2 * node + 1])
        .sum();
    let (lambda, mu) = lame(&material);
    Ok(2.0 * down / (2.0 * b * (lambda + 2.0 * mu)))
}

pub fn thin() -> Measured {
    // In a thin strip the pressure p(x) does not vary through the thickness. Between bonded plates it drives the flux
    // q = −t³ p'/(12 μ), and what the plates displace either flows or is compressed, δ/t = p/M + q'/t, where M stands for
    // the bulk modulus to the order of μ/M. So p'' = β² (p − M δ/t), p(±b) = 0, β² = 12 μ/(M t²), and
    // F t/(2b M δ) = 1 − tanh(βb)/(βb), up to the edge, a piece of some t out of b: an error c₁/s + c₂/s² + c₃/s³ + … at
    // the slenderness s = b/t. Three strips remove the first two terms; the third leaves c₃/(10 · 20 · 40), 1.3e-4 c₃.
    let limit = 1.0 - libm::tanh(2.0) / 2.0;
    let [short, medium, long] = [strip(10)?, strip(20)?, strip(40)?];
    let extrapolated = (8.0 * long - 6.0 * medium + short) / 3.0;
    let off = [(short, 10.0), (medium, 20.0), (long, 40.0)]
        .map(|(found, slenderness)| (found - limit).abs() * slenderness);
    let difference = (extrapolated - limit).abs();
    Ok(figures! {
        "force extrapolated to infinite slenderness, over a wide strip's" => told(extrapolated);
        "difference of the extrapolated force from the limit" => at_most(difference, 5e-4);
        "largest difference of a strip's force from the limit, times its slenderness" => at_most(largest(off), 0.1);
    })
}
