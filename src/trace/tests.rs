use super::*;
use crate::detect::{Decision, error_rates};
use crate::force_map::{Hypotheses, Matrix};

const EXAMPLE: &str = "position_mm,lateral_force_n,normal_force_n\n-1,0.25,1.5\n0.5,-0.5,1.25\n";

fn read(text: &str) -> Result<Record, String> {
    let trace = Trace::from_csv(text, "t.csv").map_err(|error| error.to_string())?;
    trace.record(None).map_err(|error| error.to_string())
}

/// A table at depths 1 and 3 mm over −3 … 3 mm by 1 mm: normal force 1 N, lateral 0.1 N, and with
/// `signal` times a bump at x = 0.
fn table(signal: f64) -> ForceTable {
    let laterals: Vec<f64> = (-3..=3).map(|k| f64::from(k) / 1e3).collect();
    let normal = [0.0, 0.125, 0.5, 1.0, 0.5, 0.125, 0.0];
    let lateral = [0.0, 0.25, 0.5, 0.0, -0.5, -0.25, 0.0];
    let matrix = |base: f64, bump: [f64; 7]| {
        Matrix::from_fn(2, 7, |row, column| {
            base + signal * (row + 1) as f64 * bump[column]
        })
    };
    let (normal, lateral) = (matrix(1.0, normal), matrix(0.1, lateral));
    ForceTable::new(vec![0.001, 0.003], laterals, Force::new(lateral, normal)).unwrap()
}

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

const NOISE: Force<f64> = Force::new(0.5, 0.25);

/// Whether the second map's inclusion lies under a sweep at `depth`; a priori one in four has it.
fn question<'a>(without: &'a ForceTable, with: &'a ForceTable, depth: f64) -> Question<'a> {
    Question {
        hypotheses: Hypotheses::of_tables(without, with).unwrap(),
        depth,
        noise_sd: NOISE,
        criterion: Criterion::Map,
        prior_h1: 0.25,
    }
}

fn find(record: &Record, signal: f64, criterion: Criterion) -> Result<Location, Refusal> {
    Question {
        criterion,
        ..question(&table(0.0), &table(signal), 0.003)
    }
    .locate(record)
}

// Verifies: TRC-001, TRC-002, TRC-003.
#[test]
fn columns_units_and_lines() {
    let expected = read(EXAMPLE).unwrap();
    assert_eq!(expected.positions(), [-0.001, 0.0005]);
    assert_eq!(expected.forces().lateral, [0.25, -0.5]);
    assert_eq!(expected.forces().normal, [1.5, 1.25]);
    let same = [
        "\u{feff}# pass 3\r\n\r\nposition_mm , lateral_force_n,normal_force_n\r\n -1,0.25 ,1.5\r\n #\r\n0.5,-0.5,1.25",
        "normal_force_mn,position_m,lateral_force_mn\n1500,-1e-3,250\n1250,0.0005,-500\n",
    ];
    for text in same {
        let record = read(text).unwrap();
        assert_eq!(record.positions(), expected.positions());
        assert_eq!(record.forces(), expected.forces());
    }
}

// Verifies: TRC-001, TRC-004, TRC-005, TRC-006, TRC-008.
#[test]
fn malformed_traces_are_refused_with_their_line() {
    // A text, where HEAD is a header and \n a line break, and under it the beginning of the refusal.
    let cases = r#"
        \n
        1: header "", expected position_mm,
        position,lateral_force_n,normal_force_n\n
        1: header "position,
        position_mm,time_s,lateral_force_n,normal_force_n\n
        1: header
        position_mm,lateral_force_n,lateral_force_mn\n
        1: header
        -1,0.25,1.5\n
        1: header "-1,0.25,1.5"
        HEAD
        1: no samples under the header, expected at least one row
        HEAD\n0,1\n
        2: 2 fields, expected 3
        HEAD\n0,1,2,3\n
        2: 4 fields, expected 3
        HEAD\n# c\n0,nan,2\n
        3: lateral_force_n = "nan", expected a finite decimal number
        HEAD\n0,1,inf\n
        2: normal_force_n = "inf"
        HEAD\n0,1,1e999\n
        2: normal_force_n = "1e999"
        HEAD\n0,,1\n
        2: lateral_force_n = ""
        HEAD\n0,1,1\n\n0,1,1\n
        4: position 0.0 mm after 0.0 mm, expected it to increase
        HEAD\n0,1,1\n-0.5,1,1\n
        3: position -0.5 mm after 0.0 mm
        HEAD\n0,1,1\n0.0000009,1,1\n
        3: position
        time_s,lateral_force_n,normal_force_n\n1,1,1\n1,1,1\n
        3: time 1.0 s after 1.0 s
        time_ms,lateral_force_n,normal_force_n\n1,1,1\n0,1,1\n
        3: time 0.0 s after 0.001 s
    "#;
    let lines: Vec<_> = cases.trim().lines().map(str::trim).collect();
    for case in lines.chunks(2) {
        let text = case[0].replace("\\n", "\n");
        let text = text.replace("HEAD", "position_mm,lateral_force_n,normal_force_n");
        let error = read(&text).unwrap_err();
        let expected = format!("t.csv:{}", case[1]);
        assert!(error.starts_with(&expected), "{text:?}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    assert!(read("").unwrap_err().starts_with("t.csv:1: header \"\""));
}

// Verifies: TRC-010, TRC-011, TRC-012, TRC-013.
#[test]
fn times_become_positions_by_the_motion() {
    let trace = || {
        let text = "time_s,lateral_force_n,normal_force_n\n1,1,2\n1.5,3,4\n";
        Trace::from_csv(text, "t.csv").unwrap()
    };
    let record = |velocity, start| trace().record(Some(Motion { velocity, start }));
    let there = record(0.5, -0.25).unwrap();
    assert_eq!(there.positions(), [0.25, 0.5]);
    assert_eq!(there.forces().lateral, [1.0, 3.0]);
    let back = record(-0.5, 0.25).unwrap();
    assert_eq!(back.positions(), [-0.5, -0.25]);
    assert_eq!(
        (back.forces().lateral, back.forces().normal),
        (&[3.0, 1.0][..], &[4.0, 2.0][..])
    );
    let wrong = [
        (trace().record(None), "t.csv: the samples have times"),
        (record(0.0, 0.0), "t.csv: velocity = 0 m/s"),
        (record(f64::NAN, 0.0), "t.csv: velocity = NaN m/s"),
        (record(1e-9, 0.0), "t.csv:3: position"),
        (
            record(f64::MAX, f64::MAX),
            "t.csv:2: position = inf m from this time",
        ),
    ];
    for (found, expected) in wrong {
        let error = found.unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
    let motion = Some(Motion {
        velocity: 1.0,
        start: 0.0,
    });
    let error = Trace::from_csv(EXAMPLE, "t.csv").unwrap().record(motion);
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("the samples have positions")
    );
}

// Verifies: TRC-020, TRC-022, TRC-023, CLI-043.
#[test]
fn a_record_at_a_known_position_by_hand() {
    // At 2 mm, half-way, the bump is 1.5 times that of the first row; at −0.5 mm, half-way, it is
    // 1.125 N normal, 0.375 N lateral.
    let record = read("position_mm,lateral_force_n,normal_force_n\n-0.5,0.1,2.125\n").unwrap();
    let found = question(&table(0.0), &table(1.0), 0.002).judge(&record);
    let Judgement {
        eta, assessment, ..
    } = found.unwrap();
    // r = (0, 1.125), Δ = (0.375, 1.125).
    let theta = -0.5 * 0.375 * 0.375 / 0.25 + 0.5 * 1.125 * 1.125 / 0.0625;
    let gamma = f64::sqrt(0.375 * 0.375 / 0.25 + 1.125 * 1.125 / 0.0625);
    assert!((assessment.statistic.theta - theta).abs() < 1e-12);
    assert!((assessment.statistic.gamma - gamma).abs() < 1e-12);
    assert!((eta - f64::ln(3.0)).abs() < 1e-15);
    assert_eq!(assessment.decision, Decision::Inclusion);
}

// Verifies: TRC-020, TRC-024, CLI-049.
#[test]
fn maps_that_do_not_fit_are_refused() {
    let judged = |record: &Record, reference: &ForceTable, depth: f64| {
        let found = question(reference, &table(1.0), depth).judge(record);
        found.unwrap_err().to_string()
    };
    let record = read(EXAMPLE).unwrap();
    let error = judged(&record, &table(1.0), 0.001);
    assert_eq!(
        error,
        "t.csv: the maps do not differ at the samples, expected a signal to decide by"
    );
    let error = judged(&record, &table(0.0), 0.0035);
    assert_eq!(
        error,
        "t.csv: depth 0.0035 m is outside the map, expected 0.001 to 0.003 m"
    );
    let far = read(&format!("{EXAMPLE}# far\n3.1,0,0\n")).unwrap();
    let error = judged(&far, &table(0.0), 0.001);
    assert_eq!(
        error,
        "t.csv:5: position 3.1 mm is outside the maps, expected -3.0 to 3.0 mm"
    );
    let other = ForceTable::new(
        vec![0.001, 0.0031],
        table(0.0).laterals().to_vec(),
        table(0.0).forces().clone(),
    );
    let error = Hypotheses::of_tables(&other.unwrap(), &table(1.0)).unwrap_err();
    let error = error.to_string();
    assert!(error.starts_with("depths_m[1] is 0.003"), "{error}");
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
    let map = find(&record, signal, Criterion::Map).unwrap();
    // The bump was moved from sample 3, at x = 0, to sample 5, at 2 mm.
    near(map.theta_max, plain[5].0);
    near(map.gamma, plain[5].1);
    assert!((map.position - 0.002).abs() < 0.0005, "{}", map.position);
    assert_eq!(map.candidates, 7);
    let likelihood: f64 = plain.iter().map(|(theta, _)| theta.exp()).sum();
    near(map.theta_mixture, (likelihood / 7.0).ln());
    near(map.posterior, 1.0 / (1.0 + 3.0 / (likelihood / 7.0)));
    near(map.eta, 3.0_f64.ln());
    assert!(map.by_mixture && map.decision == Decision::Inclusion);
    assert!(map.false_alarm_bound <= 1.0 / 3.0 + 1e-12);
    let miss = error_rates(map.gamma, 3.0_f64.ln() + 7.0_f64.ln())
        .unwrap()
        .miss;
    near(map.miss_bound, miss);
    let max_miss = 0.01;
    let miss = find(&record, signal, Criterion::NeymanPearsonMiss { max_miss }).unwrap();
    let etas = plain
        .iter()
        .map(|(_, gamma)| crate::detect::neyman_pearson_miss_threshold(*gamma, max_miss).unwrap());
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
        let seen = &bump[..7.min(10 - candidate)];
        let gamma = seen.iter().map(|b| b * b).sum::<f64>().sqrt() / NOISE.normal;
        let miss = error_rates(gamma, found.eta).unwrap().miss;
        assert!(miss < 0.01 + 1e-12, "{candidate}: {miss}");
    }
}

// Verifies: TRC-035, TRC-038.
#[test]
fn by_the_mixture_decision_and_posterior_agree_where_the_maximum_would_not() {
    // A record of zeros but for a weak bump: the best of 7 positions is more probable than none,
    // but an inclusion somewhere is not.
    let record = shifted(0.16, 1);
    let (without, with) = (table(0.0), table(0.16));
    let question = Question {
        prior_h1: 0.42,
        ..question(&without, &with, 0.003)
    };
    let found = question.locate(&record).unwrap();
    assert!(found.theta_max > found.eta, "{found:?}");
    assert!(found.posterior < 0.5, "{found:?}");
    assert_eq!(found.decision, Decision::NoInclusion);
}

// Verifies: TRC-037, TRC-039.
#[test]
fn a_scan_keeps_the_rate_of_false_alarms() {
    let criterion = Criterion::NeymanPearsonFalseAlarm {
        max_false_alarm: 0.01,
    };
    let found = find(&shifted(0.75, 2), 0.75, criterion).unwrap();
    assert!(found.false_alarm_bound <= 0.01 && found.false_alarm_bound > 0.0099);
    // No lower than the threshold for one position alone would be.
    assert!(found.eta > criterion.threshold(found.gamma, 0.25).unwrap());
}

// Verifies: TRC-034.
#[test]
fn the_bound_of_the_position_counts_what_the_record_holds() {
    // At sample 5 the last two template samples are off the record: j = −3 … 1 are seen. Slopes at
    // 3 mm depth, signal 1, in N/mm.
    let found = find(&shifted(1.0, 2), 1.0, Criterion::Map).unwrap();
    let lateral: [f64; 5] = [0.5, 0.5, -0.25, -1.0, -0.25];
    let normal: [f64; 5] = [0.25, 0.5, 0.875, 0.0, -0.875];
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
    let whole = find(&shifted(1.0, 1), 1.0, Criterion::Map).unwrap();
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
            noise_sd: noise,
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

// Verifies: TRC-030, TRC-031, TRC-033, TRC-041.
#[test]
fn records_that_cannot_be_scanned_are_refused() {
    let rows = |positions: &[&str]| {
        let rows = positions.iter().map(|position| format!("{position},0,1\n"));
        let head = "position_mm,lateral_force_n,normal_force_n\n".to_string();
        read(&(head + &rows.collect::<String>())).unwrap()
    };
    let refused = |record: &Record| find(record, 1.0, Criterion::Map).unwrap_err().to_string();
    let sweep = ["-3", "-2", "-1", "0", "1", "2", "3"];
    let mut uneven = sweep;
    uneven[2] = "-1.00001";
    assert!(find(&rows(&sweep), 1.0, Criterion::Map).is_ok());
    let error = refused(&rows(&uneven));
    assert!(
        error.starts_with("t.csv:4: position -1.00001 mm, expected -1.0 mm: a scan"),
        "{error}"
    );
    // Within 10⁻⁶ of a step.
    uneven[2] = "-1.0000009";
    assert!(find(&rows(&uneven), 1.0, Criterion::Map).is_ok());
    let error = refused(&rows(&["0"]));
    assert_eq!(error, "t.csv: 1 samples, expected 2 to 20000 for a scan");
    let error = refused(&rows(&sweep[1..]));
    assert!(
        error.starts_with("t.csv: 6 samples, expected at least the 7"),
        "{error}"
    );
    let many: Vec<String> = (0..=MOST_SAMPLES).map(|i| format!("{i}e-4")).collect();
    let error = refused(&rows(&many.iter().map(String::as_str).collect::<Vec<_>>()));
    assert_eq!(
        error,
        "t.csv: 20001 samples, expected 2 to 20000 for a scan"
    );
    let off = |signal| {
        let table = table(signal);
        let laterals = (1..=7).map(|k| f64::from(k) / 1e3).collect();
        ForceTable::new(table.depths().to_vec(), laterals, table.forces().clone()).unwrap()
    };
    let record = rows(&["1", "2", "3", "4", "5", "6", "7"]);
    let found = question(&off(0.0), &off(1.0), 0.003).locate(&record);
    let error = found.unwrap_err().to_string();
    assert!(
        error.contains("expected the inclusion's position, 0 mm"),
        "{error}"
    );
}

proptest::proptest! {
    // Verifies: TRC-007, TRC-008.
    #[test]
    fn no_text_makes_the_reader_panic(text in "(position_mm|time_s|lateral_force_n|normal_force_mn|[-0-9e.,#\r\n x\u{feff}]){0,40}") {
        if let Err(error) = Trace::from_csv(&text, "t.csv") {
            let error = error.to_string();
            proptest::prop_assert!(error.starts_with("t.csv") && !error.contains('\n'));
        }
        let text = format!("position_mm,lateral_force_n,normal_force_n\n{text}");
        let _ = Trace::from_csv(&text, "t.csv").map(|trace| trace.record(None));
    }
}
