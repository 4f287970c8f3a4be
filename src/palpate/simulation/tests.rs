//! Paths, hands and sensors against what they should do.

use super::*;
use crate::force_map::tests::table_of;
use crate::hid::simulated::{Handle, Mechanics};
use crate::trace::{Record, Trace};
use palpate_asserts::assert_near;

/// A gel as a spring of `k` N/m to a depth of 10 mm, with 2 N more a metre along x; lateral 0.25 of the normal force.
fn spring(k: f64) -> ForceTable {
    let depths: Vec<f64> = (0..=10).map(|row| 1e-3 * f64::from(row)).collect();
    let laterals: Vec<f64> = (-10..=10).map(|x| 1e-3 * f64::from(x)).collect();
    table_of(&depths, &laterals, |depth, x| {
        let normal = k * depth * (1.0 + 10.0 * x);
        [0.25 * normal, normal]
    })
}

fn simulation<'a>(gel: &'a ForceTable, path: &'a Path) -> Simulation<'a> {
    Simulation {
        gel,
        path,
        motion: Motion::default(),
        relaxation: None,
        friction: 0.0,
        sensor: Sensor::default(),
        seed: 7,
    }
}

// Verifies: SIM-010, SIM-001.
#[test]
fn passes_go_there_and_back_with_the_samples_of_their_rate() {
    let path = Path::passes(&[1e-3, 3e-3], [-2e-3, 2e-3], 10e-3, 100.0).unwrap();
    let gel = spring(400.0);
    let found = simulation(&gel, &path).record(1).unwrap();
    // 4 mm at 10 mm/s in steps of 10 ms: 41 samples a pass, half a second after the other.
    assert_eq!(found.times.len(), 82);
    for sample in 0..41 {
        let x = -2e-3 + 1e-4 * sample as f64;
        let back = 41 + sample;
        assert_near(found.positions[sample], x, 1e-15);
        assert_near(found.positions[back], -x, 1e-15);
        assert_near(found.times[back] - found.times[sample], 0.9, 1e-12);
        assert_eq!([found.depths[sample], found.depths[back]], [1e-3, 3e-3]);
        assert_near(found.forces.normal[sample], 0.4 * (1.0 + 10.0 * x), 1e-14);
        assert_near(found.forces.lateral[back], 0.3 * (1.0 - 10.0 * x), 1e-14);
    }
    // A last sample that is on the end but for rounding is where the next pass begins, and does not move there.
    let path = Path::passes(&[2e-3, 2e-3], [-1e-2, 1e-2], 15e-3, 30.0).unwrap();
    let found = simulation(&gel, &path).record(1).unwrap();
    assert_eq!(found.positions[40], found.positions[41]);
    // The last sample counts although 0.7/0.1 is below 7, and none is beyond the end.
    let path = Path::passes(&[1e-3], [0.0, 0.7], 0.1, 1.0).unwrap();
    assert_eq!(path.samples().len(), 8);
    let path = Path::passes(&[1e-3], [0.0, 0.75], 0.1, 1.0).unwrap();
    assert_eq!(path.samples().len(), 8);
    for (depths, ends, speed, rate) in [
        (&[1e-3][..], [0.0, 1.0], 0.0, 1.0),
        (&[1e-3], [0.0, 1.0], -1.0, 1.0),
        (&[1e-3], [0.0, 1.0], 1.0, 0.0),
        (&[1e-3], [1.0, 1.0], 1.0, 1.0),
        (&[], [0.0, 1.0], 1.0, 1.0),
        (&[1e-3], [0.0, 1.0], 1.0, 1e6),
        (&[1e-3], [0.0, 1.0], f64::NAN, 1.0),
        (&[1e-3], [0.0, 1.0], 1.0, f64::INFINITY),
    ] {
        assert!(Path::passes(depths, ends, speed, rate).is_err());
    }
}

// Verifies: SIM-011.
#[test]
fn a_path_of_waypoints_goes_straight_between_them() {
    let text = "time_s,position_mm,depth_mm\n1,-2,0\n2,-2,4\n4,6,2\n";
    let path = Path::from_csv(text, "path.csv", 4.0).unwrap();
    assert_eq!(path.samples().len(), 13);
    assert_eq!(path.extent(), ([-2e-3, 6e-3], 4e-3));
    for (time, x, depth) in [
        (0.0, -2.0, 0.0),
        (1.0, -2.0, 0.0),
        (1.25, -2.0, 1.0),
        (2.0, -2.0, 4.0),
        (2.5, 0.0, 3.5),
        (4.0, 6.0, 2.0),
        (5.0, 6.0, 2.0),
    ] {
        let [found_x, found_depth] = path.at(time);
        assert_near(found_x, 1e-3 * x, 1e-17);
        assert_near(found_depth, 1e-3 * depth, 1e-17);
    }
    let header = "time_s,position_mm,depth_mm\n";
    for (rows, word) in [
        ("0,1,1\n0,2,2\n", "path.csv:3: time 0 s after 0 s"),
        ("0,1,1\n", "a single place"),
        ("0,1,1\n1e9,2,2\n", "at most 1,000,000"),
        ("0,1\n", "path.csv:2"),
    ] {
        let error = Path::from_csv(&format!("{header}{rows}"), "path.csv", 10.0).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Path::from_csv(text, "path.csv", rate).is_err(), "{rate}");
    }
}

// Verifies: SIM-002.
#[test]
fn friction_opposes_the_motion_and_relaxation_follows_the_force() {
    let gel = spring(400.0);
    let path = Path::passes(&[2e-3, 2e-3], [-2e-3, 2e-3], 10e-3, 100.0).unwrap();
    let without = simulation(&gel, &path).record(1).unwrap();
    let rubbing = Simulation {
        friction: 0.3,
        ..simulation(&gel, &path)
    };
    let found = rubbing.record(1).unwrap();
    assert_eq!(found.forces.normal, without.forces.normal);
    for sample in 0..82 {
        let way = if sample < 41 { -1.0 } else { 1.0 };
        // The first of the way back is at the place of the last before it: the probe stands.
        let way = if sample == 41 { 0.0 } else { way };
        let expected = without.forces.lateral[sample] + way * 0.3 * without.forces.normal[sample];
        assert_near(found.forces.lateral[sample], expected, 1e-15);
    }
    // At rest from the first sample on the force falls as 1 − g (1 − e^(−t/τ)).
    let text = "time_s,position_mm,depth_mm\n0,0,2\n10,0,2\n";
    let path = Path::from_csv(text, "path.csv", 5.0).unwrap();
    let relaxing = Simulation {
        relaxation: Some([0.4, 2.0]),
        ..simulation(&gel, &path)
    };
    let found = relaxing.record(1).unwrap();
    for (time, force) in found.times.iter().zip(&found.forces.normal) {
        assert_near(
            *force,
            0.8 * (1.0 - 0.4 * (1.0 - (-time / 2.0).exp())),
            1e-12,
        );
    }
}

// Verifies: SIM-020.
#[test]
fn a_hand_is_pushed_out_of_the_gel_until_it_balances_it() {
    let gel = spring(400.0);
    let text = "time_s,position_mm,depth_mm\n0,0,4\n2,0,4\n";
    let path = Path::from_csv(text, "path.csv", 10.0).unwrap();
    let hand = Hand {
        mass: 0.05,
        damping: 5.0,
        stiffness: 500.0,
    };
    let held = Simulation {
        motion: Motion {
            hand: Some(hand),
            tremor: None,
        },
        ..simulation(&gel, &path)
    };
    let found = held.record(1).unwrap();
    // 500 (4 mm − d) = 400 d (1 + 10 x) and 500 x = 100 d (1 + 10 x): x by iteration.
    let (mut x, mut depth) = (0.0, 0.0);
    for _ in 0..50 {
        let k = 400.0 * (1.0 + 10.0 * x);
        depth = 500.0 * 4e-3 / (500.0 + k);
        x = 0.25 * k * depth / 500.0;
    }
    // A second of holding the place is twenty times 2 m/b: e^(−50) of 4 mm.
    for sample in 0..found.times.len() {
        assert_near(found.depths[sample], depth, 1e-9);
        assert_near(found.positions[sample], x, 1e-9);
    }
    // A stiff one follows the path: F/k = 1.6 N/1e6 N/m.
    let stiff = Hand {
        mass: 0.05,
        damping: 300.0,
        stiffness: 1e6,
    };
    let mut follows = held.clone();
    follows.motion.hand = Some(stiff);
    let found = follows.record(1).unwrap();
    assert!(
        found
            .depths
            .iter()
            .all(|depth| (depth - 4e-3).abs() < 1.7e-6)
    );
    for mass in [0.0, -1.0, f64::NAN, 1e-6] {
        follows.motion.hand = Some(Hand { mass, ..hand });
        assert!(follows.record(1).is_err());
    }
    // Pushed to the side, beyond the end of the map at 10 mm.
    let text = "time_s,position_mm,depth_mm\n0,9.9,4\n2,9.9,4\n";
    let path = Path::from_csv(text, "path.csv", 10.0).unwrap();
    let mut leaves = simulation(&gel, &path);
    leaves.motion.hand = Some(hand);
    let error = leaves.record(1).unwrap_err().to_string();
    assert!(error.contains("outside the map"), "{error}");
}

// Verifies: SIM-020.
#[test]
fn a_hand_is_where_it_is_at_the_time_of_each_sample() {
    let gel = spring(400.0);
    let text = "time_s,position_mm,depth_mm\n0,0,0\n0.9,9,0\n";
    let path = Path::from_csv(text, "path.csv", 60.0).unwrap();
    let mut moved = simulation(&gel, &path);
    moved.motion.hand = Some(Hand {
        mass: 0.05,
        damping: 5.0,
        stiffness: 500.0,
    });
    let found = moved.record(1).unwrap();
    // After 0.4 s it follows at 10 mm/s: a sample 0.1 ms late would be 1 µm off.
    for three in found.positions[24..].windows(3) {
        assert_near(three[2] - three[1], three[1] - three[0], 1e-7);
    }
}

/// Where a handle of 0.05 kg on 500 N/m is after 0.1 s, from 10 mm away, with a damping, in steps of `step`.
fn swung(damping: f64, step: f64) -> f64 {
    let mechanics = Mechanics {
        damping_n_s_per_m: 0.0,
        friction_n: 0.0,
        backlash_m: 0.0,
        hand_n_s_per_m: damping,
        ..Mechanics::PAPER
    };
    let mut handle = Handle::at(mechanics, 0.0);
    // Ten steps at a time.
    for _ in 0..(0.1 / (10.0 * step)).round() as u32 {
        handle.advance(10.0 * step, 0.01, 0.0);
    }
    handle.position
}

// Verifies: SIM-021.
#[test]
fn the_motion_of_a_hand_is_of_first_order_and_loses_no_energy() {
    // m x″ + b x′ + k (x − h) = 0 from rest at 0, after 0.1 s.
    let (m, b, k, h, t): (f64, f64, f64, f64, f64) = (0.05, 2.0, 500.0, 0.01, 0.1);
    let sigma = b / (2.0 * m);
    let omega = (k / m - sigma * sigma).sqrt();
    let swing = (omega * t).cos() + sigma / omega * (omega * t).sin();
    let exact = h * (1.0 - (-sigma * t).exp() * swing);
    let errors = [4e-5, 2e-5, 1e-5].map(|step| (swung(b, step) - exact).abs());
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.05, "{errors:?}");
    }
    // In the steps of a simulation, 10 µs, the place is right within 5 µm of a swing of 10 mm.
    assert!(errors[2] < 5e-6, "{errors:?}");
    // Without damping it swings for 100 s, 1,600 times, as far as in the beginning: ω h/2 = 5e-4 of 10 mm.
    let mechanics = Mechanics {
        damping_n_s_per_m: 0.0,
        friction_n: 0.0,
        backlash_m: 0.0,
        hand_n_s_per_m: 0.0,
        ..Mechanics::PAPER
    };
    let mut handle = Handle::at(mechanics, 0.0);
    let mut furthest = 0.0_f64;
    for step in 0..1_000_000 {
        handle.advance(1e-4, 0.01, 0.0);
        if step >= 990_000 {
            furthest = furthest.max(handle.position);
        }
    }
    assert_near(furthest, 0.02, 1e-5);
}

// Verifies: SIM-022.
#[test]
fn tremor_has_the_size_and_the_frequency_that_are_asked() {
    let gel = spring(400.0);
    let text = "time_s,position_mm,depth_mm\n0,0,2\n20,0,2\n";
    let path = Path::from_csv(text, "path.csv", 1000.0).unwrap();
    let mut shaking = simulation(&gel, &path);
    shaking.motion.tremor = Some(Tremor {
        rms: 1e-4,
        frequency: 10.0,
    });
    let found = shaking.record(1).unwrap();
    let moved: Vec<f64> = found.depths.iter().map(|depth| depth - 2e-3).collect();
    let count = moved.len() as f64;
    // The tones lie 0.5 Hz apart and from 8.25 to 11.75 Hz: 20 s hold whole periods of each but for the last sample.
    let mean = moved.iter().sum::<f64>() / count;
    let rms = (moved.iter().map(|of| of * of).sum::<f64>() / count).sqrt();
    assert_near(mean, 0.0, 1e-8);
    assert_near(rms, 1e-4, 1e-7);
    let power = |frequency: f64| {
        let sum = |of: fn(f64) -> f64| -> f64 {
            let at =
                |(time, moved): (&f64, &f64)| moved * of(std::f64::consts::TAU * frequency * time);
            found.times.iter().zip(&moved).map(at).sum()
        };
        (sum(f64::sin).powi(2) + sum(f64::cos).powi(2)).sqrt() * 2.0 / count
    };
    for tone in 0..8 {
        assert_near(power(8.25 + 0.5 * f64::from(tone)), 5e-5, 1e-7);
    }
    assert!(power(7.75) < 1e-7 && power(12.25) < 1e-7);
    // x moves by itself, and each record by its own phases.
    let along: f64 = found
        .positions
        .iter()
        .zip(&moved)
        .map(|(x, depth)| x * depth)
        .sum();
    assert!((along / count / 1e-8).abs() < 0.9, "{along}");
    assert_ne!(shaking.record(2).unwrap().depths, found.depths);
}

// Verifies: SIM-005.
#[test]
fn a_sensor_beyond_all_numbers_is_refused() {
    let gel = spring(400.0);
    let path = Path::passes(&[2e-3], [-9e-3, 9e-3], 9e-3, 10.0).unwrap();
    type Set = fn(&mut Sensor);
    // A force over so small a step is infinite.
    let wrong: [Set; 3] = [
        |sensor| sensor.resolution = 1e-310,
        |sensor| sensor.depth_sd = f64::MAX,
        |sensor| (sensor.offset_sd, sensor.drift_sd) = (f64::MAX, f64::MAX),
    ];
    for set in wrong {
        let mut beyond = simulation(&gel, &path);
        set(&mut beyond.sensor);
        let error = beyond.record(1).unwrap_err().to_string();
        assert!(error.contains("no finite number"), "{error}");
    }
}

// Verifies: SIM-002, SIM-003.
#[test]
fn a_sensor_has_the_noise_offset_drift_and_steps_that_are_asked() {
    let gel = spring(400.0);
    let path = Path::passes(&[2e-3], [-9e-3, 9e-3], 9e-3, 1000.0).unwrap();
    let calm = simulation(&gel, &path).record(1).unwrap();
    let noisy = Simulation {
        sensor: Sensor {
            noise_sd: Force::new(0.02, 0.1),
            correlation: 0.6,
            depth_sd: 1e-5,
            ..Sensor::default()
        },
        ..simulation(&gel, &path)
    };
    let found = noisy.record(3).unwrap();
    let beside = |found: &[f64], calm: &[f64]| -> Vec<f64> {
        found.iter().zip(calm).map(|(a, b)| a - b).collect()
    };
    let sd = |of: &[f64]| (of.iter().map(|x| x * x).sum::<f64>() / of.len() as f64).sqrt();
    let pairs = [
        (beside(&found.forces.lateral, &calm.forces.lateral), 0.02),
        (beside(&found.forces.normal, &calm.forces.normal), 0.1),
    ];
    for (noise, expected) in &pairs {
        // 2,001 samples of correlation 0.6 count as (1 − 0.36)/(1 + 0.36) of them for their variance: 940, and 5 standard errors.
        assert_near(sd(noise) / expected, 1.0, 5.0 / (2.0_f64 * 940.0).sqrt());
        let product: f64 = noise.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let correlation = product / noise.iter().map(|x| x * x).sum::<f64>();
        // (1 − 0.36)/2,001 is its variance.
        assert_near(correlation, 0.6, 5.0 * (0.64_f64 / 2001.0).sqrt());
    }
    let across: f64 = pairs[0].0.iter().zip(&pairs[1].0).map(|(a, b)| a * b).sum();
    assert_near(
        across / 2001.0 / 0.002,
        0.0,
        5.0 * (2.1_f64 / 2001.0).sqrt(),
    );
    let of_depth = beside(&found.depths, &calm.depths);
    assert_near(sd(&of_depth), 1e-5, 5e-5 / 4002_f64.sqrt());
    // It is none of the noise of a force, of which a part 1 − 0.36 is new.
    for (noise, size) in &pairs {
        let together: f64 = of_depth.iter().zip(noise).map(|(a, b)| a * b).sum();
        assert_near(
            together / 2001.0 / (1e-5 * size),
            0.0,
            5.0 / 2001_f64.sqrt(),
        );
    }
    assert_eq!(noisy.record(3).unwrap(), found);
    assert_ne!(noisy.record(4).unwrap().forces, found.forces);
    assert_ne!(
        Simulation { seed: 8, ..noisy }.record(3).unwrap().forces,
        found.forces
    );

    // Offsets and drifts of 400 records.
    let sensor = Sensor {
        offset_sd: 0.3,
        drift_sd: 0.1,
        ..Sensor::default()
    };
    let path = Path::passes(&[2e-3], [-1e-3, 1e-3], 1e-3, 2.0).unwrap();
    let calm = simulation(&gel, &path).record(1).unwrap();
    let drifting = Simulation {
        sensor,
        ..simulation(&gel, &path)
    };
    let [mut offsets, mut drifts] = [Vec::new(), Vec::new()];
    for number in 0..400 {
        let found = drifting.record(number).unwrap().forces;
        let [lateral, normal] = [&found.lateral, &found.normal];
        for (found, calm) in [
            (lateral, &calm.forces.lateral),
            (normal, &calm.forces.normal),
        ] {
            let found = beside(found, calm);
            offsets.push(found[0]);
            drifts.push(found[4] - found[0]);
            // A straight line.
            assert_near(found[2], 0.5 * (found[0] + found[4]), 1e-12);
        }
    }
    // A drift alone begins at 0.
    let alone = Simulation {
        sensor: Sensor {
            offset_sd: 0.0,
            ..sensor
        },
        ..drifting
    };
    let found = alone.record(1).unwrap().forces;
    assert_eq!(found.normal[0], calm.forces.normal[0]);
    assert_ne!(found.normal[4], calm.forces.normal[4]);
    // Five standard errors of 800.
    assert_near(sd(&offsets) / 0.3, 1.0, 5.0 / 40.0);
    assert_near(sd(&drifts) / 0.1, 1.0, 5.0 / 40.0);
    // Offset and drift of either force are four numbers, none of which tells another.
    let of = |list: &[f64], first: usize| list.iter().skip(first).step_by(2).copied().collect();
    let four: [Vec<f64>; 4] = [
        of(&offsets, 0),
        of(&offsets, 1),
        of(&drifts, 0),
        of(&drifts, 1),
    ];
    for (number, one) in four.iter().enumerate() {
        for other in &four[..number] {
            let product: f64 = one.iter().zip(other).map(|(a, b)| a * b).sum();
            assert_near(product / 400.0 / (sd(one) * sd(other)), 0.0, 5.0 / 20.0);
        }
    }

    let coarse = Simulation {
        sensor: Sensor {
            resolution: 0.25,
            ..Sensor::default()
        },
        ..simulation(&gel, &path)
    };
    let found = coarse.record(1).unwrap();
    for (found, exact) in found.forces.normal.iter().zip(&calm.forces.normal) {
        assert_eq!((found / 0.25).fract(), 0.0);
        assert!((found - exact).abs() <= 0.125);
    }
}

// Verifies: SIM-004, SIM-001.
#[test]
fn a_record_is_read_back_as_it_was_written() {
    let gel = spring(400.0);
    // Positions that no few digits tell: 97 µm apart.
    let path = Path::passes(&[1e-3, 2.5e-3], [-2e-3, 2e-3], 9.712_345e-3, 100.0).unwrap();
    let found = simulation(&gel, &path).record(1).unwrap();
    let read = |text: &str| -> Record {
        Trace::from_csv(text, "r.csv")
            .unwrap()
            .record(None)
            .unwrap()
    };
    let record = read(&found.to_csv(true));
    for sample in 0..found.times.len() {
        assert_near(record.positions()[sample], found.positions[sample], 1e-9);
        assert_near(record.depths().unwrap()[sample], found.depths[sample], 1e-9);
        assert_near(
            record.forces().normal[sample],
            found.forces.normal[sample],
            1e-6,
        );
        assert_near(
            record.forces().lateral[sample],
            found.forces.lateral[sample],
            1e-6,
        );
    }
    let path = Path::passes(&[2.5e-3], [-2e-3, 2e-3], 10e-3, 100.0).unwrap();
    let found = simulation(&gel, &path).record(1).unwrap();
    assert_eq!(read(&found.to_csv(false)).depths(), None);
    // Above the gel there is no force; beside the map there is none to be had.
    let text = "time_s,position_mm,depth_mm\n0,0,-2\n1,0,-1\n";
    let air = Path::from_csv(text, "path.csv", 10.0).unwrap();
    let found = simulation(&gel, &air).record(1).unwrap();
    assert!(found.forces.normal.iter().all(|force| *force == 0.0));
    let deep = Path::passes(&[11e-3], [-2e-3, 2e-3], 10e-3, 100.0).unwrap();
    let error = simulation(&gel, &deep).record(1).unwrap_err();
    assert!(error.to_string().contains("outside the map"), "{error}");
    assert!(simulation(&gel.of_normal(), &path).record(1).is_err());
}
