//! Expected values: by hand.

use super::*;

const DEPTH: [f64; 4] = [0.0026, 0.0046, 0.0066, 0.0086];
const FALLING: [f64; 4] = [8.0, 4.0, 2.0, 1.0];
const SIZE: [f64; 3] = [1.0, 2.0, 4.0];
const RISING: [f64; 3] = [0.5, 1.5, 3.5];

// Verifies: DET-090.
#[test]
fn largest_depth() {
    let largest = |required| largest_detectable_depth(&DEPTH, &FALLING, required).unwrap();
    // Half way between γ = 4 at 4.6 mm and γ = 2 at 6.6 mm.
    let Reach::Limit(depth) = largest(3.0) else {
        panic!("a limit")
    };
    assert!((depth - 0.0056).abs() < 1e-17);
    assert_eq!(largest(8.0), Reach::Limit(0.0026));
    assert_eq!(largest(2.0), Reach::Limit(0.0066));
    assert_eq!(largest(1.0), Reach::Limit(0.0086));
    assert_eq!(largest(8.5), Reach::Nowhere);
    assert_eq!(largest(0.5), Reach::Everywhere);
}

// Verifies: DET-091.
#[test]
fn smallest_size_and_indentation() {
    for least in [smallest_detectable_inclusion, indentation_needed] {
        let least = |required| least(&SIZE, &RISING, required).unwrap();
        assert_eq!(least(2.0), Reach::Limit(2.5));
        assert_eq!(least(0.5), Reach::Limit(1.0));
        assert_eq!(least(1.5), Reach::Limit(2.0));
        assert_eq!(least(3.5), Reach::Limit(4.0));
        assert_eq!(least(3.6), Reach::Nowhere);
        assert_eq!(least(0.1), Reach::Everywhere);
    }
}

// Verifies: DET-092.
#[test]
fn tables_that_are_not_monotone_are_refused() {
    let found = largest_detectable_depth(&DEPTH, &[8.0, 4.0, 4.0, 1.0], 3.0);
    assert_eq!(
        found,
        Err(DetectError::NotMonotone {
            what: "gamma",
            index: 2
        })
    );
    let found = indentation_needed(&[1.0, 1.0, 2.0], &RISING, 1.0);
    assert_eq!(
        found,
        Err(DetectError::NotMonotone {
            what: "parameter",
            index: 1
        })
    );
    assert!(largest_detectable_depth(&SIZE, &RISING, 1.0).is_err());
    assert!(smallest_detectable_inclusion(&DEPTH, &FALLING, 1.0).is_err());
    assert!(indentation_needed(&SIZE, &RISING[..2], 1.0).is_err());
    assert!(indentation_needed(&[1.0], &[1.0], 1.0).is_err());
    assert!(indentation_needed(&SIZE, &[0.5, f64::NAN, 3.0], 1.0).is_err());
    assert!(indentation_needed(&SIZE, &RISING, -1.0).is_err());
    assert!(indentation_needed(&SIZE, &RISING, f64::NAN).is_err());
}

// Verifies: DET-092.
#[test]
fn two_entries_are_enough_and_equal_ones_are_no_order() {
    let two = indentation_needed(&[1.0, 3.0], &[2.0, 4.0], 3.0);
    assert_eq!(two, Ok(Reach::Limit(2.0)));
    let found = indentation_needed(&SIZE, &[0.5, 1.5, 1.5], 1.0);
    assert_eq!(
        found,
        Err(DetectError::NotMonotone {
            what: "gamma",
            index: 2
        })
    );
}
