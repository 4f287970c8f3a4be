//! A study beside a run: what the page and the figures show of it, and which studies are refused.

use std::sync::OnceLock;

use super::run::*;
use crate::report::inputs::{Survival, survival};
use crate::report::{Run, findings};
use crate::study::tests::{near, plan, results};
use crate::study::{Kind, QuantityResult, StudyPlan, StudyResults};
use palpate::phantom::{BUILTIN_NAMES, Phantom};
use palpate_asserts::assert_has;

/// The paper's run with a study of it, on a coarse mesh.
fn with_study() -> Run {
    static STUDY: OnceLock<StudyResults> = OnceLock::new();
    let study = STUDY.get_or_init(|| {
        let mut plan = plan(vec![
            near("gel: <modulus>", "layer[1].youngs_modulus_kpa", 5.0),
            near("gel: height", "layer[1].thickness_mm", 15.0),
        ]);
        let phantoms = BUILTIN_NAMES[1..].iter().map(|name| Phantom::builtin(name));
        plan.phantoms = phantoms.collect::<Result<_, _>>().unwrap();
        plan.laterals = LATERALS.into();
        (plan.mesh_size, plan.settings) = (3e-3, SETTINGS);
        results(&plan, usize::MAX)
    });
    Run {
        study: Some(study.clone()),
        ..paper_run()
    }
}

/// A run of one inclusion with the medians and slopes of a study of it.
pub fn with_slopes() -> Run {
    let mut run = paper_run();
    run.maps = vec![run.maps.swap_remove(2)];
    let mut plan = plan(vec![
        near("gel: modulus", "layer[1].youngs_modulus_kpa", 5.0),
        near("gel: height", "layer[1].thickness_mm", 15.0),
    ]);
    plan.laterals = LATERALS.into();
    (plan.mesh_size, plan.settings) = (3e-3, SETTINGS);
    run.study = Some(results(&plan, 3 + 2 * 2));
    run
}

// Verifies: REP-081, REP-083.
#[test]
fn a_study_stands_beside_the_numbers_of_the_run() {
    let run = with_study();
    let study = run.study.as_ref().unwrap();
    let made = made(&run);
    let section = between(&made.page, "<section id=\"inputs\"", "</section>");
    // Noise of 0.1 N: γ is twice what is needed and more.
    for name in &BUILTIN_NAMES[1..] {
        let line = format!("<li>The inclusion of phantom {name} is found");
        let line = between(section, &line, "</li>");
        assert_has(line, "in 100.0 % of the draws");
        assert!(line.ends_with("survives the uncertainty of the inputs."));
    }
    let force = study.of("none", &Kind::NormalForceN { lateral_m: 0.0 });
    let lower = force.unwrap().band.unwrap().lower.value;
    let force = format!("the normal force at x = 0 is between {lower:.2} and ");
    // 4 % in the modulus and the height of the gel are not 8 % in the force. Names are text.
    let outside = "outside, so that the inputs alone do not explain the difference";
    let rejected = "These explanations of the answers to FEM playback are rejected whatever the inputs \
                    (share of the draws): peak, normal force (100.0 %)";
    let has = [&*force, outside, rejected, "gel: &#60;modulus&#62;"].join("|");
    assert_has(section, &has);
    assert!(!section.contains("<modulus>"), "{section}");
    let table = between(section, "table-bands", "</table>");
    assert_eq!(table.matches("<tr>").count(), 1 + study.listed().count());
    for (name, with_bands, count) in [
        ("figure-5", 5, 5),
        ("figure-10", 0, 1),
        ("figure-11", 1, 1),
        ("gamma", 1, 1),
    ] {
        let named = made
            .figures
            .iter()
            .filter(|of| of.file_name.starts_with(name));
        let captions: Vec<_> = named.map(|of| &of.caption).collect();
        let has_bands = |caption: &&&String| caption.contains("the draws of the uncertain inputs");
        let found = (captions.iter().filter(has_bands).count(), captions.len());
        assert_eq!(found, (with_bands, count), "{name}");
    }
    // Of the two inputs the modulus counts more in the force: 0.9 against 0.3 per cent per per cent.
    let drawn = "none: normal force at 0.0 mm, N: gel: <modulus> 3.6 %, gel: height −1.";
    assert_has(&made.figure("inputs").alt, drawn);
}

/// The run of [`with_study`] with another reference, and without the map of this name.
fn with_reference(reference: Phantom) -> Run {
    let mut run = with_study();
    let name = reference.name();
    let is_other = |phantom: &Phantom| phantom.name() != name;
    run.maps.retain(|map| map.phantom().is_none_or(is_other));
    let study = run.study.as_mut().unwrap();
    study.plan.phantoms.retain(is_other);
    study.quantities.retain(|of| of.quantity.phantom != name);
    let of_reference = |of: &&mut QuantityResult| of.quantity.phantom == "none";
    for of in study.quantities.iter_mut().filter(of_reference) {
        of.quantity.phantom = name.into();
    }
    study.plan.reference = reference.clone();
    run.reference = map(Some(reference), &DEPTHS, |_| 0.0, |_| 0.0);
    run
}

// Verifies: REP-083, REP-010.
#[test]
fn the_force_level_is_that_of_a_gel_without_inclusion_by_any_name() {
    let none = Phantom::builtin("none").unwrap();
    let renamed = none.changed(|parts| parts.name = "my gel".into());
    let deeper = Phantom::builtin("4.6");
    for (reference, is_there) in [(renamed, true), (deeper, false)] {
        let run = with_reference(reference.unwrap());
        let page = made(&run).page;
        let sentence = "Without an inclusion the normal force at x = 0 is between";
        assert_eq!(page.contains(sentence), is_there);
    }
}

// Verifies: REP-081.
#[test]
fn the_longest_bar_is_on_top_to_whichever_side_it_goes() {
    let mut run = with_slopes();
    let study = run.study.as_mut().unwrap();
    let gel = Kind::NormalForceN { lateral_m: 0.0 };
    let mut quantities = study.quantities.iter_mut();
    let of = quantities
        .find(|of| of.quantity.phantom == "none" && of.quantity.kind == gel)
        .unwrap();
    // Of a force of 1 N; the second goes down by more than the first goes up.
    of.at_medians = Some(1.0);
    for (slope, change) in of.slopes.iter_mut().zip([0.05, -0.2]) {
        slope.as_mut().unwrap().between_quartiles = change;
    }
    let drawn = "none: normal force at 0.0 mm, N: gel: height −20.0 %, gel: modulus 5.0 %";
    assert_has(&made(&run).figure("inputs").alt, drawn);
}

// Verifies: REP-081.
#[test]
fn without_a_study_the_page_says_so() {
    let made = made(&paper_run());
    assert_has(&made.page, "No study of the inputs belongs to this run");
    for figure in &made.figures {
        assert!(figure.file_name != "inputs.svg" && !figure.caption.contains("draws"));
    }
}

// Verifies: REP-004.
#[test]
fn a_study_of_something_else_is_refused() {
    type Change = fn(&mut StudyPlan);
    let changes: [(&str, Change); 7] = [
        ("reference", |plan| {
            let wider = plan.reference.changed(|parts| parts.well.width = 0.04);
            plan.reference = wider.unwrap();
        }),
        ("phantom \"4.6\"", |plan| {
            let deeper = plan.phantoms[1].changed(|parts| parts.inclusions[0].depth = 5e-3);
            plan.phantoms[1] = deeper.unwrap();
        }),
        ("depth of the probe", |plan| plan.probe_depth = 3e-3),
        ("list of lateral positions", |plan| {
            plan.laterals.truncate(4)
        }),
        ("noise, rate or prior", |plan| {
            plan.settings.noise_sd_n = 0.2
        }),
        ("noise, rate or prior", |plan| plan.settings.max_miss = 0.01),
        ("noise, rate or prior", |plan| plan.settings.prior_h1 = 0.4),
    ];
    for (what, change) in changes {
        let mut run = with_study();
        change(&mut run.study.as_mut().unwrap().plan);
        let found = findings(&run).unwrap_err().to_string();
        let expected = format!("the study of the inputs has another {what} than the run; choose");
        assert!(found.starts_with(&expected), "{found}");
    }
}

// Verifies: REP-083.
#[test]
fn a_conclusion_survives_from_95_per_cent_on() {
    let run = with_study();
    let mut of = run.study.unwrap().conclusions.remove(0);
    for (share, expected) in [
        (1.0, Survival::Holds),
        (0.95, Survival::Holds),
        (0.94, Survival::Depends),
        (0.06, Survival::Depends),
        (0.05, Survival::Fails),
    ] {
        of.share = share;
        assert_eq!(survival(&of), expected, "{share}");
    }
}
