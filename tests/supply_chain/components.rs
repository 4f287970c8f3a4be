//! The table of components, and how many each layer has.

use std::collections::BTreeSet;

use palpate::verify::supply::{Component, Role, components};

use super::ROOT;
use super::cargo::{ALL, IN_THE_PROGRAM, WITHOUT_BUILD_SCRIPTS, locked, tree};

/// The layers in their order, and the features that they are built with.
const LAYERS: [(&str, &str); 8] = [
    ("core", ""),
    ("std", "std"),
    ("fem", "fem"),
    ("report", "report"),
    ("hid", "hid"),
    ("verify", "verify"),
    ("oracle", "oracle"),
    ("cli", "default"),
];

/// The names of the crates, without the package itself.
fn names(features: &'static str, edges: &'static str) -> BTreeSet<String> {
    let tree = tree(features, edges).into_keys();
    tree.filter(|name| name != "palpate").collect()
}

fn listed() -> Vec<Component> {
    components().unwrap()
}

// Verifies: EVD-060.
#[test]
fn the_table_has_what_the_program_is_made_from_and_nothing_else() {
    let built = tree("default", ALL);
    let table: BTreeSet<String> = listed().iter().map(|c| c.name.to_string()).collect();
    assert_eq!(table, names("default", ALL));
    let normal = names("default", WITHOUT_BUILD_SCRIPTS);
    let program = names("default", IN_THE_PROGRAM);
    for component in listed() {
        let name = component.name;
        assert_eq!(component.licence, built[name].licence, "{name}");
        let role = match (program.contains(name), normal.contains(name)) {
            (true, _) => Role::Program,
            (false, true) => Role::Macro,
            (false, false) => Role::Build,
        };
        assert_eq!(component.role, role, "{name}");
        let why = component.why;
        assert!(why.len() > 20 && why.ends_with('.'), "{name}: {why}");
    }
}

// Verifies: EVD-060.
#[test]
fn a_component_stands_in_the_first_layer_that_has_it() {
    let layers = LAYERS.map(|(layer, features)| (layer, names(features, ALL)));
    for component in listed() {
        let mut having = layers
            .iter()
            .filter(|(_, all)| all.contains(component.name));
        let first = having.next().map(|(layer, _)| *layer);
        assert_eq!(first, Some(component.layer), "{}", component.name);
    }
}

// Verifies: EVD-061.
#[test]
fn versions_and_checksums_are_those_that_are_built() {
    let (built, locked) = (tree("default", ALL), locked());
    for component in listed() {
        let name = component.name;
        assert_eq!(component.version, built[name].version, "{name}");
        let package = locked
            .iter()
            .find(|package| package.name == name && package.version == component.version);
        let checksum = package.and_then(|package| package.checksum.as_deref());
        assert_eq!(Some(&*component.sha256), checksum, "{name}");
        assert_eq!(component.sha256.len(), 64, "{name}");
        let told: BTreeSet<String> = component.depends_on.iter().cloned().collect();
        assert!(
            told.is_superset(&built[name].depends_on),
            "{name}: {told:?}, built with {:?}",
            built[name].depends_on
        );
    }
}

// Verifies: EVD-062.
#[test]
fn the_layers_have_as_many_crates_as_the_specification_says() {
    let spec = std::fs::read_to_string(format!("{ROOT}/spec/supply-chain.md")).unwrap();
    for (layer, features) in LAYERS {
        let row = spec
            .lines()
            .find(|line| line.starts_with(&format!("| {layer} |")))
            .unwrap_or_else(|| panic!("no row for {layer}"));
        let cells = row.split('|').map(|cell| cell.trim().parse::<usize>());
        let told: Vec<usize> = cells.flatten().collect();
        let [all, normal, program] =
            [ALL, WITHOUT_BUILD_SCRIPTS, IN_THE_PROGRAM].map(|edges| names(features, edges).len());
        assert_eq!(
            told,
            [program, normal - program, all - normal, all],
            "{layer}"
        );
    }
}
