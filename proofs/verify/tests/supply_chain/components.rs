//! The table of components, and how many each layer has.

use std::collections::{BTreeMap, BTreeSet};

use palpate_verify::supply::{Component, Role, components};

use super::ROOT;
use super::cargo::{ALL, IN_THE_PROGRAM, OURS, WITHOUT_BUILD_SCRIPTS, locked, tree};
use super::rules::rules;

/// The layers in their order, and the features that they are built with.
const LAYERS: [(&str, &str); 5] = [
    ("core", ""),
    ("std", "std"),
    ("fem", "fem"),
    ("hid", "hid"),
    ("cli", "default"),
];

/// Names and versions of the crates, without the package itself.
fn names(features: &'static str, edges: &'static str) -> BTreeSet<String> {
    let tree = tree(features, edges).into_keys();
    tree.filter(|name| name != OURS).collect()
}

fn name(component: &Component) -> String {
    format!("{} {}", component.name, component.version)
}

#[test]
fn the_table_has_what_the_program_is_made_from_and_nothing_else() {
    let built = tree("default", ALL);
    let table: BTreeSet<String> = components().unwrap().iter().map(name).collect();
    assert_eq!(table, names("default", ALL));
    let normal = names("default", WITHOUT_BUILD_SCRIPTS);
    let program = names("default", IN_THE_PROGRAM);
    for component in components().unwrap() {
        let name = &name(&component);
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

#[test]
fn a_component_stands_in_the_first_layer_that_has_it() {
    let layers = LAYERS.map(|(layer, features)| (layer, names(features, ALL)));
    for component in components().unwrap() {
        let name = &name(&component);
        let mut having = layers.iter().filter(|(_, all)| all.contains(name));
        let first = having.next().map(|(layer, _)| *layer);
        assert_eq!(first, Some(component.layer), "{}", component.name);
    }
}

#[test]
fn versions_and_checksums_are_those_that_are_built() {
    let (built, locked) = (tree("default", ALL), locked());
    for component in components().unwrap() {
        let name = &name(&component);
        let package = locked
            .iter()
            .find(|package| format!("{} {}", package.name, package.version) == *name);
        let checksum = package.and_then(|package| package.checksum.as_deref());
        assert_eq!(Some(&*component.sha256), checksum, "{name}");
        assert_eq!(component.sha256.len(), 64, "{name}");
        // The lock file leaves out a version that is the only one.
        let told = &component.depends_on;
        for asked in &built[name].depends_on {
            let short = asked.split(' ').next().unwrap();
            let known = told.iter().any(|told| told == asked || told == short);
            assert!(known, "{name}: {told:?}, built with {asked}");
        }
    }
}

#[test]
fn a_crate_has_several_versions_only_where_specification_and_rules_say_so() {
    let mut versions: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for Component { name, version, .. } in components().unwrap() {
        // `1`, or `0.2`: what may take another's place.
        let words = if version.starts_with("0.") { 2 } else { 1 };
        let series: Vec<&str> = version.split('.').take(words).collect();
        versions.entry(name).or_default().push(series.join("."));
    }
    versions.retain(|_, series| series.len() > 1);
    let spec = std::fs::read_to_string(format!("{ROOT}/spec/supply-chain.md")).unwrap();
    let (_, table) = spec.split_once("| crate | versions |").unwrap();
    let rows = table
        .lines()
        .skip(2)
        .map_while(|row| row.rsplit_once(" | "));
    let row = |(name, series): (&&str, &Vec<String>)| format!("| {name} | {}", series.join(", "));
    assert!(rows.map(|row| row.0).eq(versions.iter().map(row)));
    // The newest of each needs no leave.
    let rules = rules();
    let skip = rules["bans"]["skip"].as_array().unwrap().iter();
    let old = versions.iter().flat_map(|(name, series)| {
        let (_, old) = series.split_last().unwrap();
        old.iter().map(move |series| format!("{name}@{series}"))
    });
    assert!(
        skip.map(|entry| entry["crate"].as_str().unwrap().to_string())
            .eq(old)
    );
}

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
