//! Records searched for the inclusion.

use super::judge::{STATED, close, gel, question, record, recorded};
use super::*;
use crate::detect::{
    Decision, error_rates, neyman_pearson_false_alarm_threshold, neyman_pearson_miss_threshold,
};
use crate::stats::random::Generator;

const NOISE: Force<f64> = Force::new(0.5, 0.25);

/// A noiseless record at 3 mm depth over −3 … 3 mm by 1 mm with the bump moved by `shift` samples.
fn shifted(signal: f64, shift: usize) -> Record {
    let (reference, inclusion) = (table(0.0), table(signal));
    let both = reference.forces().as_ref().zip(inclusion.forces().as_ref());
    let force = both.map(|(reference, inclusion)| {
        let (reference, inclusion) = (reference.row(1), inclusion.row(1));
        move |i: usize| {
            let moved = i.saturating_sub(shift);
            reference[i] + inclusion[moved] - reference[moved]
        }
    });
    let mut text = String::from("position_mm,lateral_force_n,normal_force_n\n");
    for i in 0..7 {
        let (lateral, normal) = ((force.lateral)(i), (force.normal)(i));
        text += &format!("{},{lateral},{normal}\n", i as f64 - 3.0);
    }
    read(&text).unwrap()
}

fn find(record: &Record, signal: f64, criterion: Criterion) -> Location {
    let (without, with) = (table(0.0), table(signal));
    let question = Question {
        criterion,
        ..question(&without, &with, 0.003)
    };
    question.locate(record).unwrap()
}

/// Θ at candidate `n` of the 7 samples at 3 mm depth, by the sum of DET-050.
fn plain_theta(record: &Record, signal: f64, n: usize) -> (f64, f64) {
    let (reference, inclusion) = (table(0.0), table(signal));
    let (mut theta, mut energy) = (0.0, 0.0);
    for i in 0..7 {
        // Template sample j = i − n lies on record sample i; the maps hold j = −3 … 3.
        let Some(column) = (i + 3_usize).checked_sub(n).filter(|column| *column < 7) else {
            continue;
        };
        let maps = reference.forces().as_ref().zip(inclusion.forces().as_ref());
        let components = record.forces().zip(maps).zip(NOISE).into_array();
        for ((observed, (reference, inclusion)), sd) in components {
            let delta = inclusion.row(1)[column] - reference.row(1)[column];
            let residual = observed[i] - reference.row(1)[i];
            theta += delta * (residual - 0.5 * delta) / (sd * sd);
            energy += delta * delta / (sd * sd);
        }
    }
    (theta, energy.sqrt())
}

// Verifies: TRC-031, TRC-032, TRC-034, TRC-035, TRC-036, TRC-038, TRC-039, TRC-040, CLI-044.
#[test]
fn a_scan_is_the_plain_sum_over_the_candidates() {
    let signal = 0.75;
    let record = shifted(signal, 2);
    let plain: Vec<_> = (0..7).map(|n| plain_theta(&record, signal, n)).collect();
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
    let map = find(&record, signal, Criterion::Map);
    // The bump was moved from sample 3, at x = 0, to sample 5, at 2 mm.
    near(map.theta_max, plain[5].0);
    near(map.test.gamma, plain[5].1);
    assert!((map.position - 0.002).abs() < 0.0005, "{}", map.position);
    assert_eq!(map.candidates, 7);
    let likelihood: f64 = plain.iter().map(|(theta, _)| theta.exp()).sum();
    near(map.theta_mixture, (likelihood / 7.0).ln());
    near(map.posterior, 1.0 / (1.0 + 3.0 / (likelihood / 7.0)));
    near(map.eta, 3.0_f64.ln());
    assert!(map.by_mixture);
    assert!(map.false_alarm_bound <= 1.0 / 3.0 + 1e-12);
    let miss = error_rates(map.test.gamma, 3.0_f64.ln() + 7.0_f64.ln())
        .unwrap()
        .miss;
    near(map.miss_bound, miss);
    let max_miss = 0.01;
    let miss = find(&record, signal, Criterion::NeymanPearsonMiss { max_miss });
    let etas = plain
        .iter()
        .map(|(_, gamma)| neyman_pearson_miss_threshold(*gamma, max_miss).unwrap());
    near(miss.eta, etas.fold(f64::INFINITY, f64::min));
    assert!(!miss.by_mixture && miss.miss_bound <= max_miss);
}

// Verifies: TRC-036.
#[test]
fn the_promise_of_misses_is_kept_for_an_inclusion_at_any_sample() {
    // With its left end cut off by the record, the signal leaves γ = 1 to the last candidate and 2 to the one before, of 4.9.
    // Of γ²/2 + γΦ⁻¹(0.01) = −1.8, −2.7 and 0.6 the smallest is neither that of an end nor that of the smallest γ.
    let bump = [0.0, 0.0, 0.0, 0.25, 0.1875_f64.sqrt(), 1.0, 0.5];
    let map = |signal: f64| {
        let laterals = (-3..=3).map(|k| f64::from(k) / 1e3).collect();
        let normal = Matrix::from_fn(1, 7, |_, column| signal * bump[column]);
        ForceTable::new(
            vec![0.001],
            laterals,
            Force::new(Matrix::from_fn(1, 7, |_, _| 0.0), normal),
        )
        .unwrap()
    };
    let rows: String = (-3..=3).map(|x| format!("{x},0,0\n")).collect();
    let record = read(&format!(
        "position_mm,lateral_force_n,normal_force_n\n{rows}"
    ))
    .unwrap();
    let criterion = Criterion::NeymanPearsonMiss { max_miss: 0.01 };
    let (without, with) = (map(0.0), map(1.0));
    let question = Question {
        criterion,
        ..question(&without, &with, 0.001)
    };
    let found = question.locate(&record).unwrap();
    let quantile = -2.326_347_874_040_841;
    assert!(
        (found.eta - (2.0 + 2.0 * quantile)).abs() < 1e-12,
        "{found:?}"
    );
    for candidate in 0..7 {
        // Beyond the maps it is what it is at their end.
        let seen = (0..7).map(|i: usize| bump[(i + 3).saturating_sub(candidate).min(6)]);
        let gamma = seen.map(|b| b * b).sum::<f64>().sqrt() / NOISE.normal;
        let miss = error_rates(gamma, found.eta).unwrap().miss;
        assert!(miss < 0.01 + 1e-12, "{candidate}: {miss}");
    }
}

// Verifies: TRC-035, TRC-038.
#[test]
fn by_the_mixture_decision_and_posterior_agree_where_the_maximum_would_not() {
    // Noise without inclusion: in one of these the best of the positions is more probable than none, but an inclusion somewhere is not.
    let (without, with) = (table(0.0), table(0.3));
    let found = (0..50).map(|stream| {
        let generator = Generator::new(20_261_123, stream);
        let exact = without.sweep(0.003, without.laterals()).unwrap();
        let record = record(without.laterals().to_vec(), |i| {
            let noise = |channel| generator.normal(channel, i as u64);
            [
                exact.lateral[i] + 0.5 * noise(0),
                exact.normal[i] + 0.25 * noise(1),
            ]
        });
        question(&without, &with, 0.003).locate(&record).unwrap()
    });
    let found = found.filter(|found| found.theta_max > found.eta && found.posterior < 0.5);
    let found: Vec<Location> = found.collect();
    assert!(!found.is_empty());
    for found in found {
        assert_eq!(found.decision, Some(Decision::NoInclusion), "{found:?}");
    }
}

// Verifies: TRC-037, TRC-039.
#[test]
fn a_scan_keeps_the_rate_of_false_alarms() {
    let criterion = Criterion::NeymanPearsonFalseAlarm {
        max_false_alarm: 0.01,
    };
    let found = find(&shifted(0.75, 2), 0.75, criterion);
    assert!(found.false_alarm_bound <= 0.01 && found.false_alarm_bound > 0.0099);
    // No lower than the threshold for one position alone would be.
    let gamma = found.test.gamma;
    assert!(found.eta > neyman_pearson_false_alarm_threshold(gamma, 0.01).unwrap());
}

// Verifies: TRC-034.
#[test]
fn the_bound_of_the_position_counts_what_the_record_holds() {
    // At sample 5 the last two template samples are off the record: j = −3 … 1 are seen. Slopes at
    // 3 mm depth, signal 1, in N/mm, the mean of both sides.
    let found = find(&shifted(1.0, 2), 1.0, Criterion::Map);
    let lateral: [f64; 5] = [0.25, 0.5, -0.25, -1.0, -0.25];
    let normal: [f64; 5] = [0.125, 0.5, 0.875, 0.0, -0.875];
    let information: f64 = lateral.map(|s| s * s).iter().sum::<f64>() / 0.25
        + normal.map(|s| s * s).iter().sum::<f64>() / 0.0625;
    let expected = 1e-3 / information.sqrt();
    assert!(
        (found.position_sd_bound / expected - 1.0).abs() < 1e-9,
        "{found:?}"
    );
}

// Verifies: TRC-042.
#[test]
fn a_scan_tells_how_much_of_the_signal_the_maps_cut_off() {
    let whole = find(&shifted(1.0, 1), 1.0, Criterion::Map);
    assert_eq!(whole.template_edge, 0.0);
    // Over −1 … 2 mm alone the signal at 3 mm depth is (lateral) 1, 0, −1, −½ and (normal) 1, 2, 1, ¼ N: over
    // the noise of each channel it is at most 2 and 4 at the ends, of at most 8.
    let cut = |signal: f64| {
        let whole = table(signal);
        let part =
            |matrix: &Matrix| Matrix::from_fn(2, 4, |row, column| matrix.row(row)[column + 2]);
        let laterals = whole.laterals()[2..6].to_vec();
        let (normal, lateral) = (part(&whole.forces().normal), part(&whole.forces().lateral));
        ForceTable::new(
            whole.depths().to_vec(),
            laterals,
            Force::new(lateral, normal),
        )
        .unwrap()
    };
    let record = read(
        "position_mm,lateral_force_n,normal_force_n\n-1,1.1,2\n0,0.1,3\n1,-0.9,2\n2,-0.4,1.25\n",
    );
    let record = record.unwrap();
    let edge = |noise| {
        let (without, with) = (cut(0.0), cut(1.0));
        let question = Question {
            noise: Noise {
                sd: Some(noise),
                correlation: Correlation::None,
            },
            ..question(&without, &with, 0.003)
        };
        question.locate(&record).unwrap().template_edge
    };
    assert!((edge(NOISE) - 0.5).abs() < 1e-12);
    // Where the lateral force is the quiet one, its largest is at an end: 8 of 8, and 1 of 2 in the normal force.
    assert!(
        (edge(Force {
            lateral: 0.125,
            normal: 1.0
        }) - 1.0)
            .abs()
            < 1e-12
    );
}

// Verifies: TRC-031, TRC-032, TRC-033, TRC-034, TRC-035, TRC-036, TRC-037, TRC-038, TRC-042.
#[test]
fn a_scan_over_any_positions_beside_nuisances() {
    use Unknown::{Drift, Gain, Offset};
    let (without, with) = (gel(0.0), gel(0.2));
    let signal = with.minus(&without).unwrap();
    let record = recorded(|x| {
        // Up to −6.63 mm the maps do not reach.
        let signal = signal.sweep(4e-3, &[(x - 1.37e-3).max(-8e-3)]).unwrap();
        signal.map(|signal| 0.9 * signal[0]).into_array()
    });
    let locate = |criterion| {
        let question = Question {
            unknown: &[Offset, Drift, Gain],
            noise: Noise {
                sd: Some(STATED),
                correlation: Correlation::None,
            },
            criterion,
            ..question(&without, &with, 4e-3)
        };
        question.locate(&record).unwrap()
    };
    // NumPy, a QR for each of the 161 positions.
    let found = locate(Criterion::Map);
    assert_eq!(found.candidates, 161);
    assert_eq!(found.decision, Some(Decision::Inclusion));
    for (found, expected) in [
        (found.theta_max, 26.644955622034153),
        (found.test.t, 7.331113672096765),
        (found.test.gamma, 8.00588506237336),
        (found.gamma_nominal, 11.668845377380528),
        (found.theta_mixture, 22.765838661527493),
        (found.position, 1.3712443973127422e-3),
        (found.position_sd_bound, 0.14068585345333437e-3),
        (found.template_edge, 0.011072664359861541),
        (found.fit.chi_square, 384.5230453847521),
    ] {
        close(found, expected);
    }
    let max_false_alarm = 1e-3;
    let found = locate(Criterion::NeymanPearsonFalseAlarm { max_false_alarm });
    close(found.eta, 8.02584229145231);
    let found = locate(Criterion::NeymanPearsonMiss { max_miss: 0.01 });
    close(found.eta, -1.383139429109085);
}

// Verifies: TRC-032.
#[test]
fn positions_that_the_record_cannot_tell_of_are_left_out() {
    // The signal is between −3 and −1 mm of its position, the record over 0 … 3 mm: it sees none before 1 mm, and only a corner at 1 mm.
    let map = |signal: f64| {
        let bump = [0.0, signal, 0.0, 0.0, 0.0, 0.0, 0.0];
        let normal = Matrix::from_fn(1, 7, |_, column| 1.0 + bump[column]);
        let laterals = (-3..=3).map(|x| 1e-3 * f64::from(x)).collect();
        let forces = Force::new(Matrix::from_fn(1, 7, |_, _| 0.0), normal);
        ForceTable::new(vec![0.001], laterals, forces).unwrap()
    };
    let (without, with) = (map(0.0), map(1.0));
    let record = record((0..7).map(|i| 0.5e-3 * f64::from(i)).collect(), |_| {
        [0.0, 1.0]
    });
    let found = question(&without, &with, 0.001).locate(&record).unwrap();
    // At 1.5, 2, 2.5 and 3 mm.
    assert_eq!(found.candidates, 4);
}

// Verifies: TRC-031.
#[test]
fn maps_without_the_inclusions_position_are_refused() {
    let off = |signal| {
        let table = table(signal);
        let laterals = (1..=7).map(|k| f64::from(k) / 1e3).collect();
        ForceTable::new(table.depths().to_vec(), laterals, table.forces().clone()).unwrap()
    };
    let record = record(vec![1e-3, 2e-3, 3e-3], |_| [0.0, 1.0]);
    let found = question(&off(0.0), &off(1.0), 0.003).locate(&record);
    let error = found.unwrap_err().to_string();
    let expected = "t.csv: the maps cover 1.0 to 7.0 mm, expected the inclusion's position, 0 mm";
    assert!(error.starts_with(expected), "{error}");
}
