//! Phantom files through the public interface.
#![cfg(feature = "std")]

use palpate::phantom::{
    BUILTIN_NAMES, Inclusion, Layer, Material, Phantom, Probe, Shape, Support, Well,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// The example of `spec/phantom.md`, which is the built-in phantom `2.6`.
const EXAMPLE: &str = r#"name = "2.6"

[well]
width_mm = 34.0
walls = "fixed"
floor = "fixed"

[[layer]]
name = "skin"
thickness_mm = 0.5
youngs_modulus_kpa = 180.0
poisson_ratio = 0.49

[[layer]]
name = "gel"
thickness_mm = 15.0
youngs_modulus_kpa = 5.0
poisson_ratio = 0.49

[[inclusion]]
centre_x_mm = 0.0
depth_mm = 2.6
diameter_mm = 6.4
youngs_modulus_kpa = 1200.0
poisson_ratio = 0.49

[probe]
radius_mm = 6.5
length_mm = 30.0
"#;

/// The same in the first edition.
const FIRST_EDITION: &str = r#"name = "2.6"

[gel]
width_mm = 34.0
height_mm = 15.0
youngs_modulus_kpa = 5.0
poisson_ratio = 0.49

[skin]
thickness_mm = 0.5
youngs_modulus_kpa = 180.0
poisson_ratio = 0.49

[inclusion]
diameter_mm = 6.4
depth_mm = 2.6
youngs_modulus_kpa = 1200.0
poisson_ratio = 0.49

[probe]
radius_mm = 6.5
length_mm = 30.0
"#;

fn read(text: &str) -> Result<Phantom, String> {
    Phantom::from_toml(text, "gel.toml").map_err(|error| error.to_string())
}

/// The error for the example with the only `old`, or its first, replaced by `new`.
fn refusal(old: &str, new: &str) -> String {
    refusal_of(EXAMPLE, old, new)
}

fn refusal_of(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old:?}");
    let message = read(&text.replacen(old, new, 1)).unwrap_err();
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// Checks refusals of `text`: each of `cases` is a line `old -> new`, as for [`refusal_of`], and under it the refusal without
/// the file.
fn check_refusals(text: &str, cases: &str) {
    let mut lines = cases.trim().lines().map(str::trim);
    while let Some(change) = lines.next() {
        let change = change.replace("\\n", "\n");
        let (old, new) = change.split_once(" ->").unwrap();
        let found = refusal_of(text, old, new.trim_start_matches(' '));
        assert_eq!(found.strip_prefix("gel.toml:"), lines.next());
    }
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
    assert_eq!((phantom.layers.len(), phantom.inclusions.len()), (3, 2));
}

// Verifies: PHA-020, PHA-021, PHA-027.
#[test]
fn built_in_phantoms_survive_the_file_to_the_bit() {
    assert_eq!(read(EXAMPLE), Ok(Phantom::builtin("2.6").unwrap()));
    assert_eq!(Phantom::builtin("2.6").unwrap().to_toml().unwrap(), EXAMPLE);
    for name in BUILTIN_NAMES {
        let phantom = Phantom::builtin(name).unwrap();
        assert_eq!(read(&phantom.to_toml().unwrap()), Ok(phantom), "{name}");
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
    let layers = read(&unnamed.replace("name = \"gel\"\n", ""))
        .unwrap()
        .layers;
    let names = [0, 1].map(|layer: usize| &*layers[layer].name);
    assert_eq!(names, ["layer[0]", "layer[1]"]);
}

// Verifies: PHA-016, PHA-017, PHA-021.
#[test]
fn supports_and_shapes_are_read() {
    let text = EXAMPLE.replace("\"fixed\"", "\"sliding\"");
    let well = read(&text).unwrap().well;
    assert_eq!([well.walls, well.floor], [Support::Sliding; 2]);
    let text = EXAMPLE.replace("floor = \"fixed\"", "floor = \"free\"");
    assert_eq!(read(&text).unwrap().well.floor, Support::Free);
    let shape = |keys: &str| {
        let phantom = read(&EXAMPLE.replace("diameter_mm = 6.4", keys)).unwrap();
        phantom.inclusions[0].shape.clone()
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

// Verifies: PHA-037, PHA-020.
#[test]
fn files_of_the_first_edition_are_read() {
    assert_eq!(read(FIRST_EDITION), Ok(Phantom::builtin("2.6").unwrap()));
    let (before, rest) = FIRST_EDITION.split_once("[skin]").unwrap();
    let (skin, rest) = rest.split_once("[inclusion]").unwrap();
    let bare = read(&format!("{before}[inclusion]{rest}")).unwrap();
    assert_eq!((bare.layers.len(), &*bare.layers[0].name), (1, "gel"));
    let (_, probe) = rest.split_once("[probe]").unwrap();
    let none = read(&format!("{before}[skin]{skin}[probe]{probe}")).unwrap();
    assert_eq!(none.layers, Phantom::builtin("none").unwrap().layers);
    assert!(none.inclusions.is_empty());
    // With supports and a table more than one inclusion of this edition.
    let sliding = format!("{FIRST_EDITION}[well]\nwalls = 'sliding'\n");
    let sliding = read(&sliding.replace("[inclusion]", "[[inclusion]]")).unwrap();
    assert_eq!(sliding.well.walls, Support::Sliding);
    assert_eq!(sliding.inclusions.len(), 1);
}

// Verifies: PHA-009, PHA-026, PHA-037.
#[test]
fn errors_about_the_first_edition_name_its_keys() {
    check_refusals(
        FIRST_EDITION,
        r#"
        height_mm = 15.0 -> height_mm = 0
        5: gel.height_mm = 0.0, expected at least 0.001 and at most 1000.0
        width_mm = 34.0 -> width_mm = 0x22
        4: gel.width_mm = 0x22, expected a finite decimal number
        poisson_ratio = 0.49\n\n[skin] -> poisson_ratio = 0.5\n\n[skin]
        7: gel.poisson_ratio = 0.5, expected above -1.0 and at most 0.4995
        thickness_mm = 0.5 -> thickness_mm = 0.0
        10: skin.thickness_mm = 0.0, expected at least 0.001 and at most 1000.0
        depth_mm = 2.6 -> depth_mm = 12.0
        16: inclusion.depth_mm = 12.0, expected at least 0.6 and at most 9.0 (0.1 mm of gel must lie above and below the inclusion, 6.4 mm high)
        height_mm = 15.0 -> height_mm = 15.0\nthickness_mm = 1
        6: gel.thickness_mm is unknown, expected `youngs_modulus_kpa` or `poisson_ratio`
        "#,
    );
}

// Verifies: PHA-037.
#[test]
fn the_layers_are_given_in_one_way() {
    let layer = "[[layer]]\nthickness_mm = 1\nyoungs_modulus_kpa = 1\npoisson_ratio = 0\n";
    let skin = "[skin]\nthickness_mm = 1\nyoungs_modulus_kpa = 1\npoisson_ratio = 0\n";
    for (text, more, place) in [
        (FIRST_EDITION, layer, "3: gel"),
        (FIRST_EDITION, "[well]\nwidth_mm = 34\n", "3: gel"),
        (EXAMPLE, skin, "30: skin"),
    ] {
        let expected = "expected one of `name`, `well`, `layer`, `inclusion`, `probe`";
        let message = read(&format!("{text}{more}")).unwrap_err();
        assert_eq!(message, format!("gel.toml:{place} is unknown, {expected}"));
    }
    let bare = "name = 'a'\nwell.width_mm = 34\nprobe = {radius_mm = 1, length_mm = 1}";
    assert_eq!(read(bare).unwrap_err(), "gel.toml: layer is missing");
    assert!(read(&FIRST_EDITION.replace("[gel]", "[gel]\nname = 'a'")).is_err());
}

// Verifies: PHA-026.
#[test]
fn a_shape_has_the_keys_of_one() {
    let expected = "expected one of `disc`, `ellipse`, `polygon`";
    for (keys, found) in [
        ("", "no key"),
        ("width_mm = 6", "width_mm"),
        ("angle_deg = 6", "angle_deg"),
        ("diameter_mm = 6\nangle_deg = 0", "angle_deg`, `diameter_mm"),
        (
            "diameter_mm = 6\nheight_mm = 3\nwidth_mm = 6",
            "diameter_mm`, `height_mm`, `width_mm",
        ),
        (
            "diameter_mm = 6\npoints_mm = []",
            "diameter_mm`, `points_mm",
        ),
    ] {
        for (text, place) in [
            (EXAMPLE, "20: inclusion[0]"),
            (FIRST_EDITION, "14: inclusion"),
        ] {
            let message = refusal_of(text, "diameter_mm = 6.4", keys);
            assert_eq!(
                message,
                format!("gel.toml:{place}.shape = `{found}`, {expected}")
            );
        }
    }
}

// Verifies: PHA-026.
#[test]
fn unknown_keys_are_named_with_the_allowed_ones() {
    check_refusals(
        EXAMPLE,
        r#"
        width_mm = 34.0 -> width_m = 0.034
        4: well.width_m is unknown, expected one of `width_mm`, `walls`, `floor`
        [[inclusion]] -> [[inclusions]]
        20: inclusions is unknown, expected one of `name`, `well`, `layer`, `inclusion`, `probe`
        thickness_mm = 15.0 -> thicknes_mm = 15.0
        16: layer[1].thicknes_mm is unknown, expected one of `name`, `thickness_mm`, `youngs_modulus_kpa`, `poisson_ratio`
        diameter_mm -> colour = 'red'\ndiameter_mm
        23: inclusion[0].colour is unknown, expected one of `centre_x_mm`, `depth_mm`, `diameter_mm`, `width_mm`, `height_mm`, `angle_deg`, `points_mm`, `youngs_modulus_kpa`, `poisson_ratio`
        "#,
    );
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
    for text in [EXAMPLE, FIRST_EDITION] {
        let mut table = String::new();
        let mut layer = 0;
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let end = start + line.len();
            if let Some(header) = line.trim().strip_prefix('[') {
                table = header.replace(['[', ']'], "");
                if table == "layer" {
                    table = format!("layer[{layer}]");
                    layer += 1;
                }
                if table == "inclusion" && header.starts_with('[') {
                    table = "inclusion[0]".into();
                }
            } else if let Some((key, _)) = line.split_once(' ') {
                let optional = ["walls", "floor", "centre_x_mm"].contains(&key);
                if !(optional || key == "name" && !table.is_empty()) {
                    let message = read(&format!("{}{}", &text[..start], &text[end..])).unwrap_err();
                    let named = message.contains(&format!("{key} is missing"))
                        || key == "diameter_mm" && message.contains("shape = `no key`");
                    assert!(named && message.contains(&*table), "{message}");
                }
            }
            start = end;
        }
    }
    let no_probe = EXAMPLE.split("[probe]").next().unwrap();
    assert_eq!(read(no_probe), Err("gel.toml: probe is missing".into()));
    check_refusals(
        EXAMPLE,
        r#"
        thickness_mm = 15.0\n ->
        14: layer[1].thickness_mm is missing
        width_mm = 34.0\n ->
        3: well.width_mm is missing
        "#,
    );
}

// Verifies: PHA-026.
#[test]
fn wrong_types_are_named_with_their_value() {
    let values = "nan, +inf, 0x22, 0b1, 0o17, 0xE5, 1e400, \"34\", true, [34.0], {mm = 34.0}, 1999-11-14, 07:32:00";
    for value in values.split(", ") {
        let message = refusal("width_mm = 34.0", &format!("width_mm = {value}"));
        let expected = format!("well.width_mm = {value}, expected a finite decimal number");
        assert_eq!(message, format!("gel.toml:4: {expected}"));
    }
    check_refusals(
        EXAMPLE,
        r#"
        name = "2.6" -> name = 2.6
        1: name = 2.6, expected a string
        walls = "fixed" -> walls = "glued"
        5: well.walls = "glued", expected one of `fixed`, `sliding`, `free`
        "#,
    );
    let flat = EXAMPLE.replace("[probe]\nradius_mm = 6.5\nlength_mm = 30.0\n", "");
    let one = flat.split("[[inc").next().unwrap();
    for (text, expected) in [
        (
            format!("probe = 13\n{flat}"),
            "probe = 13, expected a table",
        ),
        (
            format!("inclusion = 13\n{one}"),
            "inclusion = 13, expected a sequence",
        ),
    ] {
        assert_eq!(read(&text), Err(format!("gel.toml:1: {expected}")));
    }
    let points = r#"[[1, 2], [3]]; [[1, 2], [3, 4, 5], [0, 9]]; [1, 2]; [[1, 2], [3, "4"]]"#;
    for points in points.split("; ") {
        let message = refusal("diameter_mm = 6.4", &format!("points_mm = {points}"));
        let place = "gel.toml:23: inclusion[0].points_mm[";
        assert!(message.starts_with(place), "{message}");
    }
}

// Verifies: PHA-026.
#[test]
fn what_is_no_toml_is_refused_with_line_and_column() {
    for (new, place) in [
        ("width_mm = 34,0", "gel.toml:4: column 14: not TOML: "),
        ("width_mm = ", "gel.toml:4: column "),
        ("width_mm 34.0", "gel.toml:4: column "),
        (
            "width_mm = 1\nwidth_mm = 2",
            "gel.toml:5: column 1: not TOML: duplicate key",
        ),
    ] {
        let message = refusal("width_mm = 34.0", new);
        assert!(message.starts_with(place), "{message}");
    }
}

// Verifies: PHA-009, PHA-026.
#[test]
fn numbers_out_of_range_are_found_in_their_line() {
    check_refusals(
        EXAMPLE,
        r#"
        depth_mm = 2.6 -> depth_mm = 12
        22: inclusion[0].depth_mm = 12.0, expected at least 0.6 and at most 9.0 (0.1 mm of layer[1] must lie above and below the inclusion, 6.4 mm high)
        name = "2.6" -> # a comment\nname = ""
        2: name = "", expected 1 to 80 characters, none of them a control character
        length_mm = 30.0 -> length_mm = -0.0
        29: probe.length_mm = -0.0, expected at least 0.001 and at most 1000.0
        diameter_mm = 6.4 -> points_mm = [\n  [0, 0],\n  [1, 0],\n  [inf, 1],\n]
        26: inclusion[0].points_mm[2][0] = inf, expected a finite decimal number
        "#,
    );
    let second = "[[inclusion]]\ndepth_mm = 9.05\ndiameter_mm = 1\nyoungs_modulus_kpa = 9\npoisson_ratio = 0\n";
    assert_eq!(
        read(&format!("{EXAMPLE}{second}")).unwrap_err(),
        "gel.toml:30: inclusion[1] = an outline 0.05 mm from that of inclusion[0], expected at least 0.1 mm between them"
    );
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
fn a_phantom_that_cannot_exist_is_not_written() {
    let mut phantom = Phantom::builtin("none").unwrap();
    phantom.layers[0].thickness = f64::NAN;
    assert!(phantom.to_toml().is_err());
}

fn material() -> impl Strategy<Value = Material> {
    (1e-3..1e12, -0.999..0.4995).prop_map(|(youngs_modulus, poisson_ratio)| Material {
        youngs_modulus,
        poisson_ratio,
    })
}

/// A shape within a square of side 1 about the origin, which it need not fill.
fn shape() -> impl Strategy<Value = Shape> {
    let polygon = (3..12usize, 0.3..0.5f64, -4.0..4.0f64).prop_map(|(count, radius, y)| {
        let point = |k: usize| {
            let angle = (k as f64 + radius) / count as f64 * std::f64::consts::TAU;
            [radius * angle.cos(), y + radius * angle.sin()]
        };
        Shape::Polygon {
            points: (0..count).map(point).collect(),
        }
    });
    prop_oneof![
        (0.3..1.0).prop_map(|diameter| Shape::Disc { diameter }),
        (0.3..1.0, 0.3..1.0, -360.0..360.0).prop_map(|(width, height, angle_deg)| Shape::Ellipse {
            width,
            height,
            angle_deg
        }),
        polygon,
    ]
}

/// `shape` times `size`.
fn scaled(shape: &Shape, size: f64) -> Shape {
    match shape {
        Shape::Disc { diameter } => Shape::Disc {
            diameter: diameter * size,
        },
        Shape::Ellipse {
            width,
            height,
            angle_deg,
        } => Shape::Ellipse {
            width: width * size,
            height: height * size,
            angle_deg: *angle_deg,
        },
        Shape::Polygon { points } => Shape::Polygon {
            points: points.iter().map(|p| p.map(|x| x * size)).collect(),
        },
    }
}

/// A phantom that is allowed, by construction: each layer may hold some inclusions side by side, in cells of equal width.
fn phantom() -> impl Strategy<Value = Phantom> {
    let name = || "[^\\p{C}]{1,80}";
    let cells = prop::collection::vec(prop::option::of((shape(), material())), 0..4);
    let layer = (name(), 1e-6..0.1f64, material(), cells);
    let supports = prop::sample::select(vec![
        (Support::Fixed, Support::Fixed),
        (Support::Fixed, Support::Free),
        (Support::Sliding, Support::Sliding),
        (Support::Free, Support::Fixed),
    ]);
    let sizes = (0.01..1.0f64, 0.001..0.999, 1e-6..1.0);
    (name(), sizes, supports, prop::collection::vec(layer, 1..5)).prop_map(
        |(name, (width, share, length), (walls, floor), stack)| {
            let (mut layers, mut inclusions, mut top) = (vec![], vec![], 0.0);
            for (name, thickness, material, cells) in stack {
                let cell = (width - 0.0002) / cells.len() as f64;
                let size: f64 = f64::min(cell - 0.0002, 0.9).min(thickness - 0.0003);
                for (at, shape) in cells.iter().enumerate() {
                    // Edges of 0.3·2·sin(π/11)·size > 0.1 mm.
                    if let Some((shape, material)) = shape.as_ref().filter(|_| size > 0.002) {
                        inclusions.push(Inclusion {
                            centre_x: (at as f64 + 0.5) * cell - (width - 0.0002) / 2.0,
                            depth: top + 0.00015,
                            shape: scaled(shape, size),
                            material: *material,
                        });
                    }
                }
                top += thickness;
                layers.push(Layer {
                    name,
                    thickness,
                    material,
                });
            }
            let radius = 1e-6 + (width / 2.0 - 1e-6) * share;
            let (well, probe) = (
                Well {
                    width,
                    walls,
                    floor,
                },
                Probe { radius, length },
            );
            Phantom {
                name,
                well,
                layers,
                inclusions,
                probe,
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    // Verifies: PHA-006, PHA-027, PHA-029.
    #[test]
    fn any_valid_phantom_survives_the_file_to_the_bit(phantom in phantom()) {
        prop_assert_eq!(phantom.validate(), Ok(()));
        let text = phantom.to_toml().unwrap();
        // Texts as well, since −0 = 0.
        prop_assert_eq!(read(&text).unwrap().to_toml().unwrap(), text.clone());
        prop_assert_eq!(read(&text), Ok(phantom.clone()));
        let json = serde_json::to_string(&phantom).unwrap();
        prop_assert_eq!(serde_json::from_str::<Phantom>(&json).unwrap(), phantom);
    }

    // Verifies: PHA-026.
    #[test]
    fn mutated_files_never_panic(at in 0..EXAMPLE.len(), removed in 0usize..20, added: String) {
        let end = (at + removed).min(EXAMPLE.len());
        let text = format!("{}{added}{}", &EXAMPLE[..at], &EXAMPLE[end..]);
        if let Err(message) = read(&text) {
            prop_assert!(message.starts_with("gel.toml:"));
            prop_assert!(!message.contains('\n'), "{message:?}");
        }
    }

    // Verifies: PHA-026.
    #[test]
    fn mutated_tokens_never_panic(
        line in 0..29usize,
        token in "[-+0-9a-z_.=\\[\\]{}\"'#\\n,:eE]{0,12}",
    ) {
        let mut lines: Vec<&str> = EXAMPLE.lines().collect();
        lines[line] = &token;
        let _ = read(&lines.join("\n"));
    }
}
