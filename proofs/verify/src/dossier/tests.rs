use super::*;
use crate::evidence::{Soak, Verdict};
use crate::planted::{Planted, Power};
use crate::test_run::{End, Entry, Requirement, SCHEMA, TestRun, evidence_by_requirement};
use crate::{Figure, Outcome, claims, components};
use palpate::version::Build;

fn outcome(name: &str, value: f64) -> Outcome {
    Outcome {
        name: name.into(),
        claim: "The error is small.",
        requirements: &["FEM-050"],
        limits: "Rounding. Fixed in 0.1.0.",
        figures: vec![Figure::at_most("largest error, m", value, 1e-11)],
        failure: None,
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
        test_runs: Vec::new(),
        left_out,
        outcomes,
        soak: None,
        requirements: Vec::new(),
        components: components::locked(),
        bill_of_materials: None,
        planted: None,
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
    let changed = "0123456789abcdef0123456789abcdef01234567 with changes";
    for (commit, profile, named) in [
        (changed, "release", changed),
        ("unknown", "release", "(unknown)"),
        (sound.commit, "debug", "the profile debug"),
    ] {
        let (one, page) = of(Build {
            commit,
            profile,
            ..sound
        });
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
fn the_power_of_the_tests_stands_in_the_page_if_it_is_given() {
    let mut evidence = evidence(vec![outcome("fem.good", 0.0)], Vec::new());
    assert!(dossier(&evidence).contains("does not show how much the tests find"));
    evidence.planted = Some(Planted {
        commit: "0123abcd".into(),
        confidence: 0.95,
        power: vec![Power {
            of: "core".into(),
            defects: 32,
            found: 19,
            by_own: 11,
            lower: 0.4064,
            upper: 0.7630,
        }],
    });
    let page = dossier(&evidence);
    assert!(!page.contains("does not show how much the tests find"));
    assert!(page.contains("at a confidence of 95 %") && page.contains("<code>0123abcd</code>"));
    let (_, row) = page.split_once("<th scope=\"row\">core</th>").unwrap();
    let (row, _) = row.split_once("</tr>").unwrap();
    let numbers: Vec<&str> = row
        .split('>')
        .filter_map(|cell| cell.strip_suffix("</td"))
        .collect();
    assert_eq!(numbers, ["32", "11", "19", "59.4 %", "40.6 % to 76.3 %"]);
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

#[test]
fn every_check_that_the_chapters_name_exists() {
    let names: Vec<&str> = claims().map(|claim| claim.name).collect();
    let chapters = [CONTEXT, CREDIBILITY, SOFTWARE, RISK, PROOFS, LIMITS, PLAN];
    let quoted = chapters
        .iter()
        .flat_map(|chapter| chapter.split('`').skip(1).step_by(2));
    let mut named = 0;
    for name in quoted {
        let Some((part, what)) = name.split_once('.') else {
            continue;
        };
        let exists =
            PARTS.contains(&part) && part != "statistics" && !["*", "md", "csv"].contains(&what);
        if exists {
            named += 1;
            assert!(names.contains(&name), "{name} is no check");
        }
    }
    assert!(named > 0, "are the chapters read?");
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
        let keys = evidence.as_object_mut().unwrap();
        keys.remove("measured_here").unwrap();
    }
    assert_eq!(one, other);
}

/// The rows of a table.
fn without_head(table: &str) -> &str {
    table.split_once('\n').map_or("", |(_, rows)| rows)
}

#[test]
fn a_test_run_is_counted_and_written_beside_the_page() {
    let mut found = evidence(vec![outcome("fem.good", 0.0)], Vec::new());
    assert_eq!(found.counts(), None);
    assert!(dossier(&found).contains("No test run is attached"));
    let requirement = |id: &str, tests: &[&str]| Requirement {
        id: id.into(),
        chapter: "fem.md".into(),
        text: "It MUST, \"always\".".into(),
        code: vec!["a.rs".into(), "b.rs f".into()],
        tests: tests.iter().map(|name| name.to_string()).collect(),
        ..Requirement::default()
    };
    let entry = |name: &str, result| Entry {
        name: name.into(),
        result,
        seconds: Some(1.5),
    };
    found.test_runs = vec![TestRun {
        schema: SCHEMA.into(),
        commit: "c".into(),
        results_sha256: "h".into(),
        requirements: vec![
            requirement("FEM-001", &["one t"]),
            requirement("FEM-002", &["other, t"]),
            requirement("FEM-050", &[]),
        ],
        entries: vec![entry("one t", End::Passed), entry("other, t", End::Failed)],
        ..TestRun::default()
    }];
    found.requirements = evidence_by_requirement(&found.test_runs, &found.outcomes);
    let counts = found.counts().unwrap();
    assert_eq!((counts.requirements, counts.checks), (3, 1));
    assert_eq!((counts.tests, counts.proofs, counts.none), (1, 0, 1));
    let page = dossier(&found);
    assert!(!page.contains("No test run is attached"));
    let row = [3, 1, 1, 0, 1].map(|count| format!("<td class=\"number\">{count}</td>"));
    let row = format!("<tr><th scope=\"row\">fem.md</th>{}</tr>", row.concat());
    assert!(page.contains(&row));
    let runs = test_runs(&found);
    assert_eq!(
        without_head(&runs),
        "c,h,one t,passed,1.5\nc,h,\"other, t\",failed,1.5\n"
    );
    let rows = requirements(&found);
    let text = "fem.md,\"It MUST, \"\"always\"\".\",a.rs; b.rs f";
    assert_eq!(
        without_head(&rows),
        format!(
            "FEM-001,{text},one t,,,,one t,,,\nFEM-002,{text},\"other, t\",,,,,,,\"other, t\"\nFEM-050,{text},,,,fem.good,,,,\n"
        )
    );
}

#[test]
fn the_components_are_those_of_the_bill_of_materials_or_of_the_lock_file() {
    let mut found = evidence(vec![outcome("fem.good", 0.0)], Vec::new());
    let page = dossier(&found);
    assert!(page.contains("No bill of materials is attached"));
    found
        .components
        .retain(|component| component.name == "libm");
    found.components[0].licence = Some("MIT".into());
    found.bill_of_materials = Some("0123abcd".into());
    let page = dossier(&found);
    assert!(page.contains("as the bill of materials lists them") && page.contains("0123abcd"));
    assert!(
        page.contains("<tr><th scope=\"row\">libm</th><td>0.2.")
            && page.contains("<td>MIT</td></tr>")
    );
    assert!(!page.contains("No bill of materials"));
}
