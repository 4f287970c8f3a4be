//! Dependencies, packaging and the identity of a build (`spec/supply-chain.md`).

mod build_script;
mod dependencies;
mod linked;
mod package;
#[path = "../../../../tests/witness/present.rs"]
mod present;

use std::process::Command;

/// The root of the repository, and of the package `palpate`.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// What cargo answers, without the network.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .current_dir(ROOT)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {arguments:?}: {said}");
    String::from_utf8(output.stdout).unwrap()
}
