//! Contact solved over all unknowns at once, to compare with the condensed contact.

use faer::sparse::Triplet;
use palpate::fem::{Contact, Mesh, Model, Pose};
use palpate::force_map::ForceMap;
use palpate::phantom::Phantom;

use super::problem::{Problem, solved};
use super::{Figure, Measured, largest};

/// A contact point: its position, and the nodes of its edge with their weights.
type Point = ([f64; 2], [(f64, usize); 3]);

/// A phantom with the displacements of all its nodes, from the element stiffnesses alone.
struct Full {
    phantom: Phantom,
    contact: Contact,
    /// Whether a displacement is free, two for each node.
    free: Vec<bool>,
    /// The stiffness of the free displacements, and ones for those that are held.
    entries: Vec<Triplet<usize, usize, f64>>,
    /// The contact points from left to right.
    surface: Vec<Point>,
}

/// Forces on the probe (F_x, F_n) with the displacements of the surface.
struct Solved {
    force: [f64; 2],
    surface: Vec<[f64; 2]>,
}

impl Full {
    fn new(phantom: &Phantom, size: f64, contact: Contact) -> Measured<Full> {
        let mesh = Mesh::new(phantom, size)?;
        let free: Vec<bool> = mesh.held.as_flattened().iter().map(|held| !held).collect();
        let regions = mesh.regions.iter();
        let problem = Problem {
            nodes: mesh.nodes.clone(),
            elements: mesh
                .elements()
                .map(|nodes| std::array::from_fn(|k| nodes[k] as usize))
                .collect(),
            materials: regions.map(|region| *region.material(phantom)).collect(),
        };
        let held = (0..free.len()).filter(|&k| !free[k]);
        let mut entries: Vec<_> = held.map(|k| Triplet::new(k, k, 1.0)).collect();
        problem.visit(|row, column, value| {
            if free[row] && free[column] {
                entries.push(Triplet::new(row, column, phantom.probe().length * value));
            }
        })?;
        // Two Gauss points on each edge of three nodes, with the parabolas of its nodes.
        let g = 1.0 / 3f64.sqrt();
        let mut nodes: Vec<usize> = (0..mesh.nodes.len())
            .filter(|&node| mesh.nodes[node][1] == 0.0)
            .collect();
        nodes.sort_by(|&a, &b| mesh.nodes[a][0].total_cmp(&mesh.nodes[b][0]));
        let mut surface = Vec::new();
        for (edge, t) in (nodes.windows(3).step_by(2)).flat_map(|edge| [(edge, -g), (edge, g)]) {
            let weights = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
            let nodes = [0, 1, 2].map(|k| (weights[k], edge[k]));
            let x = nodes.iter().map(|(w, node)| w * mesh.nodes[*node][0]);
            surface.push(([x.sum(), 0.0], nodes));
        }
        Ok(Full {
            phantom: phantom.clone(),
            contact,
            free,
            entries,
            surface,
        })
    }

    /// Gap of a point moved by `u`, ∂gap/∂u and ∂²gap/∂u².
    fn gap(&self, [x, y]: [f64; 2], u: [f64; 2], pose: Pose) -> (f64, [f64; 2], [[f64; 2]; 2]) {
        let radius = self.phantom.probe().radius;
        let height = radius - pose.depth;
        match self.contact {
            Contact::DeformedNormal => {
                let (a, b) = (x + u[0] - pose.lateral, y + u[1] - height);
                let r = libm::hypot(a, b);
                let cube = r * r * r;
                let second = [[b * b / cube, -a * b / cube], [-a * b / cube, a * a / cube]];
                (r - radius, [a / r, b / r], second)
            }
            Contact::VerticalGap => {
                let offset = x - pose.lateral;
                let circle = height - (radius * radius - offset * offset).max(0.0).sqrt();
                (circle - y - u[1], [0.0, -1.0], [[0.0; 2]; 2])
            }
        }
    }

    /// Displacement of a point, from those of the nodes.
    fn moved((_, nodes): &Point, u: &[f64]) -> [f64; 2] {
        [0, 1].map(|i| nodes.iter().map(|(w, node)| w * u[2 * node + i]).sum())
    }

    /// Newton's method on K u = Σ λ n, gap = 0 over the active points, and a change of the active set after each
    /// convergence, until no point is pulled or inside the probe. The depth goes down in steps of at most 1 mm.
    fn solve(&self, pose: Pose) -> Measured<Solved> {
        let mut u = vec![0.0; self.free.len()];
        let mut pressure = vec![0.0; self.surface.len()];
        let mut active: Vec<usize> = Vec::new();
        let steps = (pose.depth / 1e-3).ceil();
        for step in 1..=steps as usize {
            let pose = Pose {
                depth: pose.depth * step as f64 / steps,
                ..pose
            };
            for round in 0.. {
                if round == 60 {
                    return Err("the set of points in contact does not settle".into());
                }
                self.newton(&mut u, &mut pressure, &active, pose)?;
                let revised: Vec<usize> = (0..self.surface.len())
                    .filter(|&k| {
                        let point = &self.surface[k];
                        let (at, moved) = (point.0, Full::moved(point, &u));
                        let (gap, ..) = self.gap(at, moved, pose);
                        if active.contains(&k) {
                            pressure[k] >= 0.0
                        } else {
                            gap < 0.0 && (at[0] - pose.lateral).abs() < self.phantom.probe().radius
                        }
                    })
                    .collect();
                if revised == active {
                    break;
                }
                active = revised;
            }
        }
        Ok(self.solved(&u, &pressure, &active, pose))
    }

    /// Newton's method for u and the pressures λ of the active points,
    ///
    /// (K − Σ λ ∂n/∂u) δu − n δλ = Σ λ n − K u, −nᵀ δu = gap.
    fn newton(
        &self,
        u: &mut [f64],
        pressure: &mut [f64],
        active: &[usize],
        pose: Pose,
    ) -> Measured<()> {
        for point in (0..pressure.len()).filter(|point| !active.contains(point)) {
            pressure[point] = 0.0;
        }
        for _ in 0..30 {
            let (entries, rest) = self.equations(u, pressure, active, pose);
            let step = solved(&entries, &rest)?;
            let mut largest = 0.0f64;
            for (u, step) in u.iter_mut().zip(&step) {
                *u += step;
                largest = largest.max(step.abs());
            }
            for (k, &point) in active.iter().enumerate() {
                pressure[point] += step[self.free.len() + k];
            }
            if largest < 1e-13 {
                return Ok(());
            }
        }
        Err("Newton's method on all unknowns does not converge".into())
    }

    /// The entries of the matrix of one step of Newton's method, and its right-hand side.
    fn equations(
        &self,
        u: &[f64],
        pressure: &[f64],
        active: &[usize],
        pose: Pose,
    ) -> (Vec<Triplet<usize, usize, f64>>, Vec<f64>) {
        let n = self.free.len();
        let mut entries = self.entries.clone();
        let mut rest = vec![0.0; n + active.len()];
        for &Triplet { row, col, val } in &self.entries {
            rest[row] -= val * u[col];
        }
        for (k, &active) in active.iter().enumerate() {
            let point = &self.surface[active];
            let (gap, normal, turn) = self.gap(point.0, Full::moved(point, u), pose);
            rest[n + k] = gap;
            // Each free displacement with its weight and direction.
            let unknowns = point
                .1
                .iter()
                .flat_map(|&(w, node)| [0, 1].map(|i| (2 * node + i, w, i)));
            let unknowns: Vec<_> = unknowns.filter(|(a, ..)| self.free[*a]).collect();
            for &(a, w, i) in &unknowns {
                rest[a] += pressure[active] * w * normal[i];
                entries.push(Triplet::new(n + k, a, -w * normal[i]));
                entries.push(Triplet::new(a, n + k, -w * normal[i]));
                for &(b, v, j) in &unknowns {
                    entries.push(Triplet::new(a, b, -pressure[active] * w * v * turn[i][j]));
                }
            }
        }
        (entries, rest)
    }

    fn solved(&self, u: &[f64], pressure: &[f64], active: &[usize], pose: Pose) -> Solved {
        let radius = self.phantom.probe().radius;
        let mut force = [0.0; 2];
        for &active in active {
            let (point, pressure) = (&self.surface[active], pressure[active]);
            let (at, (_, normal, _)) = (point.0, self.gap(point.0, Full::moved(point, u), pose));
            force[1] -= pressure * normal[1];
            // The vertical gap's pressure acts on the circle's slope.
            let offset = at[0] - pose.lateral;
            force[0] -= match self.contact {
                Contact::DeformedNormal => pressure * normal[0],
                Contact::VerticalGap => {
                    pressure * offset / (radius * radius - offset * offset).sqrt()
                }
            };
        }
        let surface = self.surface.iter().map(|point| Full::moved(point, u));
        Solved {
            force,
            surface: surface.collect(),
        }
    }
}

/// The largest difference between two lists of displacements, m; NaN for lists of unlike lengths.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    largest(pairs.map(|(a, b)| (a - b).abs()))
}

/// Both sides stop Newton's method at steps of 1e-13 m, which are worth 1e-10 N at the surface's stiffness of some
/// 10³ N/m, and round the stiffness's sums in different orders. 1e-9 N is what FEM-060 allows.
pub fn compare(name: &str, contact: Contact) -> Measured {
    let size = 6e-3;
    let phantom = Phantom::builtin(name)?;
    let model = Model::new(&phantom, size, contact)?;
    let full = Full::new(&phantom, size, contact)?;
    let mut figures = Vec::new();
    for (depth, lateral) in [(1.3e-3, 2.1e-3), (4e-3, 3.7e-3)] {
        let condensed = model.solve(Pose { depth, lateral })?;
        let [right, left] = [lateral, -lateral].map(|lateral| full.solve(Pose { depth, lateral }));
        let (right, left) = (right?, left?);
        let off = [
            condensed.force.lateral - right.force[0],
            condensed.force.normal - right.force[1],
        ];
        // The left side is solved by itself here, where the library mirrors the right one.
        let unlike = [
            left.force[0] + right.force[0],
            left.force[1] - right.force[1],
        ];
        let mirrored: Vec<[f64; 2]> = left.surface.iter().rev().map(|&[x, y]| [-x, y]).collect();
        let moved = [
            &condensed.contact().expect("small strain").displacements,
            &mirrored,
        ]
        .map(|displacements| difference(displacements, &right.surface));
        let what = format!("d = {} mm, x = {} mm", depth * 1e3, lateral * 1e3);
        let magnitude = |forces: [f64; 2]| largest(forces.map(f64::abs));
        figures.extend(figures! {
            "{what}: lateral force to compare, N" => at_least(condensed.force.lateral.abs(), 1e-3);
            "{what}: largest difference of a force, N" => at_most(magnitude(off), 1e-9);
            "{what}: largest difference of a surface displacement, m" => at_most(moved[0], 1e-12);
            "{what}: largest difference of a force from −x's, N" => at_most(magnitude(unlike), 1e-9);
            "{what}: largest difference of a surface displacement from −x's, m" => at_most(moved[1], 1e-12);
        });
    }
    Ok(figures)
}

/// Pairs of mirrored poses of a map whose lateral positions are their own mirror image.
pub fn symmetry(what: &str, map: &ForceMap) -> Vec<Figure> {
    let (rows, columns) = (map.table().depths().len(), map.table().laterals().len());
    let (mut pairs, mut unlike, mut aside) = (0, 0, 0);
    for row in 0..rows {
        let (normal, lateral) = (
            map.table().normal().row(row),
            map.table().lateral().unwrap().row(row),
        );
        for (left, right) in (0..columns).zip((0..columns).rev()).take(columns / 2) {
            let same = normal[left].to_bits() == normal[right].to_bits()
                && lateral[left].to_bits() == (-lateral[right]).to_bits();
            // Without a force there would be nothing to compare.
            let loaded = normal[right] > 0.0 && lateral[right] != 0.0;
            pairs += 1;
            unlike += u64::from(!(same && loaded));
        }
        aside += u64::from(lateral[columns / 2].to_bits() != 0.0f64.to_bits());
    }
    let expected = (rows * (columns / 2)) as u64;
    figures! {
        "{what}: pairs of poses at x and −x" => count(pairs, expected);
        "{what}: pairs that differ in a bit, or have no force" => count(unlike, 0);
        "{what}: lateral forces at x = 0 that are not 0" => count(aside, 0);
    }
}

pub fn mirror() -> Measured {
    let phantom = Phantom::builtin("2.6")?;
    let model = Model::new(&phantom, 2e-3, Contact::DeformedNormal)?;
    let depths: Vec<f64> = (1..=8).map(|k| 0.5e-3 * f64::from(k)).collect();
    let laterals: Vec<f64> = (-10..=10).map(|k| 1e-3 * f64::from(k)).collect();
    let map = model.map(&depths, &laterals, &|_| true)?;
    Ok(symmetry("2.6", &map))
}
