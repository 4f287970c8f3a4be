//! Components, their rules, the bill of materials and the identity of a build (`spec/supply-chain.md`), against what cargo itself
//! says.

mod bom;
mod build_script;
mod cargo;
mod components;
mod linked;
mod package;
#[path = "../../../../tests/witness/present.rs"]
mod present;
mod rules;

/// The root of the repository, and of the package `palpate`.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
