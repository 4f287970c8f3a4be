//! Other programs' answers to our own models (`spec/fem.md`): CalculiX for the forces on the
//! probe, scikit-fem for the stiffness matrix. A program that is not installed is skipped with a notice,
//! unless `PALPATE_REQUIRE_WITNESSES=1` asks for all of them.

mod calculix;
mod deck;
mod extruded;
pub mod present;
mod scikit_fem;
mod three_dimensions;

use std::io::ErrorKind;
use std::process::Command;

use palpate::fem::mesh::Region;
use palpate::phantom::{Material, Phantom};
use present::present;

/// Python with a module: that of the environment, or the system's. `None`, with a notice, where one of both is missing.
pub fn python_with(module: &str) -> Option<Command> {
    let python = || {
        let own = std::env::var_os("PALPATE_PYTHON");
        Command::new(own.unwrap_or_else(|| "python3".into()))
    };
    let probe = python().args(["-c", &format!("import {module}")]).output();
    let is_unknown =
        |stderr: &[u8]| String::from_utf8_lossy(stderr).contains("ModuleNotFoundError");
    let missing = match probe {
        Err(error) if error.kind() == ErrorKind::NotFound => Some("Python"),
        Ok(output) if is_unknown(&output.stderr) => Some(module),
        _ => None,
    };
    present(missing).then(python)
}

/// What a script prints, named from the root of the checkout: it must succeed. `None`, with a notice, where mpmath is missing.
pub fn printed(script: &str, arguments: &[&str]) -> Option<String> {
    let script = format!("{}/{script}", crate::ROOT);
    let mut python = python_with("mpmath")?;
    let output = python.args(["-B", &script]).args(arguments).output();
    let output = output.expect("Python starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script}: {text}{errors}");
    Some(text)
}

/// A built-in phantom, its inclusion at `centre_x`, m.
fn builtin_at(name: &str, centre_x: f64) -> Phantom {
    let phantom = Phantom::builtin(name).unwrap().changed(|parts| {
        for inclusion in &mut parts.inclusions {
            inclusion.centre_x = centre_x;
        }
    });
    phantom.unwrap()
}

/// What a region is made of, by the phantom alone: the library's own choice is among the things that are checked.
fn material(phantom: &Phantom, region: Region) -> Material {
    match region {
        Region::Layer(k) => phantom.layers()[k].material,
        Region::Inclusion(k) => phantom.inclusions()[k].material,
    }
}
