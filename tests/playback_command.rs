//! `palpate timing`, `play` and `experiment` as a person runs them.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, Matrix, Source};

fn palpate(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder of this test alone, emptied.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("playback")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The file of a map with `stiffness` (N/m) along the depth, and a bump of `bump` at x = 0.
fn map(folder: &Path, name: &str, stiffness: f64, bump: f64) -> String {
    let depths: Vec<f64> = (0..9).map(|row| f64::from(row) * 0.5e-3).collect();
    let laterals: Vec<f64> = (-20..=20)
        .map(|column| f64::from(column) * 0.5e-3)
        .collect();
    let normal = Matrix::from_fn(9, 41, |row, column| {
        let x = laterals[column] / 3e-3;
        depths[row] * (stiffness + bump * (-x * x).exp())
    });
    let lateral = Matrix::from_fn(9, 41, |_, _| 0.0);
    let forces = ForceTable::new(depths, laterals, Force::new(lateral, normal)).unwrap();
    let source = Source::Measured {
        file: "made".into(),
        note: "for a test".into(),
    };
    let path = folder.join(name);
    std::fs::write(
        &path,
        ForceMap::new(source, None, forces).unwrap().to_json(),
    )
    .unwrap();
    path.display().to_string()
}

// Verifies: CLI-060.
#[test]
fn timing_prints_its_figures_as_json() {
    let output = palpate(&[
        "timing",
        "--cycles",
        "2000",
        "--budget-us",
        "60000000",
        "--format",
        "json",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (figures["cycles"].as_u64(), figures["misses"].as_u64()),
        (Some(2000), Some(0))
    );
    assert_eq!(figures["passed"].as_bool(), Some(true));
    for quantity in ["response_us", "compute_us"] {
        let of = |key: &str| figures[quantity][key].as_f64().unwrap();
        let ordered = [of("p50"), of("p99"), of("p99_9"), of("max")];
        assert!(ordered[0] > 0.0 && ordered.is_sorted(), "{ordered:?}");
    }
    let share = figures["compute_share"].as_f64().unwrap();
    assert!(share > 0.0 && share < 1.0);
    let table = text(&palpate(&["timing", "--cycles", "1000", "--budget-us", "60000000"]).stdout);
    assert!(
        table.contains("p99.9") && table.contains("kept: 0 missed"),
        "{table}"
    );
}

// Verifies: CLI-061.
#[test]
fn a_budget_that_is_broken_is_a_failed_check() {
    // No machine is too quick for this: cycles that come at a pace begin with a sleep, and no wake-up by the system
    // is within 1 µs of its time 999 times in 1000.
    let output = palpate(&["timing", "--cycles", "1000", "--budget-us", "1", "--paced"]);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.starts_with("palpate: timing: "), "{error}");
    assert!(error.contains("expected at most 1 in 1000"), "{error}");
}

// Verifies: CLI-062.
#[test]
fn a_map_that_the_servo_refuses_is_refused_with_its_file() {
    let folder = folder("refused");
    let hard = map(&folder, "hard.json", 30_000.0, 0.0);
    let output = palpate(&["timing", "--map", &hard]);
    assert_eq!(output.status.code(), Some(2));
    let error = text(&output.stderr);
    assert!(
        error.contains(&hard) && error.contains("normal_force_n[7][0] = 105"),
        "{error}"
    );
    assert_eq!(error.lines().count(), 1);
}

// Verifies: CLI-063, CLI-064.
#[test]
fn a_map_too_stiff_is_refused_or_scaled() {
    let folder = folder("stiff");
    let stiff = map(&folder, "stiff.json", 2_400.0, 0.0);
    // 4 mm, and half a millimetre by which the table is continued: 10.8 N. 2b/T of the paper's display: 2 · 0.6 N·s/m / 1 ms.
    for (force, found, allowed, scale) in [
        ("4", "10.8000 N of force", "4.0000", 4.0 / 10.8),
        ("8", "2400.0", "1200.0000", 0.5),
    ] {
        let output = palpate(&["play", "--map", &stiff, "--max-force", force]);
        assert_eq!(output.status.code(), Some(2));
        let error = text(&output.stderr);
        for part in [found, allowed, "--scale"] {
            assert!(error.contains(part), "{part}: {error}");
        }
        let scaled = ["--max-force", force, "--scale", "--format", "json"];
        let output = palpate(&[&["play", "--map", &stiff], &scaled[..]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!((summary["scale"].as_f64().unwrap() - scale).abs() < 1e-4);
    }
    let output = palpate(&["play", "--map", &stiff, "--scale", "--max-force", "21"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("--max-force 21"));
}

// Verifies: CLI-063, CLI-065, CLI-067.
#[test]
fn a_session_is_played_recorded_and_played_again() {
    let folder = folder("record");
    let gel = map(&folder, "gel.json", 300.0, 0.0);
    let other = map(&folder, "other.json", 301.0, 0.0);
    let file = folder.join("session.txt").display().to_string();
    let output = palpate(&["play", "--map", &gel, "--record", &file, "--format", "json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["end"].as_str(), Some("ended as asked"));
    assert_eq!(summary["cycles"].as_u64(), Some(4000));
    assert_eq!(summary["missed"].as_u64(), Some(1));
    assert!(summary["played"].as_u64().unwrap() > 3500);
    let again = palpate(&["play", "--map", &gel, "--replay", &file]);
    assert!(again.status.success());
    assert_eq!(
        text(&again.stdout),
        "4000 cycles, all forces the same to the bit\n"
    );
    let differs = palpate(&["play", "--map", &other, "--replay", &file]);
    assert_eq!(differs.status.code(), Some(1));
    assert!(
        text(&differs.stderr).contains("cycle "),
        "{}",
        text(&differs.stderr)
    );
    std::fs::write(&file, "nonsense\n").unwrap();
    let wrong = palpate(&["play", "--map", &gel, "--replay", &file]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("line 1: \"nonsense\""));
}

// Verifies: CLI-066.
#[cfg(unix)]
#[test]
fn signals_end_a_session_as_asked() {
    let folder = folder("signals");
    let gel = map(&folder, "gel.json", 300.0, 0.0);
    for signal in ["INT", "TERM", "HUP"] {
        // A day of the virtual clock: no machine is through with it before the signal.
        let child = command(&["play", "--map", &gel, "--seconds", "86400"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        let kill = Command::new("kill")
            .args([format!("-{signal}"), child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(0),
            "{signal}: {}",
            text(&output.stderr)
        );
        assert!(text(&output.stdout).starts_with("ended as asked\n"));
    }
}

/// Runs the ideal observer with a journal of its own.
fn experiment(folder: &Path, maps: &[String; 2], extra: &[&str]) -> Output {
    let journal = folder.join("journal").display().to_string();
    let inclusion = format!("6.6={}", maps[1]);
    let mut arguments = vec![
        "experiment",
        "--reference",
        &maps[0],
        "--inclusion",
        &inclusion,
        "--journal",
        &journal,
        "--seed",
        "5",
    ];
    arguments.extend(extra);
    palpate(&arguments)
}

// Verifies: CLI-070, CLI-071, CLI-072, CLI-073.
#[test]
fn an_experiment_goes_on_after_an_abort() {
    let folder = folder("experiment");
    let maps = [
        map(&folder, "none.json", 300.0, 0.0),
        map(&folder, "6.6.json", 300.0, 60.0),
    ];
    let ideal = ["--observer", "ideal", "--noise", "2", "--trials", "20"];
    let whole = experiment(&folder, &maps, &ideal);
    assert!(whole.status.success(), "{}", text(&whole.stderr));
    let row = text(&whole.stdout);
    assert!(
        row.starts_with("subject,condition,trials,6.6\n1,FEM data,20,"),
        "{row}"
    );
    // Cut back to seven answers and part of a line: the end is the same.
    let journal = folder.join("journal");
    let answers = std::fs::read_to_string(&journal).unwrap();
    let kept: String = answers
        .lines()
        .take(6 + 7)
        .map(|line| format!("{line}\n"))
        .collect();
    std::fs::write(&journal, kept.clone() + "rig").unwrap();
    assert_eq!(text(&experiment(&folder, &maps, &ideal).stdout), row);
    assert_eq!(std::fs::read_to_string(&journal).unwrap(), answers);
    // Another experiment in the same journal.
    let other = experiment(
        &folder,
        &maps,
        &["--observer", "ideal", "--noise", "2", "--trials", "21"],
    );
    assert_eq!(other.status.code(), Some(2));
    let refusal = text(&other.stderr);
    assert!(refusal.contains("another experiment (seed"), "{refusal}");
    assert!(
        refusal.contains("20 trials") && refusal.contains("21 trials"),
        "{refusal}"
    );
    // A person who goes away keeps what was answered.
    std::fs::write(&journal, kept).unwrap();
    let mut person = command(&["experiment", "--reference", &maps[0], "--inclusion"]);
    let child = person
        .args([
            &format!("6.6={}", maps[1]),
            "--journal",
            &journal.display().to_string(),
        ])
        .args(["--seed", "5", "--trials", "20"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    use std::io::Write;
    child
        .stdin
        .as_ref()
        .unwrap()
        .write_all(b"\n\n3\n1\n\nq\n")
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(
        text(&output.stdout).starts_with("8 of 20 pairs answered"),
        "{}",
        text(&output.stdout)
    );
    assert!(text(&output.stderr).contains("expected 1, 2 or q"));
    // An input without an end is no person.
    let zeros = std::fs::File::open("/dev/zero").unwrap();
    let output = person.stdin(zeros).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("8 of 20 pairs answered"));
}

// Verifies: CLI-002.
#[test]
fn an_experiment_that_is_mistyped_is_refused_in_one_line() {
    for (arguments, part) in [
        (vec!["experiment"], "--reference"),
        (
            vec![
                "experiment",
                "--reference",
                "a",
                "--inclusion",
                "b",
                "--journal",
                "c",
                "--seed",
                "1",
            ],
            "NAME=FILE",
        ),
        (
            vec![
                "experiment",
                "--reference",
                "a",
                "--inclusion",
                "6.6=b",
                "--journal",
                "c",
                "--seed",
                "1",
                "--observer",
                "ideal",
            ],
            "--noise",
        ),
        (vec!["play", "--map", "nowhere.json"], "nowhere.json"),
        (vec!["timing", "--cycles", "10"], "10 is not in 1000.."),
    ] {
        let output = palpate(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let error = text(&output.stderr);
        assert!(
            error.contains(part) && error.lines().count() == 1,
            "{error}"
        );
    }
}
