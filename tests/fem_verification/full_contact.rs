//! Contact solved over all unknowns at once, to compare with the condensed contact.

use palpate::fem::assembly::material_of;
use palpate::fem::element::StiffnessRule;
use palpate::fem::{Contact, Mesh, MeshOptions, Model, Pose};
use palpate::phantom::Phantom;

use super::skyline::Skyline;

/// A phantom with all its unknowns, the free displacements in the mesh's own order of nodes, from the element
/// stiffnesses alone.
struct Full {
    phantom: Phantom,
    contact: Contact,
    unknowns: usize,
    /// Row, column ≤ row and value; those of the same place add up.
    entries: Vec<(usize, usize, f64)>,
    /// The first column of each row.
    first: Vec<usize>,
    /// Of each node of the surface its position and its first unknown.
    surface: Vec<([f64; 2], usize)>,
}

/// Forces on the probe (F_x, F_n) with the displacements of the surface.
struct Solved {
    force: [f64; 2],
    surface: Vec<[f64; 2]>,
}

impl Full {
    fn new(phantom: &Phantom, options: &MeshOptions, contact: Contact) -> Full {
        let mesh = Mesh::new(phantom, options).unwrap();
        let mut place = vec![None; mesh.nodes.len()];
        let free = mesh.free();
        for (count, node) in (0..mesh.nodes.len()).filter(|&node| free[node]).enumerate() {
            place[node] = Some(2 * count);
        }
        let unknowns = 2 * free.iter().filter(|free| **free).count();
        let (mut entries, mut first) = (Vec::new(), (0..unknowns).collect::<Vec<_>>());
        let rule = StiffnessRule::new(mesh.element);
        for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
            let element = rule
                .integrate(&mesh.positions(nodes), &material_of(phantom, region))
                .unwrap();
            let places: Vec<Option<usize>> = nodes
                .iter()
                .flat_map(|&node| [0, 1].map(|i| place[node as usize].map(|p| p + i)))
                .collect();
            for (a, row) in places.iter().enumerate() {
                for (b, column) in places.iter().enumerate() {
                    if let (&Some(row), &Some(column)) = (row, column)
                        && column <= row
                    {
                        first[row] = first[row].min(column);
                        entries.push((row, column, phantom.probe.length * element[a][b]));
                    }
                }
            }
        }
        let surface = (0..mesh.nodes.len())
            .filter(|&node| mesh.nodes[node][1] == 0.0)
            .filter_map(|node| Some((mesh.nodes[node], place[node]?)))
            .collect();
        Full {
            phantom: phantom.clone(),
            contact,
            unknowns,
            entries,
            first,
            surface,
        }
    }

    /// Gap of a node moved by `u`, ∂gap/∂u and ∂²gap/∂u².
    fn gap(&self, [x, y]: [f64; 2], u: [f64; 2], pose: Pose) -> (f64, [f64; 2], [[f64; 2]; 2]) {
        let radius = self.phantom.probe.radius;
        let height = radius - pose.depth;
        match self.contact {
            Contact::DeformedNormal => {
                let (a, b) = (x + u[0] - pose.lateral, y + u[1] - height);
                let r = a.hypot(b);
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

    /// Newton's method on K u = Σ λ n, gap = 0 over the active nodes, and a change of the active set after each
    /// convergence, until no node is pulled or inside the probe. The depth goes down in steps of at most 1 mm.
    fn solve(&self, pose: Pose) -> Solved {
        let mut u = vec![0.0; self.unknowns];
        let mut pressure = vec![0.0; self.surface.len()];
        let mut active: Vec<usize> = Vec::new();
        let steps = (pose.depth / 1e-3).ceil();
        for step in 1..=steps as usize {
            let pose = Pose {
                depth: pose.depth * step as f64 / steps,
                ..pose
            };
            for round in 0.. {
                assert!(round < 60, "the active set does not settle");
                self.newton(&mut u, &mut pressure, &active, pose);
                let revised: Vec<usize> = (0..self.surface.len())
                    .filter(|&k| {
                        let (at, place) = self.surface[k];
                        let (gap, ..) = self.gap(at, [u[place], u[place + 1]], pose);
                        if active.contains(&k) {
                            pressure[k] >= 0.0
                        } else {
                            gap < 0.0 && (at[0] - pose.lateral).abs() < self.phantom.probe.radius
                        }
                    })
                    .collect();
                if revised == active {
                    break;
                }
                active = revised;
            }
        }
        self.solved(&u, &pressure, &active, pose)
    }

    /// Newton's method for u and the pressures λ of the active nodes,
    ///
    /// (K − Σ λ ∂n/∂u) δu − n δλ = Σ λ n − K u, −nᵀ δu = gap.
    fn newton(&self, u: &mut [f64], pressure: &mut [f64], active: &[usize], pose: Pose) {
        let n = self.unknowns;
        for node in (0..pressure.len()).filter(|node| !active.contains(node)) {
            pressure[node] = 0.0;
        }
        let mut first = self.first.clone();
        first.extend(active.iter().map(|&node| self.surface[node].1));
        for _ in 0..30 {
            let mut matrix = Skyline::new(first.clone());
            let mut rest = vec![0.0; n + active.len()];
            for &(row, column, value) in &self.entries {
                matrix.add(row, column, value);
                rest[row] -= value * u[column];
                if row != column {
                    rest[column] -= value * u[row];
                }
            }
            for (k, &node) in active.iter().enumerate() {
                let (at, place) = self.surface[node];
                let (gap, normal, turn) = self.gap(at, [u[place], u[place + 1]], pose);
                rest[n + k] = gap;
                for i in 0..2 {
                    rest[place + i] += pressure[node] * normal[i];
                    matrix.add(n + k, place + i, -normal[i]);
                    for j in 0..=i {
                        matrix.add(place + i, place + j, -pressure[node] * turn[i][j]);
                    }
                }
            }
            matrix.factorise().solve(&mut rest);
            let mut largest = 0.0f64;
            for (u, step) in u.iter_mut().zip(&rest) {
                *u += step;
                largest = largest.max(step.abs());
            }
            for (k, &node) in active.iter().enumerate() {
                pressure[node] += rest[n + k];
            }
            if largest < 1e-13 {
                return;
            }
        }
        panic!("Newton's method does not converge");
    }

    fn solved(&self, u: &[f64], pressure: &[f64], active: &[usize], pose: Pose) -> Solved {
        let radius = self.phantom.probe.radius;
        let mut force = [0.0; 2];
        for &node in active {
            let (at, place) = self.surface[node];
            let (_, normal, _) = self.gap(at, [u[place], u[place + 1]], pose);
            force[1] -= pressure[node] * normal[1];
            // The vertical gap's pressure acts on the circle's slope.
            let offset = at[0] - pose.lateral;
            force[0] -= match self.contact {
                Contact::DeformedNormal => pressure[node] * normal[0],
                Contact::VerticalGap => {
                    pressure[node] * offset / (radius * radius - offset * offset).sqrt()
                }
            };
        }
        let surface = self
            .surface
            .iter()
            .map(|&(_, place)| [u[place], u[place + 1]]);
        Solved {
            force,
            surface: surface.collect(),
        }
    }
}

/// The largest difference between two lists of displacements, m.
fn difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Both sides stop Newton's method at steps of 1e-13 m, which are worth 1e-10 N at the surface's stiffness of some
/// 10³ N/m, and round the stiffness's sums in different orders. Issue and design ask for 1e-9 N.
fn check(name: &str, contact: Contact) {
    let options = MeshOptions {
        size: 6e-3,
        ..MeshOptions::default()
    };
    let phantom = Phantom::builtin(name).unwrap();
    let model = Model::new(&phantom, &options, contact).unwrap();
    let full = Full::new(&phantom, &options, contact);
    for (depth, lateral) in [(1.3e-3, 2.1e-3), (4e-3, 3.7e-3)] {
        let condensed = model.solve(Pose { depth, lateral }).unwrap();
        let [right, left] = [lateral, -lateral].map(|lateral| full.solve(Pose { depth, lateral }));
        let off = [
            condensed.lateral_force - right.force[0],
            condensed.normal_force - right.force[1],
            // The left side is solved by itself here, where the library mirrors the right one.
            left.force[0] + right.force[0],
            left.force[1] - right.force[1],
        ];
        println!("{name}, {contact:?}, d = {depth}, x = {lateral}: {off:?} N");
        assert!(
            off.iter().all(|off| off.abs() < 1e-9),
            "{name} at {depth}, {lateral}: {off:?}"
        );
        assert!(condensed.lateral_force.abs() > 1e-3, "nothing to compare");
        let mirrored: Vec<[f64; 2]> = left.surface.iter().rev().map(|&[x, y]| [-x, y]).collect();
        assert!(difference(&condensed.state.displacements, &right.surface) < 1e-12);
        assert!(difference(&mirrored, &right.surface) < 1e-12);
    }
}

// Verifies: FEM-060, FEM-061.
#[test]
fn condensed_contact_equals_a_solve_of_everything() {
    check("2.6", Contact::DeformedNormal);
}

// Verifies: FEM-060, FEM-061.
#[test]
fn condensed_vertical_contact_equals_a_solve_of_everything() {
    check("6.6", Contact::VerticalGap);
}

// Verifies: FEM-061.
#[test]
fn a_whole_map_is_mirror_symmetric_to_the_bit() {
    let options = MeshOptions {
        size: 2e-3,
        ..MeshOptions::default()
    };
    let phantom = Phantom::builtin("2.6").unwrap();
    let model = Model::new(&phantom, &options, Contact::DeformedNormal).unwrap();
    let depths: Vec<f64> = (1..=8).map(|k| 0.5e-3 * f64::from(k)).collect();
    let laterals: Vec<f64> = (-10..=10).map(|k| 1e-3 * f64::from(k)).collect();
    let map = model.map(&depths, &laterals, &|_| ()).unwrap();
    for row in 0..depths.len() {
        let (normal, lateral) = (map.normal_force().row(row), map.lateral_force().row(row));
        for (left, right) in (0..21).zip((0..21).rev()).take(10) {
            assert_eq!(normal[left].to_bits(), normal[right].to_bits());
            assert_eq!(lateral[left].to_bits(), (-lateral[right]).to_bits());
            assert!(normal[right] > 0.0 && lateral[right] != 0.0);
        }
        assert_eq!(lateral[10].to_bits(), 0.0f64.to_bits());
    }
}
