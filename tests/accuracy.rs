//! The stated accuracy of the oracle, by dense sweeps against mpmath (`spec/detector.md`, `tests/accuracy/sweep.py`). Skipped
//! with a notice where Python or mpmath is missing, unless `PALPATE_REQUIRE_WITNESSES=1` asks for it.

use std::process::Command;

use crate::witness::present::present;

// Verifies: DET-001, DET-014, ACC-014, ACC-020.
#[test]
fn every_function_is_as_accurate_as_stated() {
    let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python).args(["-c", "import mpmath"]).output();
    let missing = !probe.is_ok_and(|output| output.status.success());
    if !present(missing.then_some("mpmath")) {
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/accuracy/sweep.py");
    let output = Command::new(&python)
        .args([script, crate::program::PROGRAM, "oracle"])
        .output()
        .expect("Python starts");
    let said = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{errors}");
    assert!(said.lines().count() >= 23, "{said}");
}
