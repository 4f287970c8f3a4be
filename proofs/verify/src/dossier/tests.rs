use std::collections::BTreeSet;

use super::*;
use crate::evidence::{Soak, Verdict};
use crate::{Figure, Outcome, claims, supply, traceability};
use palpate::version::Build;

fn outcome(name: &str, value: f64) -> Outcome {
    Outcome {
        name: name.into(),
        claim: "The error is small.",
        requirements: &["FEM-050"],
        limits: "Rounding. Fixed in 0.1.0.",
        figures: vec![Figure::at_most("largest error, m", value, 1e-11)],
        failure: None,
        repeatable: true,
        seconds: 0.5,
    }
}

fn evidence(outcomes: Vec<Outcome>, left_out: Vec<&'static str>) -> Evidence {
    Evidence {
        build: Build::THIS,
        system: System {
            began: "2026-11-23T18:00:00Z".into(),
            operator: None,
            operating_system: "Debian".into(),
            c_library: "glibc 2.41".into(),
            processor: "a <processor>".into(),
        },
        executables: vec![("/bin/palpate".into(), "0123abcd".into())],
        records: Vec::new(),
        left_out,
        outcomes,
        soak: None,
        requirements: traceability::requirements().unwrap(),
        components: supply::components().unwrap(),
    }
}

#[test]
fn a_check_that_fails_stands_at_the_top_in_red() {
    let evidence = evidence(
        vec![outcome("fem.good", 1e-12), outcome("fem.bad", 1e-10)],
        Vec::new(),
    );
    assert_eq!(evidence.verdict(), Verdict::Failed);
    let page = dossier(&evidence);
    let (head, body) = page.split_once("<main>").unwrap();
    assert!(head.contains("<p class=\"verdict failed\" id=\"verdict\">1 of 2 checks failed.</p>"));
    assert!(head.contains("<code>fem.bad</code>") && !head.contains("fem.good"));
    let figure =
        "<li class=\"failed\"><strong>largest error, m: 1.0e−10 (at most 1.0e−11)</strong></li>";
    assert!(head.contains(figure) && body.contains(figure), "{head}");
    assert!(body.contains("<span class=\"failed\">FAILED</span>"));
    assert!(body.contains("<span class=\"passed\">passed</span>"));
}

#[test]
fn a_dossier_of_some_parts_is_no_verdict() {
    let evidence = evidence(vec![outcome("fem.good", 0.0)], vec!["program", "kernel"]);
    assert_eq!(evidence.verdict(), Verdict::Partial);
    let page = dossier(&evidence);
    assert!(page.contains(
        "1 check passed; not run: program, kernel. This is therefore no verdict on the build."
    ));
}

#[test]
fn what_is_unusual_about_a_build_is_an_anomaly() {
    let sound = Build {
        commit: "0123456789abcdef0123456789abcdef01234567",
        profile: "release",
        debug_assertions: false,
        ..Build::THIS
    };
    let of = |build: Build| {
        let evidence = Evidence {
            build,
            ..evidence(vec![outcome("fem.good", 0.0)], Vec::new())
        };
        (evidence.anomalies().len(), dossier(&evidence))
    };
    let (none, page) = of(sound);
    assert_eq!(none, 0);
    assert!(
        page.contains("Nothing is unusual about this build")
            && !page.contains("Anomaly of this build")
    );
    for (build, named) in [
        (
            Build {
                commit: "0123456789abcdef0123456789abcdef01234567 with changes",
                ..sound
            },
            "0123456789abcdef0123456789abcdef01234567 with changes",
        ),
        (
            Build {
                commit: "unknown",
                ..sound
            },
            "(unknown)",
        ),
        (
            Build {
                profile: "debug",
                ..sound
            },
            "the profile debug",
        ),
    ] {
        let (one, page) = of(build);
        assert_eq!(one, 1, "{named}");
        let (_, anomaly) = page.split_once("Anomaly of this build: ").unwrap();
        let (anomaly, _) = anomaly.split_once("</p>").unwrap();
        assert!(anomaly.contains(named), "{anomaly}");
    }
}

#[test]
fn a_soak_that_fails_is_a_failure_and_tells_how_to_repeat_it() {
    let mut evidence = evidence(vec![outcome("fem.good", 0.0)], Vec::new());
    assert_eq!(evidence.verdict(), Verdict::Passed);
    evidence.soak = Some(Soak {
        batteries: 3,
        seed: 7,
        false_failure: 2e-6,
        failure: Some("check x rejects <it>".into()),
    });
    assert_eq!(evidence.verdict(), Verdict::Failed);
    let page = dossier(&evidence);
    assert!(page.contains("The soak failed."));
    assert!(page.contains("check x rejects &#60;it&#62;"));
    assert!(page.contains("3 batteries with seeds from 7 on"));
    assert!(page.contains("with probability 2.0e−6 at most"));
}

#[test]
fn the_page_holds_every_section_and_needs_nothing_else() {
    let page = dossier(&evidence(vec![outcome("rates.2.6_mm", 0.0)], Vec::new()));
    for (id, _) in SECTIONS {
        assert_eq!(
            page.matches(&format!("<section id=\"{id}\"")).count(),
            1,
            "{id}"
        );
        assert!(page.contains(&format!("<a href=\"#{id}\">")));
    }
    for words in [
        "This is no certification",
        "Question of interest",
        "2. Model calibration evidence",
        "Verification, calculation: discretisation error",
        "5.3 architectural design",
        "force comes back by itself",
        "axis::a_blend_is_between_its_ends",
        "2026-11-23T18:00:00Z",
        "palpate: 0123abcd",
        "not named (--operator)",
        "Signature",
        "Limits: Rounding. Fixed in 0.1.0.",
        "coarse_<wbr>mean_<wbr>h0",
        "FEM-050",
        "libm",
        "a &#60;processor&#62;",
    ] {
        assert!(page.contains(words), "{words}");
    }
    for foreign in ["<script", "http://", "https://", "url(", "@import", " src="] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

/// The words of a text that look like ids of requirements.
fn ids(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '-')
        .filter(|word| {
            word.len() == 7
                && *word != "SHA-256"
                && word.as_bytes()[3] == b'-'
                && word[..3].chars().all(|c| c.is_ascii_uppercase())
                && word[4..].chars().all(|c| c.is_ascii_digit())
        })
}

/// Controls of hazards that only one test shows, and why.
const ALONE: [(&str, &str); 1] = [("FIR-001", "only the microcontroller can show it")];

#[test]
fn a_control_of_a_hazard_has_two_tests_proofs_or_checks() {
    let controls: BTreeSet<&str> = ids(RISK).collect();
    assert!(controls.len() > 40, "{controls:?}");
    let battery = crate::battery::GROUPS.iter().map(|(.., ids)| *ids);
    let served: Vec<&str> = claims()
        .map(|claim| claim.requirements)
        .chain(battery)
        .flatten()
        .copied()
        .collect();
    for row in traceability::requirements().unwrap() {
        let pieces = row.tests.len() + row.proofs.len() + usize::from(served.contains(&&*row.id));
        let alone = ALONE.iter().any(|(id, _)| *id == row.id);
        if controls.contains(&*row.id) {
            assert_eq!(pieces < 2, alone, "{}: {:?}", row.id, row.tests);
        }
    }
}

#[test]
fn every_requirement_and_check_that_the_chapters_name_exists() {
    let known: Vec<String> = traceability::requirements()
        .unwrap()
        .into_iter()
        .map(|row| row.id)
        .collect();
    let names: Vec<&str> = claims().map(|claim| claim.name).collect();
    let chapters = [CONTEXT, CREDIBILITY, SOFTWARE, RISK, PROOFS, LIMITS, PLAN];
    let cited: Vec<&str> = chapters.iter().flat_map(|chapter| ids(chapter)).collect();
    assert!(cited.len() > 40, "{cited:?}");
    for id in cited {
        assert!(
            known.iter().any(|known| known == id),
            "{id} is no requirement"
        );
    }
    for claim in claims() {
        for id in claim.requirements {
            assert!(
                known.iter().any(|known| known == id),
                "{}: {id} is no requirement",
                claim.name
            );
        }
    }
    let quoted = chapters
        .iter()
        .flat_map(|chapter| chapter.split('`').skip(1).step_by(2));
    let parts = crate::evidence::PARTS;
    for name in quoted {
        let Some((part, what)) = name.split_once('.') else {
            continue;
        };
        if parts.contains(&part)
            && part != "statistics"
            && what != "*"
            && !["md", "csv"].contains(&what)
        {
            assert!(names.contains(&name), "{name} is no check");
        }
    }
}

#[test]
fn the_file_for_programs_keeps_times_apart() {
    let one = evidence(vec![outcome("fem.good", 1e-12)], Vec::new());
    let mut other = one.clone();
    other.outcomes[0].seconds = 3.0;
    other.system.processor = "another".into();
    let parsed = |evidence: &Evidence| -> serde_json::Value {
        serde_json::from_str(&evidence.to_json()).unwrap()
    };
    let (mut one, mut other) = (parsed(&one), parsed(&other));
    assert_ne!(one, other);
    assert_eq!(one["checks"][0]["figures"][0]["at_most"], 1e-11);
    assert_eq!(
        one["checks"][0]["figures"][0]["at_least"],
        serde_json::Value::Null
    );
    assert_eq!(one["verdict"], "passed");
    for evidence in [&mut one, &mut other] {
        evidence
            .as_object_mut()
            .unwrap()
            .remove("measured_here")
            .unwrap();
    }
    assert_eq!(one, other);
}

#[test]
fn a_record_is_counted_and_written_beside_the_page() {
    use crate::record::{End, Entry, Record, SCHEMA};
    let mut found = evidence(vec![outcome("fem.good", 0.0)], Vec::new());
    let without = found.counts();
    assert_eq!((without.checks, without.tests, without.proofs), (1, 0, 0));
    assert_eq!(without.none, without.requirements - 1);
    assert!(dossier(&found).contains("No record of a test run is attached"));
    let row = found
        .requirements
        .iter()
        .find(|row| !row.tests.is_empty() && row.id != "FEM-050");
    let row = row.unwrap().clone();
    let entry = |name: &str, result| Entry {
        name: name.into(),
        result,
        seconds: Some(1.5),
    };
    found.records = vec![Record {
        schema: SCHEMA.into(),
        commit: "c".into(),
        began: "b".into(),
        ended: "e".into(),
        system: "s".into(),
        log_sha256: "l".into(),
        entries: vec![
            entry(&row.tests[0], End::Passed),
            entry("other, with a comma", End::Failed),
        ],
    }];
    assert!(found.counts().tests >= 1 && found.counts().none < without.none);
    assert!(!dossier(&found).contains("No record of a test run is attached"));
    let lines = record(&found);
    assert!(
        lines.contains(&format!("c,l,{},passed,1.5\n", row.tests[0])),
        "{lines}"
    );
    assert!(lines.contains("c,l,\"other, with a comma\",failed,1.5\n"));
    let trace = trace(&found);
    let line = trace
        .lines()
        .find(|line| line.starts_with(&row.id))
        .unwrap();
    let passed = line.matches(row.tests[0].as_str()).count();
    assert_eq!(
        passed, 2,
        "among its tests, and among those that passed: {line}"
    );
}
