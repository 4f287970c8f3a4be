//! What the figures show, read back from their coordinates.

use super::findings;
use super::run::*;
use crate::psychophysics::Bounds;
use crate::report::{Run, normal_approximation, text};
use crate::tests::measured;
use palpate::fem::mesh::Region;
use palpate::force_map::ForceTable;
use palpate::phantom::{Phantom, PhantomParts};
use palpate_asserts::assert_has;

fn svg(made: &Made, name: &str) -> String {
    made.figure(name).svg.clone()
}

/// The value of an attribute.
fn attribute(element: &str, name: &str) -> f64 {
    let value = between(element, &format!(" {name}=\""), "\"");
    value.parse().unwrap()
}

/// The corners of every element of one name, with the element's text.
fn shapes<'a>(svg: &'a str, name: &str) -> Vec<(&'a str, Vec<[f64; 2]>)> {
    let corner = |point: &str| {
        let (x, y) = point.split_once(',').unwrap();
        [x, y].map(|number| number.parse().unwrap())
    };
    let tag = format!("<{name} ");
    let elements = svg.split(tag.as_str()).skip(1);
    let points = |element| between(element, "points=\"", "\"").split_whitespace();
    elements
        .map(|rest| between(rest, "", ">"))
        .map(|element| (element, points(element).map(corner).collect()))
        .collect()
}

/// Width, height, and x and depth of the centre of every area of Figure 1 that is filled with a colour, mm, if its gel is 34 mm wide
/// and 15 mm high under 0.5 mm of skin.
fn areas(svg: &str, fill: &str) -> Vec<[f64; 4]> {
    let boxes = |fill: &str| {
        let mut shapes = shapes(svg, "polygon");
        shapes.retain(|(element, _)| element.contains(fill));
        let around = |corners: Vec<[f64; 2]>| {
            let range = |k: usize| text::extremes(corners.iter().map(|corner| corner[k])).unwrap();
            let [[left, right], [top, bottom]] = [0, 1].map(range);
            let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
            [right - left, bottom - top, middle[0], middle[1]]
        };
        shapes
            .into_iter()
            .map(|(_, corners)| around(corners))
            .collect::<Vec<_>>()
    };
    let gel = boxes("#FAF3E0")[0];
    let scale = 34.0 / gel[0];
    let below = |of: [f64; 4]| {
        let [x, depth] = [of[2] - gel[2], of[3] - gel[3]].map(|off| scale * off);
        [scale * of[0], scale * of[1], x, depth + 8.0]
    };
    boxes(fill).into_iter().map(below).collect()
}

/// How often a figure has each of some words as a text of their own.
fn assert_words(svg: &str, count: usize, words: &[&str]) {
    for words in words {
        let found = svg.matches(&format!("\n{words}\n")).count();
        assert_eq!(found, count, "{words}");
    }
}

const LAYER: &str = "youngs_modulus_kpa = 5\npoisson_ratio = 0.49\n";

/// A phantom 34 mm wide from the rest of its file.
fn own(name: &str, well: &str, layers: &[(&str, f64)], inclusions: &[&str]) -> Phantom {
    let mut text = format!(
        "name = {name:?}\nprobe = {{ radius_mm = 6.5, length_mm = 30 }}\n[well]\nwidth_mm = 34\n{well}"
    );
    for (name, thickness) in layers {
        text += &format!("[[layer]]\nname = {name:?}\nthickness_mm = {thickness}\n{LAYER}");
    }
    for inclusion in inclusions {
        text += &format!("[[inclusion]]\n{inclusion}\n{LAYER}");
    }
    Phantom::from_toml(&text, name).unwrap()
}

/// A run of the first phantom as Figure 6, and of maps of all if there are several.
fn run_of(phantoms: &[Phantom]) -> Run {
    let map = |phantom: &Phantom| map(Some(phantom.clone()), &DEPTHS, |_| 0.1, |_| 0.0);
    let mut run = paper_run();
    run.maps = phantoms[1..].iter().map(map).collect();
    if !run.maps.is_empty() {
        run.reference = map(&phantoms[0]);
    }
    run.deformed.phantom = phantoms[0].clone();
    for (region, _) in &mut run.deformed.elements {
        *region = Region::Layer(0);
    }
    run
}

/// Left, right, top and bottom of all words, pixels, by the report's own estimate of their width.
fn words(svg: &str) -> Vec<(String, [f64; 4])> {
    let boxes = svg.split("<text").skip(1).map(|rest| {
        let element = between(rest, "", ">");
        let text = between(rest, ">", "</text>").trim().to_string();
        let [x, y] = ["x", "y"].map(|name| attribute(element, name) / 10.0);
        let wide = 8.7 * text.chars().count() as f64;
        let left = match element {
            _ if element.contains("\"end\"") => x - wide,
            _ if element.contains("\"middle\"") => x - 0.5 * wide,
            _ => x,
        };
        (text, [left, left + wide, y - 16.0, y])
    });
    boxes.collect()
}

const TWO: [(&str, f64); 2] = [("skin", 0.5), ("gel", 15.0)];
const ELLIPSE: &str = "centre_x_mm = -6\ndepth_mm = 4\nwidth_mm = 5\nheight_mm = 2\nangle_deg = 90";
const TRIANGLE: &str = "centre_x_mm = 5\ndepth_mm = 6\npoints_mm = [[-3, 0], [3, 0], [0, 5]]";
const DISC: &str = "depth_mm = 4\ndiameter_mm = 5";

/// A drawing unit is less than 0.01 mm, and every place is rounded to a whole one. What holds the layers is drawn 2.38 mm thick.
// Verifies: REP-030.
#[test]
fn figure_1_shows_any_phantom_to_scale() {
    let paper = Phantom::builtin("2.6").unwrap();
    let two = own("two", "", &TWO, &[ELLIPSE, TRIANGLE]);
    let held = |well: &str| own("held", well, &TWO, &[]);
    let (ellipse, triangle) = ([2.0, 5.0, -6.0, 6.5], [6.0, 5.0, 5.0, 8.5]);
    let (gel, skin, probe) = (
        [34.0, 15.0, 0.0, 8.0],
        [34.0, 0.5, 0.0, 0.25],
        [13.0, 6.5, 0.0, -3.25],
    );
    let (walls, no_walls, no_floor) = (
        [38.76, 17.88, 0.0, 8.94],
        [34.0, 17.88, 0.0, 8.94],
        [38.76, 15.5, 0.0, 7.75],
    );
    for (phantom, fill, expected, words) in [
        (&paper, "#FAF3E0", &[gel][..], "gel: 15 mm"),
        (&paper, "#56B4E9", &[skin], "skin: 0.5 mm"),
        (
            &paper,
            "#D0D4DA",
            &[probe],
            "probe: ø 13 mm, 30 mm long, rigid",
        ),
        (
            &paper,
            "#E69F00",
            &[[6.4, 6.4, 0.0, 5.8]],
            "inclusion: ø 6.4 mm, 2.6 mm deep",
        ),
        (
            &two,
            "#E69F00",
            &[ellipse, triangle],
            "inclusion: 5 × 2 mm, 90°, x = −6 mm, 4 mm deep",
        ),
        (
            &two,
            "#E69F00",
            &[ellipse, triangle],
            "inclusion: 6 × 5 mm, x = 5 mm, 6 mm deep",
        ),
        (&held(""), "#E2DDD4", &[walls], "walls and floor fixed"),
        (
            &held("walls = \"sliding\"\n"),
            "#E2DDD4",
            &[walls],
            "walls sliding, floor fixed",
        ),
        (
            &held("walls = \"free\"\n"),
            "#E2DDD4",
            &[no_walls],
            "walls free, floor fixed",
        ),
        (
            &held("floor = \"free\"\n"),
            "#E2DDD4",
            &[no_floor],
            "walls fixed, floor free",
        ),
    ] {
        let made = made(&run_of(std::slice::from_ref(phantom)));
        let picture = svg(&made, "figure-1");
        let found = areas(&picture, fill);
        assert_eq!(found.len(), expected.len(), "{words}");
        let pairs = found.as_flattened().iter().zip(expected.as_flattened());
        assert!(
            pairs.into_iter().all(|(a, b)| (a - b).abs() < 0.025),
            "{found:?}, expected {expected:?}"
        );
        assert_words(&picture, 1, &[words]);
        assert_has(&made.figure("figure-1").alt, words);
    }
}

// Verifies: REP-030.
#[test]
fn figure_1_is_drawn_for_each_phantom_that_differs_in_more_than_inclusions() {
    let disc = |name: &str, change: fn(&mut PhantomParts)| {
        own(name, "", &TWO, &[DISC]).changed(change).unwrap()
    };
    let softer = disc("softer", |of| of.layers[1].material.youngs_modulus = 4e3);
    let renamed = disc("renamed", |of| of.layers[1].name = "agar".into());
    let wide = disc("wide", |of| of.well.width = 0.04);
    let plain = own("plain", "", &TWO, &[]);
    let two = own("two", "", &TWO, &[ELLIPSE, TRIANGLE]);
    let made = made(&run_of(&[plain, softer, renamed, two, wide]));
    let names = made.figures.iter().map(|figure| &figure.file_name[..]);
    let others: Vec<_> = names.filter(|name| name.starts_with("figure-1-")).collect();
    assert_eq!(others, ["figure-1-softer.svg", "figure-1-wide.svg"]);
    assert_has(&svg(&made, "figure-1-wide"), "the well is 40 mm wide");
    let materials =
        "skin: E = 5 kPa, ν = 0.49; gel: E = 4 kPa, ν = 0.49; inclusion: E = 5 kPa, ν = 0.49";
    assert_has(&made.figure("figure-1-softer").caption, materials);
}

// Verifies: REP-003, REP-030, REP-064.
#[test]
fn no_words_of_the_phantoms_figures_lie_on_others() {
    let names: [String; 9] = std::array::from_fn(|k| format!("layer {k}"));
    let many: [_; 9] = std::array::from_fn(|k| (&*names[k], [0.5, 3.0][k % 2]));
    let places: [String; 30] = std::array::from_fn(|k| {
        let (row, column) = (k / 10, k % 10);
        let (x, depth) = (
            3 * column as i32 - 14,
            1.0 + 4.5 * row as f64 + 0.1 * column as f64,
        );
        let diameter = 1.0 + 0.1 * (k % 9) as f64;
        format!("centre_x_mm = {x}\ndepth_mm = {depth:.1}\ndiameter_mm = {diameter}")
    });
    let crowd = places.each_ref().map(String::as_str);
    let sized = |phantom: Phantom, width: f64, radius: f64| {
        let sized = phantom.changed(|of| (of.well.width, of.probe.radius) = (width, radius));
        sized.unwrap()
    };
    let tall = own("tall", "floor = \"sliding\"\n", &many, &[]);
    let tall = sized(tall, 0.008, 0.0005);
    let flat = own("flat", "", &[("a layer with a long name", 1.0)], &[]);
    let flat = sized(flat, 0.5, 0.2);
    let phantoms = [
        Phantom::builtin("2.6").unwrap(),
        own("two", "", &TWO, &[ELLIPSE, TRIANGLE]),
        own("off", "walls = \"sliding\"\n", &TWO, &[ELLIPSE]),
        own("many", "", &many, &["depth_mm = 4.2\ndiameter_mm = 2.5"]),
        own("crowd", "", &[("gel", 16.0)], &crowd),
        tall,
        flat,
    ];
    for phantom in phantoms {
        let name = phantom.name().to_owned();
        let made = made(&run_of(&[phantom]));
        for figure in ["figure-1", "figure-6"] {
            let picture = svg(&made, figure);
            let (height, words) = (attribute(&picture, "height"), words(&picture));
            assert!(words.len() > 4);
            for (k, (one, a)) in words.iter().enumerate() {
                let is_inside = a[0] >= 0.0 && a[1] <= 520.0 && a[2] >= -3.0 && a[3] <= height;
                assert!(is_inside, "{name} {figure}: {one:?} {a:?}");
                for (other, b) in &words[..k] {
                    let apart = a[0] >= b[1] || b[0] >= a[1] || a[2] >= b[3] || b[2] >= a[3];
                    assert!(apart, "{name} {figure}: {one:?} {a:?} on {other:?} {b:?}");
                }
            }
        }
    }
}

// Verifies: REP-003.
#[test]
fn figure_6_tells_layers_and_inclusions_apart() {
    let layers = [("skin", 0.5), ("fat", 3.0), ("gel", 12.0)];
    let mut run = run_of(&[own("mine", "", &layers, &[ELLIPSE, TRIANGLE])]);
    let corners = run.deformed.elements[0].1.clone();
    let regions = [1, 2].map(Region::Layer).into_iter();
    let regions = regions.chain([0, 1].map(Region::Inclusion));
    run.deformed.elements = regions.map(|region| (region, corners.clone())).collect();
    let picture = svg(&made(&run), "figure-6");
    assert_words(&picture, 1, &["skin", "fat", "gel", "inclusions"]);
    let paths = |fill: &str| {
        let mut paths = picture.split("<path ").skip(1).collect::<Vec<_>>();
        paths.retain(|path| between(path, "", "/>").contains(fill));
        paths.len()
    };
    let found = ["#56B4E9", "#D3EAD4", "#FAF3E0", "#E69F00"].map(paths);
    assert_eq!(found, [0, 1, 1, 2]);
    // The words are of an inclusion where the paper's gel has one.
    for (name, keeps) in [("2.6", true), ("none", false)] {
        let mut run = paper_run();
        run.deformed.phantom = Phantom::builtin(name).unwrap();
        let made = made(&run);
        let figure = made
            .figures
            .iter()
            .find(|of| of.file_name.starts_with("figure-6"));
        let caption = &figure.unwrap().caption;
        assert_eq!(
            caption.contains("The inclusion keeps its shape"),
            keeps,
            "{caption}"
        );
    }
}

/// Upright bars with their width (drawing units), for a panel whose `range` of per cent is `height` units high.
fn bars(picture: &str) -> Vec<(f64, [f64; 2], [f64; 2])> {
    let upright = |(element, corners): (&str, Vec<[f64; 2]>)| match corners[..] {
        [from, to] if from[0] == to[0] && from[1] != to[1] => {
            Some((attribute(element, "stroke-width"), from, to))
        }
        _ => None,
    };
    let lines = shapes(picture, "polyline").into_iter();
    lines.filter_map(upright).collect()
}

// Verifies: REP-030.
#[test]
fn figures_10_to_13_show_every_subject_and_three_intervals_for_each_share() {
    let made = made(&paper_run());
    for number in 10..13 {
        let picture = svg(&made, &format!("figure-{number}"));
        for subject in 1..=10 {
            assert_words(&picture, 1, &[&format!("subject {subject}")]);
        }
        // Ten subjects and the mean at four depths, and each in the key.
        assert_eq!(picture.matches("<circle ").count(), 11 * (4 + 1));
    }
    let bars = bars(&made.figure("figure-13").svg);
    // The axis from 40 to 100 % is 330 pixels of ten units high; its foot is the lowest place of all.
    let ends = bars.iter().flat_map(|(_, from, to)| [from[1], to[1]]);
    let foot = ends.fold(0.0, f64::max) - 50.0;
    let share = |y: f64| 40.0 + 60.0 * (foot - y) / 3300.0;
    let shows = |width: f64, Bounds { lower, upper }: Bounds| {
        bars.iter().any(|(found, from, to)| {
            let off = |y: f64, end: f64| (share(y) - 100.0 * end).abs();
            // Places are rounded to a unit, 0.02 %.
            *found == width && off(from[1], lower) < 0.05 && off(to[1], upper) < 0.05
        })
    };
    let conditions = made.found.people.conditions.iter();
    for inclusion in conditions.flat_map(|condition| &condition.inclusions) {
        let pooled = &inclusion.pooled;
        let normal = normal_approximation(pooled.rate, pooled.trials);
        let clustered = inclusion.clustered.unwrap().bounds;
        assert!(shows(12.0, normal) && shows(60.0, clustered));
        assert!(shows(26.0, pooled.clopper_pearson));
    }
}

// Verifies: REP-030, REP-070.
#[test]
fn the_bridge_shows_every_convention_and_the_answers() {
    let mut run = paper_run();
    let found = made(&run);
    let picture = svg(&found, "bridge");
    let observed = &found.found.bridge.as_ref().unwrap().conditions[1].observed;
    // In both panels each share with its interval.
    let wide = bars(&picture).iter().filter(|bar| bar.0 == 60.0).count();
    assert_eq!(wide, 2 * observed.len());
    assert_eq!(picture.matches("<circle ").count(), 2 * observed.len() + 1);
    for statistic in ["peak", "filter"] {
        let names = ["normal", "lateral", "both"].map(|channel| format!("{statistic}, {channel}"));
        assert_words(&picture, 2, &names.each_ref().map(String::as_str));
    }
    run.maps.truncate(1);
    let found = made(&run);
    assert_eq!(found.found.bridge, None);
    let mut names = found.figures.iter().map(|figure| &figure.file_name[..]);
    assert!(names.all(|name| name != "bridge.svg"));
}

// Verifies: REP-004, REP-031.
#[test]
fn a_measured_map_is_figure_7_and_a_computed_one_is_refused() {
    let mut run = paper_run();
    run.measured = vec![map(None, &[0.0, 1e-3], |_| 0.1, |_| 0.0)];
    let figures = made(&run).figures;
    let mut figures = figures.iter();
    let seventh = figures.find(|figure| figure.file_name.starts_with("figure-7"));
    assert_has(&seventh.unwrap().caption, "those data are not available");
    assert_has(&seventh.unwrap().alt, "lateral position, 2 curves each");
    // A sensor of one axis has one panel.
    let text = "depth_mm,lateral_mm,normal_force_n\n1,0,0.5\n1,5,0.5\n2,0,1\n2,5,1\n";
    let table = ForceTable::from_csv(text, "gel.csv").unwrap();
    run.measured = vec![measured(None, table)];
    let figures = made(&run).figures;
    let mut figures = figures.iter();
    let seventh = figures.find(|figure| figure.file_name.starts_with("figure-7"));
    let seventh = seventh.unwrap();
    assert_has(
        &seventh.alt,
        "A line chart of measured normal force against|2 curves each",
    );
    assert!(seventh.svg.contains("Normal force (N)") && !seventh.svg.contains("Lateral force (N)"));
    run.measured = vec![computed_map("8.6", 0.5)];
    let error = findings(&run).unwrap_err().to_string();
    assert_has(&error, "\"8.6\"|computed");
}
