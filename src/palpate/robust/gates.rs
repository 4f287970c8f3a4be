//! What is wrong with a record whatever the gel: a sensor at its end, glitches, another unit or sign, no contact.

use super::modes::Modes;

/// A sample is a glitch if it is so many standard deviations from what the others say of it.
const GLITCH: f64 = 6.0;
/// A sensor is stuck where this share of the normal forces has one value.
const STUCK: f64 = 0.95;
/// So many glitches are replaced, or this share of the samples; more refuse the record.
pub const MOST_GLITCHES: usize = 2;
const MOST_GLITCHES_SHARE: f64 = 0.05;
/// The fewest samples of a record in stated noise.
pub const LEAST_SAMPLES_IN_NOISE: usize = 8;

/// Whether one end of the range of `channel` occurs too often: the sensor was at its end.
///
/// Implements: ROB-001.
pub fn is_saturated(channel: &[f64]) -> bool {
    let sorted = sorted(channel);
    let runs: Vec<usize> = sorted.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
    let samples = sorted.len() as f64;
    let (Some(first), Some(last)) = (runs.first(), runs.last()) else {
        return false;
    };
    let inner = runs.get(1..runs.len() - 1).unwrap_or_default();
    let inner = inner.iter().copied().max().unwrap_or(0);
    let at = |share: f64| sorted[(share * (samples - 1.0)) as usize];
    // A coarse converter has many samples of each value.
    let coarse = 4.0 * samples * step(channel) / (at(0.975) - at(0.025)).max(f64::MIN_POSITIVE);
    let is_end = |count: usize, other: usize| {
        let most = inner.max(other);
        count as f64 >= f64::max(4.0, 0.02 * samples) && count > 3 * most && count as f64 > coarse
    };
    // One value alone is both ends.
    let is_constant = runs.len() == 1 && samples >= 4.0;
    is_constant || is_end(*first, *last) || is_end(*last, *first)
}

/// Whether one value is nearly all of the normal force, which differs from place to place over a gel.
///
/// Implements: ROB-001.
pub fn is_stuck(normal: &[f64]) -> bool {
    let sorted = sorted(normal);
    let runs = sorted.chunk_by(|a, b| a == b).map(<[f64]>::len);
    let is_most = |most: usize| most as f64 >= STUCK * sorted.len() as f64;
    runs.max().is_some_and(is_most)
}

fn sorted(channel: &[f64]) -> Vec<f64> {
    let mut sorted = channel.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The smallest difference of two values, N: the resolution of the sensor.
pub fn step(channel: &[f64]) -> f64 {
    let sorted = sorted(channel);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let least = steps
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Replaces glitches by what the modes say of the samples beside them; their number, or none if there are too many. The noise has at
/// least the variance `least`, N².
///
/// Implements: ROB-002.
pub fn without_glitches(modes: &Modes, channel: &mut [f64], least: f64) -> Option<usize> {
    let samples = channel.len();
    let most = MOST_GLITCHES.max((MOST_GLITCHES_SHARE * samples as f64) as usize);
    let free: Vec<f64> = (0..samples)
        .map(|at| (1.0 - modes.leverage(at)).max(1e-3))
        .collect();
    for found in 0..=most {
        let left = modes.residual(channel);
        let degrees = (samples - modes.count() - found) as f64;
        let squares: f64 = left.iter().map(|r| r * r).sum();
        let score = |at: usize| {
            let own = left[at] * left[at] / free[at];
            let others = match degrees > 1.0 {
                true => (squares - own) / (degrees - 1.0),
                // The other samples say nothing of the noise.
                false => 0.0,
            };
            own / others.max(least).max(f64::MIN_POSITIVE)
        };
        let worst = (0..samples).max_by(|&a, &b| score(a).total_cmp(&score(b)))?;
        if score(worst) <= GLITCH * GLITCH {
            return Some(found);
        }
        channel[worst] -= left[worst] / free[worst];
    }
    None
}
