//! Functions of one f32 on all 2³² of them: proofs by enumeration, on all processors.

use std::ops::RangeInclusive;

use rayon::prelude::*;

use super::{Check, Figure, Measured};
use palpate::force::Force;
use palpate::hid::count;
use palpate::servo::{
    Axis, Cell, FORCE_CEILING, Input, Limits, MIN_SLEW, MIN_WIDTH, Mode, RELEASE_CYCLES, Request,
    Sample, State, Table, approach, blend, limit, step,
};

/// How the limits of each were derived.
const EVERY_INPUT: &str =
    "Every one of the inputs counted must hold: no tolerance. Fixed in 0.1.0.";

/// The checks of this part.
pub const CHECKS: &[Check] = checks! {
    "kernel.locate_uneven" ["SRV-002", "SRV-004"] => locate_uneven,
        "On an axis with cells from 1 µm to 1 m, every f32 gets a cell of the axis and a fraction in range, a position on the \
         axis one whose ends enclose it, a knot 0 or 1, and neither ever falls as the position rises.",
        EVERY_INPUT;
    "kernel.locate_even" ["SRV-004"] => locate_even,
        "The same on a uniform axis of 41 knots 0.5 mm apart, as a force map's.",
        EVERY_INPUT;
    "kernel.last_knot" ["SRV-004"] => last_knot,
        "No width of a cell times its stored reciprocal is above 1, and the last knot has the fraction 1.",
        EVERY_INPUT;
    "kernel.limit" ["SRV-020"] => limits,
        "The limit of a force gives every f32 within it unchanged, the limit with its sign beyond, and 0 for a NaN.",
        EVERY_INPUT;
    "kernel.count" ["HID-010", "HID-011"] => counts,
        "The force in the device's counts is the nearest whole number, within ±32767, for every f32.",
        EVERY_INPUT;
    "kernel.blend" ["SRV-010", "SRV-011", "SRV-013"] => blends,
        "A blend of −100 and 100, and one of 0.1 and 0.1, lies between them for every fraction from 0 to 1, is each of them at its \
         end, and is at most three times as large from −1 to 2.",
        EVERY_INPUT;
    "kernel.release" ["SRV-031"] => release,
        "Every force up to the ceiling is released to 0 within 17 cycles of the slowest release.",
        EVERY_INPUT;
    "kernel.freshness" ["SRV-040"] => freshness,
        "A sample is played if and only if its number is 1 to 32767 ahead of the last, from every 257th number.",
        EVERY_INPUT;
};

/// What a run over many inputs found.
#[derive(Debug, Clone, Copy)]
struct Tally {
    tried: u64,
    broken: u64,
    /// Bits of the first input, in the order of the run, that broke the property.
    first: Option<u32>,
    /// The largest value of what is measured besides, at least 0; NaN if one was.
    worst: f32,
}

impl Tally {
    const EMPTY: Tally = Tally {
        tried: 0,
        broken: 0,
        first: None,
        worst: 0.0,
    };

    /// Counts an input that holds or not.
    fn take(&mut self, bits: u32, holds: bool) {
        self.tried += 1;
        if !holds {
            self.broken += 1;
            self.first = self.first.or(Some(bits));
        }
    }

    /// Keeps the larger of the worst so far and `value`.
    fn measure(&mut self, value: f32) {
        if value.is_nan() || value > self.worst {
            self.worst = value;
        }
    }

    /// This run and the one after it.
    fn and(self, next: Tally) -> Tally {
        let mut worst = self;
        if !self.worst.is_nan() {
            worst.measure(next.worst);
        }
        Tally {
            tried: self.tried + next.tried,
            broken: self.broken + next.broken,
            first: self.first.or(next.first),
            worst: worst.worst,
        }
    }

    /// Inputs tried, of which there must be `expected`, and broken, of which there must be none; `named` is the
    /// name of an input.
    fn figures(&self, what: &str, expected: u64, named: impl Fn(u32) -> String) -> Vec<Figure> {
        let broken = match self.first {
            None => format!("{what}: inputs that break it"),
            Some(bits) => format!("{what}: inputs that break it, the first {}", named(bits)),
        };
        vec![
            Figure::count(format!("{what}: inputs tried"), self.tried, expected),
            Figure::count(broken, self.broken, 0),
        ]
    }
}

/// Why a case of a check could not be made.
fn refused(error: impl std::fmt::Debug) -> String {
    format!("{error:?}")
}

/// The name of an f32 that broke a property.
fn float(bits: u32) -> String {
    format!("{:e} (0x{bits:08x})", f32::from_bits(bits))
}

/// All f32.
const ALL: RangeInclusive<u32> = 0..=u32::MAX;

/// All f32 from `low` to `high`, both positive.
fn between(low: f32, high: f32) -> RangeInclusive<u32> {
    low.to_bits()..=high.to_bits()
}

fn size(bits: &RangeInclusive<u32>) -> u64 {
    u64::from(bits.end() - bits.start()) + 1
}

/// Parts of a range that are taken at a time by one processor.
const PARTS: u64 = 64;

/// Hands all bits of a range to `check`, and adds up what it found.
fn for_bits(bits: &RangeInclusive<u32>, check: impl Fn(u32, &mut Tally) + Sync) -> Tally {
    let border = |part: u64| u64::from(*bits.start()) + part * size(bits) / PARTS;
    let parts = (0..PARTS).into_par_iter().map(|part| {
        let mut tally = Tally::EMPTY;
        (border(part)..border(part + 1)).for_each(|bits| check(bits as u32, &mut tally));
        tally
    });
    parts.reduce(|| Tally::EMPTY, Tally::and)
}

/// Whether `holds` is true of every f32 with bits in a range.
fn holds_for(
    what: &str,
    bits: RangeInclusive<u32>,
    holds: impl Fn(f32) -> bool + Sync,
) -> Vec<Figure> {
    let tally = for_bits(&bits, |bits, tally| {
        tally.take(bits, holds(f32::from_bits(bits)));
    });
    tally.figures(what, size(&bits), float)
}

fn locate_uneven() -> Measured {
    // With the widest of cells and the narrowest.
    locate(&[
        -1.0, 0.0, MIN_WIDTH, 0.000_5, 0.001, 0.002, 0.004, 0.008, 1.0,
    ])
}

fn locate_even() -> Measured {
    let knots: Vec<f32> = (-20i16..=20).map(|k| f32::from(k) * 0.000_5).collect();
    locate(&knots)
}

/// Index and fraction in range; enclosure; 0 and 1 at the knots; never falling from one position to the next.
fn locate(knots: &[f32]) -> Measured {
    let reciprocals: Vec<f32> = knots
        .windows(2)
        .map(|ends| Axis::reciprocal_width(ends[0], ends[1]))
        .collect();
    let axis = Axis::new(knots, &reciprocals).map_err(refused)?;
    // Upwards from 0 and downwards from −0, each from one number to its neighbour.
    let run = |(sign, upwards)| {
        let mut tally = Tally::EMPTY;
        let mut previous = axis.locate(f32::from_bits(sign));
        for bits in 0..=f32::INFINITY.to_bits() {
            let position = f32::from_bits(sign | bits);
            let next = axis.locate(position);
            let [lower, upper] = if upwards {
                [previous, next]
            } else {
                [next, previous]
            };
            let rises = (lower.index, lower.fraction) <= (upper.index, upper.fraction);
            tally.take(sign | bits, rises && is_right(knots, position, next));
            previous = next;
        }
        // The rest are NaN.
        for bits in f32::INFINITY.to_bits() + 1..1 << 31 {
            let position = f32::from_bits(sign | bits);
            let is_right = is_right(knots, position, axis.locate(position));
            tally.take(sign | bits, is_right);
        }
        tally
    };
    let runs = [(0, true), (1 << 31, false)].into_par_iter().map(run);
    let tally = runs.reduce(|| Tally::EMPTY, Tally::and);
    Ok(tally.figures("positions", size(&ALL), float))
}

/// Whether a position has the cell that it should.
fn is_right(knots: &[f32], position: f32, Cell { index, fraction }: Cell) -> bool {
    let cells = knots.len() - 1;
    let (first, last) = (knots[0], knots[cells]);
    if index >= cells || !(-1.0..=2.0).contains(&fraction) {
        return false;
    }
    if first <= position && position <= last {
        let (start, end) = (knots[index], knots[index + 1]);
        start <= position
            && position <= end
            && (0.0..=1.0).contains(&fraction)
            && (position != start || fraction == 0.0)
            && (position != end || fraction == 1.0)
    } else if position < first {
        index == 0 && fraction <= 0.0
    } else if position > last {
        index == cells - 1 && fraction >= 1.0
    } else {
        true
    }
}

/// The last knot's fraction is the width times its reciprocal, which may not be rounded beyond 1. The fraction
/// depends on the width alone, so that axes from 0 stand for all.
fn last_knot() -> Measured {
    let widths = between(MIN_WIDTH, 2.0);
    let product = for_bits(&widths, |bits, tally| {
        let width = f32::from_bits(bits);
        let product = width * Axis::reciprocal_width(0.0, width);
        tally.measure(product);
        tally.take(bits, product <= 1.0);
    });
    let mut figures = product.figures("widths up to 2 m", size(&widths), float);
    let largest = f64::from(product.worst);
    figures.extend(figures! { "largest width times reciprocal" => at_most(largest, 1.0); });
    let cells = between(MIN_WIDTH, 1.0);
    figures.extend(holds_for("axes of one cell up to 1 m", cells, |width| {
        let (knots, reciprocals) = ([0.0, width], [Axis::reciprocal_width(0.0, width)]);
        let is_whole = |axis: Axis| [0.0, width].map(|x| axis.locate(x).fraction) == [0.0, 1.0];
        Axis::new(&knots, &reciprocals).is_ok_and(is_whole)
    }));
    Ok(figures)
}

fn limits() -> Measured {
    let mut figures = Vec::new();
    for largest in [FORCE_CEILING, 32767.0] {
        figures.extend(holds_for(&format!("limit {largest}"), ALL, |value| {
            let expected = if value.is_nan() {
                0.0
            } else if value.abs() <= largest {
                value
            } else {
                largest.copysign(value)
            };
            limit(value, largest).to_bits() == expected.to_bits()
        }));
    }
    Ok(figures)
}

fn counts() -> Measured {
    Ok(holds_for("forces in counts", ALL, |value| {
        // The conversion of a NaN gives 0.
        let expected = f64::from(value).round_ties_even().clamp(-32767.0, 32767.0) as i16;
        count(value) == expected
    }))
}

fn blends() -> Measured {
    let mut figures = Vec::new();
    for (a, b) in [(-100.0, 100.0), (0.1, 0.1)] {
        let (low, high) = (f32::min(a, b), f32::max(a, b));
        let tally = for_bits(&ALL, |bits, tally| {
            let t = f32::from_bits(bits);
            let value = blend(a, b, t);
            if (-1.0..=2.0).contains(&t) {
                tally.measure(value.abs());
            }
            let inside = (0.0..=1.0).contains(&t);
            tally.take(bits, !inside || (low <= value && value <= high));
        });
        let what = format!("{a} to {b}");
        figures.extend(tally.figures(&what, size(&ALL), float));
        let allowed = f64::from(3.0 * high.abs().max(low.abs()) * 1.000_001);
        let missed = u64::from(blend(a, b, 0.0) != a) + u64::from(blend(a, b, 1.0) != b);
        figures.extend(figures! {
            "{what}: largest magnitude from −1 to 2" => at_most(f64::from(tally.worst), allowed);
            "{what}: ends missed" => count(missed, 0);
        });
    }
    Ok(figures)
}

/// The slowest release from the largest force. A smaller force and a quicker release are never later: rounding
/// keeps the order of differences.
fn release() -> Measured {
    let limits = between(MIN_SLEW, FORCE_CEILING);
    Ok(holds_for("force limits", limits, |force| {
        let release = force / f32::from(RELEASE_CYCLES);
        let mut rest = force;
        for _ in 0..=RELEASE_CYCLES {
            rest = approach(rest, 0.0, release, release);
        }
        rest == 0.0
    }))
}

/// Every distance of two sequence numbers, from every 257th number.
fn freshness() -> Measured {
    let axis = Axis::new(&[0.0, 0.5], &[2.0]).map_err(refused)?;
    let table = Table::new(axis, axis, &[Force::ZERO; 4]).map_err(refused)?;
    let limits = Limits::new(2.0, 0.01, 0.2, 5).map_err(refused)?;
    let mut tally = Tally::EMPTY;
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
            let bits = (u32::from(last) << 16) | u32::from(ahead);
            tally.take(bits, command.playing == (1..=32767).contains(&ahead));
        }
    }
    let named = |bits: u32| format!("{} ahead of {}", bits & 0xffff, bits >> 16);
    Ok(tally.figures("numbers and distances", 256 * 65536, named))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Outcome;

    // That a violation is counted, and the first of all threads named.
    #[test]
    fn the_first_input_that_breaks_a_property_is_named() {
        let bits = between(1.0, 2.0);
        for (threshold, name) in [
            (1.25f32, "1.25e0 (0x3fa00000)"),
            (1.75, "1.75e0 (0x3fe00000)"),
        ] {
            let figures = holds_for("numbers", bits.clone(), |x| x < threshold);
            let broken = u64::from(2f32.to_bits() - threshold.to_bits()) + 1;
            assert_eq!(
                figures[0],
                Figure::count("numbers: inputs tried", (1 << 23) + 1, (1 << 23) + 1)
            );
            let what = format!("numbers: inputs that break it, the first {name}");
            assert_eq!(figures[1], Figure::count(what, broken, 0));
            assert!(figures[0].passes() && !figures[1].passes());
        }
    }

    #[test]
    fn the_worst_of_all_threads_is_kept_and_so_is_a_nan() {
        let worst = |of: fn(f32) -> f32| {
            let measure = |bits, tally: &mut Tally| tally.measure(of(f32::from_bits(bits)));
            for_bits(&between(1.0, 2.0), measure).worst
        };
        assert_eq!(worst(|x| x), 2.0);
        assert_eq!(worst(|x| 4.0 - x), 3.0);
        assert!(worst(|x| if x == 1.0 { f32::NAN } else { x }).is_nan());
        assert!(worst(|x| if x == 2.0 { f32::NAN } else { x }).is_nan());
    }

    #[test]
    fn a_thread_that_panics_fails_the_check() {
        let outcome = Outcome::measured(&CHECKS[0].claim, || {
            Ok(holds_for("numbers", between(1.0, 2.0), |x| {
                assert!(x < 1.5, "planted");
                true
            }))
        });
        let failure = outcome.failure;
        assert_eq!(failure.as_deref(), Some("panicked: planted"));
    }
}
