//! A comparison of theories whose numbers follow in closed form.

use super::run::*;
use crate::report::{Run, Theory};
use crate::tests::measured;
use palpate::force::Force;
use palpate::force_map::{ForceMap, ForceTable, Matrix};
use palpate::phantom::{Phantom, Strain};
use palpate_asserts::{assert_has, assert_near};

/// A triangle of height 1 over ±10 mm.
fn triangle(x: f64) -> f64 {
    1.0 - x.abs() / 10e-3
}

fn phantom(name: &str, strain: Strain, friction: f64) -> Phantom {
    let phantom = Phantom::builtin(name).unwrap().changed(|parts| {
        parts.strain = strain;
        parts.probe.friction = friction;
    });
    phantom.unwrap()
}

/// The phantoms of [`paper_run`] where the level is higher by 0.74 N and `bump` triangles, N, and signals are twice as strong in
/// the normal force, and `lateral` times as strong in the lateral one.
fn theory(strain: Strain, friction: f64, bump: f64, lateral: f64) -> Theory {
    let of = |name: &str, peak: f64| -> ForceMap {
        map(
            Some(phantom(name, strain, friction)),
            &DEPTHS,
            |x| 0.74 + (bump + 2.0 * peak) * triangle(x),
            at_5_mm(lateral * peak / 3.0),
        )
    };
    let peaks = [("2.6", 0.6), ("4.6", 0.45), ("6.6", 0.3), ("8.6", 0.15)];
    let mut deformed = deformed();
    deformed.phantom = phantom("2.6", strain, friction);
    Theory {
        reference: of("none", 0.0),
        maps: peaks.map(|(name, peak)| of(name, peak)).into(),
        deformed,
        poisson_leverage: Some(14.5),
    }
}

/// The paper's run with its own theory and others.
fn compared(others: impl IntoIterator<Item = Theory>) -> Run {
    let mut run = paper_run();
    let own = Theory {
        reference: run.reference.clone(),
        maps: run.maps.clone(),
        deformed: run.deformed.clone(),
        poisson_leverage: Some(7.5),
    };
    run.theories = std::iter::once(own).chain(others).collect();
    run
}

/// Less mean and slope, a triangle of height 1 has the square Σ = 0.7, and ±1 at ±5 mm has 1.6. A template of a triangle of height p
/// and ±p/3 is along a bump b of the reference by 0.7 b/√(0.7 + 1.6/9) = 0.74715 b, whatever p; in noise of 0.1 N the threshold of
/// 5 % false alarms is off by 7.4715 b/N, at half the depth by half of that. Φ is from mpmath.
// Verifies: REP-090, REP-091.
#[test]
fn templates_keep_what_is_along_them_and_raise_false_alarms_by_what_is_along_the_level() {
    let (finite, along) = (Strain::Finite, 2.0);
    let run = compared([
        theory(finite, 0.0, 0.02, along),
        theory(finite, 0.3, 0.05, along),
        theory(finite, 0.0, -0.05, 0.0),
    ]);
    let found = made(&run).found.theories;
    let names = [
        "small strain",
        "finite strain",
        "finite strain, friction 0.3",
    ];
    for (theory, name) in found.iter().zip(names) {
        assert_eq!(theory.name, name);
    }
    assert!(found[0].templates.is_empty());
    let aside = libm::sqrt(0.7 / (0.7 + 1.6 / 9.0));
    let expected = [
        [(1.0, 0.058191391, true), (1.0, 0.067401867, true)],
        [(1.0, 0.072411037, true), (1.0, 0.101814458, false)],
        [(aside, 0.033502518, false), (aside, 0.021773412, false)],
    ];
    for (theory, expected) in found[1..].iter().zip(expected) {
        let names = theory.templates.iter().map(|of| &of.name[..]);
        assert!(names.eq(["2.6", "4.6", "6.6", "8.6"]));
        for template in &theory.templates {
            assert_eq!(template.at.len(), 2, "no template at depth 0");
            let each = template.at.iter().zip([2e-3, 4e-3]).zip(expected);
            for ((at, depth), (kept, false_alarm, serves)) in each {
                assert_eq!(at.depth_m, depth);
                assert_near(at.kept, kept, 1e-12);
                assert_near(at.false_alarm, false_alarm, 1e-8);
                assert_eq!(at.serves, serves, "{} at {depth}", theory.name);
            }
        }
    }
    assert_near(
        found[1].reference.normal_force_at_centre_n.unwrap(),
        2.24,
        1e-12,
    );
    assert_near(found[1].maps[2].peak_normal.force_n, 0.6, 1e-12);
    assert_eq!(
        [found[0].poisson_leverage, found[1].poisson_leverage],
        [Some(7.5), Some(14.5)]
    );
}

// Verifies: REP-090.
#[test]
fn explanations_are_those_of_the_bridge_whatever_the_strain() {
    let run = compared([theory(Strain::Finite, 0.3, 0.0, 2.0)]);
    let found = made(&run).found;
    let fits = &found.bridge.unwrap().conditions[crate::report::paper::FEM_PLAYBACK].conventions;
    let [own, other] = [0, 1].map(|at| &found.theories[at].explanations);
    assert_eq!(own.len(), 12);
    for (of, fit) in own.iter().zip(fits) {
        assert_eq!(
            (&of.name, of.p_value, of.is_rejected),
            (&fit.name, fit.p_value, fit.is_rejected)
        );
    }
    // Signals twice as strong are explained by twice the noise.
    for (of, twice) in own.iter().zip(other) {
        assert_near(of.p_value, twice.p_value, 1e-6);
    }
    // Half a sweep is the whole one only without friction.
    let half = |map: &ForceMap| {
        let table = map.table();
        let rows = |matrix: &Matrix| {
            Matrix::from_fn(table.depths().len(), 3, |row, column| {
                matrix.row(row)[column + 2]
            })
        };
        let both = table.both().unwrap();
        let forces = Force::new(rows(both.lateral), rows(both.normal));
        let table = ForceTable::new(table.depths().into(), table.laterals()[2..].into(), forces);
        measured(map.phantom().cloned(), table.unwrap())
    };
    let mut run = run;
    let halves = |theory: &Theory| Theory {
        reference: half(&theory.reference),
        maps: theory.maps.iter().map(half).collect(),
        ..theory.clone()
    };
    let theories: Vec<Theory> = run.theories.iter().map(halves).collect();
    let found = crate::report::theories::findings(&theories, &run.settings).unwrap();
    assert_eq!(found[0].explanations.len(), 12);
    assert_eq!(found[1].explanations, []);
    // Phantoms that are not the paper's have no answers.
    for map in run.theories.iter_mut().flat_map(|theory| &mut theory.maps) {
        *map = map_with("another", |_| 0.1, |_| 0.0);
    }
    let found = made(&run).found.theories;
    assert!(found.iter().all(|theory| theory.explanations.is_empty()));
}

// Verifies: REP-090, REP-092.
#[test]
fn the_page_compares_theories_or_says_how() {
    let without = made(&paper_run());
    assert_has(&without.page, "<code>palpate run --compare-theories</code>");
    assert!(!without.summary.contains("\"theories\""));
    assert!(!without.page.contains("table-theories"));
    let finite = Strain::Finite;
    let run = compared([
        theory(finite, 0.0, 0.02, 2.0),
        theory(finite, 0.3, 0.05, 2.0),
    ]);
    let made = made(&run);
    assert_has(&made.summary, "\"theories\"");
    for words in [
        "<th scope=\"row\">finite strain, friction 0.3</th><td class=\"number\">2.270</td><td class=\"number\">14.5</td>",
        "On a gel of finite strain, the maps of small strain serve: 2.6 at every depth, 4.6 at every depth, ",
        "On a gel of finite strain, friction 0.3, the maps of small strain serve: 2.6 to 2\u{a0}mm, 4.6 to 2\u{a0}mm, ",
        "7.2 % <span class=\"tag\">serves</span></td><td class=\"number\">&#62; 99.9 %, 10.2 %</td>",
        "<tr><th scope=\"row\" class=\"quantity\">peak, normal force</th>",
    ] {
        assert_has(&made.page, words);
    }
    let theories = made.figure("theories");
    assert_has(
        &theories.alt,
        "finite strain: 2.240 N; finite strain, friction 0.3: 2.270 N",
    );
    let deformed = made.figure("deformed-finite");
    assert_has(
        &deformed.title,
        "Deformed mesh at finite strain, phantom “2.6”",
    );
    assert_has(&deformed.caption, "a gel with less than 0.05 is refused");
    assert_has(
        &made.figure("figure-6").caption,
        "below 0.2 small strain is at its limit",
    );
}
