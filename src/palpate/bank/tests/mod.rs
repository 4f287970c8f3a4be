//! Banks of signals that are known in closed form.

use super::*;
use crate::detect::nuisance::NoiseLevel;
use crate::force::Force;
use crate::force_map::tests::{measured, table_of};
use crate::force_map::{ForceTable, Matrix};
use crate::phantom::Phantom;
use crate::stats::random::Generator;

mod detector;
mod file;
mod locate;
mod place;
mod rates;
mod watch;

/// Samples of a sweep over −8 … 8 mm.
pub const SAMPLES: usize = 33;

/// The signal of an inclusion at `x` (mm) with the depth `d` (mm): a bump as wide as it is deep.
pub fn signal(x: f64, d: f64) -> Vec<f64> {
    let sample = |k: usize| 0.5 * k as f64 - 8.0 - x;
    let shape = |k: usize| (-0.5 * (sample(k) / (1.0 + d)).powi(2)).exp() / d;
    (0..SAMPLES).map(shape).collect()
}

pub fn times(factor: f64, values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

// The width of an ellipse turned by 30°, 2 √(3² cos² + 1.5² sin²) mm.
// Verifies: BNK-001.
#[test]
fn a_width_is_the_same_at_every_position() {
    let ellipse = Shape::Ellipse {
        width: 6e-3,
        height: 3e-3,
        angle_deg: 30.0,
    };
    let points = vec![[-1.1e-3, 0.0], [1.3e-3, 0.0], [0.0, 2e-3]];
    let shapes = [
        (ellipse, 5.408_326_913_195_984e-3),
        (Shape::Polygon { points }, 2.4e-3),
    ];
    for (shape, expected) in shapes {
        let width = |x: i32| {
            let phantom = Phantom::builtin("6.6").unwrap().changed(|parts| {
                parts.inclusions[0].shape = shape.clone();
                parts.inclusions[0].centre_x = f64::from(x) * 1e-4;
            });
            Parameter::Diameter.of(&phantom.unwrap().inclusions()[0])
        };
        // A few roundings.
        assert!(
            (width(0) - expected).abs() < 1e-17,
            "{} {expected}",
            width(0)
        );
        assert!((-40..=40).all(|x| width(x) == width(0)));
    }
}

/// A record of white noise about `mean`.
pub fn noisy(seed: u64, trial: u64, mean: &[f64]) -> Vec<f64> {
    let mut record = vec![0.0; mean.len()];
    Generator::new(seed, 0).normals(trial, 0, &mut record);
    record.iter_mut().zip(mean).for_each(|(r, mean)| *r += mean);
    record
}

/// The detector of templates at these positions in known noise, beside nothing.
pub fn at_positions(positions: &[f64], templates: Vec<f64>, prior: &[f64]) -> BankDetector {
    let points = [positions.to_vec(), vec![0.0], vec![0.0], vec![0.0]];
    BankDetector::new(&points, templates, prior, vec![], &[], NoiseLevel::Known).unwrap()
}

/// Positions by 1 mm and depths by 0.5 mm.
pub fn axes() -> [Vec<f64>; 4] {
    let positions = (-6..=6).map(f64::from).collect();
    let depths = (4..=8).map(|k| 0.5 * f64::from(k)).collect();
    [positions, depths, vec![1.0], vec![1.0]]
}

/// The detector of these signals in noise of standard deviation 1/`scale`, beside an unknown offset if it is so.
pub fn detector(scale: f64, has_offset: bool, level: NoiseLevel) -> BankDetector {
    let [positions, depths, ..] = axes();
    let points = depths
        .iter()
        .flat_map(|d| positions.iter().map(move |x| (*x, *d)));
    let templates: Vec<f64> = points
        .flat_map(|(x, d)| times(scale, &signal(x, d)))
        .collect();
    let number = templates.len() / SAMPLES;
    let offset = vec![1.0; if has_offset { SAMPLES } else { 0 }];
    let prior = vec![1.0 / number as f64; number];
    BankDetector::new(&axes(), templates, &prior, offset, &[], level).unwrap()
}

/// A map of one depth and −3 … 3 mm: a bump at `x` mm that is the larger, the shallower `depth` (mm), on 1 N; without an inclusion if
/// there is none.
pub fn map(inclusion: Option<(f64, f64, f64)>, depths: &[f64]) -> ForceMap {
    let laterals: Vec<f64> = (-6..=6).map(|k| f64::from(k) * 5e-4).collect();
    let phantom = Phantom::builtin("6.6").unwrap();
    let bump = |lateral: f64| {
        let (x, depth, diameter) = inclusion?;
        let from = (1e3 * lateral - x) / (0.5 + 0.1 * depth);
        Some(diameter / 10.0 * (2.0 / depth) * (-0.5 * from * from).exp())
    };
    let phantom = phantom.changed(|parts| match inclusion {
        None => parts.inclusions.clear(),
        Some((x, depth, diameter)) => {
            parts.inclusions[0].centre_x = 1e-3 * x;
            parts.inclusions[0].depth = 1e-3 * depth;
            parts.inclusions[0].shape = Shape::Disc {
                diameter: 1e-3 * diameter,
            };
        }
    });
    let normal = |depth, lateral| 250.0 * depth + bump(lateral).unwrap_or(0.0);
    let table = table_of(depths, &laterals, |depth, x| [0.0, normal(depth, x)]);
    measured(phantom.ok(), table)
}

/// Inclusions at −2 … 2 mm, 3, 4, 5 and 6 mm deep, of 4 and 8 mm, the last first.
pub fn maps() -> Vec<ForceMap> {
    let mut maps = Vec::new();
    for diameter in [8.0, 4.0] {
        for depth in [6.0, 5.0, 4.0, 3.0] {
            for x in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                maps.push(map(Some((x, depth, diameter)), &[4e-3]));
            }
        }
    }
    maps
}

pub fn reference() -> ForceMap {
    map(None, &[3.7e-3, 4e-3, 4.3e-3])
}
