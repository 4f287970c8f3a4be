//! Measured forces at jittered or scattered poses, put on a grid (`spec/force-map.md`).

use nalgebra::{Matrix2, Vector2};

use super::{ForceTable, Matrix};
use crate::decimal::mm;
use crate::force::Force;
use crate::refusal::Refusal;

/// A table of forces at the poses of a grid, and how far the samples were from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Gridded {
    /// The forces at the poses.
    pub table: ForceTable,
    /// The greatest distance of a sample from the nearest depth and lateral position of the grid, m.
    pub largest_shift: [f64; 2],
    /// The root mean square of what the planes leave of the samples at their poses, N; 0 where each pose has one sample, none of a force
    /// that is not there.
    pub residual: Force<Option<f64>>,
}

/// A sample: depth, lateral position (m), normal and lateral force (N).
type Sample = [f64; 4];

/// Squares of distances below this, over those of the step, are none: samples on a line do not say what is beside it.
const RANK: f64 = 1e-12;
/// The square of a distance of a pose from the middle of its samples, over their variance, beyond which a slope is noise.
const FARTHEST: f64 = 10.0;

/// The forces at the poses of a grid with these `steps` of depth and lateral position, m: at each pose that of a plane through the samples
/// less than a step away in both, with the weight (1 − |u|³)³ of each distance u over its step. Of the normal force alone unless the
/// samples have `has_lateral` forces.
///
/// # Errors
/// A step that is not above 0; a pose of the grid without a sample.
///
/// Implements: MAP-080, MAP-081.
pub fn gridded(samples: &[Sample], has_lateral: bool, steps: [f64; 2]) -> Result<Gridded, Refusal> {
    for step in steps {
        let refusal = Refusal::value("grid", step, "a finite number of metres above 0");
        refusal.when(!(step > 0.0 && step.is_finite()))?;
    }
    let axes = [0, 1].map(|axis| numbers(samples, axis, steps[axis]));
    // Before they are laid out: n samples can span n² poses.
    let (all, count) = (axes[0].len() * axes[1].len(), samples.len());
    let found = format!("the grid has {all} poses, and there are {count} samples");
    Refusal::state(found, "choose a coarser grid").when(all > count)?;
    let poses: Vec<[i64; 2]> = (axes[0].iter())
        .flat_map(|depth| axes[1].iter().map(|lateral| [*depth, *lateral]))
        .collect();
    let fits = poses.iter().map(|pose| at_pose(samples, *pose, steps));
    let fits = fits.collect::<Result<Vec<_>, _>>()?;
    let [depths, laterals] = [0, 1].map(|axis| {
        let positions = axes[axis].iter().map(|number| *number as f64 * steps[axis]);
        positions.collect::<Vec<f64>>()
    });
    let matrix = |channel: usize| {
        let columns = laterals.len();
        let at = |row: usize, column: usize| fits[row * columns + column].forces[channel];
        Matrix::from_fn(depths.len(), columns, at)
    };
    let shift = |axis: usize| {
        let away = |sample: &Sample| {
            let place = sample[axis] / steps[axis];
            (place - libm::round(place)).abs() * steps[axis]
        };
        samples.iter().map(away).fold(0.0, f64::max)
    };
    let residual = |channel: usize| {
        let squares: f64 = fits.iter().map(|fit| fit.squares[channel]).sum();
        libm::sqrt(squares / samples.len() as f64)
    };
    Ok(Gridded {
        table: ForceTable::of_channels(
            depths.clone(),
            laterals.clone(),
            matrix(0),
            has_lateral.then(|| matrix(1)),
        )?,
        largest_shift: [shift(0), shift(1)],
        residual: Force::new(has_lateral.then(|| residual(1)), Some(residual(0))),
    })
}

/// The whole multiples of a step to which samples are nearest along an axis.
fn numbers(samples: &[Sample], axis: usize, step: f64) -> Vec<i64> {
    let number = |sample: &Sample| libm::round(sample[axis] / step) as i64;
    let mut numbers: Vec<i64> = samples.iter().map(number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// Normal and lateral force at a pose, and the squares of what the plane leaves of the samples that are nearest to this pose.
struct AtPose {
    forces: [f64; 2],
    squares: [f64; 2],
}

/// A sample near a pose: its distances from it over the steps, its weight, and whether no pose is nearer.
struct Near<'s> {
    place: [f64; 2],
    weight: f64,
    is_nearest: bool,
    sample: &'s Sample,
}

/// The samples less than a step away from a pose.
fn near(samples: &[Sample], pose: [i64; 2], steps: [f64; 2]) -> Vec<Near<'_>> {
    let tricube = |u: f64| {
        let rest = 1.0 - u.abs() * u * u;
        rest * rest * rest
    };
    let near = samples.iter().filter_map(|sample| {
        let numbers = [0, 1].map(|axis| sample[axis] / steps[axis]);
        let place = [0, 1].map(|axis| numbers[axis] - pose[axis] as f64);
        let is_near = place.iter().all(|u| u.abs() < 1.0);
        is_near.then(|| Near {
            place,
            weight: tricube(place[0].abs()) * tricube(place[1].abs()),
            is_nearest: numbers.map(|number| libm::round(number) as i64) == pose,
            sample,
        })
    });
    near.collect()
}

/// Implements: MAP-080.
fn at_pose(samples: &[Sample], pose: [i64; 2], steps: [f64; 2]) -> Result<AtPose, Refusal> {
    let near = near(samples, pose, steps);
    if !near.iter().any(|of| of.is_nearest) {
        let [depth, lateral] = [0, 1].map(|axis| mm(pose[axis] as f64 * steps[axis]));
        let found = format!("no sample near depth {depth} mm, lateral {lateral} mm of the grid");
        return Err(Refusal::state(found, "choose a coarser grid"));
    }
    let all: f64 = near.iter().map(|of| of.weight).sum();
    let mean = |value: &dyn Fn(&Near<'_>) -> f64| {
        let weighted = near.iter().map(|of| of.weight * value(of));
        weighted.sum::<f64>() / all
    };
    // About the means, which count whatever slopes the samples say nothing of.
    let middle = [0, 1].map(|axis| mean(&|of| of.place[axis]));
    let about = |place: [f64; 2]| [place[0] - middle[0], place[1] - middle[1]];
    let product = |one: usize, other: usize| {
        mean(&|of| {
            let about = about(of.place);
            about[one] * about[other]
        })
    };
    let squares = [product(0, 0), product(0, 1), product(1, 1)];
    let mut fit = AtPose {
        forces: [0.0; 2],
        squares: [0.0; 2],
    };
    for channel in [0, 1] {
        let force = |of: &Near<'_>| of.sample[2 + channel];
        let level = mean(&force);
        let along = |axis: usize| mean(&|of| about(of.place)[axis] * (force(of) - level));
        let slopes = slopes(squares, middle, [along(0), along(1)]);
        let plane = |place: [f64; 2]| {
            let [depth, lateral] = about(place);
            level + slopes[0] * depth + slopes[1] * lateral
        };
        fit.forces[channel] = plane([0.0; 2]);
        let nearest = near.iter().filter(|of| of.is_nearest);
        let left = nearest.map(|of| force(of) - plane(of.place));
        fit.squares[channel] = left.map(|left| left * left).sum();
    }
    Ok(fit)
}

/// The slopes of least squares: the part of them along each principal axis of the samples, if these are spread over it, and the pose is not
/// so far from their middle, in steps, that noise would be extrapolated.
///
/// Implements: MAP-080.
fn slopes([depth, both, lateral]: [f64; 3], middle: [f64; 2], along: [f64; 2]) -> [f64; 2] {
    let axes = Matrix2::new(depth, both, both, lateral).symmetric_eigen();
    let [middle, along] = [middle, along].map(Vector2::from);
    let mut slopes = Vector2::zeros();
    for (spread, axis) in axes.eigenvalues.iter().zip(axes.eigenvectors.column_iter()) {
        let distance = axis.dot(&middle);
        if *spread > RANK && distance * distance <= FARTHEST * spread {
            slopes += axis * (axis.dot(&along) / spread);
        }
    }
    slopes.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane over depth and position, and its lateral force.
    fn sample([depth, lateral]: [f64; 2]) -> Sample {
        [
            depth,
            lateral,
            400.0 * depth + 20.0 * lateral,
            50.0 * lateral,
        ]
    }

    /// Samples of it at the poses of a grid.
    fn samples() -> Vec<Sample> {
        let poses = (1..=3).flat_map(|row| (-4..=4).map(move |column| (row, column)));
        let at = |(row, column)| [1e-3 * f64::from(row), 0.5e-3 * f64::from(column)];
        poses.map(at).map(sample).collect()
    }

    // Verifies: MAP-080, MAP-081.
    #[test]
    fn a_plane_stays_what_it_is_wherever_its_samples_are() {
        // Everywhere: the multiples of two irrational numbers.
        let place = |k: u32, step: f64| f64::from(k) * step % 1.0;
        let anywhere = |k| {
            [
                0.6e-3 + 2.8e-3 * place(k, 0.7548776662),
                4.4e-3 * place(k, 0.5698402910) - 2.2e-3,
            ]
        };
        let scattered = (0..500).map(anywhere).map(sample).collect();
        for (samples, most) in [(samples(), 0.0), (scattered, 1.0)] {
            let found = gridded(&samples, true, [1e-3, 0.5e-3]).unwrap();
            let (table, exact) = (&found.table, self::samples());
            assert_eq!((table.depths().len(), table.laterals().len()), (3, 9));
            for (row, column, normal) in table.normal().entries() {
                let [_, _, expected, along] = exact[9 * row + column];
                assert!((normal - expected).abs() < 1e-12, "{normal} {expected}");
                let lateral = table.lateral().unwrap().row(row)[column];
                assert!((lateral - along).abs() < 1e-12);
            }
            // Half a step, where samples are everywhere.
            for (found, step) in found.largest_shift.into_iter().zip([1e-3, 0.5e-3]) {
                assert!(
                    (0.39 * most..=0.5 * most + 1e-12).contains(&(found / step)),
                    "{found}"
                );
            }
            assert!(found.residual.normal.unwrap() < 1e-12);
        }
    }

    // Verifies: MAP-080, MAP-083. Several samples of a pose are averaged; the residual is theirs.
    #[test]
    fn samples_of_one_pose_are_averaged() {
        let twice = [
            [1e-3, 0.0, 1.0, 0.0],
            [1e-3, 0.0, 1.5, 0.0],
            [1e-3, 1e-3, 2.0, 0.5],
        ];
        let found = gridded(&twice, true, [1e-3, 1e-3]).unwrap();
        let normal = found.table.normal().row(0);
        assert!((normal[0] - 1.25).abs() < 1e-12 && (normal[1] - 2.0).abs() < 1e-12);
        assert!((found.residual.normal.unwrap() - (0.125f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(found.residual.lateral, Some(0.0));
        let one = gridded(&twice, false, [1e-3, 1e-3]).unwrap();
        assert_eq!(
            (one.table.normal(), one.table.lateral()),
            (found.table.normal(), None)
        );
        assert_eq!(
            (one.residual.normal, one.residual.lateral),
            (found.residual.normal, None)
        );
    }

    // Verifies: MAP-080.
    #[test]
    fn the_jitter_of_a_depth_makes_no_slope_of_noise() {
        // About 3.7 mm, 0.2 mm from a depth of the grid, on a jitter of 2 µm, and in noise of 0.01 N.
        let noise = |k: u32, step: f64| f64::from(k) * step % 1.0 - 0.5;
        let sample = |k: u32| {
            let depth = 3.7e-3 + 4e-6 * noise(k, 0.7548776662);
            let lateral = 4e-3 * noise(k, 0.5698402910);
            let force = 400.0 * depth + 0.035 * noise(k, 0.4142135624);
            [depth, lateral, force, 0.0]
        };
        let samples: Vec<_> = (0..400).map(sample).collect();
        let found = gridded(&samples, false, [0.5e-3, 0.5e-3]).unwrap();
        assert_eq!(found.table.depths(), [3.5e-3]);
        for (.., force) in found.table.normal().entries() {
            assert!((force - 1.48).abs() < 0.02, "{force}");
        }
    }

    // Verifies: MAP-081. Through the means of each place there is a line; what the two samples half a step away leave of it counts once.
    #[test]
    fn a_sample_between_two_poses_is_nearest_to_one() {
        let sample = |(lateral, normal)| [1e-3, lateral, normal, 0.0];
        let samples = [(0.0, 1.0), (0.5e-3, 1.5), (0.5e-3, 2.5), (1e-3, 3.0)].map(sample);
        let found = gridded(&samples, false, [1e-3, 1e-3]).unwrap();
        let residual = found.residual.normal.unwrap();
        assert!(
            (residual - (0.5f64 / 4.0).sqrt()).abs() < 1e-12,
            "{residual}"
        );
    }

    // Verifies: MAP-080.
    #[test]
    fn a_pose_without_a_sample_is_refused() {
        let mut few = samples();
        few.remove(4);
        let error = gridded(&few, true, [1e-3, 0.5e-3]).unwrap_err().to_string();
        let expected = "the grid has 27 poses, and there are 26 samples; choose a coarser grid";
        assert_eq!(error, expected);
        let twice = few[0];
        few.push(twice);
        let error = gridded(&few, true, [1e-3, 0.5e-3]).unwrap_err().to_string();
        let expected =
            "no sample near depth 1.0 mm, lateral 0.0 mm of the grid; choose a coarser grid";
        assert_eq!(error, expected);
        assert!(gridded(&few, true, [2e-3, 1e-3]).is_ok());
        assert!(gridded(&few, true, [0.0, 1e-3]).is_err());
        assert!(gridded(&few, true, [1e-3, f64::NAN]).is_err());
    }
}
