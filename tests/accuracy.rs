//! The stated accuracy of the oracle, by dense sweeps against mpmath (`spec/detector.md`, `tests/accuracy/sweep.py`). Skipped
//! with a notice where Python or mpmath is missing, unless `PALPATE_REQUIRE_WITNESSES=1` asks for it.

use crate::witness::printed;

// Verifies: DET-001, DET-014, ACC-014, ACC-020.
#[test]
#[ignore = "slow, and rarely breaks"]
fn every_function_is_as_accurate_as_stated() {
    let oracle = [crate::program::PROGRAM, "oracle"];
    if let Some(said) = printed("tests/accuracy/sweep.py", &oracle) {
        assert!(said.lines().count() >= 23, "{said}");
    }
}
