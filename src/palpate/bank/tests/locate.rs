//! Recorded sweeps against a bank.

use super::*;
use crate::detect::{Decision, map_threshold, posterior};
use crate::stats::random::Generator;
use crate::trace::{Cause, Correlation, Criterion, Noise, Question, Record, Trace, Unknown};
use palpate_asserts::assert_near;

pub const SD: f64 = 0.05;

/// A sweep of 61 samples over −3 … 3 mm of the gel of `map`, with noise unless there is no seed, and what a sensor adds.
pub fn record(map: &ForceMap, seed: Option<u64>, offset: f64, gain: f64) -> Record {
    let positions: Vec<f64> = (0..61).map(|k| 1e-4 * f64::from(k) - 3e-3).collect();
    let exact = map.table().sweep(4e-3, &positions).unwrap();
    let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for (k, position) in positions.iter().enumerate() {
        let noise = |channel: u64| {
            let deviate = |seed| Generator::new(seed, channel).normal(0, k as u64);
            SD * seed.map_or(0.0, deviate)
        };
        let lateral = gain * exact.lateral[k] + noise(0);
        let normal = gain * exact.normal[k] + offset + noise(1);
        text += &format!("{},{lateral},{normal}\n", 1e3 * position);
    }
    let trace = Trace::from_csv(&text, "t.csv").unwrap();
    trace.record(None).unwrap()
}

// Verifies: TRC-015. The limit of a noise that grows is another way to the same numbers.
#[test]
fn a_record_of_the_normal_force_alone_is_located_by_it() {
    let bank = all();
    let record = record(&bank.maps()[4], Some(7), 0.1, 1.1);
    let located = |record: &Record, lateral_sd: f64| {
        let mut search = by_map(&bank);
        search.question.noise.sd = Some(Force::new(lateral_sd, SD));
        search.locate(record).unwrap()
    };
    // Each lateral sample adds at most (1 N/1e8 N)² to a sum of squares.
    let (one, both) = (
        located(&record.clone().normal_alone(), SD),
        located(&record, 1e8),
    );
    assert_near(one.theta_mixture / both.theta_mixture, 1.0, 1e-9);
    assert_near(one.test.gamma / both.test.gamma, 1.0, 1e-9);
    assert_eq!((one.point, one.fit.noise_sd.lateral), (both.point, None));
    let offsets_and_drifts = 2.0;
    assert_eq!(
        one.fit.degrees,
        both.fit.degrees - 61.0 + offsets_and_drifts
    );
}

// Verifies: TRC-075. Positions in m where mm are meant.
#[test]
fn a_record_of_one_place_is_not_judged() {
    let bank = all();
    let wide = record(&bank.maps()[4], Some(7), 0.0, 1.0);
    let positions: Vec<f64> = wide.positions().iter().map(|x| 1e-3 * x).collect();
    let narrow = Record::new("t", &positions, wide.forces()).unwrap();
    let mut search = by_map(&bank);
    search.question.unknown = &[Unknown::Variance];
    search.question.noise.sd = None;
    let [wide, narrow] = [wide, narrow].map(|record| search.locate(&record).unwrap());
    assert_eq!(
        (wide.decision, narrow.decision),
        (Some(Decision::Inclusion), None)
    );
    assert_eq!((&*wide.causes, narrow.causes[0]), (&[][..], Cause::Narrow));
}

// Verifies: TRC-075, TRC-016, CLI-143.
#[test]
fn a_search_by_a_sensor_set_to_zero_never_finds_that_there_is_nothing() {
    let bank = all();
    let mut zeroed = by_map(&bank);
    zeroed.question.is_zeroed = true;
    // In air, where the noise is alone, and on the gel.
    for gain in [0.0, 1.0] {
        let nothing = record(&reference(), Some(2), 0.0, gain);
        let found = zeroed.locate(&nothing).unwrap();
        assert_eq!(
            (found.decision, &found.causes[..]),
            (None, &[Cause::Zeroed][..])
        );
        let rows = found.rows(&bank).unwrap();
        assert!(rows.get("posterior_h1").unwrap().is_f64());
    }
    let with = map(Some((1.3, 3.5, 8.0)), &[4e-3]);
    let found = zeroed.locate(&record(&with, Some(1), -1.0, 1.1)).unwrap();
    assert_eq!(
        (found.decision, &found.causes[..]),
        (Some(Decision::Inclusion), &[][..])
    );
}

pub const USUAL: &[Unknown] = &[Unknown::Offset, Unknown::Drift, Unknown::Gain];

pub fn question<'a>(unknown: &'a [Unknown], criterion: Criterion) -> Question<'a> {
    Question {
        depth: 4e-3,
        depth_tolerance: 0.0,
        is_zeroed: false,
        unknown,
        noise: Noise {
            sd: Some(Force::new(SD, SD)),
            correlation: Correlation::OfRecord,
        },
        criterion,
        prior_h1: 0.25,
    }
}

pub fn search<'a>(bank: &'a Bank, unknown: &'a [Unknown], criterion: Criterion) -> BankSearch<'a> {
    BankSearch {
        question: question(unknown, criterion),
        bank,
        prior: None,
        simulations: None,
    }
}

fn by_map(bank: &Bank) -> BankSearch<'_> {
    search(bank, USUAL, Criterion::MaximumAPosteriori)
}

pub fn all() -> Bank {
    Bank::new(reference(), maps()).unwrap()
}

/// The bank at three depths of the probe, whose reference has a row between two of them where the force has a kink.
pub fn deep() -> Bank {
    beside(&[3.6e-3, 3.8e-3, 4e-3, 4.2e-3, 4.4e-3])
}

/// The same with a reference of other depths.
fn beside(rows: &[f64]) -> Bank {
    let depths = [3.6e-3, 4e-3, 4.4e-3];
    let kinked = |map: ForceMap| {
        let (table, columns) = (map.table(), map.table().laterals().len());
        let kink = |row: usize| 50.0 * (table.depths()[row] - 3.8e-3).abs();
        let normal = |row, column: usize| table.normal().row(row)[column] + kink(row);
        let normal = Matrix::from_fn(table.depths().len(), columns, normal);
        let forces = Force::new(table.lateral().unwrap().clone(), normal);
        let table = ForceTable::new(table.depths().to_vec(), table.laterals().to_vec(), forces);
        measured(map.phantom().cloned(), table.unwrap())
    };
    let at = |x: i32| kinked(map(Some((f64::from(x), 4.0, 8.0)), &depths));
    Bank::new(kinked(map(None, rows)), (-2..=2).map(at).collect()).unwrap()
}

/// Three passes at 3.6 to 4.4 mm, with the inclusion at `x` (mm) or none, in noise unless there is no seed; the signal is as the bank
/// makes it of the bump, the same at all depths.
pub fn path(bank: &Bank, x: Option<f64>, seed: Option<u64>) -> Record {
    let places = (0..123).map(|k| {
        let (pass, step) = (k / 41, (k % 41) as f64);
        let x = 1.5e-4 * step - 3e-3;
        (
            if pass == 1 { -x } else { x },
            3.65e-3 + 0.006e-3 * k as f64,
        )
    });
    let (over, depths): (Vec<f64>, Vec<f64>) = places.unzip();
    let mut forces = bank.reference().table().path(&depths, &over).unwrap();
    if let Some(x) = x {
        let with = |depths| map(Some((x, 4.0, 8.0)), depths).table().clone();
        let [with, none] = [with(&[4e-3]), map(None, &[4e-3]).table().clone()];
        let [with, none] = [with, none].map(|table| table.sweep(4e-3, &over).unwrap().normal);
        let signals = with.iter().zip(&none).map(|(with, none)| with - none);
        forces
            .normal
            .iter_mut()
            .zip(signals)
            .for_each(|(force, signal)| *force += signal);
    }
    let noise = |channel: u64, k: usize| {
        let deviate = |seed| Generator::new(seed, channel).normal(0, k as u64);
        SD * seed.map_or(0.0, deviate)
    };
    for (channel, series) in [&mut forces.lateral, &mut forces.normal]
        .into_iter()
        .enumerate()
    {
        let all = series.iter_mut().enumerate();
        all.for_each(|(k, force)| *force += noise(channel as u64, k));
    }
    Record::along("t.csv", &over, &depths, forces.as_deref()).unwrap()
}

// Verifies: BNK-080, BNK-001, BNK-033.
#[test]
fn signals_between_the_depths_of_the_probe_are_free_of_the_gel() {
    let bank = deep();
    assert_eq!(bank.probe_depths(), [3.6e-3, 4e-3, 4.4e-3]);
    let found = by_map(&bank).locate(&path(&bank, Some(1.0), None)).unwrap();
    assert_eq!(found.point[0], 1e-3);
    // T of a record that is the model is γ, and nothing is left: the kink is in the reference alone.
    assert_near(found.test.t / found.test.gamma, 1.0, 1e-9);
    // The kink of 0.01 N would leave (0.01/0.05)² of a sample; the estimate is off by what the climb leaves.
    assert!(found.fit.chi_square < 1e-4, "{:?}", found.fit);
    let found = by_map(&bank).locate(&path(&bank, None, Some(3))).unwrap();
    assert_eq!(found.decision, Some(Decision::NoInclusion));
    // Without depths of the samples one of the bank's is stated.
    let sweep = record(bank.reference(), Some(3), 0.0, 1.0);
    let mut asked = by_map(&bank);
    assert!(asked.locate(&sweep).is_ok());
    asked.question.depth = 3.8e-3;
    let expected = "t.csv: the bank is for a depth of 3.6, 4.0, 4.4 mm, not 3.8 mm";
    assert!(
        asked
            .locate(&sweep)
            .unwrap_err()
            .to_string()
            .starts_with(expected)
    );
}

// Verifies: BNK-060, BNK-034, BNK-063, BNK-064.
#[test]
fn a_record_is_judged_at_the_likeliest_point() {
    let bank = all();
    let with = map(Some((1.3, 3.5, 8.0)), &[4e-3]);
    let record = record(&with, Some(1), 0.3, 1.1);
    let found = by_map(&bank).locate(&record).unwrap();
    assert_eq!(found.decision, Some(Decision::Inclusion));
    assert!([1e-3, 2e-3].contains(&found.point[0]), "{:?}", found.point);
    // As by the map of that point alone.
    let number = (0..40).find(|&number| bank.point(number) == found.point);
    let number = number.unwrap();
    let one_depth = map(None, &[4e-3]);
    let hypotheses = crate::force_map::Hypotheses::new(&one_depth, &bank.maps()[number]).unwrap();
    let question = question(USUAL, Criterion::MaximumAPosteriori);
    let alone = question.judge(hypotheses, &record).unwrap();
    assert!((found.theta_max - alone.test.theta()).abs() < 1e-9);
    // The record fits between the points, and not as well at the nearest.
    assert!(found.fit.noise_is_right(), "{:?}", found.fit);
    assert!(alone.fit.chi_square > found.fit.chi_square);
    // At most the largest, and at least its part.
    let below = found.theta_max - found.theta_mixture;
    assert!(below >= 0.0 && below <= 40f64.ln(), "{below}");
    assert_eq!(posterior(found.theta_mixture, 0.25), Ok(found.posterior));
    assert_eq!(map_threshold(0.25), Ok(found.threshold.eta));
    // Of an inclusion there whatever else is: θ ≥ η + ln 40.
    let gamma = found.test.gamma;
    let miss =
        crate::stats::normal::lower_tail((found.threshold.eta + 40f64.ln()) / gamma - 0.5 * gamma);
    // Far in the tail: γ² roundings of the exponent.
    assert_near(found.threshold.miss_bound / miss, 1.0, 1e-9);
    // Where it lies, within four standard deviations.
    for (axis, truth) in [(0, 1.3e-3), (1, 3.5e-3), (2, 8e-3)] {
        let (estimate, sd) = (found.place.estimate[axis], found.bound.sd[axis].unwrap());
        assert_near(estimate, truth, 4.0 * sd);
    }
    assert_eq!(found.bound.sd[3], None);
}

// Verifies: TRC-086, BNK-034.
#[test]
fn errors_of_the_depths_are_noise_of_the_templates_too() {
    let bank = beside(&[3.6e-3, 4e-3, 4.4e-3]);
    let record = path(&bank, Some(1.0), Some(5));
    let record = record.with_depth_sd(2e-3).unwrap();
    let mut search = search(&bank, &[], Criterion::MaximumAPosteriori);
    search.question.noise.correlation = Correlation::None;
    let found = search.locate(&record).unwrap();
    let number = (0..5).find(|&number| bank.point(number) == found.point);
    let with = bank.maps()[number.unwrap()].table();
    let hypotheses = crate::force_map::Hypotheses::of_tables(bank.base(), with).unwrap();
    let alone = search.question.judge(hypotheses, &record).unwrap();
    assert_near(found.test.gamma / alone.test.gamma, 1.0, 1e-9);
    assert_near(found.theta_max / alone.test.theta(), 1.0, 1e-9);
}

// Verifies: BNK-060, BNK-033.
#[test]
fn what_cannot_be_judged_is_told() {
    let bank = all();
    let without = record(&reference(), Some(2), 0.0, 1.0);
    let found = by_map(&bank).locate(&without).unwrap();
    assert_eq!(found.decision, Some(Decision::NoInclusion));
    let high = record(&reference(), Some(2), 5.0, 1.0);
    let found = search(&bank, &[], Criterion::MaximumAPosteriori)
        .locate(&high)
        .unwrap();
    assert_eq!((found.decision, found.causes[0]), (None, Cause::Misfit));
    let mut asked = by_map(&bank);
    // Between the depths of the reference, and beyond them.
    for (depth, found) in [(3.9e-3, "3.9"), (3e-3, "3.0")] {
        asked.question.depth = depth;
        let error = asked.locate(&without).unwrap_err().to_string();
        let expected = format!("t.csv: the bank is for a depth of 4.0 mm, not {found} mm");
        assert_eq!(error, format!("{expected}; give 4.0, or another bank"));
    }
    let wrong = BankSearch {
        prior: Some(&[1.0]),
        ..by_map(&bank)
    };
    assert!(wrong.locate(&without).is_err());
}

// Verifies: BNK-051, BNK-053, BNK-063.
#[test]
fn thresholds_keep_what_they_promise() {
    let bank = all();
    let max_false_alarm = 0.05;
    let alarm = Criterion::NeymanPearsonFalseAlarm { max_false_alarm };
    let miss = Criterion::NeymanPearsonMiss { max_miss: 0.05 };
    let with = map(Some((1.0, 5.0, 4.0)), &[4e-3]);
    let (mut alarms, mut misses) = (0, 0);
    for seed in 0..100 {
        let bare = record(&reference(), Some(seed), 0.3, 0.9);
        let found = search(&bank, USUAL, alarm).locate(&bare).unwrap();
        assert!((found.threshold.false_alarm_bound - 0.05).abs() < 1e-6);
        assert!(!found.threshold.by_mixture);
        // The posterior is of the mixture whatever the decision is by.
        assert_eq!(posterior(found.theta_mixture, 0.25), Ok(found.posterior));
        alarms += u32::from(found.decision == Some(Decision::Inclusion));
        let there = record(&with, Some(1000 + seed), 0.3, 0.9);
        let found = search(&bank, USUAL, miss).locate(&there).unwrap();
        misses += u32::from(found.decision == Some(Decision::NoInclusion));
    }
    // Of 100 at 5 % more than 18 happen with the probability 5·10⁻⁷.
    assert!(alarms <= 18 && misses <= 18, "{alarms} {misses}");
    let simulated = BankSearch {
        simulations: Some((4000, 1)),
        ..search(&bank, USUAL, alarm)
    };
    let bare = record(&reference(), Some(1), 0.0, 1.0);
    let [by_bound, by_simulation] =
        [search(&bank, USUAL, alarm), simulated].map(|s| s.locate(&bare).unwrap());
    assert!(by_simulation.threshold.eta < by_bound.threshold.eta);
    let calibrated = by_simulation.threshold.calibrated.unwrap();
    assert!((calibrated.eta, calibrated.simulations) == (by_simulation.threshold.eta, 4000));
    assert!(calibrated.false_alarm.lower < 0.05 && 0.05 < calibrated.false_alarm.upper);
}

// Of 100 at 5 % more than 18 happen with the probability 5·10⁻⁷.
// Verifies: BNK-066, TRC-064.
#[test]
fn misses_keep_their_rate_within_the_tolerance_of_the_depth() {
    // A signal that grows with the cube of the depth, by a probe that is `off` (m) deeper than is said.
    let gel = |inclusion, depths: &[f64], off: f64| {
        let map = map(inclusion, depths);
        let (table, columns) = (map.table(), map.table().laterals().len());
        let normal = |row: usize, column: usize| {
            let (said, force) = (depths[row], table.normal().row(row)[column]);
            let depth = said + off;
            250.0 * depth + (force - 250.0 * said) * (depth / 4e-3).powi(3)
        };
        let normal = Matrix::from_fn(depths.len(), columns, normal);
        let forces = Force::new(table.lateral().unwrap().clone(), normal);
        let table = ForceTable::new(depths.to_vec(), table.laterals().to_vec(), forces);
        measured(map.phantom().cloned(), table.unwrap())
    };
    let (disc, around) = (Some((1.0, 4.0, 2.0)), [3.7e-3, 4e-3, 4.3e-3]);
    let shallow = gel(disc, &[4e-3], -0.3e-3);
    let misses = |depths: &[f64]| {
        let bank = Bank::new(gel(None, &around, 0.0), vec![gel(disc, depths, 0.0)]).unwrap();
        let miss = Criterion::NeymanPearsonMiss { max_miss: 0.05 };
        let mut asked = search(&bank, USUAL, miss);
        asked.question.depth_tolerance = 0.3e-3;
        let is_missed = |seed: &u64| {
            let found = asked.locate(&record(&shallow, Some(*seed), 0.0, 1.0));
            found.unwrap().decision == Some(Decision::NoInclusion)
        };
        (0..100).filter(is_missed).count()
    };
    let [around, alone] = [&around[..], &[4e-3]].map(misses);
    assert!(around <= 18 && alone > 18, "{around} {alone}");
}

// Verifies: BNK-034.
#[test]
fn a_prior_excludes_what_it_gives_no_weight() {
    let bank = all();
    let with = map(Some((1.0, 3.0, 8.0)), &[4e-3]);
    let record = record(&with, Some(3), 0.0, 1.0);
    let is_left = |number| f64::from(u8::from(bank.point(number)[0] < 0.0));
    let prior: Vec<f64> = (0..40).map(|number| is_left(number) / 16.0).collect();
    let asked = BankSearch {
        prior: Some(&prior),
        ..by_map(&bank)
    };
    let found = asked.locate(&record).unwrap();
    assert!(found.point[0] < 0.0, "{:?}", found.point);
    // Nothing of what is likeliest by far may be: the rest has all the probability, up to the next point.
    let interval = found.place.interval(0, 0.99).unwrap();
    assert!(-2e-3 <= interval.lower && interval.lower < interval.upper && interval.upper <= 0.0);
    assert!(found.place.nodes().all(|(_, mass)| mass.is_finite()));
    let all = by_map(&bank).locate(&record).unwrap();
    assert_eq!(all.point[..3], [1e-3, 3e-3, 8e-3]);
    assert!(found.theta_mixture < all.theta_mixture);
}

// Verifies: BNK-082. The rows of the maps, which the samples of the path are at, sum up another way to γ.
#[test]
fn gamma_along_a_path_is_that_of_all_its_passes() {
    use crate::simulation::Path;
    use crate::trace::gammas_along;
    let depths = [2e-3, 4e-3];
    let [without, with] = [None, Some((0.0, 3.0, 6.0))].map(|at| map(at, &depths));
    let laterals = without.table().laterals();
    let ends = [laterals[0], laterals[laterals.len() - 1]];
    let rate = (laterals.len() - 1) as f64 / (ends[1] - ends[0]);
    let sweep = Path::passes(&depths, ends, 1.0, rate)
        .unwrap()
        .sweep()
        .unwrap();
    assert_eq!(sweep.positions().len(), 2 * laterals.len());
    let gamma = |unknown: &[Unknown]| {
        let noise_sd = Force::new(0.2, 0.1);
        let over = (without.table(), [with.table()]);
        gammas_along((&sweep, 0.0), unknown, noise_sd, over.0, over).unwrap()[0]
    };
    let signal = with.table().minus(without.table()).unwrap();
    let channels = [(signal.lateral().unwrap(), 0.2), (signal.normal(), 0.1)];
    let squares = |about_mean: f64| -> f64 {
        let of = |(matrix, sd): &(&Matrix, f64)| {
            let mean = matrix.values().iter().sum::<f64>() / matrix.values().len() as f64;
            let squares = matrix
                .values()
                .iter()
                .map(|f| (f - about_mean * mean).powi(2));
            squares.sum::<f64>() / (sd * sd)
        };
        channels.iter().map(of).sum()
    };
    assert_near(gamma(&[]), squares(0.0).sqrt(), 1e-9);
    // An offset of either force takes its mean over both passes.
    assert_near(gamma(&[Unknown::Offset]), squares(1.0).sqrt(), 1e-9);
    assert!(squares(1.0) < 0.95 * squares(0.0));
}

// Verifies: BNK-080, BNK-082, BNK-071. Of a gel whose force bends with the depth the reference has more rows than the maps.
#[test]
fn an_inclusion_without_a_signal_is_not_reached_between_the_rows_of_the_maps() {
    use crate::simulation::Path;
    let gel = |inclusion, rows: &[f64]| {
        let of = map(inclusion, rows);
        let bent = |depth: f64, x: f64| [1e3 * depth * x, 2.5e5 * depth * depth];
        let table = table_of(rows, of.table().laterals(), bent);
        measured(of.phantom().cloned(), table)
    };
    let maps = [3.0, 4.0].map(|depth| gel(Some((0.0, depth, 8.0)), &[2e-3, 3e-3]));
    let reference = gel(None, &[1.7e-3, 2e-3, 2.5e-3, 3e-3, 3.3e-3]);
    let bank = Bank::new(reference, maps.into()).unwrap();
    let between = Path::passes(&[2.5e-3], [-3e-3, 3e-3], 1e-2, 100.0).unwrap();
    let sweep = between.sweep().unwrap();
    let everything = [Unknown::Offset, Unknown::Gain, Unknown::Depth];
    for unknown in [&[][..], &everything] {
        let reach = Reach {
            bank: &bank,
            sweep: &sweep,
            noise_sd: Force::new(0.02, 0.02),
            max_false_alarm: 0.01,
            max_miss: 0.05,
            unknown,
        };
        let found = reach.reached().unwrap();
        assert_eq!((&found[0].gamma[..], found[0].depth), (&[0.0; 2][..], None));
    }
}

// Verifies: BNK-070, BNK-071.
#[test]
fn reach_is_where_gamma_is_enough() {
    use crate::stats::normal::quantile;
    let bank = all();
    let sweep = bank.sweep(None).unwrap();
    let reach = |sd: f64, unknown: &'static [Unknown]| Reach {
        bank: &bank,
        sweep: &sweep,
        noise_sd: Force::new(sd, sd),
        max_false_alarm: 0.01,
        max_miss: 0.05,
        unknown,
    };
    let enough = reach(0.1, &[]).gamma().unwrap();
    assert!((enough + quantile(0.01 / 40.0).unwrap() + quantile(0.05).unwrap()).abs() < 1e-12);
    // Who may miss so many needs no signal at all.
    let careless = |max_miss| Reach {
        max_miss,
        ..reach(0.1, &[])
    };
    assert!(careless(1.0 - 0.011 / 40.0).gamma().unwrap() > 0.0);
    let refused = careless(1.0 - 0.009 / 40.0).gamma().unwrap_err();
    assert!(refused.to_string().starts_with("max_miss is "), "{refused}");
    // γ of 1e155, whose square no number holds.
    let refused = reach(1e-156, &[]).reached().unwrap_err().to_string();
    assert_eq!(refused, "gamma is too large to represent");
    let gamma = |depth: f64, diameter: f64, sd: f64| -> f64 {
        let of = map(Some((0.0, depth, diameter)), &[4e-3]);
        let one_depth = map(None, &[4e-3]);
        let signal = of.table().minus(one_depth.table()).unwrap();
        let squares = signal.normal().values().iter().map(|f| f * f);
        squares.sum::<f64>().sqrt() / sd
    };
    let found = reach(0.1, &[]).reached().unwrap();
    assert!(found.iter().map(|of| of.diameter).eq([4e-3, 8e-3]));
    for of in &found {
        for (depth, of_depth) in [3.0, 4.0, 5.0, 6.0].iter().zip(&of.gamma) {
            assert!((of_depth - gamma(*depth, 1e3 * of.diameter, 0.1)).abs() < 1e-9);
        }
    }
    // A noise at which 4 mm are found between 4 and 5 mm, and 8 mm everywhere.
    let sd = 0.1 * gamma(4.4, 4.0, 0.1) / enough;
    let found = reach(sd, &[]).reached().unwrap();
    // Where ln γ, linear from one to the other, is enough.
    let share = |from: f64, to: f64| (from / enough).ln() / (from / to).ln();
    let between = share(gamma(4.0, 4.0, sd), gamma(5.0, 4.0, sd));
    assert!(
        (found[0].depth.unwrap() - 1e-3 * (4.0 + between)).abs() < 1e-12 && !found[0].is_beyond
    );
    assert_eq!((found[1].depth, found[1].is_beyond), (Some(6e-3), true));
    let smallest = smallest_diameters(&bank, &found, enough);
    assert_eq!(smallest[0], Some(4e-3));
    let between = share(gamma(6.0, 4.0, sd), gamma(6.0, 8.0, sd));
    assert_near(smallest[3].unwrap(), 1e-3 * (4.0 + 4.0 * between), 1e-12);
    // Twice as many samples per length in the middle of the same: γ grows, and nuisances take of it.
    let beside = reach(sd, &[Unknown::Offset, Unknown::Gain]);
    let beside = beside.reached().unwrap();
    let mut pairs = beside[0].gamma.iter().zip(&found[0].gamma);
    assert!(pairs.all(|(less, all)| less < all));
    let mut many = reach(sd, &[]);
    let finer = bank.sweep(Some(49)).unwrap();
    many.sweep = &finer;
    let many = many.reached().unwrap();
    assert!((many[1].gamma[3] / found[1].gamma[3] - 2.0).abs() < 0.1);
    let noisy = reach(1e3, &[]).reached().unwrap();
    assert_eq!((noisy[0].depth, noisy[0].is_beyond), (None, false));
    assert_eq!(smallest_diameters(&bank, &noisy, enough), [None; 4]);
    let mut never = reach(0.1, &[]);
    never.max_miss = 0.0;
    assert!(never.reached().is_err());
}
