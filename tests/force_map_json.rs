//! Force maps as JSON through the public interface.

use palpate::force::Force;
use palpate::force_map::{
    Certificate, ForceMap, ForceTable, Matrix, Measurement, SCHEMA, SCHEMA_VERSION, SmallestDet,
    Source,
};
use palpate::phantom::Phantom;
use palpate_asserts::{assert_cases, axis, changed, finite, seeded};
use proptest::prelude::*;

/// The file of [`computed`], written by hand from the spec.
const EXAMPLE: &str = include_str!("force_map_json/example.json");

fn example() -> String {
    EXAMPLE.replace("VERSION", env!("CARGO_PKG_VERSION"))
}

fn matrix<const N: usize>(rows: &[[f64; N]]) -> Matrix {
    Matrix::new(N, rows.concat()).unwrap()
}

fn certificate() -> Certificate {
    Certificate {
        worst_relative_residual: 1e-13,
        worst_force_balance: 2e-10,
        largest_penetration: 0.0,
        newton_iterations: 40,
        mesh_size: 0.0005,
        nodes: 6000,
        elements: 3000,
        element: "t6".into(),
        contact: "deformed-normal".into(),
        law: None,
        arithmetic: "other".into(),
        smallest_det: SmallestDet {
            det: 0.5,
            depth: 0.002,
            lateral: 0.0,
        },
        min_det: matrix(&[[1.0, 0.9, 0.8], [0.5, 0.7, 0.6]]),
        discretization: None,
    }
}

fn computed() -> ForceMap {
    let forces = ForceTable::new(
        vec![0.001, 0.002],
        vec![0.0, 0.005, 0.01],
        Force::new(
            matrix(&[[0.0, -1e-9, 1e21], [0.0, 0.2, 0.3]]),
            matrix(&[[0.25, 0.5, 1.0], [0.1 + 0.2, 5e-324, -0.0]]),
        ),
    );
    let certificate = certificate();
    let source = Source::FiniteElements { certificate };
    ForceMap::new(source, Phantom::builtin("none").ok(), forces.unwrap()).unwrap()
}

fn read(text: &str) -> Result<ForceMap, String> {
    ForceMap::from_json(text, "map.json").map_err(|error| error.to_string())
}

/// Maps are compared by their text too: `==` holds −0 and 0 for equal.
fn assert_same(read: &ForceMap, written: &ForceMap) {
    assert_eq!(read, written);
    let bits =
        |matrix: &Matrix| -> Vec<_> { matrix.values().iter().map(|v| v.to_bits()).collect() };
    let [read, written] = [read, written].map(|map| map.table().both().unwrap().map(bits));
    assert_eq!(read, written);
}

// Verifies: MAP-020, MAP-022, PHA-029.
#[test]
fn a_computed_map_is_written_as_the_spec_says_and_read_back() {
    assert_eq!((SCHEMA, SCHEMA_VERSION), ("palpate-force-map", 1));
    assert_eq!(computed().to_json(), example());
    assert_same(&read(&example()).unwrap(), &computed());
}

// Verifies: MAP-020, MAP-022, MAP-002, MAP-074.
#[test]
fn a_measured_map_is_written_and_read_back() {
    let source = Measurement::new("gel \"1\".csv", "ATI\nsensor");
    let map = |source| {
        let source = Source::Measured(source);
        ForceMap::new(source, None, computed().table().clone())
    };
    let smoothed = |half_width| Measurement {
        smoothed_half_width: Some(half_width),
        ..source.clone()
    };
    let text = map(smoothed(0.0025)).unwrap().to_json();
    assert!(text.contains("\"smoothed_half_width_m\": 0.0025"));
    assert_same(&read(&text).unwrap(), &map(smoothed(0.0025)).unwrap());
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = map(smoothed(wrong)).unwrap_err().to_string();
        let expected = format!("source.smoothed_half_width_m = {wrong}, but must be a finite");
        assert!(error.starts_with(&expected), "{error}");
    }
    let map = map(source).unwrap();
    let text = map.to_json();
    assert!(!text.contains("smoothed"));
    assert!(text.contains("\"kind\": \"measured\""));
    assert!(text.contains("\"phantom\": null") && text.contains("\"certificate\": null"));
    assert_same(&read(&text).unwrap(), &map);
    let short = text
        .replace("  \"phantom\": null,\n", "")
        .replace(",\n  \"certificate\": null", "");
    assert_eq!(short.lines().count() + 2, text.lines().count());
    assert_same(&read(&short).unwrap(), &map);
}

// Verifies: MAP-020.
#[test]
fn the_version_that_made_a_map_stays_with_it() {
    let old = EXAMPLE.replace("VERSION", "0.0.7");
    let map = read(&old).unwrap();
    assert_eq!(map.program_version(), "0.0.7");
    assert_eq!(map.to_json(), old);
    assert_eq!(map.mirrored().unwrap().program_version(), "0.0.7");
}

// Verifies: MAP-024, MAP-026.
#[test]
fn other_schemas_and_newer_versions_are_refused_first() {
    for version in ["2", "\"1\"", "0", "1.5"] {
        // A newer file has keys that we do not know, and lacks some that we do.
        let text =
            format!("{{\"schema_version\": {version}, \"new\": [], \"schema\": {SCHEMA:?}}}");
        let expected = "but must be 1, which is what this program reads";
        let expected = format!("map.json: schema_version = {version}, {expected}");
        assert_eq!(read(&text), Err(expected));
    }
    let none = r#"map.json: schema = null, but must be "palpate-force-map""#;
    assert_eq!(read("{}"), Err(none.into()));
}

// Verifies: MAP-024, MAP-026.
#[test]
fn every_required_key_is_missed_by_name() {
    let example = example();
    let object: serde_json::Value = serde_json::from_str(&example).unwrap();
    for key in "program_version source depths_m laterals_m normal_force_n".split(' ') {
        let mut without = object.clone();
        without.as_object_mut().unwrap().remove(key).unwrap();
        let message = read(&without.to_string()).unwrap_err();
        assert!(message.starts_with("map.json:1: "), "{message}");
        let missing = format!(": {key} is missing");
        assert!(message.contains(&missing), "{message}");
    }
    // A measured map may lack it.
    let mut without = object.clone();
    without.as_object_mut().unwrap().remove("lateral_force_n");
    let message = read(&without.to_string()).unwrap_err();
    let expected = "map.json: lateral_force_n is missing; give both forces of a computed map";
    assert_eq!(message, expected);
}

// Verifies: MAP-002, MAP-024, MAP-026.
#[test]
fn what_is_wrong_is_named_by_key_and_row() {
    let refusal = |change: &str| read(&changed(&example(), change)).unwrap_err();
    assert_cases("refused/map_json.txt", "changes", refusal);
}

// Verifies: MAP-002.
#[test]
fn a_certificate_comes_with_finite_elements() {
    let (before, _) = EXAMPLE.split_once(",\n  \"certificate\"").unwrap();
    let expected = "map.json: certificate is missing; give it with a map from finite elements";
    assert_eq!(read(&format!("{before}}}")), Err(expected.into()));
}

// Verifies: MAP-026.
#[test]
fn what_is_no_json_is_refused_with_its_line() {
    let message = read("").unwrap_err();
    let expected = "map.json:1: column 0: EOF while parsing";
    assert!(message.starts_with(expected), "{message}");
    assert!(read("[1]").is_err() && read("null").is_err());
    let one_line = example().replace('\n', "");
    assert_eq!(read(&one_line).map(|_| ()), Ok(()));
    // Of one long line the message shows the place alone.
    let message = read(&one_line.replace("0.034", "null")).unwrap_err();
    let (_, excerpt) = message.split_once(", in ").unwrap();
    let is_short = excerpt.contains(r#"\"width_m\": null"#) && excerpt.len() < 80;
    assert!(is_short, "{message}");
    let folder = std::env::temp_dir();
    let error = ForceMap::read(&folder.join("palpate-no-such-map.json")).unwrap_err();
    let expected = "palpate-no-such-map.json: cannot be read: ";
    assert!(error.to_string().contains(expected), "{error}");
}

fn any_map() -> impl Strategy<Value = ForceMap> {
    (1usize..5, 1usize..5).prop_flat_map(|(rows, columns)| {
        let values = || prop::collection::vec(finite(), rows * columns);
        let matrix = || values().prop_map(move |values| Matrix::new(columns, values).unwrap());
        let numbers = (0.0..1.0, 0.0..1e-3, 0.0..1e-6, any::<u32>(), 1e-6..1e-3);
        let axis = |length| {
            let steps = prop::collection::vec(1e-4..2e-3, length);
            steps.prop_map(|steps| axis(0.0, &steps))
        };
        let axes = (axis(rows), axis(columns));
        let matrices = (matrix(), matrix(), matrix());
        (axes, matrices, numbers, ".*").prop_map(map_of)
    })
}

type Axes = (Vec<f64>, Vec<f64>);
type Matrices = (Matrix, Matrix, Matrix);
type Numbers = (f64, f64, f64, u32, f64);

fn map_of((axes, matrices, numbers, element): (Axes, Matrices, Numbers, String)) -> ForceMap {
    let ((depths, laterals), (normal, lateral, min_det)) = (axes, matrices);
    let certificate = Certificate {
        worst_relative_residual: numbers.0,
        worst_force_balance: numbers.1,
        largest_penetration: numbers.2,
        newton_iterations: numbers.3 as usize,
        mesh_size: numbers.4,
        element,
        contact: String::new(),
        smallest_det: SmallestDet::of(&min_det, &depths, &laterals).unwrap(),
        min_det,
        ..certificate()
    };
    let forces = ForceTable::new(depths, laterals, Force::new(lateral, normal)).unwrap();
    let source = Source::FiniteElements { certificate };
    ForceMap::new(source, Phantom::builtin("8.6").ok(), forces).unwrap()
}

proptest! {
    #![proptest_config(seeded(4))]

    // Verifies: MAP-022.
    #[test]
    fn any_map_survives_the_file_to_the_bit(map in any_map()) {
        let back = read(&map.to_json()).unwrap();
        assert_same(&back, &map);
        prop_assert_eq!(back.to_json(), map.to_json());
    }

    // Verifies: MAP-026, MAP-037.
    #[test]
    fn mutated_files_never_panic(at in 0..EXAMPLE.len(), removed in 0usize..20, added: String) {
        let end = (at + removed).min(EXAMPLE.len());
        let text = format!("{}{added}{}", &EXAMPLE[..at], &EXAMPLE[end..]);
        if let Err(message) = read(&text) {
            prop_assert!(message.starts_with("map.json:"));
            prop_assert!(!message.contains('\n'), "{message:?}");
        }
    }
}
