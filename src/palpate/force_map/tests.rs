use crate::force::Force;
use proptest::prelude::*;

use super::*;
use crate::phantom::Geometry;
use palpate_asserts::{assert_cases, assert_error, axis, row, seeded};

mod pair;

/// A table of the forces, lateral and normal, that `force` gives for a depth and a lateral position.
pub(crate) fn table_of(
    depths: &[f64],
    laterals: &[f64],
    force: impl Fn(f64, f64) -> [f64; 2],
) -> ForceTable {
    let matrix = |channel: usize| {
        let at = |row: usize, column: usize| force(depths[row], laterals[column])[channel];
        Matrix::from_fn(depths.len(), laterals.len(), at)
    };
    let forces = Force::new(matrix(0), matrix(1));
    ForceTable::new(depths.into(), laterals.into(), forces).unwrap()
}

/// A measured map, of a phantom if it is known.
pub(crate) fn measured(phantom: Option<Phantom>, table: ForceTable) -> ForceMap {
    ForceMap::new(source(), phantom, table).unwrap()
}

fn matrix<const N: usize>(rows: &[[f64; N]]) -> Matrix {
    Matrix::new(N, rows.concat()).unwrap()
}

/// A table over two depths and three lateral positions x ≥ 0.
fn over_poses(normal: Matrix, lateral: Matrix) -> Result<ForceTable, Refusal> {
    let axes = (vec![0.0, 0.001], vec![0.0, 0.002, 0.005]);
    ForceTable::new(axes.0, axes.1, Force::new(lateral, normal))
}

/// Forces that tell their place.
fn table() -> ForceTable {
    let normal = matrix(&[[0.0, 0.1, 0.2], [1.0, 1.1, 1.2]]);
    let lateral = matrix(&[[0.0, 0.01, 0.02], [0.0, -0.11, -0.12]]);
    over_poses(normal, lateral).unwrap()
}

pub(crate) fn certificate(min_det: Matrix, smallest_det: SmallestDet) -> Certificate {
    Certificate {
        worst_relative_residual: 1e-13,
        worst_force_balance: 2e-10,
        largest_penetration: 3e-12,
        newton_iterations: 40,
        mesh_size: 0.0005,
        nodes: 6000,
        elements: 3000,
        element: "t6".into(),
        contact: "deformed-normal".into(),
        law: None,
        arithmetic: "other".into(),
        smallest_det,
        min_det,
        discretization: None,
    }
}

/// A computed map over [`table`], with `change` made to its certificate.
fn computed(change: impl FnOnce(&mut Certificate)) -> Result<ForceMap, Refusal> {
    let min_det = matrix(&[[1.0, 1.0, 1.0], [0.9, 0.8, 0.85]]);
    let (det, depth, lateral) = (0.8, 0.001, 0.002);
    let smallest = SmallestDet {
        det,
        depth,
        lateral,
    };
    let mut certificate = certificate(min_det, smallest);
    change(&mut certificate);
    let source = Source::FiniteElements { certificate };
    ForceMap::new(source, Phantom::builtin("2.6").ok(), table())
}

fn source() -> Source {
    Source::Measured(Measurement::new("gel.csv", ""))
}

fn axes(depths: &[f64], laterals: &[f64]) -> Result<ForceTable, Refusal> {
    let zeros = Matrix::from_fn(depths.len(), laterals.len(), |_, _| 0.0);
    let forces = Force::new(zeros.clone(), zeros);
    ForceTable::new(depths.to_vec(), laterals.to_vec(), forces)
}

fn refusal<T>(result: Result<T, Refusal>) -> String {
    result.err().expect("refused").to_string()
}

// Verifies: MAP-001.
#[test]
fn rows_are_depths_and_columns_lateral_positions() {
    let normal = matrix(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!((normal.row_count(), normal.column_count()), (2, 3));
    assert_eq!(normal.row(1), [4.0, 5.0, 6.0]);
    let rows = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    assert_eq!(normal.rows().collect::<Vec<_>>(), rows);
    assert!(normal.entries().any(|entry| entry == (1, 0, 4.0)));
    let place = |row, column| (row * 3 + column + 1) as f64;
    assert_eq!(Matrix::from_fn(2, 3, place), normal);
    assert_eq!(Matrix::new(2, vec![0.0; 3]), None);
    assert_eq!(Matrix::new(0, vec![0.0; 3]), None);
}

// Verifies: MAP-002, MAP-026.
#[test]
fn bad_axes_are_refused() {
    assert_cases("refused/force_table.txt", "axes", |case| {
        let (depths, laterals) = case.split_once(';').unwrap();
        refusal(axes(&row(depths), &row(laterals)))
    });
    assert!(axes(&[0.0, 0.0], &[0.0]).is_err());
    assert!(axes(&[0.0], &[1.0, 1.0 + 0.9e-9]).is_err());
    assert!(axes(&[0.0], &[1.0, 1.0 + 1.1e-9]).is_ok());
    assert!(axes(&[0.0], &[-f64::MAX, f64::MAX]).is_ok());
}

// Verifies: MAP-002, MAP-026, CON-007.
#[test]
fn bad_matrices_are_refused() {
    let good = Matrix::from_fn(2, 3, |_, _| 0.0);
    let transposed = Matrix::from_fn(3, 2, |_, _| 0.0);
    assert_error(
        over_poses(good.clone(), transposed.clone()),
        "lateral_force_n has 3 rows and 2 columns; \
         give 2 rows (one a depth) and 3 columns (one a lateral position)",
    );
    assert_error(
        over_poses(transposed, good.clone()),
        "normal_force_n has 3 rows[..]",
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let spoilt = matrix(&[[0.0; 3], [0.0, 0.0, bad]]);
        let expected = format!("force_n[1][2] = {bad}, but must be a finite number");
        let message = refusal(over_poses(spoilt.clone(), good.clone()));
        assert_eq!(message, format!("normal_{expected}"));
        let message = refusal(over_poses(good.clone(), spoilt));
        assert_eq!(message, format!("lateral_{expected}"));
    }
}

// Verifies: MAP-006, MAP-026.
#[test]
fn a_certificate_is_checked_number_by_number() {
    assert_eq!(computed(|_| ()).map(|_| ()), Ok(()));
    for bad in [f64::NAN, f64::INFINITY, -1e-30] {
        let refuses = |key: &str, spoil: &dyn Fn(&mut Certificate)| {
            let expected = "but must be a finite number, at least 0";
            let message = refusal(computed(spoil));
            assert_eq!(message, format!("certificate.{key} = {bad}, {expected}"));
        };
        refuses("worst_relative_residual", &|c| {
            c.worst_relative_residual = bad
        });
        refuses("worst_force_balance_n", &|c| c.worst_force_balance = bad);
        refuses("largest_penetration_m", &|c| c.largest_penetration = bad);
        refuses("mesh_size_m", &|c| c.mesh_size = bad);
    }
    assert_error(
        computed(|c| c.min_det = matrix(&[[1.0, 1.0], [0.9, 0.8]])),
        "certificate.min_det has 2 rows and 2 columns; \
         give 2 rows (one a depth) and 3 columns (one a lateral position)",
    );
    let spoilt = matrix(&[[1.0, 1.0, 1.0], [f64::NAN, 0.8, 0.85]]);
    assert_error(
        computed(|c| c.min_det = spoilt),
        "certificate.min_det[1][0] = NaN, but must be a finite number",
    );
}

// Verifies: MAP-006.
#[test]
fn the_smallest_determinant_is_the_matrixs_own() {
    assert_error(
        computed(|c| c.smallest_det.det = 0.9),
        "certificate.smallest_det = 0.9 at depth 0.001 m, lateral 0.002 m, \
         but must be the smallest entry of min_det, 0.8, and its pose",
    );
    assert!(computed(|c| c.smallest_det.lateral = 0.005).is_err());
    assert!(computed(|c| c.smallest_det.depth = 0.0).is_err());
    assert!(computed(|c| c.smallest_det.depth = f64::NAN).is_err());
    let of = |rows: &[[f64; 3]]| SmallestDet::of(&matrix(rows), &[0.0, 0.001], &[-0.1, 0.0, 0.1]);
    let of = |rows: &[[f64; 3]]| of(rows).map(|least| [least.det, least.depth, least.lateral]);
    let one = [[3.0, 2.0, 1.0], [2.0, -1.0, 3.0]];
    assert_eq!(of(&one), Some([-1.0, 0.001, 0.0]));
    // Of equals, the one nearest to x = 0, then the first.
    assert_eq!(of(&[[1.0; 3], [1.0; 3]]), Some([1.0, 0.0, 0.0]));
    assert_eq!(of(&[[1.0, 2.0, 1.0], [2.0; 3]]), Some([1.0, 0.0, -0.1]));
    assert_eq!(of(&[[1.0, f64::NAN, 1.0], [2.0; 3]]), None);
}

// Verifies: MAP-002.
#[test]
fn a_map_fits_its_phantom() {
    let certificate = computed(|_| ()).unwrap().certificate().unwrap().clone();
    let finite_elements = Source::FiniteElements { certificate };
    assert_error(
        ForceMap::new(finite_elements, None, table()),
        "phantom is missing; give the phantom that the finite elements computed",
    );
    assert!(ForceMap::new(source(), None, table()).is_ok());
    let phantom = Phantom::builtin("none").unwrap();
    assert!(ForceMap::new(source(), Some(phantom.clone()), table()).is_ok());
    let too_wide = axes(&[0.0, 0.004], &[0.0, 0.0111]).unwrap();
    assert_error(
        ForceMap::new(source(), Some(phantom), too_wide),
        "phantom: lateral_mm = 11.1, but must be [..]",
    );
    let sphere = Phantom::builtin("6.6").unwrap().changed(|parts| {
        parts.geometry = Geometry::Axisymmetric;
        parts.probe.length = 2.0 * parts.probe.radius;
    });
    let text = measured(Some(sphere.unwrap()), axes(&[0.004], &[0.0]).unwrap()).to_json();
    let oblique = "\"fibre_modulus_pa\": 5.0, \"fibre_angle_deg\": 30.0, \"youngs_modulus_pa\"";
    let text = text.replacen("\"youngs_modulus_pa\"", oblique, 1);
    assert_error(
        ForceMap::from_json(&text, "map.json"),
        "map.json: phantom: geometry = \"axisymmetric\", but must be \"plane\" where [..]",
    );
}

// Verifies: MAP-009.
#[test]
fn symmetry_extends_a_map_to_negative_positions() {
    let map = computed(|_| ()).unwrap().mirrored().unwrap();
    assert_eq!(map.table().depths(), [0.0, 0.001]);
    assert_eq!(map.table().laterals(), [-0.005, -0.002, 0.0, 0.002, 0.005]);
    let certificate = map.certificate().unwrap();
    assert_eq!(certificate.min_det.row(1), [0.85, 0.8, 0.9, 0.8, 0.85]);
    assert_eq!(certificate.smallest_det.lateral, 0.002);
    assert_eq!(map.phantom().unwrap().name(), "2.6");
}

// Verifies: MAP-092.
#[test]
fn a_whole_map_stays_and_a_half_one_is_extended() {
    let half = computed(|_| ()).unwrap();
    let whole = half.whole().unwrap();
    assert_eq!(whole, half.mirrored().unwrap());
    assert_eq!(whole.whole(), Ok(whole));
}

// Verifies: MAP-009.
#[test]
fn the_lateral_force_on_the_axis_becomes_zero_or_an_error() {
    let with = |force: f64| {
        let normal = matrix(&[[0.0, 0.0], [1.0, 1.0]]);
        let lateral = matrix(&[[0.0, 0.0], [force, 0.2]]);
        let forces = Force::new(lateral, normal);
        ForceTable::new(vec![0.0, 0.001], vec![0.0, 0.002], forces).unwrap()
    };
    for force in [1e-9, -1e-9, -0.0] {
        let mirrored = with(force).mirrored().unwrap();
        assert_eq!(mirrored.lateral().unwrap().row(1), [-0.2, 0.0, 0.2]);
        // A force of +0 stays +0 on both sides: −0 would show in a diff.
        let forces = mirrored.lateral().unwrap().values().iter();
        let zeros: Vec<_> = forces.filter(|&&force| force == 0.0).collect();
        assert!(zeros.len() == 4 && zeros.iter().all(|zero| zero.is_sign_positive()));
    }
    assert_error(
        with(-1.1e-9).mirrored(),
        "lateral force -0.0000000011 N at depth 0.001 m, x = 0; \
         give at most 1e-9 N, or negative positions too",
    );
}

// Verifies: MAP-009.
#[test]
fn only_a_map_from_zero_on_is_extended() {
    assert_error(
        axes(&[0.0], &[0.001, 0.002]).unwrap().mirrored(),
        "laterals_m[0] = 0.001, but must be 0 in a map to be extended by symmetry",
    );
    assert!(table().mirrored().unwrap().mirrored().is_err());
    let alone = axes(&[0.0], &[-0.0]).unwrap().mirrored().unwrap();
    assert_eq!(alone.laterals(), [0.0]);
}

// Verifies: MAP-002, MAP-022.
#[test]
fn minus_zero_is_no_position_of_its_own() {
    let table = axes(&[-0.0], &[-0.0, 0.001]).unwrap();
    assert!(table.depths()[0].is_sign_positive() && table.laterals()[0].is_sign_positive());
}

// Verifies: MAP-011.
#[test]
fn a_signal_is_the_map_minus_its_reference() {
    let map = computed(|_| ()).unwrap();
    let reference = matrix(&[[0.0; 3], [0.75, 0.5, 0.25]]);
    let still = Matrix::from_fn(2, 3, |_, _| 0.0);
    // The same positions but for the last bits, as a sum of steps gives them.
    let laterals = vec![0.0, 0.002 + 1e-17, 0.005 - 0.9e-9];
    let table = ForceTable::new(vec![0.0, 0.001], laterals, Force::new(still, reference)).unwrap();
    let reference = measured(None, table);
    let signal = map.signal(&reference).unwrap();
    assert_eq!(signal.laterals(), map.table().laterals());
    assert_eq!(signal.normal().row(0), [0.0, 0.1, 0.2]);
    let expected = [1.0 - 0.75, 1.1 - 0.5, 1.2 - 0.25];
    assert_eq!(signal.normal().row(1), expected);
    assert_eq!(signal.lateral().unwrap(), map.table().lateral().unwrap());
}

// Verifies: MAP-083, MAP-084.
#[test]
fn a_lateral_force_that_was_not_measured_is_absent_from_all_that_follows() {
    let whole = table();
    let one = whole.of_normal();
    assert_ne!(one, whole);
    for (one, whole) in [
        (one.minus(&one), whole.minus(&whole)),
        (one.minus(&whole), whole.minus(&whole)),
        (whole.minus(&one), whole.minus(&whole)),
        (one.mirrored(), whole.mirrored()),
        (one.at_columns(&[0, 2]), whole.at_columns(&[0, 2])),
        (
            Ok(one.mirror_image(&[2, 1, 0])),
            Ok(whole.mirror_image(&[2, 1, 0])),
        ),
    ] {
        let (one, whole) = (one.unwrap(), whole.unwrap());
        assert_eq!(
            (one.normal(), one.laterals()),
            (whole.normal(), whole.laterals())
        );
        assert_eq!((one.lateral(), whole.lateral().is_some()), (None, true));
    }
    let sweep = one.sweep(0.0005, &[0.001]).unwrap();
    assert_eq!((sweep.lateral.len(), sweep.normal.len()), (0, 1));
    let map = measured(None, one.clone());
    assert!(!map.to_json().contains("lateral_force_n"));
    assert_eq!(ForceMap::from_json(&map.to_json(), "map.json"), Ok(map));
    assert_eq!(
        ForceTable::from_csv(&one.to_csv(), "gel.csv"),
        Ok(one.clone())
    );
    assert_eq!(one.to_csv().lines().nth(6), Some("1.0,5.0,1.2"));
    // What needs both.
    let missing =
        "the map has no lateral forces, which are needed here; give a map with both forces";
    assert_error(one.both(), missing);
    assert_error(one.row(0.0), missing);
    assert_error(one.force(0.0, 0.0), missing);
    assert_error(crate::servo::LoadedTable::new(&one), missing);
    let Source::FiniteElements { certificate } = computed(|_| ()).unwrap().source else {
        panic!("not computed");
    };
    let source = Source::FiniteElements { certificate };
    assert_error(
        ForceMap::new(source, Phantom::builtin("2.6").ok(), one),
        "lateral_force_n is missing; give both forces of a computed map",
    );
}

// Verifies: MAP-002, MAP-026, MAP-011.
#[test]
fn a_signal_needs_equal_axes() {
    let shifted = axes(&[0.0, 0.001], &[0.0, 0.002, 0.005 + 1.1e-9]).unwrap();
    assert_error(
        table().minus(&shifted),
        "laterals_m[2] is 0.005 m in one map and 0.0050000011 m in the other; give maps with equal axes",
    );
    let shorter = axes(&[0.0], &[0.0, 0.002, 0.005]).unwrap();
    assert_error(
        table().minus(&shorter),
        "depths_m[1] is 0.001 m in one map and not there in the other; give maps with equal axes",
    );
    assert!(shorter.minus(&table()).is_err());
    let huge = |sign: f64| {
        let forces = Matrix::from_fn(1, 1, |_, _| sign * f64::MAX);
        ForceTable::new(vec![0.0], vec![0.0], Force::new(forces.clone(), forces)).unwrap()
    };
    assert_error(
        huge(1.0).minus(&huge(-1.0)),
        "normal_force_n[0][0] = inf, but must be a finite number",
    );
}

// Verifies: MAP-033.
#[test]
fn minus_0_is_the_position_0() {
    let text = "depth_mm,lateral_mm,normal_force_n\n-0,-0,1\n0,1,2\n1,-0.0,3\n1,1,4\n";
    let table = ForceTable::from_csv(text, "t.csv").unwrap();
    let signs = [table.depths(), table.laterals()].map(|axis| axis[0].is_sign_positive());
    assert_eq!(signs, [true, true]);
    assert_eq!(table.normal().values(), [1.0, 2.0, 3.0, 4.0]);
    // The second row of a pose is the later one, whatever the sign of its zeros.
    for (first, second) in [("0,0", "0,-0"), ("0,-0", "0,0"), ("0,0", "-0,0")] {
        let text = format!("depth_mm,lateral_mm,normal_force_n\n{first},1\n{second},2\n");
        assert_error(
            ForceTable::from_csv(&text, "t.csv"),
            "t.csv:3: a second row for depth 0.0 mm, lateral 0.0 mm; keep one; the first is line 2",
        );
    }
}

// Verifies: MAP-012.
#[test]
fn forces_at_a_stored_depth() {
    let table = table();
    let row = table.row(0.001 + 0.9e-9).unwrap();
    assert_eq!(table.laterals(), [0.0, 0.002, 0.005]);
    assert_eq!(row.normal, [1.0, 1.1, 1.2]);
    assert_eq!(row.lateral, [0.0, -0.11, -0.12]);
    assert_error(
        table.row(0.0005),
        "depth 0.5 mm is not in the map; give one of 0.0, 1.0 mm",
    );
    assert!(table.row(0.001 + 1.1e-9).is_err() && table.row(f64::NAN).is_err());
}

// Verifies: MAP-060, MAP-070.
#[test]
fn a_table_may_be_longer_than_16_bits_count() {
    let count = (1 << 16) + 9;
    let laterals: Vec<f64> = (0..count).map(|at| 1e-6 * at as f64).collect();
    let of = |row: usize, column: usize| (row * count + column) as f64;
    let forces = Force::new(
        Matrix::from_fn(2, count, of),
        Matrix::from_fn(2, count, |_, at| -of(0, at)),
    );
    let table = ForceTable::new(vec![0.0, 1e-3], laterals.clone(), forces).unwrap();
    for at in [0, 65_534, 65_535, 65_536, count - 1] {
        let expected = Force::new(of(1, at), -of(0, at));
        assert_eq!(table.force(1e-3, laterals[at]).unwrap(), expected);
        let swept = table.sweep(1e-3, &[laterals[at]]).unwrap();
        assert_eq!(swept.map(|of| of[0]), expected);
        // A straight line is what smoothing leaves.
        let smoothed = table.smoothed(3e-6).unwrap().table;
        let line = smoothed.normal().row(0)[at];
        assert!((line - expected.normal).abs() < 1e-9, "{at}: {line}");
    }
}

/// A table over two depths and these positions of the forces, lateral and normal, at each of 18 poses.
fn of_poses(laterals: &[f64], forces: &[[f64; 2]]) -> ForceTable {
    let matrix =
        |which: usize| Matrix::from_fn(2, 9, |row, column| forces[9 * row + column][which]);
    ForceTable::new(
        vec![1e-3, 3e-3],
        laterals.into(),
        Force::new(matrix(0), matrix(1)),
    )
    .unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..seeded(20_261_125) })]

    // Verifies: MAP-060, MAP-070, MAP-073.
    #[test]
    fn forces_between_poses_and_smoothed_ones_add_up_move_and_have_mirror_images(
        steps in prop::collection::vec(0.5e-3..1e-3, 9),
        one in prop::collection::vec(prop::array::uniform2(-2.0..2.0), 18),
        other in prop::collection::vec(prop::array::uniform2(-2.0..2.0), 18),
        (depth, at, shift) in (0.0..5e-3, 0.0..1.0, -2e-3..2e-3),
    ) {
        let laterals = axis(-3e-3, &steps);
        let lateral = laterals[0] - 1e-4 + at * 6e-3;
        let table = of_poses(&laterals, &one);
        let second = of_poses(&laterals, &other);
        let pairs = std::iter::zip(&one, &other);
        let sum: Vec<_> = pairs.map(|(a, b)| [a[0] + b[0], a[1] + b[1]]).collect();
        let sum = of_poses(&laterals, &sum);
        let moved: Vec<f64> = laterals.iter().map(|x| x + shift).collect();
        let moved = of_poses(&moved, &one);
        let columns: Vec<usize> = (0..9).rev().collect();
        let image = table.mirror_image(&columns);
        // Of a pose: cells are continued by less than four of their widths, where numbers below 2 are some 30 at most.
        let force = |table: &ForceTable, x| table.force(depth, x).unwrap().into_array();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-11;
        let (found, added) = (force(&table, lateral), force(&second, lateral));
        let (whole, away) = (force(&sum, lateral), force(&moved, lateral + shift));
        let [along, up] = force(&image, -lateral);
        for channel in 0..2 {
            prop_assert!(near(found[channel] + added[channel], whole[channel]));
            prop_assert!(near(found[channel], away[channel]));
            prop_assert!(near(found[channel], [-along, up][channel]));
        }
        // Of a window of four positions at least.
        let smoothed = |table: &ForceTable| table.smoothed(2.1e-3).unwrap();
        let [found, added, whole, away, image] = [&table, &second, &sum, &moved, &image].map(smoothed);
        let value = |of: &Smoothed, row: usize, column: usize| {
            of.table.both().unwrap().map(|of| of.row(row)[column]).into_array()
        };
        for (row, column) in (0..18).map(|at| (at / 9, at % 9)) {
            let [lateral, normal] = value(&found, row, column);
            let [along, up] = value(&added, row, column);
            let [x, y] = value(&away, row, column);
            prop_assert!(near(lateral, x) && near(normal, y));
            let [x, y] = value(&whole, row, column);
            prop_assert!(near(lateral + along, x) && near(normal + up, y));
            let [x, y] = value(&image, row, 8 - column);
            prop_assert!(near(lateral, -x) && near(normal, y));
        }
        for (a, b) in std::iter::zip(found.noise_sd.into_array(), image.noise_sd.into_array()) {
            prop_assert!(near(a.unwrap(), b.unwrap()));
        }
    }
}

proptest! {
    #![proptest_config(seeded(3))]

    // Verifies: MAP-009.
    #[test]
    fn mirrored_maps_are_symmetric_to_the_bit(
        steps in prop::collection::vec(1e-4..1e-3, 0..6),
        forces in prop::collection::vec(prop::array::uniform2(-2.0..2.0), 14),
    ) {
        let laterals = [vec![0.0], axis(0.0, &steps)].concat();
        let last = laterals.len() - 1;
        let force = |which: usize| {
            let forces = &forces;
            move |row: usize, column: usize| match (which, column) {
                (1, 0) => 0.0,
                _ => forces[row * 7 + column][which],
            }
        };
        let normal = Matrix::from_fn(2, last + 1, force(0));
        let lateral = Matrix::from_fn(2, last + 1, force(1));
        let half = ForceTable::new(vec![0.0, 0.001], laterals, Force::new(lateral, normal)).unwrap();
        let whole = half.mirrored().unwrap();
        for row in 0..2 {
            for column in 0..=last {
                let (left, right) = (last - column, last + column);
                let of = |matrix: &Matrix, column: usize| matrix.row(row)[column];
                prop_assert_eq!(whole.laterals()[left], -half.laterals()[column]);
                prop_assert_eq!(whole.laterals()[right], half.laterals()[column]);
                let normal = of(half.normal(), column).to_bits();
                prop_assert_eq!(of(whole.normal(), left).to_bits(), normal);
                prop_assert_eq!(of(whole.normal(), right).to_bits(), normal);
                let lateral = of(half.lateral().unwrap(), column);
                prop_assert_eq!(of(whole.lateral().unwrap(), left), -lateral);
                prop_assert_eq!(of(whole.lateral().unwrap(), right).to_bits(), lateral.to_bits());
            }
        }
    }
}

// Verifies: MAP-012.
#[test]
fn a_map_cut_to_some_positions_keeps_their_columns() {
    let map = computed(|_| ()).unwrap();
    let cut = map.at_laterals(&[0.0, 0.005]).unwrap();
    assert_eq!(cut.table().laterals(), [0.0, 0.005]);
    assert_eq!(cut.table().depths(), map.table().depths());
    for row in 0..2 {
        for (kept, column) in [(0, 0), (1, 2)] {
            let bits = |matrix: &Matrix, column: usize| matrix.row(row)[column].to_bits();
            let [ours, whole] = [&cut, &map].map(|map| map.table().both().unwrap());
            let pairs = ours.zip(whole);
            for (ours, whole) in pairs.into_array() {
                assert_eq!(bits(ours, kept), bits(whole, column));
            }
        }
    }
    let certificate = cut.certificate().unwrap();
    assert_eq!(certificate.min_det.row(1), [0.9, 0.85]);
    // The column of the smallest is gone: it is that of the rest.
    assert_eq!(certificate.smallest_det.det, 0.85);
    assert_error(
        map.at_laterals(&[0.0, 0.003]),
        "[..] 3.0 mm is not in the map[..]",
    );
    // From left to right, each once.
    for wrong in [[0.005, 0.0], [0.005, 0.005]] {
        assert_error(
            map.at_laterals(&wrong),
            "laterals_m[1] = [..] above the entry before it[..]",
        );
    }
}
