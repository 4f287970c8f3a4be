//! The design and the indices against closed forms, and a small study against slopes that another program found.

use std::f64::consts::PI;

use super::*;
use palpate::phantom::BUILTIN_NAMES;
use palpate_asserts::assert_near;
use palpate_asserts::numbers;

const NAMES: [&str; 6] = ["a", "b", "c", "d", "e", "f"];

/// The indices of a function of independent uniform inputs.
fn found(inputs: usize, rows: usize, seed: u32, of: impl Fn(&[f64]) -> f64) -> Vec<Index> {
    let design = Design::new(&NAMES[..inputs], &[], rows, seed).unwrap();
    let samples = (0..design.samples()).map(|sample| of(&design.probabilities(sample)));
    let values: Vec<f64> = samples.collect();
    indices(&design.split(&values).rows, 7).unwrap()
}

fn assert_indices(found: &[Index], expected: &[[f64; 2]]) {
    for (number, (found, [first_order, total])) in found.iter().zip(expected).enumerate() {
        for (found, expected) in [(found.first_order, first_order), (found.total, total)] {
            let error = (found.value - expected).abs();
            let holds = error < 0.01;
            assert!(holds, "input {number}: {found:?}, expected {expected}");
            // A bootstrap knows nothing of how even the points are: its interval is wide, but not several times 0.01.
            let holds = found.lower <= found.value && found.value <= found.upper;
            assert!(holds, "{found:?}");
            assert!(found.upper - found.lower < 0.15, "{found:?}");
        }
    }
}

// Verifies: STU-020, STU-040.
#[test]
fn the_indices_of_ishigamis_function_are_its_closed_form() {
    let (a, b) = (7.0, 0.1);
    let ishigami = |p: &[f64]| {
        let [x, y, z] = [p[0], p[1], p[2]].map(|p| PI * (2.0 * p - 1.0));
        x.sin() + a * y.sin().powi(2) + b * z.powi(4) * x.sin()
    };
    let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
    let second = a * a / 8.0;
    let together = b * b * PI.powi(8) * 8.0 / 225.0;
    let variance = first + second + together;
    let expected = [[first, first + together], [second, second], [0.0, together]];
    for seed in 1..=4 {
        let found = found(3, 1 << 14, seed, ishigami);
        assert_indices(&found, &expected.map(|of| of.map(|of| of / variance)));
    }
}

// Verifies: STU-040.
#[test]
fn the_indices_of_the_g_function_are_its_closed_form() {
    let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0];
    let g = |p: &[f64]| {
        let factors = p
            .iter()
            .zip(a)
            .map(|(p, a)| ((4.0 * p - 2.0).abs() + a) / (1.0 + a));
        factors.product()
    };
    let of = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
    let all: f64 = of.iter().map(|of| 1.0 + of).product();
    let expected = of.map(|of| [of, of * all / (1.0 + of)].map(|of| of / (all - 1.0)));
    for seed in 1..=4 {
        assert_indices(&found(6, 1 << 12, seed, g), &expected);
    }
}

// Verifies: STU-040.
#[test]
fn a_quantity_that_does_not_vary_has_no_indices() {
    assert_eq!(indices(&[&[0.1; 3][..]; 5], 1), None);
    assert_eq!(indices(&[&[1.0, 2.0, 2.0][..]], 1), None);
}

// (1 − 1/50)⁵⁰ = 36 % of the resamples are without the one row that differs; they are left out.
// Verifies: STU-040.
#[test]
fn a_quantity_that_seldom_varies_has_indices() {
    // A tenth is no binary number: the mean of fifty is another one. The groups do not change the row that varies.
    let mut rows = vec![[0.1; 3]; 50];
    rows[20] = [2.0, 3.0, 2.5];
    rows[30][2] = 0.2;
    let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
    let [index] = indices(&rows, 1).unwrap()[..] else {
        panic!("one group")
    };
    for of in [index.first_order, index.total] {
        let holds = of.lower <= of.value && of.value <= of.upper;
        assert!(holds && of.lower < of.upper && of.upper < 2.0, "{of:?}");
    }
}

// A change with the other sign has the other index, and its interval is turned round.
// Verifies: STU-040.
#[test]
fn an_interval_leaves_out_as_much_above_as_below() {
    // Multiples of 1/64, which are exact.
    let number = |row: u32, factor: u32| f64::from(row * factor % 61) / 64.0;
    let row = |row: u32| {
        let [a, b, mixed] = [7, 19, 23].map(|factor| number(row, factor));
        [a, b, mixed, 2.0 * a - mixed]
    };
    let rows: Vec<[f64; 4]> = (1..=60).map(row).collect();
    let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
    let found = indices(&rows, 3).unwrap();
    let [one, other] = [0, 1].map(|group: usize| found[group].first_order);
    assert!(one.lower < one.upper);
    for (end, mirrored) in [(one.lower, other.upper), (one.upper, other.lower)] {
        assert_near(end, -mirrored, 1e-15);
    }
}

fn correlation(one: &str, other: &str, coefficient: f64) -> Correlation {
    Correlation {
        inputs: [one, other].map(String::from),
        coefficient,
    }
}

// Verifies: STU-020, STU-021.
#[test]
fn each_sample_has_one_role_and_the_points_fill_the_unit_cube_evenly() {
    let design = Design::new(&NAMES[..4], &[correlation("a", "c", 0.8)], 256, 5).unwrap();
    assert_eq!(design.groups(), [vec![0, 2], vec![1], vec![3]]);
    assert_eq!(design.samples(), 3 + 2 * 4 + 256 * 5);
    let place = |role| {
        let mut samples = 0..design.samples();
        samples.position(|sample| design.role(sample) == role)
    };
    for sample in 0..design.samples() {
        assert_eq!(place(design.role(sample)), Some(sample));
    }
    let at = |role| design.probabilities(place(role).unwrap());
    // A scrambled Sobol' sequence is a (t, s)-sequence: 256 points have one in each 256th of every coordinate.
    for role in [Role::First, Role::Second] {
        for input in [1, 3] {
            let mut cells = [0; 256];
            for row in 0..256 {
                let p = at(role(row))[input];
                assert!(p > 0.0 && p < 1.0);
                cells[(p * 256.0) as usize] += 1;
            }
            assert_eq!(cells, [1; 256], "{input}");
        }
    }
    // A mixed sample has one group of the second, and all else of the first.
    let [first, second] = [Role::First(9), Role::Second(9)].map(at);
    for (group, inputs) in design.groups().iter().enumerate() {
        let of = |input| match inputs.contains(&input) {
            true => second[input],
            false => first[input],
        };
        assert_eq!(at(Role::Mixed(9, group)), [0, 1, 2, 3].map(of), "{group}");
    }
    assert_eq!(at(Role::Median(2)), [0.5; 4]);
    assert_eq!(at(Role::Slope(1, 0)), [0.5, 0.25, 0.5, 0.5]);
}

// The sequence has 2¹⁶ points: what follows is another scrambling of it, as even and with no point again.
// Verifies: STU-020.
#[test]
fn rows_beyond_the_sequence_are_points_of_their_own() {
    let rows = 1 << 20;
    let design = Design::new(&NAMES[..1], &[], rows, 5).unwrap();
    assert_eq!(design.samples(), 3 + 2 + 3 * rows);
    let of = |row: usize| {
        let sample = 3 + 2 + 3 * row;
        assert_eq!(design.role(sample), Role::First(row));
        design.probabilities(sample)[0]
    };
    let block = |from: usize| (from..from + 256).map(of).collect::<Vec<_>>();
    let blocks = [0, 1 << 16, 2 << 16, 1 << 19, rows - 256].map(block);
    let mut cells = [[0; 256]; 5];
    for (block, cells) in blocks.iter().zip(&mut cells) {
        block.iter().for_each(|p| cells[(p * 256.0) as usize] += 1);
    }
    assert_eq!(cells, [[1; 256]; 5]);
    let mut all = blocks.concat();
    all.sort_by(f64::total_cmp);
    // Two of 2²³ cells drawn 1280 times are the same once in ten draws, of a block that came again 256 times.
    assert!(all.windows(2).filter(|pair| pair[0] == pair[1]).count() < 4);
    let end = design.samples() - 1;
    assert_eq!(design.role(end), Role::Mixed(rows - 1, 0));
    assert!(Design::new(&NAMES[..1], &[], rows + 1, 5).is_err());
}

// Verifies: STU-012.
#[test]
fn correlated_inputs_have_normal_scores_of_that_correlation() {
    let correlations = [correlation("a", "b", 0.8), correlation("b", "c", -0.5)];
    let rows = 4096;
    let design = Design::new(&NAMES[..3], &correlations, rows, 1).unwrap();
    let score = |p| palpate::stats::normal::quantile(p).unwrap();
    let is_first = |sample: &usize| matches!(design.role(*sample), Role::First(_));
    let first = (0..design.samples()).filter(is_first);
    let scores = first.map(|sample| {
        design
            .probabilities(sample)
            .into_iter()
            .map(score)
            .collect()
    });
    let scores: Vec<Vec<f64>> = scores.collect();
    let expected = "0 1 0.8\n1 2 -0.5\n0 2 0\n0 0 1\n2 2 1";
    for [one, other, expected] in numbers(expected) {
        let [one, other] = [one, other].map(|input| input as usize);
        let product: f64 = scores.iter().map(|of| of[one] * of[other]).sum();
        // Independent draws would have a standard deviation of at most √2/√4096 = 0.022; these are more even.
        assert_near(product / rows as f64, expected, 0.02);
    }
}

// Verifies: STU-012.
#[test]
fn correlations_that_cannot_be_are_refused() {
    // Two inputs and their coefficient, or several such, and the beginning of the refusal.
    let cases = "
        a x 0.5 => correlation[0].inputs = a, x, but must be two of a, b, c
        a a 0.5 => correlation[0].inputs = a, a, but must be two different inputs
        a b 0.5; b a 0.5 => correlation[1].inputs = b, a, but must be two different inputs
        a b 1.0 => correlation[0].coefficient = 1, but must be
        a b NaN => correlation[0].coefficient = NaN, but must be
        a b 0.9; b c 0.9; a c -0.9 => the correlations of a, b, c contradict one another
    ";
    for case in cases.trim().lines().map(str::trim) {
        let (pairs, expected) = case.split_once(" => ").unwrap();
        let correlation = |pair: &str| {
            let words: Vec<&str> = pair.split_whitespace().collect();
            correlation(words[0], words[1], words[2].parse().unwrap())
        };
        let correlations: Vec<_> = pairs.split(';').map(correlation).collect();
        let found = Design::new(&NAMES[..3], &correlations, 8, 1).unwrap_err();
        assert!(found.to_string().starts_with(expected), "{found}");
    }
    for (inputs, rows, expected) in [(0, 8, "0 inputs"), (2, 1, "rows = 1")] {
        let found = Design::new(&NAMES[..inputs], &[], rows, 1).unwrap_err();
        assert!(found.to_string().starts_with(expected), "{found}");
    }
}

// Verifies: STU-043.
#[test]
fn the_intervals_of_quantiles_are_those_of_the_tables() {
    // For the median of 10 values the tables give x₂ to x₉ (97.9 %), of 100 x₄₀ to x₆₁ (96.5 %).
    for (count, lower, upper) in [(10, 2.0, 9.0), (100, 40.0, 61.0)] {
        let values = (1..=count).rev().map(f64::from).collect();
        let median = band(values).unwrap().unwrap().median;
        assert_eq!((median.lower, median.upper), (lower, upper));
        assert_eq!(median.value, 0.5 * f64::from(count + 1));
    }
    assert_eq!(band(vec![]), Ok(None));
    let one = band(vec![3.0]).unwrap().unwrap();
    assert_eq!((one.lower.value, one.upper.upper), (3.0, 3.0));
}

/// An input that is uniform within 4 % of a number.
pub fn near(name: &str, key: &str, number: f64) -> Input {
    Input {
        name: name.into(),
        key: key.into(),
        change: Change::Value,
        distribution: uniform(0.96 * number, 1.04 * number),
        source: "a test".into(),
    }
}

fn uniform(from: f64, to: f64) -> Distribution {
    Distribution::Uniform { from, to }
}

/// A study of the reference and the phantom 6.6, on two positions.
pub fn plan(inputs: Vec<Input>) -> StudyPlan {
    let [reference, .., inclusion, _] = BUILTIN_NAMES.map(|name| Phantom::builtin(name).unwrap());
    StudyPlan {
        reference,
        phantoms: vec![inclusion],
        probe_depth: 4e-3,
        laterals: vec![0.0, 1e-3],
        mesh_size: 0.5e-3,
        contact: Contact::default(),
        settings: Settings {
            noise_sd_n: 0.2,
            ..Settings::default()
        },
        inputs,
        correlations: vec![],
        rows: 2,
        seed: 1,
    }
}

/// The results of the first samples, computed here; the others count as failed.
pub fn results(plan: &StudyPlan, count: usize) -> StudyResults {
    let sampler = Sampler::new(plan).unwrap();
    let mut failures = Vec::new();
    let mut sampled = Vec::new();
    let none = Err(Refusal::state("not computed", ""));
    for sample in 0..sampler.design().samples() {
        let found = if sample < count {
            sampler.sample(sample)
        } else {
            none.clone()
        };
        sampled.push(found.unwrap_or_else(|reason| {
            let reason = reason.to_string();
            failures.push(Failure { sample, reason });
            vec![f64::NAN; sampler.quantities().len()]
        }));
    }
    let column = |quantity| sampled.iter().map(|of| of[quantity]).collect();
    let columns = |range: std::ops::Range<usize>| Ok::<_, Refusal>(range.map(column).collect());
    StudyResults::new(&sampler, palpate::fem::arithmetic(), &failures, columns).unwrap()
}

// Verifies: STU-001, STU-021, STU-030, STU-043.
#[test]
fn slopes_are_those_of_another_program() {
    // Narrower, since forces rise steeply to 0.5.
    let mut ratio = near("ν", "layer[1].poisson_ratio", 0.49);
    ratio.distribution = uniform(0.486, 0.495);
    let plan = plan(vec![
        ratio,
        near("width", "well.width_mm", 34.0),
        near("E", "layer[1].youngs_modulus_kpa", 5.0),
        near("radius", "probe.radius_mm", 6.5),
        near("height", "layer[1].thickness_mm", 15.0),
        near("skin", "layer[0].thickness_mm", 0.5),
        near("diameter", "inclusion[0].diameter_mm", 6.4),
        near("depth", "inclusion[0].depth_mm", 6.6),
    ]);
    // All but the rows.
    let results = results(&plan, 3 + 2 * 8);
    let of = |phantom, kind| results.of(phantom, &kind).unwrap();
    let force = of("none", Kind::NormalForceN { lateral_m: 0.0 });
    let signal = of("6.6", Kind::PeakNormalN);
    // In per cent per per cent, at small strain, as printed: with one decimal. 2 % are for the steps and the meshes of both.
    let of_force = "0 7.3\n1 -1.1\n2 0.9\n3 0.8\n4 -0.3\n5 0.2";
    let of_signal = "0 3.4\n6 2.0\n4 -1.8\n7 -1.3\n2 0.75";
    let of = |quantity, table| numbers(table).into_iter().map(move |row| (quantity, row));
    for (quantity, [input, expected]) in of(force, of_force).chain(of(signal, of_signal)) {
        let found = quantity.slopes[input as usize].unwrap().elasticity.unwrap();
        println!("{} {input}: {found:.3}, {expected}", quantity.quantity);
        let tolerance = 0.05 + 0.02 * f64::abs(expected);
        assert!((found - expected).abs() < tolerance, "{input}");
    }
    // An inclusion does nothing to the gel without one.
    assert_eq!(force.slopes[6].unwrap().per_unit, 0.0);
    let band = force.numerical_band.unwrap();
    let holds = band > 0.0 && band < 0.02 * force.at_medians.unwrap();
    assert!(holds, "{band}");
}

// The peak of a signal at one position is its mean, so that no subject could have felt the one less the other.
// Verifies: STU-031.
#[test]
fn a_study_over_one_position_explains_no_answers() {
    let mut plan = plan(vec![near("E", "layer[1].youngs_modulus_kpa", 4.0)]);
    plan.phantoms = ["4.6", "6.6"]
        .map(|name| Phantom::builtin(name).unwrap())
        .into();
    (plan.laterals, plan.mesh_size) = (vec![0.0], 2e-3);
    let sampler = Sampler::new(&plan).unwrap();
    let found = sampler.sample(0).unwrap();
    assert_eq!(found.len(), sampler.quantities().len());
}

// Verifies: STU-021, STU-030.
#[test]
fn the_medians_are_solved_on_three_meshes() {
    let mut plan = plan(vec![near("E", "layer[1].youngs_modulus_kpa", 4.0)]);
    plan.mesh_size = 1.5e-3;
    let softer = plan
        .reference
        .changed(|parts| parts.layers[1].material.youngs_modulus = 4000.0);
    let phantom = softer.unwrap();
    let sampler = Sampler::new(&plan).unwrap();
    for (sample, size) in [(0, 1.5e-3), (1, 2e-3), (2, 3e-3)] {
        let model = palpate::fem::Model::new(&phantom, size, plan.contact).unwrap();
        let map = model.sweep(&[plan.probe_depth], &plan.laterals).unwrap();
        let found = sampler.sample(sample).unwrap();
        // 4/3 and 3/2 of a mesh size round.
        assert!((found[0] - map.table().normal().row(0)[0]).abs() < 1e-9);
    }
}

// Verifies: STU-031.
#[test]
fn what_rests_on_the_noise_takes_that_of_the_sample() {
    let mut plan = plan(vec![near("noise", NOISE_SD, 1.0)]);
    (plan.mesh_size, plan.settings.noise_sd_n) = (2e-3, 0.2);
    plan.inputs[0].distribution = uniform(0.1, 0.5);
    let sampler = Sampler::new(&plan).unwrap();
    let place = |kind: Kind| {
        let mut quantities = sampler.quantities().iter();
        quantities.position(|of| of.kind == kind).unwrap()
    };
    let kinds = [
        Kind::PeakNormalN,
        Kind::TwoAfcByPeak,
        Kind::Gamma,
        Kind::TwoAfc,
        Kind::NeededNoiseSdN,
    ];
    let places = kinds.map(place);
    // The quartiles of the noise: the forces are the same.
    let of = |sample| {
        let values = sampler.sample(sample).unwrap();
        let [noise] = sampler.inputs(sample)[..] else {
            panic!("one input")
        };
        (noise, places.map(|place| values[place]))
    };
    let ((low, of_low), (high, of_high)) = (of(3), of(4));
    assert_near(low, 0.2, 1e-15);
    assert_near(high, 0.4, 1e-15);
    for (noise, [peak, by_peak, gamma, pairs, needed]) in [(low, of_low), (high, of_high)] {
        let right = |gamma: f64| palpate::stats::normal::cdf(gamma / 2.0_f64.sqrt()).unwrap();
        assert_near(by_peak, right(peak / noise), 1e-12);
        assert_near(pairs, right(gamma), 1e-12);
        assert_near(gamma * noise, of_low[2] * low, 1e-12);
        assert_near(needed, of_low[4], 1e-12);
    }
}

// Verifies: STU-031.
#[test]
fn the_inclusion_of_the_reference_has_no_part_in_the_detectable_depth() {
    let mut plan = plan(vec![near("noise", NOISE_SD, 1e-6)]);
    let [deep, shallow, middle] = ["6.6", "2.6", "4.6"].map(|name| Phantom::builtin(name).unwrap());
    (plan.reference, plan.phantoms) = (deep, vec![shallow, middle]);
    plan.mesh_size = 3e-3;
    let sampler = Sampler::new(&plan).unwrap();
    let mut kinds = sampler.quantities().iter().map(|of| &of.kind);
    let place = kinds.position(|kind| *kind == Kind::DetectableDepthM);
    // Both are found in so little noise.
    let depth = sampler.sample(0).unwrap()[place.unwrap()];
    assert_near(depth, 4.6e-3, 1e-15);
}

// Verifies: STU-031, STU-032, STU-043.
#[test]
fn failures_are_counted_and_conclusions_have_their_share() {
    // Above 0.4995 there is no phantom: a quarter of the draws.
    let mut ratio = near("ν", "layer[1].poisson_ratio", 0.49);
    ratio.distribution = uniform(0.49, 0.502_6);
    let mut plan = plan(vec![ratio]);
    (plan.rows, plan.mesh_size, plan.settings.noise_sd_n) = (4, 2e-3, 0.02);
    let results = results(&plan, 17);
    // Four rows have one point in each quarter, in both samples; the mixed one is the second with one input.
    assert_eq!((results.samples, results.failed), (3 + 2 + 4 * 3, 3));
    let reason = &results.failures[0].reason;
    let holds = reason.starts_with("phantom none: layer[1].poisson_ratio = 0.50");
    assert!(holds, "{reason}");
    let conclusion = &results.conclusions[0];
    assert_eq!(conclusion.quantity.kind, Kind::Gamma);
    // 2 × 1.645 for 5 % of both errors.
    assert!((conclusion.limit - 3.290).abs() < 5e-4);
    // γ is far above it in each of the six points that are left: 0.025^(1/6) of their probability.
    assert_eq!((conclusion.at_medians, conclusion.share), (Some(true), 1.0));
    assert!((conclusion.lower - 0.025f64.powf(1.0 / 6.0)).abs() < 1e-12);
    assert!((2..=3).contains(&results.rows_used));
    let gamma = results.of("6.6", &Kind::Gamma).unwrap();
    // The largest noise is that at which γ is what is needed.
    let (noise, at) = (
        results.of("6.6", &Kind::NeededNoiseSdN).unwrap(),
        gamma.at_medians.unwrap(),
    );
    assert!((noise.at_medians.unwrap() - at * 0.02 / conclusion.limit).abs() < 1e-12);
}

// Verifies: STU-001, STU-011.
#[test]
fn inputs_that_make_no_study_are_refused_with_their_key() {
    let refused = |change: &dyn Fn(&mut Input)| {
        let mut input = near("ν", "layer[1].poisson_ratio", 0.49);
        change(&mut input);
        let plan = plan(vec![near("skin", "layer[0].thickness_mm", 0.5), input]);
        plan.design().unwrap_err().to_string()
    };
    let begins = |found: String, expected: &str| assert!(found.starts_with(expected), "{found}");
    for (name, expected) in [
        ("skin", "input.name = \"skin\" twice"),
        (
            " ",
            "input[1].name = \" \", but must be a text that is not blank",
        ),
    ] {
        begins(refused(&|input| input.name = name.into()), expected);
    }
    for key in "layer[2].poisson_ratio layer[0].name layer[x probe.radius_mm.x".split(' ') {
        let expected = format!("input[1].key = {key:?}, but must be the key");
        begins(refused(&|input| input.key = key.into()), &expected);
    }
    let replaces = refused(&|input| input.key = "layer[0].thickness_mm".into());
    let expected =
        "input[1].key = \"layer[0].thickness_mm\", but must be a key of no earlier input";
    begins(replaces, expected);
    let nowhere = refused(&|input| input.source.clear());
    begins(
        nowhere,
        "input[1].source = \"\", but must be a text that is not blank",
    );
    let (mean, sd) = (1.0, -1.0);
    let normal = refused(&|input| input.distribution = Distribution::Normal { mean, sd });
    begins(
        normal,
        "input[1].distribution.normal.sd = -1.0, but must be",
    );
}

// Verifies: STU-001.
#[test]
fn a_value_replaces_is_added_or_multiplies() {
    let own = Phantom::builtin("6.6").unwrap();
    for (change, value, depth) in [
        (Change::Value, 4.5, 4.5e-3),
        (Change::Offset, 0.25, 6.85e-3),
        (Change::Factor, 0.5, 3.3e-3),
    ] {
        let mut input = near("depth", "inclusion[0].depth_mm", 6.6);
        input.change = change;
        let phantom = plan(vec![input]).changed(&own, &[value]).unwrap();
        // One rounding in mm.
        assert_near(phantom.inclusions()[0].depth, depth, 1e-17);
    }
    // Of two inputs with one key, the second changes what the first made of it.
    let mut inputs = ["a", "b"].map(|name| near(name, "layer[1].thickness_mm", 15.0));
    [inputs[0].change, inputs[1].change] = [Change::Offset, Change::Factor];
    let phantom = plan(inputs.into()).changed(&own, &[1.0, 2.0]).unwrap();
    assert_eq!(phantom.layers()[1].thickness, 0.032);
}
