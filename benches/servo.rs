//! The servo kernel and the whole loop on the simulated device, for people: `cargo bench -p palpate-benches --bench servo`.
//! Ends with 1 if the upper bound of the confidence interval of the loop's mean time exceeds the budget
//! of 1 ms (SRV-060). The instruction ceiling of `benches/kernel/` is the gate that does
//! not depend on the machine's load.

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use criterion::Criterion;
use palpate::hid::simulated::{Mechanics, PAPER, SimulatedDevice, Trajectory};
use palpate::hid::{HapticDevice, Session};
use palpate::servo::{Input, Limits, Request, State, step};
use palpate_kernel_bench::{PaperTable, armed, sample};

/// The time of a cycle at 1 kHz, ns.
///
/// Implements: SRV-060.
const BUDGET: f64 = 1e6;

// Verifies: SRV-060.
fn main() -> ExitCode {
    // An estimate of an earlier run is none of this one.
    let _ = std::fs::remove_file(estimates());
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    let paper = PaperTable::default();
    let table = paper.table().expect("the table is valid");
    let limits = Limits::for_playback(4.0, PAPER.period_us).expect("the limits are valid");

    let state: State = armed();
    let input = Input {
        sample: Some(sample()),
        request: Request::None,
    };
    criterion.bench_function("step", |bencher| {
        bencher.iter(|| {
            step(
                black_box(&table),
                black_box(&limits),
                black_box(state),
                black_box(input),
            )
        });
    });

    // Without end, as far as the bench goes.
    let trajectory = Trajectory::probing(3e-3, 9e-3, Duration::from_secs(1_000_000));
    let device = SimulatedDevice::new(PAPER, Mechanics::PAPER, trajectory, Vec::new());
    let mut session = Session::begin(device, table, limits).expect("the device is sound");
    criterion.bench_function("loop", |bencher| {
        bencher.iter(|| {
            session
                .cycle(black_box(Request::None))
                .expect("the device works")
        });
    });
    println!(
        "the loop ran {:?} of the device's time",
        session.device().now()
    );
    criterion.final_summary();
    verdict()
}

/// Where criterion puts the loop's estimates: in CARGO_TARGET_DIR, or else in the folder of the workspace.
fn estimates() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let target = target.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"));
    target.join("criterion/loop/new/estimates.json")
}

/// Compares criterion's upper confidence bound of the loop's mean with the budget.
fn verdict() -> ExitCode {
    let file = estimates();
    let Ok(text) = std::fs::read_to_string(&file) else {
        eprintln!(
            "no estimate in {}: the loop was not measured",
            file.display()
        );
        return ExitCode::FAILURE;
    };
    let estimates: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    match estimates["mean"]["confidence_interval"]["upper_bound"].as_f64() {
        Some(upper) if upper <= BUDGET => {
            println!(
                "loop: at most {:.2} µs with 95 % confidence, budget {} µs: kept",
                upper * 1e-3,
                BUDGET * 1e-3
            );
            ExitCode::SUCCESS
        }
        upper => {
            eprintln!("loop: upper bound {upper:?} ns, budget {BUDGET} ns: broken");
            ExitCode::FAILURE
        }
    }
}
