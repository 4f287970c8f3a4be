//! The numbers of a file in another unit.

use proptest::prelude::*;

use crate::decimal::{format_scaled, parse_scaled};
use palpate_asserts::{assert_cases, seeded};

// Verifies: PHA-004, PHA-020, PHA-026.
#[test]
fn scaled_decimals_are_the_nearest_floats() {
    assert_cases("tables/decimals.txt", "scaled", |case| {
        let (text, power) = case.rsplit_once(" e").unwrap();
        let found = parse_scaled(text, power.parse().unwrap());
        found.map_or("no number".into(), |found| format!("{found:?}"))
    });
}

proptest! {
    #![proptest_config(seeded(2))]

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
