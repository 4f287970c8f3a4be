//! Manufactured solutions: orders of convergence, and locking as ν goes to ½.

use palpate::fem::Element;
use palpate::phantom::Material;

use super::problem::{Errors, Exact, Problem, assert_convergence, lame};

/// u = (A sin px sin qy, B cos px cos qy), with div u = (A p − B q) cos px sin qy, which vanishes for A = q, B = p.
struct Wave {
    amplitude: [f64; 2],
    number: [f64; 2],
}

impl Exact for Wave {
    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        [
            a * (p * x).sin() * (q * y).sin(),
            b * (p * x).cos() * (q * y).cos(),
        ]
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let ([a, b], [p, q]) = (self.amplitude, self.number);
        let ([sx, cx], [sy, cy]) = (
            [(p * x).sin(), (p * x).cos()],
            [(q * y).sin(), (q * y).cos()],
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
            share * p * (p * x).sin() * (q * y).sin() + mu * (p * p + q * q) * u[0],
            -share * q * (p * x).cos() * (q * y).cos() + mu * (p * p + q * q) * u[1],
        ]
    }

    /// Errors on a mesh of `cells` × `cells` cells of the unit square, bent so that every edge is curved and no
    /// element like another; the exact displacement is prescribed along the border.
    fn errors(&self, element: Element, cells: usize, poisson_ratio: f64) -> Errors {
        let material = Material {
            youngs_modulus: 1.0,
            poisson_ratio,
        };
        let bend = |[x, y]: [f64; 2]| {
            let turn = 2.0 * std::f64::consts::PI;
            [
                x + 0.06 * (turn * y).sin() + 0.04 * (turn * x).sin(),
                y + 0.08 * (turn * x).sin(),
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
        });
        problem.errors(&u, self)
    }
}

/// Cells along each side of the meshes. The stored errors on them are scikit-fem's (reference.py).
const CELLS: [usize; 4] = [4, 8, 16, 32];

fn check(element: Element, poisson_ratio: f64, order: f64, stored: [[f64; 4]; 2]) {
    let wave = Wave {
        amplitude: [1.0, -0.5],
        number: [2.0, 3.0],
    };
    let errors = CELLS.map(|cells| wave.errors(element, cells, poisson_ratio));
    let name = format!("{} at ν = {poisson_ratio}", element.name());
    assert_convergence(
        &format!("{name}, L2"),
        &errors.map(|e| e.displacement),
        &stored[0],
        order,
    );
    assert_convergence(
        &format!("{name}, H1"),
        &errors.map(|e| e.gradient),
        &stored[1],
        order - 1.0,
    );
}

// Verifies: FEM-053, FEM-062.
#[test]
fn triangles_converge_with_orders_3_and_2() {
    check(
        Element::T6,
        0.3,
        3.0,
        [
            [9.364223e-3, 1.178679e-3, 1.432481e-4, 1.753357e-5],
            [7.456549e-2, 2.003823e-2, 5.121438e-3, 1.288508e-3],
        ],
    );
    check(
        Element::T6,
        0.49,
        3.0,
        [
            [1.676103e-2, 2.849298e-3, 3.667516e-4, 3.711537e-5],
            [1.114067e-1, 3.152678e-2, 7.787697e-3, 1.717520e-3],
        ],
    );
}

// Verifies: FEM-053, FEM-062.
#[test]
fn quadrilaterals_converge_with_orders_2_and_1() {
    check(
        Element::Q4Full,
        0.3,
        2.0,
        [
            [6.871083e-2, 1.844815e-2, 4.710444e-3, 1.184856e-3],
            [2.491043e-1, 1.294257e-1, 6.528736e-2, 3.271421e-2],
        ],
    );
}

// Verifies: FEM-058.
#[test]
fn near_incompressibility_costs_triangles_one_order_and_quadrilaterals_all() {
    let wave = Wave {
        amplitude: [3.0, 2.0],
        number: [2.0, 3.0],
    };
    for nu in [0.3, 0.4, 0.49, 0.499, 0.4999] {
        let [triangles, quadrilaterals] = [Element::T6, Element::Q4Full].map(|element| {
            let [coarse, fine] = [16, 32].map(|cells| wave.errors(element, cells, nu).gradient);
            println!("{} at ν = {nu}: {coarse:.4e}, {fine:.4e}", element.name());
            (fine, (coarse / fine).log2())
        });
        // Quadratic triangles lose one order of their two at most, however near ν comes to ½ (I. Babuška and M. Suri,
        // Numerische Mathematik 62, 1992, on straight ones); linear quadrilaterals lose the only one they have.
        assert!(triangles.1 > 1.0, "ν = {nu}: {triangles:?}");
        assert!(triangles.0 < 0.03, "ν = {nu}: {triangles:?}");
        if nu == 0.4999 {
            assert!(
                quadrilaterals.1 < 0.3,
                "they no longer lock: {quadrilaterals:?}"
            );
        }
        if nu == 0.3 {
            assert!(quadrilaterals.1 > 0.9, "{quadrilaterals:?}");
        }
    }
}
