//! What a test does without a program that it needs.

use std::io::{ErrorKind, Write};
use std::process::Command;

/// Whether a test goes on. `missing` says which program is not there, if one is not: then it is skipped with a
/// notice, unless `PALPATE_REQUIRE_WITNESSES=1` asks for all of them.
///
/// Implements: FEM-082.
pub fn present(missing: Option<&str>) -> bool {
    let Some(program) = missing else { return true };
    let required = std::env::var_os("PALPATE_REQUIRE_WITNESSES").is_some_and(|value| value == "1");
    let holds = !required;
    assert!(
        holds,
        "{program} is not installed, but PALPATE_REQUIRE_WITNESSES=1 asks for it"
    );
    #[allow(clippy::explicit_write)]
    // Not by eprintln!, which the test runner keeps to itself when a test passes.
    writeln!(std::io::stderr(), "SKIPPED: {program} is not installed").unwrap();
    false
}

/// Python with a module: that of the environment, or the system's. `None`, with a notice, where one of both is missing.
pub fn python_with(module: &str) -> Option<Command> {
    let python = || {
        let own = std::env::var_os("PALPATE_PYTHON");
        Command::new(own.unwrap_or_else(|| "python3".into()))
    };
    let probe = python().args(["-c", &format!("import {module}")]).output();
    let is_unknown =
        |stderr: &[u8]| String::from_utf8_lossy(stderr).contains("ModuleNotFoundError");
    let missing = match probe {
        Err(error) if error.kind() == ErrorKind::NotFound => Some("Python"),
        Ok(output) if is_unknown(&output.stderr) => Some(module),
        _ => None,
    };
    present(missing).then(python)
}
