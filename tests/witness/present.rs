//! What a test does without a program that it needs.

use std::io::Write;

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
