//! A circular inclusion in a far field: the strain inside is uniform (Eshelby).

use std::f64::consts::FRAC_PI_4;

use num_complex::Complex;
use palpate::phantom::Material;

use super::Measured;
use super::convergence::convergence;
use super::problem::{Errors, Exact, Field, Problem, lame, material};

/// A disc of radius 1 under the far stresses σ_xx = P + Q and σ_yy = P − Q.
///
/// With Kolosov's and Muskhelishvili's potentials, 2μ (u + iv) = κ φ − z φ̄' − ψ̄ and κ = 3 − 4ν, the field is
/// φ = P z/2 + A/z, ψ = −Q z + B/z + A/z³ outside and φ = D z, ψ = E z inside. Continuity of traction, φ + z φ̄' + ψ̄,
/// and of displacement on |z| = 1 gives, with Γ = μ_disc/μ,
///
/// A = Q (1 − Γ)/(1 + Γκ), E = A − Q, D = P Γ (κ + 1)/(2 (κ_disc − 1 + 2Γ)), B = 2D − P.
struct Disc {
    outside: Material,
    inside: Material,
    /// P and Q.
    far: [f64; 2],
}

/// 2μ and κ.
fn constants(material: &Material) -> [f64; 2] {
    [2.0 * lame(material).1, 3.0 - 4.0 * material.poisson_ratio]
}

impl Disc {
    /// A, B, D, E.
    fn coefficients(&self) -> [f64; 4] {
        let ([mu, kappa], [mu_disc, kappa_disc]) =
            (constants(&self.outside), constants(&self.inside));
        let ([p, q], ratio) = (self.far, mu_disc / mu);
        let a = q * (1.0 - ratio) / (1.0 + ratio * kappa);
        let d = p * ratio * (kappa + 1.0) / (2.0 * (kappa_disc - 1.0 + 2.0 * ratio));
        [a, 2.0 * d - p, d, a - q]
    }

    /// 2μ and κ at z, and there φ, φ', φ'', ψ, ψ'.
    fn potentials(&self, z: Complex<f64>) -> ([f64; 2], [Complex<f64>; 5]) {
        let ([a, b, d, e], [p, q]) = (self.coefficients(), self.far);
        let zero = Complex::from(0.0);
        if libm::hypot(z.re, z.im) < 1.0 {
            let potentials = [z * d, zero + d, zero, z * e, zero + e];
            return (constants(&self.inside), potentials);
        }
        let w = z.inv();
        let potentials = [
            z * 0.5 * p + w * a,
            -w * w * a + 0.5 * p,
            w.powi(3) * 2.0 * a,
            -z * q + w * b + w.powi(3) * a,
            -w * w * b - w.powi(4) * 3.0 * a - q,
        ];
        (constants(&self.outside), potentials)
    }
}

impl Exact for Disc {
    fn field(&self, [x, y]: [f64; 2]) -> Field {
        let z = Complex::new(x, y);
        let ([mu, kappa], [phi, slope, second, psi, psi_slope]) = self.potentials(z);
        let w = (phi * kappa - z * slope.conj() - psi.conj()) / mu;
        // With w = u + iv: ∂w/∂x = w_z + w_z̄ and ∂w/∂y = i (w_z − w_z̄).
        let along = (slope * kappa - slope.conj()) / mu;
        let across = -(z * second.conj() + psi_slope.conj()) / mu;
        let (by_x, by_y) = (along + across, (along - across) * Complex::i());
        ([w.re, w.im], [[by_x.re, by_y.re], [by_x.im, by_y.im]])
    }
}

/// Where a lattice point of the unit square goes on the quarter of a square of half-width 3, with the disc's quarter in
/// the lower left quarter of the lattice, as in the phantom's own mesh.
fn bend([s, t]: [f64; 2]) -> [f64; 2] {
    let (s, t) = (2.0 * s, 2.0 * t);
    let ring = s.max(t);
    if ring == 0.0 {
        return [0.0; 2];
    }
    let (sin, cos) = if s == 0.0 {
        (1.0, 0.0)
    } else if t <= s {
        libm::sincos(FRAC_PI_4 * t / s)
    } else {
        let (cos, sin) = libm::sincos(FRAC_PI_4 * s / t);
        (sin, cos)
    };
    // The square's point in the same direction of the lattice, and the circle's.
    let (square, circle) = ([s / ring, t / ring], [cos, sin]);
    [0, 1].map(|i| {
        if ring <= 1.0 {
            ring * ((1.0 - ring) * 0.7 * square[i] + ring * circle[i])
        } else {
            (2.0 - ring) * circle[i] + (ring - 1.0) * 3.0 * square[i]
        }
    })
}

/// Errors everywhere and inside the disc, on a lattice of 2n × 2n cells.
fn errors(disc: &Disc, n: usize) -> Measured<[Errors; 2]> {
    let material_at = |[s, t]: [f64; 2]| {
        if s.max(t) < 0.5 {
            disc.inside
        } else {
            disc.outside
        }
    };
    // Diagonals point to the disc's centre, so that no corner of its bent square is flat.
    let problem = Problem::lattice([2 * n, 2 * n], bend, |_| true, material_at);
    // Symmetry on the axes; the exact displacement, so no truncation, on the outer sides.
    let (u, _) = problem.solve(vec![0.0; 2 * problem.nodes.len()], |node, direction| {
        let at = problem.nodes[node];
        if at.contains(&3.0) {
            Some(disc.displacement(at)[direction])
        } else {
            (at[direction] == 0.0).then_some(0.0)
        }
    })?;
    let inside = problem.errors_in(&u, disc, |material| *material == disc.inside);
    Ok([problem.errors(&u, disc), inside])
}

pub fn disc() -> Measured {
    // The moduli of gel and inclusion; pull along x and half as much push along y.
    let disc = Disc {
        outside: material(5e3, 0.49),
        inside: material(1.2e6, 0.49),
        far: [250.0, 750.0],
    };
    let solve = |n| errors(&disc, n);
    let solved = [solve(4)?, solve(8)?, solve(16)?, solve(32)?];
    let mut figures = convergence("disc", &solved.map(|[all, _]| all))?;
    // The uniform strain and stress inside, point by point in the mean square.
    figures.extend(convergence(
        "within the disc",
        &solved.map(|[_, inside]| inside),
    )?);
    Ok(figures)
}
