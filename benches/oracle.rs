//! Answers a second of `palpate oracle` through pipes (ORA-013): in a stream, and one question at a time.
//!
//! `cargo bench -p palpate-benches --bench oracle` fails below the rate that the specification promises for the stream.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitCode, Stdio};
use std::thread;
use std::time::Instant;

const REQUESTS: usize = 500_000;
const QUESTIONS: usize = 20_000;
// Verifies: ORA-013.
/// What ORA-013 promises, 1/s.
const PROMISED: f64 = 50_000.0;

fn oracle() -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut child = Command::new(std::env::current_exe().expect("a path of this program"))
        .arg("oracle")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the oracle starts");
    let input = child.stdin.take().expect("its input");
    let output = BufReader::new(child.stdout.take().expect("its output"));
    (child, input, output)
}

fn request(index: usize) -> String {
    let (gamma, eta) = (0.5 + 1e-5 * index as f64, 0.3 - 1e-6 * index as f64);
    format!(
        "{{\"id\":{index},\"op\":\"error_rates\",\"args\":{{\"gamma\":{gamma},\"eta\":{eta}}}}}\n"
    )
}

/// Questions a second when they are written as fast as the pipe takes them.
fn stream() -> f64 {
    let requests: String = (0..REQUESTS).map(request).collect();
    let (mut child, mut input, output) = oracle();
    let start = Instant::now();
    let writer = thread::spawn(move || input.write_all(requests.as_bytes()));
    let answers = output.split(b'\n').filter(|line| {
        line.as_ref()
            .is_ok_and(|line| line.windows(4).any(|part| part == b"\"ok\""))
    });
    assert_eq!(answers.count(), REQUESTS, "every request has its answer");
    let rate = REQUESTS as f64 / start.elapsed().as_secs_f64();
    writer
        .join()
        .expect("the writer ends")
        .expect("the oracle reads");
    assert!(child.wait().expect("the oracle ends").success());
    rate
}

/// Questions a second when each waits for the answer to the one before.
fn one_at_a_time() -> f64 {
    let (mut child, mut input, mut output) = oracle();
    let start = Instant::now();
    let mut answer = String::new();
    for index in 0..QUESTIONS {
        input
            .write_all(request(index).as_bytes())
            .expect("the oracle reads");
        answer.clear();
        output.read_line(&mut answer).expect("the oracle answers");
        assert!(answer.contains("\"ok\""), "{answer}");
    }
    let rate = QUESTIONS as f64 / start.elapsed().as_secs_f64();
    drop(input);
    assert!(child.wait().expect("the oracle ends").success());
    rate
}

fn main() -> ExitCode {
    // Started by itself it is the program.
    if std::env::args().nth(1).as_deref() == Some("oracle") {
        return palpate_program::main(["palpate", "oracle"].map(OsString::from));
    }
    let best = (0..3).map(|_| stream()).fold(0.0, f64::max);
    println!("error_rates in a stream: {best:.0} answers a second (best of 3 × {REQUESTS})");
    println!(
        "error_rates one at a time: {:.0} answers a second",
        one_at_a_time()
    );
    if best < PROMISED {
        eprintln!("below the promised {PROMISED:.0} a second");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
