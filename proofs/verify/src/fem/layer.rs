//! A layer bonded to a rigid base, thin or thick, and a thin strip between rigid bonded plates.

use std::f64::consts::PI;

use palpate::phantom::Material;

use super::convergence::convergence;
use super::problem::{Errors, Exact, Field, Problem, lame, material};
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
    fn field(&self, [x, y]: [f64; 2]) -> Field {
        let ([a, b], k) = (self.coefficients(), self.number);
        let (double_mu, kappa) = (
            2.0 * lame(&self.material).1,
            3.0 - 4.0 * self.material.poisson_ratio,
        );
        let (s, c) = (libm::sinh(k * y), libm::cosh(k * y));
        let (even, odd) = (a * c + b * s, a * s + b * c);
        let (along, up) = (kappa * a * s + k * y * even, kappa * b * s - k * y * odd);
        let along_slope = kappa * a * c + even + k * y * odd;
        let up_slope = kappa * b * c - odd - k * y * even;
        let (sin, cos) = libm::sincos(k * x);
        let (rise, run) = (k * sin / double_mu, k * cos / double_mu);
        (
            [along * sin / double_mu, up * cos / double_mu],
            [
                [along * run, along_slope * rise],
                [-up * rise, up_slope * run],
            ],
        )
    }
}

/// Errors of half a wave of the layer on 4 meshes of bent triangles.
fn errors(layer: &BondedLayer, columns: usize) -> Measured<[Errors; 4]> {
    let (length, h) = (PI / layer.number, layer.thickness);
    let solve = |n: usize| -> Measured<Errors> {
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

/// Wave number times thickness, kh, columns of cells for each row, and ν.
const CASES: [(f64, usize, f64); 3] = [(2.0, 2, 0.49), (0.3, 3, 0.49), (0.3, 3, 0.4999)];

pub fn bonded() -> Measured {
    let mut figures = Vec::new();
    for (number, columns, nu) in CASES {
        let layer = BondedLayer {
            number,
            thickness: 1.0,
            material: material(1.0, nu),
        };
        // The closed form itself: no shear and the pressure cos kx at the top, where 2μ ∂u_y/∂y + λ div u = −cos kx.
        let (lambda, mu) = lame(&layer.material);
        let (_, g) = layer.field([0.7, 1.0]);
        let pressure = -(lambda * (g[0][0] + g[1][1]) + 2.0 * mu * g[1][1]);
        let what = format!("kh = {number}, ν = {nu}");
        let shear = (g[0][1] + g[1][0]).abs();
        figures.extend(figures! {
            "{what}: error of the closed form's pressure" => at_most((pressure - libm::cos(0.7 * number)).abs(), 1e-9);
            "{what}: shear strain of the closed form at the free surface" => at_most(shear, 1e-12);
        });
        figures.extend(convergence(&what, &errors(&layer, columns)?)?);
    }
    Ok(figures)
}

/// Force over that of a wide strip, F t/(2b M δ), on a strip of half-width b and thickness t between rigid bonded plates
/// that come closer by δ, M = λ + 2μ, with the modulus chosen so that β b = 2 (see the check).
fn strip(slenderness: usize) -> Measured<f64> {
    let b = slenderness as f64;
    // β² = 12 μ/(M t²), t = 1, and M/μ = 2 (1 − ν)/(1 − 2ν).
    let ratio = 12.0 * b * b / 4.0;
    let material = material(1.0, (ratio - 2.0) / (2.0 * ratio - 2.0));
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
