//! Figures, page and summary.

use std::collections::HashSet;

use roxmltree::Document;

use super::run::*;
use crate::report::*;
use palpate::force_map::Discretization;
use palpate::phantom::Phantom;
use palpate_asserts::assert_has;

// Verifies: REP-041.
#[test]
fn page_and_summary_tell_the_bands() {
    let mut run = paper_run();
    let map = computed_map("8.6", 0.3);
    run.maps.push(map.clone());
    let Made { page, summary, .. } = made(&run);
    assert!(page.contains("not estimated") && summary.contains("\"largest_normal_band_n\": null"));
    let discretization = Discretization {
        nodes: [1234, 700, 300],
        normal_force_band: matrix_with((1, 2), 6.5e-3, 0.0),
        lateral_force_band: matrix_with((1, 2), 4.5e-4, 0.0),
    };
    *run.maps.last_mut().unwrap() = map.with_discretization(discretization).unwrap();
    let Made { page, summary, .. } = made(&run);
    assert!(page.contains(">6.5</td>") && page.contains(">0.45</td>"));
    assert!(!page.contains("not estimated"));
    assert!(summary.contains("\"largest_normal_band_n\": 0.0065"));
    assert!(summary.contains("\"largest_lateral_band_n\": 0.00045"));
}

// Verifies: REP-030.
#[test]
fn every_figure_is_there() {
    let made = made(&paper_run());
    let names = made.figures.iter().map(|figure| &*figure.file_name);
    let names: Vec<_> = names.map(|name| name.trim_end_matches(".svg")).collect();
    let expected = "figure-1 figure-6 signals figure-5-none figure-5-2.6 figure-5-4.6 figure-5-6.6 figure-5-8.6 \
        figure-2 figure-3 figure-4 figure-9 gamma paths figure-8 figure-10 figure-11 figure-12 figure-13 bridge";
    assert_eq!(names.join(" "), expected);
}

/// A polyline's corners would show a NaN, or a place far outside the figure.
// Verifies: REP-003, REP-031, REP-042.
#[test]
fn figures_are_well_formed_and_inside_whatever_the_names() {
    for run in [paper_run(), hostile_run()] {
        let mut seen = HashSet::new();
        for figure in made(&run).figures {
            let name = &figure.file_name;
            let is_safe = |c: char| c.is_ascii_alphanumeric() || ".-_".contains(c);
            let is_svg = name.ends_with(".svg") && !name.starts_with('.');
            assert!(
                is_svg && name.chars().all(is_safe) && name.len() < 80,
                "{name}"
            );
            assert!(seen.insert(name.to_ascii_lowercase()), "{name} twice");
            let svg = Document::parse(&figure.svg).unwrap_or_else(|e| panic!("{name}: {e}"));
            let elements: Vec<_> = svg.descendants().filter(|node| node.is_element()).collect();
            let names: Vec<_> = elements.iter().map(|of| of.tag_name().name()).collect();
            let known = "svg title desc rect line polyline polygon circle text path g";
            let is_known = |name: &&str| known.split(' ').any(|known| known == *name);
            assert!(names.iter().all(is_known), "{names:?}");
            assert_eq!(names[..3], ["svg", "title", "desc"]);
            let words = elements.iter().filter_map(|of| of.text());
            assert!(words.flat_map(str::split_whitespace).count() > 20, "{name}");
            let head = elements[0];
            assert!(head.attribute("role") == Some("img") && head.has_attribute("aria-labelledby"));
            let limit = pair(&head.attribute("viewBox").unwrap()[4..], ' ');
            let points = elements.iter().filter_map(|of| of.attribute("points"));
            for point in points.flat_map(str::split_whitespace) {
                let place = pair(point, ',');
                let is_inside = (0..2).all(|k| (0..=limit[k]).contains(&place[k]));
                assert!(is_inside, "{name}: {point} not in {limit:?}");
            }
            for words in [&figure.title, &figure.alt, &figure.caption] {
                assert!(words.len() > 10, "{name}");
            }
        }
    }
}

/// Two whole numbers.
fn pair(text: &str, between: char) -> [i32; 2] {
    let (x, y) = text.split_once(between).unwrap();
    [x, y].map(|number| number.parse().unwrap())
}

// Verifies: REP-031.
#[test]
fn file_names_are_unique_even_where_case_is_ignored() {
    let mut names = FileNames::default();
    let mut unique = |name| names.unique("map", name, "json");
    assert_eq!(unique("../6.6 mm"), "map-.._6.6_mm.json");
    assert_eq!(unique("../6.6_MM"), "map-.._6.6_MM-2.json");
    assert_eq!(unique(""), "map.json");
}

// Verifies: REP-003.
#[test]
fn studies_of_any_size_have_a_report() {
    let mut run = paper_run();
    run.maps.clear();
    let empty = made(&run);
    assert!(empty.found.maps.is_empty() && empty.figures.len() == 12);
    assert!(empty.page.contains("no signal"));
    // One depth, the surface itself: there is no force at all.
    run.reference = map(Phantom::builtin("none").ok(), &[0.0], |_| 0.0, |_| 0.0);
    run.maps = vec![run.reference.clone()];
    assert_eq!(made(&run).figures.len(), 14);
    // Signals, one figure for each map, Figures 1, 6; 2, 3, 4, 9; γ, paths; 8 and 10 to 13.
    let figures = made(&hostile_run()).figures;
    assert_eq!(figures.len(), 1 + 1 + HOSTILE.len() + 2 + 2 + 4 + 2 + 5);
}

// Verifies: REP-005.
#[test]
fn the_same_run_gives_the_same_bytes() {
    assert!(made(&hostile_run()) == made(&hostile_run()));
}

// Verifies: REP-040, REP-042.
#[test]
fn the_page_needs_nothing_else() {
    let forbidden = "http // <script <link <img <iframe src= url( @import \u{0}";
    for run in [paper_run(), hostile_run()] {
        let page = made(&run).page.to_ascii_lowercase();
        for forbidden in forbidden.split(' ') {
            assert!(!page.contains(forbidden), "{forbidden}");
        }
        // The only links are those of the contents.
        let mut links = page.split("href=").skip(1);
        assert!(links.all(|link| link.starts_with("\"#")));
        // An event handler must stand in quoted text, never in a tag of its own.
        let mut tags = page.split('<').skip(1);
        assert!(tags.all(|tag| !between(tag, "", ">").contains(" onload=")));
    }
}

// Verifies: REP-042.
#[test]
fn a_name_is_text_wherever_it_stands() {
    // Where any of these pairs of letters stands in the page or a figure, something between them was not escaped.
    let name = "q<w&q\"w'q";
    let mut run = super::inputs::with_slopes();
    let named = |signal: f64| map_with(name, move |_| signal, |_| 0.0);
    // Without a signal there is a warning.
    run.maps.extend([named(0.1), named(0.0)]);
    run.measured = vec![named(0.1)];
    let phantom = &run.deformed.phantom;
    run.deformed.phantom = phantom.changed(|parts| parts.name = name.into()).unwrap();
    let study = run.study.as_mut().unwrap();
    study.plan.inputs[0].name = name.into();
    study.plan.inputs[0].source = name.into();
    study.groups[0][0] = name.into();
    let made = made(&run);
    let texts = made
        .figures
        .iter()
        .map(|figure| &figure.svg)
        .chain([&made.page]);
    for text in texts {
        for pair in ["q<w", "w&q", "q\"w", "w'q"] {
            assert!(
                !text.contains(pair),
                "{pair} in {}",
                &text[text.find(pair).unwrap_or(0)..][..200]
            );
        }
    }
    let warned = "<strong>Phantom q&#60;w&#38;q&#34;w&#39;q.</strong> No signal";
    assert_has(&made.page.replace('\u{a0}', " "), warned);
}

// Verifies: REP-041.
#[test]
fn the_page_holds_everything() {
    let mut run = paper_run();
    run.maps.push(computed_map("8.6", 0.1));
    let made = made(&run);
    let page = &made.page;
    for figure in &made.figures {
        let id = figure.file_name.trim_end_matches(".svg");
        let titles = page.matches(&format!("id=\"{id}-title\"")).count();
        assert_eq!(titles, 1, "{id}");
        assert!(page.contains(&shown(&figure.caption)), "{id}");
    }
    for row in &made.found.comparison {
        for words in [&row.quantity, &row.why, &row.paper_text, &row.here.text()] {
            assert!(page.contains(&shown(words)), "{words}");
        }
    }
    let numbers = "1234|1.5e−13|2.5e−12|3.5e−14|0.100";
    let words = "Small strain is at its limit|cargo run --release -- run";
    assert_has(page, &format!("{numbers}|{words}|palpate {VERSION}"));
}

#[test]
fn numbers_stay_with_their_units() {
    let prose = text::prose("At 4 mm, x = 3 mm (5 % of 2 N/γ); 3 Newtons & 2 a");
    let expected = "At 4_mm, x_=_3_mm (5_% of 2 N/γ); 3 Newtons & 2 a";
    assert_eq!(prose, expected.replace('_', "\u{a0}"));
}

// Verifies: REP-050.
#[test]
fn the_summary_is_json_with_units() {
    for run in [hostile_run(), paper_run()] {
        let value: serde_json::Value = serde_json::from_str(&made(&run).summary).unwrap();
        assert_eq!(value["schema"], "palpate-summary");
        assert_eq!(value["schema_version"], 2);
        assert_eq!(value["program_version"], VERSION);
        assert_eq!(value["settings"]["noise_sd_n"], 0.1);
        assert_eq!(value["laterals_m"].as_array().unwrap().len(), 5);
        check_keys(&value);
        let findings = &value["findings"];
        assert_eq!(findings["comparison"][0]["paper"]["force_n"], 1.6);
        let peak = &findings["maps"][2]["peak_lateral"]["lateral_m"];
        assert_eq!(*peak, made(&run).found.maps[2].peak_lateral.lateral_m);
    }
}

/// Keys whose number has a unit, by the words in them.
fn check_keys(value: &serde_json::Value) {
    let items = value.as_array().into_iter().flatten();
    items.for_each(check_keys);
    for (key, inner) in value.as_object().into_iter().flatten() {
        let holds = |words: &[&str]| words.iter().any(|word| key.contains(word));
        let unit = match () {
            () if holds(&["depth", "penetration", "mesh_size"]) => "_m",
            () if holds(&["force", "noise", "signal"]) => "_n",
            () => "",
        };
        assert!(!inner.is_number() || key.ends_with(unit), "{key}");
        check_keys(inner);
    }
}
