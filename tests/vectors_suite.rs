//! The vectors are as their generator writes them, and the suite is sound, by the Python programs that come with it.
//! Where Python or mpmath is missing, a notice is given, unless `PALPATE_REQUIRE_WITNESSES=1` asks for them.

#[path = "witness/present.rs"]
mod present;

use std::io::ErrorKind;
use std::process::Command;

use present::present;

/// Python with mpmath: the one of the environment, or the system's.
fn python() -> Command {
    Command::new(std::env::var_os("PALPATE_PYTHON").unwrap_or_else(|| "python3".into()))
}

/// What is missing, if anything is.
fn missing() -> Option<&'static str> {
    match python().args(["-c", "import mpmath"]).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => Some("Python"),
        Ok(output) if String::from_utf8_lossy(&output.stderr).contains("ModuleNotFoundError") => {
            Some("mpmath")
        }
        _ => None,
    }
}

/// Runs a script of `vectors/`, which must succeed, and gives what it printed.
fn run(script: &str, arguments: &[&str]) -> Option<String> {
    if !present(missing()) {
        return None;
    }
    let path = format!("{}/vectors/{script}", env!("CARGO_MANIFEST_DIR"));
    let output = python()
        .args(["-B", &path])
        .args(arguments)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{script}: {text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(text)
}

// Verifies: VEC-007.
#[test]
fn the_files_are_as_the_generator_writes_them() {
    if let Some(text) = run("generate.py", &["--check"]) {
        assert!(text.contains("files are as generated"), "{text}");
    }
}

// Verifies: VEC-001, VEC-002, VEC-003, VEC-004, VEC-005, VEC-008, VEC-014.
#[test]
fn the_suite_is_sound() {
    if let Some(text) = run("check.py", &[]) {
        assert!(text.contains(" 0 problems"), "{text}");
    }
}
