//! Components, their rules, the bill of materials and the identity of a build (`spec/supply-chain.md`), against what cargo itself
//! says.
#![cfg(feature = "cli")]

mod bom;
mod build_script;
mod cargo;
mod components;
mod linked;
mod package;
#[path = "../witness/present.rs"]
mod present;
mod rules;

/// The root of the package.
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
