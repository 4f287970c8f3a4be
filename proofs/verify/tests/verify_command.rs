//! `palpate-verify`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Runs the command with a folder of its own.
fn verify(folder: &str, arguments: &[&str]) -> (Output, PathBuf) {
    verify_on("0", folder, arguments)
}

/// The same on so many threads; 0 for one a processor.
fn verify_on(threads: &str, folder: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("verify")
        .join(folder);
    let _ = fs::remove_dir_all(&folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate-verify"));
    command.args(arguments).arg("--out").arg(&folder);
    let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
    (output, folder)
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
    assert_eq!(evidence["parts_left_out"].as_array().unwrap().len(), 5);
    // The heads alone: no test run was given.
    let heads = ["requirements.csv", "test-runs.csv"].map(|name| read(name).lines().count());
    assert_eq!(heads, [1, 1]);
    assert_eq!(evidence["requirements"], Value::Null);
    assert!(read("dossier.html").contains("not run: statistics, program, fem, kernel, timing"));
}

#[test]
fn a_test_run_is_joined_to_the_requirements() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("test-run.json");
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
    let arguments = ["--only", "tests", "--test-run", path.to_str().unwrap()];
    let (output, folder) = verify("tests", &arguments);
    // It is of another commit.
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(text(&output.stderr).contains("1 of 1 checks failed: tests.complete"));
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let row = "AAA-001,a.md,It MUST.,a.rs,program test,,,,program test,,,";
    assert_eq!(read("requirements.csv").lines().nth(1), Some(row));
    assert!(read("evidence.json").contains("\"test runs of another commit than this build's\""));
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
