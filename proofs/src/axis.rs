//! The cell of a position, the fraction in it, and what is between two numbers.

use std::ops::Bound::Included;

use bolero::generator::bolero_generator;
use bolero::{Driver, TypeGenerator};
use palpate_core::servo::{Axis, FORCE_CEILING, approach, blend, limit};

use crate::cases::{AnyAxis, Entry, Fraction, Grid, Newtons, Position, folded, near};

/// An axis of three cells and any position.
#[derive(Debug, Clone)]
struct OnAxis {
    axis: AnyAxis<4, 3>,
    position: f32,
}

impl TypeGenerator for OnAxis {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let axis: AnyAxis<4, 3> = driver.produce()?;
        // Now and then a knot, which bits alone would not hit.
        let position = match driver.gen_variant(4, 0)? {
            1 => axis.knots[driver.gen_variant(4, 0)?],
            _ => driver.produce::<Position>()?.0,
        };
        Some(OnAxis { axis, position })
    }
}

/// Cell and fraction are in range, and the cell encloses a position within the axis.
fn is_in_range(knots: &[f32; 4], axis: &Axis, position: f32) {
    let found = axis.locate(position);
    assert!(found.index < 3);
    assert!((-1.0..=2.0).contains(&found.fraction));
    let inside = knots[0] <= position && position < knots[3];
    if inside {
        assert!(knots[found.index] <= position && position <= knots[found.index + 1]);
        assert!((0.0..=1.0).contains(&found.fraction));
    }
    // At the last knot the fraction is 1: `exhaustive.rs` has that for each width.
    if position < knots[0] {
        assert!(found.index == 0 && found.fraction <= 0.0);
    }
    if position >= knots[3] {
        assert!(found.index == 2 && found.fraction >= 1.0);
    }
    reached! {
        "in the first cell": inside && position < knots[1],
        "in the last cell": inside && position >= knots[2],
        "below the axis": position < knots[0],
        "above the axis": position > knots[3],
        "not finite": !position.is_finite(),
    }
}

// No Kani proof on any axis: three symbolic divisions end in no solver.
// Verifies: SRV-004, SRV-012.
#[cfg(not(kani))]
#[test]
fn locate_is_total_and_in_range() {
    harness!(OnAxis, |case| {
        is_in_range(&case.axis.knots, &case.axis.axis(), case.position);
    });
}

/// The same on one of the axes of the tables.
macro_rules! located {
    ($name:ident, $axes:literal) => {
        // Verifies: SRV-004, SRV-012.
        #[test]
        #[cfg_attr(kani, kani::proof, kani::unwind(6), kani::solver(minisat))]
        fn $name() {
            harness!(Near<$axes>, |case| {
                let (_, laterals) = Grid::<$axes, true>::axes();
                is_in_range(&Grid::<$axes, true>::LATERALS, &laterals, case.0);
            });
        }
    };
}
located!(locate_on_the_axis_of_a_map, 0);
located!(locate_on_an_axis_of_narrow_cells, 1);
located!(locate_on_an_axis_of_exact_knots, 2);

/// Any position, two in three about the lateral axis of number AXES.
#[derive(Debug, Clone, Copy)]
struct Near<const AXES: usize>(f32);

impl<const AXES: usize> TypeGenerator for Near<AXES> {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        near(driver, Grid::<AXES, true>::LATERALS).map(Near)
    }
}

// No Kani proof: it relates a product to a quotient.
// Verifies: SRV-004, SRV-012.
#[cfg(not(kani))]
#[test]
fn a_fraction_is_near_the_exact_one() {
    harness!(OnAxis, |case| {
        let knots = case.axis.knots.map(f64::from);
        let position = f64::from(case.position);
        let found = case.axis.axis().locate(case.position);
        let (start, end) = (knots[found.index], knots[found.index + 1]);
        // The width, its reciprocal, the distance and the product are each rounded to 24 bits.
        let exact = ((position - start) / (end - start)).clamp(-1.0, 2.0);
        let off = (f64::from(found.fraction) - exact).abs();
        assert!(case.position.is_nan() || off <= 4.01 / 16_777_216.0 * exact.abs());
        reached! {
            "within a cell": found.fraction > 0.0 && found.fraction < 1.0,
            "in a cell but the first": found.index != 0 && found.fraction < 1.0,
            "continued": found.fraction > -1.0 && found.fraction < 0.0,
        }
    });
}

/// An axis of two cells and one of its knots, but not the last.
#[derive(Debug, Clone, bolero_generator::TypeGenerator)]
struct AtKnot {
    axis: AnyAxis<3, 2>,
    #[generator(0..2)]
    knot: usize,
}

// No Kani proof on any axis, likewise.
// Verifies: SRV-004.
#[cfg(not(kani))]
#[test]
fn knots_have_whole_fractions() {
    harness!(AtKnot, |case| {
        let found = case.axis.axis().locate(case.axis.knots[case.knot]);
        assert!(found.index == case.knot && found.fraction == 0.0);
        reached! {
            "the first knot": case.knot == 0,
            "a knot between two cells": case.knot == 1,
        }
    });
}

/// Two forces and a fraction.
#[derive(Debug, Clone)]
struct Blend {
    a: f32,
    b: f32,
    t: f32,
}

impl TypeGenerator for Blend {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let a = driver.produce::<Entry>()?.0;
        let b = match driver.gen_variant(4, 0)? {
            1 => a,
            _ => driver.produce::<Entry>()?.0,
        };
        let t = match driver.gen_variant(8, 0)? {
            1 => 0.0,
            2 => 1.0,
            _ => driver.produce::<Fraction>()?.0,
        };
        Some(Blend { a, b, t })
    }
}

// Verifies: SRV-010, SRV-011.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn a_blend_is_between_its_ends() {
    harness!(Blend, |case| {
        let &Blend { a, b, t } = case;
        let value = blend(a, b, t);
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        let inside = (0.0..=1.0).contains(&t);
        if inside {
            assert!(low <= value && value <= high);
        }
        if t == 0.0 {
            assert!(value == a);
        }
        if t == 1.0 {
            assert!(value == b);
        }
        assert!(value.abs() <= 301.0);
        reached! {
            "between": inside && t != 0.0 && t != 1.0,
            "at an end": t == 0.0 || t == 1.0,
            "outside": !inside,
            "ends that are equal": a == b && a != 0.0,
        }
    });
}

/// Any number and the largest magnitude that it is limited to.
#[derive(Debug, Clone, bolero_generator::TypeGenerator)]
struct Limited {
    value: Newtons,
    largest: Entry,
}

// Verifies: SRV-020.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn a_limited_number_is_within_its_limit() {
    harness!(Limited, |case| {
        let (value, largest) = (case.value.0, case.largest.0.abs());
        let limited = limit(value, largest);
        if value.is_nan() {
            assert!(limited == 0.0);
        } else if value.abs() <= largest {
            assert!(limited == value);
        } else {
            assert!(limited == largest.copysign(value));
        }
        reached! {
            "a NaN": value.is_nan(),
            "within": value.abs() <= largest,
            "above": value > largest,
            "below": value < -largest,
        }
    });
}

/// A force, where it goes, and by how much it may rise and fall in a cycle, as limits have it.
#[derive(Debug, Clone, Copy)]
struct Step {
    last: f32,
    target: f32,
    rise: f32,
    fall: f32,
}

impl TypeGenerator for Step {
    fn generate<D: Driver>(driver: &mut D) -> Option<Self> {
        let (Newtons(last), Newtons(target)) = driver.produce()?;
        let (last, target) = (folded(last, FORCE_CEILING), folded(target, FORCE_CEILING));
        let rise = driver.gen_f32(Included(&1e-4), Included(&FORCE_CEILING))?;
        let fall = driver.gen_f32(Included(&1e-4), Included(&1e30))?;
        Some(Step {
            last,
            target,
            rise,
            fall: if fall < rise { rise } else { fall },
        })
    }
}

/// A force grows by the rise and falls by the fall at most, never beyond its target, nor through zero.
// Verifies: SRV-021.
#[test]
#[cfg_attr(kani, kani::proof, kani::solver(cadical))]
fn a_force_approaches_with_any_rise_and_fall() {
    harness!(Step, |case| {
        let &Step {
            last,
            target,
            rise,
            fall,
        } = case;
        let value = approach(last, target, rise, fall);
        let grows = value.abs() > last.abs();
        let change = if grows { rise } else { fall };
        assert!(last - change <= value && value <= last + change);
        assert!(value == 0.0 || last == 0.0 || (value < 0.0) == (last < 0.0));
        assert!(value <= last || value <= target);
        assert!(value >= last || value >= target);
        reached! {
            "the target": value == target,
            "a rise": grows && value != target,
            "a fall": !grows && value != target && value != 0.0,
            "a force that would turn": value == 0.0 && target != 0.0,
        }
    });
}
