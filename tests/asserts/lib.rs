//! What the tests of all crates compare with.

/// The numbers of a table, whose rows are lines.
pub fn numbers<const N: usize>(table: &str) -> Vec<[f64; N]> {
    let row = |line: &str| {
        let cells = line.split_whitespace().map(|cell| cell.parse().unwrap());
        cells.collect::<Vec<f64>>().try_into().unwrap()
    };
    table.trim().lines().map(row).collect()
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
