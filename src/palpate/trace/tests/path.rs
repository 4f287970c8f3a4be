//! Records whose samples have depths of their own.

use super::judge::question;
use super::*;
use crate::csv::Layout;
use crate::fem::{Contact, Model};
use crate::force_map::tests::table_of;
use crate::phantom::Phantom;
use crate::stats::random::Generator;
use crate::trace::design::{Design, difference, expected, slope};
use palpate_asserts::assert_near;

/// Forces that are a cubic of the depth (mm) and a line in x (mm), over rows of uneven steps.
fn cubic() -> ForceTable {
    let laterals = [-8e-3, -2e-3, 1e-3, 8e-3];
    table_of(&[1e-3, 2e-3, 2.5e-3, 3e-3, 4e-3], &laterals, |d, x| {
        let [lateral, normal] = force(1e3 * d, 1e3 * x);
        [lateral, normal]
    })
}

fn force(d: f64, x: f64) -> [f64; 2] {
    let of = |x: f64| 0.2 + 0.3 * d - 0.1 * d * d + 0.02 * x * d * d * d;
    [of(-x) - 0.5, of(x)]
}

fn along(x: &[f64], d: &[f64]) -> Record {
    let metres = |mm: &[f64]| -> Vec<f64> { mm.iter().map(|mm| 1e-3 * mm).collect() };
    let zeros = vec![0.0; x.len()];
    Record::along("t.csv", &metres(x), &metres(d), Force::new(&zeros, &zeros)).unwrap()
}

// Verifies: TRC-080, TRC-081.
#[test]
fn a_column_of_depths_makes_a_path() {
    let layout = |text: &str| text.parse::<Layout>().unwrap();
    let read = |text: &str, columns: &str| {
        let trace = Trace::from_csv_as(text, "t.csv", &layout(columns)).unwrap();
        trace.record(None).unwrap()
    };
    let rows = "3,1.5,1\n-3,2,2\n3,2.5,4\n";
    for (header, columns) in [
        ("position_mm,depth_mm,normal_force_n", "normal=3[N]"),
        ("position_mm,Z(mm),normal_force_n", "depth=Z(mm)"),
        ("position_mm,note,normal_force_n", "depth=2[mm]"),
        ("x (mm),Depth_mm,Fz (N)", "normal=3[N]"),
    ] {
        let record = read(&format!("{header}\n{rows}"), columns);
        assert_eq!(record.positions(), [3e-3, -3e-3, 3e-3], "{header}");
        assert_eq!(record.depths().unwrap(), [1.5e-3, 2e-3, 2.5e-3]);
        assert_eq!(record.forces().normal, [1.0, 2.0, 4.0]);
        assert!(record.forces().lateral.is_empty());
    }
    // In time, over which the probe moves to the left.
    let text = "time_s,depth_m,lateral_force_n,normal_force_n\n0,0.001,5,1\n1,0.002,6,2\n";
    let motion = Motion {
        velocity: -1e-3,
        start: 2e-3,
    };
    let trace = Trace::from_csv(text, "t.csv").unwrap();
    let record = trace.record(Some(motion)).unwrap();
    assert_eq!(record.positions(), [2e-3, 1e-3]);
    assert_eq!(record.depths().unwrap(), [1e-3, 2e-3]);
    assert_eq!(record.forces().lateral, [5.0, 6.0]);
    // Another name is no depth, and then there is one pass.
    for name in ["displacement (mm)", "indentation_mm", "depth", "depth (mm)"] {
        let text = format!("position_mm,{name},normal_force_n\n-3,1,1\n3,2,2\n");
        let trace = Trace::from_csv(&text, "t.csv").unwrap();
        assert_eq!(trace.notes()[0], format!("column {name:?} is not used"));
        assert_eq!(trace.record(None).unwrap().depths(), None);
    }
    let back = "position_mm,normal_force_n\n3,1\n-3,2\n3,4\n";
    assert!(Trace::from_csv(back, "t.csv").is_err());
}

// Verifies: TRC-081.
#[test]
fn the_lists_of_a_path_have_one_length() {
    for lengths in [
        [1, 2, 2],
        [2, 1, 2],
        [2, 3, 2],
        [2, 0, 2],
        [2, 2, 1],
        [2, 2, 3],
    ] {
        let [x, depths, normal] = lengths.map(|length| vec![1e-3; length]);
        let path = Record::along("t.csv", &x, &depths, Force::new(&[][..], &normal));
        assert!(path.is_err(), "{lengths:?}");
    }
}

// Verifies: TRC-082, MAP-090.
#[test]
fn forces_are_those_of_each_pose() {
    let (x, d) = ([-8.0, 0.3, 7.9, 0.3, -2.0], [1.0, 1.4, 2.2, 2.7, 3.9]);
    let record = along(&x, &d);
    let found = record.expected(&cubic(), f64::NAN).unwrap();
    for at in 0..5 {
        let [lateral, normal] = force(d[at], x[at]);
        // A dozen roundings of forces of up to 12 N.
        assert_near(found.normal[at], normal, 1e-13);
        assert_near(found.lateral[at], lateral, 1e-13);
    }
    // Rows count to the bit, half a nanometre off too.
    for (row, depth) in [(0, 1.0 - 5e-7), (2, 2.5), (4, 4.0 + 5e-7)] {
        let at_row = along(&[-8.0, -2.0, 1.0, 8.0], &[depth; 4]);
        let found = at_row.expected(&cubic(), f64::NAN).unwrap();
        assert_eq!(found.normal, cubic().normal().row(row));
    }
    // Two rows make a line, and one row stands for itself.
    let line = table_of(&[1e-3, 3e-3], &[0.0, 1e-3], |d, _| [0.0, 1e3 * d]);
    let found = along(&[0.5, 0.5], &[1.5, 3.0])
        .expected(&line, 0.0)
        .unwrap();
    assert_near(found.normal[0], 1.5, 1e-15);
    let one = table_of(&[2e-3], &[0.0, 1e-3], |_, x| [0.0, 1e3 * x]);
    assert_eq!(
        along(&[0.5], &[2.0]).expected(&one, 0.0).unwrap().normal,
        [0.5]
    );
    assert!(along(&[0.5], &[2.1]).expected(&one, 0.0).is_err());
    let far = along(&[0.0, 1.0, 1.0], &[1.0, 5.0, 0.9]);
    assert_error(
        far.expected(&cubic(), 0.0),
        "t.csv:2: position 1.0 mm at a depth of 5.0 mm is outside the maps, which have -8.0 to 8.0 mm at depths of 1.0 to 4.0 mm; leave it out, or use --trim",
    );
    let (kept, note) = far.trimmed(&cubic()).unwrap();
    assert_eq!(kept.depths().unwrap(), [1e-3]);
    assert!(note.unwrap().starts_with("2 of 3 samples left out"));
}

// Solved between the rows, not interpolated.
// Verifies: MAP-091.
#[test]
fn four_rows_tell_the_forces_between_them() {
    let model = |name: &str| {
        let phantom = Phantom::builtin(name).unwrap();
        Model::new(&phantom, 0.65e-3, Contact::default()).unwrap()
    };
    let x = [0.0, 3e-3];
    let worst = |name: &str, rows: &[f64], between: &[f64]| {
        let model = model(name);
        let metres = |mm: &[f64]| -> Vec<f64> { mm.iter().map(|mm| 1e-3 * mm).collect() };
        let map = model.map(&metres(rows), &x, &|_| true).unwrap();
        let solved = model.map(&metres(between), &x, &|_| true).unwrap();
        let (mut of_path, mut of_line) = (0.0, 0.0);
        for (row, &depth) in metres(between).iter().enumerate() {
            let path = map.table().path(&[depth; 2], &x).unwrap();
            let line = map.table().sweep(depth, &x).unwrap();
            for (channel, right) in [solved.table().lateral().unwrap(), solved.table().normal()]
                .into_iter()
                .enumerate()
            {
                let off = |found: &Force<Vec<f64>>, at: usize| {
                    (found.as_deref().into_array()[channel][at] - right.row(row)[at]).abs()
                };
                for at in 0..2 {
                    of_path = f64::max(of_path, off(&path, at));
                    of_line = f64::max(of_line, off(&line, at));
                }
            }
        }
        [of_path, of_line]
    };
    for name in ["none", "4.6", "2.6"] {
        let [path, line] = worst(name, &[1.0, 2.0, 3.0, 4.0], &[1.3, 1.5, 2.4, 2.75, 3.5]);
        assert!(path < 1e-3 && line > 12e-3, "{name}: {path:e} {line:e}");
        let half: Vec<f64> = (0..=8).map(|row| 0.5 * f64::from(row)).collect();
        let [path, line] = worst(name, &half, &[0.1, 0.25, 0.75, 1.3, 2.2, 3.8]);
        assert!(path < 2.5e-3 && line > 3e-3, "{name}: {path:e} {line:e}");
    }
}

// Verifies: TRC-083.
#[test]
fn passes_end_where_the_probe_turns() {
    let lines = |x: &[f64]| {
        let passes = along(x, &vec![2.0; x.len()]).passes();
        passes
            .iter()
            .map(|pass| pass.lines.clone())
            .collect::<Vec<_>>()
    };
    // Forth and back, towards +x each.
    assert_eq!(
        lines(&[-4.0, 0.0, 4.0, 3.0, -4.0, -3.0]),
        [&[1, 2, 3][..], &[5, 4], &[6]]
    );
    // Jitter of 5 % of 8 mm is no turn, and a rest at the turn is of the pass before it.
    assert_eq!(
        lines(&[-4.0, 0.0, -0.4, 4.0, 4.0, -4.0]),
        [&[1, 2, 3, 4, 5][..], &[6]]
    );
    assert_eq!(lines(&[-4.0, 0.0, -0.41, 4.0]), [&[1, 2][..], &[3, 4]]);
    // A probe that is lifted and comes down where it began.
    assert_eq!(
        lines(&[-4.0, 0.0, 4.0, -4.0, 0.0, 4.0]),
        [[1, 2, 3], [4, 5, 6]]
    );
    assert_eq!(lines(&[1.0, 1.0, 1.0]), [[1, 2, 3]]);
    let passes = along(&[-4.0, 4.0, 3.0, -3.0], &[1.0, 2.0, 3.0, 4.0]).passes();
    assert_eq!(passes[1].depths().unwrap(), [4e-3, 3e-3]);
    assert_eq!(passes[1].travelled(), [6e-3, 0.0]);
    // All are of one place.
    assert_eq!(passes[1].place(), Some([-4e-3, 4e-3]));
    let pass = read(EXAMPLE).unwrap();
    assert_eq!(pass.passes(), std::slice::from_ref(&pass));
}

// Verifies: TRC-084.
#[test]
fn the_slope_is_that_of_each_depth() {
    let table = table_of(&[0.0, 1e-3, 2e-3, 4e-3], &[0.0, 1e-3], |d, _| {
        [1e3 * d, 1e6 * d * d]
    });
    let record = along(&[0.5, 0.5, 0.5, 0.5], &[0.0, 0.98, 3.0, 4.0]);
    let found = slope(&record, &table, f64::NAN, expected).unwrap().unwrap();
    // ∂F_n/∂d is 2d, N/mm; where it touches, half of the 2 · 0.025 below; at the last row, over 0.05 mm on one side, 2d − 0.05.
    let expected_slopes = [[0.5, 0.025], [1.0, 1.96], [1.0, 6.0], [1.0, 7.95]];
    for (at, [lateral, normal]) in expected_slopes.into_iter().enumerate() {
        assert_near(1e-3 * found[4 + at], normal, 1e-10);
        assert_near(1e-3 * found[at], lateral, 1e-10);
    }
    let one = table_of(&[2e-3], &[0.0, 1e-3], |_, _| [0.0, 1.0]);
    let at_row = along(&[0.5], &[2.0]);
    assert_eq!(slope(&at_row, &one, 0.0, expected), Ok(None));
}

/// Four passes over the gel of `judge.rs` at 3.7 … 4.3 mm, with the inclusion if there is a signal; `beside` adds to the normal force.
fn path(signal: f64, beside: impl Fn(usize) -> f64) -> Record {
    let x = |at: usize| {
        let (pass, step) = (at / 41, at % 41);
        let x = 0.4e-3 * step as f64 - 8e-3;
        if pass % 2 == 0 { x } else { -x }
    };
    let x: Vec<f64> = (0..164).map(x).collect();
    let d: Vec<f64> = (0..164)
        .map(|at| 3.7e-3 + 0.2e-3 * (at / 41) as f64)
        .collect();
    let mut forces = judge::gel(signal).path(&d, &x).unwrap();
    for (at, force) in forces.normal.iter_mut().enumerate() {
        *force += beside(at);
    }
    Record::along("t.csv", &x, &d, forces.as_deref()).unwrap()
}

fn judged(question: &Question<'_>, record: &Record) -> Judgement {
    let maps = [0.0, 0.2].map(judge::gel);
    let hypotheses = Hypotheses::of_tables(&maps[0], &maps[1]).unwrap();
    question.judge(hypotheses, record).unwrap()
}

// Verifies: TRC-085, TRC-065.
#[test]
fn a_drift_is_one_of_time_and_an_unknown_depth_of_all_samples() {
    let noise = |at: usize| 0.02 * Generator::new(8, 1).normal(0, at as u64);
    let of = |unknown, beside: &dyn Fn(usize) -> f64| {
        let question = Question {
            unknown,
            depth: f64::NAN,
            ..question(0.0)
        };
        judged(&question, &path(0.2, |at| noise(at) + beside(at)))
            .test
            .t
    };
    let drift = |at: usize| 0.4 * at as f64 / 163.0;
    let unknown = &[Unknown::Offset, Unknown::Drift][..];
    // The drift is of the space of the nuisances: 13 digits of forces of 2 N over noise of 0.05 N are left.
    assert_near(of(unknown, &drift), of(unknown, &|_| 0.0), 1e-9);
    // All depths off by 0.05 mm: the gel's force is a quadratic of the depth, whose change by it is 0.05 mm times the slope, and
    // (0.05 mm)²/2 times its curvature, a constant.
    let maps = judge::gel(0.0);
    let there = path(0.0, |_| 0.0);
    let moved = there.moved(|d| d + 0.05e-3 * if *d > 4.2e-3 { -1.0 } else { 1.0 });
    let change = {
        let [a, b] = [&there, &moved].map(|of| of.expected(&maps, 0.0).unwrap().normal);
        move |at: usize| {
            if at < 123 {
                b[at] - a[at]
            } else {
                a[at] - b[at]
            }
        }
    };
    let off = |unknown| (of(unknown, &change) - of(unknown, &|_| 0.0)).abs();
    let (fitted, known) = (off(&[Unknown::Depth]), off(&[]));
    assert!(fitted < 0.05 && known > 0.5, "{fitted} {known}");
}

// Verifies: TRC-082, TRC-064.
#[test]
fn a_column_of_one_depth_is_that_depth() {
    let sweep = judge::recorded(|_| [0.0, 0.0]);
    let depths = vec![4e-3; sweep.positions().len()];
    let with = Record::along("t.csv", sweep.positions(), &depths, sweep.forces()).unwrap();
    let question = Question {
        unknown: &[Unknown::Offset, Unknown::Drift, Unknown::Gain],
        ..question(4e-3)
    };
    assert_eq!(judged(&question, &with), judged(&question, &sweep));
    // The forces are a quadratic of the depth: the slope over 0.1 mm is that over 0.6 mm, but for rounding of 2 N over 0.1 mm.
    let tolerant = Question {
        depth_tolerance: 0.3e-3,
        ..question
    };
    let [with, sweep] = [&with, &sweep].map(|record| judged(&tolerant, record).test.bias);
    assert!(sweep > 0.1);
    assert_near(with / sweep, 1.0, 1e-9);
}

// Verifies: TRC-086.
#[test]
fn errors_of_the_depths_are_noise_of_both_channels() {
    let of = |unknown, sd: f64| {
        let record = path(0.2, |at| 0.01 * (at % 7) as f64)
            .with_depth_sd(sd)
            .unwrap();
        let question = Question {
            unknown,
            ..question(0.0)
        };
        let maps = [0.0, 0.2].map(judge::gel);
        let mut design = Design::new(&question, &maps[0], &record).unwrap();
        let with = expected(&record, &maps[1], question.depth).unwrap();
        design.template = difference(&with, &design.reference);
        let sd = question.noise.sd.unwrap();
        (design.clone(), design.whitened(sd), sd)
    };
    let (plain, white, sd) = of(&[], 0.1e-3);
    let slope = slope(&path(0.2, |_| 0.0), &judge::gel(0.0), 0.0, expected);
    let slope = slope.unwrap().unwrap();
    // aᵀC⁻¹b by the inverse of a matrix of two rows.
    let mut right = 0.0;
    for at in 0..164 {
        let [u, v] = [at, at + 164].map(|at| 0.1e-3 * slope[at]);
        let [a, b, c] = [
            sd.lateral * sd.lateral + u * u,
            u * v,
            sd.normal * sd.normal + v * v,
        ];
        let [p, q] = [&plain.residual, &plain.template].map(|part| [part[at], part[at + 164]]);
        let sum = c * p[0] * q[0] - b * (p[0] * q[1] + p[1] * q[0]) + a * p[1] * q[1];
        right += sum / (a * c - b * b);
    }
    let pairs = white.residual.iter().zip(&white.template);
    let found: f64 = pairs.map(|(a, b)| a * b).sum();
    assert_near(found / right, 1.0, 1e-12);
    assert!(
        slope.iter().take(164).any(|of| of.abs() > 1.0),
        "both channels"
    );
    // Without errors it is the noise of the forces alone.
    let (plain, white, sd) = of(&[], 0.0);
    assert_eq!(white.residual[0], plain.residual[0] * (1.0 / sd.lateral));
    let record = path(0.2, |_| 0.0).with_depth_sd(1e-4).unwrap();
    let maps = [0.0, 0.2].map(judge::gel);
    let estimated = Question {
        unknown: &[Unknown::Variance],
        noise: Noise {
            sd: None,
            correlation: Correlation::None,
        },
        ..question(0.0)
    };
    let hypotheses = Hypotheses::of_tables(&maps[0], &maps[1]).unwrap();
    assert_error(
        estimated.judge(hypotheses, &record),
        "[..]the errors of the depths cannot be told from noise that is estimated; state the noise[..]",
    );
    assert!(path(0.0, |_| 0.0).with_depth_sd(-1.0).is_err());
    assert!(judge::recorded(|_| [0.0; 2]).with_depth_sd(1e-4).is_err());
}

// Verifies: MAP-090, TRC-082.
#[test]
fn above_the_gel_there_is_no_force() {
    let table = table_of(&[0.0, 1e-3, 2e-3], &[0.0, 1e-3], |d, x| [x, 1e3 * d + x]);
    let record = along(&[0.0, 0.5, 1.0, 1.0], &[-2.0, -0.001, 0.0, 1.0]);
    let found = record.expected(&table, 0.0).unwrap();
    assert_eq!(found.normal, [0.0, 0.0, 1e-3, 1.001]);
    assert_eq!(found.lateral, [0.0, 0.0, 1e-3, 1e-3]);
    let (kept, note) = record.trimmed(&table).unwrap();
    assert!(kept.positions().len() == 4 && note.is_none());
    let slope = slope(&along(&[0.0, 0.5], &[-2.0, 1.5]), &table, 0.0, expected);
    let slope = slope.unwrap().unwrap();
    assert_eq!(slope[2], 0.0);
    // N/m of the normal force: 1e3.
    assert_near(slope[3], 1e3, 1e-9);
    assert!(table.path(&[f64::NEG_INFINITY], &[0.0]).is_err());
    // A map that begins in the gel says nothing of what is above it.
    let deep = table_of(&[1e-3, 2e-3], &[0.0, 1e-3], |d, _| [0.0, d]);
    assert!(along(&[0.0], &[-1.0]).expected(&deep, 0.0).is_err());
}
