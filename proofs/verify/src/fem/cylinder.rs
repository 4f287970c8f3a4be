//! A thick-walled cylinder under internal pressure (Lamé).

use std::f64::consts::FRAC_PI_2;

use palpate::phantom::Material;

use super::convergence::convergence;
use super::problem::{Errors, Exact, Field, Problem, material};
use super::{Measured, largest};

/// Inner radius a and outer radius b under the pressure 1 inside:
///
/// u_r = (1 + ν) a² ((1 − 2ν) r + b²/r) / (E (b² − a²)), σ_r, σ_θ = a²/(b² − a²) (1 ∓ b²/r²).
struct Cylinder {
    radii: [f64; 2],
    material: Material,
}

impl Cylinder {
    /// u_r = linear · r + inverse / r.
    fn coefficients(&self) -> [f64; 2] {
        let [a, b] = self.radii.map(|r| r * r);
        let nu = self.material.poisson_ratio;
        let share = (1.0 + nu) * a / (self.material.youngs_modulus * (b - a));
        [share * (1.0 - 2.0 * nu), share * b]
    }

    /// A quarter of the ring, with `cells` (along the radius, around), cell borders at the fractions `border` of the wall.
    fn quarter(&self, cells: [usize; 2], border: impl Fn(f64) -> f64) -> Problem {
        let [a, b] = self.radii;
        Problem::lattice(
            cells,
            |[s, t]| {
                let (r, angle) = (a + (b - a) * border(s), FRAC_PI_2 * t);
                // The edges on the axes exactly, so that they are found.
                let (sin, cos) = if t == 1.0 {
                    (1.0, 0.0)
                } else {
                    libm::sincos(angle)
                };
                [r * cos, r * sin]
            },
            |_| true,
            |_| self.material,
        )
    }

    /// Displacements of a quarter that is free to slide along both axes.
    fn solve(&self, problem: &Problem) -> Measured<Vec<f64>> {
        let mut loads = vec![0.0; 2 * problem.nodes.len()];
        let inner = self.radii[0] * (1.0 + 1e-9);
        // The pressure 1 pushes against the outward normal.
        problem.add_traction(
            &mut loads,
            |[x, y]| libm::hypot(x, y) < inner,
            |_, n| n.map(|c| -c),
        );
        let on_axis = |node: usize, direction: usize| problem.nodes[node][direction] == 0.0;
        let (u, _) = problem.solve(loads, |node, direction| {
            on_axis(node, direction).then_some(0.0)
        })?;
        Ok(u)
    }
}

impl Exact for Cylinder {
    fn field(&self, [x, y]: [f64; 2]) -> Field {
        let [linear, inverse] = self.coefficients();
        let square = x * x + y * y;
        let (even, odd) = (
            inverse * (y * y - x * x) / (square * square),
            -2.0 * inverse * x * y / (square * square),
        );
        let displacement = [x, y].map(|c| c * (linear + inverse / square));
        (displacement, [[linear + even, odd], [odd, linear - even]])
    }
}

pub fn pressed() -> Measured {
    let cylinder = Cylinder {
        radii: [1.0, 2.0],
        material: material(1000.0, 0.49),
    };
    let solve = |n: usize| -> Measured<Errors> {
        let problem = cylinder.quarter([n, 2 * n], |s| s);
        Ok(problem.errors(&cylinder.solve(&problem)?, &cylinder))
    };
    let errors = [solve(2)?, solve(4)?, solve(8)?, solve(16)?, solve(32)?];
    convergence("cylinder", &errors)
}

/// Displacement of the inner radius over the exact one, on the cylinder and mesh of R. H. MacNeal and R. L. Harder's
/// standard set (Finite Elements in Analysis and Design 1, 1985): radii 3 and 9, cells of 10°, walls between 3, 3.5,
/// 4.2, 5.2, 6.75 and 9.
fn standard_ratio(nu: f64) -> Measured<f64> {
    let borders = [3.0, 3.5, 4.2, 5.2, 6.75, 9.0];
    let cylinder = Cylinder {
        radii: [3.0, 9.0],
        material: material(1000.0, nu),
    };
    let problem = cylinder.quarter([5, 9], |s| {
        let cell = (5.0 * s).floor().min(4.0);
        let [inner, outer] = [0, 1].map(|k| borders[cell as usize + k]);
        (inner + (5.0 * s - cell) * (outer - inner) - 3.0) / 6.0
    });
    let u = cylinder.solve(&problem)?;
    let inside = problem.nodes.iter().position(|&at| at == [3.0, 0.0]);
    let inside = inside.ok_or("no node at the inner radius")?;
    Ok(u[2 * inside] / cylinder.displacement([3.0, 0.0])[0])
}

pub fn locking() -> Measured {
    let worst = |ratios: &[f64]| -> Measured<f64> {
        let off = ratios
            .iter()
            .map(|&nu| Ok((standard_ratio(nu)? - 1.0).abs()));
        Ok(largest(off.collect::<Measured<Vec<_>>>()?))
    };
    // Triangles with curved edges lose some per cent on this coarse mesh at the very end.
    Ok(figures! {
        "ν to 0.49: largest relative error of the displacement" => at_most(worst(&[0.3, 0.4, 0.49])?, 0.004);
        "ν beyond: largest relative error of the displacement" => at_most(worst(&[0.499, 0.4999])?, 0.04);
    })
}
