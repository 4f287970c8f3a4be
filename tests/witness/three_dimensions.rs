//! How wrong the plane is (`spec/fem.md`): the force on a probe with ends, in a well with ends, from CalculiX's displacements.
//!
//! CalculiX's own contact factorises the stiffness some hundred times, because its set of touching nodes swings. The gel is linear, so
//! here CalculiX factorises once, and the contact is solved with its displacements under unit forces.

use std::collections::HashMap;
use std::path::Path;

use palpate::fem::{Contact, Mesh, Model, Pose};

use super::builtin_at;
use super::calculix::{is_present, run};
use super::extruded::{Ends, Part, Place};

/// The section's mesh size, m, and its cuts along z, m: of the meshes in `spec/fem.md` the coarsest.
const SIZE: f64 = 2e-3;
const CUTS: [f64; 12] = [
    0.0, 4e-3, 8e-3, 11e-3, 13e-3, 14.3e-3, 15e-3, 15.7e-3, 17e-3, 19e-3, 23e-3, 29.6e-3,
];
/// Half-width of the strip, m, in which a probe 4 mm deep or less touches: 5.4 mm and some nodes more.
const STRIP: f64 = 6.2e-3;

/// Places at the surface, and how they give way: `compliance[2 i + k][2 j + l]` is the displacement of i along k under 1 N on j along
/// l, m. k and l are 0 for x and 1 for y.
struct Surface {
    places: Vec<Place>,
    compliance: Vec<Vec<f64>>,
    radius: f64,
    /// Where the probe stands, m.
    lateral: f64,
    /// How many such surfaces make up the gel.
    parts: f64,
}

/// CalculiX's displacements of the `places` under unit forces on each of them.
fn compliance(part: &Part<'_>, places: &[Place], directory: &Path) -> Vec<Vec<f64>> {
    let all = (0..places.len()).flat_map(|place| [(place, 0), (place, 1)]);
    // In a plane of symmetry nothing moves along x.
    let free = |&(place, direction): &(usize, usize)| {
        places[place].x != 0.0 || part.lateral != 0.0 || direction == 1
    };
    let loads: Vec<(usize, usize)> = all.filter(free).collect();
    let tables = run(directory, &part.deck(places, &loads));
    let numbers: HashMap<usize, usize> = places.iter().map(|p| p.number).zip(0..).collect();
    let mut compliance = vec![vec![0.0; 2 * places.len()]; 2 * places.len()];
    let mut under = None;
    for line in tables.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if line.contains("E I G E N V A L U E") {
            under = Some(under.map_or(0, |load| load + 1));
        } else if let ([number, x, y, _], Some(load)) = (&words[..], under)
            && let Ok(number) = number.parse::<usize>()
        {
            let (place, direction) = loads[load];
            for (k, u) in [x, y].into_iter().enumerate() {
                compliance[2 * numbers[&number] + k][2 * place + direction] = u.parse().unwrap();
            }
        }
    }
    assert_eq!(
        under,
        Some(loads.len() - 1),
        "CalculiX did not come to the end"
    );
    compliance
}

impl Surface {
    /// The surface of a gel under a probe at `lateral`, m. `None` where CalculiX is missing.
    fn new(name: &str, lateral: f64, ends: Ends) -> Option<Surface> {
        if !is_present() {
            return None;
        }
        let phantom = builtin_at(name, 0.0);
        let mesh = Mesh::new(&phantom, SIZE).unwrap();
        let cuts = match ends {
            Ends::Fixed => &CUTS[..],
            Ends::Plane => &[0.0, 1e-3],
        };
        let part = Part {
            phantom: &phantom,
            lateral,
            mesh: &mesh,
            cuts,
            ends,
        };
        let places = part.places(STRIP);
        let directory = format!("ccx-{name}-{lateral}-{ends:?}");
        let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(directory);
        Some(Surface {
            compliance: compliance(&part, &places, &directory),
            places,
            radius: phantom.probe().radius,
            lateral,
            // In plane strain a slice stands for half of the probe.
            parts: match ends {
                Ends::Fixed => part.of_the_gel(),
                Ends::Plane => 0.5 * part.of_the_gel() * phantom.probe().length / cuts[1],
            },
        })
    }

    /// F_n, N. No place may lie inside the probe's circle, and a force λ ≥ 0 pushes each that touches along the circle's normal there.
    fn force(&self, depth: f64) -> f64 {
        let all = 0..self.places.len();
        let centre = self.radius - depth;
        let mut displaced = vec![[0.0; 2]; self.places.len()];
        let mut pushed = vec![0.0; self.places.len()];
        for _ in 0..40 {
            let normal = |(place, u): (&Place, &[f64; 2])| {
                let [x, y] = [place.x - self.lateral + u[0], u[1] - centre];
                [x, y].map(|component| component / x.hypot(y))
            };
            let normals: Vec<[f64; 2]> = self.places.iter().zip(&displaced).map(normal).collect();
            let dot = |[a, b]: [f64; 2], [x, y]: [f64; 2]| a * x + b * y;
            let gap = |(place, n): (&Place, &[f64; 2])| {
                dot(*n, [place.x - self.lateral, -centre]) - self.radius
            };
            let gaps = self.places.iter().zip(&normals).map(gap).collect();
            let moved = |j: usize, k: usize| {
                [0, 1].map(|l| {
                    let row = &self.compliance[2 * j + l];
                    dot([row[2 * k], row[2 * k + 1]], normals[k])
                })
            };
            let gives = |k: usize| all.clone().map(|j| dot(normals[j], moved(j, k))).collect();
            settle(
                &all.clone().map(gives).collect::<Vec<_>>(),
                gaps,
                &mut pushed,
            );
            let before = displaced.clone();
            displaced.fill([0.0; 2]);
            for k in all.clone().filter(|&k| pushed[k] > 0.0) {
                for j in all.clone() {
                    let by = moved(j, k);
                    displaced[j] = [0, 1].map(|l| displaced[j][l] + by[l] * pushed[k]);
                }
            }
            let pairs = before.as_flattened().iter().zip(displaced.as_flattened());
            if pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-9 {
                let up = normals.iter().zip(&pushed).map(|(n, force)| -n[1] * force);
                return self.parts * up.sum::<f64>();
            }
        }
        panic!("the contact does not settle at {depth}");
    }
}

/// The forces ≥ 0 that leave no gap below 0, and none where a gap is left: by over-relaxation, projected. `gives[k][j]` is what a force
/// of 1 N on k adds to the gap of j, and `gaps` are those without forces.
fn settle(gives: &[Vec<f64>], mut gaps: Vec<f64>, pushed: &mut [f64]) {
    let push = |gaps: &mut [f64], k: usize, force: f64| {
        for (gap, gives) in gaps.iter_mut().zip(&gives[k]) {
            *gap += gives * force;
        }
    };
    for (k, &force) in pushed.iter().enumerate() {
        push(&mut gaps, k, force);
    }
    for _ in 0..20_000 {
        let mut largest: f64 = 0.0;
        for k in 0..pushed.len() {
            let change = (-1.5 * gaps[k] / gives[k][k]).max(-pushed[k]);
            if change != 0.0 {
                pushed[k] += change;
                push(&mut gaps, k, change);
            }
            largest = largest.max(change.abs());
        }
        if largest < 1e-9 {
            return;
        }
    }
    panic!("the forces do not settle");
}

/// One row of the table: the pose, and F_n, N, in three dimensions and in plane strain.
#[derive(Debug, Clone, Copy)]
struct Row {
    pose: Pose,
    normal: [f64; 2],
}

/// The rows of a phantom under a probe at `lateral`, m.
fn table(name: &str, lateral: f64) -> Vec<Row> {
    let rows = include_str!("../tables/three_dimensions.txt").lines();
    let rows = rows.map(|row| row.split_whitespace().collect::<Vec<_>>());
    let row = |row: Vec<&str>| {
        let number = |k: usize| row[k].parse::<f64>().unwrap();
        Row {
            pose: pose(1e-3 * number(1), 1e-3 * number(2)),
            normal: [number(3), number(4)],
        }
    };
    let rows = rows.filter(|row| row[0] == name).map(row);
    rows.filter(|row| row.pose.lateral == lateral).collect()
}

/// What the inclusion adds, at each pose.
fn signals(none: &[Row], with: &[Row]) -> Vec<[f64; 2]> {
    let pairs = with.iter().zip(none);
    let signal = |(with, none): (&Row, &Row)| [0, 1].map(|k| with.normal[k] - none.normal[k]);
    pairs.map(signal).collect()
}

/// With plane ends the wedges give our plane forces. Contact here is at nodes and ours at Gauss points: both swing with the pose, by
/// 0.05 % on the default mesh (`spec/fem.md`) and with the square of the mesh size, so here by up to 0.8 %; FEM-080 allows 0.5 %.
///
/// Verifies: FEM-083.
#[test]
fn wedges_that_cannot_move_along_z_give_the_plane_force() {
    for (name, lateral) in [("none", 0.0), ("4.6", 5e-3)] {
        let Some(surface) = Surface::new(name, lateral, Ends::Plane) else {
            return;
        };
        for depth in [1e-3, 2e-3, 4e-3] {
            let (ours, theirs) = (plane(name, pose(depth, lateral)), surface.force(depth));
            println!("{name}, x = {lateral}, d = {depth}: F_n {ours:.6} N, CalculiX {theirs:.6} N");
            assert!((ours / theirs - 1.0).abs() < 5e-3, "{depth}");
        }
    }
}

fn pose(depth: f64, lateral: f64) -> Pose {
    Pose { depth, lateral }
}

/// F_n in plane strain, N.
fn plane(name: &str, pose: Pose) -> f64 {
    let model = Model::new(&builtin_at(name, 0.0), SIZE, Contact::DeformedNormal).unwrap();
    model.solve(pose).unwrap().force.normal
}

/// The table's ratios again, on a coarser mesh: its wedges at the ends of probe and inclusion are 0.7 mm long, those of the table's mesh
/// 0.3 mm. The ratios of forces differ by 0.0025 between both and those of signals by 0.0035, of which twice is allowed.
///
/// Verifies: FEM-083.
#[test]
#[ignore = "slow, some minutes"]
fn the_plane_is_as_wrong_as_the_table_says() {
    compare_with_the_table(0.0);
}

/// As above beside the inclusion, where the gel has half the symmetry.
///
/// Verifies: FEM-083.
#[test]
#[ignore = "slow, a quarter of an hour"]
fn the_plane_is_as_wrong_beside_the_inclusion_as_the_table_says() {
    compare_with_the_table(5e-3);
}

fn compare_with_the_table(lateral: f64) {
    let found = ["none", "4.6"].map(|name| {
        let rows = table(name, lateral);
        assert_eq!(rows.len(), 3);
        let surface = Surface::new(name, lateral, Ends::Fixed)?;
        let again = |row: &Row| {
            let normal = [surface.force(row.pose.depth), plane(name, row.pose)];
            println!("{name}, {:?}: F_n {normal:?} N", row.pose);
            Row { normal, ..*row }
        };
        Some((rows.iter().map(again).collect::<Vec<_>>(), rows))
    });
    let [Some((none, none_stored)), Some((with, with_stored))] = found else {
        return;
    };
    let ratio = |[three, plane]: [f64; 2]| three / plane;
    let rows = none
        .iter()
        .chain(&with)
        .zip(none_stored.iter().chain(&with_stored));
    for (found, stored) in rows {
        let off = ratio(found.normal) - ratio(stored.normal);
        assert!(off.abs() < 0.005, "{stored:?}: {off}");
    }
    let stored = signals(&none_stored, &with_stored);
    for (found, stored) in signals(&none, &with).into_iter().zip(stored) {
        let off = ratio(found) - ratio(stored);
        assert!(off.abs() < 0.007, "{stored:?}: {off}");
    }
}

/// The gain that fits forces in plane strain best to those in three dimensions, and the largest force, N, that it leaves.
fn gain(pairs: &[[f64; 2]]) -> [f64; 2] {
    let sum = |k: usize| pairs.iter().map(|pair| pair[k] * pair[1]).sum::<f64>();
    let gain = sum(0) / sum(1);
    let left = pairs
        .iter()
        .map(|[three, plane]| (three - gain * plane).abs());
    [gain, left.fold(0.0, f64::max)]
}

/// The figures of `spec/fem.md`, which rounds them to 0.001 and 1 mN.
#[test]
fn one_gain_makes_up_for_a_part_of_the_plane() {
    let [none, with] = ["none", "4.6"].map(|name| table(name, 0.0));
    let forces = |rows: &[Row]| rows.iter().map(|row| row.normal).collect::<Vec<_>>();
    let beside = ["none", "4.6"].map(|name| table(name, 5e-3));
    let both = [signals(&none, &with), signals(&beside[0], &beside[1])].concat();
    let kinds = [forces(&none), forces(&with), signals(&none, &with), both];
    let stated = [
        [0.948, 0.023],
        [0.982, 0.015],
        [1.082, 0.012],
        [1.094, 0.015],
    ];
    for (pairs, stated) in kinds.iter().zip(stated) {
        let found = gain(pairs);
        println!("gain {:.4}, {:.1} mN left", found[0], 1e3 * found[1]);
        assert!((found[0] - stated[0]).abs() <= 5e-4 && (found[1] - stated[1]).abs() <= 5e-4);
    }
}
