//! Sweeps that are judged while they are taken.

use std::f64::consts::PI;

use palpate_asserts::assert_near;

use super::locate::{SD, USUAL, all, deep, path, record, search};
use super::neighbours::Neighbours;
use super::*;
use crate::detect::Decision;
use crate::detect::sequential::{Evidence, Wald};
use crate::stats::binomial::clopper_pearson;
use crate::trace::{Cause, Criterion, Record, Unknown};

const TEST: [f64; 2] = [0.02, 0.05];

fn question(unknown: &[Unknown]) -> WatchQuestion {
    WatchQuestion {
        unknown: unknown.to_vec(),
        noise_sd: Force::new(SD, SD),
        is_zeroed: false,
        prior_h1: 0.25,
        prior: None,
        test: Wald::new(TEST[0], TEST[1]).unwrap(),
    }
}

/// Position, lateral force, if there is one, and normal force.
type Sample = (f64, Option<f64>, f64);

/// The samples of a record, in order.
fn samples(record: &Record) -> Vec<Sample> {
    let forces = record.forces();
    let places = record.positions().iter().enumerate();
    places
        .map(|(at, x)| (*x, forces.lateral.get(at).copied(), forces.normal[at]))
        .collect()
}

fn watched(question: &WatchQuestion, samples: impl IntoIterator<Item = Sample>) -> Watcher {
    let mut watcher = Watcher::new(&all(), question).unwrap();
    for (x, lateral, normal) in samples {
        watcher.push(x, None, lateral, normal).unwrap();
    }
    watcher
}

// Verifies: SEQ-002, SEQ-025.
#[test]
fn the_last_answer_is_that_of_the_whole_record() {
    use Unknown::{Depth, Drift, Gain, Offset};
    let bank = all();
    let with = map(Some((1.3, 3.5, 4.0)), &[4e-3]);
    let own: Vec<f64> = (0..40).map(|at| f64::from(at % 7)).collect();
    let own = times(1.0 / own.iter().sum::<f64>(), &own);
    for unknown in [
        &[][..],
        USUAL,
        &[Offset],
        &[Gain, Drift],
        &[Depth, Offset],
        &[Offset, Drift, Gain, Depth],
    ] {
        for (map, seed) in [(&with, 1), (bank.reference(), 2)] {
            let both = record(map, Some(seed), 0.0, 1.0);
            for record in [both.clone(), both.normal_alone()] {
                for prior in [None, Some(&own[..])] {
                    let mut batch = search(&bank, unknown, Criterion::MaximumAPosteriori);
                    batch.prior = prior;
                    let expected = batch.locate(&record).unwrap();
                    let question = WatchQuestion {
                        prior: prior.map(<[f64]>::to_vec),
                        ..question(unknown)
                    };
                    let samples = samples(&record);
                    // A sweep to the left is the same record.
                    for found in [
                        watched(&question, samples.iter().copied()),
                        watched(&question, samples.iter().rev().copied()),
                    ] {
                        let found = found.answer().unwrap();
                        let place = found.likeliest.unwrap();
                        let place = [
                            place.position_m,
                            place.depth_m,
                            place.diameter_m,
                            place.youngs_modulus_pa,
                        ];
                        assert_eq!(
                            (found.counts.samples, place),
                            (61, expected.point),
                            "{unknown:?}"
                        );
                        assert!(
                            (found.theta - expected.theta_mixture).abs() < 1e-9,
                            "{unknown:?} {} {}",
                            found.theta,
                            expected.theta_mixture
                        );
                        assert!((found.posterior_h1 - expected.posterior).abs() < 1e-9);
                        assert_eq!(found.causes, expected.causes);
                    }
                }
            }
        }
    }
}

// Verifies: SEQ-020, SEQ-021, SEQ-022.
#[test]
fn a_path_that_ends_early_leaves_open_what_it_has_not_covered() {
    let record = samples(&record(&reference(), Some(3), 0.2, 1.1));
    let question = question(&[Unknown::Offset, Unknown::Gain]);
    let half = watched(&question, record[..30].iter().copied())
        .answer()
        .unwrap();
    assert_eq!(
        (half.decision, half.places, half.causes.len()),
        (None, 40, 0)
    );
    assert!(half.covered > 0 && half.excluded > 0, "{half:?}");
    // 30 samples over −3 … −0.1 mm.
    assert_eq!(half.uncovered_positions_m.last(), Some(&2e-3));
    for position in &half.uncovered_positions_m {
        assert!(half.open_positions_m.contains(position));
    }
    let whole = watched(&question, record.iter().copied()).answer().unwrap();
    assert_eq!(whole.decision, Some(Decision::NoInclusion));
    assert_eq!([whole.places, whole.covered, whole.excluded], [40; 3]);
    assert!(whole.open_positions_m.is_empty() && whole.uncovered_positions_m.is_empty());
    assert!(
        whole
            .decided_at_sample
            .is_some_and(|sample| sample > 30 && sample <= 61)
    );
    // The first that could: what came before leaves places open.
    let before = whole.decided_at_sample.unwrap() - 1;
    let before = watched(&question, record[..before].iter().copied())
        .answer()
        .unwrap();
    assert_eq!(before.decision, None);
    assert!(before.excluded < 40);
    // Places that cannot be need no coverage.
    let mut left = vec![0.0; 40];
    for diameter in 0..2 {
        left[20 * diameter] = 0.5;
    }
    let left = WatchQuestion {
        prior: Some(left),
        ..question.clone()
    };
    let half = watched(&left, record[..40].iter().copied())
        .answer()
        .unwrap();
    assert_eq!(
        (half.decision, half.places),
        (Some(Decision::NoInclusion), 2)
    );
}

// A record of which θ is below ln β at a place of which the path has told little: −6 − γ²/2 and noise of γ below −3, with γ² below 6.
// Verifies: SEQ-021.
#[test]
fn a_place_that_the_path_has_not_covered_is_not_excluded_by_chance() {
    let (bank, question) = (all(), question(&[]));
    let gel = samples(&record(&reference(), Some(8), 0.0, 1.0));
    let (place, end) = (0..40)
        .flat_map(|place| (1..61).map(move |end| (place, end)))
        .find(|&(place, end)| {
            let watcher = watched(&question, gel[..end].iter().copied());
            let evidence = watcher.found.evidence().nth(place);
            end > 20 && evidence.is_some_and(|of| (2.0..5.0).contains(&of.gamma_squared))
        })
        .unwrap();
    let evidence = |samples: &[Sample]| {
        let watcher = watched(&question, samples.iter().copied());
        let found = watcher.found.evidence().nth(place).unwrap();
        (found, watcher.answer().unwrap())
    };
    let (before, _) = evidence(&gel[..end]);
    let difference = |x: f64| {
        let force = |map: &ForceMap| map.table().sweep(4e-3, &[x]).unwrap();
        let (with, without) = (force(&bank.maps()[place]), force(bank.reference()));
        [
            with.lateral[0] - without.lateral[0],
            with.normal[0] - without.normal[0],
        ]
    };
    let times = -6.0 / before.gamma_squared;
    let drawn: Vec<Sample> = gel[..end]
        .iter()
        .map(|&(x, lateral, normal)| {
            let [of_lateral, of_normal] = difference(x);
            (
                x,
                lateral.map(|force| force + times * of_lateral),
                normal + times * of_normal,
            )
        })
        .collect();
    let (found, answer) = evidence(&drawn);
    assert!(
        found.theta() < TEST[1].ln() && answer.causes.is_empty(),
        "{found:?} {answer:?}"
    );
    let position = bank.point(place)[0];
    assert!(answer.open_positions_m.contains(&position));
    // Only the places of which it has told enough.
    let bound = TEST[1].ln();
    let watcher = watched(&question, drawn);
    let is_excluded = |of: &Evidence| of.theta() <= bound && of.gamma_squared >= -2.0 * bound;
    let excluded = watcher.found.evidence().filter(is_excluded);
    assert_eq!(answer.excluded, excluded.count());
}

// Verifies: SEQ-020, SEQ-022.
#[test]
fn an_inclusion_is_told_before_the_sweep_is_over_and_stays_told() {
    let bank = all();
    // At −1 mm, 4 mm deep, 8 mm wide.
    let place = (0..40)
        .find(|&map| bank.point(map)[..3] == [-1e-3, 4e-3, 8e-3])
        .unwrap();
    let record = samples(&record(&bank.maps()[place], Some(4), 0.2, 1.1));
    let mut watcher = watched(&question(USUAL), None);
    let mut told = None;
    for (at, (x, lateral, normal)) in (1..).zip(record) {
        watcher.push(x, None, lateral, normal).unwrap();
        let found = watcher.answer().unwrap();
        if told.is_none() && found.decision.is_some() {
            told = Some(at);
            assert!(found.theta >= -TEST[0].ln());
        }
        let expected = told.map(|_| Decision::Inclusion);
        assert_eq!((found.decision, found.decided_at_sample), (expected, told));
    }
    assert!(told.is_some_and(|at| at < 40), "{told:?}");
    let found = watcher.answer().unwrap().likeliest.unwrap();
    assert_eq!(
        (found.position_m, found.depth_m, found.diameter_m),
        (-1e-3, 4e-3, 8e-3)
    );
    assert!(found.probability > 0.5 && found.probability <= 1.0);
}

// Verifies: SEQ-024.
#[test]
fn samples_that_are_missing_or_outside_are_counted_and_change_nothing() {
    let record = samples(&record(&reference(), Some(5), 0.2, 1.1));
    let question = question(USUAL);
    let mut holed = Vec::new();
    let nan = f64::NAN;
    for (at, &(x, lateral, normal)) in record.iter().enumerate() {
        holed.extend(
            [
                (x, Some(nan), normal),
                (nan, lateral, normal),
                (x, lateral, nan),
            ]
            .get(at),
        );
        holed.extend([(3.1e-3, lateral, normal), (-3.1e-3, lateral, normal)].get(at));
        holed.push((x, lateral, normal));
    }
    let (found, expected) = (
        watched(&question, holed).answer().unwrap(),
        watched(&question, record).answer().unwrap(),
    );
    let counts = |missing, outside| SampleCounts {
        samples: 61,
        missing,
        outside,
    };
    assert_eq!(
        (found.counts, expected.counts),
        (counts(3, 2), counts(0, 0))
    );
    let counts = expected.counts;
    assert_eq!(WatchAnswer { counts, ..found }, expected);
}

// Verifies: SEQ-023.
#[test]
fn a_record_that_no_hypothesis_explains_is_not_answered() {
    let gel = samples(&record(&reference(), Some(6), 0.0, 1.0));
    let air: Vec<_> = gel
        .iter()
        .map(|&(x, lateral, normal)| (x, lateral, normal - 1.0))
        .collect();
    let question = question(&[Unknown::Offset]);
    let all = watched(&question, air.iter().copied()).answer().unwrap();
    assert_eq!(
        (all.causes.as_slice(), all.decision, all.excluded),
        (&[Cause::NoContact][..], None, 0)
    );
    assert_eq!((all.covered, all.open_positions_m.len()), (40, 5));
    // The same sweep in the other sign, or in mN: the gain would take what is wrong, and nothing speaks for an inclusion.
    for (factor, cause) in [(-1.0_f64, Cause::Sign), (1e3, Cause::ForceUnit)] {
        let unknown = [Unknown::Offset, Unknown::Drift, Unknown::Gain];
        let question = WatchQuestion {
            noise_sd: Force::new(factor.abs() * SD, factor.abs() * SD),
            ..self::question(&unknown)
        };
        let scaled = |&(x, lateral, normal): &Sample| {
            (x, lateral.map(|force| factor * force), factor * normal)
        };
        let found = watched(&question, gel.iter().map(scaled)).answer().unwrap();
        assert_eq!(
            (found.causes.as_slice(), found.decision, found.excluded),
            (&[cause][..], None, 0)
        );
    }
    let zeroed = WatchQuestion {
        is_zeroed: true,
        ..question.clone()
    };
    // The same in air as on the gel: nothing speaks against either.
    let on_gel = watched(&zeroed, air.iter().copied()).answer().unwrap();
    assert_eq!(on_gel.causes, [Cause::Zeroed]);
    // The probe comes down at 0: a step.
    let step: Vec<_> = air[..30].iter().chain(&gel[30..]).copied().collect();
    let found = watched(&zeroed, step).answer().unwrap();
    assert_eq!(
        (found.causes.as_slice(), found.decision),
        (&[Cause::Misfit][..], None)
    );
    // A noise that is stated three times too large, after 122 rows: R is ν/9, and the limit is ν − 2 √(14.5 ν) = ν/3.
    let noise_sd = Force::new(3.0 * SD, 3.0 * SD);
    let quiet = watched(
        &WatchQuestion {
            noise_sd,
            ..question.clone()
        },
        gel.iter().copied(),
    );
    assert_eq!(quiet.answer().unwrap().causes, [Cause::Misfit]);
    // An answer that was given is withheld while the record does not fit.
    let mut watcher = watched(&question, gel.iter().copied());
    assert_eq!(
        watcher.answer().unwrap().decision,
        Some(Decision::NoInclusion)
    );
    for (x, lateral, normal) in air.iter().rev().take(40).copied() {
        watcher.push(x, None, lateral, normal).unwrap();
    }
    let found = watcher.answer().unwrap();
    assert_eq!(
        (
            found.decision,
            found.decided_at_sample,
            found.causes.as_slice()
        ),
        (None, None, &[Cause::Misfit][..])
    );
}

// Verifies: SEQ-023.
#[test]
fn a_lateral_force_of_the_other_sign_hides_no_inclusion() {
    // Beside the bump of the normal force, one of the lateral force that goes from one sign to the other.
    let sideways = |map: ForceMap, size: f64| {
        let table = map.table();
        let (depths, laterals) = (table.depths().to_vec(), table.laterals().to_vec());
        let lateral = Matrix::from_fn(depths.len(), laterals.len(), |_, column| {
            let from: f64 = laterals[column] / 0.9e-3;
            size * from * (-0.5 * from * from).exp()
        });
        let forces = Force::new(lateral, table.normal().clone());
        let table = ForceTable::new(depths, laterals, forces).unwrap();
        measured(map.phantom().cloned(), table)
    };
    let inclusion = sideways(map(Some((0.0, 4.0, 8.0)), &[4e-3]), 0.6);
    let reference = sideways(map(None, &[4e-3]), 0.0);
    let bank = Bank::new(reference, vec![inclusion.clone()]).unwrap();
    let exact = samples(&record(&inclusion, None, 0.0, 1.0));
    let question = WatchQuestion {
        noise_sd: Force::new(0.05, 0.4),
        ..question(USUAL)
    };
    let taken = |sign: f64| {
        let mut watcher = Watcher::new(&bank, &question).unwrap();
        let noise = |channel, at| Generator::new(8, channel).normal(0, at);
        for (at, (x, lateral, normal)) in (0..).zip(exact.iter().copied()) {
            let lateral = lateral.map(|force| sign * (force + 0.05 * noise(0, at)));
            watcher
                .push(x, None, lateral, normal + 0.4 * noise(1, at))
                .unwrap();
        }
        watcher.answer().unwrap()
    };
    assert_eq!(taken(1.0).decision, Some(Decision::Inclusion));
    let found = taken(-1.0);
    assert_eq!(
        (found.decision, found.excluded, &found.causes[..]),
        (None, 0, &[Cause::Channels][..])
    );
}

// Verifies: SEQ-020, SEQ-021, SEQ-022, SEQ-023, SEQ-026.
#[test]
fn a_sensor_set_to_zero_never_excludes_a_place() {
    let bank = all();
    let zeroed = WatchQuestion {
        is_zeroed: true,
        ..question(&[Unknown::Offset, Unknown::Gain])
    };
    // In air, where the noise is alone, and on the gel.
    for gain in [0.0, 1.1] {
        let nothing = samples(&record(&reference(), Some(3), 0.2, gain));
        let half = watched(&zeroed, nothing[..30].iter().copied());
        let half = half.answer().unwrap();
        assert_eq!(
            (half.decision, half.excluded, half.causes.len()),
            (None, 0, 0)
        );
        let whole = watched(&zeroed, nothing);
        let told: Vec<Told> = whole.places().iter().map(|place| place.told).collect();
        assert_eq!(told, [Told::Open; 40]);
        let found = whole.answer().unwrap();
        assert_eq!(
            (found.decision, &found.causes[..]),
            (None, &[Cause::Zeroed][..])
        );
        assert_eq!((found.covered, found.excluded), (40, 0));
        assert_eq!(found.open_positions_m.len(), 5);
    }
    let with = map(Some((-1.0, 4.0, 8.0)), &[4e-3]);
    let with = samples(&record(&with, Some(4), -1.2, 1.1));
    let found = watched(&zeroed, with).answer().unwrap();
    assert_eq!(
        (found.decision, &found.causes[..]),
        (Some(Decision::Inclusion), &[][..])
    );
    assert_eq!(found.excluded, 0);
    assert_eq!(bank.maps().len(), found.places);
}

// The first pass is over an inclusion; the second takes its force back, and the others are over a gel without one.
// Verifies: SEQ-020, SEQ-023.
#[test]
fn an_inclusion_is_withheld_once_every_place_is_excluded() {
    let sd = 0.3;
    let zeroed = WatchQuestion {
        is_zeroed: true,
        noise_sd: Force::new(sd, sd),
        ..question(&[Unknown::Offset])
    };
    let (with, without) = (map(Some((0.0, 3.0, 8.0)), &[4e-3]), reference());
    let exact = |map: &ForceMap| samples(&record(map, None, -1.0, 1.0));
    let (with, without) = (exact(&with), exact(&without));
    let mut watcher = watched(&zeroed, None);
    let mut noise = vec![0.0; 2 * with.len()];
    let bound = TEST[1].ln();
    let is_excluded = |of: Evidence| of.theta() <= bound && of.gamma_squared >= -2.0 * bound;
    let mut withheld = 0;
    for pass in 0..12 {
        Generator::new(20_261_128, 0).normals(pass, 0, &mut noise);
        let share = [1.0, -1.0].get(pass as usize).unwrap_or(&0.0);
        for (at, (with, without)) in with.iter().zip(&without).enumerate() {
            let normal = without.2 + share * (with.2 - without.2) + sd * noise[2 * at];
            let lateral = Some(sd * noise[2 * at + 1]);
            watcher.push(with.0, None, lateral, normal).unwrap();
        }
        let found = watcher.answer().unwrap();
        // No hypothesis explains both.
        let is_none = watcher.found.evidence().all(is_excluded);
        let expected = match is_none {
            true => (None, &[Cause::Misfit][..]),
            false => (Some(Decision::Inclusion), &[][..]),
        };
        assert_eq!((found.decision, &*found.causes), expected, "{pass}");
        withheld += usize::from(is_none);
    }
    assert!((1..12).contains(&withheld), "{withheld}");
}

// Verifies: SEQ-002.
#[test]
fn what_cannot_be_watched_is_refused() {
    let (bank, usual) = (all(), question(USUAL));
    type Change = fn(&mut WatchQuestion);
    let changes: [(Change, &str); 6] = [
        (
            |of| of.unknown = vec![Unknown::Offset, Unknown::Variance],
            "cannot be estimated",
        ),
        (|of| of.noise_sd.normal = 0.0, "noise_sd_normal_n"),
        (|of| of.noise_sd.lateral = 1e-60, "1e50"),
        (|of| of.prior_h1 = 1.0, "prior_h1"),
        (|of| of.prior = Some(vec![1.0]), "prior"),
        (|of| of.prior = Some(vec![0.1; 40]), "prior"),
    ];
    for (change, words) in changes {
        let mut question = usual.clone();
        change(&mut question);
        let error = Watcher::new(&bank, &question).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let single = Bank::new(map(None, &[4e-3]), maps()).unwrap();
    let question = WatchQuestion {
        unknown: vec![Unknown::Depth],
        ..usual.clone()
    };
    assert!(
        Watcher::new(&single, &question)
            .unwrap_err()
            .to_string()
            .contains("single depth")
    );
    let mut watcher = Watcher::new(&bank, &usual).unwrap();
    for (x, lateral, normal) in [
        (f64::INFINITY, 0.0, 1.0),
        (0.0, f64::NEG_INFINITY, 1.0),
        (0.0, 0.0, 1e60),
        (f64::NAN, 0.0, f64::INFINITY),
    ] {
        assert!(watcher.push(x, None, Some(lateral), normal).is_err());
    }
    let found = watcher.answer().unwrap();
    assert_eq!(
        (
            found.counts.samples,
            found.counts.missing,
            found.theta,
            found.posterior_h1
        ),
        (0, 0, 0.0, 0.25)
    );
    // Named twice is named once.
    let twice = [Unknown::Offset; 9];
    let mut watcher = Watcher::new(
        &bank,
        &WatchQuestion {
            unknown: twice.to_vec(),
            ..usual.clone()
        },
    )
    .unwrap();
    watcher.push(0.0, None, Some(0.0), 1.0).unwrap();
}

// The mean of exp(ρP − ρ²A/2) over ρ ~ N(0, 1/10) by sums of steps of 0.001 over ±5, which lose e^−125;
// 10,001 roundings of 2⁻⁵³ of the sum would all have to be alike to lose 10⁻¹².
// Verifies: SEQ-027, NUI-022.
#[test]
fn neighbours_that_are_alike_speak_for_correlated_noise() {
    let left = |row: u64, place: u64| Generator::new(71, place).normal(0, row) + 0.4;
    let (mut found, mut expected) = (Neighbours::new(2), [[0.0; 2]; 3]);
    for row in 0..60 {
        let without = left(row, 0);
        let signals = [1, 2].map(|place| without - left(row, place));
        let innovation = [without, signals[0], signals[1]];
        found.push((row % 2) as usize, innovation.into_iter());
        for (place, [products, squares]) in (0..).zip(&mut expected) {
            *squares += left(row, place).powi(2);
            if row >= 2 {
                *products += left(row, place) * left(row - 2, place);
            }
        }
    }
    for (place, [products, squares]) in [None, Some(0), Some(1)].into_iter().zip(expected) {
        let at = |step: i32| {
            let correlation = 1e-3 * f64::from(step);
            let prior = (-5.0 * correlation * correlation).exp() * (5.0 / PI).sqrt();
            1e-3 * prior * (correlation * (products - 0.5 * correlation * squares)).exp()
        };
        let mean: f64 = (-5000..=5000).map(at).sum();
        assert_near(found.theta(place, squares), mean.ln(), 1e-12);
    }
}

/// How often sweeps were answered so, and what else came of them.
#[derive(Debug, Default)]
struct Answers {
    inclusion: u64,
    none: u64,
    /// The place of the inclusion was excluded at some sample.
    excluded: u64,
    /// The noise was called correlated at some sample.
    coloured: u64,
    /// "Inclusion" was the answer at some sample; counted in correlated noise alone, as an answer takes long.
    told: u64,
}

/// The answers to so many sweeps back and forth, of so many samples each, over a gel with the inclusion of a map, or none, in noise of
/// 0.4 N of this correlation between neighbours.
fn answers(trials: u64, map: Option<usize>, samples: i32, correlation: f64) -> Answers {
    let (bank, sd) = (all(), 0.4);
    let question = WatchQuestion {
        noise_sd: Force::new(sd, sd),
        ..question(USUAL)
    };
    let fresh = Watcher::new(&bank, &question).unwrap();
    let table = map.map_or(&bank.reference, |map| &bank.maps()[map]).table();
    let path = (0..samples).map(|k| 1e-4 * f64::from((k % 120 - 60_i32).abs() - 30));
    let path: Vec<f64> = path.collect();
    let exact = table.sweep(4e-3, &path).unwrap();
    let generator = Generator::new(20_261_126, map.map_or(0, |map| map as u64 + 1));
    let (mut noise, mut answers) = (vec![0.0; 2 * path.len()], Answers::default());
    for trial in 0..trials {
        generator.normals(trial, 0, &mut noise);
        for at in 2..noise.len() {
            noise[at] =
                correlation * noise[at - 2] + (1.0 - correlation * correlation).sqrt() * noise[at];
        }
        let mut watcher = fresh.clone();
        let [mut is_excluded, mut is_coloured, mut is_told] = [false; 3];
        for (at, x) in path.iter().enumerate() {
            let normal = 1.1 * exact.normal[at] + 0.2 + sd * noise[2 * at];
            let lateral = Some(sd * noise[2 * at + 1]);
            watcher.push(*x, None, lateral, normal).unwrap();
            let there = map.and_then(|map| watcher.found.evidence().nth(map));
            is_excluded |= there.is_some_and(|of| watcher.is_excluded(of));
            is_coloured |= watcher.is_coloured();
            is_told |= correlation > 0.0
                && watcher.answer().unwrap().decision == Some(Decision::Inclusion);
        }
        let decision = watcher.answer().unwrap().decision;
        answers.inclusion += u64::from(decision == Some(Decision::Inclusion));
        answers.none += u64::from(decision == Some(Decision::NoInclusion));
        answers.excluded += u64::from(is_excluded);
        answers.coloured += u64::from(is_coloured);
        answers.told += u64::from(is_told);
    }
    answers
}

/// Checks the rates by the ends of their 99 % intervals, and that those of false answers are no smaller than a tenth of what is stated: a
/// bound that is never reached shows nothing.
fn check_rates(trials: u64) {
    let rate = |count| clopper_pearson(count, trials, 0.99).unwrap();
    let without = answers(trials, None, 240, 0.0);
    println!("without: {without:?} of {trials}");
    assert!(rate(without.inclusion).upper <= TEST[0], "{without:?}");
    assert!(
        rate(without.inclusion).upper >= 0.1 * TEST[0],
        "{without:?}"
    );
    assert!(rate(without.coloured).lower <= 1e-3, "{without:?}");
    // In the middle, 4 mm wide, 3 and 4 mm deep.
    for map in [2, 7] {
        let with = answers(trials, Some(map), 240, 0.0);
        println!("with {map}: {with:?} of {trials}");
        assert!(
            with.none <= with.excluded && rate(with.excluded).upper <= TEST[1],
            "{with:?}"
        );
        assert!(rate(with.excluded).upper >= 0.1 * TEST[1], "{with:?}");
        assert!(rate(with.coloured).lower <= 1e-3, "{with:?}");
    }
}

// After 480 rows, θ_c is ln 1,000 for P/A = 0.19, which with a correlation of 0.5 is 7.7 standard deviations √(0.75/480) below P/A. Some answers
// begin before that.
// Verifies: SEQ-023, SEQ-027.
#[test]
fn no_answer_stays_in_noise_that_is_seen_to_be_correlated() {
    let found = answers(200, None, 240, 0.5);
    println!("{found:?}");
    assert_eq!((found.inclusion, found.none, found.coloured), (0, 0, 200));
    assert!(found.told > 0, "{found:?}");
}

// Verifies: SEQ-020, SEQ-021.
#[test]
fn false_answers_are_as_rare_as_stated_however_often_one_looks() {
    check_rates(2000);
}

// Takes minutes.
// Verifies: SEQ-020, SEQ-021.
#[test]
#[ignore = "100,000 records of each kind"]
fn false_answers_of_many_records_are_as_rare_as_stated() {
    check_rates(100_000);
}

// Verifies: SEQ-030, SEQ-025, SEQ-031, SEQ-024.
#[test]
fn samples_at_depths_of_their_own_have_the_last_answer_of_the_whole_record() {
    use Unknown::{Depth, Drift, Gain, Offset};
    let bank = deep();
    for unknown in [
        &[][..],
        USUAL,
        &[Depth, Offset],
        &[Offset, Drift, Gain, Depth],
    ] {
        for (x, seed) in [(Some(1.3), 4), (None, 5)] {
            let record = path(&bank, x, Some(seed));
            let batch = search(&bank, unknown, Criterion::MaximumAPosteriori);
            let expected = batch.locate(&record).unwrap();
            let mut watcher = Watcher::new(&bank, &question(unknown)).unwrap();
            let depths = record.depths().unwrap();
            for ((x, lateral, normal), depth) in samples(&record).into_iter().zip(depths) {
                watcher.push(x, Some(*depth), lateral, normal).unwrap();
            }
            let found = watcher.answer().unwrap();
            let off = (found.theta - expected.theta_mixture).abs();
            assert!(off < 1e-9, "{unknown:?}: {off:e}");
            // Too deep for the bank, and no depth at all.
            watcher.push(0.0, Some(4.5e-3), Some(0.0), 1.0).unwrap();
            watcher.push(0.0, Some(f64::NAN), Some(0.0), 1.0).unwrap();
            let error = watcher
                .push(0.0, None, Some(0.0), 1.0)
                .unwrap_err()
                .to_string();
            assert!(error.contains("the bank has several depths"), "{error}");
            let after = watcher.answer().unwrap();
            assert_eq!((after.counts.outside, after.counts.missing), (1, 1));
            let samples = [&after, &found].map(|of| of.counts.samples);
            assert_eq!((after.theta, samples[0]), (found.theta, samples[1]));
        }
    }
}
