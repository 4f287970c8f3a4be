//! Maxima and crossings of functions of one number, in a fixed number of steps.

use std::convert::Infallible;

use super::rates::OpenBounds;
use palpate::stats::tails::halved;

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

/// The largest of the maxima between each two of these `ends`, each with so many cells, and where it is.
pub fn largest(f: impl Fn(f64) -> f64, ends: &[f64], cells: u32) -> (f64, f64) {
    let of = |ends: &[f64]| maximum(&f, ends[0], ends[1], cells);
    let maxima = ends.windows(2).map(of);
    let larger = |a: (f64, f64), b: (f64, f64)| if b.1 > a.1 { b } else { a };
    maxima.fold((f64::NAN, f64::NEG_INFINITY), larger)
}

/// The top of a function with one maximum between two ends.
fn golden(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
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
mod tests {
    //! Functions whose maxima and crossings are known.

    use super::*;
    use palpate_asserts::assert_near;

    // Verifies: PSY-040.
    #[test]
    fn maxima_inside_and_at_the_ends() {
        // The bracket of two cells shrinks by 4·10⁻⁶.
        let (at, value) = maximum(|x| 3.0 - (x - 0.3) * (x - 0.3), -2.0, 5.0, 7);
        assert_near(at, 0.3, 8e-6);
        assert_near(value, 3.0, 1e-10);
        assert_eq!(maximum(|x| x, -1.0, 2.0, 3).0, 2.0);
        assert_eq!(maximum(|x| -x, -1.0, 2.0, 3).0, -1.0);
        // Of two hills the higher one.
        let hills = |x: f64| (-(x - 1.0) * (x - 1.0)).exp() + 1.1 * (-(x - 7.0) * (x - 7.0)).exp();
        assert_near(maximum(hills, 0.0, 10.0, 10).0, 7.0, 1e-5);
    }

    // Verifies: PSY-040.
    #[test]
    fn crossings_in_either_direction_and_from_infinity() {
        let root = std::f64::consts::LN_2;
        assert_near(crossing(|x| 2.0 - x.exp(), 0.0, 40.0), root, 1e-9);
        assert_near(crossing(|x| x.exp() - 2.0, 3.0, -1.0), root, 1e-9);
        assert_near(crossing(|x| 2.0 + x.ln(), 1.0, 0.0), (-2.0_f64).exp(), 1e-9);
        let root = change(|x| x * x < 2.0, 0.0, 2.0);
        assert_near(root, std::f64::consts::SQRT_2, 4e-13);
    }
}
