//! Components, their rules and the identity of a build (`spec/supply-chain.md`), against what cargo itself
//! says.

mod build_script;
mod cargo;
mod components;
mod linked;
mod package;
mod rules;

/// The root of the repository, and of the package `palpate`.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
