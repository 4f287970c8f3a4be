//! Other programs' answers to our own models (`spec/verification.md`): CalculiX for the forces on the
//! probe, scikit-fem for the stiffness matrix. A program that is not installed is skipped with a notice,
//! unless `PALPATE_REQUIRE_WITNESSES=1` asks for all of them.

mod calculix;
mod deck;
mod scikit_fem;

use std::io::Write;

use palpate::fem::mesh::Region;
use palpate::phantom::{Material, Phantom};

/// Whether a test goes on. `missing` says which program is not there, if one is not.
fn present(missing: Option<&str>) -> bool {
    let Some(program) = missing else { return true };
    let required = std::env::var_os("PALPATE_REQUIRE_WITNESSES").is_some_and(|value| value == "1");
    assert!(
        !required,
        "{program} is not installed, but PALPATE_REQUIRE_WITNESSES=1 asks for it"
    );
    #[allow(clippy::explicit_write)]
    // Not by eprintln!, which the test runner keeps to itself when a test passes.
    writeln!(std::io::stderr(), "SKIPPED: {program} is not installed").unwrap();
    false
}

/// What a region is made of, by the phantom alone: the library's own choice is among the things that are checked.
fn material(phantom: &Phantom, region: Region) -> Material {
    match (region, &phantom.inclusion) {
        (Region::Skin, _) => phantom.skin.material,
        (Region::Disc, Some(inclusion)) => inclusion.material,
        (Region::Disc, None) | (Region::Gel, _) => phantom.gel.material,
    }
}
