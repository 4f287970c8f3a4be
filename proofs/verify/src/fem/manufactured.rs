//! Manufactured solutions: orders of convergence, and locking as ν goes to ½.

use palpate::phantom::Material;

use super::convergence::{STRESS_ORDER_OF_ANY_NU, convergence};
use super::problem::{Errors, Exact, Field, Problem, lame, material};
use super::{Measured, largest, least};

/// u = (A sin px sin qy, B cos px cos qy), with div u = (A p − B q) cos px sin qy, which vanishes for A = q, B = p.
struct Wave {
    amplitude: [f64; 2],
    number: [f64; 2],
}

impl Exact for Wave {
    fn field(&self, [x, y]: [f64; 2]) -> Field {
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        let ([sx, cx], [sy, cy]) = (
            [libm::sin(p * x), libm::cos(p * x)],
            [libm::sin(q * y), libm::cos(q * y)],
        );
        let gradient = [
            [a * p * cx * sy, a * q * sx * cy],
            [-b * p * sx * cy, -b * q * cx * sy],
        ];
        ([a * sx * sy, b * cx * cy], gradient)
    }
}

impl Wave {
    /// The body force that keeps the field in balance, f = −(λ + μ) ∇ div u − μ Δu, with Δu = −(p² + q²) u.
    fn body_force(&self, material: &Material, [x, y]: [f64; 2]) -> [f64; 2] {
        let (lambda, mu) = lame(material);
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        let share = (lambda + mu) * (a * p - b * q);
        let u = self.displacement([x, y]);
        [
            share * p * libm::sin(p * x) * libm::sin(q * y) + mu * (p * p + q * q) * u[0],
            -share * q * libm::cos(p * x) * libm::cos(q * y) + mu * (p * p + q * q) * u[1],
        ]
    }

    /// Errors on a mesh of `cells` × `cells` cells of the unit square, bent so that every edge is curved and no
    /// element like another; the exact displacement is prescribed along the border.
    fn errors(&self, cells: usize, poisson_ratio: f64) -> Measured<Errors> {
        let material = material(1.0, poisson_ratio);
        let bend = |[x, y]: [f64; 2]| {
            let turn = 2.0 * std::f64::consts::PI;
            [
                x + 0.06 * libm::sin(turn * y) + 0.04 * libm::sin(turn * x),
                y + 0.08 * libm::sin(turn * x),
            ]
        };
        // The diagonals point to the middle, as in the phantom's mesh.
        let problem = Problem::lattice(
            [cells, cells],
            bend,
            |[x, y]| (x > 0.5) == (y > 0.5),
            |_| material,
        );
        let flat = Problem::lattice([cells, cells], |at| at, |_| true, |_| material);
        let border = |node: usize| flat.nodes[node].iter().any(|&c| c == 0.0 || c == 1.0);
        let loads = problem.body_loads(|at| self.body_force(&material, at));
        let (u, _) = problem.solve(loads, |node, direction| {
            border(node).then(|| self.displacement(problem.nodes[node])[direction])
        })?;
        Ok(problem.errors(&u, self))
    }
}

pub fn triangles() -> Measured {
    let wave = Wave {
        amplitude: [1.0, -0.5],
        number: [2.0, 3.0],
    };
    let mut figures = Vec::new();
    for nu in [0.3, 0.49] {
        let errors = [4, 8, 16, 32].map(|cells| wave.errors(cells, nu));
        let errors = errors.into_iter().collect::<Measured<Vec<_>>>()?;
        figures.extend(convergence(&format!("manufactured, ν = {nu}"), &errors)?);
    }
    Ok(figures)
}

pub fn locking() -> Measured {
    let wave = Wave {
        amplitude: [3.0, 2.0],
        number: [2.0, 3.0],
    };
    let study = |nu| -> Measured<[f64; 2]> {
        let [coarse, fine] = [16, 32].map(|cells| wave.errors(cells, nu));
        let [coarse, fine] = [coarse?.gradient, fine?.gradient];
        Ok([fine, libm::log2(coarse / fine)])
    };
    let found = [0.3, 0.4, 0.49, 0.499, 0.4999].map(study);
    let found = found.into_iter().collect::<Measured<Vec<_>>>()?;
    let [errors, orders] = [0, 1].map(|k| found.iter().map(move |found| found[k]));
    Ok(figures! {
        "any ν: least observed order of the gradient" => at_least(least(orders), STRESS_ORDER_OF_ANY_NU);
        "any ν: largest relative error of the gradient" => at_most(largest(errors), 0.03);
    })
}
