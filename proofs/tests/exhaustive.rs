//! Functions of one f32 on all 2³² of them: proofs by enumeration. In debug builds they take
//! minutes: `cargo test --release -p palpate-proofs -- --ignored`.
#![cfg(not(any(kani, fuzzing)))]

use palpate::hid::count;
use palpate::servo::{
    Axis, Cell, FORCE_CEILING, Force, Input, Limits, MIN_SLEW, MIN_WIDTH, Mode, RELEASE_CYCLES,
    Request, Sample, State, Table, approach, blend, limit, step,
};

/// Checks all f32, in two threads.
fn for_all(check: impl Fn(f32) + Sync) {
    for_bits(0, u32::MAX, |bits| check(f32::from_bits(bits)));
}

/// Checks all f32 from `low` to `high`, both positive.
fn for_all_between(low: f32, high: f32, check: impl Fn(f32) + Sync) {
    for_bits(low.to_bits(), high.to_bits(), |bits| {
        check(f32::from_bits(bits))
    });
}

fn for_bits(low: u32, high: u32, check: impl Fn(u32) + Sync) {
    let half = low + (high - low) / 2;
    std::thread::scope(|scope| {
        let check = &check;
        for part in [low..=half, half + 1..=high] {
            scope.spawn(move || part.for_each(check));
        }
    });
}

fn with_axis<R>(knots: &[f32], then: impl FnOnce(&Axis) -> R) -> R {
    let reciprocals: Vec<f32> = knots
        .windows(2)
        .map(|ends| Axis::reciprocal_width(ends[0], ends[1]))
        .collect();
    then(&Axis::new(knots, &reciprocals).unwrap())
}

/// Index and fraction in range; enclosure; 0 and 1 at the knots; never falling from one position to
/// the next.
fn locate_is_right_everywhere(knots: &[f32]) {
    let (first, last) = (knots[0], *knots.last().unwrap());
    let cells = knots.len() - 1;
    with_axis(knots, |axis| {
        let check = |position: f32| {
            let Cell { index, fraction } = axis.locate(position);
            assert!(index < cells, "{position}");
            assert!((-1.0..=2.0).contains(&fraction), "{position}");
            if first <= position && position <= last {
                let (start, end) = (knots[index], knots[index + 1]);
                assert!(start <= position && position <= end, "{position}");
                assert!((0.0..=1.0).contains(&fraction), "{position}");
                assert!(position != start || fraction == 0.0, "{position}");
                assert!(position != end || fraction == 1.0, "{position}");
            } else if position < first {
                assert!(index == 0 && fraction <= 0.0, "{position}");
            } else if position > last {
                assert!(index == cells - 1 && fraction >= 1.0, "{position}");
            }
            (index, fraction)
        };
        std::thread::scope(|scope| {
            // Upwards from 0 and downwards from −0, each from one number to its neighbour.
            for (sign, upwards) in [(0, true), (1 << 31, false)] {
                scope.spawn(move || {
                    let mut previous = check(f32::from_bits(sign));
                    for bits in 0..=f32::INFINITY.to_bits() {
                        let next = check(f32::from_bits(sign | bits));
                        let (lower, upper) = if upwards {
                            (previous, next)
                        } else {
                            (next, previous)
                        };
                        assert!(lower <= upper, "{lower:?} {upper:?}");
                        previous = next;
                    }
                    // The rest are NaN.
                    for bits in f32::INFINITY.to_bits() + 1..1 << 31 {
                        check(f32::from_bits(sign | bits));
                    }
                });
            }
        });
    });
}

// With the widest of cells and the narrowest.
// Proves: SRV-002, SRV-004, SRV-005, SRV-006.
#[test]
#[ignore = "all 2³² inputs"]
fn locate_on_an_axis_that_is_not_uniform() {
    locate_is_right_everywhere(&[
        -1.0, 0.0, MIN_WIDTH, 0.000_5, 0.001, 0.002, 0.004, 0.008, 1.0,
    ]);
}

// Proves: SRV-004, SRV-005, SRV-006.
#[test]
#[ignore = "all 2³² inputs"]
fn locate_on_a_uniform_axis() {
    let knots: Vec<f32> = (-20i16..=20).map(|k| f32::from(k) * 0.000_5).collect();
    locate_is_right_everywhere(&knots);
}

// The last knot's fraction is the width times its reciprocal, which may not be rounded beyond 1. The
// fraction depends on the width alone, so that axes from 0 stand for all.
// Proves: SRV-005, SRV-006.
#[test]
#[ignore = "all widths"]
fn no_width_carries_its_last_knot_beyond_one() {
    for_all_between(MIN_WIDTH, 2.0, |width| {
        assert!(width * Axis::reciprocal_width(0.0, width) <= 1.0, "{width}");
    });
    for_all_between(MIN_WIDTH, 1.0, |width| {
        let (knots, reciprocals) = ([0.0, width], [Axis::reciprocal_width(0.0, width)]);
        let axis = Axis::new(&knots, &reciprocals).unwrap();
        assert_eq!(
            (axis.locate(0.0).fraction, axis.locate(width).fraction),
            (0.0, 1.0)
        );
    });
}

// Proves: SRV-020.
#[test]
#[ignore = "all 2³² inputs"]
fn limit_is_right_everywhere() {
    for largest in [FORCE_CEILING, 32767.0] {
        for_all(|value| {
            let limited = limit(value, largest);
            let expected = if value.is_nan() {
                0.0
            } else if value.abs() <= largest {
                value
            } else {
                largest.copysign(value)
            };
            assert_eq!(limited.to_bits(), expected.to_bits(), "{value}");
        });
    }
}

// Proves: HID-010, HID-011.
#[test]
#[ignore = "all 2³² inputs"]
fn count_is_right_everywhere() {
    for_all(|value| {
        // The conversion of a NaN gives 0.
        let expected = f64::from(value).round_ties_even().clamp(-32767.0, 32767.0) as i16;
        assert_eq!(count(value), expected, "{value}");
    });
}

// Proves: SRV-010, SRV-011, SRV-013.
#[test]
#[ignore = "all 2³² inputs"]
fn blend_is_in_the_hull_everywhere() {
    for (a, b) in [(-100.0, 100.0), (0.1, 0.1)] {
        let (low, high) = (f32::min(a, b), f32::max(a, b));
        for_all(|t| {
            let value = blend(a, b, t);
            if (0.0..=1.0).contains(&t) {
                assert!(low <= value && value <= high, "{t}");
            }
            if (-1.0..=2.0).contains(&t) {
                assert!(
                    value.abs() <= 3.0 * high.abs().max(low.abs()) * 1.000_001,
                    "{t}"
                );
            }
        });
        assert_eq!((blend(a, b, 0.0), blend(a, b, 1.0)), (a, b));
    }
}

// The slowest release from the largest force. A smaller force and a quicker release are never later:
// rounding keeps the order of differences.
// Proves: SRV-031.
#[test]
#[ignore = "all force limits"]
fn every_force_is_released_in_time() {
    for_all_between(MIN_SLEW, FORCE_CEILING, |force| {
        let release = force / f32::from(RELEASE_CYCLES);
        let mut rest = force;
        for _ in 0..=RELEASE_CYCLES {
            rest = approach(rest, 0.0, release);
        }
        assert_eq!(rest, 0.0, "{force}");
    });
}

// Every distance of two sequence numbers, from every 257th number.
// Verifies: SRV-040.
#[test]
#[ignore = "16 million cycles"]
fn freshness_depends_on_the_distance_alone() {
    let axis = Axis::new(&[0.0, 0.5], &[2.0]).unwrap();
    let table = Table::new(axis, axis, &[Force::ZERO; 4]).unwrap();
    let limits = Limits::new(2.0, 0.01, 0.2, 5).unwrap();
    for last in (0..=u16::MAX).step_by(257) {
        for ahead in 0..=u16::MAX {
            let state = State {
                mode: Mode::Armed,
                sequence: Some(last),
                ..State::default()
            };
            let sample = Sample {
                sequence: last.wrapping_add(ahead),
                deadman: true,
                device_fault: false,
                depth: 0.0,
                lateral: 0.0,
            };
            let input = Input {
                sample: Some(sample),
                request: Request::None,
            };
            let (_, command) = step(&table, &limits, state, input);
            assert_eq!(
                command.playing,
                (1..=32767).contains(&ahead),
                "{last} {ahead}"
            );
        }
    }
}
