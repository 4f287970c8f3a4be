//! The solver's speed against its bars, on one core: `cargo bench --bench fem_limits`. Prints each figure with its
//! bar, and ends with exit code 1 where one is missed by more than [`MARGIN`], which is what a busy machine adds to
//! the fastest of some runs. `--report` never fails. Times are the processor's, by Linux's accounting; elsewhere, the
//! clock's.

use std::time::Instant;

use palpate::fem::certify::certified_map;
use palpate::fem::{Contact, ContactState, MeshOptions, Model, Pose};
use palpate::phantom::{BUILTIN_NAMES, Phantom};

/// What a figure may be above its bar before the bench fails.
const MARGIN: f64 = 1.3;

/// The fastest of some runs, s.
fn fastest<T>(runs: usize, run: impl Fn() -> T) -> f64 {
    let time = |_| {
        let (before, start) = (processor_seconds(), Instant::now());
        std::hint::black_box(run());
        let elapsed = start.elapsed().as_secs_f64();
        (before.zip(processor_seconds())).map_or(elapsed, |(before, after)| after - before)
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

/// Time that this thread has had a processor, s; `None` where there is no /proc.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

fn model(name: &str, size: f64, refinement: usize) -> Model {
    let options = MeshOptions {
        size,
        refinement,
        ..MeshOptions::default()
    };
    let phantom = Phantom::builtin(name).expect("a built-in name");
    Model::new(&phantom, &options, Contact::default()).expect("a model")
}

/// The paper's poses with a force.
fn axes() -> (Vec<f64>, Vec<f64>) {
    let metres = |k: i32| f64::from(k) * 0.5e-3;
    (
        (1..=8).map(metres).collect(),
        (0..=20).map(metres).collect(),
    )
}

/// Mean time of a pose of the paper, started from the two above it as a map does, s.
fn warm_pose(model: &Model) -> f64 {
    let (depths, laterals) = axes();
    let surface = model.surface();
    let sweep = || {
        for &lateral in &laterals {
            let mut above = ContactState::untouched(surface.positions.len());
            let mut state = above.clone();
            for &depth in &depths {
                let pose = Pose { depth, lateral };
                let start = state.extrapolated(&above, 1.0);
                above = std::mem::replace(&mut state, surface.solve(pose, &start).expect("a pose"));
            }
        }
    };
    fastest(5, sweep) / (depths.len() * laterals.len()) as f64
}

/// The slope of ln t over ln n: the exponent of growth.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(n, t)| (n.ln(), t.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let products: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    products / logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum::<f64>()
}

fn main() {
    let mut missed = false;
    let mut line = |what: &str, found: f64, bar: f64, unit: &str| {
        let verdict = match found / bar {
            ratio if ratio <= 1.0 => "reached",
            ratio if ratio <= MARGIN => "missed, within the margin",
            _ => {
                missed = true;
                "MISSED"
            }
        };
        println!("{what}: {found:.3} {unit}, bar {bar} {unit}: {verdict}");
    };
    let small = model("2.6", 0.9e-3, 1);
    println!("small mesh: {} nodes", small.mesh().nodes.len());
    let build = fastest(9, || model("2.6", 0.9e-3, 1));
    line("condensed stiffness, small mesh", 1e3 * build, 60.0, "ms");
    line("warm pose, small mesh", 1e3 * warm_pose(&small), 0.3, "ms");
    let (depths, laterals) = axes();
    let poses = (depths.len() * laterals.len()) as f64;
    let map = fastest(3, || small.map(&depths, &laterals, &|_| ()).expect("a map"));
    println!(
        "pose with checks of its whole field, small mesh: {:.3} ms",
        1e3 * map / poses
    );

    let default = MeshOptions::default().size;
    let certified = || {
        let model = model("2.6", default, 1);
        certified_map(&model, &depths, &laterals, &|_| ()).expect("a map")
    };
    line(
        "map certified on three meshes, default mesh",
        fastest(3, certified),
        1.0,
        "s",
    );
    let job = || {
        for name in BUILTIN_NAMES {
            let model = model(name, default, 1);
            std::hint::black_box(model.map(&depths, &laterals, &|_| ()).expect("a map"));
        }
    };
    line(
        "the paper's five maps, default mesh",
        fastest(3, job),
        1.5,
        "s",
    );

    let mut series = Vec::new();
    for (size, refinement, runs) in [
        (0.9e-3, 1, 5),
        (0.9e-3, 2, 3),
        (0.9e-3, 3, 3),
        (0.9e-3, 4, 2),
    ] {
        let nodes = model("2.6", size, refinement).mesh().nodes.len() as f64;
        let build = fastest(runs, || model("2.6", size, refinement));
        println!("build of {nodes} nodes: {build:.3} s");
        series.push((nodes, build));
    }
    line(
        "growth of the build with nodes, exponent",
        exponent(&series),
        1.5,
        "",
    );
    if let Some(&(nodes, build)) = series.last() {
        // Scaled from the largest mesh of the series to 100 000 nodes by the bar's own growth.
        let scaled = build * (1e5 / nodes).powf(1.5);
        line("build at 100 000 nodes", scaled, 3.0, "s");
    }
    if missed && !std::env::args().any(|argument| argument == "--report") {
        std::process::exit(1);
    }
}
