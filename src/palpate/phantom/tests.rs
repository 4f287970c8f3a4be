mod decimal;

use super::*;
use crate::decimal::parse_scaled;
use palpate_asserts::numbers;

/// The paper's phantom with the inclusion at 2.6 mm, to be spoilt.
fn paper() -> PhantomParts {
    Phantom::builtin("2.6").unwrap().into()
}

/// `paper` after `change`.
fn changed(change: impl FnOnce(&mut PhantomParts)) -> PhantomParts {
    let mut phantom = paper();
    change(&mut phantom);
    phantom
}

fn with_disc(diameter: f64, depth: f64) -> PhantomParts {
    changed(|p| {
        p.inclusions[0].shape = Shape::Disc { diameter };
        p.inclusions[0].depth = depth;
    })
}

/// A gel of 20 mm and 5 kPa in a well of 60 mm, with inclusions of these shapes: centre, depth and shape in mm.
fn with_shapes(shapes: &[(f64, f64, Shape)]) -> PhantomParts {
    let mut phantom = PhantomParts::from(Phantom::builtin("none").unwrap());
    let material = phantom.layers[1].material;
    phantom.well.width = 0.06;
    phantom.layers[1].thickness = 0.02;
    let inclusion = |(x, depth, shape): &(f64, f64, Shape)| Inclusion {
        centre_x: mm(*x),
        depth: mm(*depth),
        shape: shape.clone(),
        material,
    };
    phantom.inclusions = shapes.iter().map(inclusion).collect();
    phantom
}

/// The length that the decimal of `length` (mm) names.
fn mm(length: f64) -> f64 {
    parse_scaled(&length.to_string(), -3).unwrap_or(length)
}

pub(crate) fn disc(diameter_mm: f64) -> Shape {
    let diameter = mm(diameter_mm);
    Shape::Disc { diameter }
}

pub(crate) fn ellipse(width_mm: f64, height_mm: f64, angle_deg: f64) -> Shape {
    Shape::Ellipse {
        width: mm(width_mm),
        height: mm(height_mm),
        angle_deg,
    }
}

pub(crate) fn polygon(points_mm: &[[f64; 2]]) -> Shape {
    let points = points_mm.iter().map(|p| p.map(mm)).collect();
    Shape::Polygon { points }
}

fn rectangle(width_mm: f64, height_mm: f64) -> Shape {
    let x = width_mm / 2.0;
    polygon(&[[-x, 0.0], [x, 0.0], [x, height_mm], [-x, height_mm]])
}

fn check(parts: &PhantomParts) -> Result<(), Refusal> {
    Phantom::new(parts.clone()).map(|_| ())
}

fn made(parts: PhantomParts) -> Phantom {
    Phantom::new(parts).unwrap()
}

fn is_valid(shapes: &[(f64, f64, Shape)]) -> bool {
    check(&with_shapes(shapes)).is_ok()
}

fn refusal(phantom: &PhantomParts) -> String {
    check(phantom).unwrap_err().to_string()
}

fn shape_refusal(shapes: &[(f64, f64, Shape)]) -> String {
    refusal(&with_shapes(shapes))
}

/// Asserts the refusal of some shapes, the key of an inclusion left out.
#[track_caller]
fn refuses(shapes: &[(f64, f64, Shape)], expected: &str) {
    assert_eq!(shape_refusal(shapes), format!("inclusion{expected}"));
}

// Verifies: PHA-001.
#[test]
fn other_names_are_refused_with_the_list() {
    assert_eq!(BUILTIN_NAMES, ["none", "2.6", "4.6", "6.6", "8.6"]);
    let message = Phantom::builtin("2.60").unwrap_err().to_string();
    let expected = "no phantom named \"2.60\" is built in; built in are none, 2.6, 4.6, 6.6, 8.6";
    assert_eq!(message, expected);
}

/// The keys of every number of the paper's phantom in its file.
const KEYS: &str = "well.width_mm \
    layer[0].thickness_mm layer[0].youngs_modulus_kpa layer[0].poisson_ratio \
    layer[1].thickness_mm layer[1].youngs_modulus_kpa layer[1].poisson_ratio \
    inclusion[0].centre_x_mm inclusion[0].diameter_mm inclusion[0].depth_mm \
    inclusion[0].youngs_modulus_kpa inclusion[0].poisson_ratio probe.radius_mm probe.length_mm";

/// The number with this key.
fn number<'a>(phantom: &'a mut PhantomParts, key: &str) -> &'a mut f64 {
    let (table, key) = key.split_once('.').unwrap();
    let (layer, inclusion) = (usize::from(table == "layer[1]"), &mut phantom.inclusions[0]);
    let layer = &mut phantom.layers[layer];
    let material = match table {
        "inclusion[0]" => &mut inclusion.material,
        _ => &mut layer.material,
    };
    match (key, &mut inclusion.shape) {
        ("youngs_modulus_kpa", _) => &mut material.youngs_modulus,
        ("poisson_ratio", _) => &mut material.poisson_ratio,
        ("width_mm", _) => &mut phantom.well.width,
        ("thickness_mm", _) => &mut layer.thickness,
        ("centre_x_mm", _) => &mut inclusion.centre_x,
        ("depth_mm", _) => &mut inclusion.depth,
        ("diameter_mm", Shape::Disc { diameter }) => diameter,
        ("radius_mm", _) => &mut phantom.probe.radius,
        ("length_mm", _) => &mut phantom.probe.length,
        _ => panic!("{key}"),
    }
}

// Verifies: PHA-004, PHA-009, CON-007.
#[test]
fn numbers_that_are_not_finite_or_no_sizes_are_refused_by_key() {
    for key in KEYS.split(' ') {
        for value in [f64::NAN, f64::INFINITY, -f64::INFINITY, 0.0, -0.0, -1.5] {
            let may_be_0 = key.ends_with("ratio") || key.ends_with("centre_x_mm");
            let shown = match value.is_finite() {
                true if may_be_0 => continue,
                true => format!("{key} = "),
                false => format!("{key} = {value}, "),
            };
            let message = refusal(&changed(|p| *number(p, key) = value));
            assert!(message.starts_with(&shown), "{message}");
        }
    }
}

// Verifies: PHA-004.
#[test]
fn the_ends_of_the_ranges_are_where_the_spec_says() {
    let valid = |change: &dyn Fn(&mut PhantomParts)| check(&changed(change)).is_ok();
    let poisson = |ratio| valid(&|p| p.layers[1].material.poisson_ratio = ratio);
    assert!(poisson(0.4995) && poisson(-0.9999) && poisson(0.0));
    assert!(!poisson(0.49951) && !poisson(-1.0) && !poisson(-1.5));
    let finite = |ratio| {
        valid(&|p| {
            p.strain = Strain::Finite;
            p.layers[1].material.poisson_ratio = ratio;
        })
    };
    assert!(finite(0.4999) && finite(1e-3));
    assert!(!finite(0.49991) && !finite(0.0) && !finite(-0.3));
    let radius = |radius| valid(&|p| p.probe.radius = radius);
    assert!(radius(0.016_999) && !radius(0.017) && !radius(0.018));
    let skin = |thickness| valid(&|p| p.layers[0].thickness = thickness);
    assert!(skin(1e-6) && !skin(0.99e-6));
    let length = |length| valid(&|p| p.probe.length = length);
    assert!(length(1.0) && !length(1.000_001));
}

// Verifies: PHA-004, PHA-009.
#[test]
fn there_are_some_layers_and_not_too_many() {
    let layers = |count| {
        changed(|p| {
            p.inclusions.clear();
            let layer = p.layers[0].clone();
            p.layers = vec![layer; count];
        })
    };
    assert_eq!(check(&layers(1)), Ok(()));
    assert_eq!(check(&layers(100)), Ok(()));
    assert_eq!(
        refusal(&layers(0)),
        "layer = 0 of them, but must be 1 to 100"
    );
    let message = "layer = 101 of them, but must be 1 to 100";
    assert_eq!(refusal(&layers(101)), message);
    // Discs of 0.2 mm, 0.4 mm apart.
    let one = |at| (0.4 * f64::from(at) - 20.0, 3.0, disc(0.2));
    assert!(is_valid(&(0..100).map(one).collect::<Vec<_>>()));
    let discs: Vec<_> = (0..101).map(one).collect();
    refuses(&discs, " = 101 of them, but must be 0 to 100");
}

// Verifies: PHA-006, PHA-015.
#[test]
fn an_inclusion_keeps_its_clearance_from_layers_and_walls() {
    let fits = |diameter, depth| check(&with_disc(diameter, depth)).is_ok();
    // Skin: 0.5 mm of skin and 0.1 mm of gel above the disc.
    assert!(fits(0.0064, 0.0006) && !fits(0.0064, 0.000_599));
    // Floor: 15.5 − 6.4 − 0.1 = 9.0 mm.
    assert!(fits(0.0064, 0.009) && !fits(0.0064, 0.009_001));
    // Skin and floor at once: 15.0 − 0.2 = 14.8 mm.
    assert!(fits(0.0148, 0.0006) && !fits(0.014_801, 0.0006));
    // In the skin itself: a disc of 0.3 mm fits 0.1 mm below the surface, nowhere else.
    assert!(fits(0.0003, 0.0001) && !fits(0.0003, 0.000_101) && !fits(0.0003, 0.000_099));
    // Walls: a well of 10 mm holds a disc of 9.8 mm, and one of 6.4 mm up to 1.7 mm off its middle.
    let in_narrow_well = |diameter, centre_x| {
        let mut phantom = with_disc(diameter, 0.002);
        phantom.well.width = 0.01;
        phantom.probe.radius = 0.002;
        phantom.inclusions[0].centre_x = centre_x;
        check(&phantom).is_ok()
    };
    assert!(in_narrow_well(0.0098, 0.0) && !in_narrow_well(0.009_801, 0.0));
    assert!(in_narrow_well(0.0064, 0.0017) && !in_narrow_well(0.0064, 0.001_701));
    assert!(in_narrow_well(0.0064, -0.0017) && !in_narrow_well(0.0064, -0.001_701));
    // An ellipse of 10 mm by 6 mm at 30° is 2·√(5²·¾ + 3²·¼) = 2·√21 mm wide and 2·√(5²·¼ + 3²·¾) = 2·√13 mm high.
    let [wide, high] = [2.0 * 21f64.sqrt(), 2.0 * 13f64.sqrt()];
    let turned = |x, depth| is_valid(&[(x, depth, ellipse(10.0, 6.0, 30.0))]);
    let (x, depth) = (30.0 - 0.1 - wide / 2.0, 20.5 - 0.1 - high);
    assert!(turned(x - 1e-6, depth - 1e-6) && !turned(x + 1e-6, 5.0) && !turned(0.0, depth + 1e-6));
}

// Verifies: PHA-015, PHA-006.
#[test]
fn discs_that_overlap_or_touch_are_refused() {
    // 3-4-5: centres 5 mm apart, and 4.9 mm are 2.4 + 2.5.
    let two = |diameter| {
        [
            (0.0, 4.0, disc(4.8)),
            (3.0, 8.0 - (diameter - 4.8) / 2.0, disc(diameter)),
        ]
    };
    assert!(is_valid(&two(5.0)));
    for (diameter, gap) in [(5.2, "0.0"), (5.1, "0.05")] {
        let outline = format!("[1] = an outline {gap} mm from that of inclusion[0]");
        refuses(
            &two(diameter),
            &format!("{outline}, but must be at least 0.1 mm away"),
        );
    }
    assert!(is_valid(&[(-2.5, 4.0, disc(5.0)), (2.6, 4.0, disc(5.0))]));
    assert!(!is_valid(&[
        (-2.5, 4.0, disc(5.0)),
        (2.599, 4.0, disc(5.0))
    ]));
}

// Verifies: PHA-006.
#[test]
fn shapes_that_overlap_or_enclose_one_another_are_refused() {
    let overlap =
        "[1] = an outline 0.0 mm from that of inclusion[0], but must be at least 0.1 mm away";
    let shapes = [disc(8.0), ellipse(8.0, 7.9, 10.0), rectangle(8.0, 8.0)];
    let small = [disc(1.0), ellipse(1.0, 0.9, 10.0), rectangle(1.0, 1.0)];
    for (large, size) in shapes.iter().zip(0..) {
        for inner in &small {
            // Within, in either order, and half within.
            let (outer, inner) = ((0.0, 4.0, large.clone()), |x, y| (x, y, inner.clone()));
            refuses(&[outer.clone(), inner(0.0, 7.0)], overlap);
            refuses(&[inner(0.0, 7.0), outer.clone()], overlap);
            refuses(&[outer.clone(), inner(4.0, 7.5)], overlap);
            // 0.101 mm beside it, 0.098 mm beside it: 0.001 mm are for chords.
            let half = |shape| with_shapes(&[shape]).inclusions[0].extent()[1] * 1e3;
            let half_width = [4.0, half(outer.clone()), 4.0][size];
            let inner_half = half(inner(0.0, 4.0));
            let beside = |gap: f64| {
                let depth = 8.0 - inner_half; // about the middle of the large one
                is_valid(&[outer.clone(), inner(half_width + inner_half + gap, depth)])
            };
            assert!(beside(0.3) && !beside(-0.1));
        }
    }
    // A triangle in the notch of another: bounding boxes overlap, outlines are 0.5·√2/2 mm apart.
    let triangle = polygon(&[[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]);
    let notch = |x: f64, depth| (x, depth, polygon(&[[4.0, 4.0], [0.0, 4.0], [4.0, 0.0]]));
    assert!(is_valid(&[(0.0, 4.0, triangle.clone()), notch(0.5, 4.0)]));
    refuses(&[(0.0, 4.0, triangle.clone()), notch(0.0, 4.0)], overlap);
    // 0.1·√2/2 = 0.0707… mm.
    let message = shape_refusal(&[(0.0, 4.0, triangle), notch(0.1, 4.0)]);
    let beginning = "inclusion[1] = an outline 0.0707106";
    assert!(message.starts_with(beginning), "{message}");
}

// Verifies: PHA-004.
#[test]
fn ellipses_are_neither_slivers_nor_turned_too_far() {
    let of = |[width, height, angle]: [f64; 3]| [(0.0, 4.0, ellipse(width, height, angle))];
    let sizes = "0.1 2 0\n2 0.1 0\n2 1 360\n2 1 -360";
    assert!(numbers(sizes).into_iter().all(|sizes| is_valid(&of(sizes))));
    let message = shape_refusal(&of([2.0, 1.0, f64::NAN]));
    assert!(message.starts_with("inclusion[0].angle_deg = NaN, but must be "));
}

// Verifies: PHA-004.
#[test]
fn polygons_have_three_to_a_thousand_finite_corners() {
    let refusal = |points: &[[f64; 2]]| shape_refusal(&[(0.0, 4.0, polygon(points))]);
    let round = |count: usize| {
        let angle = |k| 2.0 * std::f64::consts::PI * k as f64 / count as f64;
        let point = |k| [9.0 * f64::cos(angle(k)), 9.0 * f64::sin(angle(k))];
        (0..count).map(point).collect::<Vec<_>>()
    };
    // Edges of 18·sin(π/500) = 0.113 mm.
    assert!(is_valid(&[(0.0, 1.0, polygon(&round(500)))]));
    assert!(refusal(&round(1001)).starts_with("inclusion[0].points_mm = 1001 of them, "));
    assert_eq!(
        refusal(&[[0.0, 0.0], [1.0, 0.0], [0.0, f64::INFINITY]]),
        "inclusion[0].points_mm[2][1] = inf, but must be at least -1000.0 and at most 1000.0"
    );
}

// Verifies: PHA-004.
#[test]
fn names_that_break_a_table_are_refused() {
    let named = |name: &str| check(&changed(|p| p.name = name.into())).is_ok();
    assert!(named("a") && named(&"ü".repeat(80)));
    assert!(!named("") && !named("a\nb") && !named("\u{7}") && !named(&"a".repeat(81)));
}

// Verifies: PHA-008, PHA-017.
#[test]
fn outlines_lie_below_the_surface_by_their_depth() {
    let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
    let same = |a: [f64; 2], b: [f64; 2]| close(a[0], b[0] / 1e3) && close(a[1], b[1] / 1e3);
    let phantom = made(paper());
    assert!(close(phantom.height(), 0.0155));
    // −(2.6 + 3.2) mm.
    let Outline::Ellipse(Ellipse { centre, radii, .. }) = phantom.inclusions()[0].outline() else {
        panic!()
    };
    assert!(same(centre, [0.0, -5.8]) && radii == [0.0032; 2]);
    // 5² ¾ + 3² ¼ = 21 and 5² ¼ + 3² ¾ = 13; 30° counts from +x towards +y.
    let shapes = [
        (5.0, 4.0, ellipse(10.0, 6.0, 30.0)),
        (-9.0, 4.0, polygon(&[[0.0, 7.0], [1.0, 9.0], [1.0, 7.0]])),
    ];
    let phantom = with_shapes(&shapes);
    let (half_width, half_height) = (21f64.sqrt(), 13f64.sqrt());
    let [left, right, bottom, top] = phantom.inclusions[0].extent();
    assert!(same([left, right], [5.0 - half_width, 5.0 + half_width]));
    assert!(same([bottom, top], [-4.0 - 2.0 * half_height, -4.0]));
    let end = phantom.inclusions[0].outline().chords(4)[0];
    let (cos, sin) = (3f64.sqrt() / 2.0, 0.5);
    assert!(same(end, [5.0 + 5.0 * cos, -4.0 - half_height + 5.0 * sin]));
    // Clockwise as written, the other way round in the outline.
    let points = phantom.inclusions[1].outline().chords(0);
    let expected = [[-8.0, -6.0], [-8.0, -4.0], [-9.0, -6.0]];
    assert!((0..3).all(|k| same(points[k], expected[k])));
    let [left, right, bottom, top] = phantom.inclusions[1].extent();
    assert!(same([left, right], [-9.0, -8.0]) && same([bottom, top], [-6.0, -4.0]));
}

// Verifies: PHA-019.
#[test]
fn mirror_images_are_found_and_their_absence_too() {
    let symmetric = |shapes: &[(f64, f64, Shape)]| made(with_shapes(shapes)).is_symmetric();
    assert!(symmetric(&[]) && made(paper()).is_symmetric());
    assert!(!symmetric(&[(1.0, 4.0, disc(5.0))]));
    let pair =
        |a: Shape, b: Shape| symmetric(&[(-9.3, 4.1, a), (0.0, 4.0, disc(2.0)), (9.3, 4.1, b)]);
    assert!(pair(disc(5.0), disc(5.0)) && !pair(disc(5.0), disc(5.001)));
    assert!(pair(ellipse(5.0, 2.0, 30.0), ellipse(5.0, 2.0, -30.0)));
    assert!(pair(ellipse(5.0, 2.0, 30.0), ellipse(5.0, 2.0, 150.0)));
    assert!(!pair(ellipse(5.0, 2.0, 30.0), ellipse(5.0, 2.0, 30.0)));
    let triangle = |sign: f64| polygon(&[[0.0, 0.0], [sign * 3.1, 0.0], [sign * 1.3, 2.7]]);
    assert!(pair(triangle(1.0), triangle(-1.0)) && !pair(triangle(1.0), triangle(1.0)));
    // On the axis: by itself.
    let alone = |shape| symmetric(&[(0.0, 4.0, shape)]);
    assert!(
        [0.0, 90.0, -90.0, 180.0]
            .iter()
            .all(|&angle| alone(ellipse(5.0, 2.0, angle)))
    );
    assert!(!alone(ellipse(5.0, 2.0, 89.0)));
    assert!(alone(rectangle(3.0, 2.0)) && alone(polygon(&[[0.0, 3.0], [-1.0, 0.0], [1.0, 0.0]])));
    assert!(!alone(triangle(1.0)));
    // Of one material.
    let phantom = made(with_shapes(&[
        (-5.0, 4.0, disc(5.0)),
        (5.0, 4.0, disc(5.0)),
    ]));
    assert!(phantom.is_symmetric());
    let softer = |parts: &mut PhantomParts| parts.inclusions[0].material.poisson_ratio = 0.3;
    assert!(!phantom.changed(softer).unwrap().is_symmetric());
}

// Verifies: PHA-011, PHA-009.
#[test]
fn a_probe_outside_the_gel_or_at_a_wall_is_refused() {
    let phantom = made(paper());
    let stands = |depth, lateral| phantom.check_pose(depth, lateral).is_ok();
    // d = 4 mm: w² = 6.5² − 2.5² = 6², so |x| < 17 − 6 = 11 mm.
    assert!(stands(0.004, 0.010_999) && stands(0.004, -0.010_999));
    assert!(!stands(0.004, 0.011_001) && !stands(0.004, -0.011_001));
    // At the surface the probe is a line, below its radius it is 13 mm wide.
    assert!(stands(0.0, 0.016_999) && !stands(0.0, 0.017));
    assert!(stands(0.0065, 0.010_499) && !stands(0.0065, 0.010_501));
    assert!(stands(0.012, 0.010_499) && !stands(0.012, 0.010_501));
    assert!(stands(0.015_499, 0.0));
    let depth = "but must be at least 0.0 and below 15.5 (the height of the layers)";
    let lateral = "but must be above -11.0 and below 11.0 \
                   (the probe, 6.0 mm to each side when 4.0 mm deep, clears the walls)";
    for (place, found, expected) in [
        ([-0.001, 0.0], "depth_mm = -1.0", depth),
        ([0.0155, 0.0], "depth_mm = 15.5", depth),
        ([f64::NAN, 0.0], "depth_mm = NaN", depth),
        ([f64::INFINITY, 0.0], "depth_mm = inf", depth),
        ([1e300, 0.0], "depth_mm = 1e303", depth),
        ([0.004, -0.012], "lateral_mm = -12.0", lateral),
        ([0.004, f64::NAN], "lateral_mm = NaN", lateral),
        ([0.004, f64::INFINITY], "lateral_mm = inf", lateral),
    ] {
        let error = phantom.check_pose(place[0], place[1]).unwrap_err();
        assert_eq!(error.to_string(), format!("{found}, {expected}"));
    }
}

/// The phantom 2.6 in JSON.
const JSON: &str = r#"{"name":"2.6","well":{"width_m":0.034,"walls":"fixed","floor":"fixed"},
"layer":[{"name":"skin","thickness_m":0.0005,"material":{"youngs_modulus_pa":180000.0,"poisson_ratio":0.49}},
{"name":"gel","thickness_m":0.015,"material":{"youngs_modulus_pa":5000.0,"poisson_ratio":0.49}}],
"inclusion":[{"centre_x_m":0.0,"depth_m":0.0026,"shape":{"disc":{"diameter_m":0.0064}},
"material":{"youngs_modulus_pa":1200000.0,"poisson_ratio":0.49}}],
"probe":{"radius_m":0.0065,"length_m":0.03}}"#;

// Verifies: PHA-029, CON-001.
#[test]
fn in_json_a_phantom_has_si_units_in_its_keys() {
    let points = vec![[0.0, 0.0], [0.001, 0.0], [0.0, 0.001]];
    let triangle = Shape::Polygon { points };
    let json = JSON.replace('\n', "");
    let disc_in_json = r#"{"disc":{"diameter_m":0.0064}}"#;
    let mut cases = Vec::new();
    for (shape, in_json) in [
        (disc(6.4), disc_in_json),
        (
            ellipse(6.0, 3.0, 30.0),
            r#"{"ellipse":{"width_m":0.006,"height_m":0.003,"angle_deg":30.0}}"#,
        ),
        (
            triangle,
            r#"{"polygon":{"points_m":[[0.0,0.0],[0.001,0.0],[0.0,0.001]]}}"#,
        ),
    ] {
        let phantom = changed(|p| p.inclusions[0].shape = shape);
        cases.push((phantom, json.replace(disc_in_json, in_json)));
    }
    let (before, rest) = json.split_once(r#""inclusion""#).unwrap();
    let (_, after) = rest.split_once(r#"],"probe""#).unwrap();
    let empty = format!(r#"{before}"probe"{after}"#);
    cases.push((changed(|p| p.inclusions.clear()), empty));
    for (phantom, expected) in cases {
        assert_eq!(serde_json::to_string(&phantom).unwrap(), expected);
        assert_eq!(
            serde_json::from_str::<PhantomParts>(&expected).unwrap(),
            phantom
        );
    }
    // Neither a key that is none, nor those of a file.
    for key in ["colour", "gel", "inclusions"] {
        let unknown = json.replacen('{', &format!("{{{key:?}:{{}},"), 1);
        assert!(serde_json::from_str::<PhantomParts>(&unknown).is_err());
    }
}
