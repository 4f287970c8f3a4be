//! What is done with the samples of a record before it is compared with the maps.

use super::*;

/// Forces over a flat gel: 1.5 N in the normal channel at 4 mm.
fn flat() -> ForceTable {
    table_of(&[3e-3, 4e-3], &[-8e-3, 8e-3], |depth, _| {
        [0.0, 375.0 * depth]
    })
}

/// The detector of a disc in records along `over`, at 4 mm or at their own depths.
fn detector<'a>(question: RobustQuestion<'a>, over: &Record) -> RobustDetector<'a> {
    let channel =
        |of: usize| -> Vec<f64> { over.positions().iter().map(|x| disc(*x)[of]).collect() };
    let signal = RobustSignal {
        of_sweeps: vec![[channel(0), channel(1)].concat()],
        amplitude_sd: 0.4,
        prior: 1.0,
    };
    let sweep = RobustSweep::new(over, 4e-3, None);
    RobustDetector::new(question, &flat(), &[sweep], &[signal]).unwrap()
}

// A sound sample is 6 standard deviations of the stated noise off with a probability of 2e-9, so that one of all 72,000 is replaced with
// 1.4e-4. With as many samples as modes and two more, the others say nearly nothing of the noise.
// Verifies: ROB-002.
#[test]
fn few_samples_in_stated_noise_are_kept_but_for_a_glitch() {
    let question = RobustQuestion {
        noise_sd: Some(Force::new(0.02, 0.02)),
        ..RobustQuestion::default()
    };
    for samples in [8, 12, 16] {
        let zeros = vec![0.0; samples];
        let over = Record::new("over", &positions(samples), Force::new(&zeros, &zeros)).unwrap();
        let detector = detector(question, &over);
        for trial in 0..1000 {
            let lateral = noise(samples, 2 * trial).into_iter().map(|n| 0.02 * n);
            let normal = noise(samples, 2 * trial + 1);
            let normal = normal.into_iter().map(|n| 1.5 + 0.02 * n);
            let [lateral, mut normal]: [Vec<f64>; 2] = [lateral.collect(), normal.collect()];
            let replaced = |normal: &[f64]| {
                let answer = detector.judge(&[Force::new(&lateral, normal)]).unwrap();
                (answer.causes.contains(&Cause::Glitches), answer.glitches)
            };
            assert_eq!(replaced(&normal), (false, vec![0]), "{samples} {trial}");
            if trial < 10 {
                normal[samples / 2] += 0.7;
                assert_eq!(replaced(&normal), (false, vec![1]), "{samples} {trial}");
            }
        }
    }
}

// 16 modes leave 145 of 161 degrees of freedom. χ² is above 1.58 times its mean with a probability of 1e-5. Noise of 6.25 times the stated
// variance is half of that, 3.12 times the mean, and missed with 1e-7; noise of 1.9 times is refused with 1e-6. An error of 0.1 mm of the
// depth is one of 0.0375 N.
// Verifies: ROB-040.
#[test]
fn more_noise_than_was_stated_is_a_misfit() {
    let (over, depths) = (positions(161), [4e-3; 161]);
    let record = Record::along("over", &over, &depths, Force::new(&over, &over)).unwrap();
    for (stated, depth_sd, normal_sd, is_misfit) in [
        (Force::new(0.008, 0.02), 0.0, 0.02, true),
        (Force::new(0.02, 0.008), 0.0, 0.02, true),
        (Force::new(0.02, 0.02), 0.0, 0.02, false),
        (Force::new(0.0145, 0.0145), 0.0, 0.02, false),
        (Force::new(0.02, 0.02), 0.0, 0.06, true),
        (Force::new(0.02, 0.02), 1e-4, 0.0425, false),
    ] {
        let question = RobustQuestion {
            noise_sd: Some(stated),
            ..RobustQuestion::default()
        };
        let record = record.clone().with_depth_sd(depth_sd).unwrap();
        let record = record.passes().remove(0);
        let detector = detector(question, &record);
        for trial in 0..100 {
            let lateral = noise(161, 2 * trial).into_iter().map(|n| 0.02 * n);
            let normal = noise(161, 2 * trial + 1).into_iter();
            let normal: Vec<f64> = normal.map(|n| 1.5 + normal_sd * n).collect();
            let lateral: Vec<f64> = lateral.collect();
            let answer = detector.judge(&[Force::new(&lateral, &normal)]).unwrap();
            let found = answer.causes.contains(&Cause::Misfit);
            assert_eq!(found, is_misfit, "{stated:?} {depth_sd} {trial}");
        }
    }
}

// Half of the resolution is the most that a sample is off, and the others say that there is no noise at all.
// Verifies: ROB-002.
#[test]
fn the_resolution_and_the_stated_noise_are_the_least_noise() {
    let modes = modes(161);
    let glitch = |size: f64, least: f64| {
        let mut channel = vec![1.0; 161];
        channel[80] += size;
        without_glitches(&modes, &mut channel, least)
    };
    assert_eq!(glitch(1.0, 0.0), Some(1));
    // Of 161 samples 16 modes take a tenth of the glitch.
    assert_eq!([5.5, 7.0].map(|size| glitch(size, 1.0)), [Some(0), Some(1)]);
}

/// The standard deviation of the noise that is found in two passes with a tremor of 0.05 mm, at 2.1 and 4.2 mm, in noise of 0.005 N, by
/// a sensor with an offset of the normal force, N, and a glitch in the second, N.
fn noise_of_a_tremor(bank: &Bank, is_zeroed: bool, offset: f64, glitch: f64) -> [f64; 2] {
    let there = positions(161);
    let back = there.iter().rev().skip(1);
    let over: Vec<f64> = there.iter().chain(back).copied().collect();
    let depth = |at: usize| {
        let of_pass = if at < 161 { 2.1e-3 } else { 4.2e-3 };
        of_pass + 0.05e-3 * (1.9 * at as f64).sin()
    };
    let depths: Vec<f64> = (0..over.len()).map(depth).collect();
    let mut forces = bank.reference().table().path(&depths, &over).unwrap();
    forces.normal.iter_mut().for_each(|force| *force += offset);
    let mut forces = noisy(forces, 0.005, [0, 1]);
    forces.normal[241] += glitch;
    let record = Record::along("path", &over, &depths, forces.as_deref()).unwrap();
    let question = RobustQuestion {
        is_zeroed,
        ..RobustQuestion::default()
    };
    let (passes, _) = question.passes(&record, bank.reference());
    let sweeps: Vec<_> = passes.iter().map(|of| at_place(bank, of, None)).collect();
    let (answer, _) = question.locate(bank, None, &sweeps).unwrap();
    assert_eq!(answer.glitches, [0, usize::from(glitch > 0.0)]);
    [0, 1].map(|pass| answer.noise_sd[pass].normal.unwrap())
}

// Verifies: ROB-081, ROB-003.
#[test]
fn a_tremor_is_no_noise_whatever_the_offset_of_the_sensor() {
    let bank = deep_bank();
    let [light, heavy] = noise_of_a_tremor(&bank, false, 0.0, 0.0);
    // 160 samples less 16 modes: a standard deviation of 6 %.
    assert_near(light, 0.005, 0.001);
    assert_near(heavy, 0.005, 0.001);
    // A sensor that was set to zero on the gel has any offset, and the level 1.
    let zeroed = noise_of_a_tremor(&bank, true, -0.5, 0.0);
    assert_near(zeroed[0] / light, 1.0, 0.05);
    assert_near(zeroed[1] / heavy, 1.0, 0.05);
    // The offset is half of the force of the light pass, and a fifth of that of the other, whose level stands for both.
    let [offset, _] = noise_of_a_tremor(&bank, false, 0.3, 0.0);
    assert_near(offset / light, 1.0, 0.2);
    // A glitch of the heavy pass is not in the level that stands for both.
    let glitch = noise_of_a_tremor(&bank, false, 0.0, 1000.0);
    assert_near(glitch[0] / light, 1.0, 0.01);
    assert_near(glitch[1] / heavy, 1.0, 0.02);
}

// Verifies: ROB-007, TRC-017, TRC-085.
#[test]
fn samples_in_air_are_those_at_the_start_of_the_file_whichever_way_the_probe_went() {
    let force = |at: usize| if at < 60 { 0.0 } else { 1.5 };
    let normal: Vec<f64> = (noise(161, 7).iter().enumerate())
        .map(|(at, noise)| force(at) + 0.02 * noise)
        .collect();
    let there = positions(161);
    let back: Vec<f64> = there.iter().rev().copied().collect();
    for over in [there, back] {
        let forces = Force::new(&[][..], &normal[..]);
        let sweep = Record::new("sweep", &over, forces).unwrap();
        let path = Record::along("path", &over, &[4e-3; 161], forces).unwrap();
        for record in [sweep, path.passes().remove(0)] {
            let detector = detector(RobustQuestion::default(), &record);
            let answer = detector.judge(&[record.forces()]).unwrap();
            assert_eq!(answer.causes, [Cause::InAir], "{}", record.file());
            assert_eq!(answer.in_air, [[60, 0]], "{}", record.file());
        }
    }
}
