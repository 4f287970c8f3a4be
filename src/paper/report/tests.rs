//! A small run whose numbers follow in closed form, and hostile ones.

// Expected values keep the digits that their source printed.
#![allow(clippy::excessive_precision)]

mod hand;
mod inputs;
mod nuisances;
mod outputs;
mod page;
mod paths;
mod pictures;
mod run;
mod theories;

use super::*;
use palpate::phantom::{PhantomParts, Support};
use palpate_asserts::{assert_has, assert_near};
use run::*;

/// Expected values are from mpmath with 30 digits; the detector's own accuracy is tested elsewhere.
fn assert_close(found: f64, expected: f64) {
    assert_near(found, expected, 1e-13 * expected.abs());
}

// Verifies: REP-001.
#[test]
fn settings_default_to_the_paper() {
    let (noise_sd_n, default) = (0.235, Settings::default());
    assert_eq!(
        default,
        Settings {
            noise_sd_n,
            ..SETTINGS
        }
    );
}

// Verifies: REP-012.
#[test]
fn numbers_of_a_triangular_signal() {
    let found = findings(&paper_run()).unwrap();
    let map = &found.maps[2];
    assert_eq!(map.name, "6.6");
    // ΣΔ² is 1.5 · 0.3² normal and 2 · 0.1² lateral, in noise of 0.1 N.
    for (found, expected) in [
        (map.peak_normal.force_n, 0.3),
        (map.peak_normal.lateral_m, 0.0),
        (map.peak_lateral.force_n, 0.1),
        (map.peak_lateral.lateral_m, 5e-3),
        (map.gamma.normal, libm::sqrt(13.5)),
        (map.gamma.lateral, libm::sqrt(2.0)),
        (map.gamma.both, libm::sqrt(15.5)),
        (map.detection.auc, 0.997314372939209941),
        (map.detection.two_afc, 0.997314372939209941),
    ] {
        assert_close(found, expected);
    }
    let even = 0.0245051549198494117;
    let (eta, rare) = (1.27420479489360891, 0.0109484855667236183);
    assert_thresholds(
        map,
        [[0.0, even, even], [eta, rare, 0.05], [-eta, 0.05, rare]],
    );
    // Either threshold keeps its own bound: with γ² = 15.5, η = γ²/2 − γΦ⁻¹(0.9) and −γ²/2 + γΦ⁻¹(0.98).
    let mut run = paper_run();
    (run.settings.max_miss, run.settings.max_false_alarm) = (0.1, 0.02);
    let misses = [2.7045264409748262, 0.00396010585635342014, 0.1];
    let alarms = [0.335617546779076951, 0.02, 0.0298329075387685601];
    assert_thresholds(
        &findings(&run).unwrap().maps[2],
        [[0.0, even, even], misses, alarms],
    );
}

/// η, false alarms and misses of each rule.
fn assert_thresholds(map: &MapFindings, expected: [[f64; 3]; 3]) {
    let found = &map.detection;
    let found = [
        found.map_rule,
        found.bounded_miss,
        found.bounded_false_alarm.unwrap(),
    ];
    for (Threshold { eta, rates }, expected) in found.into_iter().zip(expected) {
        let found = [eta, rates.false_alarm, rates.miss];
        found
            .into_iter()
            .zip(expected)
            .for_each(|(found, expected)| assert_close(found, expected));
    }
}

// Verifies: REP-012.
#[test]
fn of_equal_peaks_the_one_nearest_to_the_middle_counts() {
    let ties = |x: f64| {
        if x.abs() > 7e-3 {
            -0.2
        } else {
            0.2 * x.abs() / 5e-3
        }
    };
    let pit = |x: f64| if x == 0.0 { -0.3 } else { 0.2 };
    let mut run = paper_run();
    // The first is −0.2 N at both ends, 0.2 N at ±5 mm.
    run.maps = vec![
        map_with("ties", ties, |_| 0.0),
        map_with("pit", pit, |_| 0.0),
    ];
    let found = findings(&run).unwrap();
    let [ties, pit] = [0, 1].map(|map| found.maps[map].peak_normal);
    assert!(ties.lateral_m == 5e-3 && ties.force_n > 0.0);
    assert_close(pit.force_n, -0.3);
}

/// The row of a quantity, if there is one.
fn row<'a>(found: &'a Findings, quantity: &str) -> Option<&'a Comparison> {
    let mut rows = found
        .comparison
        .iter()
        .filter(|row| row.quantity.contains(quantity));
    let row = rows.next();
    assert_eq!(rows.next(), None, "two rows {quantity:?}");
    row
}

/// The paper's number and ours for a part of a row's name, what ours may be off by, relative, and words of the reason, parted by `;`. Ours
/// are from mpmath: the noise with the largest likelihood of the four counts solves one equation. The search for it stops where the
/// likelihood is flat to 1e-9, so that the noise and the shares keep 4 digits fewer than a double at the least.
// √(0.15² − 0.1²) and, with 0.5 N/3.28971 = 0.151989 N, √(0.151989² − 0.093²) N. The interval is 0.3 N over √2 Φ⁻¹ of 0.7415 and of 0.9452,
// the ends with the subjects as the sample (scipy); of all answers pooled it would be 0.179 to 0.255 N.
const ROWS: &str = "
Force level | 1.6 | 1.48 | 1e-13 |
Signal F₁ | 0.5 | 0.45 | 1e-13 |
Peak signal | 0.34 | 0.3 | 1e-13 |
at most 5 % | 3.3 | 3.28970725390294543 | 1e-13 |
allowed in all | 0.15 | 0.151989207977942236 | 1e-13 |
allowed to the display | 0.11 | 0.114458373838536514 | 1e-13 | it is 0.1118 N;it is 0.120 N
playback of FEM data, from | 0.17 | 0.168075132009467718 | 1e-13 |
direct contact, from | 0.22 | 0.220565183109211505 | 1e-13 |
84 % | 1.45 | 1.40637582564407233 | 1e-13 | the 253 of 300 of Table 1 it is 1.426
of the subjects | 0.235 | 0.210395775374330952688 | 1e-13 | interval is 0.133 to 0.327 N;0.300 N over 1.426;95 %
FEM playback, 2.6 | 0.97333333333333333 | 0.970819401558362083 | 1e-5 | 0.224 N
FEM playback, 4.6 | 0.92333333333333333 | 0.922157029428948384 | 1e-5 | 0.224 N
FEM playback, 6.6 | 0.84333333333333333 | 0.828049999963410114 | 1e-5 | 0.224 N;observed share is 74.;to 94.5 %
FEM playback, 8.6 | 0.63 | 0.681980354179924793 | 1e-5 | 0.224 N";

// Verifies: REP-020, REP-070.
#[test]
fn every_number_of_the_paper_has_its_row() {
    let found = findings(&paper_run()).unwrap();
    let rows = ROWS.trim().lines();
    for line in rows.clone() {
        let [quantity, numbers @ .., why] = &line.split('|').map(str::trim).collect::<Vec<_>>()[..]
        else {
            panic!("{line}")
        };
        let row = row(&found, quantity).unwrap();
        let [paper, here] = [row.paper, row.here].map(|value| match value {
            Value::ForceN(number) | Value::Gamma(number) | Value::Probability(number) => number,
        });
        let numbers: Vec<f64> = numbers
            .iter()
            .map(|number| number.parse().unwrap())
            .collect();
        assert_eq!(paper, numbers[0], "{quantity}");
        assert_near(here, numbers[1], numbers[2] * numbers[1]);
        assert!(row.why.len() > 10, "{quantity}");
        assert_has(&row.why, &why.replace(';', "|"));
    }
    assert_eq!(found.comparison.len(), rows.count());
    assert_eq!(found.people.conditions.len(), 3);
}

/// The expected ends are from mpmath.
// Verifies: REP-030.
#[test]
fn the_normal_approximation_has_its_ends() {
    let bounds = normal_approximation(253.0 / 300.0, 300);
    assert_close(bounds.lower, 0.802201752767006725);
    assert_close(bounds.upper, 0.884464913899659942);
    assert_eq!(normal_approximation(0.99, 30).upper, 1.0);
}

// Verifies: REP-020, REP-070.
#[test]
fn rows_without_their_phantom_are_left_out() {
    let mut run = paper_run();
    run.maps.remove(2);
    let found = findings(&run).unwrap();
    let bridge = found.bridge.as_ref().unwrap();
    assert_eq!(bridge.inclusions.len(), 3);
    assert_eq!(row(&found, "6.6"), None);
    run.maps.truncate(1);
    assert_eq!(findings(&run).unwrap().bridge, None);
    assert!(row(&found, "Force level").is_some());
    run.maps.clear();
    let found = findings(&run).unwrap();
    assert_eq!(row(&found, "Signal F₁"), None);
    // Another reference: no number of the paper is about it.
    let none = Phantom::builtin("none").unwrap();
    let softer = none.changed(|parts| parts.layers[1].material.youngs_modulus = 4e3);
    let mut run = paper_run();
    run.reference = map(softer.ok(), &DEPTHS, |_| 0.0, |_| 0.0);
    let found = findings(&run).unwrap();
    assert_eq!(row(&found, "Force level"), None);
    assert_eq!(found.bridge, None);
    assert_eq!(found.people.conditions.len(), 3);
}

// Verifies: REP-010.
#[test]
fn a_phantom_is_the_papers_by_its_data_and_not_by_its_name() {
    let phantom = Phantom::builtin("6.6").unwrap();
    let name_of = |change: fn(&mut PhantomParts)| {
        let changed = phantom.changed(change).unwrap();
        paper::name_of(&changed)
    };
    let renamed = |parts: &mut PhantomParts| {
        parts.name = "mine".into();
        parts.layers[1].name = "agar".into();
    };
    assert_eq!(name_of(renamed), Some("6.6"));
    assert_eq!(name_of(|parts| parts.well.walls = Support::Sliding), None);
    assert_eq!(name_of(|parts| parts.probe.radius = 6e-3), None);
}

// Verifies: REP-003.
#[test]
fn of_several_inclusions_the_highest_is_named() {
    let phantom = Phantom::builtin("6.6").unwrap();
    let mut higher = phantom.inclusions()[0].clone();
    (higher.centre_x, higher.depth) = (-9e-3, 2e-3);
    let phantom = phantom.changed(|parts| parts.inclusions.push(higher));
    let mut run = paper_run();
    run.maps = vec![map(phantom.ok(), &DEPTHS, |_| 0.1, |_| 0.0)];
    let found = findings(&run).unwrap();
    assert_eq!(found.maps[0].inclusion_depth_m, Some(2e-3));
    let figures = figures(&run, &found).unwrap();
    let title = |figure: &&Figure| figure.title == "Figure 5. Forces, phantom “6.6”: 2 inclusions";
    assert_eq!(figures.iter().filter(title).count(), 1);
}

// Verifies: REP-002.
#[test]
fn without_4_mm_the_deepest_depth_counts_and_is_named() {
    let mut run = paper_run();
    let depths = [0.0, 1e-3, 3e-3];
    run.reference = map(Phantom::builtin("none").ok(), &depths, |_| 0.0, |_| 0.0);
    run.maps = vec![map(Phantom::builtin("6.6").ok(), &depths, |_| 0.4, |_| 0.0)];
    let found = findings(&run).unwrap();
    assert_eq!(found.probe_depth_m, 3e-3);
    // The synthetic forces are proportional to the depth, and 0.4 N at 4 mm.
    assert_close(found.maps[0].peak_normal.force_n, 0.3);
    let note = found.probe_depth_note.clone().unwrap();
    assert!(note.contains("3 mm"), "{note}");
    assert_eq!(found.bridge, None);
    assert_eq!(row(&found, "Force level"), None);
    let made = made(&run);
    assert!(made.page.contains(&shown(&note)));
    assert!(made.figure("signals").title.contains("3 mm"));
    // At 4 mm there is no note though the maps go deeper.
    let depths = [0.0, 4e-3 + 1e-10, 5e-3];
    run.reference = map(Phantom::builtin("none").ok(), &depths, |_| 0.0, |_| 0.0);
    run.maps.clear();
    let found = findings(&run).unwrap();
    assert_eq!(
        (found.probe_depth_m, found.probe_depth_note),
        (depths[1], None)
    );
}

// Verifies: REP-012, REP-015.
#[test]
fn no_signal_and_a_squeezed_gel_are_warned_of() {
    let mut run = paper_run();
    run.maps = vec![
        run.reference.clone(),
        computed_map("6.6", 0.2),
        computed_map("6.6", 0.19),
    ];
    let [same, limit, squeezed] = &findings(&run).unwrap().maps[..] else {
        panic!("three maps")
    };
    assert_eq!(same.gamma.both, 0.0);
    assert_eq!(same.detection.bounded_false_alarm, None);
    assert_eq!(same.detection.auc, 0.5);
    assert_has(&same.warnings.concat(), "nothing can be detected");
    assert_eq!((limit.warnings.len(), squeezed.warnings.len()), (0, 1));
    assert_has(&squeezed.warnings[0], "0.190 at depth 4 mm, x = −5 mm");
}

// Verifies: REP-004.
#[test]
fn what_does_not_fit_is_refused() {
    let refused = |maps: Vec<ForceMap>, words: &str, damage: fn(&mut Settings)| {
        let mut run = Run {
            maps,
            ..paper_run()
        };
        damage(&mut run.settings);
        assert_has(&findings(&run).unwrap_err().to_string(), words);
    };
    let other = map(Phantom::builtin("4.6").ok(), &[0.0, 4e-3], |_| 0.0, |_| 0.0);
    refused(vec![other], "\"4.6\"|depths_m", |_| ());
    type Damage = fn(&mut Settings);
    let damaged: [(&str, Damage); 6] = [
        ("noise_sd", |settings| settings.noise_sd_n = 0.0),
        ("noise_sd", |settings| settings.noise_sd_n = f64::NAN),
        ("max_miss", |settings| settings.max_miss = 1.0),
        ("max_miss", |settings| settings.max_miss = 0.96),
        ("max_false_alarm", |settings| {
            settings.max_false_alarm = f64::NAN
        }),
        ("prior_h1", |settings| settings.prior_h1 = -0.1),
    ];
    for (word, damage) in damaged {
        refused(paper_run().maps, word, damage);
        refused(Vec::new(), word, damage);
    }
}
