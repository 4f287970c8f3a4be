//! Curves whose truth is known.

use rayon::prelude::*;

use super::*;
use crate::fem::{Contact, Model};
use crate::phantom::Strain;
use crate::stats::random::Generator;
use palpate_asserts::assert_near;

/// Times of a ramp, uneven.
fn times() -> Vec<f64> {
    (0..200)
        .map(|k| 0.02 * f64::from(k) + 0.004 * f64::from(k % 3))
        .collect()
}

// Verifies: CAL-020, CAL-021. The integrals of both forms under a ramp of 1 N/s are known.
#[test]
fn a_ramp_relaxes_as_its_integral_says() {
    let times = times();
    let elastic: Vec<f64> = times.iter().map(|t| t - times[0]).collect();
    let [tau, beta] = [0.3, 0.4];
    let power = Relaxation::PowerLaw.terms(&[libm::log(tau), libm::log(beta)]);
    // g₁/(1 + Σ g) = 0.5 and 0.25.
    let prony = Relaxation::Prony(2).terms(&[libm::log(0.1), libm::log(2.0), libm::log(1.0), 0.0]);
    assert_eq!(prony[0][0], 0.5);
    let [power, prony] = [power, prony].map(|terms| relaxed(&terms, &times, &elastic));
    for (k, t) in elastic.iter().enumerate() {
        let exact = tau / (1.0 - beta) * ((1.0 + t / tau).powf(1.0 - beta) - 1.0);
        // The quadrature leaves 1e-4 of the weights below its first point.
        assert!(
            (power[k] - exact).abs() <= 2e-4 * t,
            "{t}: {} {exact}",
            power[k]
        );
        let term = |tau: f64| tau * (1.0 - (-t / tau).exp());
        let exact = 0.25 * t + 0.5 * term(0.1) + 0.25 * term(1.0);
        assert!((prony[k] - exact).abs() < 1e-12, "{t}");
    }
}

/// A curve of a sensor with offset, drift and noise (N) over the paper's gel, which is `stiffer` and touched at 1.2 mm; its forces come
/// from another mesh than those that it is fitted with.
struct Rig {
    depths: Vec<f64>,
    forces: Vec<f64>,
}

const TOUCHED: f64 = 1.2e-3;

impl Rig {
    fn new(phantom: &Phantom, mesh_size: f64) -> Rig {
        let depths: Vec<f64> = (0..=240).map(|k| 2e-5 * f64::from(k)).collect();
        let below: Vec<f64> = depths
            .iter()
            .map(|d| d - TOUCHED)
            .filter(|d| *d > 1e-9)
            .collect();
        let model = Model::new(phantom, mesh_size, Contact::default()).unwrap();
        let map = model.map(&below, &[0.0], &|_| true).unwrap();
        let mut forces = vec![0.0; depths.len() - below.len()];
        forces.extend(map.table().normal().values());
        Rig { depths, forces }
    }

    fn curve(&self, stiffer: f64, noise: f64, number: u64) -> Curve {
        let generator = Generator::new(42, number);
        let last = (self.depths.len() - 1) as f64;
        let sample = |(k, force): (usize, &f64)| {
            stiffer * force + 0.05 - 0.02 * k as f64 / last + noise * generator.normal(0, k as u64)
        };
        let forces: Vec<f64> = self.forces.iter().enumerate().map(sample).collect();
        Curve::new("curve", None, &self.depths, &forces).unwrap()
    }
}

fn asked(layers: &[usize], mesh_size: f64) -> Indentation<'_> {
    Indentation {
        layers,
        lateral: 0.0,
        mesh_size,
    }
}

fn holds(interval: Interval, truth: f64) -> bool {
    (interval.ends[0]..=interval.ends[1]).contains(&truth)
}

// Verifies: CAL-010, CAL-011, CAL-012, CAL-030, CAL-013, CAL-035.
#[test]
fn contact_and_modulus_of_a_gel_are_found() {
    let phantom = Phantom::builtin("none").unwrap();
    let rig = Rig::new(&phantom, 0.7e-3);
    let asked = asked(&[], 1e-3);
    let mut missed = [0; 3];
    for number in 0..20 {
        let curve = rig.curve(1.3, 0.01, number);
        let question = CalibrationQuestion {
            gel: Some((&phantom, asked)),
            contact: None,
        };
        let found = calibrate(&curve, question).unwrap();
        assert_eq!(found.cause, None);
        let moduli = found.moduli(&[]).unwrap();
        let truths = [
            TOUCHED,
            1.3 * phantom.layers()[0].material.youngs_modulus,
            0.01,
        ];
        let found = [
            found.contact().unwrap().unwrap(),
            moduli[0].1,
            found.noise_sd().unwrap().unwrap(),
        ];
        for (missed, (found, truth)) in missed.iter_mut().zip(found.into_iter().zip(truths)) {
            *missed += usize::from(!holds(found, truth));
            assert!(
                (found.estimate / truth - 1.0).abs() < 0.15,
                "{found:?} {truth}"
            );
        }
    }
    // Of 20 intervals of 95 % more than 4 miss with 0.3 %.
    assert!(missed.iter().all(|missed| *missed <= 4), "{missed:?}");
}

// Verifies: CAL-036. The root of a mean is too small by its variance over 8 times its cube.
#[test]
fn the_bias_of_a_root_is_taken_from_it() {
    let data: Vec<f64> = (0..10).map(|k| [3.0, 5.0][k % 2]).collect();
    let found = fit(&|at| vec![at[0] * at[0]; 10], &data, &[1.0]).unwrap();
    let root = found.interval(|at| at[0]).unwrap();
    // One of ten degrees of freedom is that of the root. The last step of the fit moves it by less than 1e-8.
    let variance_of_mean = 10.0 / 9.0 / 10.0;
    let unbiased = 2.0 + variance_of_mean / (8.0 * 8.0);
    assert!((root.estimate - unbiased).abs() < 1e-7, "{root:?}");
    assert!((0.5 * (root.ends[0] + root.ends[1]) - unbiased).abs() < 1e-7);
}

// Verifies: CAL-037. A contact held at an end of the interval leaves 1 + t²/n times the least sum of squares.
#[test]
fn the_interval_of_the_contact_ends_where_the_profile_says() {
    let curve = Rig::new(&Phantom::builtin("none").unwrap(), 1e-3).curve(1.3, 30e-3, 1);
    let question = |contact| CalibrationQuestion { gel: None, contact };
    let found = calibrate(&curve, question(None)).unwrap();
    let (interval, fit) = (found.contact().unwrap().unwrap(), found.fit.unwrap());
    assert!(interval.ends[0] < interval.estimate && interval.estimate < interval.ends[1]);
    for end in interval.ends {
        let held = calibrate(&curve, question(Some(end))).unwrap();
        assert_eq!(held.relaxation, found.relaxation);
        let more = held.fit.unwrap().squares / fit.squares - 1.0;
        let point = (more * fit.degrees).sqrt();
        // Student's point of 97.5 % is 1.960 + 2.4/n.
        let expected = 1.96 + 2.4 / fit.degrees;
        // The steps end within a hundredth.
        assert!((point / expected - 1.0).abs() < 0.01, "{point} at {end}");
    }
}

// Verifies: CAL-030, CAL-036, CAL-037, CAL-010, CAL-011. 2,000 curves at each noise, whose forces come from a mesh of a quarter of the size.
#[test]
#[ignore = "slow: run it with --release"]
fn intervals_hold_what_they_state_in_95_of_100_curves() {
    let phantom = Phantom::builtin("none").unwrap();
    let rig = Rig::new(&phantom, 0.125e-3);
    let gel = Gel::new(&phantom, asked(&[], crate::fem::MESH_SIZE), 3.8e-3).unwrap();
    let elastic = Elastic::Gel(Box::new(gel));
    for (stream, noise) in (1..).zip([3e-3, 10e-3, 30e-3]) {
        let curves = 0..2000u64;
        let errors: Vec<_> = (curves.into_par_iter())
            .filter_map(|number| {
                let curve = rig.curve(1.3, noise, 10_000 * stream + number);
                let known = Known {
                    contact: None,
                    no_drift: false,
                };
                let mut scanned = empirical_law(&curve, known).unwrap();
                scanned.insert(2, 0.0);
                let start = best(&curve, known, Elastic::Empirical, &scanned);
                let ended = start.fit.map(|fit| fit.parameters);
                let mut start = ended.unwrap_or(scanned)[..3].to_vec();
                start.push(0.0);
                let found = best(&curve, known, elastic.clone(), &start);
                found.cause.is_none().then_some(())?;
                let quantities = [
                    (found.contact().unwrap().unwrap(), TOUCHED),
                    (found.law().unwrap()[0], 1.3),
                    (found.noise_sd().unwrap().unwrap(), noise),
                ];
                let of =
                    |(of, truth): (Interval, f64)| (holds(of, truth), of.estimate / truth - 1.0);
                Some(quantities.map(of))
            })
            .collect();
        // In much noise the steps of a fit may not end.
        assert!(
            errors.len() >= 1995,
            "{} of 2,000 were judged",
            errors.len()
        );
        for (quantity, name) in ["contact", "modulus", "noise"].into_iter().enumerate() {
            let count = errors.len() as f64;
            let of = |k: usize| errors[k][quantity];
            let all = 0..errors.len();
            let covered = all.clone().filter(|k| of(*k).0).count() as f64 / count;
            let mean = all.clone().map(|k| of(k).1).sum::<f64>() / count;
            let sd = (all.map(|k| (of(k).1 - mean).powi(2)).sum::<f64>() / count).sqrt();
            let bias = mean / (sd / count.sqrt());
            println!(
                "{noise} N {name}: {covered:.4} covered, bias {mean:.2e} = {bias:.2} standard errors, sd {sd:.2e}"
            );
            assert!(
                (0.93..=0.97).contains(&covered),
                "{noise} N, {name}: {covered}"
            );
            // The bias of one estimate is small beside its spread.
            assert!(mean.abs() < 0.25 * sd, "{noise} N, {name}: {mean} {sd}");
        }
    }
}

// Verifies: CAL-012, CAL-013, CAL-034.
#[test]
fn the_modulus_of_a_named_layer_is_found() {
    let text = r#"
name = "skin"
well = { width_mm = 34 }
layer = [{ name = "skin", thickness_mm = 1, youngs_modulus_kpa = 20, poisson_ratio = 0.45 },
         { name = "gel", thickness_mm = 15, youngs_modulus_kpa = 5, poisson_ratio = 0.45 }]
probe = { radius_mm = 6.5, length_mm = 30 }
"#;
    let phantom = Phantom::from_toml(text, "skin.toml").unwrap();
    let stiff = phantom.set([("layer[0].youngs_modulus_kpa", 45)]).unwrap();
    let curve = Rig::new(&stiff, 1e-3).curve(1.0, 1e-3, 0);
    let question = |layers| CalibrationQuestion {
        gel: Some((&phantom, asked(layers, 1e-3))),
        contact: Some(TOUCHED),
    };
    let found = calibrate(&curve, question(&[0])).unwrap();
    let moduli = found.moduli(&[0]).unwrap();
    assert_eq!((&*moduli[0].0, moduli.len()), ("skin", 1));
    assert!(
        (moduli[0].1.estimate / 45e3 - 1.0).abs() < 0.03,
        "{moduli:?}"
    );
    let calibrated = calibrated(&phantom, &[0], &moduli).unwrap();
    let [skin, gel] = [0, 1].map(|layer| calibrated.layers()[layer].material.youngs_modulus);
    assert_eq!((skin, gel), (moduli[0].1.estimate, 5000.0));
    // Another gel is of no use: the contact is known, and one factor of both moduli has another curve.
    let error = calibrate(&curve, question(&[7])).unwrap_err().to_string();
    assert_eq!(error, "layer = 7, but must be below 2");
}

// Verifies: CAL-012, CAL-013.
#[test]
fn one_factor_is_that_of_all_moduli_and_of_an_inclusion_too() {
    let phantom = Phantom::builtin("4.6").unwrap();
    let moduli = |of: &Phantom| -> Vec<f64> {
        let all = of.materials();
        all.map(|material| material.youngs_modulus).collect()
    };
    let own = moduli(&phantom);
    assert_eq!(own.len(), 3);
    let stiffer = |layers: &[usize]| moduli(&stiffened(&phantom, layers, &[1.5]).unwrap());
    let scaled = |factors: [f64; 3]| -> Vec<f64> {
        own.iter()
            .zip(factors)
            .map(|(modulus, factor)| factor * modulus)
            .collect()
    };
    assert_eq!(stiffer(&[]), scaled([1.5; 3]));
    assert_eq!(stiffer(&[1]), scaled([1.0, 1.5, 1.0]));
    let fibrous = Phantom::builtin("none").unwrap().changed(|parts| {
        parts.strain = Strain::Finite;
        parts.layers[1].material.yeoh_c20 = 2e3;
        parts.layers[1].material.fibre_modulus = 2e4;
    });
    let fibrous = fibrous.unwrap();
    let force = |of: &Phantom| {
        let map = Model::new(of, 3e-3, Contact::default()).unwrap();
        let map = map.sweep(&[1e-3], &[0.0]).unwrap();
        map.table().normal().row(0)[0]
    };
    let factor = force(&stiffened(&fibrous, &[], &[1.5]).unwrap()) / force(&fibrous);
    assert!((factor - 1.5).abs() < 1e-6, "{factor}");
}

// Verifies: CAL-011. At 0.5 µm the probe is 0.16 mm wide, and the first of the contact points are 0.21 mm apart.
#[test]
fn a_mesh_without_a_point_under_the_lightest_touch_is_refused() {
    let phantom = Phantom::builtin("none").unwrap();
    let error = Gel::new(&phantom, asked(&[], 2e-3), 1e-4).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the mesh is so coarse that a light touch has no force; give a smaller mesh size"
    );
}

/// A sphere on a gel that relaxes by a power law, as [`relaxing`].
fn held(amount: f64, air: f64) -> Curve {
    let terms = Relaxation::PowerLaw.terms(&[libm::log(0.5), libm::log(0.25)]);
    relaxing(&terms, amount, air)
}

/// A sphere on a gel that relaxes, 2 s down and 10 s held; from a contact on.
fn relaxing(terms: &[[f64; 2]], amount: f64, air: f64) -> Curve {
    let times: Vec<f64> = (0..=480).map(|k| 0.025 * f64::from(k)).collect();
    let depths: Vec<f64> = times.iter().map(|t| 2e-3 * t.min(2.0)).collect();
    let elastic = |d: &f64| amount * (1e3 * (d - air)).max(0.0).powf(1.5);
    let elastic: Vec<f64> = depths.iter().map(elastic).collect();
    let generator = Generator::new(43, 0);
    let noise = |k: usize| 2e-3 * generator.normal(0, k as u64);
    let forces = relaxed(terms, &times, &elastic);
    let forces: Vec<f64> = forces
        .iter()
        .enumerate()
        .map(|(k, f)| f + noise(k))
        .collect();
    Curve::new("held", Some(&times), &depths, &forces).unwrap()
}

/// A sphere on a gel, whose force is bent by 3 % to either side.
fn bent() -> Curve {
    let depths: Vec<f64> = (0..=200).map(|k| 2e-5 * f64::from(k)).collect();
    let generator = Generator::new(45, 0);
    let force = |(k, depth): (usize, &f64)| {
        let elastic = 0.2 * (1e3 * (depth - 0.8e-3)).max(0.0).powf(1.5);
        let noise = 2e-3 * generator.normal(0, k as u64);
        elastic * (1.0 + 0.03 * (0.2 * k as f64).sin()) + noise
    };
    let forces: Vec<f64> = depths.iter().enumerate().map(force).collect();
    Curve::new("bent", None, &depths, &forces).unwrap()
}

const ALONE: CalibrationQuestion<'_> = CalibrationQuestion {
    gel: None,
    contact: None,
};

// Verifies: CAL-021, CAL-022, CAL-030, CAL-032.
#[test]
fn the_relaxation_of_a_sphere_is_found_with_its_form() {
    let curve = held(0.2, 0.8e-3);
    let found = calibrate(&curve, ALONE).unwrap();
    assert_eq!(
        (found.cause, found.relaxation),
        (None, Relaxation::PowerLaw)
    );
    let terms = found.relaxation_terms().unwrap();
    let law = found.law().unwrap();
    for (interval, truth) in [
        (terms[0].0, 0.5),
        (terms[0].1, 0.25),
        (law[0], 0.2),
        (law[1], 1.5),
        (found.contact().unwrap().unwrap(), 0.8e-3),
    ] {
        // Twice the interval: of five, none is beyond it in 2,000 such curves.
        let half = interval.ends[1] - interval.ends[0];
        assert!(
            (interval.estimate - truth).abs() < half,
            "{interval:?} {truth}"
        );
        assert!(half < 0.5 * truth, "{interval:?}");
    }
    let rows = serde_json::to_value(found.rows(&[]).unwrap()).unwrap();
    assert_eq!(rows["relaxation"]["form"], "power_law");
    assert_eq!(rows["held"][2]["seconds"], 10.0);
}

/// A curve that relaxes by a power law that one exponential nearly describes, in noise of 5 mN; from 0.8 mm on, with an offset of 0.12 N and
/// a drift of −0.02 N.
fn nearly_exponential(number: u64) -> Curve {
    let times: Vec<f64> = (0..=292).map(|k| 0.025 * f64::from(k)).collect();
    let depths: Vec<f64> = times.iter().map(|t| 2e-3 * t.min(2.3)).collect();
    let elastic = |d: &f64| 0.15 * (1e3 * (d - 0.8e-3)).max(0.0).powf(1.6);
    let elastic: Vec<f64> = depths.iter().map(elastic).collect();
    let terms = Relaxation::PowerLaw.terms(&[0.0, libm::log(0.135)]);
    let mut forces = relaxed(&terms, &times, &elastic);
    let generator = Generator::new(47, number);
    for (k, force) in forces.iter_mut().enumerate() {
        *force += 0.12 - 0.02 * k as f64 / 292.0 + 5e-3 * generator.normal(0, k as u64);
    }
    Curve::new("held", Some(&times), &depths, &forces).unwrap()
}

/// Whether the intervals of contact, offset and drift hold them, in the curve of that number.
fn held_whatever_form(number: u64) -> [bool; 3] {
    let curve = nearly_exponential(number);
    let found = calibrate(&curve, ALONE).unwrap();
    let [offset, drift] = found.baseline().unwrap().map(Option::unwrap);
    let contact = found.contact().unwrap().unwrap();
    let held = [(contact, 0.8e-3), (offset, 0.12), (drift, -0.02)];
    held.map(|(of, truth)| holds(of, truth))
}

// The noise of this curve prefers one exponential, whose own interval does not hold the drift.
// Verifies: CAL-022.
#[test]
fn a_form_that_is_nearly_as_good_widens_the_intervals() {
    let curve = nearly_exponential(0);
    let found = calibrate(&curve, ALONE).unwrap();
    assert_eq!(found.relaxation, Relaxation::Prony(1));
    let own = found.interval(|parts| parts.baseline[1]).unwrap().unwrap();
    assert!(!holds(own, -0.02), "{own:?}");
    assert_eq!(held_whatever_form(0), [true; 3]);
}

// Verifies: CAL-022, CAL-030. With the best form alone, 50 of 60 intervals held the drift, in curves of another
// simulator.
#[test]
#[ignore = "slow: run it with --release"]
fn intervals_hold_what_they_state_whatever_form_is_taken() {
    let all: Vec<_> = (0..100).into_par_iter().map(held_whatever_form).collect();
    for (quantity, name) in ["contact", "offset", "drift"].into_iter().enumerate() {
        let covered = all.iter().filter(|held| held[quantity]).count();
        println!("{name}: {covered} of 100");
        // Of 100 intervals that hold with 95 %, fewer than 87 hold with a probability of 5e-4.
        assert!(covered >= 87, "{name}: {covered}");
    }
}

// Verifies: CAL-030.
#[test]
fn no_interval_of_a_weight_reaches_below_zero() {
    let curve = relaxing(&[[0.3, 2.0]], 0.2, 0.8e-3);
    let mut found = calibrate(&curve, ALONE).unwrap();
    assert_eq!(found.relaxation, Relaxation::Prony(1));
    let weight = |found: &Calibration<'_>| found.relaxation_terms().unwrap()[0].1;
    let own = weight(&found);
    assert!(
        (own.estimate - 0.3).abs() < own.ends[1] - own.ends[0],
        "{own:?}"
    );
    // So much wider that the estimate less half the width would be half of it below 0.
    let reach = libm::log(own.ends[1] / own.estimate);
    found.fit.as_mut().unwrap().covariance *= (1.5 / reach).powi(2);
    let wide = weight(&found);
    for (end, factor) in wide.ends.into_iter().zip([-1.5, 1.5].map(libm::exp)) {
        // A derivative by differences, and some roundings.
        assert_near(end / (factor * own.estimate), 1.0, 1e-9);
    }
}

// Verifies: CAL-040.
#[test]
fn a_curve_that_says_nothing_is_not_judged() {
    for (curve, cause) in [
        (held(0.0, 0.8e-3), CurveCause::NoContact),
        (held(0.2, 0.8e-3).negated(), CurveCause::Sign),
        (held(0.2, -1e-3), CurveCause::NoAir),
        (bent(), CurveCause::Misfit),
    ] {
        let found = calibrate(&curve, ALONE).unwrap();
        // There is a fit to look at, but for what is not there.
        let is_nothing = matches!(cause, CurveCause::NoContact | CurveCause::Sign);
        assert!(found.expected().is_some() || is_nothing);
        assert_eq!(found.cause, Some(cause));
        assert_eq!(found.contact().unwrap(), None);
        assert_eq!(
            found.rows(&[]).unwrap().get("contact"),
            Some(&serde_json::Value::Null)
        );
    }
    // A stage that knows where the gel is may begin within it.
    let known = CalibrationQuestion {
        contact: Some(-1e-3),
        ..ALONE
    };
    assert_eq!(calibrate(&held(0.2, -1e-3), known).unwrap().cause, None);
}

/// A curve of a probe that goes down evenly, from `begin` mm on, into a gel that it touches at 0.5 mm: 0.1 N at rest; noise and drift over
/// the curve are shares of the highest force.
fn ramp(gel: &Elastic, begin: f64, [noise, drift]: [f64; 2], number: u64) -> Curve {
    let changes = vec![0.0; gel.parameters()];
    let force = |depth: f64| gel.force(depth - 0.5, &changes);
    let generator = Generator::new(46, number);
    let depth = |k: u32| begin + 0.02 * f64::from(k);
    let depths: Vec<f64> = (0..400).map(depth).take_while(|d| *d < 3.51).collect();
    let last = (depths.len() - 1) as f64;
    let sample = |(k, depth): (usize, &f64)| {
        let more = noise * generator.normal(0, k as u64) + drift * k as f64 / last;
        0.1 + force(*depth) + more * force(3.5)
    };
    let forces: Vec<f64> = depths.iter().enumerate().map(sample).collect();
    let depths: Vec<f64> = depths.iter().map(|depth| 1e-3 * depth).collect();
    Curve::new("ramp", None, &depths, &forces).unwrap()
}

/// The forces of one layer of 15 mm, 5 kPa.
fn even_gel() -> (Phantom, Elastic) {
    let text = r#"
name = "even"
well = { width_mm = 34 }
layer = [{ name = "gel", thickness_mm = 15, youngs_modulus_kpa = 5, poisson_ratio = 0.49 }]
probe = { radius_mm = 6.5, length_mm = 30 }
"#;
    let phantom = Phantom::from_toml(text, "even.toml").unwrap();
    let gel = Gel::new(&phantom, asked(&[], 1e-3), 3.2e-3).unwrap();
    (phantom, Elastic::Gel(Box::new(gel)))
}

// Verifies: CAL-041, CAL-040. A drift over the number of the sample is one over the depth, and takes the place of the force.
#[test]
fn no_drift_takes_the_place_of_a_force() {
    let (phantom, gel) = even_gel();
    let of_gel = CalibrationQuestion {
        gel: Some((&phantom, asked(&[], 1e-3))),
        contact: None,
    };
    let begins = [0.55, 0.6, 0.7, 0.8, 1.0];
    let noises = [1e-3, 1e-2];
    let all = begins.iter().flat_map(|b| noises.map(|n| (*b, n)));
    let all: Vec<_> = all.flat_map(|of| [0, 1, 2].map(|k| (of, k))).collect();
    let judged = all.par_iter().flat_map_iter(|&((begin, noise), number)| {
        let curve = ramp(&gel, begin, [noise, 0.0], number);
        [of_gel, ALONE].into_iter().filter_map(move |question| {
            let found = calibrate(&curve, question).unwrap();
            let wrong = found.contact().unwrap()?.estimate;
            let law = question.gel.map_or("empirical", |_| "gel");
            Some(format!(
                "{law}, from {begin} mm, {noise}, {number}: {wrong}"
            ))
        })
    });
    let judged: Vec<String> = judged.collect();
    assert!(
        judged.is_empty(),
        "{} are judged: {judged:#?}",
        judged.len()
    );
    // If the contact is known, the sensor may drift.
    let known = CalibrationQuestion {
        contact: Some(0.5e-3),
        ..of_gel
    };
    let curve = ramp(&gel, 0.6, [1e-3, 0.0], 0);
    let found = calibrate(&curve, known).unwrap();
    let modulus = found.moduli(&[]).unwrap()[0].1.estimate;
    assert!((modulus / 5e3 - 1.0).abs() < 0.01, "{modulus}");
}

// Verifies: CAL-041, CAL-010, CAL-030.
#[test]
fn a_drift_that_the_air_shows_is_fitted() {
    let (phantom, gel) = even_gel();
    let question = CalibrationQuestion {
        gel: Some((&phantom, asked(&[], 1e-3))),
        contact: None,
    };
    let all = [0.3, 0.1, 0.02, -0.02, -0.1, -0.3].map(|drift| [1e-3, 1e-2].map(|n| [n, drift]));
    all.as_flattened().par_iter().for_each(|disturbed| {
        // 35 samples of air.
        let curve = ramp(&gel, -0.2, *disturbed, 0);
        let found = calibrate(&curve, question).unwrap();
        assert_eq!(found.cause, None, "{disturbed:?}");
        let modulus = found.moduli(&[]).unwrap()[0].1;
        let half = 0.5 * (modulus.ends[1] - modulus.ends[0]);
        // Twice the interval of 95 %: of 10,000 such moduli one is beyond it.
        assert!(
            (modulus.estimate - 5e3).abs() < 2.0 * half,
            "{disturbed:?}: {modulus:?}"
        );
        assert!(half < 2e3, "{disturbed:?}: {modulus:?}");
    });
}

// Verifies: CAL-012, CAL-040. The skin alone cannot make a gel half as stiff: its modulus goes down with each step, until no gel has it.
#[test]
fn moduli_whose_steps_do_not_end_are_not_those_of_the_gel() {
    let phantom = Phantom::builtin("none").unwrap();
    let curve = Rig::new(&phantom, 1e-3).curve(0.5, 0.01, 3);
    let question = CalibrationQuestion {
        gel: Some((&phantom, asked(&[0], 2e-3))),
        contact: None,
    };
    let found = calibrate(&curve, question).unwrap();
    assert_eq!(found.cause, Some(CurveCause::Misfit));
    assert!(found.expected().is_some() && found.moduli(&[0]).unwrap().is_empty());
}

// Verifies: CAL-011.
#[test]
fn a_phantom_with_friction_is_refused() {
    let phantom = Phantom::builtin("none").unwrap();
    let curve = Rig::new(&phantom, 1e-3).curve(0.5, 0.01, 3);
    let rubs = phantom.changed(|parts| {
        parts.strain = Strain::Finite;
        parts.probe.friction = 0.3;
    });
    let question = CalibrationQuestion {
        gel: Some((&rubs.unwrap(), asked(&[], 2e-3))),
        contact: None,
    };
    let error = calibrate(&curve, question).unwrap_err().to_string();
    assert!(error.contains("leave out probe.friction"), "{error}");
}

// Verifies: CAL-001, CAL-002.
#[test]
fn curves_that_are_none_are_refused() {
    let curve = |count: i32, step: f64| {
        let depths: Vec<f64> = (0..count).map(|k| step * f64::from(k)).collect();
        Curve::new("c", None, &depths, &depths)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        curve(19, 1e-3),
        "c: 19 samples on the way into the gel; give at least 20"
    );
    let there_and_back: Vec<f64> = (-30i32..=30).map(|k| -1e-4 * f64::from(k.abs())).collect();
    let kept = Curve::new("c", None, &there_and_back, &there_and_back).unwrap();
    // Within 5 % of the way of 3 mm there is one sample behind the deepest.
    assert_eq!(
        (kept.depths().len(), kept.notes()),
        (
            32,
            &["samples of the way back are not used: 29".to_string()][..]
        )
    );
    // However far above its start the probe then goes.
    let up = (1..=300).map(|k| -3e-3 - 1e-4 * f64::from(k));
    let further: Vec<f64> = there_and_back.iter().copied().chain(up).collect();
    let kept_of_further = Curve::new("c", None, &further, &further).unwrap();
    assert_eq!(kept_of_further.depths(), kept.depths());
    // Nor is a second cycle used, though it goes as deep.
    let again: Vec<f64> = [&there_and_back[..], &there_and_back[1..]].concat();
    let kept_of_again = Curve::new("c", None, &again, &again).unwrap();
    assert_eq!(kept_of_again.depths(), kept.depths());
    // With what the reader of the file has to say before it.
    let rows = there_and_back.iter().map(|x| format!("{x},{x},0\n"));
    let text = "depth_m,normal_force_n,note\n".to_string() + &rows.collect::<String>();
    let read = Curve::from_csv(&text, "c.csv", &Default::default()).unwrap();
    let unused = "column \"note\" is not used".to_string();
    assert_eq!(read.notes(), [unused, kept.notes()[0].clone()]);
    assert_eq!(
        curve(40, 0.0),
        "c: the probe does not move into the gel; give a curve into the gel, on which the depth grows"
    );
    let text = "t (s),depth_mm,Fz\n".to_string() + &"0,1,1\n".repeat(30);
    let error = Curve::from_csv(&text, "c.csv", &Default::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "c.csv: time 0.0 s after 0.0 s; give times that increase"
    );
}

// Verifies: CAL-030. Of Student's law with one and with two degrees of freedom the quantiles are known.
#[test]
fn an_interval_holds_95_of_100_by_students_law() {
    let tangent = (0.475 * std::f64::consts::PI).tan();
    for (degrees, point) in [(1.0, tangent), (2.0, 0.95 * (2.0_f64 / 0.0975).sqrt())] {
        let Interval { estimate, ends } = Interval::of(3.0, 2.0, degrees).unwrap();
        assert_eq!(estimate, 3.0);
        // The tails are right to some 1e-13, and the tangent multiplies by 160.
        for (end, expected) in ends.into_iter().zip([3.0 - 2.0 * point, 3.0 + 2.0 * point]) {
            assert!((end / expected - 1.0).abs() < 1e-10, "{end} {expected}");
        }
    }
}

// Verifies: CAL-031. Each sample has 0.6 of the noise of the one before it: independent samples would count as four times as many.
#[test]
fn intervals_allow_for_noise_that_is_correlated() {
    let samples = 200;
    let line = |at: &[f64]| -> Vec<f64> {
        let x = |k: usize| k as f64 / samples as f64;
        (0..samples).map(|k| at[0] + at[1] * x(k)).collect()
    };
    let held = (0..400).filter(|trial| {
        let mut white = vec![0.0; samples];
        Generator::new(44, 0).normals(*trial, 0, &mut white);
        let noise = white.iter().scan(0.0, |before, white| {
            *before = 0.6 * *before + 0.8 * white;
            Some(*before)
        });
        let data: Vec<f64> = line(&[1.0, 0.5])
            .iter()
            .zip(noise)
            .map(|(y, n)| y + n)
            .collect();
        let found = fit(&line, &data, &[0.0, 0.0]).unwrap();
        holds(found.interval(|at| at[0]).unwrap(), 1.0)
    });
    // 95 % less what the estimate of the correlation misses; without it 67 %, with a standard deviation of 2.4 %.
    let covered = held.count() as f64 / 400.0;
    assert!((0.85..=0.98).contains(&covered), "{covered}");
}
