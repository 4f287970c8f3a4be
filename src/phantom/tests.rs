use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::decimal::{format_scaled, parse_scaled};
use super::*;

/// The paper's phantom with the inclusion at 2.6 mm, to be spoilt.
fn paper() -> Phantom {
    Phantom::builtin("2.6").unwrap()
}

/// `paper` after `change`.
fn changed(change: impl FnOnce(&mut Phantom)) -> Phantom {
    let mut phantom = paper();
    change(&mut phantom);
    phantom
}

fn with_disc(diameter: f64, depth: f64) -> Phantom {
    changed(|p| {
        let disc = p.inclusion.as_mut().unwrap();
        disc.diameter = diameter;
        disc.depth = depth;
    })
}

fn refusal(phantom: &Phantom) -> String {
    phantom.validate().unwrap_err().to_string()
}

// Verifies: PHA-001, PHA-002, CON-001.
#[test]
fn built_in_phantoms_are_the_papers() {
    assert_eq!(BUILTIN_NAMES, ["none", "2.6", "4.6", "6.6", "8.6"]);
    // Paper §3 and §3.1, in its own units.
    let near = |si: f64, written: f64| (si / written - 1.0).abs() < 1e-15;
    for name in BUILTIN_NAMES {
        let phantom = Phantom::builtin(name).unwrap();
        assert_eq!(phantom.validate(), Ok(()), "{name}");
        assert_eq!(phantom.name, name);
        assert!(near(phantom.gel.width * 1e3, 34.0));
        assert!(near(phantom.gel.height * 1e3, 15.0));
        assert!(near(phantom.skin.thickness * 1e3, 0.5));
        assert!(near(phantom.probe.radius * 1e3, 13.0 / 2.0));
        assert!(near(phantom.probe.length * 1e3, 30.0));
        let elastic = |m: Material| (m.youngs_modulus, m.poisson_ratio);
        assert_eq!(elastic(phantom.gel.material), (5000.0, 0.49));
        assert_eq!(elastic(phantom.skin.material), (180_000.0, 0.49));
        let Some(disc) = phantom.inclusion else {
            assert_eq!(name, "none");
            continue;
        };
        assert!(near(disc.diameter * 1e3, 6.4));
        assert!(near(disc.depth * 1e3, name.parse().unwrap()));
        assert_eq!(elastic(disc.material), (1_200_000.0, 0.49));
    }
    assert!(paper().inclusion.is_some());
}

// Verifies: PHA-014.
#[test]
fn other_names_are_refused_with_the_list() {
    let message = Phantom::builtin("2.60").unwrap_err().to_string();
    assert_eq!(
        message,
        "no phantom named \"2.60\" is built in; built in are none, 2.6, 4.6, 6.6, 8.6"
    );
}

/// Every number of a phantom, with its key in the file.
fn numbers(phantom: &mut Phantom) -> Vec<(&'static str, &mut f64)> {
    let disc = phantom.inclusion.as_mut().unwrap();
    vec![
        ("gel.width_mm", &mut phantom.gel.width),
        ("gel.height_mm", &mut phantom.gel.height),
        (
            "gel.youngs_modulus_kpa",
            &mut phantom.gel.material.youngs_modulus,
        ),
        ("gel.poisson_ratio", &mut phantom.gel.material.poisson_ratio),
        ("skin.thickness_mm", &mut phantom.skin.thickness),
        (
            "skin.youngs_modulus_kpa",
            &mut phantom.skin.material.youngs_modulus,
        ),
        (
            "skin.poisson_ratio",
            &mut phantom.skin.material.poisson_ratio,
        ),
        ("inclusion.diameter_mm", &mut disc.diameter),
        ("inclusion.depth_mm", &mut disc.depth),
        (
            "inclusion.youngs_modulus_kpa",
            &mut disc.material.youngs_modulus,
        ),
        ("inclusion.poisson_ratio", &mut disc.material.poisson_ratio),
        ("probe.radius_mm", &mut phantom.probe.radius),
        ("probe.length_mm", &mut phantom.probe.length),
    ]
}

/// The refusal of the paper's phantom with number `index` set to `value`, and that number's key.
fn refusal_with(index: usize, value: f64) -> (String, &'static str) {
    let mut phantom = paper();
    let key = {
        let mut all = numbers(&mut phantom);
        *all[index].1 = value;
        all[index].0
    };
    (refusal(&phantom), key)
}

// Verifies: PHA-003, PHA-009, CON-007.
#[test]
fn numbers_that_are_not_finite_are_refused_by_key() {
    let count = numbers(&mut paper()).len();
    for index in 0..count {
        for (value, text) in [
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
            (-f64::INFINITY, "-inf"),
        ] {
            let (message, key) = refusal_with(index, value);
            let expected = format!("{key} = {text}, allowed: ");
            assert!(message.starts_with(&expected), "{message}");
        }
    }
}

// Verifies: PHA-004, PHA-005, PHA-009.
#[test]
fn lengths_and_moduli_of_zero_or_below_are_refused() {
    let count = numbers(&mut paper()).len();
    for index in 0..count {
        for value in [0.0, -0.0, -1.5] {
            let mut phantom = paper();
            if numbers(&mut phantom)[index].0.ends_with("ratio") {
                continue;
            }
            let (message, key) = refusal_with(index, value);
            assert!(message.starts_with(&format!("{key} = ")), "{message}");
        }
    }
}

// Verifies: PHA-004, PHA-005, PHA-007, PHA-009.
#[test]
fn messages_give_value_and_range_in_the_files_unit() {
    assert_eq!(
        refusal(&changed(|p| p.gel.width = 34.0)),
        "gel.width_mm = 34000.0, allowed: at least 0.001 and at most 1000.0"
    );
    assert_eq!(
        refusal(&changed(|p| p.skin.material.youngs_modulus = -180e3)),
        "skin.youngs_modulus_kpa = -180.0, allowed: above 0.0"
    );
    assert_eq!(
        refusal(&changed(|p| p.gel.material.poisson_ratio = 0.5)),
        "gel.poisson_ratio = 0.5, allowed: above -1.0 and at most 0.4995"
    );
    assert_eq!(
        refusal(&changed(|p| p.probe.radius = 0.017)),
        "probe.radius_mm = 17.0, allowed: at least 0.001 and below 17.0 \
         (the probe must be narrower than the well)"
    );
}

// Verifies: PHA-004, PHA-005, PHA-007.
#[test]
fn the_ends_of_the_ranges_are_where_the_spec_says() {
    let poisson = |ratio| {
        changed(|p| p.gel.material.poisson_ratio = ratio)
            .validate()
            .is_ok()
    };
    assert!(poisson(0.4995) && poisson(-0.9999) && poisson(0.0));
    assert!(!poisson(0.49951) && !poisson(-1.0) && !poisson(-1.5));
    let radius = |radius| changed(|p| p.probe.radius = radius).validate().is_ok();
    assert!(radius(0.016_999) && !radius(0.017) && !radius(0.018));
    let skin = |thickness| {
        let thin = |p: &mut Phantom| p.skin.thickness = thickness;
        changed(thin).validate().is_ok()
    };
    assert!(skin(1e-6) && !skin(0.99e-6));
    let length = |length| changed(|p| p.probe.length = length).validate().is_ok();
    assert!(length(1.0) && !length(1.000_001));
}

// Verifies: PHA-006, PHA-015.
#[test]
fn an_inclusion_keeps_its_clearance_from_skin_floor_and_walls() {
    let fits = |diameter, depth| with_disc(diameter, depth).validate().is_ok();
    // Skin: 0.5 mm of skin and 0.1 mm of gel above the disc.
    assert!(fits(0.0064, 0.0006) && !fits(0.0064, 0.000_599));
    // Floor: 15.5 − 6.4 − 0.1 = 9.0 mm.
    assert!(fits(0.0064, 0.009) && !fits(0.0064, 0.009_001));
    // Skin and floor at once: 15.0 − 0.2 = 14.8 mm.
    assert!(fits(0.0148, 0.0006) && !fits(0.014_801, 0.0006));
    // Walls: a well of 10 mm holds a disc of 9.8 mm.
    let in_narrow_well = |diameter| {
        let mut phantom = with_disc(diameter, 0.002);
        phantom.gel.width = 0.01;
        phantom.probe.radius = 0.002;
        phantom.validate().is_ok()
    };
    assert!(in_narrow_well(0.0098) && !in_narrow_well(0.009_801));
}

// Verifies: PHA-006, PHA-009.
#[test]
fn the_clearance_is_in_the_message() {
    let why = "(at least 0.1 mm of gel must lie between the inclusion and the skin, \
               the floor and each wall)";
    assert_eq!(
        refusal(&with_disc(0.0064, 0.012)),
        format!("inclusion.depth_mm = 12.0, allowed: at least 0.6 and at most 9.0 {why}")
    );
    assert_eq!(
        refusal(&with_disc(0.015, 0.0026)),
        format!("inclusion.diameter_mm = 15.0, allowed: at least 0.001 and at most 14.8 {why}")
    );
    let mut shallow = paper();
    shallow.gel.height = 0.0001;
    assert_eq!(
        refusal(&shallow),
        format!("inclusion.diameter_mm = 6.4, allowed: nothing {why}")
    );
}

// Verifies: PHA-010.
#[test]
fn names_that_break_a_table_are_refused() {
    let named = |name: &str| changed(|p| p.name = name.into()).validate().is_ok();
    assert!(named("a") && named(&"ü".repeat(80)));
    assert!(!named("") && !named("a\nb") && !named("\u{7}") && !named(&"a".repeat(81)));
}

// Verifies: PHA-008.
#[test]
fn the_disc_lies_below_the_surface_by_depth_and_radius() {
    let phantom = paper();
    let disc = phantom.inclusion.unwrap();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-17;
    assert!(close(phantom.total_height(), 0.0155));
    assert!(close(disc.radius(), 0.0032));
    assert!(close(disc.centre_y(), -0.0058)); // −(2.6 + 3.2) mm
}

// Verifies: PHA-011, PHA-013.
#[test]
fn depths_outside_the_gel_are_refused() {
    let phantom = paper();
    for depth in [0.0, 0.004, 0.015_499] {
        assert_eq!(phantom.check_depth(depth), Ok(()));
    }
    let message = |depth| phantom.check_depth(depth).unwrap_err().to_string();
    let allowed = "allowed: at least 0 and below 15.5, the height of gel and skin";
    assert_eq!(message(-0.001), format!("depth_mm = -1, {allowed}"));
    assert_eq!(message(0.0155), format!("depth_mm = 15.5, {allowed}"));
    assert_eq!(
        message(f64::NAN),
        "depth_mm = NaN, allowed: a finite number"
    );
    assert_eq!(
        message(f64::INFINITY),
        "depth_mm = inf, allowed: a finite number"
    );
    assert!(message(1e300).starts_with("depth_mm = 1e303, "));
}

// Verifies: PHA-012, PHA-013.
#[test]
fn a_probe_that_reaches_a_wall_is_refused() {
    let phantom = paper();
    let stands = |depth, lateral| phantom.check_pose(depth, lateral).is_ok();
    // d = 4 mm: w² = 6.5² − 2.5² = 6², so |x| < 17 − 6 = 11 mm.
    assert!(stands(0.004, 0.010_999) && stands(0.004, -0.010_999));
    assert!(!stands(0.004, 0.011_001) && !stands(0.004, -0.011_001));
    // At the surface the probe is a line, below its radius it is 13 mm wide.
    assert!(stands(0.0, 0.016_999) && !stands(0.0, 0.017));
    assert!(stands(0.0065, 0.010_499) && !stands(0.0065, 0.010_501));
    assert!(stands(0.012, 0.010_499) && !stands(0.012, 0.010_501));
    let message = |depth, lateral| phantom.check_pose(depth, lateral).unwrap_err().to_string();
    assert!(message(0.0155, 0.0).starts_with("depth_mm = 15.5, allowed: "));
    assert!(message(-0.001, 0.0).starts_with("depth_mm = -1, allowed: "));
    for bad in [f64::NAN, f64::INFINITY] {
        let expected = format!("lateral_mm = {bad}, allowed: a finite number");
        assert_eq!(message(0.004, bad), expected);
    }
    assert_eq!(
        message(0.004, -0.012),
        "lateral_mm = -12, allowed at depth_mm = 4: above -11 and below 11, \
         where the probe, there 6 mm to each side, clears the walls"
    );
}

// Verifies: PHA-029.
#[test]
fn in_json_a_phantom_has_si_units_in_its_keys() {
    let expected = serde_json::json!({
        "name": "2.6",
        "gel": {"width_m": 0.034, "height_m": 0.015,
            "material": {"youngs_modulus_pa": 5000.0, "poisson_ratio": 0.49}},
        "skin": {"thickness_m": 0.0005,
            "material": {"youngs_modulus_pa": 180000.0, "poisson_ratio": 0.49}},
        "inclusion": {"diameter_m": 0.0064, "depth_m": 0.0026,
            "material": {"youngs_modulus_pa": 1200000.0, "poisson_ratio": 0.49}},
        "probe": {"radius_m": 0.0065, "length_m": 0.03}
    });
    assert_eq!(serde_json::to_value(paper()).unwrap(), expected);
    let empty = serde_json::to_value(Phantom::builtin("none").unwrap()).unwrap();
    assert_eq!(empty["inclusion"], serde_json::Value::Null);
}

// Verifies: PHA-020.
#[test]
fn scaled_decimals_are_the_nearest_floats() {
    // The right-hand sides are rounded by the compiler. A product of floats with 1e-3 misses the
    // first two, a quotient of floats by 1000 the next two.
    for (text, power, expected) in [
        ("2.6", -3, 0.0026),
        ("6.5", -3, 0.0065),
        ("1.0566132852391916", -3, 0.0010566132852391916),
        ("1.7672673511353922", -3, 0.0017672673511353922),
        ("34", -3, 0.034),
        ("-0.5", -3, -0.0005),
        ("+1.5e-3", 3, 1.5),
        ("1.2e3", 3, 1.2e6),
        ("1E2", -3, 0.1),
        (".5", 0, 0.5),
        ("5.", 0, 5.0),
    ] {
        assert_eq!(parse_scaled(text, power), Some(expected), "{text}e{power}");
    }
}

// Verifies: PHA-003, PHA-020, PHA-024.
#[test]
fn what_is_no_finite_decimal_is_no_number() {
    for text in [
        "",
        " 1",
        "nan",
        "NaN",
        "inf",
        "-inf",
        "infinity",
        "1e400",
        "1e99999999999",
        "0x10",
        "1,5",
        "1_000",
        "e5",
        "1e",
        ".",
        "--1",
        "1e2147483647",
    ] {
        assert_eq!(parse_scaled(text, 3), None, "{text:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    // Verifies: PHA-020.
    #[test]
    fn scaling_back_gives_the_same_bits(bits: u64, power in -3..=3) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        // Also where the other unit has no such float: the text has every digit.
        let text = format_scaled(value, power);
        prop_assert_eq!(parse_scaled(&text, -power).map(f64::to_bits), Some(bits));
    }

    // Verifies: PHA-020.
    #[test]
    fn scaling_moves_the_decimal_point(digits in "[1-9][0-9]{6,18}", decimals in 0usize..4) {
        // Independent of exponents: the point moved by hand, then read by the standard library.
        let with_decimals = |count| {
            let (whole, decimals) = digits.split_at(digits.len() - count);
            format!("{whole}.{decimals}")
        };
        let moved: f64 = with_decimals(decimals + 3).parse().unwrap();
        prop_assert_eq!(parse_scaled(&with_decimals(decimals), -3), Some(moved));
    }

    // Verifies: PHA-020.
    #[test]
    fn no_text_makes_the_number_reader_panic(
        text in "(\\PC{0,8}|[-+]?[0-9.]{0,5}[eE][-+]?[0-9]{0,12})",
        power in -3..=3,
    ) {
        let _ = parse_scaled(&text, power);
    }
}
