//! Tests of the solver, one file a topic.

mod assembly;
mod certify;
mod cholesky;
mod contact;
mod element;
mod map;
mod mesh;
mod supports;
mod vtu;

use super::{Contact, MESH_SIZE, Model, Pose};
use crate::phantom::tests::{disc, ellipse, polygon};
use crate::phantom::{Inclusion, Layer, Material, Phantom, Shape};
use palpate_asserts::numbers;

/// A built-in phantom.
fn builtin(name: &str) -> Phantom {
    Phantom::builtin(name).expect("a built-in name")
}

fn pose(depth: f64, lateral: f64) -> Pose {
    Pose { depth, lateral }
}

/// A coarse model, for laws that hold on any mesh.
fn coarse(phantom: &Phantom, contact: Contact) -> Model {
    Model::new(phantom, 2e-3, contact).expect("a model")
}

/// The 2.6 mm phantom on a mesh of a quarter of the default's size, made once for all tests: some 150 000 nodes.
fn finest() -> &'static Model {
    static FINEST: std::sync::LazyLock<Model> = std::sync::LazyLock::new(|| {
        Model::new(&builtin("2.6"), 0.25 * MESH_SIZE, Contact::default()).expect("a model")
    });
    &FINEST
}

/// A phantom so small that a coarse mesh of it has some hundred nodes, with a disc this far off the axis, mm.
fn small(centre_x_mm: f64) -> Phantom {
    let small = builtin("none").changed(|parts| {
        parts.inclusions = vec![hard(centre_x_mm, 1.0, disc(1.5))];
        parts.well.width = 6e-3;
        parts.layers[1].thickness = 3e-3;
        parts.probe.radius = 1e-3;
    });
    small.expect("sizes that fit")
}

/// A hard inclusion, its lengths in mm.
fn hard(centre_x_mm: f64, depth_mm: f64, shape: Shape) -> Inclusion {
    Inclusion {
        centre_x: centre_x_mm * 1e-3,
        depth: depth_mm * 1e-3,
        shape,
        material: Material::isotropic(1.2e6, 0.49),
    }
}

/// The paper's skin and gel with these inclusions.
fn with(inclusions: Vec<Inclusion>) -> Phantom {
    let phantom = builtin("none").changed(|parts| parts.inclusions = inclusions);
    phantom.expect("inclusions that fit")
}

/// The paper's disc, this far off the axis, mm.
pub(in crate::fem) fn off_centre(depth_mm: f64, centre_x_mm: f64) -> Phantom {
    with(vec![hard(centre_x_mm, depth_mm, disc(6.4))])
}

/// Phantoms of every kind, with a name for messages.
fn zoo() -> Vec<(String, Phantom)> {
    let mut zoo: Vec<(String, Phantom)> = crate::phantom::BUILTIN_NAMES
        .map(|name| (name.into(), builtin(name)))
        .into();
    let mut add = |what: &str, phantom: Phantom| zoo.push((what.into(), phantom));
    for depth in [2.6, 6.6] {
        for x in [2.0, 5.0, 10.0] {
            add(&format!("disc {depth} deep at {x}"), off_centre(depth, x));
        }
    }
    for (width, height) in [(6.0, 4.0), (8.0, 3.2), (8.0, 1.6), (1.6, 8.0)] {
        for angle in [0.0, 30.0, -75.0] {
            let shape = ellipse(width, height, angle);
            let what = format!("ellipse {width} by {height} at {angle}°");
            add(&what, with(vec![hard(0.0, 3.0, shape.clone())]));
            add(&(what + ", off centre"), with(vec![hard(-4.3, 4.1, shape)]));
        }
    }
    let upright = ellipse(8.0, 3.2, 90.0);
    add(
        "ellipse turned by a right angle",
        with(vec![hard(0.0, 3.0, upright)]),
    );
    let square = polygon(&[[-2.0, 0.0], [2.0, 0.0], [2.0, 4.0], [-2.0, 4.0]]);
    let triangle = polygon(&[[-3.0, 0.0], [3.0, 0.0], [0.0, 5.0]]);
    let sharp = polygon(&[[0.0, 0.0], [6.0, 0.0], [0.0, 3.5]]);
    let hexagon = "3 0\n1.5 2.6\n-1.5 2.6\n-3 0\n-1.5 -2.6\n1.5 -2.6";
    let angled = "0 0\n5 0\n5 1.5\n1.5 1.5\n1.5 5\n0 5";
    let [hexagon, angled] = [hexagon, angled].map(|corners| polygon(&numbers(corners)));
    for (what, shape) in [
        ("square", &square),
        ("triangle", &triangle),
        ("sharp triangle", &sharp),
        ("hexagon", &hexagon),
        ("angle", &angled),
    ] {
        add(what, with(vec![hard(0.0, 3.0, shape.clone())]));
        let what = format!("{what}, off centre");
        add(&what, with(vec![hard(3.7, 5.2, shape.clone())]));
    }
    let pair = |left: f64, right: f64| {
        let discs = [left, right].map(|x| hard(x, 4.0, disc(4.0)));
        with(discs.into())
    };
    add("two discs, mirror images", pair(-4.0, 4.0));
    add("two discs", pair(-5.0, 3.0));
    add("two discs that nearly touch", pair(-2.05, 2.05));
    let unlike = vec![hard(-4.0, 2.0, disc(3.0)), hard(4.0, 6.0, square)];
    add("disc and square", with(unlike));
    add("disc just under the skin", off_centre(0.6, 0.0));
    add("disc just above the floor", off_centre(8.95, 0.0));
    add("small disc", with(vec![hard(1.0, 5.0, disc(0.5))]));
    let material = Material::isotropic(20e3, 0.45);
    let fat = Layer {
        name: "fat".into(),
        thickness: 2e-3,
        material,
    };
    for (what, x) in [("three layers", 0.0), ("three layers, off centre", 2.5)] {
        let layers = off_centre(6.6, x).changed(|parts| parts.layers.insert(1, fat.clone()));
        add(what, layers.unwrap());
    }
    let thin = off_centre(6.6, 0.0).changed(|parts| parts.layers[0].thickness = 1e-4);
    add("thin skin", thin.unwrap());
    zoo
}
