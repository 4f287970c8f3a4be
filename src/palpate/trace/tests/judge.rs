//! Records judged at a known position. Expected values: NumPy's QR of the same signals, SciPy's laws of t.

use super::*;
use crate::detect::Decision;
use crate::detect::nuisance::Threshold;
use crate::force_map::tests::table_of;
use crate::stats::random::Generator;
use crate::trace::design::difference;
use palpate_asserts::assert_error;

fn at(threshold: Threshold) -> f64 {
    match threshold {
        Threshold::At(t) => t,
        _ => panic!("{threshold:?}"),
    }
}

/// What is known of a sweep at `depth`: all of it; a priori one in four has an inclusion.
pub fn question<'a>(depth: f64) -> Question<'a> {
    Question {
        depth,
        depth_tolerance: 0.0,
        is_zeroed: false,
        unknown: &[],
        noise: noise(Some(Force::new(0.5, 0.25)), Correlation::None),
        criterion: Criterion::MaximumAPosteriori,
        prior_h1: 0.25,
    }
}

fn noise(sd: Option<Force<f64>>, correlation: Correlation) -> Noise {
    Noise { sd, correlation }
}

const TWO_PER_CENT: Criterion = Criterion::NeymanPearsonFalseAlarm {
    max_false_alarm: 0.02,
};

// Verifies: TRC-020, TRC-021, TRC-065, TRC-060, CLI-043.
#[test]
fn a_record_at_a_known_position_by_hand() {
    // At 2 mm, half-way, the bump is 1.5 times that of the first row; at −0.5 mm, half-way, it is
    // 1.125 N normal, 0.375 N lateral.
    let record = read("position_mm,lateral_force_n,normal_force_n\n-0.5,0.1,2.125\n").unwrap();
    let (without, with) = (table(0.0), table(1.0));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let found = question(0.002).judge(hypotheses, &record).unwrap();
    // r = (0, 1.125), Δ = (0.375, 1.125).
    let theta = -0.5 * 0.375 * 0.375 / 0.25 + 0.5 * 1.125 * 1.125 / 0.0625;
    let gamma = f64::sqrt(0.375 * 0.375 / 0.25 + 1.125 * 1.125 / 0.0625);
    assert!((found.test.theta() - theta).abs() < 1e-12);
    assert!((found.test.gamma - gamma).abs() < 1e-12);
    let threshold = f64::ln(3.0) / gamma + 0.5 * gamma;
    assert!((at(found.threshold) - threshold).abs() < 1e-12);
    let posterior = 1.0 / (1.0 + 3.0 * f64::exp(-theta));
    assert!((found.posterior - posterior).abs() < 1e-12);
    assert_eq!(found.decision, Some(Decision::Inclusion));
}

// Verifies: TRC-020, TRC-024, TRC-060, CLI-049.
#[test]
fn maps_that_do_not_fit_are_refused() {
    let judged = |record: &Record, reference: &ForceTable, depth: f64| {
        let with = table(1.0);
        let hypotheses = Hypotheses::of_tables(reference, &with).unwrap();
        let found = question(depth).judge(hypotheses, record);
        found.unwrap_err().to_string()
    };
    let record = read(EXAMPLE).unwrap();
    let far = read(&format!("{EXAMPLE}# far\n3.1,0,0\n")).unwrap();
    let found = [
        judged(&record, &table(1.0), 0.001),
        judged(&record, &table(0.0), 0.0035),
        judged(&far, &table(0.0), 0.001),
    ];
    let expected = "t.csv: the maps do not differ at the samples, and leave no signal to decide by; check where the samples are: a depth below the surface is positive
t.csv: depth 3.5 mm is outside the map, which has 1.0 to 3.0 mm
t.csv:5: position 3.1 mm is outside the maps, which have -3.0 to 3.0 mm; leave it out, or use --trim";
    assert_eq!(found.join("\n"), expected);
    let table = |depths: [f64; 2]| {
        let (laterals, forces) = (
            table(0.0).laterals().to_vec(),
            table(0.0).both().unwrap().map(Matrix::clone),
        );
        ForceTable::new(depths.to_vec(), laterals, forces).unwrap()
    };
    let (a, b) = (table([0.001, 0.003]), table([0.001, 0.0031]));
    assert_error(Hypotheses::of_tables(&b, &a), "depths_m[1] is 0.003[..]");
    let single = |signal| {
        let normal = |x| 1.0 + if x > 0.0 { signal } else { 0.0 };
        table_of(&[0.001], &[-0.001, 0.001], |_, x| [0.0, normal(x)])
    };
    let (without, with) = (single(0.0), single(1.0));
    let question = Question {
        unknown: &[Unknown::Depth],
        ..question(0.001)
    };
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    assert_error(
        question.judge(hypotheses, &record),
        "[..]the maps have a single depth; give rows at other depths, or the depth as known[..]",
    );
}

/// Maps at 3.7, 4 and 4.3 mm over −8 … 8 mm by ½ mm, with an inclusion of so much signal (N).
pub fn gel(signal: f64) -> ForceTable {
    let bump = |x: f64| signal / ((1.0 + x * x / 4.0) * (1.0 + x * x / 4.0));
    let millimetres = |column: u8| f64::from(column) / 2.0 - 8.0;
    let laterals: Vec<f64> = (0..33).map(|column| 1e-3 * millimetres(column)).collect();
    table_of(&[3.7, 4.0, 4.3].map(|d| 1e-3 * d), &laterals, |d, x| {
        // The forces are of round numbers of mm.
        let [d, x] = [d, x].map(|metres| (1e4 * metres).round() / 10.0);
        let lateral = 0.25 * d * (0.02 * x - 0.5 * x * bump(x));
        let normal = 1.5 * d * d / 16.0 + 0.004 * x * x + 0.25 * d * bump(x);
        [lateral, normal]
    })
}

/// A record over these positions (m), of the force that `of` gives for a sample, N.
pub fn record(positions: Vec<f64>, of: impl Fn(usize) -> [f64; 2]) -> Record {
    let column = |channel: usize| (0..positions.len()).map(|i| of(i)[channel]).collect();
    Record {
        file: "t.csv".into(),
        lines: (2..).take(positions.len()).collect(),
        forces: Force::new(column(0), column(1)),
        positions,
        depths: Vec::new(),
        depth_sd: 0.0,
        place: None,
    }
}

/// A record of 161 samples with jitter, and with what the model does not have: its gel is 10 % stiffer, its sensor has offsets and drifts;
/// `signal` gives the force of the inclusion at a sample, N.
pub fn recorded(signal: impl Fn(f64) -> [f64; 2]) -> Record {
    let positions = (0..161_u16).map(|i| {
        let jitter = f64::from((i * i % 7 * 5 + i) % 7) - 3.0;
        1e-3 * (-8.0 + 0.1 * f64::from(i) + 0.01 * jitter).clamp(-8.0, 8.0)
    });
    let positions: Vec<f64> = positions.collect();
    let exact = gel(0.0).sweep(4e-3, &positions).unwrap();
    record(positions.clone(), |i| {
        let line = 2.0 * i as f64 / 160.0 - 1.0;
        let noise = [(i * i * 7 + 3 * i) % 11, (i * i * 5 + 2 * i) % 13];
        let noise = [
            0.3 / 11.0 * (noise[0] as f64 - 5.0),
            0.3 / 13.0 * (noise[1] as f64 - 6.0),
        ];
        let [lateral, normal] = signal(positions[i]);
        [
            1.1 * exact.lateral[i] + lateral + 0.25 + 0.1 * line + noise[0],
            1.1 * exact.normal[i] + normal - 0.5 - 0.2 * line + noise[1],
        ]
    })
}

/// The standard deviations that are stated of that record's noise, N.
pub const STATED: Force<f64> = Force::new(0.1, 0.08);

#[track_caller]
pub fn close(found: f64, expected: f64) {
    let error = (found - expected).abs() / expected.abs();
    assert!(error < 1e-9, "{found}, not {expected}");
}

// Verifies: TRC-060, TRC-064, TRC-065, TRC-068, TRC-070.
#[test]
fn what_is_unknown_is_fitted_by_least_squares() {
    use Unknown::{Depth, Drift, Gain, Offset, Variance};
    let (without, with) = (gel(0.0), gel(0.2));
    let signal = with.minus(&without).unwrap();
    let record = recorded(|x| {
        let signal = signal.sweep(4e-3, &[x]).unwrap();
        signal.map(|signal| 0.8 * signal[0]).into_array()
    });
    let white = noise(Some(STATED), Correlation::None);
    let of_the_record = noise(None, Correlation::None);
    // What is unknown, the tolerance of the depth (m) and the noise; χ² and its degrees, T, γ, θ, threshold and rate of misses.
    #[rustfmt::skip]
    let cases: [(&[Unknown], _, _, _); 6] = [
        (&[Offset], 0.0, white,
            "799.4244995614722 319 5.824996501068192 9.915940204836977 8.597381925025607 2.0537489106318225 1.8873548914461486e-15"),
        (&[Offset, Drift, Gain], 0.0, white,
            "384.5330530254016 316 6.301881197215209 7.7741019113226715 18.77313639638376 2.0537489106318225 5.3151482144953576e-09"),
        (&[Offset, Drift, Gain, Depth], 0.3e-3, white,
            "384.45405287405015 315 6.301261218221724 7.774083880156563 18.768343173378145 2.0537489106318225 5.3157123313174165e-09"),
        (&[Offset, Drift, Gain], 0.3e-3, white,
            "384.5330530254016 316 6.301881197215209 7.7741019113226715 18.77313639638376 2.636816542338049 2.629043646583619e-06"),
        (&[Offset, Drift, Gain, Variance], 0.0, white,
            "384.5330530254016 316 5.712772308095997 7.047367719173405 14.687372168873093 2.0622612001565277 5.11354167711858e-7"),
        (&[Offset, Drift, Gain, Depth, Variance], 0.0, of_the_record,
            "314.9999862721934 315 5.431020422293289 6.727327051309264 13.30191441728586 2.0622883327535564 2.283796350787377e-6"),
    ];
    for (unknown, depth_tolerance, noise, expected) in cases {
        let question = Question {
            unknown,
            depth_tolerance,
            noise,
            criterion: TWO_PER_CENT,
            ..question(4e-3)
        };
        let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
        let found = question.judge(hypotheses, &record).unwrap();
        let (test, fit) = (found.test, found.fit);
        let chi_square = [fit.chi_square, fit.degrees];
        let of_t = [test.t, test.gamma, test.theta()];
        let decided = [at(found.threshold), found.rates.miss];
        let found_all = chi_square.into_iter().chain(of_t).chain(decided);
        for (found, expected) in found_all.zip(expected.split(' ')) {
            close(found, expected.parse().unwrap());
        }
        close(found.rates.false_alarm, 0.02);
        let gamma = match noise.sd {
            Some(_) => 11.669211961222613,
            None => 9.776655129796268,
        };
        close(found.gamma_nominal, gamma);
    }
}

// Over a gel whose force is the same everywhere, another gain is another offset: it adds no amplitude.
// Verifies: TRC-060, TRC-068, TRC-070, NUI-001.
#[test]
fn what_is_unknown_twice_counts_once() {
    let flat = |signal: f64| {
        let bump = move |x: f64| signal / (1.0 + 1e6 * x * x);
        let laterals: Vec<f64> = (-16..=16).map(|x| 5e-4 * f64::from(x)).collect();
        table_of(&[4e-3], &laterals, |_, x| {
            [60.0 * x * bump(x), 1.5 + bump(x)]
        })
    };
    let (without, with) = (flat(0.0), flat(0.2));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let record = record(without.laterals().to_vec(), |i| {
        [(i * i % 5) as f64 / 50.0, 1.4 + (i * i % 7) as f64 / 70.0]
    });
    for sd in [Some(STATED), None] {
        let judged = |unknown: &[Unknown]| {
            let level = sd.is_none().then_some(Unknown::Variance);
            let unknown: Vec<_> = unknown.iter().copied().chain(level).collect();
            let question = Question {
                unknown: &unknown,
                noise: noise(sd, Correlation::None),
                ..question(4e-3)
            };
            question.judge(hypotheses, &record).unwrap()
        };
        let once = judged(&[Unknown::Offset]);
        let twice = judged(&[Unknown::Offset, Unknown::Gain]);
        // 33 samples of two forces, less two offsets and the inclusion.
        assert_eq!([once.fit.degrees, twice.fit.degrees], [63.0; 2]);
        for [once, twice] in [
            [once.fit.chi_square, twice.fit.chi_square],
            [&once, &twice].map(|judged| judged.fit.noise_sd.normal.unwrap()),
            [once.test.t, twice.test.t],
            [once.test.gamma, twice.test.gamma],
            [once.posterior, twice.posterior],
        ] {
            close(twice, once);
        }
    }
}

// Verifies: TRC-011, TRC-014, TRC-015, TRC-068, TRC-070.
#[test]
fn a_lateral_force_that_is_not_there_counts_nowhere() {
    let (without, with) = (gel(0.0), gel(0.2));
    let signal = with.minus(&without).unwrap();
    let both = recorded(|x| {
        let signal = signal.sweep(4e-3, &[x]).unwrap();
        signal.map(|signal| 0.8 * signal[0]).into_array()
    });
    let one = both.clone().normal_alone();
    let maps_of_one = [&without, &with].map(ForceTable::of_normal);
    let judged = |record: &Record, [without, with]: [&ForceTable; 2], noise: Noise| {
        let known_level = &[Unknown::Offset, Unknown::Drift, Unknown::Gain][..];
        let question = Question {
            unknown: if noise.sd.is_none() {
                USUAL
            } else {
                known_level
            },
            noise,
            ..question(4e-3)
        };
        question.judge(Hypotheses::of_tables(without, with).unwrap(), record)
    };
    // χ², degrees, T, γ, γ if all were known, and the noise, of the normal force alone.
    for (sd, expected) in [
        (
            Some(STATED),
            "241.7926599020309 157 5.628875376068693 6.886509620972397 10.998195443250404 0.08",
        ),
        (
            None,
            "157 157 4.535758292249939 5.549162315936748 8.862366431773692 0.09927998827779684",
        ),
    ] {
        let noise = noise(sd, Correlation::OfRecord);
        let found = judged(&one, [&without, &with], noise).unwrap();
        let (test, fit) = (found.test, &found.fit);
        assert_eq!(fit.noise_sd.lateral, None);
        let numbers = [fit.chi_square, fit.degrees, test.t, test.gamma];
        let more = [found.gamma_nominal, fit.noise_sd.normal.unwrap()];
        let found_all = numbers.into_iter().chain(more);
        for (found, expected) in found_all.zip(expected.split(' ')) {
            close(found, expected.parse().unwrap());
        }
        assert!(found.rows().get("noise_sd_lateral_n").unwrap().is_null());
        // With maps of which either or both have no lateral force it is the same answer.
        let [f0, f1] = &maps_of_one;
        for maps in [[f0, f1], [&without, f1], [f0, &with]] {
            assert_eq!(judged(&one, maps, noise).unwrap(), found);
        }
        assert_error(
            judged(&both, [f0, f1], noise),
            "t.csv: the record has lateral forces, and the maps have none; leave out those of the record",
        );
    }
}

// Verifies: TRC-060, TRC-064.
#[test]
fn a_tolerance_of_depth_shifts_t_by_the_slope_between_the_rows_beside_it() {
    // The positions in mm, and the force of the signal and its slope over depth in N/mm, without and with the inclusion: d² has
    // the slope 2d between rows as far above as below.
    let x: Vec<f64> = (0..33).map(|i| 0.5 * f64::from(i) - 8.0).collect();
    let bump = |x: f64| 0.2 / ((1.0 + x * x / 4.0) * (1.0 + x * x / 4.0));
    let (mut gamma2, mut along) = (0.0, [0.0; 2]);
    for &x in &x {
        let [lateral, normal] = [-0.125 * x * bump(x), 0.25 * bump(x)];
        let weights = [
            1.0 / (STATED.lateral * STATED.lateral),
            1.0 / (STATED.normal * STATED.normal),
        ];
        let signal = [4.0 * lateral * weights[0], 4.0 * normal * weights[1]];
        gamma2 += 4.0 * (lateral * signal[0] + normal * signal[1]);
        let without = [0.005 * x, 0.75];
        for (along, signals) in along.iter_mut().zip([0.0, 1.0]) {
            *along += (without[0] + signals * lateral) * signal[0]
                + (without[1] + signals * normal) * signal[1];
        }
    }
    let slope = f64::max(along[0].abs(), along[1].abs()) / f64::sqrt(gamma2);
    let question = Question {
        depth_tolerance: 1e-4,
        noise: noise(Some(STATED), Correlation::None),
        criterion: TWO_PER_CENT,
        ..question(4e-3)
    };
    let (without, with) = (gel(0.0), gel(0.2));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let record = record(x.iter().map(|x| 1e-3 * x).collect(), |_| [0.0, 1.5]);
    let found = question.judge(hypotheses, &record).unwrap();
    // Φ⁻¹(0.98) by tables.
    close(at(found.threshold), 2.053_748_910_631_823 + 0.1 * slope);
}

/// A sweep of 401 samples at 4 mm over the gel with an inclusion of so much signal (N), in noise of 0.1 N.
fn sweep(signal: f64, stream: u64) -> Record {
    let positions: Vec<f64> = (0..401).map(|i| 4e-5 * f64::from(i) - 8e-3).collect();
    let exact = gel(signal).sweep(4e-3, &positions).unwrap();
    let generator = Generator::new(20_261_123, stream);
    record(positions, |i| {
        let noise = |channel| 0.1 * generator.normal(channel, i as u64);
        [exact.lateral[i] + noise(0), exact.normal[i] + noise(1)]
    })
}

/// The same question about a gel with a signal of 0.5 N, as the program asks it.
fn asked(record: &Record, unknown: &[Unknown], sd: Option<f64>) -> Judgement {
    let (without, with) = (gel(0.0), gel(0.5));
    let question = Question {
        unknown,
        noise: noise(sd.map(|sd| Force::new(sd, sd)), Correlation::OfRecord),
        ..question(4e-3)
    };
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    question.judge(hypotheses, record).unwrap()
}

/// A sweep of so many samples at 4 mm over the gel without an inclusion, in noise of 0.1 N.
fn short(samples: u32, stream: u64) -> Record {
    let step = 16e-3 / f64::from(samples - 1);
    let positions: Vec<f64> = (0..samples).map(|i| step * f64::from(i) - 8e-3).collect();
    let exact = gel(0.0).sweep(4e-3, &positions).unwrap();
    let generator = Generator::new(20_261_128, stream);
    record(positions, |i| {
        let noise = |channel| 0.1 * generator.normal(channel, i as u64);
        [exact.lateral[i] + noise(0), exact.normal[i] + noise(1)]
    })
}

// Verifies: TRC-068, CLI-041.
#[test]
fn too_few_samples_tell_no_noise() {
    let (without, with) = (gel(0.0), gel(0.5));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let judged = |record: &Record, unknown, sd: Option<f64>| {
        let question = Question {
            unknown,
            noise: noise(sd.map(|sd| Force::new(sd, sd)), Correlation::None),
            ..question(4e-3)
        };
        question.judge(hypotheses, record).map(|found| found.test)
    };
    let few = short(19, 1);
    let found =
        "t.csv: 19 samples, whose noise is not stated; give at least 20, or state the noise[..]";
    assert_error(judged(&few, USUAL, None), found);
    assert!(judged(&few, USUAL, Some(0.1)).is_ok());
    // One channel has Student's law, however few the samples are.
    assert!(judged(&few.normal_alone(), USUAL, None).is_ok());
    let found = "the noise is not stated, and its variance is taken as known; state the noise[..]";
    assert_error(judged(&short(20, 1), &[Unknown::Offset], None), found);
    assert!(judged(&short(20, 1), USUAL, None).is_ok());
}

// Verifies: TRC-068.
#[test]
#[ignore = "slow, and rarely breaks"]
fn the_estimate_of_two_noises_costs_at_most_the_false_alarms_that_are_said() {
    let (without, with) = (gel(0.0), gel(0.5));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let alarms = |samples| {
        let question = Question {
            unknown: USUAL,
            noise: noise(None, Correlation::None),
            criterion: Criterion::NeymanPearsonFalseAlarm {
                max_false_alarm: 0.01,
            },
            ..question(4e-3)
        };
        let alarm = |stream: &u64| {
            let found = question
                .judge(hypotheses, &short(samples, *stream))
                .unwrap();
            found.threshold.decide(found.test.t) == Decision::Inclusion
        };
        (0..20_000).filter(alarm).count()
    };
    // Of 20,000: so many times the stated 200 at most, and not much fewer.
    for (samples, times) in [(20, 1.7), (41, 1.3)] {
        let alarms = alarms(samples) as f64 / 200.0;
        assert!((0.85..times).contains(&alarms), "{samples}: {alarms}");
    }
}

// Verifies: TRC-016, TRC-075, CLI-143.
#[test]
fn a_sensor_set_to_zero_never_tells_that_there_is_nothing() {
    let judged = |record: &Record, stated: f64, criterion| {
        let (without, with) = (gel(0.0), gel(0.5));
        let sd = Some(Force::new(stated, stated));
        let question = Question {
            is_zeroed: true,
            unknown: USUAL,
            noise: noise(sd, Correlation::OfRecord),
            criterion,
            ..question(4e-3)
        };
        let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
        question.judge(hypotheses, record).unwrap()
    };
    let generator = Generator::new(20_261_127, 1);
    let white = |i: usize| [0, 1].map(|channel| 0.1 * generator.normal(channel, i as u64));
    let gel = sweep(0.0, 1);
    let air = record(gel.positions.clone(), white);
    // Thresholds far from noise alone.
    let few_misses = Criterion::NeymanPearsonMiss { max_miss: 1e-3 };
    for criterion in [Criterion::MaximumAPosteriori, few_misses] {
        for nothing in [&air, &gel] {
            let found = judged(nothing, 0.1, criterion);
            assert_eq!(
                (found.decision, &found.causes[..]),
                (None, &[Cause::Zeroed][..])
            );
            assert!(found.rows().get("posterior_h1").unwrap().is_f64());
        }
        let found = judged(&sweep(0.5, 1), 0.1, criterion);
        assert_eq!(
            (found.decision, &found.causes[..]),
            (Some(Decision::Inclusion), &[][..])
        );
    }
    // What does not fit is no record of air either.
    let found = judged(&air, 0.035, Criterion::MaximumAPosteriori);
    assert_eq!(
        (found.decision, &found.causes[..]),
        (None, &[Cause::Misfit][..])
    );
    assert!(found.rows().get("posterior_h1").unwrap().is_null());
}

/// All that is unknown unless a user says otherwise.
const USUAL: &[Unknown] = {
    use Unknown::{Drift, Gain, Offset, Variance};
    &[Offset, Drift, Gain, Variance]
};

// Verifies: TRC-077, TRC-065.
#[test]
fn a_prior_that_outweighs_both_channels_is_no_contradiction() {
    let (without, with) = (gel(0.0), gel(0.5));
    // θ is some 240, and ln(P0/P1) 691.
    let question = Question {
        unknown: USUAL,
        noise: noise(Some(Force::new(0.1, 0.1)), Correlation::OfRecord),
        prior_h1: 1e-300,
        ..question(4e-3)
    };
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let found = question.judge(hypotheses, &sweep(0.5, 1)).unwrap();
    let verdict = (found.decision, &found.causes[..]);
    assert_eq!(verdict, (Some(Decision::NoInclusion), &[][..]));
}

// Verifies: TRC-075.
#[test]
fn a_part_of_the_signal_is_not_none() {
    // γ is some 25: T of two fifths of the signal is 10 above 0 and 15 below γ, of a 25th 1 above 0.
    for (sd, unknown) in [(Some(0.1), &USUAL[..3]), (None, USUAL)] {
        let part = asked(&sweep(0.2, 1), unknown, sd);
        assert_eq!(
            (part.decision, &part.causes[..]),
            (None, &[Cause::Misfit][..])
        );
        assert!(part.test.theta() < 0.0);
        let little = asked(&sweep(0.02, 1), unknown, sd);
        assert_eq!(little.decision, Some(Decision::NoInclusion));
    }
    let zeroed = Question {
        is_zeroed: true,
        unknown: USUAL,
        noise: noise(None, Correlation::OfRecord),
        ..question(4e-3)
    };
    let (without, with) = (gel(0.0), gel(0.5));
    let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
    let found = zeroed.judge(hypotheses, &sweep(0.2, 1)).unwrap();
    assert_eq!(found.causes, [Cause::Misfit, Cause::Zeroed]);
}

// Verifies: TRC-070, TRC-075, TRC-016.
#[test]
fn a_record_that_cannot_be_judged_has_a_cause() {
    let held = {
        let mut record = sweep(0.5, 1);
        let columns = [&mut record.forces.lateral, &mut record.forces.normal];
        for column in columns {
            let values = column.clone();
            (0..column.len()).for_each(|i| column[i] = values[i / 2 * 2]);
        }
        record
    };
    // The lateral and the normal forces times these.
    let scaled = |signal: f64, lateral: f64, normal: f64| {
        let mut record = sweep(signal, 1);
        let forces = [&mut record.forces.lateral, &mut record.forces.normal];
        for (column, factor) in std::iter::zip(forces, [lateral, normal]) {
            column.iter_mut().for_each(|force| *force *= factor);
        }
        record
    };
    use Cause::{Coloured, ForceUnit, Misfit, Sign};
    for (record, stated, causes) in [
        (scaled(0.5, 1.0, 1.0), Some(0.1), &[][..]),
        (scaled(0.0, 1.0, 1.0), Some(0.1), &[]),
        // A gel that is nearly twice as stiff, in nearly twice the noise.
        (scaled(0.5, 1.9, 1.9), Some(0.19), &[]),
        // Millinewtons, gram-force, and a sensor the other way round, whose noise nobody states.
        (scaled(0.5, 1e3, 1e3), Some(0.1), &[ForceUnit, Misfit]),
        (scaled(0.5, 102.0, 102.0), None, &[ForceUnit]),
        (scaled(0.5, -1.0, -1.0), None, &[Sign]),
        (scaled(0.5, 1.0, 1.0), Some(0.035), &[Misfit]),
        (scaled(0.5, 1.0, 1.0), Some(0.29), &[Misfit]),
        (held, Some(0.1), &[Coloured]),
    ] {
        let found = asked(&record, USUAL, stated);
        assert_eq!(found.causes, causes, "{found:?}");
        assert_eq!(found.decision.is_none(), !causes.is_empty());
    }
}

// All is known but the size of the signal, so that what is left is z − (δᵀz/δᵀδ) δ. Forces of up to 3 N over 0.1 N lose 30 · 2⁻⁵³ each, and 162
// products of them less than 10⁻¹².
// Verifies: TRC-070, TRC-075, NUI-022.
#[test]
fn a_record_whose_neighbours_are_alike_is_coloured() {
    let (without, with) = (gel(0.0), gel(0.5));
    let positions: Vec<f64> = (0..81).map(|i| 2e-4 * f64::from(i) - 8e-3).collect();
    let of = |map: &ForceTable| map.sweep(4e-3, &positions).unwrap();
    let (exact, inclusion) = (of(&without), of(&with));
    for (correlation, causes) in [(0.0_f64, &[][..]), (0.45, &[Cause::Coloured])] {
        let generator = Generator::new(20_261_129, 1);
        let noise = [0, 1].map(|channel| {
            let mut state = generator.normal(channel, 0);
            let next = |i| {
                let step = (1.0 - correlation * correlation).sqrt() * generator.normal(channel, i);
                state = correlation * state + step;
                state
            };
            (1..82).map(next).collect::<Vec<f64>>()
        });
        let record = record(positions.clone(), |i| {
            [
                exact.lateral[i] + 0.1 * noise[0][i],
                exact.normal[i] + 0.1 * noise[1][i],
            ]
        });
        let asked = |correlation| {
            let question = Question {
                noise: self::noise(Some(Force::new(0.1, 0.1)), correlation),
                ..question(4e-3)
            };
            let hypotheses = Hypotheses::of_tables(&without, &with).unwrap();
            question.judge(hypotheses, &record).unwrap()
        };
        let found = asked(Correlation::OfRecord);
        let signal = [
            difference(&inclusion.lateral, &exact.lateral),
            difference(&inclusion.normal, &exact.normal),
        ];
        let sum = |a: &[Vec<f64>; 2], b: &[Vec<f64>; 2], lag: usize| -> f64 {
            let pairs = a.iter().zip(b).flat_map(|(a, b)| a.iter().zip(&b[lag..]));
            pairs.map(|(a, b)| a * b).sum()
        };
        let size = sum(&signal, &noise, 0) / sum(&signal, &signal, 0);
        let left = [0, 1].map(|channel| {
            let pairs = noise[channel].iter().zip(&signal[channel]);
            pairs.map(|(noise, signal)| noise - size * signal).collect()
        });
        let squares = sum(&left, &left, 0);
        let products = 161.0 / squares * sum(&left, &left, 1) + 1.0;
        let expected = products * products / (2.0 * 171.0) - 0.5 * 17.1_f64.ln();
        assert!((found.fit.theta_correlated.unwrap() - expected).abs() < 1e-9);
        assert_eq!(found.causes, causes, "{found:?}");
        // The test of all lags sees nothing.
        assert!(found.fit.whiteness.unwrap() > 1e-6);
        let white = asked(Correlation::None);
        assert_eq!(
            (white.fit.theta_correlated, &white.causes[..]),
            (None, &[][..])
        );
    }
}

// Verifies: CLI-143, PYT-049.
#[test]
fn each_cause_says_what_to_do_without_an_option_of_the_command_line() {
    use Cause::*;
    let causes = [
        Sign, ForceUnit, Level, Misfit, Coloured, Saturated, Glitches, NoContact, InAir, Narrow,
        Exchanged,
    ];
    for cause in causes {
        let words = cause.to_string();
        assert_eq!(words.matches(": ").count(), 1, "{words}");
        assert!(
            !words.contains("--") && !words.contains("header"),
            "{words}"
        );
    }
    let both = "samples at the start or at the end are in air: leave them out; the record is too weak to tell an inclusion from a disturbance that looks like one";
    assert_eq!(reasons(&[InAir, TooWeak]), both);
}

// Verifies: TRC-070.
#[test]
fn the_limits_of_chi_square() {
    let record = sweep(0.5, 2);
    let limits = |unknown, sd| asked(&record, unknown, sd).fit.limits;
    // SciPy: χ² with 802 − 6 and 802 − 1 degrees of freedom, 5·10⁻⁷ to either side.
    let known = &USUAL[..3];
    for (unknown, within, expected) in [
        (known, 1.0, [615.8671227778298, 1006.6805218906653]),
        (USUAL, 4.0, [615.8671227778298, 1006.6805218906653]),
        (&[][..], 1.0, [620.2558895848359, 1012.2918998427099]),
    ] {
        let [low, high] = limits(unknown, Some(0.1)).unwrap();
        close(low, expected[0] / within);
        close(high, expected[1] * within);
    }
    assert_eq!(limits(USUAL, None), None);
}

// Verifies: TRC-076.
#[test]
fn a_blank_sweep_tells_its_noise() {
    let generator = Generator::new(20_261_123, 4);
    let blank = |samples: u64, hold: u64, quiet: f64| {
        let rows = (0..samples).map(|i| {
            let noise = |channel| generator.normal(channel, i / hold);
            let (lateral, normal) = (0.05 * noise(0), quiet * noise(1));
            let line = 0.01 * i as f64;
            format!("{i},{},{}\n", 3.0 + line + lateral, -1.0 - line + normal)
        });
        let head = "time_ms,lateral_force_n,normal_force_n\n".to_string();
        Trace::from_csv(&(head + &rows.collect::<String>()), "blank.csv").unwrap()
    };
    // The least squares of a line, in the middle of the samples.
    let sd = |trace: &Trace, channel: usize| {
        let n = trace.samples.len() as f64;
        let rows = (0..).zip(&trace.samples);
        let rows = rows.map(|(i, (_, row))| (f64::from(i) - 0.5 * (n - 1.0), row[channel]));
        let rows = || rows.clone();
        let mean = rows().map(|(_, y)| y).sum::<f64>() / n;
        let (products, squares) = (rows().map(|(x, y)| x * y), rows().map(|(x, _)| x * x));
        let slope = products.sum::<f64>() / squares.sum::<f64>();
        let left = rows().map(|(x, y)| y - mean - slope * x);
        (left.map(|left| left * left).sum::<f64>() / (n - 2.0)).sqrt()
    };
    let trace = blank(400, 1, 0.2);
    let found = Noise::of_blank(&trace).unwrap();
    // White here, and tested in the record.
    assert_eq!(found.correlation, Correlation::OfRecord);
    let found = found.sd.unwrap();
    close(found.normal, sd(&trace, 1));
    close(found.lateral, sd(&trace, 2));
    let Correlation::Known(length) = Noise::of_blank(&blank(4000, 10, 0.2)).unwrap().correlation
    else {
        panic!("each value was held");
    };
    // τ is 10; its estimate has a standard deviation of √(2 · 51/4000) of it.
    assert!((length / 10.0 - 1.0).abs() < 0.5, "{length}");
    let few = "99 samples; give at least 100";
    for (trace, expected) in [
        (blank(99, 1, 0.2), few),
        (blank(100, 100, 0.2), "noise_sd_lateral_n"),
    ] {
        let error = Noise::of_blank(&trace).unwrap_err().to_string();
        let expected = format!("blank.csv: {expected}");
        assert!(error.starts_with(&expected), "{error}");
    }
}

// Verifies: TRC-017, TRC-010.
#[test]
fn samples_in_air_are_those_at_the_start_of_the_file_whichever_way_the_probe_went() {
    let there: Vec<f64> = (0..41).map(|k| 0.4e-3 * f64::from(k) - 8e-3).collect();
    let back: Vec<f64> = there.iter().rev().copied().collect();
    let maps = [0.0, 0.2].map(gel);
    let hypotheses = Hypotheses::of_tables(&maps[0], &maps[1]).unwrap();
    for over in [there, back] {
        let mut forces = maps[0].sweep(4e-3, &over).unwrap();
        forces.normal[..10].fill(0.0);
        let record = Record::new("sweep", &over, forces.as_deref()).unwrap();
        let found = question(4e-3).judge(hypotheses, &record).unwrap();
        assert_eq!(found.fit.in_air, [10, 0]);
        assert!(found.causes.contains(&Cause::InAir));
    }
}
