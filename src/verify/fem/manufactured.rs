//! Manufactured solutions: orders of convergence, and locking as ν goes to ½.

use crate::fem::Element;
use crate::phantom::Material;

use super::convergence::convergence;
use super::problem::{Errors, Exact, Problem, lame};
use super::{Check, Figure, Figures, largest, least};

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
    fn errors(&self, element: Element, cells: usize, poisson_ratio: f64) -> Result<Errors, String> {
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
            element,
            [cells, cells],
            bend,
            |[x, y]| (x > 0.5) == (y > 0.5),
            |_| material,
        );
        let flat = Problem::lattice(element, [cells, cells], |at| at, |_| true, |_| material);
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

/// A convergence study with the least orders and the stored errors of displacement and gradient.
fn study(element: Element, poisson_ratio: f64, orders: [f64; 2], stored: [[f64; 4]; 2]) -> Figures {
    let wave = Wave {
        amplitude: [1.0, -0.5],
        number: [2.0, 3.0],
    };
    let [a, b, c, d] = CELLS.map(|cells| wave.errors(element, cells, poisson_ratio));
    let errors = [a?, b?, c?, d?];
    let name = format!("{} at ν = {poisson_ratio}", element.name());
    let [displacement, gradient] = stored;
    let mut figures = convergence(
        &format!("{name}, displacement"),
        errors.map(|e| e.displacement),
        displacement,
        orders[0],
    );
    figures.extend(convergence(
        &format!("{name}, gradient"),
        errors.map(|e| e.gradient),
        gradient,
        orders[1],
    ));
    Ok(figures)
}

/// Orders of the triangles.
pub const TRIANGLES: Check = Check {
    name: "fem.manufactured_t6",
    claim: "On four bent meshes t6 converges to a manufactured solution with the orders 3 (displacement) and 2 \
            (gradient), at ν = 0.3 and 0.49, with the errors that scikit-fem has on the same meshes.",
    requirements: &["FEM-053", "FEM-062"],
    repeatable: true,
    run: triangles,
};

fn triangles() -> Figures {
    let mut figures = study(
        Element::T6,
        0.3,
        [2.9, 1.9],
        [
            [9.364223e-3, 1.178679e-3, 1.432481e-4, 1.753357e-5],
            [7.456549e-2, 2.003823e-2, 5.121438e-3, 1.288508e-3],
        ],
    )?;
    figures.extend(study(
        Element::T6,
        0.49,
        [2.9, 1.9],
        [
            [1.676103e-2, 2.849298e-3, 3.667516e-4, 3.711537e-5],
            [1.114067e-1, 3.152678e-2, 7.787697e-3, 1.717520e-3],
        ],
    )?);
    Ok(figures)
}

/// Orders of the quadrilaterals.
pub const QUADRILATERALS: Check = Check {
    name: "fem.manufactured_q4",
    claim: "On four bent meshes q4-full converges to a manufactured solution with the orders 2 (displacement) and 1 \
            (gradient) at ν = 0.3, with the errors that scikit-fem has on the same meshes.",
    requirements: &["FEM-053", "FEM-062"],
    repeatable: true,
    run: quadrilaterals,
};

fn quadrilaterals() -> Figures {
    study(
        Element::Q4Full,
        0.3,
        [1.9, 0.9],
        [
            [6.871083e-2, 1.844815e-2, 4.710444e-3, 1.184856e-3],
            [2.491043e-1, 1.294257e-1, 6.528736e-2, 3.271421e-2],
        ],
    )
}

/// What near incompressibility costs.
pub const LOCKING: Check = Check {
    name: "fem.manufactured_locking",
    claim: "From ν = 0.3 to 0.4999 the gradient of t6 keeps an order of at least 1 on a field that is almost free of \
            divergence, while q4-full loses its order.",
    requirements: &["FEM-058"],
    repeatable: true,
    run: locking,
};

fn locking() -> Figures {
    let wave = Wave {
        amplitude: [3.0, 2.0],
        number: [2.0, 3.0],
    };
    let study = |element, nu| -> Result<(f64, f64), String> {
        let [coarse, fine] = [16, 32].map(|cells| wave.errors(element, cells, nu));
        let [coarse, fine] = [coarse?.gradient, fine?.gradient];
        Ok((fine, libm::log2(coarse / fine)))
    };
    let triangles = [0.3, 0.4, 0.49, 0.499, 0.4999].map(|nu| study(Element::T6, nu));
    let triangles = triangles.into_iter().collect::<Result<Vec<_>, _>>()?;
    let (_, free) = study(Element::Q4Full, 0.3)?;
    let (_, locked) = study(Element::Q4Full, 0.4999)?;
    // Quadratic triangles lose one order of their two at most, however near ν comes to ½ (I. Babuška and M. Suri,
    // Numerische Mathematik 62, 1992, on straight ones); linear quadrilaterals lose the only one they have.
    Ok(vec![
        Figure::at_least(
            "t6, any ν: least observed order of the gradient",
            least(triangles.iter().map(|(_, order)| *order)),
            1.0,
        ),
        Figure::at_most(
            "t6, any ν: largest relative error of the gradient",
            largest(triangles.iter().map(|(error, _)| *error)),
            0.03,
        ),
        Figure::at_least(
            "q4-full at ν = 0.3: observed order of the gradient",
            free,
            0.9,
        ),
        Figure::at_most(
            "q4-full at ν = 0.4999: observed order of the gradient",
            locked,
            0.3,
        ),
    ])
}
