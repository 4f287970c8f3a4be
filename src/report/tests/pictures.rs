//! What the figures show, read back from their coordinates.

use super::study::*;
use super::{figures, findings};
use crate::phantom::Phantom;
use crate::psychophysics::Bounds;
use crate::report::{Figure, Findings, Study, normal_approximation};

fn drawn(study: &Study) -> (Findings, Vec<Figure>) {
    let found = findings(study).unwrap();
    let drawn = figures(study, &found).unwrap();
    (found, drawn)
}

fn svg<'a>(figures: &'a [Figure], name: &str) -> &'a str {
    let figure = figures.iter().find(|figure| figure.file_name == name);
    &figure.unwrap_or_else(|| panic!("no {name}")).svg
}

/// The corners of every element of one name, with the element's text.
fn shapes<'a>(svg: &'a str, name: &str) -> Vec<(&'a str, Vec<[f64; 2]>)> {
    let tag = format!("<{name} ");
    let elements = svg.split(tag.as_str()).skip(1);
    elements
        .map(|rest| {
            let element = rest.split_once('>').unwrap().0;
            let points = element
                .split_once("points=\"")
                .unwrap()
                .1
                .split_once('"')
                .unwrap()
                .0;
            let corner = |point: &str| {
                let (x, y) = point.split_once(',').unwrap();
                [x, y].map(|number| number.parse().unwrap())
            };
            (element, points.split_whitespace().map(corner).collect())
        })
        .collect()
}

/// Width, height and centre of the box around `corners`.
fn extent(corners: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    let range = |k: usize| {
        let values = corners.iter().map(|corner| corner[k]);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| {
            [a.min(v), b.max(v)]
        })
    };
    let (x, y) = (range(0), range(1));
    (
        [x[1] - x[0], y[1] - y[0]],
        [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])],
    )
}

/// A drawing unit is 1/91 mm of the paper's phantom, and every place is rounded to a whole one.
// Verifies: REP-035.
#[test]
fn figure_1_is_to_scale() {
    let mut study = paper_study();
    study.maps.push(map_with("shallow", |_| 0.1, |_| 0.0));
    let mut wide = Phantom::builtin("8.6").unwrap();
    wide.gel.width = 0.04;
    study.maps.push(map(Some(wide), &DEPTHS, |_| 0.1, |_| 0.0));
    let (_, figures) = drawn(&study);
    let picture = svg(&figures, "figure-1.svg");
    let filled = |fill: &str| {
        let shapes = shapes(picture, "polygon");
        let (_, corners) = shapes
            .iter()
            .find(|(element, _)| element.contains(fill))
            .unwrap();
        extent(corners)
    };
    let (gel, _) = filled("#FAF3E0");
    let scale = gel[0] / 34.0;
    let (probe, _) = filled("#D0D4DA");
    let (skin, place) = filled("#56B4E9");
    let (disc, centre) = filled("#E69F00");
    for (found, millimetres) in [
        (gel[1], 15.5),
        (probe[0], 13.0),
        (probe[1], 6.5),
        (skin[1], 0.5),
        (disc[0], 6.4),
        (disc[1], 6.4),
        // The disc's centre below the skin's middle.
        (centre[1] - place[1], 2.6 + 3.2 - 0.25),
    ] {
        assert!(
            (found - scale * millimetres).abs() <= 2.0,
            "{found} for {millimetres} mm"
        );
    }
    // One outline in dashes for each depth in this gel; "shallow" lies where 2.6 mm does.
    for words in [
        "34 mm",
        "15 mm",
        "skin 0.5 mm",
        "ø 6.4 mm",
        "2.6 mm",
        "4.6 mm",
        "6.6 mm",
        "8.6 mm",
    ] {
        assert_eq!(
            picture.matches(&format!("\n{words}\n")).count(),
            1,
            "{words}"
        );
    }
}

// Verifies: REP-037.
#[test]
fn figures_10_to_12_show_every_subject() {
    let (_, figures) = drawn(&paper_study());
    for number in 10..13 {
        let picture = svg(&figures, &format!("figure-{number}.svg"));
        for subject in 1..=10 {
            assert_eq!(
                picture.matches(&format!("\nsubject {subject}\n")).count(),
                1
            );
        }
        // Ten subjects and the mean at four depths, and two samples in the key.
        assert_eq!(picture.matches("<circle ").count(), 11 * 4 + 2);
    }
}

/// Upright bars with their width (drawing units), for a panel whose `range` of per cent is `height` units high.
fn bars(picture: &str) -> Vec<(f64, [f64; 2], [f64; 2])> {
    let upright = |(element, corners): (&str, Vec<[f64; 2]>)| {
        let width = element
            .split_once("stroke-width=\"")
            .unwrap()
            .1
            .split_once('"')
            .unwrap()
            .0;
        match corners[..] {
            [from, to] if from[0] == to[0] && from[1] != to[1] => {
                Some((width.parse().unwrap(), from, to))
            }
            _ => None,
        }
    };
    shapes(picture, "polyline")
        .into_iter()
        .filter_map(upright)
        .collect()
}

// Verifies: REP-038.
#[test]
fn figure_13_has_three_intervals_for_each_share() {
    let (found, figures) = drawn(&paper_study());
    let bars = bars(svg(&figures, "figure-13.svg"));
    // The axis from 40 to 100 % is 330 pixels of ten units high; its foot is the lowest place of all.
    let foot = bars
        .iter()
        .map(|bar| bar.1[1].max(bar.2[1]))
        .fold(0.0, f64::max)
        - 50.0;
    let share = |y: f64| 40.0 + 60.0 * (foot - y) / 3300.0;
    let shows = |width: f64, Bounds { lower, upper }: Bounds| {
        bars.iter().any(|(found, from, to)| {
            let off = |y: f64, end: f64| (share(y) - 100.0 * end).abs();
            // Places are rounded to a unit, 0.02 %.
            *found == width && off(from[1], lower) < 0.05 && off(to[1], upper) < 0.05
        })
    };
    for condition in &found.people.conditions {
        for inclusion in &condition.inclusions {
            let pooled = &inclusion.pooled;
            assert!(shows(
                12.0,
                normal_approximation(pooled.rate, pooled.trials)
            ));
            assert!(shows(26.0, pooled.clopper_pearson));
            assert!(shows(60.0, inclusion.clustered.unwrap().bounds));
        }
    }
}

// Verifies: REP-039, REP-071.
#[test]
fn the_bridge_shows_every_convention_and_the_answers() {
    let mut study = paper_study();
    let (found, figures) = drawn(&study);
    let picture = svg(&figures, "bridge.svg");
    let observed = &found.bridge.as_ref().unwrap().conditions[1].observed;
    // In both panels each share with its interval.
    let wide = bars(picture).iter().filter(|bar| bar.0 == 60.0).count();
    assert_eq!(wide, 2 * observed.len());
    assert_eq!(picture.matches("<circle ").count(), 2 * observed.len() + 1);
    for name in [
        "peak, normal",
        "peak, lateral",
        "peak, both",
        "filter, normal",
        "filter, lateral",
        "filter, both",
    ] {
        assert_eq!(picture.matches(&format!("\n{name}\n")).count(), 2, "{name}");
    }
    study.maps.truncate(1);
    let (found, figures) = drawn(&study);
    assert_eq!(found.bridge, None);
    assert!(
        figures
            .iter()
            .all(|figure| figure.file_name != "bridge.svg")
    );
}

// Verifies: REP-006, REP-036.
#[test]
fn a_measured_map_is_figure_7_and_a_computed_one_is_refused() {
    let mut study = paper_study();
    let depths = [0.0, 1e-3];
    study.measured = vec![map(None, &depths, |_| 0.1, |_| 0.0)];
    let (_, figures) = drawn(&study);
    let figure = figures
        .iter()
        .find(|figure| figure.file_name.starts_with("figure-7"))
        .unwrap();
    assert!(
        figure.caption.contains("those data are not available"),
        "{}",
        figure.caption
    );
    study.measured = vec![computed_map("8.6", 0.5)];
    let error = findings(&study).err().unwrap().to_string();
    assert!(
        error.contains("\"8.6\"") && error.contains("computed"),
        "{error}"
    );
}
