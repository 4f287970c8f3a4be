//! Maxima and crossings of functions of one number, in a fixed number of steps.

use std::convert::Infallible;

use super::rates::OpenBounds;
use crate::stats::tails::halved;

/// Steps of the golden section: the bracket shrinks by 0.618²⁶ = 4·10⁻⁶, and the value, flat at the
/// top, is right to the square of that.
const GOLDEN_STEPS: u32 = 26;
/// Halvings until a bracket has shrunk to 10⁻¹³ of its width.
const HALVINGS: u32 = 44;
/// A log-likelihood this near to the wanted one is there.
const ZERO: f64 = 1e-9;

/// The largest value of `f` between two ends and where it is: the best of `cells` + 1 points at equal
/// distances, improved between its neighbours.
pub fn maximum(f: impl Fn(f64) -> f64, low: f64, high: f64, cells: u32) -> (f64, f64) {
    let step = (high - low) / f64::from(cells);
    let mut best = (low, f(low));
    for cell in 1..=cells {
        let at = low + step * f64::from(cell);
        let value = f(at);
        if value > best.1 {
            best = (at, value);
        }
    }
    let inside = golden(&f, (best.0 - step).max(low), (best.0 + step).min(high));
    // An end of the range may be the best of all.
    if inside.1 > best.1 { inside } else { best }
}

/// The top of a function with one maximum between two ends.
pub fn golden(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let mut left = high - SHARE * (high - low);
    let mut right = low + SHARE * (high - low);
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..GOLDEN_STEPS {
        if at_left > at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - SHARE * (high - low);
            at_left = f(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + SHARE * (high - low);
            at_right = f(right);
        }
    }
    if at_left > at_right {
        (left, at_left)
    } else {
        (right, at_right)
    }
}

/// Where `holds` changes from true, at `from`, to false, at `to`, to 10⁻¹³ of their distance.
pub fn change(holds: impl Fn(f64) -> bool, from: f64, to: f64) -> f64 {
    let holds = |at| Ok::<_, Infallible>(holds(at));
    let Ok([yes, _]) = halved(HALVINGS, [from, to], holds);
    yes
}

/// Where `f`, a difference of log-likelihoods that is at least 0 at `from` and below at `to`, crosses 0, to
/// 10⁻⁹ of its value: false position in the Illinois form, and halving while `f` is infinite.
pub fn crossing(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let ((mut yes, mut at_yes), (mut no, mut at_no)) = ((from, f(from).max(0.0)), (to, f(to)));
    // The end that moved last, +1 or −1: false position alone would move one end for ever.
    let mut moved = 0;
    for _ in 0..2 * HALVINGS {
        let next = if at_no.is_finite() {
            yes + (no - yes) * (at_yes / (at_yes - at_no))
        } else {
            0.5 * (yes + no)
        };
        let value = f(next);
        if value.abs() <= ZERO {
            return next;
        }
        if value > 0.0 {
            (yes, at_yes) = (next, value);
            if moved > 0 {
                at_no *= 0.5;
            }
            moved = 1;
        } else {
            (no, at_no) = (next, value);
            if moved < 0 {
                at_yes *= 0.5;
            }
            moved = -1;
        }
    }
    yes
}

/// Where a profile of log-likelihoods with its top at `best` falls below `floor` on the way to either end of its range; missing
/// where it does not.
pub fn interval(profile: impl Fn(f64) -> f64, floor: f64, best: f64, ends: [f64; 2]) -> OpenBounds {
    let [lower, upper] = ends
        .map(|end| (profile(end) < floor).then(|| crossing(|at| profile(at) - floor, best, end)));
    OpenBounds { lower, upper }
}

#[cfg(test)]
mod tests;
