//! What must not change the judgement of a record, or changes it in a known way.

use proptest::prelude::*;

use super::judge::{STATED, close, question};
use super::*;
use crate::force_map::tests::table_of;
use crate::stats::random::Generator;
use palpate_asserts::seeded;

/// Maps without and with an inclusion, neither their own mirror image, and a record over them.
struct Case {
    maps: [ForceTable; 2],
    record: Record,
    noise_sd: Force<f64>,
}

impl Case {
    fn new(stream: u64, signal: f64) -> Case {
        let laterals: Vec<f64> = (-8..=8).map(|x| 1e-3 * f64::from(x)).collect();
        let map = |signal: f64| {
            table_of(&[3e-3, 4e-3, 5e-3], &laterals, |d, x| {
                let bump = signal / (1.0 + 1e5 * (x - 1e-3) * (x - 1e-3));
                let stiff = 400.0 * d + 5e4 * d * d;
                [
                    stiff * (x * 20.0 + 0.02) - 300.0 * x * bump,
                    stiff * (1.0 - 8.0 * x) + bump,
                ]
            })
        };
        let generator = Generator::new(20_261_125, stream);
        let positions: Vec<f64> = (0..40).map(|i| 1e-3 * (0.4 * f64::from(i) - 7.8)).collect();
        let exact = map(0.7 * signal).sweep(4e-3, &positions).unwrap();
        let noise = |channel, i| 0.1 * generator.normal(channel, i as u64);
        let record = judge::record(positions, |i| {
            [
                exact.lateral[i] + noise(0, i),
                exact.normal[i] + noise(1, i),
            ]
        });
        let maps = [0.0, signal].map(map);
        Case {
            maps,
            record,
            noise_sd: STATED,
        }
    }

    fn judged(&self, unknown: &[Unknown]) -> Judgement {
        let noise = Noise {
            sd: Some(self.noise_sd),
            correlation: Correlation::None,
        };
        let question = Question {
            unknown,
            noise,
            ..question(4e-3)
        };
        let hypotheses = Hypotheses::of_tables(&self.maps[0], &self.maps[1]).unwrap();
        question.judge(hypotheses, &self.record).unwrap()
    }

    /// The same with other positions and forces, of the maps and of the record.
    fn changed(&self, position: impl Fn(f64) -> f64, forces: Force<f64>) -> Case {
        let map = |map: &ForceTable| {
            let mut places: Vec<usize> = (0..map.laterals().len()).collect();
            let at = |place: &usize| position(map.laterals()[*place]);
            places.sort_by(|a, b| at(a).total_cmp(&at(b)));
            let of = map.both().unwrap().zip(forces).map(|(of, factor)| {
                Matrix::from_fn(of.row_count(), places.len(), |row, column| {
                    factor * of.row(row)[places[column]]
                })
            });
            ForceTable::new(map.depths().into(), places.iter().map(at).collect(), of).unwrap()
        };
        let record = judge::record(
            self.record
                .positions()
                .iter()
                .map(|x| position(*x))
                .collect(),
            |i| {
                self.record
                    .forces()
                    .as_ref()
                    .zip(forces)
                    .map(|(of, factor)| factor * of[i])
                    .into_array()
            },
        );
        let noise_sd = self
            .noise_sd
            .zip(forces)
            .map(|(sd, factor)| sd * factor.abs());
        Case {
            maps: self.maps.each_ref().map(map),
            record,
            noise_sd,
        }
    }

    /// The same with some of the samples, in another order.
    fn of(&self, samples: &[usize]) -> Case {
        let positions = samples
            .iter()
            .map(|i| self.record.positions()[*i])
            .collect();
        let forces = self.record.forces();
        let record = judge::record(positions, |i| {
            forces.as_ref().map(|of| of[samples[i]]).into_array()
        });
        Case {
            maps: self.maps.clone(),
            record,
            ..*self
        }
    }
}

/// Asserts that two judgements have the same numbers, to rounding.
fn assert_same(found: &Judgement, expected: &Judgement) {
    let numbers = |of: &Judgement| {
        [
            of.test.t,
            of.test.gamma,
            of.test.theta(),
            of.posterior,
            of.rates.miss,
            of.gamma_nominal,
            of.fit.chi_square,
            of.fit.degrees,
        ]
    };
    for (found, expected) in std::iter::zip(numbers(found), numbers(expected)) {
        close(found, expected);
    }
}

// Verifies: TRC-001, TRC-020.
#[test]
fn a_record_may_be_longer_than_16_bits_count() {
    let count = (1 << 16) + 1;
    let row = |i: usize| format!("{},0,{}\n", i as f64 / 65_536.0, 1.0 + (i % 2) as f64);
    let head = "position_mm,lateral_force_n,normal_force_n\n".to_string();
    let text = head + &(0..count).map(row).collect::<String>();
    let record = read(&text).unwrap();
    assert_eq!(
        (record.positions().len(), record.positions()[count - 1]),
        (count, 1e-3)
    );
    let level = |signal: f64| table_of(&[4e-3], &[0.0, 1e-3], |_, _| [0.0, 1.0 + signal]);
    let (without, with) = (level(0.0), level(0.125));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let noise_sd = Force::new(0.5, 0.5);
    let noise = Noise {
        sd: Some(noise_sd),
        correlation: Correlation::None,
    };
    let found = Question {
        noise,
        ..question(4e-3)
    }
    .judge(hypotheses, &record)
    .unwrap();
    // Each sample has a signal of a quarter of its noise; every second one, from the second on, is 1 N above the level.
    assert_eq!(found.fit.degrees, 2.0 * count as f64 - 1.0);
    close(found.test.gamma, (count as f64).sqrt() / 4.0);
    close(
        found.test.theta(),
        32_768.0 * 2.0 / 4.0 - count as f64 / 32.0,
    );
    let error = read(&format!("{text}0.5,none,1\n")).unwrap_err();
    assert!(error.starts_with("t.csv:65539:"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..seeded(20_261_125) })]

    // Verifies: TRC-020, TRC-060, TRC-065.
    #[test]
    fn units_places_sides_and_the_order_of_samples_change_no_judgement(
        stream in any::<u64>(),
        signal in 0.1..0.5,
        mask in 0..16_usize,
        shift in -2.0..2.0,
        power in -12..12_i32,
        turn in 1..39_usize,
    ) {
        let case = Case::new(stream, signal);
        let all = &Unknown::ALL[..4];
        let unknown: Vec<Unknown> = (0..4).filter(|at| mask >> at & 1 == 1).map(|at| all[at]).collect();
        let expected = case.judged(&unknown);
        // Forces and noise in another unit, and the lateral ones in one of their own where nothing ties them to the normal ones.
        let unit = 2.0_f64.powi(power);
        let scaled = case.changed(|x| x, Force::new(unit, unit)).judged(&unknown);
        prop_assert_eq!(scaled.test, expected.test);
        let scaled = case.changed(|x| x, Force::new(unit, 1.0)).judged(&unknown);
        assert_same(&scaled, &expected);
        // Everything elsewhere, and in a mirror.
        assert_same(&case.changed(|x| x + 1e-3 * shift, Force::new(1.0, 1.0)).judged(&unknown), &expected);
        assert_same(&case.changed(|x| -x, Force::new(-1.0, 1.0)).judged(&unknown), &expected);
        // A drift goes as far up as down.
        let reversed: Vec<usize> = (0..40).rev().collect();
        assert_same(&case.of(&reversed).judged(&unknown), &expected);
        // It has an order.
        if !unknown.contains(&Unknown::Drift) {
            let turned: Vec<usize> = (turn..40).chain(0..turn).collect();
            assert_same(&case.of(&turned).judged(&unknown), &expected);
        }
    }

    // Verifies: TRC-020, TRC-065.
    #[test]
    fn theta_adds_up_over_parts_of_a_record_and_turns_round_with_the_hypotheses(
        stream in any::<u64>(),
        signal in 0.1..0.5,
        cut in 1..39_usize,
    ) {
        let case = Case::new(stream, signal);
        let whole = case.judged(&[]).test;
        let samples: Vec<usize> = (0..40).collect();
        let parts = [&samples[..cut], &samples[cut..]].map(|part| case.of(part).judged(&[]).test);
        close(parts[0].theta() + parts[1].theta(), whole.theta());
        close(parts[0].gamma.powi(2) + parts[1].gamma.powi(2), whole.gamma.powi(2));
        let [without, with] = &case.maps;
        let maps = [with.clone(), without.clone()];
        let turned = Case { maps, ..case }.judged(&[]).test;
        close(turned.theta(), -whole.theta());
        prop_assert_eq!(turned.gamma, whole.gamma);
    }
}
