//! Tests of the solver, one file a topic.

mod certify;
mod cholesky;
mod contact;
mod element;
mod map;
mod mesh;

use super::{Contact, MeshOptions, Model};
use crate::phantom::Phantom;

/// A built-in phantom.
fn builtin(name: &str) -> Phantom {
    Phantom::builtin(name).expect("a built-in name")
}

/// A coarse model, for laws that hold on any mesh.
fn coarse(name: &str, contact: Contact) -> Model {
    let options = MeshOptions {
        size: 2e-3,
        ..MeshOptions::default()
    };
    Model::new(&builtin(name), &options, contact).expect("a model")
}
