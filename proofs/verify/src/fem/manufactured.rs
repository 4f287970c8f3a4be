//! Manufactured solutions: orders of convergence, and locking as ν goes to ½.

use palpate::phantom::Material;

use super::convergence::{ORDERS, ORDERS_OF_ANY_NU, convergence};
use super::problem::{Errors, Exact, Problem, lame};
use super::{Measured, largest, least};

/// u = (A sin px sin qy, B cos px cos qy), with div u = (A p − B q) cos px sin qy, which vanishes for A = q, B = p.
struct Wave {
    amplitude: [f64; 2],
    number: [f64; 2],
}

impl Exact for Wave {
    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        [
            a * libm::sin(p * x) * libm::sin(q * y),
            b * libm::cos(p * x) * libm::cos(q * y),
        ]
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        let ([sx, cx], [sy, cy]) = (
            [libm::sin(p * x), libm::cos(p * x)],
            [libm::sin(q * y), libm::cos(q * y)],
        );
        [
            [a * p * cx * sy, a * q * sx * cy],
            [-b * p * sx * cy, -b * q * cx * sy],
        ]
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
    fn errors(&self, cells: usize, poisson_ratio: f64) -> Result<Errors, String> {
        let material = Material {
            youngs_modulus: 1.0,
            poisson_ratio,
        };
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

/// Cells along each side of the meshes. The stored errors on them are scikit-fem's (reference.py).
const CELLS: [usize; 4] = [4, 8, 16, 32];

/// A convergence study with the stored errors of displacement and gradient.
fn study(poisson_ratio: f64, stored: [[f64; 4]; 2]) -> Measured {
    let wave = Wave {
        amplitude: [1.0, -0.5],
        number: [2.0, 3.0],
    };
    let [a, b, c, d] = CELLS.map(|cells| wave.errors(cells, poisson_ratio));
    let errors = [a?, b?, c?, d?];
    let name = format!("ν = {poisson_ratio}");
    let [displacement, gradient] = stored;
    let mut figures = convergence(
        &format!("{name}, displacement"),
        errors.map(|e| e.displacement),
        displacement,
        ORDERS[0],
    );
    figures.extend(convergence(
        &format!("{name}, gradient"),
        errors.map(|e| e.gradient),
        gradient,
        ORDERS[1],
    ));
    Ok(figures)
}

pub fn triangles() -> Measured {
    let mut figures = study(
        0.3,
        [
            [9.364223e-3, 1.178679e-3, 1.432481e-4, 1.753357e-5],
            [7.456549e-2, 2.003823e-2, 5.121438e-3, 1.288508e-3],
        ],
    )?;
    figures.extend(study(
        0.49,
        [
            [1.676103e-2, 2.849298e-3, 3.667516e-4, 3.711537e-5],
            [1.114067e-1, 3.152678e-2, 7.787697e-3, 1.717520e-3],
        ],
    )?);
    Ok(figures)
}

pub fn locking() -> Measured {
    let wave = Wave {
        amplitude: [3.0, 2.0],
        number: [2.0, 3.0],
    };
    let study = |nu| -> Result<[f64; 2], String> {
        let [coarse, fine] = [16, 32].map(|cells| wave.errors(cells, nu));
        let [coarse, fine] = [coarse?.gradient, fine?.gradient];
        Ok([fine, libm::log2(coarse / fine)])
    };
    let found = [0.3, 0.4, 0.49, 0.499, 0.4999].map(study);
    let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
    let [errors, orders] = [0, 1].map(|k| found.iter().map(move |found| found[k]));
    Ok(figures! {
        "any ν: least observed order of the gradient" => at_least(least(orders), ORDERS_OF_ANY_NU[1]);
        "any ν: largest relative error of the gradient" => at_most(largest(errors), 0.03);
    })
}
