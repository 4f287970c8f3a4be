//! What the tests of all crates compare with.

mod cases;
mod random;

use std::fmt::Display;

pub use cases::{assert_cases, changed, line_matches, numbers_of};
pub use random::{axis, finite, seeded};

/// The numbers of a table, whose rows are lines.
pub fn numbers<const N: usize>(table: &str) -> Vec<[f64; N]> {
    let rows = table.trim().lines().map(row);
    rows.map(|row| row.try_into().unwrap()).collect()
}

/// The numbers of a line.
pub fn row(line: &str) -> Vec<f64> {
    let cells = line.split_whitespace().map(|cell| cell.parse().unwrap());
    cells.collect()
}

/// Asserts that a text has these parts, parted by `|`.
#[track_caller]
pub fn assert_has(text: &str, parts: &str) {
    for part in parts.split('|') {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
}

/// Asserts |found − expected| ≤ `ulps` units in the last place of `expected`.
#[track_caller]
pub fn assert_ulps(found: f64, expected: f64, ulps: f64) {
    let unit = (expected.abs().next_up() - expected.abs()).max(f64::from_bits(1));
    let distance = (found - expected).abs() / unit;
    assert!(
        distance <= ulps,
        "found {found:e}, expected {expected:e}: {distance} ulps > {ulps}"
    );
}

/// Asserts |found − expected| ≤ `tolerance`.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64) {
    let distance = (found - expected).abs();
    assert!(
        distance <= tolerance,
        "found {found:e}, expected {expected:e}: off by {distance:e} > {tolerance:e}"
    );
}

/// Asserts that a result is an error with this message, in which `[..]` stands for any text.
#[track_caller]
pub fn assert_error<T, E: Display>(result: Result<T, E>, expected: &str) {
    let found = result.err().expect("an error").to_string();
    let holds = line_matches(expected, &found) && !found.contains('\n');
    assert!(holds, "found {found:?}, expected {expected:?}");
}
