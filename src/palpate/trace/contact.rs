//! Whether a record is of a probe that touches the gel.

use super::cause::Cause;
use crate::force_map::ForceMap;

/// The level of a record of the gel: of computed gels 0.57 to 1.34, at finite strain up to 1.83.
const LEVEL: [f64; 2] = [0.5, 2.2];
/// From here on another unit is likelier than anything else.
const UNIT: f64 = 30.0;
/// Below this the sign is another.
const SIGN: f64 = -0.4;

/// The radius of the probe where no phantom says it, m: the paper's.
pub const RADIUS: f64 = 6.5e-3;

/// The radius of the probe over this map, m.
pub fn radius(map: &ForceMap) -> f64 {
    map.phantom().map_or(RADIUS, |of| of.probe().radius)
}

/// A sweep over less than this share of the radius of the probe shows no inclusion.
const NARROW: f64 = 0.46;

/// The force of touching is that of the part in which it is largest, of so many.
const PARTS: usize = 4;
/// ln of the likelihood ratio from which on a sample at an end is in air: 10⁶ to 1.
const IN_AIR: f64 = 13.8;
/// A touch with less force, N, may be lost in the drift of a sensor.
const LIGHT: f64 = 0.5;

/// Σ F f/Σ f² of forces F and those that are expected, f.
pub fn level(forces: &[f64], expected: &[f64]) -> f64 {
    let cross: f64 = forces.iter().zip(expected).map(|(a, b)| a * b).sum();
    let square: f64 = expected.iter().map(|b| b * b).sum();
    cross / square.max(f64::MIN_POSITIVE)
}

/// Whether a sweep of this width, m, is too short to show an inclusion.
///
/// Implements: ROB-004.
pub fn is_narrow(width: f64, radius: f64) -> bool {
    width < NARROW * radius
}

/// What the level of a record, Σ F f/Σ f² of its normal force, says is wrong.
///
/// Implements: ROB-003, TRC-016.
pub fn wrong_level(level: f64) -> Option<Cause> {
    match level {
        level if level > UNIT => Some(Cause::ForceUnit),
        level if level > LEVEL[1] => Some(Cause::Level),
        level if level >= LEVEL[0] => None,
        level if level < SIGN => Some(Cause::Sign),
        _ => Some(Cause::NoContact),
    }
}

/// The same where another gel than that of the maps is a gain, which is fitted.
///
/// Implements: TRC-016, SEQ-023.
pub fn wrong_gain(level: f64) -> Option<Cause> {
    wrong_level(level).filter(|&of| of != Cause::Level)
}

/// How many samples at the start and at the end are in air: those beside the part of the record that is likeliest in contact, in noise of
/// this `variance`, N². There the force is L f, with the largest level L of four parts of the record, and beside it there is none.
/// An end is not in air where that is not 10⁶ times as likely as contact, or where its L f is below 0.5 N in the mean, and none is where that
/// of the record is.
///
/// Implements: TRC-017.
pub fn in_air(forces: &[f64], expected: &[f64], variance: f64) -> [usize; 2] {
    let samples = forces.len();
    let part = samples.div_ceil(PARTS).max(1);
    let parts = forces.chunks(part).zip(expected.chunks(part));
    let level = parts
        .map(|(forces, of)| level(forces, of))
        .fold(0.0, f64::max);
    if level * expected.iter().sum::<f64>() < LIGHT * samples as f64 {
        return [0; 2];
    }
    // ln of p(F | L f)/p(F | 0), times the variance.
    let pairs = forces.iter().zip(expected);
    let logs = pairs.map(|(force, of)| level * of * (force - 0.5 * level * of));
    let logs: Vec<f64> = logs.collect();
    let (mut start, mut sum, mut most, mut touching) = (0, 0.0, 0.0, 0..samples);
    for (at, log) in logs.iter().enumerate() {
        if sum < 0.0 {
            (start, sum) = (at, 0.0);
        }
        sum += log;
        if sum > most {
            (most, touching) = (sum, start..at + 1);
        }
    }
    [0..touching.start, touching.end..samples].map(|end| {
        let count = end.len();
        let touch = level * expected[end.clone()].iter().sum::<f64>();
        let is_light = touch < LIGHT * count as f64;
        let is_in_air = !is_light && -logs[end].iter().sum::<f64>() > IN_AIR * variance;
        if is_in_air { count } else { 0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::random::Generator;

    /// A gel whose forces rise to its walls, under a sensor with an offset and noise of 0.1 N.
    fn forces(air: [usize; 2], offset: f64, stream: u64) -> [Vec<f64>; 2] {
        let generator = Generator::new(20_261_125, stream);
        let expected: Vec<f64> = (0..401)
            .map(|k| 1.5 + 3e-6 * f64::from((k - 200) * (k - 200)))
            .collect();
        let touches = |at: usize| at >= air[0] && at < 401 - air[1];
        let force = |(at, of): (usize, &f64)| {
            let gel = if touches(at) { 1.1 * of } else { 0.0 };
            gel + offset + 0.1 * generator.normal(1, at as u64)
        };
        [expected.iter().enumerate().map(force).collect(), expected]
    }

    // Verifies: TRC-017.
    #[test]
    fn samples_in_air_are_counted_at_either_end() {
        for (stream, offset) in [(1, 0.0), (2, 0.3), (3, -0.3)] {
            for air in [[0, 0], [1, 0], [40, 0], [0, 40], [3, 150], [250, 0]] {
                let [found, expected] = forces(air, offset, stream);
                assert_eq!(in_air(&found, &expected, 0.01), air, "{offset}");
            }
        }
        // No noise, and no force at all: nothing is likelier than nothing.
        assert_eq!(in_air(&[1.0; 9], &[1.0; 9], 0.0), [0, 0]);
        assert_eq!(in_air(&[0.0; 9], &[1.0; 9], 0.0), [0, 0]);
        assert_eq!(
            in_air(&[0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0], &[1.0; 7], 0.0),
            [2, 0]
        );
    }

    // Verifies: TRC-017.
    #[test]
    fn a_light_touch_is_no_air() {
        // Forces of 0.6 N in noise of 0.2 N: a sample below half of them is common, a change is not. The rate is at most 10⁻⁶ by the
        // inequality of Ville for a likelihood ratio.
        for stream in 0..500 {
            let generator = Generator::new(20_261_125, stream);
            let force = |at| 0.6 + 0.2 * generator.normal(1, at);
            let forces: Vec<f64> = (0..401).map(force).collect();
            assert_eq!(in_air(&forces, &[0.6; 401], 0.04), [0, 0]);
        }
        // Passes at depths that grow: an offset is as large as the force of the first.
        let depth = |at: usize| if at < 161 { 0.24 } else { 1.48 };
        let expected: Vec<f64> = (0..322).map(depth).collect();
        let forces: Vec<f64> = expected.iter().map(|force| force - 0.2).collect();
        assert_eq!(in_air(&forces, &expected, 0.01), [0, 0]);
        // A drift of 0.3 N is as large as the force.
        let drift: Vec<f64> = (0..401).map(|at| 0.3 * f64::from(at) / 400.0).collect();
        assert_eq!(in_air(&drift, &[0.2; 401], 1e-4), [0, 0]);
    }
}
