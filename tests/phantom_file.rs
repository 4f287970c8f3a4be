//! Phantom files through the public interface.

mod any;

use palpate::phantom::{BUILTIN_NAMES, Geometry, Phantom, PhantomParts, Shape, Strain, Support};
use palpate_asserts::{assert_cases, changed};

/// The example of `spec/phantom.md`, which is the built-in phantom `2.6`.
const EXAMPLE: &str = include_str!("phantom_file/example.toml");

fn read(text: &str) -> Result<Phantom, String> {
    Phantom::from_toml(text, "gel.toml").map_err(|error| error.to_string())
}

/// The refusal of the example with the first `old` replaced by `new`.
fn refusal(old: &str, new: &str) -> String {
    let message = read(&EXAMPLE.replacen(old, new, 1)).unwrap_err();
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// What is said of a file, or `good` if nothing is.
fn told(text: &str, good: &str) -> String {
    read(text).map_or_else(|message| message, |_| good.into())
}

// Verifies: PHA-019, PHA-021, PHA-026, PHA-031, PHA-032, PHA-033.
#[test]
fn finite_strain_friction_and_fibres_are_read() {
    let gel = "thickness_mm = 15.0\n";
    let text = EXAMPLE.replace("[well]", "strain = \"finite\"\n[well]");
    let text = text.replace(
        gel,
        &format!("{gel}yeoh_c20_kpa = 1.5\nfibre_modulus_kpa = 20\n"),
    );
    let phantom = read(&text).unwrap();
    assert_eq!(phantom.strain(), Strain::Finite);
    let material = phantom.layers()[1].material;
    assert_eq!((material.yeoh_c20, material.fibre_modulus), (1500.0, 20e3));
    // Along x, the fibres leave the phantom its own mirror image; obliquely not; nor does friction, which has a direction.
    assert!(phantom.is_symmetric() && phantom.mirror_image().as_ref() == Some(&phantom));
    let oblique = phantom.changed(|parts| parts.layers[1].material.fibre_angle_deg = 30.0);
    let rough = phantom.changed(|parts| parts.probe.friction = 0.3);
    let keys = ["layer[1].fibre_angle_deg", "probe.friction"];
    for ((key, value), changed) in keys.into_iter().zip([30.0, 0.3]).zip([oblique, rough]) {
        let changed = changed.unwrap();
        assert!(
            !changed.is_symmetric() && changed.mirror_image().is_none(),
            "{key}"
        );
        assert_eq!(changed.number(key), Some(value));
    }
    // Turned about its axis, it is as it was written, and has nothing off the axis.
    let ball = phantom.changed(|parts| {
        parts.geometry = Geometry::Axisymmetric;
        parts.probe.length = 2.0 * parts.probe.radius;
    });
    let ball = ball.unwrap();
    assert_eq!(read(&ball.to_toml()).as_ref(), Ok(&ball));
    let off =
        |of: &dyn Fn(&mut PhantomParts)| ball.changed(|parts| of(parts)).unwrap_err().to_string();
    let beside = off(&|parts| parts.inclusions[0].centre_x = 1e-3);
    assert!(
        beside.starts_with("inclusion[0].centre_x_mm = 1.0, but must be "),
        "{beside}"
    );
    let rough = off(&|parts| parts.probe.friction = 0.1);
    assert!(rough.contains("no friction"), "{rough}");
    let fibres = "fibre_modulus_kpa = 20.0\n";
    let oblique = format!("{fibres}fibre_angle_deg = 30.0\n");
    let lopsided = read(&ball.to_toml().replace(fibres, &oblique)).unwrap_err();
    let expected = "gel.toml:3: geometry = \"axisymmetric\", but must be \"plane\" where the phantom is not its own mirror image: ";
    assert!(lopsided.starts_with(expected), "{lopsided}");
    assert!(ball.check_pose(1e-3, 0.0).is_ok() && ball.check_pose(1e-3, 1e-3).is_err());
    let upright = phantom.changed(|parts| parts.layers[1].material.fibre_angle_deg = 90.0);
    assert!(upright.unwrap().is_symmetric());
}

// Verifies: PHA-021.
#[test]
fn the_example_of_the_spec_is_this_one() {
    let spec = include_str!("../spec/phantom.md");
    let block = spec.split("```toml\n").nth(1).unwrap();
    let block = block.split("```").next().unwrap();
    assert_eq!(read(block), read(EXAMPLE));
}

// Verifies: PHA-021.
#[test]
fn the_example_of_the_readme_is_read() {
    let phantom = read(include_str!("../docs/phantom.toml")).unwrap();
    assert_eq!((phantom.layers().len(), phantom.inclusions().len()), (3, 2));
}

// Verifies: PHA-001, PHA-020, PHA-021, PHA-027.
#[test]
fn built_in_phantoms_are_the_papers_and_survive_the_file_to_the_bit() {
    assert_eq!(Phantom::builtin("2.6").unwrap().to_toml(), EXAMPLE);
    let (before, rest) = EXAMPLE.split_once("[[inclusion]]").unwrap();
    let (_, probe) = rest.split_once("[probe]").unwrap();
    // Paper §3 and §3.1: gel, skin, well and probe are the same without an inclusion, and with one at any depth.
    for name in BUILTIN_NAMES {
        let phantom = Phantom::builtin(name).unwrap();
        let file = match name {
            "none" => format!("{before}[probe]{probe}"),
            depth => EXAMPLE.replace("depth_mm = 2.6", &format!("depth_mm = {depth}")),
        };
        let file = file.replace("name = \"2.6\"", &format!("name = {name:?}"));
        assert_eq!(read(&file), Ok(phantom.clone()), "{name}");
        assert_eq!(read(&phantom.to_toml()), Ok(phantom), "{name}");
    }
}

// Verifies: PHA-021.
#[test]
fn integers_comments_dotted_keys_and_other_orders_are_toml_too() {
    let text = "\
        probe = {radius_mm = 6.5, length_mm = 30}\n\
        name = '2.6' # mm\n\
        well.width_mm = 34\n\
        [[inclusion]]\npoisson_ratio = 0.49\ndepth_mm = 2.6\n\
        youngs_modulus_kpa = 1_200\ndiameter_mm = 6.4\n\
        [[layer]]\nname = 'skin'\nthickness_mm = 5e-1\n\
        youngs_modulus_kpa = 0.18e3\npoisson_ratio = +0.49\n\
        [[layer]]\nname = 'gel'\nthickness_mm = 15\nyoungs_modulus_kpa = 5\npoisson_ratio = 49e-2\n";
    assert_eq!(read(text), Ok(Phantom::builtin("2.6").unwrap()));
    for text in [EXAMPLE.replace('\n', "\r\n"), format!("\u{feff}{EXAMPLE}")] {
        assert_eq!(read(&text), Ok(Phantom::builtin("2.6").unwrap()));
    }
    let unnamed = EXAMPLE.replace("name = \"skin\"\n", "");
    let phantom = read(&unnamed.replace("name = \"gel\"\n", "")).unwrap();
    let names = [0, 1].map(|layer: usize| &*phantom.layers()[layer].name);
    assert_eq!(names, ["layer[0]", "layer[1]"]);
}

// Verifies: PHA-016, PHA-017, PHA-021.
#[test]
fn supports_and_shapes_are_read() {
    let text = EXAMPLE.replace("\"fixed\"", "\"sliding\"");
    let well = *read(&text).unwrap().well();
    assert_eq!([well.walls, well.floor], [Support::Sliding; 2]);
    let text = EXAMPLE.replace("floor = \"fixed\"", "floor = \"free\"");
    assert_eq!(read(&text).unwrap().well().floor, Support::Free);
    let shape = |keys: &str| {
        let phantom = read(&EXAMPLE.replace("diameter_mm = 6.4", keys)).unwrap();
        phantom.inclusions()[0].shape.clone()
    };
    let (width, height) = (0.006, 0.003);
    let ellipse = |angle_deg| Shape::Ellipse {
        width,
        height,
        angle_deg,
    };
    let sizes = "width_mm = 6\nheight_mm = 3";
    assert_eq!(shape(&format!("{sizes}\nangle_deg = 30")), ellipse(30.0));
    assert_eq!(shape(sizes), ellipse(0.0));
    let points = vec![[-0.001, 0.0], [0.0013, 0.0], [0.0, 0.002]];
    let found = shape("points_mm = [[-1, 0], [1.3, 0], [0, 2]]");
    assert_eq!(found, Shape::Polygon { points });
}

// Verifies: PHA-021.
#[test]
fn a_single_inclusion_may_be_a_table() {
    let text = EXAMPLE.replace("[[inclusion]]", "[inclusion]");
    assert_eq!(read(&text), read(EXAMPLE));
    let message = read(&text.replace("depth_mm = 2.6", "depth_mm = 12")).unwrap_err();
    assert!(message.starts_with("gel.toml:22: inclusion[0].depth_mm = 12.0, "));
}

// Verifies: PHA-020, PHA-027.
#[test]
fn every_digit_of_a_number_counts() {
    // No f64 of mm has this many metres as its shortest decimal: 1.0566132852391916 reads as the f64 that is shown as
    // 1.0566132852391915.
    let text = EXAMPLE.replace("depth_mm = 2.6", "depth_mm = 1.0566132852391916");
    let phantom = read(&text).unwrap();
    assert_eq!(phantom.inclusions()[0].depth, 0.0010566132852391916);
    assert_eq!(read(&phantom.to_toml()), Ok(phantom.clone()));
    // Nor does a change elsewhere round it.
    let other = phantom.set([("probe.radius_mm", 6.0)]).unwrap();
    assert_eq!(other.inclusions(), phantom.inclusions());
}

// Verifies: PHA-021, PHA-026.
#[test]
fn values_are_set_by_the_keys_of_the_file() {
    let phantom = read(EXAMPLE).unwrap();
    let set = |key: &str, value: &str| phantom.set([(key, value)]).map_err(|e| e.to_string());
    let text = EXAMPLE.replacen("\"fixed\"", "\"sliding\"", 1);
    assert_eq!(set("well.walls", "\"sliding\""), read(&text));
    let text = EXAMPLE.replace("name = \"gel\"", "name = \"a \\\"b\\\"\"");
    assert_eq!(set("layer[1].name", r#""a \"b\"""#), read(&text));
    let text = EXAMPLE.replace("youngs_modulus_kpa = 180.0", "youngs_modulus_kpa = 8");
    assert_eq!(set("layer[0].youngs_modulus_kpa", "8"), read(&text));
    assert_eq!(phantom.number("layer[0].youngs_modulus_kpa"), Some(180.0));
    let shape = [
        ("inclusion[0].diameter_mm", 1.0),
        ("inclusion[0].depth_mm", 14.0),
    ];
    assert!(phantom.set(shape).is_ok() && phantom.set(shape.into_iter().skip(1)).is_err());
    for key in "name layer[2].thickness_mm layer layer[0] layer[0].name layer[x].thickness_mm x.y probe.radius_mm.x".split(' ') {
        assert_eq!(phantom.number(key), None, "{key}");
    }
    assert_cases("refused/phantom.txt", "keys", |case| {
        let (key, value) = case.split_once(" = ").unwrap();
        set(key, value).unwrap_err()
    });
}

// Verifies: PHA-026.
#[test]
fn unknown_keys_are_named_with_the_allowed_ones() {
    assert!(refusal("radius_mm", "\"a\\nb\" = 1\nradius_mm").contains("probe.a b is unknown"));
    // Keys of JSON are none of a file, nor are those of a file none for their quotation marks.
    for key in r#"material shape layers "depth_m" "a.b_mm[0]" "" ".""#.split(' ') {
        let message = refusal("diameter_mm", &format!("{key} = 1\ndiameter_mm"));
        let place = "gel.toml:23: inclusion[0]";
        assert!(message.starts_with(place), "{message}");
        let message = read(&format!("{key} = 1\n{EXAMPLE}")).unwrap_err();
        assert!(message.starts_with("gel.toml:1: "), "{message}");
    }
}

// Verifies: PHA-026.
#[test]
fn every_missing_key_is_named() {
    let (mut table, mut start) = (String::new(), 0);
    for line in EXAMPLE.split_inclusive('\n') {
        let end = start + line.len();
        if let Some(header) = line.trim().strip_prefix('[') {
            table = match header.trim_matches(['[', ']']) {
                "layer" => format!("layer[{}]", EXAMPLE[..start].matches("[[layer]]").count()),
                "inclusion" => "inclusion[0]".into(),
                other => other.into(),
            };
        } else if let Some((key, _)) = line.split_once(' ') {
            let optional = ["walls", "floor", "centre_x_mm"].contains(&key);
            if !(optional || key == "name" && !table.is_empty()) {
                let without = format!("{}{}", &EXAMPLE[..start], &EXAMPLE[end..]);
                let expected = match key {
                    "name" => "name is missing".into(),
                    "diameter_mm" => "inclusion[0] has no shape: give ".into(),
                    key => format!("{table}.{key} is missing"),
                };
                let message = read(&without).unwrap_err();
                assert!(message.contains(&expected), "{message}");
            }
        }
        start = end;
    }
    let no_probe = EXAMPLE.split("[probe]").next().unwrap();
    assert_eq!(read(no_probe), Err("gel.toml: probe is missing".into()));
    let no_layer = "name = 'a'\nwell.width_mm = 34\nprobe = {radius_mm = 1, length_mm = 1}";
    assert_eq!(read(no_layer), Err("gel.toml: layer is missing".into()));
}

// Verifies: PHA-026.
#[test]
fn wrong_types_are_named_with_their_value() {
    let values = "nan, +inf, 0x22, 0b1, 0o17, 0xE5, 1e400, \"34\", true, [34.0], {mm = 34.0}, 1999-11-14, 07:32:00";
    for value in values.split(", ") {
        let message = refusal("width_mm = 34.0", &format!("width_mm = {value}"));
        let expected = format!("well.width_mm = {value}, but must be a finite decimal number");
        assert_eq!(message, format!("gel.toml:4: {expected}"));
    }
    let flat = EXAMPLE.replace("[probe]\nradius_mm = 6.5\nlength_mm = 30.0\n", "");
    let one = flat.split("[[inc").next().unwrap();
    for (text, expected) in [
        (
            format!("probe = 13\n{flat}"),
            "probe = 13, but must be a table",
        ),
        (
            format!("inclusion = 13\n{one}"),
            "inclusion = 13, but must be a list",
        ),
    ] {
        assert_eq!(read(&text), Err(format!("gel.toml:1: {expected}")));
    }
}

// Verifies: PHA-004, PHA-006, PHA-009, PHA-026.
#[test]
fn what_is_wrong_is_refused_with_its_line_key_and_value() {
    let refusal = |change: &str| read(&changed(EXAMPLE, change)).unwrap_err();
    assert_cases("refused/phantom.txt", "changes", refusal);
}

// Verifies: PHA-016, PHA-030.
#[test]
fn supports_that_hold_nothing_are_refused() {
    assert_cases("refused/phantom.txt", "supports", |case| {
        let (walls, floor) = case.split_once(", floor ").unwrap();
        let walls = walls.strip_prefix("walls ").unwrap();
        let text = EXAMPLE.replace("walls = \"fixed\"", &format!("walls = {walls:?}"));
        let text = text.replace("floor = \"fixed\"", &format!("floor = {floor:?}"));
        told(&text, "holds")
    });
}

// Verifies: PHA-015, PHA-006.
#[test]
fn polygons_that_no_mesh_follows_are_refused() {
    assert_cases("refused/phantom.txt", "polygons", |case| {
        let (points, _) = case.split_once(" #").unwrap_or((case, ""));
        let points = format!("diameter_mm = 6.4 -> points_mm = {points}");
        told(&changed(EXAMPLE, &points), "valid")
    });
}

// Verifies: PHA-026.
#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = std::env::temp_dir();
    let error = Phantom::read(&folder.join("palpate-no-such-phantom.toml")).unwrap_err();
    assert!(error.line.is_none() && error.found.starts_with("cannot be read: "));
    assert!(
        error
            .to_string()
            .contains("palpate-no-such-phantom.toml: cannot be read: ")
    );
}

// Verifies: PHA-027.
#[test]
fn a_phantom_that_cannot_exist_is_not_made() {
    let none = Phantom::builtin("none").unwrap();
    assert!(
        none.changed(|parts| parts.layers[0].thickness = f64::NAN)
            .is_err()
    );
}
