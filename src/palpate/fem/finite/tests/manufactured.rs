//! A manufactured solution: errors of displacement, gradient and pressure on finer and finer meshes.
//!
//! The exact displacement is 0 on floor and walls. Body forces and the traction on top follow from the first Piola stress, which is
//! derived from FIN-001 by hand: P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ + 4 C₂₀ (I₁ − 3) F + E_f/2 (I₄ − 1) F a aᵀ.

use faer::Col;
use faer::linalg::solvers::Solve;
use nalgebra::{Matrix2, Vector2};

use super::super::system::System;
use super::{lattice, long, pressure_unknowns, rich};
use crate::fem::Mesh;
use crate::fem::element::{CORNERS, NODES, PerNode, gradients, parent_gradients, shapes};
use crate::phantom::{Material, Strain};

/// Points and weights of Gauss and Legendre on (0, 1), exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// u at a place of the square |x| < ½, −1 < y < 0, m: the curl of ψ = 0.02 cos²(πx) (1 + y)², and a dilation. It is 0 on floor and
/// walls; shears are 0.4, J is 1 ± 0.1.
fn displacement(at: Vector2<f64>) -> Vector2<f64> {
    let (across, height) = (libm::cos(PI * at.x), at.y + 1.0);
    let curl = Vector2::new(
        0.04 * across * across * height,
        0.02 * PI * libm::sin(2.0 * PI * at.x) * height * height,
    );
    curl - Vector2::y() * (0.02 * across * libm::sin(0.5 * PI * height))
}

const PI: f64 = std::f64::consts::PI;

/// The central difference of sixth order: (π h)⁶/140 = 7e-12 of truncation for waves of this length, 1e-13 of rounding.
fn slope<T>(of: impl Fn(f64) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let h = 0.01;
    let odd = |k: f64| of(k * h) - of(-k * h);
    (odd(1.0) * 45.0 - odd(2.0) * 9.0 + odd(3.0)) * (1.0 / (60.0 * h))
}

fn gradient(at: Vector2<f64>) -> Matrix2<f64> {
    let along = |axis: Vector2<f64>| slope(|step| displacement(at + axis * step));
    Matrix2::from_columns(&[along(Vector2::x()), along(Vector2::y())])
}

/// Lamé's λ times ln J, Pa.
fn pressure(material: &Material, at: Vector2<f64>) -> f64 {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    lambda * libm::log((Matrix2::identity() + gradient(at)).determinant())
}

/// The first Piola stress, Pa.
fn piola(material: &Material, at: Vector2<f64>) -> Matrix2<f64> {
    let mu = material.youngs_modulus / (2.0 * (1.0 + material.poisson_ratio));
    let f = Matrix2::identity() + gradient(at);
    let inverse = f.try_inverse().unwrap().transpose();
    let angle = material.fibre_angle_deg.to_radians();
    let fibres = Vector2::new(libm::cos(angle), libm::sin(angle));
    let stretched = f * fibres;
    let (i1, i4) = (f.norm_squared() + 1.0, stretched.norm_squared());
    (f - inverse) * mu
        + inverse * pressure(material, at)
        + f * (4.0 * material.yeoh_c20 * (i1 - 3.0))
        + stretched * fibres.transpose() * (0.5 * material.fibre_modulus * (i4 - 1.0))
}

/// −Div P, N/m³.
fn body_force(material: &Material, at: Vector2<f64>) -> Vector2<f64> {
    let [x, y] = [Vector2::x(), Vector2::y()]
        .map(|axis| slope(|step| piola(material, at + axis * step)) * axis);
    -(x + y)
}

/// A point of an element under a rule much finer than the law's own: the square of Gauss folded onto the triangle.
struct Point {
    at: Vector2<f64>,
    shapes: [f64; NODES],
    gradients: PerNode,
    corners: [f64; CORNERS],
    area: f64,
}

fn fine(positions: &[[f64; 2]]) -> impl Iterator<Item = Point> {
    let pairs = GAUSS.iter().flat_map(|a| GAUSS.iter().map(move |b| (a, b)));
    pairs.map(move |(&(a, wa), &(b, wb))| {
        let [r, s] = [a, b * (1.0 - a)];
        let g = gradients(&parent_gradients([r, s]), positions);
        let shapes = shapes([r, s]);
        Point {
            at: positions
                .iter()
                .zip(shapes)
                .map(|(&x, n)| Vector2::from(x) * n)
                .sum(),
            shapes,
            gradients: g.of_node,
            corners: [1.0 - r - s, r, s],
            area: wa * wb * (1.0 - a) * g.jacobian,
        }
    })
}

/// The forces of the body force and of the traction on top, by unknown.
fn loads(mesh: &Mesh, system: &System, material: &Material) -> Vec<f64> {
    let mut loads = vec![0.0; system.unknowns()];
    let mut add = |node: usize, force: Vector2<f64>| {
        for k in 0..2 {
            if let Some(unknown) = system.unknown(node, k) {
                loads[unknown] += force[k];
            }
        }
    };
    for nodes in mesh.elements() {
        for point in fine(&mesh.positions(nodes)) {
            let force = body_force(material, point.at) * point.area;
            for (&node, n) in nodes.iter().zip(point.shapes) {
                add(node as usize, force * n);
            }
        }
    }
    for edge in mesh.surface.windows(3).step_by(2) {
        let [left, right] = [edge[0], edge[2]].map(|node| mesh.nodes[node][0]);
        for (t, weight) in GAUSS {
            let at = Vector2::new(left + t * (right - left), 0.0);
            let force = piola(material, at) * Vector2::y() * (weight * (right - left));
            let shapes = [
                (1.0 - t) * (1.0 - 2.0 * t),
                4.0 * t * (1.0 - t),
                t * (2.0 * t - 1.0),
            ];
            for (&node, n) in edge.iter().zip(shapes) {
                add(node, force * n);
            }
        }
    }
    loads
}

/// The state that balances `loads`, by Newton's method from rest in four parts, with one surface node in the probe's place.
fn balanced(mesh: &Mesh, system: &System, loads: &[f64]) -> Vec<f64> {
    let first = system
        .unknown(mesh.surface[mesh.surface.len() / 2], 0)
        .unwrap();
    let largest = |forces: &[f64]| forces.iter().fold(0.0f64, |most, f| most.max(f.abs()));
    let mut state = vec![0.0; system.unknowns()];
    for part in [0.25, 0.5, 0.75, 1.0] {
        for iteration in 0.. {
            let mut equations = system.equations(&state).unwrap();
            for (force, load) in equations.forces.iter_mut().zip(loads) {
                *force -= part * load;
            }
            if largest(&equations.forces) < 1e-10 * largest(loads) {
                break;
            }
            assert!(iteration < 12, "{}", largest(&equations.forces));
            let condensed = system
                .condense(&equations, first..first + 2)
                .unwrap()
                .unwrap();
            let held = Col::from_fn(2, |k| -condensed.forces[k]);
            let moved = condensed.stiffness.partial_piv_lu().solve(held);
            let changes = condensed
                .changes(&equations, &[moved[0], moved[1]], &[0.0; 2])
                .unwrap();
            state.iter_mut().zip(changes).for_each(|(z, dz)| *z += dz);
        }
    }
    state
}

/// The errors of displacement, gradient and pressure in L2, each over the size of what it is the error of.
fn errors(cells: usize, material: &Material) -> [f64; 3] {
    let phantom = long(1.0).changed(|parts| {
        parts.strain = Strain::Finite;
        parts.layers.remove(0);
        parts.layers[0].material = *material;
    });
    let phantom = phantom.unwrap();
    // Bent inside, straight at the border, where the displacement is known.
    let mesh = lattice([cells, cells], |[x, y]| {
        let bend = 0.06 * libm::sin(PI * x) * libm::sin(PI * y);
        [
            x - 0.5 + bend * libm::cos(2.0 * PI * y),
            y - 1.0 + bend * libm::cos(3.0 * PI * x),
        ]
    });
    let system = System::new(&mesh, &phantom).unwrap();
    let state = balanced(&mesh, &system, &loads(&mesh, &system, material));
    let pressures = pressure_unknowns(&system);
    let (mut wrong, mut whole) = ([0.0; 3], [0.0; 3]);
    for (nodes, pressures) in mesh.elements().zip(pressures.chunks(CORNERS)) {
        let u = nodes
            .iter()
            .map(|&node| Vector2::from(system.displacement(&state, node as usize)));
        let u: Vec<Vector2<f64>> = u.collect();
        for point in fine(&mesh.positions(nodes)) {
            let exact = displacement(point.at);
            let slopes = gradient(point.at);
            let p = pressure(material, point.at);
            let here: Vector2<f64> = u.iter().zip(point.shapes).map(|(u, n)| u * n).sum();
            let slopes_here: Matrix2<f64> = u
                .iter()
                .zip(point.gradients.column_iter())
                .map(|(u, g)| u * g.transpose())
                .sum();
            let p_here: f64 = pressures
                .iter()
                .zip(point.corners)
                .map(|(&k, n)| n * state[k])
                .sum();
            let squares = [
                [(here - exact).norm_squared(), exact.norm_squared()],
                [(slopes_here - slopes).norm_squared(), slopes.norm_squared()],
                [(p_here - p) * (p_here - p), p * p],
            ];
            for (k, [error, size]) in squares.into_iter().enumerate() {
                wrong[k] += error * point.area;
                whole[k] += size * point.area;
            }
        }
    }
    std::array::from_fn(|k| libm::sqrt(wrong[k] / whole[k]))
}

// Verifies: FIN-001, FIN-002, FIN-003.
#[test]
fn errors_fall_by_the_orders_of_the_element() {
    let gels = [
        Material::isotropic(5e3, 0.45),
        Material::isotropic(5e3, 0.49),
        rich(),
    ];
    for material in gels {
        let [before, finest] = [8, 16].map(|cells| errors(cells, &material));
        // Taylor and Hood's orders, less a tenth for meshes that are still coarse.
        for (k, order) in [3.0, 2.0, 2.0].into_iter().enumerate() {
            let observed = libm::log2(before[k] / finest[k]);
            println!("{observed:.2}, {:.1e}", finest[k]);
            assert!(observed > order - 0.1, "{material:?}: {k}: {observed}");
        }
        assert!(
            finest[0] < 1e-3 && finest[1] < 1e-2 && finest[2] < 1e-2,
            "{finest:?}"
        );
    }
}
