//! Patch test and zero-energy modes.

use faer::{Mat, Side};

use palpate::fem::element::{NODES, StiffnessRule};
use palpate::phantom::{Geometry, Material};

use super::problem::{Exact, Field, Problem, inside_out, lame, material};
use super::{Figure, Measured, largest, least};

/// How far edges are bent: not at all, or so far that elements lose what straight ones can do.
const CURVES: [f64; 2] = [0.0, 0.08];
const NEARLY_INCOMPRESSIBLE: Material = material(1.0, 0.49);

/// Numbers that look random in (−1, 1), the same in each run (Knuth's 64-bit linear congruence).
fn noise() -> impl FnMut() -> f64 {
    let mut state = 1u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A lattice of 4 × 4 cells of size 1 with every corner moved by up to 0.2, and middle nodes half-way between the corners,
/// moved on by up to `curve` in each direction.
fn distorted(curve: f64) -> Problem {
    let mut problem = Problem::lattice(
        [4, 4],
        |at| at.map(|c| 4.0 * c),
        |[x, y]| (x > 0.5) == (y > 0.5),
        |_| NEARLY_INCOMPRESSIBLE,
    );
    let mut noise = noise();
    for node in &mut problem.nodes {
        *node = node.map(|c| c + 0.2 * noise());
    }
    let mut bent = vec![false; problem.nodes.len()];
    for nodes in &problem.elements {
        for (middle, [a, b]) in [(3, [0, 1]), (4, [1, 2]), (5, [2, 0])] {
            if !std::mem::replace(&mut bent[nodes[middle]], true) {
                let [a, b] = [a, b].map(|k| problem.nodes[nodes[k]]);
                problem.nodes[nodes[middle]] =
                    [0, 1].map(|i| 0.5 * (a[i] + b[i]) + curve * noise());
            }
        }
    }
    problem
}

/// u_i = G_i0 x + G_i1 y + Q_i0 x² + Q_i1 xy + Q_i2 y².
struct Polynomial {
    linear: [[f64; 2]; 2],
    quadratic: [[f64; 3]; 2],
}

const LINEAR_FIELD: Polynomial = Polynomial {
    linear: [[0.7, -1.1], [0.4, 0.9]],
    quadratic: [[0.0; 3]; 2],
};
const QUADRATIC_FIELD: Polynomial = Polynomial {
    linear: [[0.7, -1.1], [0.4, 0.9]],
    quadratic: [[0.3, -0.2, 0.1], [-0.1, 0.2, 0.4]],
};

impl Exact for Polynomial {
    fn field(&self, [x, y]: [f64; 2]) -> Field {
        let component = |i: usize| {
            let ([a, b], [xx, xy, yy]) = (self.linear[i], self.quadratic[i]);
            let u = a * x + b * y + xx * x * x + xy * x * y + yy * y * y;
            (u, [a + 2.0 * xx * x + xy * y, b + xy * x + 2.0 * yy * y])
        };
        let [(u, of_u), (v, of_v)] = [0, 1].map(component);
        ([u, v], [of_u, of_v])
    }
}

/// The largest relative error, of displacement, gradient or stress, with the exact displacement along the border and
/// the exact body force, which is constant.
fn worst_error(problem: &Problem, exact: &Polynomial) -> Measured<f64> {
    let lattice = Problem::lattice([4, 4], |at| at, |_| true, |_| NEARLY_INCOMPRESSIBLE);
    let border = |node: usize| lattice.nodes[node].iter().any(|&c| c == 0.0 || c == 1.0);
    let (lambda, mu) = lame(&NEARLY_INCOMPRESSIBLE);
    let [[xx, xy, yy], [vxx, vxy, vyy]] = exact.quadratic;
    // f = −(λ + μ) ∇ div u − μ Δu.
    let force = [
        -(lambda + mu) * (2.0 * xx + vxy) - 2.0 * mu * (xx + yy),
        -(lambda + mu) * (xy + 2.0 * vyy) - 2.0 * mu * (vxx + vyy),
    ];
    let (u, _) = problem.solve(problem.body_loads(|_| force), |node, direction| {
        border(node).then(|| exact.displacement(problem.nodes[node])[direction])
    })?;
    let errors = problem.errors(&u, exact);
    Ok(largest([
        errors.displacement,
        errors.gradient,
        errors.stress,
    ]))
}

/// Rounding of the solve: the matrix's condition, some 16 cells² times the ratio of the moduli (λ + 2μ)/μ = 51 at
/// ν = 0.49, so 10³, times 1.1e-16; stresses multiply the strains' errors by λ/μ = 49 once more.
const ROUNDING: f64 = 1e-11;

pub fn linear() -> Measured {
    // On curved edges too: J⁻¹ det J ∇N is a polynomial of degree 2, which the rule integrates exactly, so that the internal
    // forces of a constant stress are in balance.
    let figure = |curve| {
        let worst = worst_error(&distorted(curve), &LINEAR_FIELD)?;
        let what = format!("bent by {curve}: largest relative error");
        Ok(Figure::at_most(what, worst, ROUNDING))
    };
    CURVES.into_iter().map(figure).collect()
}

pub fn quadratic() -> Measured {
    let [straight, curved] = CURVES.map(|curve| worst_error(&distorted(curve), &QUADRATIC_FIELD));
    // The check can see the difference.
    Ok(figures! {
        "straight: largest relative error" => at_most(straight?, ROUNDING);
        "curved: largest relative error, which must show" => at_least(curved?, 1e-3);
    })
}

/// The share of the largest eigenvalue of a stiffness that the largest of the three least has by magnitude, and
/// that the fourth has.
///
/// Zeros come out within 10² roundings of the largest, which goes as λ + 2μ. The smallest deformation's goes as μ
/// times (size of an element/size of the mesh)², so at least 1e-2/51 of the largest for one element and 1e-5 for a mesh.
fn shares(matrix: Mat<f64>) -> Measured<[f64; 2]> {
    let values = matrix.self_adjoint_eigenvalues(Side::Lower);
    let values = values.map_err(|error| format!("no eigenvalues: {error:?}"))?;
    let greatest = values[values.len() - 1];
    Ok([
        largest(values[..3].iter().map(|value| value.abs())) / greatest,
        least(values[3..].iter().copied()) / greatest,
    ])
}

/// The figures of stiffnesses whose eigenvalues have these shares: three zeros, and no other one.
fn three_zeros(what: &str, shares: &[[f64; 2]], allowed: f64) -> Vec<Figure> {
    let [zero, other] = [0, 1].map(|k| shares.iter().map(move |share| share[k]));
    figures! {
        "{what}: largest of the three least eigenvalues, over the largest" => at_most(largest(zero), 1e-14);
        "{what}: least of the other eigenvalues, over the largest" => at_least(least(other), allowed);
    }
}

pub fn rigid() -> Measured {
    let mut figures = Vec::new();
    let rule = StiffnessRule::default();
    for curve in CURVES {
        let problem = distorted(curve);
        let mut elements = Vec::new();
        for nodes in &problem.elements {
            let stiffness = rule
                .integrate(
                    &problem.positions(nodes),
                    &NEARLY_INCOMPRESSIBLE,
                    Geometry::Plane,
                )
                .map_err(inside_out)?;
            let matrix = Mat::from_fn(2 * NODES, 2 * NODES, |i, j| stiffness[(i, j)]);
            elements.push(shares(matrix)?);
        }
        let n = 2 * problem.nodes.len();
        let mut matrix = Mat::zeros(n, n);
        problem.visit(|row, column, value| matrix[(row, column)] += value)?;
        let what = |part: &str| format!("{part}, bent by {curve}");
        figures.extend(three_zeros(&what("elements"), &elements, 1e-4));
        figures.extend(three_zeros(&what("mesh"), &[shares(matrix)?], 1e-5));
    }
    Ok(figures)
}
