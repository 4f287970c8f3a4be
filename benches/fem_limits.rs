//! The solver's speed against its bars, on one core: `cargo bench -p palpate-benches --bench fem_limits`. Prints each figure with its
//! bar, and ends with exit code 1 where one is missed by more than [`MARGIN`], which is what a busy machine adds.
//! `--report` never fails. Times are the processor's.

use palpate::fem::assembly::StiffnessMatrix;
use palpate::fem::cholesky::Factor;
use palpate::fem::{MESH_SIZE, Mesh};
use palpate::phantom::Phantom;
use rustix::time::{ClockId, clock_gettime};

const RUNS: usize = 5;
/// What a figure may be above its bar before the bench fails.
const MARGIN: f64 = 1.3;

/// The median of some runs, s.
fn median<T>(run: impl Fn() -> T) -> f64 {
    let time = |_| {
        let before = thread_seconds();
        std::hint::black_box(run());
        thread_seconds() - before
    };
    let mut times: Vec<f64> = (0..RUNS).map(time).collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

/// Time that this thread has had a processor, s.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn mesh(phantom: &Phantom, size: f64) -> Mesh {
    Mesh::new(phantom, size).expect("a mesh")
}

/// The compliance of a mesh's surface: stiffness matrix, factor, inverse of its corner.
fn condense(phantom: &Phantom, mesh: &Mesh) -> impl Sized + use<> {
    let matrix = StiffnessMatrix::assemble(mesh, phantom).expect("a matrix");
    let factor = Factor::new(&matrix).expect("a factor");
    factor.surface_compliance(&matrix).expect("a compliance")
}

fn main() {
    let mut missed = false;
    let mut line = |what: &str, nodes: usize, found: f64, bar: f64| {
        let verdict = match found / bar {
            ratio if ratio <= 1.0 => "reached",
            ratio if ratio <= MARGIN => "missed, within the margin",
            _ => {
                missed = true;
                "MISSED"
            }
        };
        println!("{what}, {nodes} nodes: {found:.4} s, bar {bar} s: {verdict}");
    };
    let phantom = Phantom::builtin("2.6").expect("a built-in name");
    for (size, bar) in [(0.61e-3, 0.05), (0.15e-3, 2.5)] {
        let mesh = mesh(&phantom, size);
        let time = median(|| condense(&phantom, &mesh));
        line(
            "from a mesh to its condensed stiffness",
            mesh.nodes.len(),
            time,
            bar,
        );
    }
    // Without a mirror image: the whole width is meshed.
    let asymmetric = phantom.changed(|parts| parts.inclusions[0].centre_x = 2e-3);
    let phantom = asymmetric.expect("within the well");
    let nodes = mesh(&phantom, MESH_SIZE).nodes.len();
    let time = median(|| condense(&phantom, &mesh(&phantom, MESH_SIZE)));
    line(
        "from an asymmetric phantom to its condensed stiffness",
        nodes,
        time,
        0.15,
    );
    if missed && !std::env::args().any(|argument| argument == "--report") {
        std::process::exit(1);
    }
}
