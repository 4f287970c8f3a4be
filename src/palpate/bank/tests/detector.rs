//! Interpolation, and the likelihood ratio of each point.

use super::super::axis::{BankAxis, BankCell, PRIOR, SIGNAL, signal_at};
use super::*;
use crate::detect::DetectError;
use crate::detect::nuisance::{Nuisances, SubspaceDetector};
use palpate_asserts::assert_near;

fn uneven() -> [BankAxis; 4] {
    let axis = |points: &[f64], nodes| BankAxis {
        points: points.to_vec(),
        nodes,
    };
    [
        axis(&[-3.0, -1.0, 0.0, 0.5, 2.0, 4.0], 5),
        axis(&[1.0, 2.0, 4.0], 3),
        axis(&[7.0], 1),
        axis(&[2.0, 3.0], 2),
    ]
}

/// Cubic along the first axis, quadratic along the second, linear along the last, as the points of each allow.
fn polynomial([x, y, _, z]: [f64; 4]) -> f64 {
    (1.0 - 2.0 * x + 0.5 * x * x * x) * (3.0 + y - 0.25 * y * y) * (1.0 + z) + x * y
}

fn values(axes: &[BankAxis; 4]) -> Vec<f64> {
    let mut values = Vec::new();
    for w in &axes[3].points {
        for z in &axes[2].points {
            for y in &axes[1].points {
                values.extend(axes[0].points.iter().map(|x| polynomial([*x, *y, *z, *w])));
            }
        }
    }
    values
}

// Verifies: BNK-030.
#[test]
fn polynomials_of_the_degree_of_the_points_are_exact_between_them() {
    let axes = uneven();
    let values = values(&axes);
    // 24 products of values up to 400, with weights up to 2.
    let tolerance = 24.0 * 2.0 * 400.0 * 8.0 * f64::EPSILON;
    for x in [-3.0, -2.5, -0.3, 0.2, 0.5, 3.9, 4.0] {
        for (y, z) in [(1.0, 2.0), (1.7, 2.25), (3.9, 3.0)] {
            let at = [x, y, 7.0, z];
            let points = axes.each_ref().map(|axis| axis.points.clone());
            let found = signal_at(&points, at, 1, |map, _| values[map]);
            assert_near(found[0], polynomial(at), tolerance);
        }
    }
    let (mut nodes, mut spare) = (Vec::new(), Vec::new());
    for (x, y) in [(0, 0), (2, 1), (4, 1)] {
        let cell = BankCell::new(&axes, [x, y, 0, 0], SIGNAL);
        cell.interpolate(|map| values[map], &mut nodes, &mut spare);
        assert_eq!(nodes.len(), 5 * 3 * 2);
        for (number, found) in nodes.iter().enumerate() {
            let node = [number % 5, number / 5 % 3, 0, number / 15];
            let cell = [x, y, 0, 0];
            let at = [0, 1, 2, 3].map(|axis: usize| axes[axis].node(cell[axis], node[axis]));
            assert_near(*found, polynomial(at), tolerance);
        }
        let corners: Vec<f64> = cell.corners(&axes).iter().map(|map| values[*map]).collect();
        let [low, high] = [0, 1].map(|end| axes[0].points[x + end]);
        let [near, far] = [0, 1].map(|end| axes[1].points[y + end]);
        let expected = [(low, near), (high, near), (low, far), (high, far)];
        let expected = expected.map(|(x, y)| polynomial([x, y, 7.0, 2.0]));
        assert_eq!(corners[..4], expected);
    }
    // A prior is linear between two points: in the cell from (−1, 1) to (0, 2).
    let cell = BankCell::new(&axes, [1, 0, 0, 0], PRIOR);
    let second = |map| if map == 1 { 1.0 } else { 0.0 };
    cell.interpolate(second, &mut nodes, &mut spare);
    assert_near(nodes[0], 0.9 * (5.0 / 6.0) * 0.75, 1e-15);
}

// Verifies: BNK-031, BNK-034.
#[test]
fn each_point_is_tested_as_alone() {
    let [positions, depths, ..] = axes();
    for (level, trial) in [(NoiseLevel::Known, 0), (NoiseLevel::Unknown, 1)] {
        let bank = detector(4.0, true, level);
        let record = noisy(2026, trial, &signal(1.3, 2.2));
        let found = bank.statistic(&mut record.clone()).unwrap();
        let mut whole = 0.0;
        for (point, theta) in found.theta.iter().enumerate() {
            let (x, d) = (positions[point % 13], depths[point / 13]);
            let mut template = times(4.0, &signal(x, d));
            let mut offset = [1.0; SAMPLES];
            let nuisances = Nuisances::new(&mut offset, SAMPLES).unwrap();
            let alone = SubspaceDetector::new(nuisances, &mut template).unwrap();
            let test = alone.statistic(&mut record.clone()).unwrap();
            let test = test.test(level, 0.0).unwrap();
            // The same sums, in another order; θ is below 100.
            assert_near(*theta, test.theta(), 1e-11);
            let of_bank = bank.test(&found, point).unwrap().unwrap();
            assert_near(of_bank.t, test.t, 1e-11);
            assert_near(of_bank.gamma, test.gamma, 1e-11);
            assert_eq!(of_bank.degrees, test.degrees);
            whole += theta.exp() / 65.0;
        }
        let best = bank.likeliest(&found);
        assert!(found.theta.iter().all(|theta| *theta <= found.theta[best]));
        assert!((bank.mixture(&found).unwrap() - whole.ln()).abs() < 1e-12);
        // An offset says nothing.
        let mut moved: Vec<f64> = record.iter().map(|r| r + 1e3).collect();
        let moved = bank.statistic(&mut moved).unwrap();
        assert!((moved.theta[best] - found.theta[best]).abs() < 1e-9);
    }
}

// Verifies: BNK-031, BNK-033.
#[test]
fn what_no_detector_can_be_made_of_is_refused() {
    let axes = [vec![0.0, 1.0], vec![0.0], vec![0.0], vec![0.0]];
    let new = |templates: &[f64], prior: &[f64], nuisances: &[f64]| {
        let (templates, nuisances) = (templates.to_vec(), nuisances.to_vec());
        BankDetector::new(&axes, templates, prior, nuisances, &[], NoiseLevel::Known)
    };
    let templates = [1.0, 1.0, 1.0, 0.0, 0.0, 2.0];
    // The offset explains the first template: the second alone counts, and its own part of it alone.
    let found = new(&templates, &[0.5, 0.5], &[1.0; 3]).unwrap();
    assert_eq!(found.points().collect::<Vec<_>>(), [1]);
    let statistic = found.statistic(&mut [0.0, 0.0, 3.0]).unwrap();
    assert_eq!(statistic.theta[0], 0.0);
    assert_eq!(found.likeliest(&statistic), 1);
    assert!(found.test(&statistic, 0).is_none());
    let explained = new(&templates, &[1.0, 0.0], &[1.0; 3]);
    assert_eq!(explained.unwrap_err(), DetectError::NoSignal);
    for (templates, prior, nuisances) in [
        (&templates[..5], &[0.5, 0.5][..], &[][..]),
        (&templates, &[0.5, 0.6], &[]),
        (&templates, &[1.0], &[]),
        (&templates, &[1.5, -0.5], &[]),
        (&templates, &[0.5, 0.5], &[1.0; 4]),
        (&[f64::NAN; 6], &[0.5, 0.5], &[]),
        (&templates, &[0.5, 0.5], &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
    ] {
        let found = new(templates, prior, nuisances);
        assert!(found.is_err(), "{templates:?} {prior:?}");
    }
    assert!(found.statistic(&mut [0.0; 2]).is_err());
    assert!(found.statistic(&mut [0.0, f64::NAN, 0.0]).is_err());
}

// Verifies: BNK-031.
#[test]
fn a_bank_may_have_more_points_than_16_bits_count() {
    let count = (1 << 16) + 1;
    let positions: Vec<f64> = (0..count).map(|at| 1e-6 * at as f64).collect();
    let mut templates = [1.0, 0.0, 0.0].repeat(count);
    // The last of all, and the one that a number of 16 bits would take it for.
    templates[3 * (count - 1)..].copy_from_slice(&[0.0, 3.0, 0.0]);
    templates[..3].copy_from_slice(&[0.0, 0.0, 2.0]);
    let detector = at_positions(&positions, templates, &vec![1.0 / count as f64; count]);
    let statistic = detector.statistic(&mut [0.0, 3.0, 0.0]).unwrap();
    assert_eq!(statistic.theta.len(), count);
    let likeliest = detector.likeliest(&statistic);
    assert_eq!(likeliest, count - 1);
    // γ²/2 of it.
    assert_eq!(
        (statistic.theta[likeliest], statistic.theta[0]),
        (4.5, -2.0)
    );
}
