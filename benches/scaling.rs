//! How time grows with the nodes of a mesh and the hypotheses of a bank, and memory with the latter: `cargo bench -p palpate-benches
//! --bench scaling`. Prints each exponent, of a straight line through the logarithms of both, and writes `docs/scaling.svg`. Set
//! `RAYON_NUM_THREADS=1` for the times of one core.

use std::time::Instant;

use palpate::bank::BankPlan;
use palpate::chart::style::BLUE;
use palpate::chart::{Line, Panel, chart};
use palpate::fem::{Contact, Mesh, Model};
use palpate::phantom::Phantom;
use palpate::text::extremes;

const RUNS: usize = 3;
/// Mesh sizes of a model, m.
const SIZES: [f64; 6] = [1.6e-3, 1.13e-3, 0.8e-3, 0.57e-3, 0.4e-3, 0.28e-3];
/// Hypotheses of a bank.
const HYPOTHESES: [u32; 5] = [4, 8, 16, 32, 64];

/// The least of some runs, s.
fn seconds<T>(run: impl Fn() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

/// The most memory that this process has had, MB.
fn peak_mb() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").expect("Linux's accounting");
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.trim().strip_suffix(" kB"));
    1e-3 * number.and_then(|kb| kb.parse::<f64>().ok()).expect("kB")
}

/// The slope of the straight line through the points.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
    let above: f64 = points.iter().map(|(x, y)| (x - mean_x) * y).sum();
    let below: f64 = points
        .iter()
        .map(|(x, _)| (x - mean_x) * (x - mean_x))
        .sum();
    above / below
}

/// The panel of a cost and its exponent.
fn panel(what: &str, cost: &[(f64, f64)]) -> Panel {
    let logs: Vec<_> = cost.iter().map(|(x, y)| (x.log10(), y.log10())).collect();
    let exponent = slope(&logs);
    println!("{what}: exponent {exponent:.2}");
    for (x, y) in cost {
        println!("{x:>10} {y:>10.4} s");
    }
    let range = |of: fn(&(f64, f64)) -> f64| {
        let [least, most] = extremes(logs.iter().map(of)).expect("points");
        [least.floor(), most.ceil()]
    };
    let axes = [range(|point| point.0), range(|point| point.1)];
    let line = Line::new(BLUE, logs.clone()).dotted(3);
    Panel {
        caption: vec![format!(
            "Time grows as the {what} to the power {exponent:.2}."
        )],
        x_name: format!("log₁₀ of the {what}"),
        ..Panel::new("log₁₀ of the time (s)", axes, 200, vec![line])
    }
}

fn main() {
    let phantom = Phantom::builtin("2.6").expect("a built-in phantom");
    let plan = |hypotheses: u32| {
        let laterals: Vec<f64> = (-20..=20).map(|step| 5e-4 * f64::from(step)).collect();
        let mut plan = BankPlan::new(phantom.clone(), 4e-3, &laterals).expect("a plan");
        // On one side of the probe's path: none is the mirror image of another.
        let place = |k: u32| 8e-3 * f64::from(k + 1) / f64::from(hypotheses);
        plan.positions = (0..hypotheses).map(place).collect();
        plan.depths = vec![2.6e-3];
        plan
    };
    let mut memory = Vec::new();
    let bank = |&hypotheses: &u32| {
        let time = seconds(|| plan(hypotheses).bank().expect("a bank"));
        memory.push((f64::from(hypotheses), peak_mb()));
        (f64::from(hypotheses), time)
    };
    let bank: Vec<_> = HYPOTHESES.iter().map(bank).collect();
    println!("memory of a hypothesis: {:.3} MB", slope(&memory));
    for (hypotheses, mb) in memory {
        println!("{hypotheses:>10} {mb:>10.1} MB");
    }
    let model = |&size: &f64| {
        let nodes = Mesh::new(&phantom, size).expect("a mesh").nodes.len();
        let time = seconds(|| Model::new(&phantom, size, Contact::default()).expect("a model"));
        (nodes as f64, time)
    };
    let model: Vec<_> = SIZES.iter().map(model).collect();
    let panels = [
        panel("number of nodes of a mesh", &model),
        panel("number of hypotheses of a bank", &bank),
    ];
    let words = [
        "scaling",
        "How the time of a model and of a bank grows",
        "Time against nodes of a mesh and against hypotheses of a bank, all as logarithms: nearly straight lines.",
    ];
    let svg = chart(&panels, words).expect("a figure");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/scaling.svg");
    std::fs::write(path, svg).expect("docs is a folder");
}
