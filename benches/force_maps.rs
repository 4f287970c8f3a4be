//! Times the force-map job of `palpate run` on one core: five phantoms × 9 depths × 21 lateral positions x ≥ 0.
//!
//! `cargo bench -p palpate-benches --bench force_maps`. Processor time and peak memory are Linux's own accounting of this process.
//! The bar: 1.6 s of processor time, 150 MB. It is reported, not enforced: on a shared machine time is no gate.

use palpate::fem::{Contact, MESH_SIZE, Model};
use palpate::phantom::{BUILTIN_NAMES, Phantom};

const RUNS: usize = 5;

fn main() {
    let depths: Vec<f64> = (0..=8).map(|k| f64::from(k) * 0.5e-3).collect();
    let laterals: Vec<f64> = (0..=20).map(|k| f64::from(k) * 0.5e-3).collect();
    let mut seconds = Vec::new();
    for run in 0..RUNS {
        let before = processor_seconds();
        let mut line = String::new();
        for name in BUILTIN_NAMES {
            let phantom = Phantom::builtin(name).expect("a built-in name");
            let model = Model::new(&phantom, MESH_SIZE, Contact::default()).expect("a model");
            let map = model.map(&depths, &laterals, &|_| ()).expect("a map");
            line += &format!(
                "  {name}: {} nodes, {:.5} N",
                model.mesh().nodes.len(),
                map.table().normal().row(8)[0]
            );
        }
        if run == 0 {
            println!("force at 4 mm, x = 0:{line}");
        }
        seconds.push(processor_seconds() - before);
    }
    seconds.sort_by(f64::total_cmp);
    println!(
        "force-map job, {RUNS} runs: processor time {:.2} s (fastest), {:.2} s (median), {:.2} s (slowest); bar 1.6 s",
        seconds[0],
        seconds[RUNS / 2],
        seconds[RUNS - 1]
    );
    println!("peak memory {:.0} MB; bar 150 MB", peak_megabytes());
}

/// User and system time of this process, s; NaN where there is no /proc.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields are counted behind the program's name, which ends with the last parenthesis.
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    let ticks = |index: usize| {
        fields
            .get(index)
            .and_then(|field| field.parse::<f64>().ok())
            .unwrap_or(f64::NAN)
    };
    // Linux counts these in hundredths of a second on every machine.
    (ticks(11) + ticks(12)) / 100.0
}

/// The most memory that this process has held, MB; NaN where there is no /proc.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = peak.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes / 1e3)
}
