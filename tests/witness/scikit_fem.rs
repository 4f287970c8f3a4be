//! The stiffness matrix by scikit-fem.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use palpate::fem::Mesh;
use palpate::fem::assembly::StiffnessMatrix;
use palpate::phantom::Phantom;

use super::{builtin_at, material, python_with};

/// The mesh and the materials, as `stiffness.py` reads them.
fn problem(mesh: &Mesh, phantom: &Phantom) -> String {
    let mut text = format!("{} {}\n", mesh.nodes.len(), mesh.regions.len());
    for [x, y] in &mesh.nodes {
        writeln!(text, "{x:e} {y:e}").unwrap();
    }
    for (nodes, &region) in mesh.elements().zip(&mesh.regions) {
        for node in nodes {
            write!(text, "{node} ").unwrap();
        }
        let material = material(phantom, region);
        let (modulus, ratio) = (material.youngs_modulus, material.poisson_ratio);
        writeln!(text, "{modulus:e} {ratio:e}").unwrap();
    }
    text
}

/// scikit-fem's matrix: its upper triangle by row and column over all nodes, N/m per metre.
fn witness(mut python: Command, problem: &str) -> HashMap<(usize, usize), f64> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/witness/stiffness.py");
    let mut child = python
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // The script reads all before it writes; dropping the pipe ends its input.
    let mut input = child.stdin.take().unwrap();
    input.write_all(problem.as_bytes()).unwrap();
    drop(input);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{script} failed");
    let text = String::from_utf8(output.stdout).unwrap();
    let entry = |line: &str| {
        let mut words = line.split(' ');
        let mut index = || words.next().unwrap().parse().unwrap();
        ((index(), index()), words.next().unwrap().parse().unwrap())
    };
    text.lines().map(entry).collect()
}

/// Differences are taken relative to √(K_aa K_bb), which bounds |K_ab|, so that the soft gel counts as much as the
/// hard disc. Both sides add up the same products at the same points: some 10² roundings, 10⁻¹⁴, and their tables of the
/// points differ in the 15th digit, which (λ + 2μ)/μ = 51 makes some 10⁻¹³.
///
/// The mesh has curved edges, on which the integrand is rational and each rule gives another matrix; scikit-fem's rule of
/// degree 4 has the same 6 points as ours.
// Verifies: FEM-080, FEM-082.
#[test]
fn scikit_fem_assembles_our_stiffness() {
    for (name, centre_x) in [("none", 0.0), ("2.6", 0.0), ("2.6", 3e-3)] {
        let phantom = builtin_at(name, centre_x);
        let mesh = Mesh::new(&phantom, 1.5e-3).unwrap();
        let matrix = StiffnessMatrix::assemble(&mesh, &phantom).unwrap();
        let Some(python) = python_with("skfem") else {
            return;
        };
        let witness = witness(python, &problem(&mesh, &phantom));
        // Place of each free displacement among our unknowns, to displacement i of node a, 2a + i.
        let mut number = vec![usize::MAX; matrix.unknowns()];
        for displacement in 0..2 * mesh.nodes.len() {
            if let Some(unknown) = matrix.unknown(displacement / 2, displacement % 2) {
                number[unknown] = displacement;
            }
        }
        let mut ours = HashMap::new();
        for (column, &b) in number.iter().enumerate() {
            let rows = matrix.upper.row_idx_of_col(column);
            for (row, &value) in rows.zip(matrix.upper.val_of_col(column)) {
                let a = number[row];
                ours.insert((a.min(b), a.max(b)), value / phantom.probe().length);
            }
        }
        // Entries that one side leaves out are zeros.
        let free = |k: usize| !mesh.held[k / 2][k % 2];
        let theirs = witness.keys().filter(|(a, b)| free(*a) && free(*b));
        let diagonal = |k: usize| witness[&(k, k)];
        let mut worst = 0.0f64;
        for at in ours.keys().chain(theirs) {
            let [our, their] = [&ours, &witness].map(|side| side.get(at).copied().unwrap_or(0.0));
            worst = worst.max((our - their).abs() / (diagonal(at.0) * diagonal(at.1)).sqrt());
        }
        println!(
            "{name} at {centre_x}: {} entries, largest difference {worst:.2e}",
            ours.len()
        );
        assert!(worst <= 1e-12, "{name}: {worst:e}");
    }
}
