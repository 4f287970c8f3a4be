//! Phantom files through the public interface.
#![cfg(feature = "std")]

use palpate::phantom::{
    BUILTIN_NAMES, Gel, Inclusion, Material, Phantom, PhantomFileProblem, Probe, Skin,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// The example of `spec/phantom.md`, which is the built-in phantom `2.6`.
const EXAMPLE: &str = r#"name = "2.6"

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

/// The error for the example with `old` replaced by `new`.
fn refusal(old: &str, new: &str) -> String {
    assert_eq!(EXAMPLE.matches(old).count(), 1, "{old:?}");
    let message = read(&EXAMPLE.replace(old, new)).unwrap_err();
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

// Verifies: PHA-021.
#[test]
fn the_example_of_the_spec_is_this_one() {
    let spec = include_str!("../spec/phantom.md");
    let block = spec.split("```toml\n").nth(1).unwrap();
    let block = block.split("```").next().unwrap();
    assert_eq!(read(block), read(EXAMPLE));
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
        gel.width_mm = 34\ngel.height_mm = 15\n\
        gel.youngs_modulus_kpa = 5\ngel.poisson_ratio = 49e-2\n\
        [inclusion]\npoisson_ratio = 0.49\ndepth_mm = 2.6\n\
        youngs_modulus_kpa = 1_200\ndiameter_mm = 6.4\n\
        [skin]\nthickness_mm = 5e-1\nyoungs_modulus_kpa = 0.18e3\npoisson_ratio = +0.49\n";
    assert_eq!(read(text), Ok(Phantom::builtin("2.6").unwrap()));
    let crlf = EXAMPLE.replace('\n', "\r\n");
    assert_eq!(read(&crlf), Ok(Phantom::builtin("2.6").unwrap()));
}

// Verifies: PHA-022, PHA-026.
#[test]
fn unknown_keys_are_named_with_the_allowed_ones() {
    assert_eq!(
        refusal("width_mm = 34.0", "width_m = 0.034"),
        "gel.toml:4: unknown key \"gel.width_m\", \
         allowed: width_mm, height_mm, youngs_modulus_kpa, poisson_ratio"
    );
    assert_eq!(
        refusal("[inclusion]", "[inclusions]"),
        "gel.toml:14: unknown key \"inclusions\", allowed: name, gel, skin, inclusion, probe"
    );
    assert!(refusal("radius_mm", "\"a\\nb\" = 1\nradius_mm").contains(r#""probe.a\nb""#));
}

// Verifies: PHA-023, PHA-026.
#[test]
fn every_missing_key_is_named() {
    let mut table = String::new();
    let mut start = 0;
    for line in EXAMPLE.split_inclusive('\n') {
        let end = start + line.len();
        if let Some(header) = line.strip_prefix('[') {
            table = header.trim().replace(']', ".");
        } else if let Some((key, _)) = line.split_once(' ') {
            let message = read(&format!("{}{}", &EXAMPLE[..start], &EXAMPLE[end..])).unwrap_err();
            let expected = format!(": {table}{key} is missing, expected a ");
            assert!(message.contains(&expected), "{message}");
        }
        start = end;
    }
    let no_probe = EXAMPLE.split("[probe]").next().unwrap();
    assert_eq!(
        read(no_probe),
        Err("gel.toml: probe is missing, expected a table".into())
    );
    assert_eq!(
        refusal("height_mm = 15.0\n", ""),
        "gel.toml:3: gel.height_mm is missing, expected a number"
    );
}

// Verifies: PHA-024, PHA-026.
#[test]
fn wrong_types_are_named_with_their_value() {
    for (value, shown) in [
        ("\"34\"", "\"34\""),
        ("true", "true"),
        ("nan", "nan"),
        ("+inf", "+inf"),
        ("1e400", "1e400"),
        ("0x22", "0x22"),
        ("[34.0]", "an array"),
        ("{mm = 34.0}", "a table"),
        ("1999-11-14", "a date"),
    ] {
        assert_eq!(
            refusal("width_mm = 34.0", &format!("width_mm = {value}")),
            format!("gel.toml:4: gel.width_mm = {shown}, expected a finite decimal number")
        );
    }
    assert_eq!(
        refusal("name = \"2.6\"", "name = 2.6"),
        "gel.toml:1: name = 2.6, expected a string"
    );
    let flat = EXAMPLE.replace("[probe]\nradius_mm = 6.5\nlength_mm = 30.0\n", "");
    assert_eq!(
        read(&format!("probe = 13\n{flat}")),
        Err("gel.toml:1: probe = 13, expected a table".into())
    );
}

// Verifies: PHA-025, PHA-026.
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
    assert_eq!(
        refusal("diameter_mm = 6.4", "diameter_mm = 15"),
        "gel.toml:15: inclusion.diameter_mm = 15.0, allowed: at least 0.001 and at most 14.8 \
         (at least 0.1 mm of gel must lie between the inclusion and the skin, the floor and each \
         wall)"
    );
    assert_eq!(
        refusal("name = \"2.6\"", "# a comment\nname = \"\""),
        "gel.toml:2: name = \"\", allowed: 1 to 80 characters, none of them a control character"
    );
    assert!(refusal("length_mm = 30.0", "length_mm = -0.0").starts_with("gel.toml:22: probe.len"));
}

// Verifies: PHA-026.
#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = std::env::temp_dir();
    let error = Phantom::read(&folder.join("palpate-no-such-phantom.toml")).unwrap_err();
    assert!(matches!(error.problem, PhantomFileProblem::Read(_)));
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
    phantom.skin.thickness = f64::NAN;
    assert!(phantom.to_toml().is_err());
}

fn material() -> impl Strategy<Value = Material> {
    (1e-3..1e12, -0.999..0.4995).prop_map(|(youngs_modulus, poisson_ratio)| Material {
        youngs_modulus,
        poisson_ratio,
    })
}

/// Any phantom that is allowed, by construction: lengths as shares of what is left.
fn phantom() -> impl Strategy<Value = Phantom> {
    let shares = prop::array::uniform3(0.001..0.999);
    let sizes = (0.001..1.0, 0.001..0.5, 1e-6..0.5, 1e-6..1.0);
    let materials = (material(), material(), prop::option::of(material()));
    ("[^\\p{C}]{1,80}", sizes, shares, materials).prop_map(
        |(name, (width, height, thickness, length), shares, (gel, skin, disc))| Phantom {
            name,
            gel: Gel {
                width,
                height,
                material: gel,
            },
            skin: Skin {
                thickness,
                material: skin,
            },
            inclusion: disc.map(|material| {
                let room = width.min(height) - 0.0002;
                let diameter = 1e-6 + (room - 1e-6) * shares[0];
                let slack = height - 0.0002 - diameter;
                Inclusion {
                    diameter,
                    depth: thickness + 0.0001 + slack * shares[1],
                    material,
                }
            }),
            probe: Probe {
                radius: 1e-6 + (width / 2.0 - 1e-6) * shares[2],
                length,
            },
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    // Verifies: PHA-006, PHA-027.
    #[test]
    fn any_valid_phantom_survives_the_file_to_the_bit(phantom in phantom()) {
        prop_assert_eq!(phantom.validate(), Ok(()));
        let text = phantom.to_toml().unwrap();
        // Floats compare equal here only if their bits do: none of them is zero or NaN.
        prop_assert_eq!(read(&text), Ok(phantom));
    }

    // Verifies: PHA-026, PHA-028.
    #[test]
    fn mutated_files_never_panic(at in 0..EXAMPLE.len(), removed in 0usize..20, added: String) {
        let end = (at + removed).min(EXAMPLE.len());
        let text = format!("{}{added}{}", &EXAMPLE[..at], &EXAMPLE[end..]);
        if let Err(message) = read(&text) {
            prop_assert!(message.starts_with("gel.toml:"));
            prop_assert!(!message.contains('\n'), "{message:?}");
        }
    }

    // Verifies: PHA-028.
    #[test]
    fn mutated_tokens_never_panic(
        line in 0..22usize,
        token in "[-+0-9a-z_.=\\[\\]{}\"'#\\n,:eE]{0,12}",
    ) {
        let mut lines: Vec<&str> = EXAMPLE.lines().collect();
        lines[line] = &token;
        let _ = read(&lines.join("\n"));
    }
}
