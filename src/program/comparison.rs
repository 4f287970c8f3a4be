//! A measured map compared with the computed forces of its phantom: advice on units and signs.

use super::progress::{bar, tell_large_mesh};
use palpate::decimal::format_scaled;
use palpate::fem::{Contact, FemError, MESH_SIZE, Model, Pose};
use palpate::force::Force;
use palpate::force_map::ForceTable;
use palpate::phantom::Phantom;

/// Most depths and lateral positions that are solved.
const MOST: [usize; 2] = [7, 8];
/// A ratio of forces in this range, or its inverse, means that mN and N were confused.
const THOUSAND: std::ops::RangeInclusive<f64> = 300.0..=3000.0;
/// Lengths so many times too large mean that mm and m were confused.
const FAR_TOO_LARGE: f64 = 10.0;
/// Below this cosine, two forces over the poses have opposite signs.
const OPPOSITE: f64 = -0.7;
/// The sign of a lateral force is judged only above this share of the normal force.
const LARGE: f64 = 0.02;

/// What stands out in a measured map of `phantom`; if nothing does, its difference from the computed forces.
///
/// # Errors
/// The solver failed.
///
/// Implements: CLI-022.
pub fn compare(measured: &ForceTable, phantom: &Phantom) -> Result<Vec<String>, FemError> {
    let odd = odd_lengths(measured, phantom);
    if !odd.is_empty() {
        return Ok(odd);
    }
    let touching = measured.depths().partition_point(|&depth| depth <= 0.0);
    let rows = spread(touching..measured.depths().len(), MOST[0]);
    let columns = spread(0..measured.laterals().len(), MOST[1]);
    let poses = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
    let poses: Vec<_> = poses.filter(|&at| stands(measured, phantom, at)).collect();
    if poses.is_empty() {
        return Ok(vec![
            "no pose with the probe in the gel, so nothing was compared".into(),
        ]);
    }
    tell_large_mesh(phantom, MESH_SIZE)?;
    let model = Model::new(phantom, MESH_SIZE, Contact::default())?;
    let bar = bar(poses.len(), phantom.name());
    let pair = |(row, column)| {
        let solution = model.solve(pose(measured, (row, column)))?;
        bar.inc(1);
        let found = Force::new(measured.lateral(), Some(measured.normal()));
        let found = found.map(|force| Some(force?.row(row)[column]));
        Ok::<_, FemError>((found, solution.force))
    };
    let pairs = poses.into_iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    bar.finish_and_clear();
    Ok(odd_forces(&pairs))
}

/// The number of poses of a map that the probe of `phantom` cannot reach.
///
/// Implements: CLI-022.
pub fn left_out(measured: &ForceTable, phantom: &Phantom) -> usize {
    let poses = measured.normal().entries();
    let stand = poses.map(|(row, column, _)| stands(measured, phantom, (row, column)));
    stand.filter(|stands| !stands).count()
}

fn pose(table: &ForceTable, (row, column): (usize, usize)) -> Pose {
    Pose {
        depth: table.depths()[row],
        lateral: table.laterals()[column],
    }
}

fn stands(table: &ForceTable, phantom: &Phantom, at: (usize, usize)) -> bool {
    let Pose { depth, lateral } = pose(table, at);
    phantom.check_pose(depth, lateral).is_ok()
}

/// At most `most` (> 1) numbers of `all`, the first and the last among them.
fn spread(all: std::ops::Range<usize>, most: usize) -> impl Iterator<Item = usize> + Clone {
    let steps = all.len().min(most).max(2) - 1;
    let count = all.len().min(most);
    (0..count).map(move |k| all.start + k * (all.len() - 1) / steps)
}

/// The axes of a map that do not look like lengths in the phantom.
///
/// Implements: CLI-022.
fn odd_lengths(measured: &ForceTable, phantom: &Phantom) -> Vec<String> {
    let largest = |axis: &[f64]| axis.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let axes = [
        ("depths", largest(measured.depths()), phantom.height()),
        (
            "lateral positions",
            largest(measured.laterals()),
            phantom.well().width / 2.0,
        ),
    ];
    let odd = |(name, found, fits): (&str, f64, f64)| {
        let like = match found {
            _ if found > FAR_TOO_LARGE * fits => "mm in a column of metres",
            _ if found > 0.0 && 1e3 * found < fits => "metres in a column of mm",
            _ => return None,
        };
        let [found, fits] = [found, fits].map(|length| format_scaled(length, 3));
        Some(format!(
            "the {name} look like {like}: they reach {found} mm, the phantom {fits} mm"
        ))
    };
    axes.into_iter().filter_map(odd).collect()
}

/// What stands out in measured and computed forces (N) at some poses in the gel; if nothing does, their difference.
///
/// Implements: CLI-022.
fn odd_forces(pairs: &[(Force<Option<f64>>, Force<f64>)]) -> Vec<String> {
    let of = |channel: fn(Force<Option<f64>>) -> Option<f64>| {
        let there = |(a, b): &(_, Force<f64>)| channel(*a).zip(channel(b.map(Some)));
        pairs.iter().filter_map(there).collect::<Vec<_>>()
    };
    let (normal, lateral) = (of(|force| force.normal), of(|force| force.lateral));
    let ratio = median_ratio(&normal);
    let times = format!("{ratio:.4} times the computed one (median)");
    let mut odd = Vec::new();
    for (ratio, like) in [
        (ratio, "mN in a column of N"),
        (ratio.recip(), "N in a column of mN"),
    ] {
        if THOUSAND.contains(&ratio.abs()) {
            odd.push(format!(
                "the forces look like {like}: the normal force is {times}"
            ));
        }
    }
    if cosine(&normal) < OPPOSITE {
        odd.push(
            "the normal force looks negated: it must be positive where the gel pushes the probe up"
                .into(),
        );
    }
    if largest(&lateral) > LARGE * largest(&normal) && cosine(&lateral) < OPPOSITE {
        odd.push("the lateral force looks negated: it must be positive where the gel pushes the probe along +x".into());
    }
    if odd.is_empty() {
        let mean = |square: fn(&(f64, f64)) -> f64| {
            normal.iter().map(square).sum::<f64>() / normal.len() as f64
        };
        let off = mean(|(found, expected)| (found - expected) * (found - expected)).sqrt();
        let share = 100.0 * off / mean(|(_, expected)| expected * expected).sqrt();
        odd.push(format!(
            "the normal force is {times}, with an rms difference of {off:.4} N ({share:.1} %) over {} poses",
            normal.len()
        ));
    }
    odd
}

/// The largest computed force.
fn largest(pairs: &[(f64, f64)]) -> f64 {
    let sizes = pairs.iter().map(|(_, expected)| expected.abs());
    sizes.fold(0.0, f64::max)
}

/// The median of measured over computed force, where the latter is more than a tenth of its largest.
fn median_ratio(pairs: &[(f64, f64)]) -> f64 {
    let enough = |(_, expected): &&(f64, f64)| expected.abs() > 0.1 * largest(pairs);
    let ratios = pairs.iter().filter(enough);
    let mut ratios: Vec<f64> = ratios.map(|(found, expected)| found / expected).collect();
    ratios.sort_by(f64::total_cmp);
    let Some(last) = ratios.len().checked_sub(1) else {
        return f64::NAN;
    };
    0.5 * (ratios[last / 2] + ratios[ratios.len() / 2])
}

/// Σ ab / √(Σa² Σb²): 1 where both are the same but for a factor, −1 where that is negative.
fn cosine(pairs: &[(f64, f64)]) -> f64 {
    let sum = |product: fn(&(f64, f64)) -> f64| pairs.iter().map(product).sum::<f64>();
    let squares = sum(|(a, _)| a * a) * sum(|(_, b)| b * b);
    sum(|(a, b)| a * b) / squares.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_asserts::numbers;

    /// Computed forces over a gel, (normal, lateral).
    const COMPUTED: [(f64, f64); 4] = [(1.0, -0.2), (2.0, 0.0), (1.0, 0.2), (0.05, 0.0)];

    /// The findings on these forces times (normal, lateral) factors, with an error of (0.3, −0.3, 0, 0.04) N in the normal force.
    fn said(factors: (f64, f64)) -> Vec<String> {
        let errors = [0.3, -0.3, 0.0, 0.04];
        let pair = |((normal, lateral), error): ((f64, f64), f64)| {
            let found = Force::new(factors.1 * lateral, factors.0 * (normal + error));
            (found.map(Some), Force::new(lateral, normal))
        };
        let pairs: Vec<_> = COMPUTED.into_iter().zip(errors).map(pair).collect();
        odd_forces(&pairs)
    }

    /// Asserts the beginnings of the findings on each of `cases`, two numbers.
    fn assert_said(cases: &str, said: impl Fn([f64; 2]) -> Vec<String>) {
        for case in cases.trim().lines() {
            let (of, expected) = case.split_once(" => ").unwrap();
            let expected: Vec<_> = expected
                .split(" | ")
                .filter(|&words| words != "nothing")
                .collect();
            let said = said(numbers(of)[0]);
            assert_eq!(said.len(), expected.len(), "{said:?}");
            for (said, expected) in std::iter::zip(&said, expected) {
                assert!(said.starts_with(expected), "{said}");
            }
        }
    }

    // Verifies: CLI-022.
    #[test]
    fn units_and_signs_that_look_wrong_are_told() {
        // Factors, and the beginnings of the findings. Ratios of 1.3, 0.85 and 1 (0.05 N is too little to count); √(0.1816/4) of
        // √(6.0025/4).
        let cases = "
            1e3 1e3 => the forces look like mN in a column of N: the normal force is 1000.0000
            1e-3 1e-3 => the forces look like N in a column of mN: the normal force is 0.0010
            -1 1 => the normal force looks negated
            1 -1 => the lateral force looks negated
            -1e3 -1e3 => the forces look like mN | the normal force looks | the lateral force looks
            1 1 => the normal force is 1.0000 times the computed one (median), with an rms difference of 0.2131 N (17.4 %) over 4 poses
            250 1 => the normal force is 250.0000";
        assert_said(cases, |[normal, lateral]| said((normal, lateral)));
        // A lateral force of 0.03 N beside 2 N tells nothing of its sign.
        let pairs = [(-0.03, 0.03), (0.03, -0.03)].map(|(found, expected)| {
            (
                Force::new(Some(found), Some(2.0)),
                Force::new(expected, 2.0),
            )
        });
        assert!(odd_forces(&pairs)[0].starts_with("the normal force is 1.0000"));
    }

    // Verifies: CLI-022.
    #[test]
    fn lengths_in_the_wrong_unit_are_told_before_anything_is_solved() {
        let phantom = Phantom::builtin("none").unwrap();
        let table = |depth: f64, lateral: f64| {
            let rows = [0.0, depth].map(|d| {
                [-lateral, lateral]
                    .map(|x| format!("{d},{x},0,0\n"))
                    .concat()
            });
            let head = "depth_m,lateral_m,normal_force_n,lateral_force_n\n";
            ForceTable::from_csv(&format!("{head}{}", rows.concat()), "gel.csv").unwrap()
        };
        let cases = "
            4 8e-3 => the depths look like mm in a column of metres: they reach 4000.0 mm, the phantom 15.5 mm
            4e-6 8e-3 => the depths look like metres in a column of mm
            4e-3 8 => the lateral positions look like mm in a column of metres
            4 8 => the depths look like mm | the lateral positions look like mm
            4e-6 8e-6 => the depths look like metres | the lateral positions look like metres
            16e-3 12e-3 => nothing";
        assert_said(cases, |[depth, lateral]| {
            odd_lengths(&table(depth, lateral), &phantom)
        });
        assert_eq!(left_out(&table(16e-3, 5e-3), &phantom), 2);
        assert_eq!(left_out(&table(4e-3, 5e-3), &phantom), 0);
    }

    // Verifies: CLI-022.
    #[test]
    fn poses_are_spread_from_end_to_end() {
        let of = |all, most| spread(all, most).collect::<Vec<_>>();
        assert_eq!(of(0..41, 8), [0, 5, 11, 17, 22, 28, 34, 40]);
        assert_eq!(of(3..6, 8), [3, 4, 5]);
        assert_eq!((of(3..4, 8), of(3..3, 8)), (vec![3], vec![]));
    }
}
