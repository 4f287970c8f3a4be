//! Times the force-map job of `palpate run` on one core: five phantoms × 9 depths × 21 lateral positions x ≥ 0.
//!
//! `cargo bench -p palpate-benches --bench force_maps`. Processor time and peak memory are Linux's own accounting of this process.
//! The bar: 1.6 s of processor time, 150 MB. It is reported, not enforced: on a shared machine time is no gate.
//!
//! In the same run, on the same matrices, it times what no implementation of this method can do without on these parts: faer's numeric factor
//! and the inverse of its corner for each model; for each pose two Cholesky factors of the size of its contact, those of C_nn and of the slip,
//! and the back-substitution of its field, 24 poses at once. That is the bound to which our stages are compared.

use std::time::{Duration, Instant};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::inverse::{inverse, inverse_scratch};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Conj, Mat, Par, Side};
use palpate::fem::assembly::StiffnessMatrix;
use palpate::fem::{Contact, MESH_SIZE, Model, Pose};
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
            let map = model.map(&depths, &laterals, &|_| true).expect("a map");
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
    let stages = BUILTIN_NAMES.map(|name| stages(name, &depths, &laterals));
    for (stage, name) in ["models", "poses"].into_iter().enumerate() {
        let [ours, bound] =
            [0, 1].map(|of| stages.iter().map(|all| all[stage][of]).sum::<Duration>());
        let [ours, bound] = [ours, bound].map(|time| time.as_secs_f64());
        println!(
            "{name}: {ours:.3} s, bound {bound:.3} s: {:.2} times",
            ours / bound
        );
    }
}

/// The time of a job, and what it gives.
fn timed<T>(job: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let found = std::hint::black_box(job());
    (start.elapsed(), found)
}

/// How long the model and the poses of a map take, ours and the bound.
fn stages(name: &str, depths: &[f64], laterals: &[f64]) -> [[Duration; 2]; 2] {
    let phantom = Phantom::builtin(name).expect("a built-in name");
    let build = || Model::new(&phantom, MESH_SIZE, Contact::default()).expect("a model");
    build();
    let (of_model, model) = timed(build);
    let (of_poses, _) = timed(|| model.map(depths, laterals, &|_| true).expect("a map"));
    let matrix = StiffnessMatrix::assemble(model.mesh(), &phantom).expect("a matrix");
    let corner = matrix.unknowns() - matrix.first_surface_unknown;
    let poses = laterals
        .iter()
        .flat_map(|&lateral| depths.iter().map(move |&depth| Pose { depth, lateral }));
    let contacts: Vec<usize> = poses
        .map(|pose| {
            model
                .solve(pose)
                .expect("a pose")
                .contact()
                .map_or(0, |state| state.active.len())
        })
        .collect();
    let [of_factor, of_fields] = sparse(&matrix, contacts.len());
    let of_corner = timed_inverse(corner);
    let (of_contacts, ()) = timed(|| contacts.iter().for_each(|&size| contact_factors(size)));
    [
        [of_model, of_factor + of_corner],
        [of_poses, of_contacts + of_fields],
    ]
}

/// The numeric factor of a stiffness matrix, and the back-substitution of fields.
fn sparse(matrix: &StiffnessMatrix, fields: usize) -> [Duration; 2] {
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    let (upper, identity) = (matrix.upper.symbolic(), SymmetricOrdering::Identity);
    let symbolic =
        factorize_symbolic_cholesky(upper, Side::Upper, identity, params).expect("memory");
    let mut values = vec![1.0; symbolic.len_val()];
    let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
    let mut memory = MemBuffer::new(request);
    let (of_factor, found) = timed(|| {
        let upper = matrix.upper.as_ref();
        let stack = MemStack::new(&mut memory);
        symbolic
            .factorize_numeric_llt(
                &mut values,
                upper,
                Side::Upper,
                Default::default(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .map(|_| ())
    });
    found.expect("a factor");
    let SymbolicCholeskyRaw::Supernodal(raw) = symbolic.raw() else {
        panic!("supernodes were asked for");
    };
    let factor = SupernodalLltRef::new(raw, &values);
    let mut rows = vec![1.0; 24 * matrix.unknowns()];
    let mut memory = MemBuffer::new(raw.solve_in_place_scratch::<f64>(24, Par::Seq));
    let (of_fields, ()) = timed(|| {
        for _ in 0..fields.div_ceil(24) {
            let u = faer::MatMut::from_row_major_slice_mut(&mut rows, matrix.unknowns(), 24);
            factor.l_transpose_solve_with_conj(Conj::No, u, Par::Seq, MemStack::new(&mut memory));
        }
    });
    [of_factor, of_fields]
}

/// The inverse of a matrix by its factor.
fn timed_inverse(size: usize) -> Duration {
    let (factor, mut found) = (
        Mat::<f64>::identity(size, size),
        Mat::<f64>::zeros(size, size),
    );
    let mut memory = MemBuffer::new(inverse_scratch::<f64>(size, Par::Seq));
    timed(|| {
        inverse(
            found.as_mut(),
            factor.as_ref(),
            Par::Seq,
            MemStack::new(&mut memory),
        )
    })
    .0
}

fn contact_factors(size: usize) {
    let matrix = Mat::<f64>::identity(size, size);
    for _ in 0..2 {
        std::hint::black_box(matrix.llt(Side::Lower).expect("a factor"));
    }
}

/// Processor time of this process, s.
fn processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The most memory that this process has held, MB; NaN where there is no /proc.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = peak.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes / 1e3)
}
