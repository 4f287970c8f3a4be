//! What arrays under the probe make of a run.

use super::run::*;
use crate::report::{ArraySweep, Run};
use palpate::phantom::Phantom;
use palpate_asserts::assert_has;

/// The sweep of an array over a phantom of the paper, with these forces on its elements over x, N.
fn sweep(name: &str, force: impl Fn(f64, usize) -> f64) -> ArraySweep {
    let forces = LATERALS.map(|x| (0..32).map(|k| force(x, k)).collect());
    ArraySweep {
        phantom: Phantom::builtin(name).unwrap(),
        depth: 4e-3,
        laterals: LATERALS.into(),
        forces: forces.into(),
    }
}

/// The paper's run, with 6.6 mm and the reference as arrays feel them: at x = 0 the first quarter of the elements carries
/// 10 mN more on each and the last quarter 5 mN less, and at 5 mm the first two elements carry 80 mN more and less.
fn felt() -> Run {
    let with = |x: f64, k: usize| match (x, k) {
        (0.0, 0..8) => 0.060,
        (0.0, 24..) => 0.045,
        (5e-3, 0) => 0.130,
        (5e-3, 1) => -0.030,
        _ => 0.050,
    };
    let arrays = vec![sweep("6.6", with), sweep("none", |_, _| 0.050)];
    Run {
        arrays,
        ..paper_run()
    }
}

// In units of the noise of 0.1 N, with n elements of noise 0.1/√n: at x = 0 halves differ by 0.8 and −0.4, quarters and what is finer
// by 8/m of 0.1·m and of −0.05·m for m of the 32 elements in one; at 5 mm only the finest of all tells 0.8 from −0.8.
// Verifies: REP-018.
#[test]
fn gamma_of_arrays_is_that_of_plain_arithmetic() {
    let Made { found, summary, .. } = made(&felt());
    assert!(found.maps[0].array.is_none() && found.maps[3].array.is_none());
    let array = found.maps[2].array.as_ref().unwrap();
    // 0.3 N normal and nothing lateral.
    assert!((array.press_of_total_force.unwrap() - 3.0).abs() < 1e-12);
    let halves = 2.0 * (0.64 + 0.16);
    let press = [0.16, halves, 4.0 * 0.8, 8.0 * 0.4, 16.0 * 0.2, 32.0 * 0.1];
    let edge = [0.0, 0.0, 0.0, 0.0, 0.0, 32.0 * 1.28];
    let elements = [1, 2, 4, 8, 16, 32];
    assert_eq!(array.arrays.len(), elements.len());
    for (k, of) in array.arrays.iter().enumerate() {
        assert_eq!(of.elements, elements[k]);
        let square = of.press.unwrap() * of.press.unwrap();
        assert!((square - press[k]).abs() < 1e-12, "{k}: {square}");
        let square = of.sweep * of.sweep;
        assert!((square - press[k] - edge[k]).abs() < 1e-11, "{k}: {square}");
    }
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let maps = &summary["findings"]["maps"];
    assert!(maps[0]["array"].is_null());
    let written = &maps[2]["array"];
    let press = array.press_of_total_force.unwrap();
    assert_eq!(written["press_of_total_force"], press);
    assert_eq!(written["arrays"][5]["elements"], 32);
    assert_eq!(written["arrays"][5]["sweep"], array.arrays[5].sweep);
}

// Σ of the squares of n parts is at least the square of their sum over n (Cauchy and Schwarz), which the noise s/√n undoes.
// Verifies: REP-018.
#[test]
fn a_finer_array_never_reads_less() {
    let generator = palpate::stats::random::Generator::new(7, 0);
    let noise: Vec<f64> = (0..5 * 32).map(|k| generator.normal(0, k)).collect();
    let at = |x: f64| LATERALS.iter().position(|&of| of == x).unwrap();
    let mut run = felt();
    run.arrays[0] = sweep("6.6", |x, k| 0.05 + 0.01 * noise[32 * at(x) + k]);
    let found = made(&run).found;
    let arrays = &found.maps[2].array.as_ref().unwrap().arrays;
    assert!(arrays.is_sorted_by(|a, b| a.sweep <= b.sweep && a.press <= b.press));
    assert!(arrays[0].sweep > 0.0);
}

// Verifies: REP-018.
#[test]
fn sweeps_of_arrays_that_do_not_fit_are_left_out() {
    let is_there = |run: &Run| made(run).found.maps[2].array.is_some();
    assert!(is_there(&felt()));
    let damages: [fn(&mut ArraySweep); 4] = [
        |of| of.depth = 3e-3,
        |of| of.laterals[0] = -9e-3,
        |of| of.phantom.inclusions.clear(),
        |of| of.phantom.probe.radius = 6e-3,
    ];
    for damage in damages {
        let mut run = felt();
        damage(&mut run.arrays[0]);
        assert!(!is_there(&run));
    }
    // Another probe than that of the reference presses with another width.
    let mut run = felt();
    let mut phantom = run.arrays[0].phantom.clone();
    phantom.probe.radius = 6e-3;
    run.arrays[0].phantom = phantom.clone();
    run.maps[2] = map(Some(phantom), &DEPTHS, |_| 0.1, |_| 0.0);
    assert!(!is_there(&run));
    run = felt();
    run.arrays.truncate(1);
    let made = made(&run);
    assert!(made.found.maps[2].array.is_none());
    assert!(made.page.contains("The run holds no sweep of an array"));
    assert!(made.figures.iter().all(|of| of.file_name != "pressure.svg"));
}

// γ of the press is 3 for the total force and √3.2 for the array, of the sweep √15.5 and √44.16; 3.29 is needed.
// Verifies: REP-030, REP-041.
#[test]
fn the_page_reads_what_the_numbers_say() {
    let made = made(&felt());
    let section = between(&made.page, "<section id=\"pressure\"", "</section>");
    let words = "the finest array has 1.69 times the γ of the total force; the rates are met for 1 of 1 phantoms, with the total force for 1.\
        |it has 0.60 times the γ of the total force; the rates are met for 0 of 1 phantoms, with the total force for 0.";
    assert_has(section, words);
    let cells =
        "3.94 (3.00)|0.40 (0.40)|1.26 (1.26)|1.79 (1.79)|1.79 (1.79)|1.79 (1.79)|6.65 (1.79)";
    let cells = cells
        .split('|')
        .map(|cell| format!("<td class=\"number\">{cell}</td>"));
    assert_has(section, &cells.collect::<String>());
    let figure = made.figure("pressure");
    // Six dots in each panel, one in the key.
    assert_eq!(figure.svg.matches("<circle ").count(), 2 * 6 + 1);
    assert_has(&figure.svg, "\n32\n|\n6.6 mm\n|\nneeded\n|\ntotal force\n");
    assert_has(&figure.caption, "16.61 times the γ of a single element");
}

// Verifies: REP-003, REP-018.
#[test]
fn a_sweep_that_never_stands_at_the_middle_has_no_press() {
    let mut run = felt();
    let laterals = vec![1e-3, 2e-3, 3e-3, 5e-3, 6e-3];
    for map in run.maps.iter_mut().chain([&mut run.reference]) {
        *map = moved(map, &laterals);
    }
    for of in &mut run.arrays {
        of.laterals = laterals.clone();
    }
    let made = made(&run);
    let array = made.found.maps[2].array.as_ref().unwrap();
    assert!(array.press_of_total_force.is_none() && array.arrays[0].press.is_none());
    let section = between(&made.page, "<section id=\"pressure\"", "</section>");
    assert!(section.contains("(none)") && !section.contains("In one press at x = 0, "));
    assert!(!made.figure("pressure").svg.contains("one press"));
}

fn moved(map: &palpate::force_map::ForceMap, laterals: &[f64]) -> palpate::force_map::ForceMap {
    use palpate::force_map::{ForceMap, ForceTable};
    let forces = map.forces().clone();
    let table = ForceTable::new(map.depths().to_vec(), laterals.to_vec(), forces).unwrap();
    ForceMap::new(map.source().clone(), map.phantom().cloned(), table).unwrap()
}
