//! Synthetic runs: forces proportional to the depth, and signals that are given at 4 mm.

use crate::report::{
    DeformedMesh, Figure, Findings, Run, Settings, figures, findings, html, summary_json, text,
};
use crate::tests::{certificate, table_of};
use palpate::fem::Pose;
use palpate::fem::mesh::Region;
use palpate::force_map::{
    Certificate, ForceMap, ForceTable, Matrix, Measurement, SmallestDet, Source,
};
use palpate::phantom::Phantom;

pub const DEPTHS: [f64; 3] = [0.0, 2e-3, 4e-3];
pub const LATERALS: [f64; 5] = [-10e-3, -5e-3, 0.0, 5e-3, 10e-3];
pub const SETTINGS: Settings = Settings {
    max_false_alarm: 0.05,
    max_miss: 0.05,
    prior_h1: 0.5,
    noise_sd_n: 0.1,
};

fn forces(depths: &[f64], normal: impl Fn(f64) -> f64, lateral: impl Fn(f64) -> f64) -> ForceTable {
    table_of(depths, &LATERALS, |depth, x| {
        [lateral(x), 1.48 + normal(x)].map(|at_4_mm| at_4_mm * depth / 4e-3)
    })
}

/// A measured map of 1.48 N and the signal given, both at 4 mm.
pub fn map(
    phantom: Option<Phantom>,
    depths: &[f64],
    normal: impl Fn(f64) -> f64,
    lateral: impl Fn(f64) -> f64,
) -> ForceMap {
    let file = "a<b>&\"'\u{0}\u{1b}[31m.csv";
    let source = Source::Measured(Measurement::new(file, ""));
    ForceMap::new(source, phantom, forces(depths, normal, lateral)).unwrap()
}

/// A phantom with an inclusion under another name.
pub fn map_with(name: &str, normal: impl Fn(f64) -> f64, lateral: impl Fn(f64) -> f64) -> ForceMap {
    let paper = Phantom::builtin("2.6").unwrap();
    let phantom = paper.changed(|parts| parts.name = name.into());
    map(Some(phantom.unwrap()), &DEPTHS, normal, lateral)
}

/// Forces of this size at ±5 mm along x, and none elsewhere.
pub fn at_5_mm(force: f64) -> impl Fn(f64) -> f64 {
    move |x: f64| {
        if x.abs() == 5e-3 {
            force * x.signum()
        } else {
            0.0
        }
    }
}

/// A triangle of the height `peak` over ±10 mm, and a lateral third of it at ±5 mm.
pub fn triangle(name: &str, peak: f64) -> ForceMap {
    let normal = move |x: f64| peak * (1.0 - x.abs() / 10e-3);
    let phantom = Phantom::builtin(name).ok();
    map(phantom, &DEPTHS, normal, at_5_mm(peak / 3.0))
}

/// Numbers for all poses, one of which has its own.
pub fn matrix_with(pose: (usize, usize), one: f64, others: f64) -> Matrix {
    let number = |row, column| if (row, column) == pose { one } else { others };
    Matrix::from_fn(DEPTHS.len(), LATERALS.len(), number)
}

/// A computed map whose smallest det(I + ∇u) stands at x = −5 mm.
pub fn computed_map(name: &str, smallest: f64) -> ForceMap {
    let min_det = matrix_with((2, 1), smallest, 0.9);
    let smallest = SmallestDet::of(&min_det, &DEPTHS, &LATERALS).unwrap();
    let certificate = Certificate {
        worst_relative_residual: 1.5e-13,
        worst_force_balance: 2.5e-12,
        largest_penetration: 3.5e-14,
        newton_iterations: 7,
        mesh_size: 0.7e-3,
        nodes: 1234,
        elements: 567,
        ..certificate(min_det, smallest)
    };
    let forces = forces(&DEPTHS, |_| 0.2, |_| 0.0);
    let source = Source::FiniteElements { certificate };
    ForceMap::new(source, Phantom::builtin(name).ok(), forces).unwrap()
}

/// One square of gel under one of skin, pressed down.
pub fn deformed() -> DeformedMesh {
    let square = |top: f64| {
        let corners = [(-17e-3, -7e-3), (17e-3, -7e-3), (17e-3, 0.0), (-17e-3, 0.0)];
        corners.map(|(x, y)| [x, top + y - 1e-3]).to_vec()
    };
    let (depth, lateral) = (4e-3, 0.0);
    DeformedMesh {
        phantom: Phantom::builtin("2.6").unwrap(),
        pose: Pose { depth, lateral },
        elements: [(1, -7e-3), (0, 0.0)]
            .map(|(layer, top)| (Region::Layer(layer), square(top)))
            .into(),
        min_det: 0.5,
    }
}

/// All that a run gives.
#[derive(PartialEq)]
pub struct Made {
    pub found: Findings,
    pub figures: Vec<Figure>,
    pub page: String,
    pub summary: String,
}

pub fn made(run: &Run) -> Made {
    let found = findings(run).unwrap();
    let figures = figures(run, &found).unwrap();
    Made {
        page: html(run, &found, &figures),
        summary: summary_json(&found, run),
        found,
        figures,
    }
}

impl Made {
    pub fn figure(&self, name: &str) -> &Figure {
        let file_name = format!("{name}.svg");
        let found = self.figures.iter().find(|of| of.file_name == file_name);
        found.unwrap_or_else(|| panic!("no {name}"))
    }
}

/// What stands in `text` between the first `from` and the next `to`.
pub fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let after = text.split_once(from).map(|(_, after)| after);
    let inside = after.and_then(|after| after.split_once(to));
    inside
        .unwrap_or_else(|| panic!("no {from} before {to} in {text}"))
        .0
}

/// How the page shows words.
pub fn shown(words: &str) -> String {
    let words = askama::filters::escape(text::prose(words), askama::filters::Html);
    words.unwrap().to_string()
}

/// The paper's phantoms with peaks of 0.6, 0.45, 0.3 and 0.15 N.
pub fn paper_run() -> Run {
    let peaks = [("2.6", 0.6), ("4.6", 0.45), ("6.6", 0.3), ("8.6", 0.15)];
    Run {
        reference: map(Phantom::builtin("none").ok(), &DEPTHS, |_| 0.0, |_| 0.0),
        maps: peaks.map(|(name, peak)| triangle(name, peak)).into(),
        measured: Vec::new(),
        changes: None,
        deformed: deformed(),
        settings: SETTINGS,
        study: None,
        theories: Vec::new(),
    }
}

/// Names that a phantom may have and that break markup or file systems; two differ in case alone, two not at all.
pub const HOSTILE: [&str; 10] = [
    "</svg><script>alert(1)</script>",
    "a\"b' onload='x",
    "&amp;&#0;",
    "]]><!--",
    "../../etc/passwd",
    "nul \u{ffff}\u{202e}txt.exe",
    "CON",
    "con",
    "con",
    " ",
];

/// A run of hostile names, with a phantom without inclusion, and a map without any phantom.
pub fn hostile_run() -> Run {
    let mut run = paper_run();
    run.maps = HOSTILE.map(|name| map_with(name, |_| 0.1, |_| 0.0)).into();
    let others = [Phantom::builtin("none").ok(), None];
    let others = others.map(|phantom| map(phantom, &DEPTHS, |_| 0.1, |_| 0.0));
    run.maps.extend(others);
    let deformed = &run.deformed.phantom;
    run.deformed.phantom = deformed
        .changed(|parts| parts.name = "<b>&".into())
        .unwrap();
    run
}
