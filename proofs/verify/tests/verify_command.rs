//! `palpate-verify`.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use palpate_verify::program::sha256;
use serde_json::Value;

/// Runs the command with a folder of its own.
fn verify(folder: &str, arguments: &[&str]) -> (Output, PathBuf) {
    verify_on("0", folder, arguments)
}

/// The same on so many threads; 0 for one a processor.
fn verify_on(threads: &str, folder: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = place(folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-verify"));
    command.args(arguments).arg("--out").arg(&folder);
    let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
    (output, folder)
}

/// The path of a folder that is not there.
fn place(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("verify")
        .join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn evidence(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("evidence.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
#[ignore = "slow, and rarely breaks"]
fn a_soak_says_its_seed_and_the_probability_of_a_false_failure() {
    // The last of its seeds is beyond the largest number and begins again at 0.
    let seed = u64::MAX.to_string();
    let (output, folder) = verify("soak", &["--only", "soak", "--soak", "2", "--seed", &seed]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(
        text(&output.stdout),
        format!(
            "soak: 2 times 45 checks, seed {seed}\n\
             statistics: not run\nrates: not run\nprogram: not run\nfem: not run\nkernel: not run\n\
             timing: not run\ntests: no test run given\nsoak: all passed; a detector without defect fails such a run with probability 1.98e-6 at most\n\
             dossier.html, evidence.json, requirements.csv and test-runs.csv in {}\n",
            folder.display()
        )
    );
    // No progress bar in a pipe.
    assert!(output.stderr.is_empty());
    let evidence = evidence(&folder);
    assert_eq!(evidence["verdict"], "partial");
    assert_eq!(evidence["soak"]["seed"], u64::MAX);
    assert_eq!(evidence["soak"]["failure"], Value::Null);
}

#[test]
fn a_part_gives_all_files() {
    let (output, folder) = verify("rates", &["--only", "rates"]);
    assert!(output.status.success(), "{output:?}");
    assert!(text(&output.stdout).starts_with("statistics: not run\nrates: 8 of 8 checks passed\n"));
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let evidence = evidence(&folder);
    assert_eq!(evidence["checks"].as_array().unwrap().len(), 8);
    assert_eq!(evidence["verdict"], "partial");
    let left_out = ["statistics", "program", "fem", "kernel", "timing", "tests"];
    assert_eq!(evidence["parts_left_out"], serde_json::json!(left_out));
    // The heads alone: no test run was given.
    let heads = ["requirements.csv", "test-runs.csv"].map(|name| read(name).lines().count());
    assert_eq!(heads, [1, 1]);
    assert_eq!(evidence["requirements"], Value::Null);
    let told = format!("not run: {}. ", left_out.join(", "));
    assert!(read("dossier.html").contains(&told));
}

/// Writes a test run of another commit, in which the test of the only requirement passed.
fn foreign_test_run(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let run = serde_json::json!({
        "schema": "palpate-test-run",
        "commit": "another",
        "began": "",
        "ended": "",
        "system": "",
        "results_sha256": "",
        "requirements": [{
            "id": "AAA-001",
            "chapter": "a.md",
            "text": "It MUST.",
            "code": ["a.rs"],
            "tests": ["program test"],
            "proofs": [],
            "vectors": [],
        }],
        "entries": [{"name": "program test", "result": "passed", "seconds": 0.5}],
    });
    fs::write(&path, run.to_string()).unwrap();
    path.to_str().unwrap().into()
}

#[test]
fn a_test_run_is_joined_to_the_requirements() {
    let run = foreign_test_run("test-run.json");
    let (output, folder) = verify("tests", &["--only", "tests", "--test-run", &run]);
    // It is of another commit.
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(text(&output.stderr).contains("1 of 1 checks failed: tests.complete"));
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let row = "AAA-001,a.md,It MUST.,a.rs,program test,,,,program test,,,";
    assert_eq!(read("requirements.csv").lines().nth(1), Some(row));
    assert!(read("evidence.json").contains("\"test runs of another commit than this build's\""));
}

#[test]
fn a_test_run_is_checked_even_if_only_another_part_is_asked_for() {
    let run = foreign_test_run("test-run-of-another.json");
    let (output, folder) = verify("foreign", &["--only", "rates", "--test-run", &run]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(text(&output.stderr).contains("1 of 9 checks failed: tests.complete"));
    assert!(text(&output.stdout).contains("\ntests: 0 of 1 checks passed\n"));
    let evidence = evidence(&folder);
    assert_eq!(evidence["verdict"], "failed");
    let left_out = ["statistics", "program", "fem", "kernel", "timing"];
    assert_eq!(evidence["parts_left_out"], serde_json::json!(left_out));
    let page = fs::read_to_string(folder.join("dossier.html")).unwrap();
    let (head, _) = page.split_once("<main>").unwrap();
    assert!(head.contains("<strong>test runs of another commit than this build&#39;s: 1"));
}

#[test]
fn a_name_without_a_folder_is_the_file_here_and_not_one_of_the_search_path() {
    let [here, elsewhere] = ["program-here", "program-elsewhere"].map(place);
    // Each notes beside itself how it was run.
    for (folder, end) in [(&here, "exit 3"), (&elsewhere, "exit 4")] {
        let program = folder.join("palpate");
        fs::create_dir_all(folder).unwrap();
        let script = format!("#!/bin/sh\necho \"$@\" >> \"$0.ran\"\n{end}\n");
        fs::write(&program, script).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = [elsewhere.clone()]
        .into_iter()
        .chain(std::env::split_paths(&path));
    let out = place("program");
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-verify"));
    command.args(["--only", "program", "--program", "palpate", "--out"]);
    command.arg(&out).current_dir(&here);
    command.env("PATH", std::env::join_paths(path).unwrap());
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let ran = fs::read_to_string(here.join("palpate.ran")).unwrap();
    for asked in ["--version", "oracle", "solve", "detect"] {
        let mut lines = ran.lines();
        assert!(lines.any(|line| line.starts_with(asked)), "{asked}: {ran}");
    }
    assert!(!elsewhere.join("palpate.ran").exists());
    let program = here.join("palpate");
    let judged = serde_json::json!([program, sha256(&program).unwrap()]);
    assert_eq!(evidence(&out)["measured_here"]["executables"][1], judged);
}

#[test]
#[ignore = "slow, and rarely breaks"]
fn the_same_build_gives_the_same_evidence_with_any_number_of_threads() {
    let evidence = |threads: &str| {
        let (output, folder) = verify_on(threads, threads, &["--only", "rates"]);
        assert!(output.status.success(), "{output:?}");
        let mut evidence = evidence(&folder);
        let keys = evidence.as_object_mut().unwrap();
        keys.remove("measured_here").unwrap();
        evidence
    };
    assert_eq!(evidence("1"), evidence("3"));
}

#[test]
fn bad_arguments_are_refused() {
    for arguments in [
        &["--soak", "0"][..],
        &["--soak", "-1"],
        &["--soak", "many"],
        &["--seed", "1"],
        &["--soak", "1", "--seed", "-1"],
        &["--only", "soak"],
        &["--only", "tests"],
        &["--test-run", "Cargo.toml"],
        &["--test-run", "nowhere.json"],
        &["--sbom", "Cargo.toml"],
        &["--planted", "Cargo.toml"],
        &["--only", "statistics,physics"],
        &["--only", ""],
        &["--program", ""],
    ] {
        let (output, folder) = verify("refused", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let error = text(&output.stderr);
        assert_eq!(error.lines().count(), 1, "{error}");
        assert!(!folder.exists(), "{arguments:?}");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_told_before_the_work() {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("verify-file");
    fs::write(&file, "").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-verify"));
    let output = command.arg("--out").arg(file.join("folder")).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).starts_with("palpate-verify: make folder "),
        "{output:?}"
    );
}
