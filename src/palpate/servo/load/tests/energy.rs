//! A passivity observer: a hand that is moved along closed paths on tables that were accepted gets no energy from the device.

use super::super::*;
use crate::servo::{Command, Input, Mode, Request, Sample, State, step};
use crate::stats::random::Generator;

/// Parts of a cycle in which the work is added up.
const PARTS: usize = 4;

/// The paper's display, whose force comes so many periods late.
fn display(delay_periods: u16) -> Damping {
    Damping {
        period_s: 1e-3,
        delay_periods,
        damping_n_s_per_m: 0.6,
        friction_n: 0.14,
        resolution_m: 1e-6,
    }
}

fn limits() -> Limits {
    Limits::new(4.0, 0.25, 0.5, 20).unwrap()
}

/// A closed path of a hand: where it is (lateral, depth) at each part of each cycle.
struct Path(Vec<[f64; 2]>);

impl Path {
    /// Along `curve`, over the phase from 0 to 1, at `speed` (m/s) where it is fastest. Ends with a rest outside of the gel.
    fn along(curve: impl Fn(f64) -> [f64; 2], speed: f64, period: f64) -> Path {
        const SAMPLES: usize = 256;
        let at = |index: usize| curve(index as f64 / SAMPLES as f64);
        let step = |k| {
            let (a, b) = (at(k), at(k + 1));
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let longest = (0..SAMPLES).map(step).fold(0.0, f64::max);
        // A chord is a little shorter than the path at its steepest.
        let time = 1.001 * longest * SAMPLES as f64 / speed;
        let cycles = (time / period).ceil() as usize;
        let parts = cycles * PARTS;
        let point = |part: usize| curve((part as f64 / parts as f64).min(1.0));
        Path((0..=parts + 30 * PARTS).map(point).collect())
    }
}

/// The energy, J, that a hand on `path` gives to the device.
fn energy(table: &Table, damping: &Damping, limits: &Limits, path: &Path) -> f64 {
    let mut state = State::default();
    let mut sequence = 0;
    let mut sampled = |position: [f64; 2], deadman, request| {
        sequence += 1;
        let count =
            |position: f64| (position / damping.resolution_m).round() * damping.resolution_m;
        let sample = Some(Sample {
            sequence,
            deadman,
            device_fault: false,
            depth: count(position[1]) as f32,
            lateral: count(position[0]) as f32,
        });
        let (next, command) = step(table, limits, state, Input { sample, request });
        state = next;
        (state.mode, command)
    };
    let start = path.0[0];
    sampled(start, false, Request::None);
    assert_eq!(sampled(start, false, Request::Arm).0, Mode::Armed);
    let mut under_way = vec![Force::ZERO; usize::from(damping.delay_periods)];
    let mut given = 0.0;
    for cycle in path.0.windows(PARTS + 1).step_by(PARTS) {
        let (_, Command { force, playing }) = sampled(cycle[0], true, Request::None);
        assert!(playing);
        under_way.push(force);
        let force = under_way.remove(0);
        let force = [f64::from(force.lateral), -f64::from(force.normal)];
        for ends in cycle.windows(2) {
            let moved = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
            for axis in 0..2 {
                let viscous =
                    damping.damping_n_s_per_m * moved[axis] / damping.period_s * PARTS as f64;
                given +=
                    moved[axis] * (viscous - force[axis]) + moved[axis].abs() * damping.friction_n;
            }
        }
    }
    assert_eq!(state.force, Force::ZERO);
    given
}

/// A random number from 0 to 1.
fn unit(word: u64) -> f64 {
    (word >> 11) as f64 / (1u64 << 53) as f64
}

/// A gel of 300 to 1200 N/m with a random inclusion and its lateral force, and up to `noise` (N) of noise on every force.
fn gel(generator: &Generator, number: u64, noise: f64) -> ForceTable {
    let [a, b, c, d] = generator.words([number, 0, 0, 0]).map(unit);
    let (stiffness, bump, width) = (300.0 + 900.0 * a, 600.0 * b, 2e-3 + 3e-3 * c);
    let (rows, columns) = (9, 21);
    let depths: Vec<f64> = (0..rows).map(|row| row as f64 * 0.5e-3).collect();
    let laterals: Vec<f64> = (0..columns)
        .map(|column| (column as f64 - 10.0) * 1e-3)
        .collect();
    let noise = |row: usize, column: usize, component| {
        let words = generator.words([number, 1, row as u64, column as u64]);
        if row == 0 {
            0.0
        } else {
            noise * d * (2.0 * unit(words[component]) - 1.0)
        }
    };
    let hill = |x: f64| bump * (-(x / width).powi(2)).exp();
    let normal = Matrix::from_fn(rows, columns, |row, column| {
        depths[row] * (stiffness + hill(laterals[column])) + noise(row, column, 0)
    });
    let lateral = Matrix::from_fn(rows, columns, |row, column| {
        let x = laterals[column];
        depths[row].powi(2) * x / (width * width) * hill(x) + noise(row, column, 1)
    });
    ForceTable::new(depths, laterals, Force::new(lateral, normal)).unwrap()
}

/// A random closed path from outside of the gel: a wandering of three harmonics, or in, so many times round, and out.
fn path(generator: &Generator, number: u64, damping: &Damping) -> Path {
    let words = |group| generator.words([number, 2, group, 0]).map(unit);
    let [kind, speed, x, size] = words(0);
    let speed = HAND_SPEED * if kind < 0.3 { 1.0 } else { 0.05 + 0.95 * speed };
    let turn = std::f64::consts::TAU;
    let x = 14e-3 * (x - 0.5);
    if words(1)[0] < 0.5 {
        let phases = [words(2), words(3)];
        let weights = [words(4), words(5)];
        let curve = move |t: f64| {
            let wave = |axis: usize| -> f64 {
                let harmonic = |k: usize| {
                    let phase = turn * phases[axis][k];
                    let swing = (turn * (k + 1) as f64 * t + phase).sin() - phase.sin();
                    weights[axis][k] / (k + 1) as f64 * swing
                };
                (0..3).map(harmonic).sum()
            };
            // Between the sides of the table, and down to where it is continued.
            let lateral = (x + 6e-3 * size * wave(0)).clamp(-10e-3, 10e-3);
            [lateral, (-0.2e-3 + 2.5e-3 * wave(1).abs()).min(4.5e-3)]
        };
        Path::along(curve, speed, damping.period_s)
    } else {
        let [depth, rounds, aspect, sense] = words(6);
        let (depth, rounds) = (0.3e-3 + 3.5e-3 * depth, (1.0 + 6.0 * rounds).floor());
        let radius = [3e-3 * size, (0.6e-3 * aspect).min(depth)];
        let sense = if sense < 0.5 { -1.0 } else { 1.0 };
        let curve = move |t: f64| match t {
            t if t < 0.15 => [x, -0.2e-3 + (depth + 0.2e-3) * t / 0.15],
            t if t > 0.85 => [x, -0.2e-3 + (depth + 0.2e-3) * (1.0 - t) / 0.15],
            t => {
                let angle = turn * rounds * (t - 0.15) / 0.7;
                let round = [
                    sense * radius[0] * angle.sin(),
                    radius[1] * (1.0 - angle.cos()),
                ];
                [x + round[0], (depth + round[1]).min(4.5e-3)]
            }
        };
        Path::along(curve, speed, damping.period_s)
    }
}

// Verifies: SRV-051.
#[test]
fn no_accepted_table_gives_out_energy_on_a_closed_path() {
    let generator = Generator::new(20_261_122, 7);
    for number in 0..100 {
        let damping = display((number % 3) as u16);
        let noise = [0.0, 0.02, 0.2][number as usize / 3 % 3];
        let map = gel(&generator, number, noise);
        let (loaded, _) = LoadedTable::scaled_to_be_passive(&map, &damping, &limits()).unwrap();
        let table = loaded.table();
        for trajectory in 0..1000 {
            let path = path(&generator, 1000 * number + trajectory, &damping);
            let given = energy(&table, &damping, &limits(), &path);
            assert!(given > 0.0, "table {number}, path {trajectory}: {given} J");
        }
    }
}

/// What a hand gives that moves up and down `times` times from 0.5 mm above the surface to a depth of 4 mm, at `speed` (m/s).
fn pressed(map: &ForceTable, damping: &Damping, limits: &Limits, speed: f64, times: f64) -> f64 {
    let curve = |t: f64| {
        let angle = std::f64::consts::TAU * times * t;
        [0.0, -0.5e-3 + 2.25e-3 * (1.0 - angle.cos())]
    };
    let path = Path::along(curve, speed, damping.period_s);
    let loaded = LoadedTable::new(map).unwrap();
    energy(&loaded.table(), damping, limits, &path)
}

/// Asserts that a table is refused by the bound `what`.
#[track_caller]
fn assert_refused(map: &ForceTable, damping: &Damping, limits: &Limits, what: &str) {
    let refusal = LoadedTable::passive(map, damping, limits).unwrap_err();
    let found = refusal.to_string();
    let holds = found.contains(&format!(" {what}, where device and force limit allow"));
    assert!(holds, "{found}");
}

/// A spring along the depth of so many N/m.
fn spring(stiffness: f64) -> ForceTable {
    let depths = [0.0, 4e-3, 4.5e-3];
    super::map(&depths, &[-0.01, 0.01], |d, _| [0.0, d * stiffness])
}

// What is refused does give energy out, each by the bound that refuses it: the observer can see it.
// Verifies: SRV-051, SRV-052.
#[test]
fn what_is_refused_gives_energy_out() {
    let (near, frictionless) = (display(0), |damping| Damping {
        friction_n: 1e-3,
        ..damping
    });
    // A force that lags behind the hand on its way in: 50 N/s, where 780 N/m at 0.2 m/s need 156 N/s.
    let slow = Limits::new(4.0, 0.05, 0.5, 20).unwrap();
    let (stiff, slick) = (spring(780.0), frictionless(near));
    assert_refused(&stiff, &slick, &slow, "N of growth in a cycle");
    assert!(pressed(&stiff, &slick, &slow, HAND_SPEED, 3.0) < 0.0);
    assert!(LoadedTable::passive(&stiff, &slick, &limits()).is_ok());
    assert!(pressed(&stiff, &slick, &limits(), HAND_SPEED, 3.0) > 0.0);

    // A force that comes a cycle and a half late, on a display that would play it at half a cycle.
    let late = frictionless(display(1));
    let stiff = spring(440.0);
    assert_refused(&stiff, &late, &limits(), "N/m of stiffness");
    assert!(pressed(&stiff, &late, &limits(), HAND_SPEED, 3.0) < 0.0);
    let fitting = spring(390.0);
    assert!(LoadedTable::passive(&fitting, &late, &limits()).is_ok());
    assert!(pressed(&fitting, &late, &limits(), HAND_SPEED, 3.0) > 0.0);

    // A normal force that is larger on the right, without a lateral force that says so: down on the left, up on the right.
    let twisted = |twist: f64| {
        let normal = |d: f64, x: f64| d / 4.5e-3 * twist * (x + 0.01) / 0.01;
        super::map(&[0.0, 4.5e-3], &[-0.01, 0.0, 0.01], |d, x| {
            [0.0, normal(d, x)]
        })
    };
    let round = |twist: f64| {
        let loaded = LoadedTable::new(&twisted(twist)).unwrap();
        let curve = |t: f64| match t {
            t if t < 0.25 => [-0.01, -0.5e-3 + 5e-3 * t / 0.25],
            t if t < 0.5 => [-0.01 + 0.02 * (t - 0.25) / 0.25, 4.5e-3],
            t if t < 0.75 => [0.01, 4.5e-3 - 5e-3 * (t - 0.5) / 0.25],
            t => [0.01 - 0.02 * (t - 0.75) / 0.25, -0.5e-3],
        };
        let path = Path::along(curve, 2e-3, near.period_s);
        energy(&loaded.table(), &near, &limits(), &path)
    };
    let what = "N of force without a potential";
    assert_refused(&twisted(1.9), &near, &limits(), what);
    assert!(round(1.9) < 0.0 && round(0.1) > 0.0);
    assert!(LoadedTable::passive(&twisted(0.1), &near, &limits()).is_ok());

    // A normal force that is cut off at the limit, where the lateral force goes on.
    let weak = Limits::new(1.0, 0.25, 0.25, 20).unwrap();
    assert_refused(&spring(390.0), &near, &weak, "N of force");
}
