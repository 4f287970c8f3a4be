//! The numbers of a file in another unit.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::decimal::{format_scaled, parse_scaled};

// Verifies: PHA-020.
#[test]
fn scaled_decimals_are_the_nearest_floats() {
    // The right-hand sides are rounded by the compiler. A product of floats with 1e-3 misses the
    // first two, a quotient of floats by 1000 the next two.
    for (text, power, expected) in [
        ("2.6", -3, 0.0026),
        ("6.5", -3, 0.0065),
        ("1.0566132852391916", -3, 0.0010566132852391916),
        ("1.7672673511353922", -3, 0.0017672673511353922),
        ("34", -3, 0.034),
        ("-0.5", -3, -0.0005),
        ("+1.5e-3", 3, 1.5),
        ("1.2e3", 3, 1.2e6),
        ("1E2", -3, 0.1),
        (".5", 0, 0.5),
        ("5.", 0, 5.0),
    ] {
        assert_eq!(parse_scaled(text, power), Some(expected), "{text}e{power}");
    }
}

// Verifies: PHA-004, PHA-020, PHA-026.
#[test]
fn what_is_no_finite_decimal_is_no_number() {
    let texts =
        "| 1|nan|NaN|inf|-inf|infinity|1e400|1e99999999999|0x10|1,5|1_000|e5|1e|.|--1|1e2147483647";
    for text in texts.split('|') {
        assert_eq!(parse_scaled(text, 3), None, "{text:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    // Verifies: PHA-020.
    #[test]
    fn scaling_back_gives_the_same_bits(bits: u64, power in -3..=3) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        // Also where the other unit has no such float: the text has every digit.
        let text = format_scaled(value, power);
        prop_assert_eq!(parse_scaled(&text, -power).map(f64::to_bits), Some(bits));
    }

    // Verifies: PHA-020.
    #[test]
    fn scaling_moves_the_decimal_point(digits in "[1-9][0-9]{6,18}", decimals in 0usize..4) {
        // Independent of exponents: the point moved by hand, then read by the standard library.
        let with_decimals = |count| {
            let (whole, decimals) = digits.split_at(digits.len() - count);
            format!("{whole}.{decimals}")
        };
        let moved: f64 = with_decimals(decimals + 3).parse().unwrap();
        prop_assert_eq!(parse_scaled(&with_decimals(decimals), -3), Some(moved));
    }

    // Verifies: PHA-020.
    #[test]
    fn no_text_makes_the_number_reader_panic(
        text in "(\\PC{0,8}|[-+]?[0-9.]{0,5}[eE][-+]?[0-9]{0,12})",
        power in -3..=3,
    ) {
        let _ = parse_scaled(&text, power);
    }
}
