//! Expected values: by hand, in whole and half numbers.

use super::*;
use palpate_asserts::assert_near;

const RECORD: [f64; 5] = [1.0, 2.0, 0.0, -1.0, 3.0];
const TEMPLATE: [f64; 3] = [1.0, 2.0, 1.0];
const NOTHING: [f64; 5] = [0.0; 5];

fn scan() -> Scan<'static> {
    let template = Force::new(&NOTHING[..3], &TEMPLATE);
    Scan::new(5, template, Force::new(1.0, 0.5)).unwrap()
}

const RESIDUAL: Force<&[f64]> = Force::new(&RECORD, &RECORD);

/// Σ rΔ − ½ΣΔ² over the overlap; over s² = ¼ it is four times that.
const BY_HAND: [(isize, f64, f64); 7] = [
    (-2, 0.5, 1.0),
    (-1, 1.5, 5.0),
    (0, 2.0, 6.0),
    (1, -2.0, 6.0),
    (2, -2.0, 6.0),
    (3, 2.5, 5.0),
    (4, 2.5, 1.0),
];

// Verifies: DET-050, DET-052.
#[test]
fn every_shift_counts_what_overlaps_and_nothing_else() {
    let scan = scan();
    assert_eq!((scan.shifts(), scan.full_shifts()), (-2..=4, 0..=2));
    for (shift, quarter, energy) in BY_HAND {
        let found = scan.maximum(RESIDUAL, shift..=shift).unwrap();
        let expected = (4.0 * quarter, libm::sqrt(4.0 * energy));
        assert_eq!((found.theta, found.gamma), expected);
    }
    let mut theta = [0.0; 7];
    scan.theta(RESIDUAL, -2, &mut theta).unwrap();
    assert_eq!(theta, BY_HAND.map(|(_, quarter, _)| 4.0 * quarter));
}

// Verifies: DET-053, DET-054.
#[test]
fn maximum_is_the_first_of_the_largest() {
    for (shifts, shift, theta, refined) in [
        // The parabola through −8, 10, 10 has its top half way between the equal ones.
        (-2..=4, 3, 10.0, 3.5),
        (0..=2, 0, 8.0, 0.0),
        // Θ of 6, 8, −8 at shifts −1, 0, 1: vertex ½(2 − 16)/(2 + 16).
        (-1..=2, 0, 8.0, -7.0 / 18.0),
        // At the last candidate the shift behind it, which has the same Θ, has no say.
        (1..=3, 3, 10.0, 3.0),
    ] {
        let found = scan().maximum(RESIDUAL, shifts).unwrap();
        assert_eq!((found.shift, found.theta), (shift, theta));
        assert_eq!(found.refined_shift, refined);
    }
    for outside in [-3..=1, 0..=5, isize::MIN..=isize::MAX] {
        let found = scan().maximum(RESIDUAL, outside);
        assert!(matches!(found, Err(DetectError::OutOfRange { .. })));
    }
    assert!(scan().theta(RESIDUAL, -3, &mut [0.0; 2]).is_err());
    assert!(scan().theta(RESIDUAL, 3, &mut [0.0; 3]).is_err());
    assert!(scan().theta(RESIDUAL, isize::MAX, &mut [0.0; 3]).is_err());
    let empty = RangeInclusive::new(2, 1);
    let found = scan().maximum(RESIDUAL, empty).unwrap_err();
    assert_eq!(found, DetectError::Empty { what: "shifts" });
}

// Verifies: DET-005.
#[test]
fn scans_that_cannot_be_are_refused() {
    let template: Force<&[f64]> = Force::new(&TEMPLATE, &TEMPLATE);
    let sd = Force::new(1.0, 1.0);
    assert!(Scan::new(2, template, sd).is_err());
    assert!(Scan::new(5, Force::new(&TEMPLATE, &TEMPLATE[..2]), sd).is_err());
    assert!(Scan::new(5, Force::new(&[], &[]), sd).is_err());
    assert!(Scan::new(5, template, Force::new(1.0, 0.0)).is_err());
    let scan = Scan::new(5, template, sd).unwrap();
    let mut bad = RECORD;
    bad[4] = f64::NAN;
    let (what, index) = ("residual_y", 4);
    let expected = Err(DetectError::NotFinite { what, index });
    // The NaN lies where this template is not: the record is refused all the same.
    assert_eq!(scan.maximum(Force::new(&RECORD, &bad), 0..=0), expected);
    let short = Force::new(&RECORD[..4], &RECORD);
    assert!(scan.maximum(short, 0..=1).is_err());
}

// Verifies: DET-005, DET-054. θ is −1.5e308, 5e307 and −1.5e308: a parabola beyond the largest number.
#[test]
fn a_top_beyond_the_range_of_numbers_is_refused() {
    let (template, record) = ([1e154], [-1e154, 1e154, -1e154]);
    let template = Force::new(&template[..], &[0.0]);
    let scan = Scan::new(3, template, Force::new(1.0, 1.0)).unwrap();
    let found = scan.maximum(Force::new(&record, &[0.0; 3]), 0..=2);
    assert!(found.is_err(), "{found:?}");
}

// Verifies: DET-050, DET-052.
#[test]
fn noise_that_is_no_power_of_two_counts_by_its_square() {
    let template = Force::new(&TEMPLATE[..], &TEMPLATE);
    let scan = Scan::new(5, template, Force::new(0.3, 0.7)).unwrap();
    let inverse = 1.0 / 0.09 + 1.0 / 0.49;
    for (shift, quarter, energy) in BY_HAND {
        let found = scan.maximum(RESIDUAL, shift..=shift).unwrap();
        // Two divisions, a sum and a root: each rounds by half a unit; the expected value by as many.
        let theta = quarter * inverse;
        assert_near(found.theta, theta, 4.0 * f64::EPSILON * theta.abs());
        let gamma = libm::sqrt(energy * inverse);
        assert_near(found.gamma, gamma, 4.0 * f64::EPSILON * gamma);
    }
}
