//! The detector of a whole record is the reference: it orthogonalises columns, and shares no code with the rotations.
use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::detect::nuisance::{Nuisances, dot};
use crate::stats::random::Generator;
use palpate_asserts::assert_near;

/// A record of rows: columns of nuisances, the residual, columns of signals.
#[derive(Debug, Clone)]
struct Rows {
    nuisances: Vec<Vec<f64>>,
    residual: Vec<f64>,
    signals: Vec<Vec<f64>>,
}

impl Rows {
    fn detector(&self) -> Sequential<Vec<f64>> {
        let (hypotheses, nuisances) = (self.signals.len(), self.nuisances.len());
        let memory = vec![f64::NAN; memory(hypotheses, nuisances)];
        Sequential::new(memory, hypotheses, nuisances).unwrap()
    }

    fn push(&self, row: usize, into: &mut Sequential<Vec<f64>>) {
        let of =
            |columns: &[Vec<f64>]| columns.iter().map(|column| column[row]).collect::<Vec<_>>();
        let pushed = into.push(self.residual[row], &of(&self.nuisances), &of(&self.signals));
        pushed.unwrap();
    }

    fn pushed(&self, order: impl IntoIterator<Item = usize>) -> Sequential<Vec<f64>> {
        let mut found = self.detector();
        order.into_iter().for_each(|row| self.push(row, &mut found));
        found
    }

    /// θ and γ² of each signal, |Pz|² and the rank over the first rows by projection, and 3e of SEQ-001.
    fn batch(&self, rows: usize) -> (Vec<(f64, f64)>, f64, usize, f64) {
        let mut basis: Vec<f64> = self
            .nuisances
            .iter()
            .flat_map(|of| &of[..rows])
            .copied()
            .collect();
        let space = Nuisances::new(&mut basis, rows).unwrap();
        let mut z = self.residual[..rows].to_vec();
        space.project(&mut z).unwrap();
        let of = |signal: &Vec<f64>| {
            let mut signal = signal[..rows].to_vec();
            match space.project(&mut signal).unwrap() {
                0.0 => (0.0, 0.0),
                _ => (
                    dot(&signal, &z) - 0.5 * dot(&signal, &signal),
                    dot(&signal, &signal),
                ),
            }
        };
        let e = 2.0 * (self.nuisances.len() + 1) as f64 * (rows + 4) as f64;
        let e = e * (1.0 + self.inverse(rows)) * 0.5 * f64::EPSILON;
        (
            self.signals.iter().map(of).collect(),
            dot(&z, &z),
            space.rank().get(),
            3.0 * e,
        )
    }

    /// ‖A⁺‖ of the nuisances that count, each over its length: a row of A⁺ has the length of one over the distance of its column
    /// from the space of the others.
    fn inverse(&self, rows: usize) -> f64 {
        let mut kept: Vec<&[f64]> = Vec::new();
        for column in &self.nuisances {
            let mut basis = kept.concat();
            let mut left = column[..rows].to_vec();
            if Nuisances::new(&mut basis, rows)
                .unwrap()
                .project(&mut left)
                .unwrap()
                > 0.0
            {
                kept.push(&column[..rows]);
            }
        }
        let of = |number: usize| {
            let mut others = kept.clone();
            let mut column = others.remove(number).to_vec();
            let length = dot(&column, &column).sqrt();
            let mut others = others.concat();
            (length
                / Nuisances::new(&mut others, rows)
                    .unwrap()
                    .project(&mut column)
                    .unwrap())
            .powi(2)
        };
        (0..kept.len()).map(of).sum::<f64>().sqrt()
    }

    /// Compares the answer after the first rows with that of the batch.
    fn check(&self, found: &Sequential<Vec<f64>>, rows: usize) {
        let (expected, squares, rank, tolerance) = self.batch(rows);
        let length = |column: &[f64]| dot(&column[..rows], &column[..rows]).sqrt();
        let z = length(&self.residual);
        assert_eq!(
            (found.rows(), found.rank()),
            (rows, rank),
            "after {rows} rows"
        );
        assert_near(found.residual(), squares, tolerance * z * z);
        assert_eq!(found.evidence().count(), self.signals.len());
        for (number, (found, (theta, energy))) in found.evidence().zip(expected).enumerate() {
            let signal = length(&self.signals[number]);
            assert_near(found.theta(), theta, tolerance * signal * (z + signal));
            assert_near(found.gamma_squared, energy, tolerance * signal * signal);
        }
    }
}

/// Sweeps of two channels, row by row: offsets, drifts by the number of the sample, a gain and a slope along the depth; signals;
/// large amplitudes of all nuisances in the record.
fn sweeps() -> impl Strategy<Value = Rows> {
    let number = || -1.0..1.0_f64;
    (2..24_usize, 1..5_usize)
        .prop_flat_map(move |(samples, signals)| {
            let series = || prop::collection::vec(number(), 2 * samples);
            (
                series(),
                series(),
                series(),
                prop::collection::vec(series(), signals),
                prop::array::uniform6(-1e3..1e3_f64),
            )
        })
        .prop_map(|(gain, slope, noise, signals, amplitudes)| {
            let rows = noise.len();
            let alone = |channel: usize, of: &dyn Fn(usize) -> f64| -> Vec<f64> {
                (0..rows)
                    .map(|row| if row % 2 == channel { of(row / 2) } else { 0.0 })
                    .collect()
            };
            let gain: Vec<f64> = gain.iter().map(|of| 15.0 + of).collect();
            let nuisances = vec![
                alone(0, &|_| 10.0),
                alone(1, &|_| 10.0),
                alone(0, &|sample| sample as f64),
                alone(1, &|sample| sample as f64),
                gain,
                slope,
            ];
            let residual = (0..rows).map(|row| {
                let disturbed = nuisances
                    .iter()
                    .zip(amplitudes)
                    .map(|(of, amplitude)| amplitude * of[row]);
                3.0 * noise[row] + disturbed.sum::<f64>()
            });
            Rows {
                residual: residual.collect(),
                nuisances,
                signals,
            }
        })
}

proptest! {
    // Verifies: SEQ-001, SEQ-002, SEQ-003, SEQ-004.
    #[test]
    fn after_each_row_the_answer_is_that_of_the_record_so_far(sweep in sweeps()) {
        let mut found = sweep.detector();
        for row in 0..sweep.residual.len() {
            sweep.push(row, &mut found);
            sweep.check(&found, row + 1);
        }
    }

    // A path may end or begin anywhere: no row knows its place.
    // Verifies: SEQ-001.
    #[test]
    fn the_order_of_the_rows_does_not_matter(sweep in sweeps()) {
        let rows = sweep.residual.len();
        sweep.check(&sweep.pushed((0..rows).rev()), rows);
        sweep.check(&sweep.pushed((0..rows).step_by(2).chain((1..rows).step_by(2))), rows);
    }

    // Verifies: SEQ-001.
    #[test]
    fn a_hypothesis_is_not_affected_by_the_others(sweep in sweeps()) {
        let rows = sweep.residual.len();
        let together: Vec<Evidence> = sweep.pushed(0..rows).evidence().collect();
        for (signal, expected) in sweep.signals.iter().zip(together) {
            let alone = Rows { signals: vec![signal.clone()], ..sweep.clone() };
            prop_assert_eq!(alone.pushed(0..rows).evidence().next(), Some(expected));
        }
    }

    // Verifies: SEQ-003, SEQ-004.
    #[test]
    fn units_do_not_matter(sweep in sweeps(), powers in prop::array::uniform6(-60..60_i32), power in -60..60_i32) {
        let rows = sweep.residual.len();
        let times = |column: &Vec<f64>, power: i32| column.iter().map(|of| of * 2f64.powi(power)).collect::<Vec<_>>();
        let scaled = Rows {
            nuisances: sweep.nuisances.iter().zip(powers).map(|(of, power)| times(of, power)).collect(),
            signals: sweep.signals.iter().map(|of| times(of, power)).collect(),
            ..sweep.clone()
        };
        // Powers of two change no digit.
        let (found, expected) = (scaled.pushed(0..rows), sweep.pushed(0..rows));
        prop_assert_eq!((found.residual(), found.rank()), (expected.residual(), expected.rank()));
        for (found, expected) in found.evidence().zip(expected.evidence()) {
            prop_assert_eq!(found.along, 2f64.powi(power) * expected.along);
            prop_assert_eq!(found.gamma_squared, 4f64.powi(power) * expected.gamma_squared);
        }
    }

    // Verifies: SEQ-005.
    #[test]
    fn a_missing_row_changes_nothing(sweep in sweeps(), at in 0..4_usize) {
        let rows = sweep.residual.len();
        let mut holed = sweep.clone();
        holed.residual[at] = f64::NAN;
        let (holed, whole) = (holed.pushed(0..rows), sweep.pushed((0..rows).filter(|row| *row != at)));
        prop_assert_eq!((holed.missing(), holed.rows()), (1, rows - 1));
        prop_assert!(holed.evidence().eq(whole.evidence()));
        prop_assert_eq!(holed.residual(), whole.residual());
    }

    // Verifies: SEQ-003, SEQ-006.
    #[test]
    fn no_number_makes_nan(rows in prop::collection::vec(prop::array::uniform6(any::<f64>()), 1..12), powers in prop::array::uniform6(-320..100_i32)) {
        let mut found = Sequential::new([0.0; memory(3, 2)], 3, 2).unwrap();
        for row in rows {
            let scaled: Vec<f64> = row.iter().zip(powers).map(|(value, power)| {
                // Any bits, or a number of the size that is given.
                if value.abs() <= LARGEST && *value != 0.0 { value.signum() * 10f64.powi(power) } else { *value }
            }).collect();
            let before: Vec<Evidence> = found.evidence().collect();
            if found.push(scaled[0], &scaled[1..3], &scaled[3..]).is_err() {
                prop_assert!(found.evidence().eq(before));
            }
            prop_assert!(found.evidence().all(|of| of.theta().is_finite() && of.gamma_squared >= 0.0));
            prop_assert!(found.residual() >= 0.0 && found.rank() <= 2);
        }
    }
}

mod rates;

// The expected values are mpmath's, of the tests of the subspace detector.
// Verifies: SEQ-001.
#[test]
fn the_digits_are_those_of_exact_arithmetic() {
    let series = |of: &dyn Fn(usize) -> f64| (0..12).map(of).collect::<Vec<f64>>();
    let sweep = Rows {
        nuisances: vec![
            series(&|_| 1.0),
            series(&|i| (2.0 * i as f64 - 11.0) / 8.0),
            series(&|i| (i * i * 5 % 7) as f64 / 4.0),
        ],
        residual: series(&|i| ((i * i * 7 + 3 * i) % 11) as f64 / 4.0 - 1.0),
        signals: vec![series(&|i| (i * 3 % 5) as f64 - 0.5)],
    };
    let found = sweep.pushed(0..12);
    let evidence = found.evidence().next().unwrap();
    let (gamma, t) = (4.816937762021007_f64, 1.6478011024129822);
    assert_near(evidence.gamma_squared, gamma * gamma, 1e-12);
    assert_near(evidence.theta(), -3.6640893470790377, 1e-12);
    assert_near(found.residual(), 5.174391403455745 + t * t, 1e-12);
    assert_eq!((found.rows(), found.rank()), (12, 3));
}

// A gain of which the first row tells next to nothing and the others all: with u = (ε, 1, 1, 1), δ = (3, 1, 0, 2) and z = (1, 2, 5, −1) the
// products are uᵀδ = 3 + 3ε, uᵀz = 6 + ε, δᵀz = 3, |δ|² = 14, |z|² = 31 and |u|² = 3 + ε², of which ε² is below the digits. The bound of
// SEQ-001 for two columns, four rows and a condition of 1 is 3·2·2·8·2·2⁻⁵³ = 2·10⁻¹⁴ of 14, 31 and √14 (√31 + √14) = 35.
// Verifies: SEQ-001.
#[test]
fn a_first_row_that_tells_little_costs_no_digits() {
    for small in [1e-3, 1e-8, 1e-12, 1e-30] {
        let sweep = Rows {
            nuisances: vec![vec![small, 1.0, 1.0, 1.0]],
            residual: vec![1.0, 2.0, 5.0, -1.0],
            signals: vec![vec![3.0, 1.0, 0.0, 2.0]],
        };
        let found = sweep.pushed(0..4);
        let evidence = found.evidence().next().unwrap();
        let length = 3.0 + small * small;
        let [signal, residual] = [3.0 + 3.0 * small, 6.0 + small];
        let gamma_squared = 14.0 - signal * signal / length;
        let along = 3.0 - signal * residual / length;
        assert_near(evidence.gamma_squared, gamma_squared, 3e-13);
        assert_near(evidence.along, along, 8e-13);
        assert_near(found.residual(), 31.0 - residual * residual / length, 7e-13);
    }
}

// Each nuisance has 10⁻¹¹ of its length beside those before it, so that the last row grows by 10¹¹ and its weight falls by 10⁻²² at each.
// Verifies: SEQ-003, SEQ-006.
#[test]
fn numbers_that_grow_from_nuisance_to_nuisance_stay_finite() {
    const COUNT: usize = 40;
    let mut found = Sequential::new([0.0; memory(1, COUNT)], 1, COUNT).unwrap();
    for own in 0..=COUNT {
        let number = |at: usize| match at.cmp(&own) {
            core::cmp::Ordering::Less if own < COUNT => 0.0,
            core::cmp::Ordering::Equal => 1e-11,
            _ => 1.0,
        };
        let nuisances: [f64; COUNT] = core::array::from_fn(number);
        found.push(1.0, &nuisances, &[1.0 + own as f64]).unwrap();
        let evidence = found.evidence().next().unwrap();
        assert!(
            evidence.theta().is_finite() && found.residual().is_finite(),
            "{own}: {evidence:?}"
        );
    }
    assert_eq!(found.rank(), COUNT);
}

// A gel whose forces are everywhere the same cannot tell a gain from an offset.
// Verifies: SEQ-003, SEQ-004.
#[test]
fn nuisances_and_signals_that_the_others_explain_do_not_count() {
    let series = |of: &dyn Fn(usize) -> f64| (0..40).map(of).collect::<Vec<f64>>();
    let noise = |stream| series(&|i| Generator::new(44, stream).normal(0, i as u64));
    let sweep = Rows {
        nuisances: vec![
            series(&|_| 1.0),
            series(&|_| 0.1 + 0.2),
            series(&|i| i as f64),
        ],
        residual: noise(1),
        signals: vec![series(&|i| 0.7 * i as f64 - 3.1), noise(2)],
    };
    let mut found = sweep.detector();
    for row in 0..40 {
        sweep.push(row, &mut found);
        sweep.check(&found, row + 1);
        let explained = found.evidence().next().unwrap();
        assert_eq!((explained.theta(), explained.gamma_squared), (0.0, 0.0));
    }
    assert_eq!(found.rank(), 2);
}

// Verifies: SEQ-001.
#[test]
fn rows_that_nuisances_explain_leave_the_prior() {
    let mut found = Sequential::new([0.0; memory(1, 2)], 1, 2).unwrap();
    for (row, nuisances) in [[1.0, 0.0], [0.0, 2.0]].iter().enumerate() {
        found.push(7.0, nuisances, &[3.0]).unwrap();
        let evidence = found.evidence().next().unwrap();
        assert_eq!(
            (evidence.theta(), found.residual(), found.rank()),
            (0.0, 0.0, row + 1)
        );
    }
    // A second row of the same tells: the differences of 1 and of 3, over √2 each.
    found.push(8.0, &[1.0, 0.0], &[0.0]).unwrap();
    let evidence = found.evidence().next().unwrap();
    assert_near(evidence.along, -1.5, 1e-14);
    assert_near(evidence.gamma_squared, 4.5, 1e-14);
}

// Helmert's contrasts, of numbers up to 24 that are added 40 times at most: 40 · 24 roundings, of which most cancel.
// Verifies: SEQ-008.
#[test]
fn an_innovation_is_what_the_rows_before_it_do_not_predict() {
    let mut found = Sequential::new([0.0; memory(2, 1)], 2, 1).unwrap();
    assert!(found.innovation().eq([0.0; 3]));
    let mut before: [Vec<f64>; 3] = [const { Vec::new() }; 3];
    for row in 0..40_u32 {
        let noise = Generator::new(45, 0).normal(0, row.into());
        let numbers = [20.0 + noise, f64::from(row % 7), -f64::from(row % 3)];
        found.push(numbers[0], &[2.0], &numbers[1..]).unwrap();
        let count = f64::from(row.max(1));
        let factor = f64::from(row) / f64::from(row + 1);
        for ((of, number), before) in found.innovation().zip(numbers).zip(&mut before) {
            let mean = before.iter().sum::<f64>() / count;
            assert_near(
                of,
                factor.sqrt() * (number - mean),
                40.0 * 24.0 * f64::EPSILON,
            );
            before.push(number);
        }
    }
    // A row that is missing leaves the last one.
    let last: Vec<f64> = found.innovation().collect();
    found.push(f64::NAN, &[2.0], &[1.0, 1.0]).unwrap();
    assert!(found.innovation().eq(last));
}

// Verifies: SEQ-006, SEQ-007.
#[test]
fn what_no_row_can_be_is_refused() {
    assert_eq!(memory(231, 6), 10 * 238);
    assert_eq!(memory(usize::MAX, 1), usize::MAX);
    assert!(Sequential::new([0.0; 10], 0, 1).is_err());
    assert!(Sequential::new([0.0; memory(1, 1) + 1], 1, 1).is_err());
    assert!(Sequential::new([0.0; 1], usize::MAX, usize::MAX).is_err());
    let mut found = Sequential::new([0.0; memory(1, 1)], 1, 1).unwrap();
    found.push(1.0, &[1.0], &[1.0]).unwrap();
    found.push(2.0, &[1.0], &[3.0]).unwrap();
    let before = found.clone();
    for (residual, nuisances, signals) in [
        (f64::INFINITY, &[1.0][..], &[1.0][..]),
        (-1.1e80, &[1.0], &[1.0]),
        (1.0, &[f64::NAN], &[1.0]),
        (f64::NAN, &[f64::NAN], &[1.0]),
        (1.0, &[1.0], &[f64::NAN]),
        (1.0, &[1.0], &[f64::NEG_INFINITY]),
        (1.0, &[1.0, 1.0], &[1.0]),
        (1.0, &[], &[1.0]),
        (1.0, &[1.0], &[1.0, 1.0]),
        (1.0, &[1.0], &[]),
    ] {
        assert!(found.push(residual, nuisances, signals).is_err());
        assert_eq!(found.memory, before.memory);
        assert_eq!((found.rows(), found.missing()), (2, 0));
    }
}

// Verifies: SEQ-010, SEQ-011, SEQ-012.
#[test]
fn the_test_of_two_hypotheses_is_walds() {
    let test = Wald::new(0.05, 0.2).unwrap();
    // ln 20 and −ln 5.
    assert_near(test.upper(), 2.995732273553991, 1e-15);
    assert_near(test.lower(), -1.6094379124341003, 1e-15);
    let decide = |theta| test.decide(theta).unwrap();
    assert_eq!(decide(test.upper()), Some(Decision::Inclusion));
    assert_eq!(decide(test.lower()), Some(Decision::NoInclusion));
    assert_eq!((decide(2.99), decide(-1.6)), (None, None));
    assert!(test.decide(f64::NAN).is_err() && test.decide(f64::INFINITY).is_err());
    // a = 0.05 · 0.8/0.99, b = 0.2 · 0.95/0.99.
    let (a, b) = (0.04 / 0.99, 0.19 / 0.99);
    let expected = -2.0 * (a * 2.995732273553991 - (1.0 - a) * 1.6094379124341003);
    assert_near(
        test.mean_gamma_squared(Decision::NoInclusion),
        expected,
        1e-14,
    );
    let expected = 2.0 * ((1.0 - b) * 2.995732273553991 - b * 1.6094379124341003);
    assert_near(
        test.mean_gamma_squared(Decision::Inclusion),
        expected,
        1e-14,
    );
    for rates in [
        (0.0, 0.1),
        (0.1, 0.0),
        (1.0, 0.1),
        (0.5, 0.5),
        (f64::NAN, 0.1),
        (0.9, 0.2),
    ] {
        assert!(Wald::new(rates.0, rates.1).is_err(), "{rates:?}");
    }
    // γ = 2 at η = 0: Φ(−1).
    let ends = test.truncated(2.0, 0.0).unwrap();
    assert_near(ends.false_alarm, 0.05 + 0.15865525393145707, 1e-15);
    assert_near(ends.miss, 0.2 + 0.15865525393145707, 1e-15);
    assert_eq!(test.truncated(0.0, 0.0).unwrap().false_alarm, 1.0);
    assert!(test.truncated(-1.0, 0.0).is_err());
}
