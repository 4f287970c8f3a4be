//! The parts of the robust detector, each against another way to the same number.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::classes::{CLASSES, Covariance, Disturbances, Part, Undisturbed};
use super::detector::joined;
use super::evidence::{Signal, WeightedClass, evidence};
use super::explanation::fitted;
use super::gates::{is_saturated, is_stuck, step, without_glitches};
use super::modes::Modes;
use super::{
    BankHypotheses, GelChanges, GelUncertainty, RobustAnswer, RobustDetector, RobustPlace,
    RobustQuestion, RobustSignal, RobustSweep,
};
use crate::bank::{Bank, BankPlan};
use crate::detect::Decision;
use crate::fem::{Contact, Model};
use crate::force::Force;
use crate::force_map::tests::{measured, table_of};
use crate::force_map::{ForceMap, ForceTable, Hypotheses};
use crate::phantom::Phantom;
use crate::stats::random::Generator;
use crate::trace::contact::wrong_level;
use crate::trace::{Cause, Record};
use palpate_asserts::assert_near;

mod samples;

fn positions(samples: usize) -> Vec<f64> {
    let step = 16e-3 / (samples - 1) as f64;
    (0..samples).map(|k| step * k as f64 - 8e-3).collect()
}

fn modes(samples: usize) -> Modes {
    Modes::new(&positions(samples), 6.5e-3, false)
}

fn noise(samples: usize, trial: u64) -> Vec<f64> {
    let mut noise = vec![0.0; samples];
    Generator::new(1, 0).normals(trial, 0, &mut noise);
    noise
}

/// Forces in noise of this standard deviation, N, of these trials.
fn noisy(forces: Force<Vec<f64>>, sd: f64, [lateral, normal]: [u64; 2]) -> Force<Vec<f64>> {
    let channels = forces.zip(Force::new(lateral, normal));
    channels.map(|(channel, trial)| {
        let pairs = channel.iter().zip(noise(channel.len(), trial));
        pairs.map(|(force, noise)| force + sd * noise).collect()
    })
}

// SciPy's multivariate_normal.logpdf with dense covariances, plus 2 ln 2π.
// Verifies: ROB-031, ROB-032.
#[test]
fn evidence_is_that_of_dense_normal_laws() {
    let record = DVector::from_vec(vec![1.0, -0.5, 2.0, 0.25]);
    let own = DVector::from_vec(vec![0.25, 0.5, 1.0, 2.0]);
    #[rustfmt::skip]
    let one = DMatrix::from_row_slice(4, 4, &[
        2.0, 1.0, 0.0, 0.0,
        1.0, 2.0, 0.5, 0.0,
        0.0, 0.5, 1.0, 0.25,
        0.0, 0.0, 0.25, 1.0,
    ]);
    let other = DMatrix::from_diagonal(&DVector::from_vec(vec![4.0, 1.0, 1.0, 0.5]));
    let shape = DMatrix::from_diagonal(&DVector::from_vec(vec![0.25, 0.25, 1.0, 1.0]));
    let signal = |mean: [f64; 4], size, prior: f64| Signal {
        mean: DVector::from_column_slice(&mean),
        size,
        amplitude_sd: 0.4,
        log_prior: prior.ln(),
    };
    let signals = [
        signal([1.0, 0.0, 2.0, 0.5], 2.0, 0.75),
        signal([0.0, -1.0, 1.0, 1.0], 0.5, 0.25),
    ];
    let classes = [(3.0, one), (1.0, other)];
    let classes = classes.map(|(weight, covariance)| WeightedClass { weight, covariance });
    let other = &record * 2.0;
    let found = evidence([&other, &record], &own, &classes, &signals, &shape);
    let ([_, found], _) = found.unwrap();
    for (found, expected) in [
        (found.without, [-3.6753127483705823, -4.330685755016049]),
        (found.with, [-1.9559298058616992, -2.3567653216572255]),
        (found.by_class, [-2.3080557626350013, -3.4965484838491694]),
    ] {
        for (found, expected) in found.into_iter().zip(expected) {
            // Condition numbers are below 10; some tens of operations.
            assert_near(found, expected, 1e-13);
        }
    }
}

// The nearest of eight sizes in equal ratios stands for a size.
// Verifies: ROB-031.
#[test]
fn signals_of_nearly_one_size_have_one_shape() {
    let of = |values: [f64; 2]| DVector::from_column_slice(&values);
    // The seventh part of the way from 1 to 2 is a step.
    let with = |steps: f64| {
        let signal = |steps: f64| Signal {
            mean: of([1.0, -0.5]),
            size: (steps * 2f64.ln() / 7.0).exp(),
            amplitude_sd: 0.4,
            log_prior: 0.0,
        };
        let signals = [0.0, steps, 7.0].map(signal);
        let class = WeightedClass {
            weight: 1.0,
            covariance: DMatrix::identity(2, 2),
        };
        let shape = DMatrix::from_diagonal_element(2, 2, 100.0);
        let (record, noise) = (of([2.0, 1.0]), of([1.0, 1.0]));
        let found = evidence([&record], &noise, &[class], &signals, &shape);
        let ([found], _) = found.unwrap();
        found.with[1]
    };
    for near in [3.6, 4.4] {
        assert_eq!(with(near), with(4.0));
    }
    assert!(with(3.4) != with(4.0) && with(4.6) != with(4.0));
}

// Verifies: ROB-010.
#[test]
fn modes_are_orthonormal_and_hold_whatever_is_smooth() {
    let modes = modes(161);
    assert_eq!(modes.count(), 16);
    let identity = modes.covariance(|i, j| f64::from(i == j));
    let off = (identity - DMatrix::<f64>::identity(16, 16)).amax();
    assert!(off < 1e-14, "{off:e}");
    // A bump with the standard deviation of a deep disc's signal, and a line, are left with less than two thousandths.
    let bump = |x: &f64| (-0.5 * (x / 2.5e-3) * (x / 2.5e-3)).exp() + 100.0 * x;
    let bump: Vec<f64> = positions(161).iter().map(bump).collect();
    let left = modes
        .residual(&bump)
        .into_iter()
        .fold(0.0, |most: f64, left| most.max(left.abs()));
    assert!(left < 2e-3, "{left:e}");
    // With stated noise, 17 samples give more modes: 75 % instead of 40 %.
    let few = [false, true].map(|stated| Modes::new(&positions(17), 6.5e-3, stated).count());
    assert_eq!(few, [6, 12]);
}

// Verifies: ROB-011.
#[test]
fn noise_is_estimated_beside_any_smooth_record() {
    let modes = modes(161);
    let (mut white, mut slow) = (0.0, 0.0);
    for trial in 0..40 {
        let smooth = |x: f64| 1.5 + 0.5 * (300.0 * x).sin();
        let noise = noise(161, trial);
        let record = |noise: &[f64]| -> Vec<f64> {
            positions(161)
                .iter()
                .zip(noise)
                .map(|(x, n)| smooth(*x) + 0.1 * n)
                .collect()
        };
        white += modes.noise(&record(&noise), 0.0, false).of_modes[0] / 40.0;
        // A low pass of the first order with a = 0.8: the power at frequency 0 is 1/(1 − a)² of white noise's.
        let mut held = 0.0;
        let low: Vec<f64> = noise
            .iter()
            .map(|n| {
                held = 0.8 * held + n;
                held
            })
            .collect();
        slow += modes.noise(&record(&low), 0.0, false).of_modes[0] / 40.0;
        // Noise that is called white has the same power everywhere.
        let called = modes.noise(&record(&low), 0.0, true);
        assert_eq!(called.of_modes, vec![called.of_modes[0]; modes.count()]);
    }
    // 144 powers of each of 40 records: a standard deviation of 2 %.
    assert_near(white, 0.01, 0.001);
    // Of slow noise only the tail is beyond the modes: the corner, and so the power at 0, may be any that has this tail.
    assert!((0.06..4.0).contains(&slow), "{slow}");
    // A coarse converter has q²/12, also where no sample changes.
    assert_near(
        modes.noise(&[1.5; 161], 0.12, false).variance,
        0.0012,
        1e-12,
    );
}

// Verifies: ROB-001, ROB-002, ROB-003.
#[test]
fn broken_sensors_are_seen_and_coarse_ones_pass() {
    let mut channel = noise(161, 0);
    assert!(!is_saturated(&channel));
    let coarse: Vec<f64> = channel.iter().map(|v| v.round()).collect();
    assert!(!is_saturated(&coarse) && step(&coarse) == 1.0);
    let capped: Vec<f64> = channel.iter().map(|v| v.min(1.0)).collect();
    assert!(is_saturated(&capped));
    let raised: Vec<f64> = channel.iter().map(|v| v.max(-1.0)).collect();
    assert!(is_saturated(&raised));
    assert!(is_saturated(&[0.5; 161]) && !is_saturated(&[0.5; 3]) && !is_saturated(&[]));
    // A coarse converter shows one value most of the time, a stuck one nearly all of it.
    let most = |count: usize| -> Vec<f64> {
        let value = |at: usize| {
            if at < count {
                1.5
            } else {
                1.5 + 0.1 * at as f64
            }
        };
        (0..161).map(value).collect()
    };
    assert_eq!(
        [140, 152, 153, 161].map(|count| is_stuck(&most(count))),
        [false, false, true, true]
    );
    let of_few = |count: usize, samples: usize| is_stuck(&most(count)[..samples]);
    assert_eq!(
        [(9, 10), (18, 20), (19, 20)].map(|(count, samples)| of_few(count, samples)),
        [false, false, true]
    );
    let modes = modes(161);
    assert_eq!(without_glitches(&modes, &mut channel.clone(), 0.0), Some(0));
    let own = channel[70];
    channel[70] += 30.0;
    assert_eq!(without_glitches(&modes, &mut channel, 0.0), Some(1));
    assert!((channel[70] - own).abs() < 5.0, "{}", channel[70]);
    // Each far from those that are left when the larger ones are replaced: nine are more than 8, 5 %.
    for (at, size) in (0..9).map(|k| (10 + 15 * k, 30.0 * 4.0_f64.powi(k as i32))) {
        channel[at] += size;
    }
    assert_eq!(without_glitches(&modes, &mut channel, 0.0), None);
    let levels = [1e3, 102.0, 3.0, 1.83, 0.57, 0.2, -0.2, -1.0];
    let causes = [
        Some(Cause::ForceUnit),
        Some(Cause::ForceUnit),
        Some(Cause::Level),
        None,
        None,
        Some(Cause::NoContact),
        Some(Cause::NoContact),
        Some(Cause::Sign),
    ];
    assert_eq!(levels.map(wrong_level), causes);
}

// Verifies: ROB-047.
#[test]
fn what_helps_is_that_of_the_first_part() {
    for class in CLASSES {
        let words = match class.name {
            "the gel is tilted" => "another sweep of the place,",
            name if name.starts_with("the surface ") => "another sweep of the place,",
            "the gel is another"
            | "the gel is another, and off smoothly"
            | "walls or floor are loose" => "a reference sweep,",
            name if name.starts_with("several") => "a reference sweep,",
            _ => "more sweeps of the place,",
        };
        assert!(class.remedy().starts_with(words), "{}", class.name);
    }
}

// Verifies: ROB-050.
#[test]
fn what_is_known_leaves_the_classes() {
    let left = |known: &[Part]| {
        CLASSES
            .iter()
            .filter_map(|class| class.parts(known))
            .collect::<Vec<_>>()
    };
    assert_eq!(left(&[]).len(), CLASSES.len());
    let all = left(&Part::KNOWN);
    assert_eq!(
        all,
        [vec![(Part::Smooth, 0.002)], vec![(Part::Smooth, 0.005)]]
    );
    // Both classes of friction alone go; where the gel relaxes too, that stays.
    let without = left(&[Part::Friction]);
    assert_eq!(without.len(), CLASSES.len() - 2);
    let parts: Vec<Part> = without.concat().into_iter().map(|(part, _)| part).collect();
    assert!(!parts.contains(&Part::Friction) && !parts.contains(&Part::UnevenFriction));
    assert!(parts.contains(&Part::Relaxation));
    // Each part has the name of one that can be known.
    let names =
        [Part::Broad, Part::Bump(1), Part::Waves(0), Part::Sway(0)].map(|of| of.to_string());
    assert_eq!(names, ["smooth", "surface", "surface", "walk"]);
    // Who knows the surface knows its waves, and who knows that the sensor does not walk, that it does not sway.
    for (known, classes) in [(Part::Surface, 15), (Part::Walk, 11)] {
        assert_eq!(left(&[known]).len(), CLASSES.len() - classes);
    }
}

// Verifies: ROB-021, ROB-022, ROB-023, ROB-024, ROB-025, ROB-081, ROB-082.
#[test]
fn parts_and_classes_are_those_of_the_tables() {
    let (samples, radius, level) = (41, 6.5e-3, 2.0);
    let modes = modes(samples);
    let both = |lateral: f64, normal: f64| [vec![lateral; samples], vec![normal; samples]].concat();
    let sweep = Undisturbed {
        forces: both(0.5, level),
        slope: both(100.0, 1000.0),
        gel: vec![both(0.0, 0.1)],
        support: vec![both(0.2, 0.0)],
        travelled: positions(samples).iter().map(|x| x + 8e-3).collect(),
        u: modes.u.clone(),
        half: 8e-3,
        uneven: Vec::new(),
        share: vec![1.0; samples],
        zero_error: Vec::new(),
        depth_noise: Vec::new(),
        depth_sd: vec![0.2e-3; samples],
        radius,
        is_zeroed: false,
    };
    let of = Disturbances::new(&modes, &sweep);
    // A direction, from its lateral and normal force at u.
    let is = |found: &DVector<f64>, expected: &dyn Fn(f64) -> [f64; 2]| {
        let series = |channel: usize| {
            modes
                .u
                .iter()
                .map(|u| expected(*u)[channel])
                .collect::<Vec<_>>()
        };
        let (lateral, normal) = (series(0), series(1));
        let off = (modes.of(Force::new(&lateral, &normal)) - found).amax();
        assert!(off < 1e-12, "{off:e}");
    };
    let way = |u: f64| 8e-3 * (u + 1.0);
    let (a, half) = (0.031 * radius, 8e-3);
    is(&of.part(Part::Stage).vectors[1], &|u| {
        [100.0 * a * u * u, 1000.0 * a * u * u]
    });
    is(&of.part(Part::Surface).vectors[0], &|u| {
        [
            a * (100.0 * u - level / half),
            a * (1000.0 * u + 0.5 / half),
        ]
    });
    is(&of.part(Part::Stage).vectors[5], &|u| {
        let cos = 0.0046 * radius * (2.0 * PI * u).cos();
        [100.0 * cos, 1000.0 * cos]
    });
    // The third of nine places is 30 % along: 3.2 mm before the middle.
    is(&of.part(Part::Bump(3)).vectors[0], &|u| {
        let (off, sd) = (8e-3 * u + 3.2e-3, 0.38 * radius);
        let height = radius * (-0.5 * (off / sd).powi(2)).exp();
        let slope = -height * off / (sd * sd);
        [
            100.0 * height - level * slope,
            1000.0 * height + 0.5 * slope,
        ]
    });
    // The first wavenumber of the second band of waves, and the last of all bands: 0.65 and 1.25 cycles in a radius.
    for (band, wave, cycles, waves) in [(1, 0, 0.65, 3), (4, 16, 1.25, 9)] {
        let vectors = of.part(Part::Waves(band)).vectors;
        let (k, size) = (2.0 * PI * cycles / radius, radius / f64::from(waves).sqrt());
        is(&vectors[wave], &|u| {
            let (height, slope) = ((k * u * half).sin(), k * (k * u * half).cos());
            let [lateral, normal] = [
                100.0 * height - level * slope,
                1000.0 * height + 0.5 * slope,
            ];
            [size * lateral, size * normal]
        });
        is(&vectors[wave + 1], &|u| {
            let (height, slope) = ((k * u * half).cos(), -k * (k * u * half).sin());
            let [lateral, normal] = [
                100.0 * height - level * slope,
                1000.0 * height + 0.5 * slope,
            ];
            [size * lateral, size * normal]
        });
        assert_eq!(vectors.len(), 2 * waves as usize);
    }
    assert_eq!(
        [Part::Stage, Part::Tilt].map(|part| of.part(part).vectors.len()),
        [7, 2]
    );
    is(&of.part(Part::Gel).vectors[1], &|_| {
        [0.2e-3 * 100.0, 0.2e-3 * 1000.0]
    });
    is(&of.part(Part::Support).vectors[0], &|_| [0.2, 0.0]);
    is(&of.part(Part::Friction).vectors[0], &|_| [0.2 * level, 0.0]);
    is(&of.part(Part::Friction).vectors[4], &|u| {
        [0.1 * level * (-way(u) / (0.46 * radius)).exp(), 0.0]
    });
    is(&of.part(Part::Relaxation).vectors[1], &|u| {
        let left = 0.1 * (-way(u) / (0.77 * radius)).exp();
        [0.5 * left, level * left]
    });
    is(&of.always().vectors[0], &|_| [0.3, 0.0]);
    is(&of.always().vectors[3], &|u| [0.0, 0.15 * u]);
    is(&of.always().vectors[4], &|_| [0.15, 0.3 * level]);
    // The first mode is the mean: kᵀKk over all pairs of samples.
    let first = |part: Part, channel: usize, kernel: &dyn Fn(f64, f64) -> f64| {
        let rest = of.part(part).rest;
        let at = channel * modes.count();
        let ways: Vec<f64> = modes.u.iter().map(|u| way(*u)).collect();
        let pairs = ways.iter().flat_map(|x| ways.iter().map(move |y| (*x, *y)));
        let sum: f64 = pairs.map(|(x, y)| kernel(x, y)).sum();
        assert_near(rest[(at, at)], level * level * sum / samples as f64, 1e-10);
    };
    let gauss = |x: f64, y: f64, lengths: &[f64]| {
        let each = lengths
            .iter()
            .map(|length| (-0.5 * ((x - y) / (length * radius)).powi(2)).exp());
        each.sum::<f64>() / lengths.len() as f64
    };
    first(Part::Smooth, 1, &|x, y| gauss(x, y, &[0.38, 0.77]));
    first(Part::Smooth, 0, &|x, y| 0.25 * gauss(x, y, &[0.38, 0.77]));
    first(Part::Broad, 1, &|x, y| gauss(x, y, &[0.62, 1.23]));
    first(Part::Friction, 0, &|x, y| {
        4e-4 * gauss(x, y, &[0.15, 0.38, 0.77])
    });
    first(Part::UnevenFriction, 0, &|x, y| gauss(x, y, &[0.38, 0.77]));
    first(Part::Walk, 0, &|x, y| x.min(y) / 16e-3);
    // The mean of cos φ between two angles.
    for (band, cycles) in [(1, [0.46, 0.58]), (6, [0.34, 1.06])] {
        for channel in [0, 1] {
            first(Part::Sway(band), channel, &|x, y| {
                let [low, high] = cycles.map(|cycles| 2.0 * PI * cycles * (x - y) / radius);
                match high == low {
                    true => 1.0,
                    false => (high.sin() - low.sin()) / (high - low),
                }
            });
        }
    }
    // Depths that were measured: their zero, and errors of their own. The first mode of N independent errors v has the variance Σv²/N.
    let measured = Undisturbed {
        zero_error: both(20.0, 200.0),
        depth_noise: both(0.01, -0.03),
        share: (0..samples)
            .map(|at| if at < 20 { 0.5 } else { 1.0 })
            .collect(),
        ..sweep.clone()
    };
    let path = Disturbances::new(&modes, &measured);
    let (even, beside) = (of.always(), path.always());
    assert_eq!(beside.vectors.len(), even.vectors.len() + 1);
    is(beside.vectors.last().unwrap(), &|_| [20.0, 200.0]);
    let (errors, m) = (beside.rest - even.rest, modes.count());
    for (row, column, variance) in [(0, 0, 1e-4), (0, m, -3e-4), (m, 0, -3e-4), (m, m, 9e-4)] {
        assert_near(errors[(row, column)], variance, 1e-16);
    }
    // A smooth misfit is a share of the force at each sample.
    let smooth = path.part(Part::Smooth).rest[(m, m)];
    let ways: Vec<f64> = modes.u.iter().map(|u| way(*u)).collect();
    let all = (0..samples).flat_map(|a| (0..samples).map(move |b| (a, b)));
    let sum: f64 = all
        .map(|(a, b)| {
            measured.share[a] * measured.share[b] * gauss(ways[a], ways[b], &[0.38, 0.77])
        })
        .sum();
    assert_near(smooth, level * level * sum / samples as f64, 1e-10);
    // 2, six of 1, 14 of ½, nine of ⅕, nine of ⅒, and four of 2/25.
    assert_near(CLASSES.iter().map(|class| class.weight).sum(), 18.02, 1e-13);
    let several = CLASSES
        .iter()
        .find(|class| class.name.starts_with("several"))
        .unwrap();
    assert_eq!(several.parts(&[]).unwrap().len(), 6);
    // Waves and sways come with what gels and probes do in any case, and a known one takes the whole class with it.
    let of = |name: &str| CLASSES.iter().find(|class| class.name == name).unwrap();
    let mut beside = vec![
        (Part::Sway(6), 0.05),
        (Part::Support, 1.0),
        (Part::Gel, 0.5),
        (Part::Surface, 0.5),
        (Part::Friction, 0.5),
        (Part::Relaxation, 0.5),
        (Part::Smooth, 0.002),
    ];
    let sways = of("the sensor sways");
    assert_eq!(sways.parts(&[]).unwrap(), beside);
    assert!(sways.parts(&[Part::Walk]).is_none());
    beside.retain(|(part, _)| *part != Part::Surface);
    assert_eq!(sways.parts(&[Part::Surface]).unwrap(), beside);
}

// Verifies: ROB-030.
#[test]
fn what_sweeps_share_is_one_disturbance() {
    let sweep = |value: f64| Covariance {
        vectors: vec![DVector::from_vec(vec![value])],
        rest: DMatrix::from_element(1, 1, 10.0),
    };
    let sweeps = [sweep(2.0), sweep(3.0)];
    let (shared, own) = (joined(&sweeps, |_| 0), joined(&sweeps, |sweep| sweep));
    assert_eq!(
        shared,
        DMatrix::from_row_slice(2, 2, &[14.0, 6.0, 6.0, 19.0])
    );
    assert_eq!(own, DMatrix::from_row_slice(2, 2, &[14.0, 0.0, 0.0, 19.0]));
}

/// A sweep at the depth of `bank` over the place in question.
fn at_place<'a>(
    bank: &Bank,
    record: &'a Record,
    changes: Option<&'a GelChanges>,
) -> RobustSweep<'a> {
    RobustSweep::new(record, bank.depth(), changes)
}

fn bank() -> Bank {
    let laterals: Vec<f64> = (-8..=8).map(|x| f64::from(x) * 1e-3).collect();
    let mut plan = BankPlan::new(Phantom::builtin("4.6").unwrap(), 4e-3, &laterals).unwrap();
    plan.mesh_size = 2e-3;
    plan.positions = (-2..=2).map(|x| f64::from(2 * x) * 1e-3).collect();
    plan.depths = vec![3.6e-3, 4.6e-3, 5.6e-3];
    plan.bank().unwrap()
}

// Verifies: ROB-020, ROB-032, ROB-040, ROB-041, ROB-042, ROB-043, ROB-004.
#[test]
fn an_inclusion_is_found_where_it_is_and_none_where_there_is_none() {
    let bank = bank();
    let (depths, usual) = ([bank.depth()], GelUncertainty::default());
    let changes = GelChanges::new(bank.reference(), &depths, &usual);
    let changes = changes.unwrap().unwrap();
    // Each change of the paper's gel is possible in both directions.
    assert_eq!((changes.gel.len(), changes.support.len()), (5, 2));
    let question = RobustQuestion::default();
    let over = positions(161);
    let record = |map: usize, scale: f64| {
        let table = match map {
            usize::MAX => bank.reference().table(),
            map => bank.maps()[map].table(),
        };
        let forces = noisy(table.sweep(bank.depth(), &over).unwrap(), 0.02, [5, 6]);
        let forces = forces.map(|channel| channel.iter().map(|f| scale * f).collect::<Vec<_>>());
        Record::new("sweep", &over, forces.as_deref()).unwrap()
    };
    let judge = |record: &Record| {
        let sweep = at_place(&bank, record, Some(&changes));
        question.locate(&bank, None, &[sweep]).unwrap()
    };
    // The disc at 2 mm, 4.6 mm deep, in a gel 20 % stiffer.
    let disc = (0..bank.maps().len())
        .find(|&map| bank.point(map)[..2] == [2e-3, 4.6e-3])
        .unwrap();
    let (answer, place) = judge(&record(disc, 1.2));
    assert_eq!(answer.decision, Some(Decision::Inclusion), "{answer:?}");
    // The disc carries a part.
    assert!((1.2..1.5).contains(&answer.levels[0]), "{answer:?}");
    assert!(
        answer.noise_sd[0]
            .into_array()
            .iter()
            .all(|sd| (0.02..0.03).contains(&sd.unwrap())),
        "{answer:?}"
    );
    let [position, depth, diameter, modulus] = place.intervals;
    let position = position.unwrap();
    assert_eq!((position.lower, position.upper), (Some(1e-3), Some(3e-3)));
    assert_near(position.estimate, 2e-3, 0.3e-3);
    assert!(
        depth.unwrap().lower.is_none_or(|lower| lower < 4.6e-3),
        "{place:?}"
    );
    assert!(
        depth.unwrap().upper.is_none_or(|upper| upper > 4.6e-3),
        "{place:?}"
    );
    assert!(diameter.is_none() && modulus.is_none() && place.none_down_to.is_none());
    let (answer, place) = judge(&record(usize::MAX, 1.0));
    assert_eq!(answer.decision, Some(Decision::NoInclusion), "{answer:?}");
    assert_eq!(place.none_down_to, Some(5.6e-3));
    // Down to a depth there is none if each above it is excluded too.
    let hypotheses = BankHypotheses::new(&bank, None);
    let down_to = |of_depth: [f64; 3]| {
        let row = |map: usize| bank.axes()[1].partition_point(|depth| *depth < bank.point(map)[1]);
        let mut thetas = vec![0.0; answer.thetas.len()];
        (0..bank.maps().len()).for_each(|map| thetas[map] = of_depth[row(map)]);
        let answer = RobustAnswer {
            thetas,
            ..answer.clone()
        };
        hypotheses.place(&answer).none_down_to
    };
    assert_eq!(down_to([-9.0, -9.0, -9.0]), Some(5.6e-3));
    assert_eq!(down_to([-9.0, -9.0, 0.0]), Some(4.6e-3));
    assert_eq!(down_to([0.0, -9.0, -9.0]), None);
    // One inclusion has its place even where two explain the record far better.
    let mut thetas = vec![1e4; answer.thetas.len()];
    thetas[..bank.maps().len()].fill(0.0);
    thetas[0] = 50.0;
    let two = RobustAnswer {
        thetas,
        ..answer.clone()
    };
    let found = hypotheses.place(&two);
    assert_eq!(found.several, 1.0);
    let at = found.intervals[1].unwrap().estimate;
    assert_near(at, bank.point(0)[1], 1e-12);
    // However large θ is, the shares add up to 1 but for some roundings of 10⁻¹⁶.
    let thetas = (0..answer.thetas.len()).map(|hypothesis| 1e6 + 0.1 * hypothesis as f64);
    let large = RobustAnswer {
        thetas: thetas.collect(),
        ..answer.clone()
    };
    let found = hypotheses.place(&large);
    assert!((0.0..=1.0).contains(&found.several), "{}", found.several);
    for shares in &found.marginals {
        assert_near(shares.iter().sum(), 1.0, 1e-14);
    }
    for hypothesis in [0, 1] {
        let shares = answer.classes.iter().map(|(_, shares)| shares[hypothesis]);
        assert_near(shares.sum(), 1.0, 1e-12);
    }
    // Metres in place of millimetres.
    let wrong: Vec<f64> = over.iter().map(|x| 1e-3 * x).collect();
    let forces = record(disc, 1.0);
    let narrow = Record::new("sweep", &wrong, forces.forces()).unwrap();
    let (answer, _) = judge(&narrow);
    assert_eq!(
        (answer.decision, &answer.causes[..]),
        (None, &[Cause::Narrow][..])
    );
    // A sensor that was set to zero on the gel never says that there is nothing, at no depth.
    let zeroed = RobustQuestion {
        is_zeroed: true,
        ..question
    };
    let flat = record(usize::MAX, 1.0);
    let sweep = at_place(&bank, &flat, Some(&changes));
    let (answer, place) = zeroed.locate(&bank, None, &[sweep]).unwrap();
    assert_eq!(
        (answer.decision, &answer.causes[..]),
        (None, &[Cause::Zeroed][..])
    );
    assert_eq!(place.none_down_to, None);
    let rows = answer.rows(Some((&bank, &place)));
    assert!(rows.get("no_inclusion_down_to_m").unwrap().is_null());
    assert!(!rows.table().contains("no inclusion down to"));
    // What is excluded one by one may be there as two.
    for (several, line) in [
        (0.4, "no inclusion down to, mm"),
        (0.6, "P(two inclusions, if any)"),
    ] {
        let none_down_to = Some(5e-3);
        let place = RobustPlace {
            several,
            none_down_to,
            ..place.clone()
        };
        let table = answer.rows(Some((&bank, &place))).table();
        let lines = ["no inclusion down to, mm", "P(two inclusions, if any)"];
        assert_eq!(
            lines.map(|of| table.contains(of)),
            lines.map(|of| of == line),
            "{table}"
        );
    }
}

// Verifies: ROB-032.
#[test]
fn the_prior_of_a_banks_hypotheses_adds_up_to_one() {
    let bank = bank();
    let over = Record::new("over", &positions(30), Force::new(&[0.0; 30], &[0.0; 30])).unwrap();
    let sweep = at_place(&bank, &over, None);
    let signals = BankHypotheses::new(&bank, None).signals(&[sweep]).unwrap();
    // 15 maps; pairs 6 and 8 mm apart: 2 and 1 at each of 3 depths.
    assert_eq!(signals.len(), 15 + 9);
    assert_near(signals.iter().map(|signal| signal.prior).sum(), 1.0, 1e-12);
    assert_near(
        signals[..15].iter().map(|signal| signal.prior).sum(),
        0.8,
        1e-12,
    );
    let mut prior = vec![0.0; 15];
    prior[7] = 1.0;
    let alone = BankHypotheses::new(&bank, Some(&prior))
        .signals(&[sweep])
        .unwrap();
    assert_eq!((alone.len(), alone[0].prior), (1, 1.0));
}

// Of 66 pairs a part is taken, from everywhere: over a bank that is its own mirror image they lie about x = 0.
// Verifies: ROB-032.
#[test]
fn the_pairs_that_count_are_of_the_whole_bank() {
    let x: Vec<f64> = (-8..=8).map(|x| f64::from(x) * 1e-3).collect();
    // 0.1 N above an inclusion and 0 elsewhere, on 1 N.
    let map = |place: Option<f64>| {
        let force = |_, x| [0.0, 1.0 + if Some(x) == place { 0.1 } else { 0.0 }];
        let phantom = Phantom::builtin("4.6")
            .unwrap()
            .changed(|parts| match place {
                None => parts.inclusions.clear(),
                Some(place) => parts.inclusions[0].centre_x = place,
            });
        measured(phantom.ok(), table_of(&[4e-3], &x, force))
    };
    let maps = x.iter().map(|x| map(Some(*x))).collect();
    let bank = Bank::new(map(None), maps).unwrap();
    let over = Record::new("over", &x, Force::new(&[0.0; 17], &[0.0; 17])).unwrap();
    let signals = BankHypotheses::new(&bank, None)
        .signals(&[at_place(&bank, &over, None)])
        .unwrap();
    let middles: Vec<f64> = signals[17..]
        .iter()
        .map(|pair| {
            let normal = pair.of_sweeps[0][17..].iter().zip(&x);
            normal.map(|(force, x)| force * x).sum::<f64>() / 0.2
        })
        .collect();
    assert!((20..=40).contains(&middles.len()), "{}", middles.len());
    let middle = middles.iter().sum::<f64>() / middles.len() as f64;
    assert!(middle.abs() < 0.5e-3, "{middle:e}");
    // One pair is possible, at −6 and 0 mm.
    let mut prior = vec![0.0; 17];
    (prior[2], prior[8]) = (0.5, 0.5);
    let possible = BankHypotheses::new(&bank, Some(&prior))
        .signals(&[at_place(&bank, &over, None)])
        .unwrap();
    let priors: Vec<f64> = possible.iter().map(|signal| signal.prior).collect();
    assert_eq!(priors, [0.4, 0.4, 0.2]);
    // A sweep of the left half says nothing of an inclusion at the right, and something of the others.
    let half: Vec<f64> = (0..=64).map(|at| 1.25e-4 * f64::from(at) - 8e-3).collect();
    let forces = noisy(Force::new(vec![0.0; 65], vec![1.0; 65]), 0.02, [10, 9]);
    let record = Record::new("half", &half, forces.as_deref()).unwrap();
    let sweep = at_place(&bank, &record, None);
    let (answer, _) = RobustQuestion::default()
        .locate(&bank, None, &[sweep])
        .unwrap();
    assert_near(answer.thetas[16], 0.0, 1e-9);
    assert!(answer.thetas[4].abs() > 1e-3, "{:?}", answer.thetas);
}

// Verifies: ROB-044.
#[test]
fn what_is_expected_beside_noise_is_that_of_a_hand() {
    let of = |values: [f64; 2]| DVector::from_column_slice(&values);
    let covariance = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 1.5]);
    let found = fitted(
        &of([1.0, 2.0]),
        &of([1.0, 0.5]),
        &of([0.5, 0.5]),
        &covariance,
    )
    .unwrap();
    // E + R is 3, 1; 1, 2, its inverse a fifth of 2, -1; -1, 3, and y - m is 0.5, 1.5. A few operations.
    for (found, expected) in [(found.weights, [-0.1, 0.8]), (found.mean, [1.1, 1.6])] {
        assert!((found - of(expected)).amax() < 1e-15);
    }
}

/// Sweeps of 161 and 81 samples over a flat gel, 1.5 N in the normal channel, of these lateral and normal forces at x in m and noise of
/// 0.02 N; what is said of them, and the forces without noise.
fn explained(forces: &dyn Fn(f64) -> [f64; 2]) -> (RobustAnswer, Vec<Force<Vec<f64>>>) {
    let rows = (-17..=17).map(|k| format!("4,{},1.5,0\n", 0.5 * f64::from(k)));
    let header = "depth_mm,lateral_mm,normal_force_n,lateral_force_n\n";
    let text = header.to_string() + &rows.collect::<String>();
    let flat = ForceTable::from_csv(&text, "flat").unwrap();
    let counts = [161, 81];
    let series = |count: usize, of: &dyn Fn(f64) -> [f64; 2]| {
        let channel =
            |at: usize| -> Vec<f64> { positions(count).iter().map(|x| of(*x)[at]).collect() };
        Force::new(channel(0), channel(1))
    };
    let truth: Vec<_> = counts.map(|count| series(count, forces)).into();
    let records = (0..).zip(&truth).map(|(sweep, truth)| {
        let mut noisy = noisy(truth.clone(), 0.02, [20 + 2 * sweep, 21 + 2 * sweep]);
        // A glitch in the middle of the first sweep.
        noisy.normal[80] += if sweep == 0 { 30.0 } else { 0.0 };
        Record::new("sweep", &positions(truth.normal.len()), noisy.as_deref()).unwrap()
    });
    let records: Vec<Record> = records.collect();
    let of_sweeps = counts.map(|count| {
        let Force { lateral, normal } = series(count, &disc);
        [lateral, normal].concat()
    });
    let signal = RobustSignal {
        of_sweeps: of_sweeps.into(),
        amplitude_sd: 0.4,
        prior: 1.0,
    };
    let sweeps = records
        .iter()
        .map(|record| RobustSweep::new(record, 4e-3, None));
    let sweeps: Vec<_> = sweeps.collect();
    let detector =
        RobustDetector::new(RobustQuestion::default(), &flat, &sweeps, &[signal]).unwrap();
    let forces: Vec<_> = records.iter().map(Record::forces).collect();
    (detector.judge(&forces).unwrap(), truth)
}

/// What a disc adds, about.
fn disc(x: f64) -> [f64; 2] {
    let bump = 0.3 * (-0.5 * (x / 2.5e-3) * (x / 2.5e-3)).exp();
    [100.0 * x * bump, bump]
}

// The map states no phantom, so that it has no changes of the gel.
// Verifies: ROB-044, ROB-023.
#[test]
fn a_dome_and_a_disc_are_each_explained_to_within_the_noise() {
    // The root mean square of what is expected about the truth, in the worst channel of a hypothesis. The fit of a channel has at most
    // its 16 modes: sd 0.02 sqrt(16/81) = 0.009 of the shorter sweep, 1.3 times that with four standard deviations of 64 powers.
    let off = |answer: &RobustAnswer, truth: &[Force<Vec<f64>>], hypothesis: usize| {
        let expected = &answer.explanation.as_ref().unwrap().expected[hypothesis];
        let pairs = expected
            .iter()
            .zip(truth)
            .flat_map(|(expected, truth)| expected.as_deref().zip(truth.as_deref()).into_array());
        let square = |(expected, truth): (&[f64], &[f64])| {
            let pairs = expected.iter().zip(truth);
            pairs.map(|(e, t)| (e - t) * (e - t)).sum::<f64>() / truth.len() as f64
        };
        pairs.map(square).fold(0.0, f64::max).sqrt()
    };
    // A gel a fifth stiffer, domed by 0.2 mm as a cosine: the force grows with the depth of 4 mm, and is turned by the slope. A parabola
    // would do for a bowed stage with a drift of the lateral force.
    let dome = |x: f64| {
        let (u, a) = (PI * x / 8e-3, 0.1e-3);
        let slope = -a * PI / 8e-3 * u.sin();
        [-1.8 * slope, 1.8 * (1.0 + a / 4e-3 * u.cos())]
    };
    let (answer, truth) = explained(&dome);
    let (class, _) = answer.classes[answer.likeliest_class(0).unwrap()];
    assert_eq!(class.name, "the surface is domed or dished");
    assert!(
        off(&answer, &truth, 0) < 0.012,
        "{}",
        off(&answer, &truth, 0)
    );
    let cleaned = answer.explanation.as_ref().unwrap().records[0].normal[80];
    assert!((cleaned - 1.8).abs() < 0.1, "{cleaned}");
    // Eight tenths of the signal.
    let (answer, truth) = explained(&|x| [0.8 * disc(x)[0], 1.5 + 0.8 * disc(x)[1]]);
    assert_eq!(answer.decision, Some(Decision::Inclusion), "{answer:?}");
    assert!(
        off(&answer, &truth, 1) < 0.012,
        "{}",
        off(&answer, &truth, 1)
    );
    // The level is that of the record with the disc, 1.07; the noise leaves 0.02.
    let amplitude = answer.explanation.unwrap().amplitude;
    assert_near(amplitude, 0.8 / answer.levels[0], 0.06);
}

// Verifies: ROB-031.
#[test]
fn among_several_diameters_the_amplitude_is_surer() {
    let over = Record::new("over", &positions(30), Force::new(&[0.0; 30], &[0.0; 30])).unwrap();
    for (diameters, expected) in [(vec![6.4e-3], 0.4), (vec![4e-3, 6.4e-3], 0.15)] {
        let laterals = [-8e-3, 0.0, 8e-3];
        let mut plan = BankPlan::new(Phantom::builtin("4.6").unwrap(), 4e-3, &laterals).unwrap();
        plan.mesh_size = 2e-3;
        plan.diameters = diameters;
        let bank = plan.bank().unwrap();
        let sweep = at_place(&bank, &over, None);
        let signals = BankHypotheses::new(&bank, None).signals(&[sweep]).unwrap();
        assert!(signals.iter().all(|signal| signal.amplitude_sd == expected));
    }
}

// Verifies: ROB-020.
#[test]
fn what_is_known_of_the_gel_is_not_solved() {
    let bank = bank();
    let of = |uncertainty: GelUncertainty| {
        let changes = GelChanges::new(bank.reference(), &[bank.depth()], &uncertainty);
        changes.unwrap().unwrap()
    };
    let none = of(GelUncertainty::default().beside(&[Part::Gel, Part::Support]));
    assert_eq!((none.gel.len(), none.support.len()), (0, 0));
    assert_eq!(none.depth_percent, 0.0);
    let height = |height_percent| {
        let only = GelUncertainty {
            height_percent,
            ..GelUncertainty::NONE
        };
        let over = Record::new("over", &[0.0], Force::new(&[0.0], &[0.0])).unwrap();
        of(only).gel[0].at(&over, bank.depth()).unwrap()[1]
    };
    assert_near(height(2.0) / height(1.0), 2.0, 1e-12);
    // A higher gel is softer.
    assert!(height(1.0) < 0.0, "{}", height(1.0));
}

// Verifies: ROB-033, ROB-030, ROB-045, ROB-047.
#[test]
fn a_reference_sweep_tells_of_the_gel_and_a_light_one_of_the_surface() {
    let phantom = |name| Phantom::builtin(name).unwrap();
    let laterals: Vec<f64> = (-16..=16).map(|x| f64::from(x) * 0.5e-3).collect();
    let map = |name| {
        let model = Model::new(&phantom(name), 1e-3, Contact::default()).unwrap();
        model
            .map(&[1e-3, 2e-3, 4e-3], &laterals, &|_| true)
            .unwrap()
    };
    let (none, disc) = (map("none"), map("4.6"));
    let depths = [1e-3, 4e-3];
    let changes = depths.map(|depth| {
        let changes = GelChanges::new(&none, &[depth], &GelUncertainty::default());
        changes.unwrap().unwrap()
    });
    let zeros = vec![0.0; 161];
    let over = Record::new("over", &positions(161), Force::new(&zeros, &zeros)).unwrap();
    let sweep = |number: usize, is_reference: bool| RobustSweep {
        record: &over,
        depth: depths[number],
        changes: Some(&changes[number]),
        is_reference,
    };
    let detector = |sweeps: &[RobustSweep]| {
        let signal = |sweep: &RobustSweep| {
            let none = sweep.expected(none.table()).unwrap();
            sweep.signal(disc.table(), &none).unwrap()
        };
        let of_sweeps = sweeps.iter().map(signal).collect();
        let signal = RobustSignal {
            of_sweeps,
            amplitude_sd: 0.4,
            prior: 1.0,
        };
        let question = RobustQuestion::default();
        RobustDetector::new(question, none.table(), sweeps, &[signal]).unwrap()
    };
    let gamma = |sweeps: &[RobustSweep], class: &str| {
        let detector = detector(sweeps);
        let gammas = detector.gammas(0, Force::new(0.02, 0.02));
        gammas.iter().find(|(of, _)| of.name == class).unwrap().1
    };
    let (surface, gel) = ("the surface is domed or dished", "the gel is another");
    let one = [sweep(1, false)];
    let light = [sweep(1, false), sweep(0, false)];
    let beside = [sweep(1, false), sweep(1, true)];
    // The surface of another place is another: a reference sweep says as much of it as no sweep.
    let [alone, twice, lifted, other] =
        [&one[..], &[one[0]; 2], &light, &beside].map(|sweeps| gamma(sweeps, surface));
    assert!(
        lifted > 2.0 * alone && lifted > 1.5 * twice,
        "{alone} {twice} {lifted}"
    );
    assert_near(other / alone, 1.0, 0.05);
    // A sweep over half of the place has the surface of that half.
    let half: Vec<f64> = positions(161)[40..121].to_vec();
    let half = Record::new("half", &half, Force::new(&zeros[..81], &zeros[..81])).unwrap();
    let shorter = RobustSweep {
        record: &half,
        ..sweep(0, false)
    };
    let [whole, half] =
        [0, 1].map(|at| detector(&[one[0], shorter]).sweeps[at].undisturbed.clone());
    assert_eq!((&whole.u[40..121], whole.half), (&half.u[..], half.half));
    let [alone, known] = [&one[..], &beside].map(|sweeps| gamma(sweeps, gel));
    assert!(known > 1.5 * alone, "{alone} {known}");
    // Sweeps of two reference files have a surface each, those of one file the same.
    let there = Record::new("there", &positions(161), Force::new(&zeros, &zeros)).unwrap();
    let reference = |record| RobustSweep {
        record,
        ..sweep(1, true)
    };
    let sweeps = [
        sweep(1, false),
        reference(&there),
        reference(&there),
        reference(&over),
    ];
    let signal = RobustSignal {
        of_sweeps: vec![
            vec![1.0; 322],
            vec![0.0; 322],
            vec![0.0; 322],
            vec![0.0; 322],
        ],
        amplitude_sd: 0.4,
        prior: 1.0,
    };
    let question = RobustQuestion::default();
    let signals = [signal];
    let detector = RobustDetector::new(question, none.table(), &sweeps, &signals).unwrap();
    let class = CLASSES.iter().position(|of| of.name == surface);
    let covariance = &detector.weighted[class.unwrap()].covariance;
    let size = covariance.nrows() / 4;
    let shared = [(1, 2), (1, 3), (0, 3)]
        .map(|(a, b)| covariance.view((a * size, b * size), (size, size)).amax() > 0.0);
    assert_eq!(shared, [true, false, false]);
    // What is known does not help.
    let question = RobustQuestion {
        known: &[Part::Gel],
        ..question
    };
    let detector = RobustDetector::new(question, none.table(), &sweeps, &signals).unwrap();
    let classes = detector.gammas(0, Force::new(0.02, 0.02));
    let (several, _) = classes
        .iter()
        .find(|(of, _)| of.name == "several of these at once")
        .unwrap();
    assert!(several.remedy().starts_with("more sweeps"));
}

// Verifies: ROB-005. The limit of a noise that grows is another way to the same number.
#[test]
fn a_record_of_one_channel_is_judged_as_if_the_other_had_infinite_noise() {
    let bank = bank();
    let over = positions(81);
    let forces = bank.maps()[7].table().sweep(bank.depth(), &over).unwrap();
    let pairs = forces.normal.iter().zip(noise(81, 3));
    let normal: Vec<f64> = pairs.map(|(force, n)| force + 0.1 * n).collect();
    // A force without noise would come from no sensor.
    let pairs = forces.lateral.iter().zip(noise(81, 4));
    let lateral: Vec<f64> = pairs.map(|(force, n)| force + 0.01 * n).collect();
    let judged = |lateral: &[f64], sd: f64| {
        let record = Record::new("sweep", &over, Force::new(lateral, &normal[..])).unwrap();
        let question = RobustQuestion {
            noise_sd: Some(Force::new(sd, 0.1)),
            ..RobustQuestion::default()
        };
        let sweep = at_place(&bank, &record, None);
        question.locate(&bank, None, &[sweep]).unwrap()
    };
    let (one, place) = judged(&[], 0.1);
    let (both, place_of_both) = judged(&lateral, 1e6);
    // An information of (1 N/1e6 N)² is lost, times the condition of the covariances.
    assert!(
        (one.theta - both.theta).abs() < 1e-6,
        "{} {}",
        one.theta,
        both.theta
    );
    let [one_at, both_at] = [&place, &place_of_both].map(|of| of.intervals[0].unwrap().estimate);
    assert!((one_at - both_at).abs() < 1e-9);
    assert_eq!(one.decision, both.decision);
    assert_eq!(
        one.noise_sd[0],
        Force {
            lateral: None,
            normal: Some(0.1)
        }
    );
    // What the lateral force would have said.
    let (all, _) = judged(&lateral, 0.1);
    assert!(all.theta > one.theta + 1.0, "{} {}", all.theta, one.theta);
    let rows = one.rows(None);
    assert!(
        !rows.table().contains("noise sd, lateral"),
        "{}",
        rows.table()
    );
}

// Verifies: ROB-006.
#[test]
fn maps_of_the_normal_force_alone_judge_a_record_of_it() {
    let bank = bank();
    let over = positions(81);
    let table = |map: &ForceMap| map.table().at_depths(&[bank.depth()]).unwrap();
    let maps = [bank.reference(), &bank.maps()[7]].map(table);
    let maps = [&maps[0], &maps[1]];
    let alone = maps.map(ForceTable::of_normal);
    let judged = |[without, with]: [&ForceTable; 2], map: &ForceTable, has_lateral: bool| {
        let forces = map.sweep(bank.depth(), &over).unwrap();
        let pairs = forces.normal.iter().zip(noise(81, 3));
        let normal: Vec<f64> = pairs.map(|(force, n)| force + 0.05 * n).collect();
        let lateral = if has_lateral {
            &forces.lateral[..]
        } else {
            &[]
        };
        let record = Record::new("sweep", &over, Force::new(lateral, &normal[..])).unwrap();
        let hypotheses = Hypotheses::of_tables(without, with).unwrap();
        let sweep = at_place(&bank, &record, None);
        RobustQuestion::default().judge(hypotheses, &[sweep])
    };
    let [f0, f1] = [&alone[0], &alone[1]];
    for map in maps {
        let by_both = judged(maps, map, false).unwrap();
        let by_one = judged([f0, f1], map, false).unwrap();
        assert_eq!(by_one.decision, by_both.decision);
        assert!(by_one.decision.is_some());
        assert_eq!(by_one.noise_sd[0].lateral, None);
        // What the lateral force of an even gel does to the normal one where its surface is tilted or rubs.
        let apart = (by_one.theta - by_both.theta).abs();
        assert!(
            apart < 0.02 * by_both.theta.abs(),
            "{apart} {}",
            by_both.theta
        );
    }
    let refused = judged([f0, f1], maps[1], true).unwrap_err().to_string();
    let expected = "sweep: the record has lateral forces, and the maps have none; leave out those of the record";
    assert_eq!(refused, expected);
}

/// A bank of one disc under a probe at 2 to 4.4 mm.
fn deep_bank() -> Bank {
    let laterals: Vec<f64> = (-8..=8).map(|x| f64::from(x) * 1e-3).collect();
    let mut plan = BankPlan::new(Phantom::builtin("4.6").unwrap(), 4e-3, &laterals).unwrap();
    plan.mesh_size = 2e-3;
    plan.probe_depths = (0..5).map(|row| 2e-3 + 0.6e-3 * f64::from(row)).collect();
    plan.bank().unwrap()
}

/// Forth at 2.5 mm and back at 3.8 mm with a tremor of 0.3 mm, over a gel of which the bank knows all, in noise of 0.02 N.
fn trembling(bank: &Bank, has_disc: bool, trial: u64) -> Record {
    let over: Vec<f64> = positions(161)
        .into_iter()
        .chain(positions(161).into_iter().rev())
        .collect();
    let tremor = |at: usize| 0.3e-3 * (1.9 * at as f64).sin();
    let depth = |at: usize| if at < 161 { 2.5e-3 } else { 3.8e-3 } + tremor(at);
    let depths: Vec<f64> = (0..over.len()).map(depth).collect();
    let table = match has_disc {
        true => bank.maps()[0].table(),
        false => bank.reference().table(),
    };
    let forces = table.path(&depths, &over).unwrap();
    let forces = noisy(forces, 0.02, [2 * trial, 2 * trial + 1]);
    Record::along("path", &over, &depths, forces.as_deref()).unwrap()
}

// Verifies: ROB-081, ROB-083, ROB-080, BNK-081, BNK-020.
#[test]
fn passes_whose_depth_trembles_are_judged_by_what_the_maps_say_of_it() {
    let bank = deep_bank();
    // Those of the probe, 0.3 mm above the first and below the last, and one between two.
    let rows = bank.reference().table().depths();
    assert_eq!(rows.len(), 11, "{rows:?}");
    for (row, depth) in rows.iter().enumerate() {
        assert_near(*depth, 1.7e-3 + 0.3e-3 * row as f64, 1e-9);
    }
    let question = RobustQuestion::default();
    let judge = |record: &Record, has_depths: bool| {
        let (mut passes, left_out) = question.passes(record, bank.reference());
        assert_eq!((passes.len(), left_out), (2, 0));
        if !has_depths {
            passes = passes
                .iter()
                .map(|pass| Record::new("path", pass.positions(), pass.forces()).unwrap())
                .collect();
        }
        let all: Vec<&Record> = passes.iter().collect();
        let depths = GelChanges::depths_along(bank.reference(), &all);
        let changes = GelChanges::new(bank.reference(), &depths, &GelUncertainty::default());
        let changes = changes.unwrap();
        let sweeps: Vec<_> = (passes.iter().zip([2.6e-3, 3.8e-3]))
            .map(|(record, depth)| RobustSweep::new(record, depth, changes.as_ref()))
            .collect();
        question.locate(&bank, None, &sweeps).unwrap().0
    };
    for (has_disc, expected) in [(true, Decision::Inclusion), (false, Decision::NoInclusion)] {
        let record = trembling(&bank, has_disc, 3);
        let answer = judge(&record, true);
        assert_eq!(
            (answer.decision, &answer.glitches[..]),
            (Some(expected), &[0, 0][..]),
            "{answer:?}"
        );
        // The noise is that of the sensor: of 161 samples its standard deviation is known to 6 %.
        let sd = answer.noise_sd.iter().map(|sd| sd.normal.unwrap());
        assert!(
            sd.clone().all(|sd| (0.015..0.025).contains(&sd)),
            "{answer:?}"
        );
        let whole = RobustSweep::new(&record, 0.0, None);
        let error = question
            .locate(&bank, None, &[whole])
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "path: the record may have several passes, at depths of their own; give each of its passes as a sweep"
        );
    }
    // A probe that goes on for 2 mm is no sweep, and neither is one of seven samples.
    let step = |k: usize| -8e-3 + 1e-4 * k as f64;
    let back: Vec<f64> = (0..161)
        .map(step)
        .chain((0..21).map(|k| 8e-3 - 1e-4 * k as f64))
        .collect();
    let far = back[..161]
        .iter()
        .copied()
        .chain((0..7).map(|k| 8e-3 - 2e-3 * k as f64));
    let zeros = |count| vec![0.0; count];
    for (over, short) in [(back.clone(), 20), (far.collect(), 6)] {
        let (none, depths) = (zeros(over.len()), vec![3e-3; over.len()]);
        let record = Record::along("path", &over, &depths, Force::new(&none, &none)).unwrap();
        let (passes, left_out) = question.passes(&record, bank.reference());
        // The first sample on the way back is where the probe turns.
        assert_eq!((passes.len(), left_out), (1, short));
    }
    let even = Record::new("sweep", &back[..161], Force::new(&zeros(161), &zeros(161))).unwrap();
    assert_eq!(
        question.passes(&even, bank.reference()),
        (vec![even.clone()], 0)
    );
    // The changes at a depth between rows are those of that depth, within a hundredth of them.
    let at = vec![2.9e-3; 161];
    let record = Record::along(
        "path",
        &back[..161],
        &at,
        Force::new(&zeros(161), &zeros(161)),
    );
    let record = record.unwrap();
    let depths = GelChanges::depths_along(bank.reference(), &[&record]);
    let [all, own] = [&depths[..], &[2.9e-3]]
        .map(|depths| GelChanges::new(bank.reference(), depths, &GelUncertainty::default()));
    let (all, own) = (all.unwrap().unwrap(), own.unwrap().unwrap());
    for (all, own) in all
        .gel
        .iter()
        .chain(&all.support)
        .zip(own.gel.iter().chain(&own.support))
    {
        let [found, right] = [all.at(&record, 0.0), own.at(&even, 2.9e-3)].map(Result::unwrap);
        let most = right.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
        let off = found
            .iter()
            .zip(&right)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(most > 1e-3 && off < 0.02 * most, "{off:e} of {most:e}");
    }
}

// Verifies: ROB-008.
#[test]
fn forces_whose_squares_overflow_are_refused() {
    let bank = bank();
    let over = positions(81);
    let forces = bank.maps()[7].table().sweep(bank.depth(), &over).unwrap();
    let record = Record::new("sweep", &over, Force::new(&forces.lateral, &forces.normal));
    let record = record.unwrap();
    let sweep = at_place(&bank, &record, None);
    let question = RobustQuestion::default();
    let (detector, _) = question.bank_detector(&bank, None, &[sweep]).unwrap();
    let judged = |channel: usize, force: f64| {
        let mut channels = [forces.lateral.clone(), forces.normal.clone()];
        channels[channel][40] = force;
        let answer = detector.judge(&[Force::new(&channels[0], &channels[1])]);
        answer.map_err(|refusal| refusal.to_string())
    };
    for channel in [0, 1] {
        assert!(judged(channel, -1e20).is_ok());
        for force in [f64::NAN, f64::NEG_INFINITY, 1e300, -1.1e20] {
            let expected = format!("force = {force:?}, but must be at most 1e20 N in magnitude");
            assert_eq!(judged(channel, force).err(), Some(expected));
        }
    }
}

// The sum of ROB-007 begins anew behind the spike, if that counts.
// Verifies: ROB-002, ROB-007.
#[test]
fn a_spike_near_an_end_is_a_glitch_and_no_air() {
    let bank = bank();
    let over = positions(161);
    let forces = bank.maps()[7].table().sweep(bank.depth(), &over).unwrap();
    let mut forces = noisy(forces, 0.05, [31, 32]);
    forces.normal[10] = -20.0;
    let record = Record::new("sweep", &over, forces.as_deref()).unwrap();
    let sweep = at_place(&bank, &record, None);
    for noise_sd in [None, Some(Force::new(0.05, 0.05))] {
        let question = RobustQuestion {
            noise_sd,
            ..RobustQuestion::default()
        };
        let (detector, _) = question.bank_detector(&bank, None, &[sweep]).unwrap();
        let answer = detector.judge(&[record.forces()]).unwrap();
        let found = (answer.causes, answer.in_air, answer.glitches);
        assert_eq!(found, (Vec::new(), vec![[0; 2]], vec![1]), "{noise_sd:?}");
    }
}
