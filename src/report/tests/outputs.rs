//! Figures, page and summary.

use std::collections::HashSet;

use super::study::*;
use super::xml;
use crate::force_map::{Discretization, Matrix};
use crate::phantom::Phantom;
use crate::report::*;

fn all_of(study: &Study) -> (Findings, Vec<Figure>, String, String) {
    let found = findings(study).unwrap();
    let drawn = figures(study, &found).unwrap();
    let page = html(study, &found, &drawn);
    let summary = summary_json(&found, study);
    (found, drawn, page, summary)
}

// Verifies: REP-044.
#[test]
fn page_and_summary_tell_the_bands() {
    let mut study = paper_study();
    let map = computed_map("8.6", 0.3);
    study.maps.push(map.clone());
    let (_, _, page, summary) = all_of(&study);
    assert!(page.contains("not estimated") && summary.contains("\"largest_normal_band_n\": null"));
    let bands = |largest: f64| {
        Matrix::from_fn(3, 5, |row, column| {
            if (row, column) == (1, 2) {
                largest
            } else {
                0.0
            }
        })
    };
    let discretization = Discretization {
        nodes: [1234, 700, 300],
        normal_force_band: bands(6.5e-3),
        lateral_force_band: bands(4.5e-4),
    };
    study.maps.pop();
    study
        .maps
        .push(map.with_discretization(discretization).unwrap());
    let (_, _, page, summary) = all_of(&study);
    assert!(page.contains(">6.5</td>") && page.contains(">0.45</td>"));
    assert!(!page.contains("not estimated"));
    assert!(summary.contains("\"largest_normal_band_n\": 0.0065"));
    assert!(summary.contains("\"largest_lateral_band_n\": 0.00045"));
}

// Verifies: REP-030.
#[test]
fn every_figure_is_there() {
    let (_, drawn, _, _) = all_of(&paper_study());
    let names: Vec<_> = drawn
        .iter()
        .map(|figure| figure.file_name.as_str())
        .collect();
    let expected = [
        "figure-1.svg",
        "figure-6.svg",
        "signals.svg",
        "figure-5-none.svg",
        "figure-5-2.6.svg",
        "figure-5-4.6.svg",
        "figure-5-6.6.svg",
        "figure-5-8.6.svg",
        "figure-2.svg",
        "figure-3.svg",
        "figure-4.svg",
        "figure-9.svg",
        "figure-8.svg",
        "figure-10.svg",
        "figure-11.svg",
        "figure-12.svg",
        "figure-13.svg",
        "bridge.svg",
    ];
    assert_eq!(names, expected);
}

// Verifies: REP-032, REP-033, REP-042.
#[test]
fn figures_are_well_formed_whatever_the_names() {
    for study in [paper_study(), hostile_study()] {
        for figure in all_of(&study).1 {
            let (elements, text) = match xml::read(&figure.svg) {
                Ok(read) => read,
                Err(problem) => panic!("{}: {problem}", figure.file_name),
            };
            let known = [
                "svg", "title", "desc", "rect", "line", "polyline", "polygon", "circle", "text",
                "path", "g",
            ];
            assert!(
                elements.iter().all(|name| known.contains(&name.as_str())),
                "{elements:?}"
            );
            assert_eq!(elements[..3], ["svg", "title", "desc"]);
            assert!(text.split_whitespace().count() > 20, "{text}");
            let head = &figure.svg[..figure.svg.find('>').unwrap()];
            assert!(
                head.contains("viewBox=\"0 0 ") && head.contains("role=\"img\""),
                "{head}"
            );
            assert!(head.contains("aria-labelledby="), "{head}");
            for words in [&figure.title, &figure.alt, &figure.caption] {
                assert!(words.len() > 10, "{}", figure.file_name);
            }
        }
    }
}

/// A polyline's corners would show a NaN, or a place far outside the figure.
// Verifies: REP-003.
#[test]
fn nothing_is_drawn_outside() {
    for study in [paper_study(), hostile_study()] {
        for figure in all_of(&study).1 {
            let after = figure.svg.split_once("viewBox=\"0 0 ").unwrap().1;
            let size = after.split_once('"').unwrap().0;
            let (width, height) = size.split_once(' ').unwrap();
            let limit = [width, height].map(|side| side.parse::<i32>().unwrap());
            for points in figure.svg.split("points=\"").skip(1) {
                for point in points.split_once('"').unwrap().0.split_whitespace() {
                    let (x, y) = point.split_once(',').unwrap();
                    let place = [x, y].map(|number| number.parse::<i32>().unwrap());
                    let inside =
                        (0..=limit[0]).contains(&place[0]) && (0..=limit[1]).contains(&place[1]);
                    assert!(inside, "{}: {point} not in {size}", figure.file_name);
                }
            }
        }
    }
}

// Verifies: REP-031.
#[test]
fn file_names_are_safe_and_unique() {
    let (_, drawn, _, _) = all_of(&hostile_study());
    let mut seen = HashSet::new();
    for Figure { file_name, .. } in &drawn {
        let safe = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
        assert!(file_name.chars().all(safe), "{file_name}");
        assert!(
            file_name.ends_with(".svg") && !file_name.starts_with('.'),
            "{file_name}"
        );
        assert!(file_name.len() < 80, "{file_name}");
        assert!(
            seen.insert(file_name.to_ascii_lowercase()),
            "{file_name} twice"
        );
    }
    // Signals, one figure for each map, Figures 1, 6; 2, 3, 4, 9; 8 and 10 to 13.
    assert_eq!(drawn.len(), 1 + 1 + HOSTILE.len() + 2 + 2 + 4 + 5);
}

// Verifies: REP-003.
#[test]
fn studies_of_any_size_have_a_report() {
    let none = Study {
        maps: Vec::new(),
        ..paper_study()
    };
    let (found, drawn, page, _) = all_of(&none);
    assert!(found.maps.is_empty() && drawn.len() == 12);
    assert!(page.contains("no signal"));
    // One depth, the surface itself: there is no force at all.
    let depths = [0.0];
    let untouched = map(Phantom::builtin("none").ok(), &depths, |_| 0.0, |_| 0.0);
    let study = Study {
        maps: vec![untouched.clone()],
        reference: untouched,
        ..paper_study()
    };
    assert_eq!(all_of(&study).1.len(), 14);
}

// Verifies: REP-005.
#[test]
fn the_same_study_gives_the_same_bytes() {
    let (found, drawn, page, summary) = all_of(&hostile_study());
    let (found_again, drawn_again, page_again, summary_again) = all_of(&hostile_study());
    assert_eq!(found, found_again);
    assert_eq!(drawn, drawn_again);
    assert_eq!(page, page_again);
    assert_eq!(summary, summary_again);
}

// Verifies: REP-040, REP-042.
#[test]
fn the_page_needs_nothing_else() {
    for study in [paper_study(), hostile_study()] {
        let page = all_of(&study).2.to_ascii_lowercase();
        for forbidden in [
            "http", "//", "<script", "<link", "<img", "<iframe", "src=", "url(", "@import", "\u{0}",
        ] {
            assert!(!page.contains(forbidden), "{forbidden}");
        }
        // The only links are those of the contents.
        for link in page.split("href=").skip(1) {
            assert!(link.starts_with("\"#"), "{}", &link[..40]);
        }
        // An event handler must stand in quoted text, never in a tag of its own.
        for tag in page.split('<').skip(1) {
            let tag = tag.split_once('>').unwrap().0;
            assert!(!tag.contains(" onload="), "{tag}");
        }
    }
}

// Verifies: REP-041.
#[test]
fn the_page_holds_everything() {
    let mut study = paper_study();
    study.maps.push(computed_map("8.6", 0.1));
    let (found, drawn, page, _) = all_of(&study);
    for figure in &drawn {
        let id = figure.file_name.trim_end_matches(".svg");
        assert_eq!(
            page.matches(&format!("id=\"{id}-title\"")).count(),
            1,
            "{id}"
        );
        assert!(page.contains(&shown(&figure.caption)), "{id}");
    }
    for row in &found.comparison {
        for words in [&row.quantity, &row.why, &row.paper_text, &row.here.text()] {
            assert!(page.contains(&shown(words)), "{words}");
        }
    }
    for words in [
        "1234",
        "1.5e−13",
        "2.5e−12",
        "3.5e−14",
        "0.100",
        "Small strain is at its limit",
        "cargo run --release -- run",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.contains(&format!("palpate {}", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn numbers_stay_with_their_units() {
    let prose = text::prose("At 4 mm, x = 3 mm (5 % of 2 N/γ); 3 Newtons & 2 a");
    let expected = "At 4_mm, x_=_3_mm (5_% of 2 N/γ); 3 Newtons & 2 a";
    assert_eq!(prose, expected.replace('_', "\u{a0}"));
}

// Verifies: REP-050, REP-051.
#[test]
fn the_summary_is_json_with_units() {
    for study in [paper_study(), hostile_study()] {
        let text = all_of(&study).3;
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["schema"], "palpate-summary");
        assert_eq!(value["schema_version"], 2);
        assert_eq!(value["program_version"], env!("CARGO_PKG_VERSION"));
        assert_eq!(value["settings"]["noise_sd_n"], 0.1);
        assert_eq!(value["laterals_m"].as_array().unwrap().len(), 5);
        check_keys(&value);
    }
    let value: serde_json::Value = serde_json::from_str(&all_of(&paper_study()).3).unwrap();
    let level = &value["findings"]["comparison"][0];
    assert_eq!(level["paper"]["force_n"], 1.6);
    assert_eq!(
        value["findings"]["maps"][2]["peak_lateral"]["lateral_m"],
        5e-3
    );
}

/// Keys whose number has a unit, by the words in them.
fn check_keys(value: &serde_json::Value) {
    if let Some(items) = value.as_array() {
        items.iter().for_each(check_keys);
    }
    for (key, inner) in value.as_object().into_iter().flatten() {
        let unit = if ["depth", "penetration", "mesh_size"]
            .iter()
            .any(|word| key.contains(word))
        {
            Some("_m")
        } else if ["force", "noise", "signal"]
            .iter()
            .any(|word| key.contains(word))
        {
            Some("_n")
        } else {
            None
        };
        if let (true, Some(unit)) = (inner.is_number(), unit) {
            assert!(key.ends_with(unit), "{key}");
        }
        check_keys(inner);
    }
}
