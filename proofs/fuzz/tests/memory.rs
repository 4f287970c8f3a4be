//! A small input does not make a reader use much memory. One test, since the count is of the whole
//! process.

// As in src/lib.rs.
use bolero as _;
use palpate_fuzz::TARGETS;
use palpate_fuzz::random::{Random, changed, kept};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Bytes that any input may use: an experiment has at most 100 000 pairs of 16 bytes, which the
/// target holds three times.
const ANY: usize = 8 << 20;
/// And for each byte of the input: each empty line of the oracle has an answer of 120 bytes, in a
/// vector that doubles.
const EACH: usize = 512;
/// Random cases of each target.
const CASES: u64 = 300;

/// Inputs that claim much with few characters, beside what is kept.
fn claims() -> Vec<Vec<u8>> {
    let texts = [
        "0:1e9:1e-9".to_string(),
        "0:999999.999999999:0.000000001".into(),
        "depths_mm = \"0:1e9:1e-9\"".into(),
        grid(2_000),
        "palpate-experiment 1\nseed 1\ntrials 99999999999\nsubject 1\ncondition 1\ninclusions 1\n".into(),
        r#"{"id":1,"op":"count_analysis","args":{"correct":[[1]],"trials":1000000000}}"#
            .into(),
        r#"{"id":1,"op":"proportion_interval","args":{"successes":1,"trials":1000000000,"confidence":0.5,"method":"wilson"}}"#
            .into(),
        "[".repeat(100_000),
        "{\"a\":".repeat(100_000),
        format!("a{} = 1", ".a".repeat(100_000)),
        format!("a = {}", "[".repeat(100_000)),
        format!("[{}a]", "a.".repeat(100_000)),
        ",".repeat(100_000),
        "\n".repeat(100_000),
        "9".repeat(100_000),
    ];
    texts.map(String::into_bytes).to_vec()
}

/// A CSV of `rows` rows that spans `rows`² poses.
fn grid(rows: usize) -> String {
    let header = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n".to_string();
    (0..rows).fold(header, |text, row| text + &format!("{row},{row},0,0\n"))
}

#[test]
fn memory_is_in_proportion_to_the_input() {
    for target in TARGETS {
        let kept: Vec<_> = kept(target.name).into_values().collect();
        let random = (0..CASES).map(|seed| changed(&kept, &mut Random::new(seed)));
        let cases = claims()
            .into_iter()
            .chain(kept.iter().cloned())
            .chain(random);
        let mut most = (0, 0);
        for bytes in cases {
            MEMORY.reset_peak_usage();
            let before = MEMORY.current_usage();
            target.check(&bytes);
            let used = MEMORY.peak_usage().saturating_sub(before);
            most = most.max((used, bytes.len()));
            let text = String::from_utf8_lossy(&bytes[..bytes.len().min(80)]);
            assert!(
                used <= ANY + EACH * bytes.len(),
                "{}: {used} bytes for {} of input, {text:?}",
                target.name,
                bytes.len()
            );
        }
        println!(
            "{}: at most {} bytes, for {} of input",
            target.name, most.0, most.1
        );
    }
}
