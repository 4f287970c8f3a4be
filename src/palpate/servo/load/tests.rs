//! Loading on maps whose rounding and slopes are known.

mod energy;

use proptest::prelude::*;

use super::*;
use crate::force_map::tests::table_of as map;
use crate::servo::EXTRAPOLATION_CELLS;
use palpate_asserts::{assert_cases, assert_near, row};

/// A device that plays everything.
const FREE: Damping = Damping {
    period_s: 1e-3,
    delay_periods: 0,
    damping_n_s_per_m: 1e3,
    friction_n: 1e6,
    resolution_m: 1e-6,
};

/// Limits that allow everything.
fn open_limits() -> Limits {
    Limits::new(20.0, 20.0, 20.0, 20).unwrap()
}

fn scaled(map: &ForceTable, device: &Damping) -> Result<(LoadedTable, f64), Refusal> {
    LoadedTable::scaled_to_be_passive(map, device, &open_limits())
}

/// A device for springs up to so many N/m.
fn playing_up_to(stiffest: f64) -> Damping {
    Damping {
        damping_n_s_per_m: stiffest / 2000.0,
        ..FREE
    }
}

// Verifies: SRV-044.
#[test]
fn the_surface_is_put_in_front_and_rounding_is_reported() {
    let loaded = LoadedTable::new(&map(&[0.1, 0.5], &[-0.25, 0.5], |d, x| [x, 10.0 * d])).unwrap();
    let table = loaded.table();
    assert_eq!(table.depths().knots(), [0.0, 0.1f32, 0.5]);
    assert_eq!(table.laterals().knots(), [-0.25, 0.5]);
    let row = |normal| [-0.25, 0.5].map(|lateral| Force { lateral, normal });
    let expected = [[Force::ZERO; 2], row(1.0), row(5.0)];
    assert_eq!(table.forces(), expected.concat());
    // 0.1 is not a number of f32; the exact difference by hand: 0x3DCCCCCD − 0.1.
    assert_eq!(loaded.rounding().position_m, 1.490_116_113_833_650_5e-9);
    assert_eq!(loaded.rounding().force_n, 0.0);
}

// Verifies: SRV-044.
#[test]
fn a_map_from_the_surface_on_is_taken_as_it_is() {
    let loaded =
        LoadedTable::new(&map(&[0.0, 0.5], &[-0.25, 0.5], |d, _| [0.1 * d, 0.02])).unwrap();
    assert_eq!(loaded.table().depths().knots(), [0.0, 0.5]);
    // 0.02f32 − 0.02 exceeds 0.05f32 − 0.05 … in f64: 4.47e-10 against 7.45e-10.
    assert_eq!(loaded.rounding().force_n, (f64::from(0.05f32) - 0.05).abs());
}

// Verifies: SRV-047.
#[test]
fn a_map_is_refused_with_its_place() {
    assert_cases("refused/playback.txt", "maps", |case| {
        let numbers = case.split(';').map(row);
        let [depths, laterals, slopes] = numbers.collect::<Vec<_>>().try_into().unwrap();
        let force = |_, x: f64| [slopes[0] * x, slopes[1] * x];
        let refused = LoadedTable::new(&map(&depths, &laterals, force));
        refused.unwrap_err().to_string()
    });
}

// Verifies: SRV-047.
#[test]
fn a_map_at_the_limits_is_taken() {
    let at_limits = map(&[1e-6, 1.0], &[-1.0, 1.0], |d, x| [100.0 * d * x, 100.0]);
    assert!(LoadedTable::new(&at_limits).is_ok());
}

// Verifies: SRV-050.
#[test]
fn the_stiffness_is_the_largest_singular_value_of_a_linear_force() {
    // F = A (x, d): the singular values of [[3, 0], [4, 5]] are √45 and √5.
    let loaded = LoadedTable::new(&map(&[0.0, 0.5], &[0.0, 0.001], |d, x| {
        [3.0 * x, 4.0 * x + 5.0 * d]
    }));
    let stiffness = stiffness(&loaded.unwrap().table());
    // Forces of some 1e-3 N are rounded to 2⁻²⁴ of that, over 1 mm: 2e-7 N/m, on two entries.
    assert!((stiffness - 45f64.sqrt()).abs() < 5e-7, "{stiffness}");
}

// Verifies: SRV-050.
#[test]
fn the_stiffness_counts_the_cells_continued_at_the_border() {
    // F_n = 16 x d: ∂F_n/∂x = 16 d and ∂F_n/∂d = 16 x; continued to d = 1 and x = 1 and −0.5.
    let loaded = LoadedTable::new(&map(&[0.0, 0.5], &[0.0, 0.5], |d, x| [0.0, 16.0 * x * d]));
    let stiffness = stiffness(&loaded.unwrap().table());
    assert_near(stiffness, 16.0 * 2f64.sqrt(), 1e-13);
}

/// The largest singular value of [[a, b], [c, d]] from the eigenvalues of its square.
fn singular_value([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    let (sum, product) = (a * a + b * b + c * c + d * d, a * d - b * c);
    ((sum + (sum * sum - 4.0 * product * product).max(0.0).sqrt()) / 2.0).sqrt()
}

/// The steepest slope of a table that is played, by differences of forces at the ends of each cell, which the
/// kernel gives exactly there: a cell further on every side but above the surface.
fn steepest(table: &Table) -> f64 {
    let continued = |knots: &[f32], first: bool| {
        let (n, mut all) = (knots.len(), knots.to_vec());
        if first {
            all.insert(0, 2.0 * knots[0] - knots[1]);
        }
        all.push(2.0 * knots[n - 1] - knots[n - 2]);
        all
    };
    let depths = table.depths().knots();
    let depths = continued(depths, depths[0] > 0.0);
    let laterals = continued(table.laterals().knots(), true);
    let mut steepest = 0.0f64;
    for d in depths.windows(2) {
        for x in laterals.windows(2) {
            let difference = |from: (f32, f32), to: (f32, f32), by: f32| {
                let (from, to) = (table.force(from.0, from.1), table.force(to.0, to.1));
                [to.lateral - from.lateral, to.normal - from.normal]
                    .map(|change| f64::from(change) / f64::from(by))
            };
            for depth in [d[0], d[1]] {
                for lateral in [x[0], x[1]] {
                    let by_x = difference((depth, x[0]), (depth, x[1]), x[1] - x[0]);
                    let by_d = difference((d[0], lateral), (d[1], lateral), d[1] - d[0]);
                    let slopes = [[by_x[0], by_d[0]], [by_x[1], by_d[1]]];
                    steepest = steepest.max(singular_value(slopes));
                }
            }
        }
    }
    steepest
}

// Numbers of few bits, so that nothing is rounded in f32: the steepest cell once in each place, in either component.
// Verifies: SRV-050.
#[test]
fn the_stiffness_is_the_steepest_slope_by_differences() {
    let knots = [[0.0f32, 0.25, 0.5, 1.0], [0.25, 0.5, 0.625, 0.75]];
    let laterals = [-0.5f32, -0.25, 0.25, 0.5];
    let reciprocals = |knots: &[f32; 4]| [0, 1, 2].map(|i| 1.0 / (knots[i + 1] - knots[i]));
    for depths in knots {
        for place in 0..16 {
            for [lateral, normal] in [[8.0, 0.5], [-1.0, 4.0]] {
                let mut forces: Vec<Force<f32>> = (0..16u8)
                    .map(|k| Force::new(f32::from(k * 7 % 5) / 8.0, f32::from(k * 3 % 7) / 8.0))
                    .collect();
                forces[place] = Force { lateral, normal };
                let (heights, widths) = (reciprocals(&depths), reciprocals(&laterals));
                let depths = Axis::new(&depths, &heights).unwrap();
                let table = Table::new(depths, Axis::new(&laterals, &widths).unwrap(), &forces);
                let table = table.unwrap();
                let (found, expected) = (stiffness(&table), steepest(&table));
                assert_near(found, expected, 1e-12 * expected);
            }
        }
    }
}

// Verifies: SRV-053.
#[test]
fn the_rotation_is_the_largest_work_over_way_of_any_box() {
    let rotation = |forces: fn(f64, f64) -> [f64; 2]| {
        let map = map(&[0.0, 0.25, 0.5], &[0.0, 0.5], forces);
        rotation(&LoadedTable::new(&map).unwrap().table())
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    // All is linear, and continued to d = 0.75, so that a box is up to 0.5 wide and 0.75 high. F_x = 3 d: 3 w h / 2 (w + h).
    near(rotation(|d, _| [3.0 * d, 0.0]), 3.0 * 0.375 / 2.5);
    near(rotation(|d, _| [-3.0 * d, 0.0]), 3.0 * 0.375 / 2.5);
    // ∂F_n/∂x = 4 d is 1, 2 and 3 at most in the three cells of 1/8: worst are the two below, 0.5 high.
    near(rotation(|d, x| [0.0, 4.0 * d * x]), 5.0 / 8.0 / 2.0);
    // Together −1 + 4 d: 0, 1, 2 at most, and −1 at least.
    near(rotation(|d, x| [-d, 4.0 * d * x]), 3.0 / 8.0 / 2.0);
    // With a potential, d² x, but F_x is linear within a cell in place of square: ∂F_x/∂d is −1/4, −3/4 and once more that, and
    // ∂F_n/∂x = 2 d at most 1/2, 1 and 3/2. Of 1/4, 1/4 and 3/4 the last cell is as bad as the last two, and as all.
    near(rotation(|d, x| [-d * d, 2.0 * d * x]), 0.0625);
    // A force at the surface counts as it is: 2⁻⁷ N, and no more where it stays.
    near(rotation(|_, _| [0.0, 0.0078125]), 0.0078125);
}

// Verifies: SRV-053.
#[test]
fn no_box_is_worse_than_the_rotation() {
    let generator = crate::stats::random::Generator::new(20_261_122, 3);
    for number in 0..20 {
        let normal = |index: u64, of: u64| 0.1 * generator.normal(of, 100 * number + index);
        let forces = Matrix::from_fn(4, 6, |row, column| normal((6 * row + column) as u64, 0));
        let lateral = Matrix::from_fn(4, 6, |row, column| normal((6 * row + column) as u64, 1));
        let depths = vec![1e-3, 2e-3, 4e-3, 5e-3];
        let laterals = vec![-5e-3, -3e-3, 0.0, 1e-3, 2e-3, 5e-3];
        let map = ForceTable::new(depths, laterals, Force::new(lateral, forces)).unwrap();
        let loaded = LoadedTable::new(&map).unwrap();
        let table = loaded.table();
        let depths = [0.0, 1e-3, 2e-3, 4e-3, 5e-3, 6e-3f32];
        let laterals = table.laterals().knots();
        // The largest of ∂F_x/∂d + ∂F_n/∂x at the four corners of a cell, times its area, by the force at each.
        let around = |row: usize, column: usize, sense: f64| {
            let at = |d: usize, x: usize| table.continued(depths[row + d], laterals[column + x]);
            let h = f64::from(depths[row + 1]) - f64::from(depths[row]);
            let w = f64::from(laterals[column + 1]) - f64::from(laterals[column]);
            let difference = |a: f32, b: f32| f64::from(b) - f64::from(a);
            let corner = |d: usize, x: usize| {
                let by_depth = difference(at(0, x).lateral, at(1, x).lateral) * w;
                by_depth + difference(at(d, 0).normal, at(d, 1).normal) * h
            };
            let corners = [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
            corners
                .into_iter()
                .fold(0.0, |most: f64, work| most.max(sense * work))
        };
        let found = rotation(&table);
        let mut worst = 0.0f64;
        for (top, left) in (0..5).flat_map(|top| (0..5).map(move |left| (top, left))) {
            for (bottom, right) in (top..5).flat_map(|b| (left..5).map(move |r| (b, r))) {
                let cells = (top..=bottom).flat_map(|row| (left..=right).map(move |c| (row, c)));
                let work = |sense| -> f64 {
                    let cells = cells.clone();
                    cells.map(|(row, column)| around(row, column, sense)).sum()
                };
                let height = f64::from(depths[bottom + 1] - depths[top]);
                let width = f64::from(laterals[right + 1] - laterals[left]);
                worst = worst.max(work(1.0).max(work(-1.0)) / (2.0 * (width + height)));
            }
        }
        // Heights and widths are summed cell by cell in f64 there, and rounded to f32 here.
        assert!((found / worst - 1.0).abs() < 1e-6, "{found} {worst}");
    }
}

// Verifies: SRV-052.
#[test]
fn the_stiffest_spring_is_that_whose_delay_the_damping_makes_up_for() {
    let device = Damping {
        damping_n_s_per_m: 0.5,
        ..FREE
    };
    // b / (T/2) = 1000; b / (T/2 + 2 T) = 200.
    assert!((device.stiffest().unwrap() - 1000.0).abs() < 1e-10);
    let remote = Damping {
        delay_periods: 2,
        ..device
    };
    assert!((remote.stiffest().unwrap() - 200.0).abs() < 1e-10);
    let spoils: [fn(&mut Damping); 4] = [
        |damping| damping.period_s = 0.0,
        |damping| damping.damping_n_s_per_m = -1.0,
        |damping| damping.friction_n = f64::NAN,
        |damping| damping.resolution_m = f64::INFINITY,
    ];
    for spoil in spoils {
        let mut wrong = device;
        spoil(&mut wrong);
        assert_eq!(wrong.stiffest(), None, "{wrong:?}");
    }
}

// Verifies: SRV-051.
#[test]
fn a_table_too_stiff_is_refused_or_scaled_on_request() {
    let map = map(&[0.0, 0.004], &[-0.01, 0.01], |d, _| [0.0, 400.0 * d]);
    let device = playing_up_to(200.0);
    let refused = LoadedTable::passive(&map, &device, &open_limits()).unwrap_err();
    let text = refused.to_string();
    for part in ["400.0000 N/m", "200.0000", "0.5000"] {
        assert!(text.contains(part), "{text}");
    }

    let (loaded, scale) = scaled(&map, &device).unwrap();
    let table = loaded.table();
    assert!(stiffness(&table) <= 200.0);
    assert!((scale - 0.5).abs() < 1e-5, "{scale}");
    let (lateral, normal) = (0.0, (1.6 * scale) as f32);
    assert_eq!(table.forces()[2], Force { lateral, normal });

    let found = scaled(&map, &FREE).unwrap();
    let unscaled = LoadedTable::passive(&map, &FREE, &open_limits()).unwrap();
    assert_eq!(found, (unscaled, 1.0));
    // 2^-10 N/m above what the device plays, to be met within the rounding of the forces.
    for stiffest in [100.0, 399.999, 333.333] {
        let (loaded, scale) = scaled(&map, &playing_up_to(stiffest)).unwrap();
        let found = stiffness(&loaded.table());
        let near = found > stiffest * (1.0 - 1e-6);
        assert!(found <= stiffest && near, "{found}");
        assert!((scale - stiffest / 400.0).abs() < 1e-6, "{scale}");
    }
    let undamped = Damping {
        friction_n: 0.0,
        ..FREE
    };
    assert!(scaled(&map, &undamped).is_err());
}

// A slope between large forces is rounded by far more than a force: the scale must go down until it fits.
// Verifies: SRV-051.
#[test]
fn scaling_goes_on_until_the_rounded_slopes_fit() {
    let map = map(&[1.0], &[0.0, 2e-6], |_, x| [0.0, 8.0 + 6850.0 * x]);
    let steepest = stiffness(&LoadedTable::new(&map).unwrap().table());
    // Two forces of 8 N, each rounded by 2⁻²¹ N at the most, 2 µm apart, of a slope of 6850 N/m; the
    // scale goes down by twice what is needed at the most.
    let slack = 2.0 * 2.0 * 2f64.powi(-21) / 2e-6 / 6850.0;
    let mut lowered = 0;
    for stiffest in (1..40u8).map(|k| 100.0 * f64::from(k)) {
        let (loaded, scale) = scaled(&map, &playing_up_to(stiffest)).unwrap();
        assert!(stiffness(&loaded.table()) <= stiffest);
        let fit = stiffest / steepest;
        assert!(scale < fit && scale > fit * (1.0 - slack), "{scale}");
        lowered += u32::from(scale < fit * (1.0 - 1.5e-7));
    }
    assert!(lowered > 0, "no table was lowered twice");
}

/// A force table of random size, forces up to `largest` (N), axes of uneven steps of millimetres.
fn any_map() -> impl Strategy<Value = (ForceTable, f64)> {
    let steps = |count| prop::collection::vec(1e-6..8e-3f64, count);
    let axes = (2usize..6, 2usize..8).prop_flat_map(move |(m, n)| (steps(m), steps(n)));
    let scale = prop::sample::select(vec![1e-3, 0.3, 2.0, 100.0]);
    (axes, -0.02..0.0f64, scale).prop_flat_map(|((heights, widths), first, scale)| {
        let knots = |start: f64, steps: &[f64]| -> Vec<f64> {
            let mut at = start;
            let ends = steps.iter().map(|step| {
                at += 2e-6 + step;
                f64::from(at as f32)
            });
            ends.collect()
        };
        let (depths, laterals) = (knots(0.0, &heights), knots(first, &widths));
        let nodes = depths.len() * laterals.len();
        prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), nodes).prop_map(move |values| {
            let matrix = |component: fn(&(f64, f64)) -> f64| {
                let round = |value: &(f64, f64)| f64::from((scale * component(value)) as f32);
                Matrix::new(laterals.len(), values.iter().map(round).collect()).unwrap()
            };
            let forces = Force::new(matrix(|v| v.1), matrix(|v| v.0));
            let map = ForceTable::new(depths.clone(), laterals.clone(), forces);
            (map.unwrap(), scale)
        })
    })
}

/// A position in f32 from `reach` cells before the first knot to `reach` beyond the last, at the
/// fraction `at` of that range.
fn position(knots: &[f32], reach: f32, at: f32) -> f32 {
    let last = knots.len() - 1;
    let start = knots[0] - reach * (knots[1] - knots[0]);
    let end = knots[last] + reach * (knots[last] - knots[last - 1]);
    (start + at * (end - start)).clamp(start, end)
}

/// The largest distance of the kernel's two components from the reference, N; the reference has the
/// row at the surface too.
fn distance(map: &ForceTable, depth_at: f32, lateral_at: f32, reach: f32) -> f64 {
    let loaded = LoadedTable::new(map).unwrap();
    assert_eq!(loaded.rounding(), RoundingError::default());
    let table = loaded.table();
    let depth = position(table.depths().knots(), reach, depth_at).max(0.0);
    let lateral = position(table.laterals().knots(), reach, lateral_at);
    let reference = {
        let knots = table.depths().knots().iter();
        let (laterals, forces) = (map.laterals().to_vec(), table.forces().iter());
        let matrix = |component: fn(&Force<f32>) -> f32| {
            let values = forces.clone().map(|force| f64::from(component(force)));
            Matrix::new(laterals.len(), values.collect()).unwrap()
        };
        let forces = Force::new(matrix(|f| f.lateral), matrix(|f| f.normal));
        ForceTable::new(
            knots.map(|&knot| f64::from(knot)).collect(),
            laterals,
            forces,
        )
        .unwrap()
    };
    let expected = reference
        .force(f64::from(depth), f64::from(lateral))
        .unwrap();
    let found = table.force(depth, lateral);
    let of = |found: f32, expected: f64| (f64::from(found) - expected).abs();
    of(found.lateral, expected.lateral).max(of(found.normal, expected.normal))
}

/// The unit of the bounds: 2⁻²⁴ of the smallest power of two that no entry exceeds.
fn unit(largest: f64) -> f64 {
    largest.log2().ceil().exp2() * 2f64.powi(-24)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    // The bounds are Gappa's (proofs/gappa), put together in spec/servo.md.
    // Verifies: SRV-015.
    #[test]
    fn the_kernel_is_near_the_papers_rule(
        (map, largest) in any_map(),
        depth in 0.0..=1.0f32,
        lateral in 0.0..=1.0f32,
    ) {
        let within = distance(&map, depth, lateral, 0.0);
        prop_assert!(within <= 21.25 * unit(largest), "{within:e} N within");
        // A hundredth short of where the continuation ends, which f32 may miss by some 6e-4 of a cell.
        let beyond = distance(&map, depth, lateral, EXTRAPOLATION_CELLS - 0.01);
        prop_assert!(beyond <= 148.75 * unit(largest), "{beyond:e} N beyond");
    }
}

// Verifies: SRV-044.
#[test]
fn a_loaded_table_is_played() {
    let loaded = LoadedTable::new(&map(&[0.002, 0.004], &[-0.01, 0.01], |d, _| {
        [0.0, 400.0 * d]
    }))
    .unwrap();
    let table = loaded.table();
    assert_eq!(table.force(0.0, 0.0), Force::ZERO);
    // Within 21.25 · 2⁻²⁴ · 2 N (SRV-015) and the rounding of the depth, 2⁻²⁵ · 0.4 N.
    assert!((table.force(0.001, 0.0).normal - 0.4).abs() < 2.6e-6);
}
