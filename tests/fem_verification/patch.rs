//! Patch test and zero-energy modes.

use nalgebra::DMatrix;
use palpate::fem::Element;
use palpate::fem::element::StiffnessRule;
use palpate::phantom::Material;

use super::problem::{Exact, Problem, lame};

const ELEMENTS: [Element; 2] = [Element::T6, Element::Q4Full];
const NEARLY_INCOMPRESSIBLE: Material = Material {
    youngs_modulus: 1.0,
    poisson_ratio: 0.49,
};

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

/// A lattice of 4 × 4 cells of size 1 with every corner moved by up to 0.2. Triangles have their middle nodes half-way
/// between the corners, moved on by up to `curve` in each direction.
fn distorted(element: Element, curve: f64) -> Problem {
    let mut problem = Problem::lattice(
        element,
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
    for nodes in problem.elements.iter().filter(|nodes| nodes.len() == 6) {
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

const LINEAR: Polynomial = Polynomial {
    linear: [[0.7, -1.1], [0.4, 0.9]],
    quadratic: [[0.0; 3]; 2],
};
const QUADRATIC: Polynomial = Polynomial {
    linear: [[0.7, -1.1], [0.4, 0.9]],
    quadratic: [[0.3, -0.2, 0.1], [-0.1, 0.2, 0.4]],
};

impl Exact for Polynomial {
    fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let ([a, b], [xx, xy, yy]) = (self.linear[i], self.quadratic[i]);
            a * x + b * y + xx * x * x + xy * x * y + yy * y * y
        })
    }

    fn gradient(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|i| {
            let ([a, b], [xx, xy, yy]) = (self.linear[i], self.quadratic[i]);
            [a + 2.0 * xx * x + xy * y, b + xy * x + 2.0 * yy * y]
        })
    }
}

/// The largest relative error, of displacement, gradient or stress, with the exact displacement along the border and
/// the exact body force, which is constant.
fn worst_error(problem: &Problem, exact: &Polynomial) -> f64 {
    let lattice = Problem::lattice(
        problem.element,
        [4, 4],
        |at| at,
        |_| true,
        |_| NEARLY_INCOMPRESSIBLE,
    );
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
    });
    let errors = problem.errors(&u, exact);
    println!("{:?}: {errors:?}", problem.element);
    errors.displacement.max(errors.gradient).max(errors.stress)
}

/// Rounding of the solve: the matrix's condition, some 16 cells² times the ratio of the moduli (λ + 2μ)/μ = 51 at
/// ν = 0.49, so 10³, times 1.1e-16; stresses multiply the strains' errors by λ/μ = 49 once more.
const ROUNDING: f64 = 1e-11;

// Verifies: FEM-050.
#[test]
fn linear_fields_are_exact_on_any_mesh() {
    // On curved edges too: J⁻¹ det J ∇N is a polynomial of degree 2 (of degree 1 in each coordinate on the quadrilateral),
    // which both rules integrate exactly, so that the internal forces of a constant stress are in balance.
    for element in ELEMENTS {
        for curve in [0.0, 0.08] {
            let worst = worst_error(&distorted(element, curve), &LINEAR);
            assert!(worst < ROUNDING, "{element:?}, bent by {curve}: {worst:e}");
        }
    }
}

// Verifies: FEM-051.
#[test]
fn quadratic_fields_are_exact_on_straight_triangles() {
    let worst = worst_error(&distorted(Element::T6, 0.0), &QUADRATIC);
    assert!(worst < ROUNDING, "{worst:e}");
    // Neither a curved triangle nor a quadrilateral holds them: the test can see the difference.
    for problem in [
        distorted(Element::T6, 0.08),
        distorted(Element::Q4Full, 0.0),
    ] {
        let worst = worst_error(&problem, &QUADRATIC);
        assert!(worst > 1e-3, "{:?}: {worst:e}", problem.element);
    }
}

/// Eigenvalues of a stiffness, ascending.
fn eigenvalues(matrix: DMatrix<f64>) -> Vec<f64> {
    let mut values = matrix.symmetric_eigenvalues().as_slice().to_vec();
    values.sort_by(f64::total_cmp);
    values
}

/// Asserts that three eigenvalues are zero and no other one is.
///
/// Zeros come out within 10² roundings of the largest, which goes as λ + 2μ. The smallest deformation's goes as μ
/// times (size of an element/size of the mesh)², so at least 1e-2/51 of the largest for one element and 1e-5 for a mesh.
fn assert_three_zeros(what: &str, values: &[f64], least: f64) {
    let largest = values.last().unwrap();
    println!("{what}: {:?} of {largest:.3}", &values[..5]);
    for (k, value) in values.iter().enumerate() {
        if k < 3 {
            assert!(
                value.abs() < 1e-14 * largest,
                "{what}: eigenvalue {k} is {value:e}"
            );
        } else {
            assert!(
                *value > least * largest,
                "{what}: eigenvalue {k} is {value:e}"
            );
        }
    }
}

// Verifies: FEM-052.
#[test]
fn only_rigid_motions_cost_no_energy() {
    for element in ELEMENTS {
        for curve in [0.0, 0.08] {
            let problem = distorted(element, curve);
            let rule = StiffnessRule::new(element);
            for nodes in &problem.elements {
                let positions: Vec<_> = nodes.iter().map(|&k| problem.nodes[k]).collect();
                let stiffness = rule.integrate(&positions, &NEARLY_INCOMPRESSIBLE).unwrap();
                let n = 2 * nodes.len();
                let matrix = DMatrix::from_fn(n, n, |i, j| stiffness[i][j]);
                assert_three_zeros("element", &eigenvalues(matrix), 1e-4);
            }
            let n = 2 * problem.nodes.len();
            let mut matrix = DMatrix::zeros(n, n);
            problem.visit(|row, column, value| matrix[(row, column)] += value);
            assert_three_zeros("mesh", &eigenvalues(matrix), 1e-5);
        }
    }
}
