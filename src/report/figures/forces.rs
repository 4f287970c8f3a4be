//! Figure 5 for every phantom, and the signals at one depth.

use super::chart::{Line, Panel, round_range};
use super::style::{OKABE_ITO, ramp};
use crate::force_map::{ForceTable, Matrix};
use crate::report::text::{millimetres, shortened};
use crate::report::{Findings, MapFindings, ReportError, Study, findings};

const NORMAL: &str = "Normal force (N)";
const LATERAL: &str = "Lateral force (N)";

/// Lateral positions of the plot's ends, mm. One position alone gets some room.
fn lateral_range(laterals: &[f64]) -> [f64; 2] {
    match laterals {
        [first, .., last] => [first * 1e3, last * 1e3],
        [only] => [only * 1e3 - 1.0, only * 1e3 + 1.0],
        [] => [-1.0, 1.0],
    }
}

fn panel(heading: String, laterals: &[f64], lines: Vec<Line>, height: i32) -> Panel {
    let forces = lines
        .iter()
        .flat_map(|line| &line.points)
        .map(|point| point.1);
    Panel {
        heading,
        x: lateral_range(laterals),
        y: round_range(forces),
        height,
        lines,
        marks: Vec::new(),
    }
}

fn points(laterals: &[f64], forces: &[f64]) -> Vec<(f64, f64)> {
    laterals
        .iter()
        .zip(forces)
        .map(|(x, force)| (x * 1e3, *force))
        .collect()
}

/// Figure 5: both forces of a map, one curve for each depth of the probe.
pub fn force_curves(table: &ForceTable) -> Vec<Panel> {
    let panel = |heading: &str, matrix: &Matrix, height| {
        let count = table.depths().len();
        let lines = table.depths().iter().zip(matrix.rows()).enumerate();
        let lines = lines.map(|(row, (depth, forces))| Line {
            name: format!("{} mm", millimetres(*depth)),
            colour: ramp(row, count),
            is_dashed: false,
            points: points(table.laterals(), forces),
        });
        panel(heading.into(), table.laterals(), lines.collect(), height)
    };
    vec![
        panel(NORMAL, table.normal_force(), 230),
        panel(LATERAL, table.lateral_force(), 200),
    ]
}

/// How a map is called in a figure: the inclusion's depth for the paper's phantoms, or else its name.
pub fn label(map: &MapFindings) -> String {
    match map.paper_phantom {
        Some("none") | None => shortened(&map.name, 14),
        Some(depth) => format!("{depth} mm"),
    }
}

/// F_1 − F_0 of every map at one depth of the probe.
///
/// # Errors
/// [`ReportError::Map`] if a map does not fit the reference.
pub fn signals(study: &Study, found: &Findings) -> Result<Vec<Panel>, ReportError> {
    let (mut normal, mut lateral) = (Vec::new(), Vec::new());
    for (k, (map, of_map)) in study.maps.iter().zip(&found.maps).enumerate() {
        let table = findings::signal(study, map)?;
        let curve = findings::curve(&of_map.name, &table, found.probe_depth)?;
        let line = |forces| Line {
            name: label(of_map),
            colour: OKABE_ITO[k % OKABE_ITO.len()],
            is_dashed: (k / OKABE_ITO.len()) % 2 == 1,
            points: points(curve.laterals, forces),
        };
        normal.push(line(curve.normal_force));
        lateral.push(line(curve.lateral_force));
    }
    let laterals = study.reference.laterals();
    Ok(vec![
        panel("Normal signal F₁ − F₀ (N)".into(), laterals, normal, 230),
        panel("Lateral signal F₁ − F₀ (N)".into(), laterals, lateral, 200),
    ])
}
