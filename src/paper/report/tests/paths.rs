//! γ along paths, on gels that are springs.

use super::run::*;
use crate::report::Run;
use palpate_asserts::assert_has;

/// The space left of `signal` beside the `columns`, by Gram and Schmidt, twice for the sake of rounding.
fn left(columns: &[Vec<f64>], signal: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let apart = |basis: &[Vec<f64>], of: &[f64]| {
        let mut rest = of.to_vec();
        for axis in basis.iter().chain(basis) {
            let share = dot(axis, &rest);
            rest.iter_mut()
                .zip(axis)
                .for_each(|(rest, axis)| *rest -= share * axis);
        }
        rest
    };
    for column in columns {
        let rest = apart(&basis, column);
        let length = dot(&rest, &rest).sqrt();
        if length > 1e-9 {
            basis.push(rest.iter().map(|x| x / length).collect());
        }
    }
    let rest = apart(&basis, signal);
    dot(&rest, &rest).sqrt()
}

/// Place (mm) and share of 4 mm of sample `k` of each path, as spec/report.md has them.
fn places(path: usize, k: usize) -> (f64, f64) {
    let share = (k as f64 + 0.5) / 640.0;
    let (pass, part) = (k / 160, (k % 160) as f64 / 160.0 + 0.5 / 160.0);
    let there_and_back = if pass % 2 == 0 { part } else { 1.0 - part };
    let (indentation, time) = (k / 128, ((k % 128) as f64 + 0.5) / 64.0);
    let (way, depth) = match path {
        0 => (share, 1.0),
        1 => (there_and_back, 1.0),
        2 => (there_and_back, 0.25 * (pass + 1) as f64),
        _ => (
            0.1 + 0.2 * indentation as f64,
            if time < 1.0 { time } else { 2.0 - time },
        ),
    };
    (20.0 * way - 10.0, depth)
}

// Verifies: REP-036, BNK-082.
#[test]
fn gamma_along_paths_is_what_the_nuisances_leave_of_the_signal() {
    // The least signal of the run: a triangle of 0.15 N over ±10 mm, and laterally a third of it at ±5 mm, in noise of 0.1 N.
    let signal = |x: f64| {
        let lateral = 0.05 * x.signum() * (1.0 - (x.abs() / 5.0 - 1.0).abs());
        [lateral, 0.15 * (1.0 - x.abs() / 10.0)]
    };
    let names = [
        "one slow pass",
        "four passes at one depth",
        "four passes, each deeper",
        "five indentations",
    ];
    let alt = made(&paper_run()).figure("paths").alt.clone();
    for (path, name) in names.iter().enumerate() {
        let places: Vec<_> = (0..640).map(|k| places(path, k)).collect();
        // Lateral samples, then normal ones; all forces grow with the depth.
        let series = |of: &dyn Fn(f64, f64, f64) -> [f64; 2]| -> Vec<f64> {
            let sample = |channel: usize| {
                let drift = |k: usize| 2.0 * k as f64 / 639.0 - 1.0;
                let places = places.iter().enumerate();
                places.map(move |(k, &(x, depth))| of(x, depth, drift(k))[channel])
            };
            sample(0).chain(sample(1)).collect()
        };
        let signal = series(&|x, depth, _| signal(x).map(|force| depth * force / 0.1));
        let columns = [
            series(&|_, _, _| [1.0, 0.0]),
            series(&|_, _, _| [0.0, 1.0]),
            series(&|_, _, drift| [drift, 0.0]),
            series(&|_, _, drift| [0.0, drift]),
            series(&|_, depth, _| [0.0, 1.48 * depth]),
            series(&|_, _, _| [0.0, 1.48 / 4.0]),
        ];
        let [nothing, most, all] = [0, 5, 6].map(|count| left(&columns[..count], &signal));
        assert_has(&alt, &format!("{name}: {nothing:.1}, {most:.1}, {all:.1}"));
    }
}

// Verifies: REP-036.
#[test]
fn maps_without_rows_near_the_surface_have_no_paths() {
    let run = Run {
        reference: map(None, &[3.9e-3, 4e-3], |_| 0.0, |_| 0.0),
        maps: vec![map(None, &[3.9e-3, 4e-3], |_| 0.1, |_| 0.0)],
        ..paper_run()
    };
    let figures = made(&run).figures;
    assert!(figures.iter().all(|figure| figure.file_name != "paths.svg"));
}
