//! How far the default mesh's forces are from those of a mesh without end (requirements FEM-021, FEM-028,
//! FEM-021): `cargo bench -p palpate-benches --bench convergence`. Takes a quarter of an hour and 1 GB on one core.
//!
//! The reference is a mesh of 0.125 mm, a quarter of the default, corners at the walls included. No force is extrapolated:
//! what is left of the error swings with the pose, as the contact's edge moves from node to node, and an
//! extrapolation would enlarge that. Its largest change from a mesh of 0.2 mm tells how good it is: at second
//! order its own error is 0.64 of that, at first order 1.7 times.

use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::force_map::{ForceMap, Matrix};
use palpate::phantom::{BUILTIN_NAMES, Phantom};

/// Mesh sizes of the reference and of the mesh that tells how good it is, m.
const REFERENCES: [f64; 2] = [0.125e-3, 0.2e-3];
/// Depths and places of the discs off the middle, mm.
const OFF_CENTRE: [(&str, f64); 6] = [
    ("6.6", 2.0),
    ("6.6", 5.0),
    ("6.6", 10.0),
    ("2.6", 2.0),
    ("2.6", 5.0),
    ("2.6", 10.0),
];

fn model(phantom: &Phantom, size: f64) -> Model {
    Model::new(phantom, size, Contact::default()).expect("a model")
}

/// Half millimetres, m.
fn axis(range: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    range.map(|k| f64::from(k) * 0.5e-3).collect()
}

fn main() {
    println!(
        "phantom (disc at x)  nodes, of the reference | largest error of F_n at (d, x) mm (change of the reference), in band | of F_x"
    );
    let builtin = |name: &str| Phantom::builtin(name).expect("a built-in name");
    let mut totals = Shares::default();
    for name in BUILTIN_NAMES {
        totals.add(study(name, &builtin(name), &axis(0..=20)));
    }
    totals.print("the paper's phantoms");
    let mut totals = Shares::default();
    for (name, x) in OFF_CENTRE {
        let phantom = builtin(name).changed(|parts| parts.inclusions[0].centre_x = 1e-3 * x);
        totals.add(study(
            &format!("{name} ({x} mm)"),
            &phantom.expect("within the well"),
            &axis(-20..=20),
        ));
    }
    totals.print("discs off the middle");
}

/// How many forces lie in their bands.
#[derive(Default)]
struct Shares {
    poses: usize,
    normal: usize,
    lateral: usize,
}

impl Shares {
    fn add(&mut self, other: Shares) {
        self.poses += other.poses;
        self.normal += other.normal;
        self.lateral += other.lateral;
    }

    fn print(&self, of: &str) {
        let percent = |within: usize| 100.0 * within as f64 / self.poses as f64;
        println!(
            "{of}: {:.1} % of the normal and {:.1} % of the lateral forces in their bands",
            percent(self.normal),
            percent(self.lateral)
        );
    }
}

/// Prints one line of the table.
fn study(name: &str, phantom: &Phantom, laterals: &[f64]) -> Shares {
    let depths = axis(1..=8);
    let default = model(phantom, MESH_SIZE);
    let map = certified_map(&default, &depths, laterals, &|_| true).expect("a map");
    let references = REFERENCES.map(|size| {
        let model = model(phantom, size);
        let map = model.map(&depths, laterals, &|_| true).expect("a map");
        (model.mesh().nodes.len(), map)
    });
    let certificate = map.certificate().expect("a certificate");
    let bands = certificate.discretization.as_ref().expect("bands");
    // Normal forces in per cent of the force, lateral ones in mN.
    let errors = |force: fn(&ForceMap) -> &Matrix, bands: &Matrix, relative: bool| {
        let (mut worst, mut change, mut within) = ((0.0, 0, 0), 0.0, 0);
        for (row, column, found) in force(&map).entries() {
            let of_level = |(_, map): &(usize, ForceMap)| force(map).row(row)[column];
            let [fine, coarse] = references.each_ref().map(of_level);
            let scale = if relative { 100.0 / fine } else { 1e3 };
            let error = (found - fine).abs();
            within += usize::from(error <= bands.row(row)[column]);
            change = f64::max(change, scale * (fine - coarse).abs());
            if scale * error > worst.0 {
                worst = (scale * error, row, column);
            }
        }
        let (error, row, column) = worst;
        let (depth, lateral) = (1e3 * depths[row], 1e3 * laterals[column]);
        let unit = if relative { "%" } else { "mN" };
        let poses = depths.len() * laterals.len();
        let text = format!(
            "{error:.3} {unit} at ({depth:.1}, {lateral:.1}) ({change:.3} {unit}), {within} of {poses}"
        );
        (text, within)
    };
    let (normal, normal_within) =
        errors(|map| map.table().normal(), &bands.normal_force_band, true);
    let (lateral, lateral_within) = errors(
        |map| map.table().lateral().unwrap(),
        &bands.lateral_force_band,
        false,
    );
    let nodes = [default.mesh().nodes.len(), references[0].0];
    println!(
        "{name:>12}  {:>6} {:>7} | {normal} | {lateral}",
        nodes[0], nodes[1]
    );
    Shares {
        poses: depths.len() * laterals.len(),
        normal: normal_within,
        lateral: lateral_within,
    }
}
