//! `palpate verify`.

use std::process::{Command, Output};

fn verify(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.arg("verify").args(arguments).output().unwrap()
}

// Verifies: CLI-051, CLI-052, CLI-054.
#[test]
fn a_soak_says_its_seed_and_the_probability_of_a_false_failure() {
    // The last of its seeds is beyond the largest number and begins again at 0.
    let seed = u64::MAX.to_string();
    let output = verify(&["--soak", "2", "--seed", &seed]);
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        said,
        format!(
            "2 times 29 checks, seed {seed}\n\
             all passed; a detector without defect fails such a run with probability 1.45e-6 at most\n"
        )
    );
    // No progress bar in a pipe.
    assert!(output.stderr.is_empty());
}

// Verifies: CLI-052.
#[test]
fn bad_arguments_are_refused() {
    for arguments in [
        &["--soak", "0"][..],
        &["--soak", "-1"],
        &["--soak", "many"],
        &["--seed", "1"],
        &["--soak", "1", "--seed", "-1"],
    ] {
        let output = verify(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}
