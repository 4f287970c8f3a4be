//! What the figures show, read back from their coordinates.

use super::findings;
use super::run::*;
use crate::psychophysics::Bounds;
use crate::report::{Run, normal_approximation, text};
use palpate::fem::mesh::Region;
use palpate::phantom::Phantom;
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

/// The corners of every area that is filled with a colour.
fn filled(svg: &str, fill: &str) -> Vec<Vec<[f64; 2]>> {
    let shapes = shapes(svg, "polygon").into_iter();
    let shapes = shapes.filter(|(element, _)| element.contains(fill));
    shapes.map(|(_, corners)| corners).collect()
}

/// Size and centre of the box around `corners`.
fn extent(corners: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    let range = |k: usize| text::extremes(corners.iter().map(|corner| corner[k])).unwrap();
    let [x, y] = [0, 1].map(range);
    (
        [x[1] - x[0], y[1] - y[0]],
        [x, y].map(|[from, to]| 0.5 * (from + to)),
    )
}

/// How often a figure has each of some words as a text of their own.
fn assert_words(svg: &str, count: usize, words: &[&str]) {
    for words in words {
        let found = svg.matches(&format!("\n{words}\n")).count();
        assert_eq!(found, count, "{words}");
    }
}

/// A drawing unit is 1/91 mm of the paper's phantom, and every place is rounded to a whole one.
// Verifies: REP-030.
#[test]
fn figure_1_is_to_scale() {
    let mut run = paper_run();
    run.maps.push(map_with("shallow", |_| 0.1, |_| 0.0));
    let paper = Phantom::builtin("8.6").unwrap();
    let wide = paper.changed(|parts| parts.well.width = 0.04);
    run.maps.push(map(wide.ok(), &DEPTHS, |_| 0.1, |_| 0.0));
    let made = made(&run);
    assert!(svg(&made, "figure-1-8.6").contains("the well is 40 mm wide"));
    let picture = svg(&made, "figure-1");
    let shape = |fill: &str| extent(&filled(&picture, fill)[0]);
    let [(gel, _), (probe, _)] = ["#FAF3E0", "#D0D4DA"].map(shape);
    let [(skin, place), (disc, centre)] = ["#56B4E9", "#E69F00"].map(shape);
    let scale = gel[0] / 34.0;
    for (found, millimetres) in [
        (gel[1], 15.0),
        (probe[0], 13.0),
        (probe[1], 6.5),
        (skin[1], 0.5),
        (disc[0], 6.4),
        (disc[1], 6.4),
        // The disc's centre below the skin's middle.
        (centre[1] - place[1], 2.6 + 3.2 - 0.25),
    ] {
        let error = found - scale * millimetres;
        assert!(error.abs() <= 2.0, "{found} for {millimetres} mm");
    }
    let parts = [
        "gel: 15 mm",
        "skin: 0.5 mm",
        "inclusion: ø 6.4 mm, 2.6 mm deep",
    ];
    assert_words(&picture, 1, &parts);
    assert_eq!(picture.matches("the well is 34 mm wide\n").count(), 1);
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

// Verifies: REP-030.
#[test]
fn figure_1_shows_inclusions_of_any_shape_and_place() {
    let phantom = own("two", "", &TWO, &[ELLIPSE, TRIANGLE]);
    let made = made(&run_of(&[phantom, own("one", "", &TWO, &[DISC])]));
    let picture = &svg(&made, "figure-1");
    let (gel, axis) = extent(&filled(picture, "#FAF3E0")[0]);
    let scale = gel[0] / 34.0;
    let surface = axis[1] - scale * (0.5 + 7.5);
    let inclusions = filled(picture, "#E69F00");
    assert_eq!(inclusions.len(), 2);
    for (corners, size, centre) in [
        (&inclusions[0], [2.0, 5.0], [-6.0, 6.5]),
        (&inclusions[1], [6.0, 5.0], [5.0, 8.5]),
    ] {
        let (found, place) = extent(corners);
        for k in 0..2 {
            let origin = [axis[0], surface][k];
            let errors = [
                found[k] - scale * size[k],
                place[k] - origin - scale * centre[k],
            ];
            assert!(errors.iter().all(|e| e.abs() <= 3.0), "{errors:?} {size:?}");
        }
    }
    let ellipse = "5 × 2 mm, 90°, x = −6 mm, 4 mm deep";
    let polygon = "6 × 5 mm, x = 5 mm, 6 mm deep";
    let parts = [ellipse, polygon].map(|part| format!("inclusion: {part}"));
    assert_words(picture, 1, &parts.each_ref().map(String::as_str));
    let words = format!("It holds 2 inclusions: {ellipse}; {polygon}.");
    assert_has(&made.figure("figure-1").alt, &words);
    // The other phantom differs in nothing else, so that it needs no drawing of its own.
    let mut names = made.figures.iter().map(|figure| &figure.file_name);
    assert!(names.all(|name| !name.starts_with("figure-1-")));
}

// Verifies: REP-030.
#[test]
fn figure_1_is_drawn_for_each_phantom_that_differs_in_more_than_inclusions() {
    let with_disc = |name: &str| own(name, "", &TWO, &[DISC]);
    let softer = with_disc("softer").changed(|parts| parts.layers[1].material.youngs_modulus = 4e3);
    let renamed = with_disc("renamed").changed(|parts| parts.layers[1].name = "agar".into());
    let [softer, renamed] = [softer, renamed].map(Result::unwrap);
    let made = made(&run_of(&[own("plain", "", &TWO, &[]), softer, renamed]));
    let names = made.figures.iter().map(|figure| &figure.file_name[..]);
    let others: Vec<_> = names.filter(|name| name.starts_with("figure-1-")).collect();
    assert_eq!(others, ["figure-1-softer.svg"]);
    let materials = ["skin: E = 5", "gel: E = 4", "inclusion: E = 5"];
    let materials = materials.map(|of| format!("{of} kPa, ν = 0.49"));
    assert_has(
        &made.figure("figure-1-softer").caption,
        &materials.join("; "),
    );
}

// Verifies: REP-030.
#[test]
fn figure_1_shows_how_walls_and_floor_hold() {
    // The layers are 34 mm wide and 15.5 mm high; what holds them is drawn 2.38 mm thick.
    for (well, words, block) in [
        ("", "walls and floor fixed", [38.76, 17.88]),
        (
            "walls = \"sliding\"\n",
            "walls sliding, floor fixed",
            [38.76, 17.88],
        ),
        (
            "walls = \"free\"\n",
            "walls free, floor fixed",
            [34.0, 17.88],
        ),
        (
            "floor = \"free\"\n",
            "walls fixed, floor free",
            [38.76, 15.5],
        ),
    ] {
        let picture = svg(&made(&run_of(&[own("held", well, &TWO, &[])])), "figure-1");
        let shape = |fill: &str| extent(&filled(&picture, fill)[0]).0;
        let scale = shape("#FAF3E0")[0] / 34.0;
        for (found, expected) in shape("#E2DDD4").into_iter().zip(block) {
            let error = found / scale - expected;
            assert!(error.abs() < 0.05, "{words}: {error} from {expected}");
        }
        assert_words(&picture, 1, &[words]);
    }
}

// Verifies: REP-003, REP-030, REP-064.
#[test]
fn no_words_of_the_phantoms_figures_lie_on_others() {
    let many: Vec<_> = (0..9)
        .map(|k| (format!("layer {k}"), [0.5, 3.0][k % 2]))
        .collect();
    let many: Vec<_> = many
        .iter()
        .map(|(name, thickness)| (&name[..], *thickness))
        .collect();
    let places = (0..30).map(|k| {
        let (x, depth) = (
            -14 + 3 * (k % 10),
            1.0 + 4.5 * f64::from(k / 10) + 0.1 * f64::from(k % 10),
        );
        let diameter = 1.0 + 0.1 * f64::from(k % 9);
        format!("centre_x_mm = {x}\ndepth_mm = {depth:.1}\ndiameter_mm = {diameter}")
    });
    let places: Vec<String> = places.collect();
    let crowd: Vec<&str> = places.iter().map(String::as_str).collect();
    let with_sizes = |phantom: Phantom, width, radius| {
        let sized = phantom.changed(|of| (of.well.width, of.probe.radius) = (width, radius));
        sized.unwrap()
    };
    let tall = own("tall", "floor = \"sliding\"\n", &many, &[]);
    let tall = with_sizes(tall, 0.008, 0.0005);
    let flat = own("flat", "", &[("a layer with a long name", 1.0)], &[]);
    let flat = with_sizes(flat, 0.5, 0.2);
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
}

// Verifies: REP-030.
#[test]
fn figures_10_to_12_show_every_subject() {
    let made = made(&paper_run());
    for number in 10..13 {
        let picture = svg(&made, &format!("figure-{number}"));
        for subject in 1..=10 {
            assert_words(&picture, 1, &[&format!("subject {subject}")]);
        }
        // Ten subjects and the mean at four depths, and each in the key.
        assert_eq!(picture.matches("<circle ").count(), 11 * (4 + 1));
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
fn figure_13_has_three_intervals_for_each_share() {
    let made = made(&paper_run());
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
    run.measured = vec![computed_map("8.6", 0.5)];
    let error = findings(&run).unwrap_err().to_string();
    assert_has(&error, "\"8.6\"|computed");
}
