//! Instructions of one step of the servo kernel on a 9 × 41 table, counted by callgrind on every kind of
//! path, with a hard ceiling: `cargo bench -p palpate-kernel-bench` (needs valgrind and the runner
//! `gungraun-runner`). Ends with an error above it (SRV-060).

#![allow(missing_docs)] // of what its macros make

use std::hint::black_box;

use gungraun::prelude::*;
use gungraun::{Callgrind, EventKind, LibraryBenchmarkConfig};
use palpate_core::servo::{Command, Fault, Input, Limits, Mode, Request, Sample, State, step};
use palpate_kernel_bench::{PaperTable, armed, sample};

type Case = (PaperTable, Limits, State, Input);

fn case(state: State, sample: Option<Sample>, request: Request) -> Case {
    let limits = Limits::for_playback(4.0, 1000).expect("the limits are valid");
    (
        PaperTable::default(),
        limits,
        state,
        Input { sample, request },
    )
}

fn playing(change: impl FnOnce(&mut Sample)) -> Case {
    let mut sample = sample();
    change(&mut sample);
    case(armed(), Some(sample), Request::None)
}

#[library_benchmark]
#[bench::inside(playing(|_| ()))]
#[bench::first_cell(playing(|s| (s.depth, s.lateral) = (0.0, -10e-3)))]
#[bench::last_cell(playing(|s| (s.depth, s.lateral) = (4e-3, 10e-3)))]
#[bench::outside(playing(|s| (s.depth, s.lateral) = (1.0, -1.0)))]
#[bench::above_the_surface(playing(|s| s.depth = -1e-3))]
#[bench::not_a_number(playing(|s| s.depth = f32::NAN))]
#[bench::infinite(playing(|s| s.lateral = f32::INFINITY))]
#[bench::let_go(playing(|s| s.deadman = false))]
#[bench::device_fault(playing(|s| s.device_fault = true))]
#[bench::stale(playing(|s| s.sequence = 4711))]
#[bench::no_sample(case(armed(), None, Request::None))]
#[bench::disarmed(case(State::default(), Some(sample()), Request::Arm))]
#[bench::late(case(State { missed: 20, ..armed() }, None, Request::None))]
#[bench::faulted(case(State { mode: Mode::Faulted(Fault::Device), ..armed() }, Some(sample()), Request::Arm))]
#[bench::overwritten(case(State { missed: 9, sequence: None, force: palpate_core::force::Force { lateral: f32::NAN, normal: 0.0 }, ..armed() }, Some(sample()), Request::None))]
fn servo_step((paper, limits, state, input): Case) -> (State, Command) {
    let table = paper.table().expect("the servo takes it");
    black_box(measured(&table, &limits, state, input))
}

/// What is counted: the step alone.
#[inline(never)]
fn measured(
    table: &palpate_core::servo::Table,
    limits: &Limits,
    state: State,
    input: Input,
) -> (State, Command) {
    step(table, limits, state, input)
}

// Verifies: SRV-060. The ceiling of 400.
library_benchmark_group!(name = kernel; benchmarks = servo_step);

main!(
    config = LibraryBenchmarkConfig::default().tool(
        Callgrind::default()
            .entry_point(gungraun::EntryPoint::Custom("*::measured".to_owned()))
            .hard_limits([(EventKind::Ir, 400)])
    );
    library_benchmark_groups = kernel
);
