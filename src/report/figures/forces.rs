//! Figure 5 for every phantom, Figure 7 for measured maps, and the signals at one depth.

use super::chart::{Line, Panel, chart, round_range};
use super::style::{PALETTE, ramp};
use super::{Draft, Words};
use crate::force_map::{ForceMap, ForceTable, Matrix};
use crate::report::text::{fixed, millimetres, name_of_map, shortened};
use crate::report::{Findings, MapFindings, ReportError, Study, Topic, findings, paper};

const LATERAL_POSITION: &str = "Lateral position of the probe x (mm)";

const NORMAL: &str = "Normal force (N)";
const LATERAL: &str = "Lateral force (N)";

/// The signals, if there are any, and the forces of every map: computed ones, then the measured ones.
///
/// # Errors
/// [`ReportError::Map`] if a map does not fit the reference.
///
/// Implements: REP-036.
pub fn drafts(study: &Study, found: &Findings) -> Result<Vec<Draft>, ReportError> {
    let mut drafts = Vec::new();
    if !study.maps.is_empty() {
        drafts.push(Draft {
            prefix: "signals",
            name: String::new(),
            topic: Topic::Forces,
            words: signal_words(found),
            drawn: chart(&signals(study, found)?, LATERAL_POSITION),
        });
    }
    let of_map = |map: &ForceMap, prefix, words| Draft {
        prefix,
        name: name_of_map(map),
        topic: Topic::Forces,
        words,
        drawn: chart(&force_curves(map.forces()), LATERAL_POSITION),
    };
    for map in [&study.reference].into_iter().chain(&study.maps) {
        drafts.push(of_map(map, "figure-5", force_words(map)));
    }
    for map in &study.measured {
        drafts.push(of_map(map, "figure-7", measured_words(map)));
    }
    Ok(drafts)
}

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
        ticks: Vec::new(),
        height,
        key: Vec::new(),
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
fn force_curves(table: &ForceTable) -> Vec<Panel> {
    let panel = |heading: &str, matrix: &Matrix, height| {
        let count = table.depths().len();
        let lines = table.depths().iter().zip(matrix.rows()).enumerate();
        let lines = lines.map(|(row, (depth, forces))| {
            Line::new(ramp(row, count), points(table.laterals(), forces))
                .named(format!("{} mm", millimetres(*depth)))
        });
        panel(heading.into(), table.laterals(), lines.collect(), height)
    };
    vec![
        panel(NORMAL, table.normal_force(), 230),
        panel(LATERAL, table.lateral_force(), 200),
    ]
}

/// How a map is called in a figure: the inclusion's depth for the paper's phantoms, or else its name.
fn label(map: &MapFindings) -> String {
    match map.paper_phantom {
        Some("none") | None => shortened(&map.name, 14),
        Some(depth) => format!("{depth} mm"),
    }
}

/// F_1 − F_0 of every map at one depth of the probe.
///
/// # Errors
/// [`ReportError::Map`] if a map does not fit the reference.
fn signals(study: &Study, found: &Findings) -> Result<Vec<Panel>, ReportError> {
    let (mut normal, mut lateral) = (Vec::new(), Vec::new());
    for (k, (map, of_map)) in study.maps.iter().zip(&found.maps).enumerate() {
        let table = findings::signal(study, map)?;
        let curve = findings::curve(&of_map.name, &table, found.probe_depth)?;
        let line = |forces| Line {
            is_dashed: (k / PALETTE.len()) % 2 == 1,
            ..Line::new(PALETTE[k % PALETTE.len()], points(curve.laterals, forces))
                .named(label(of_map))
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

fn signal_words(findings: &Findings) -> Words {
    let depth = millimetres(findings.probe_depth);
    let each: Vec<_> = findings
        .maps
        .iter()
        .map(|map| {
            format!(
                "{}: {} N normal, {} N lateral",
                label(map),
                fixed(map.peak_normal.force, 3),
                fixed(map.peak_lateral.force, 3)
            )
        })
        .collect();
    Words {
        title: format!("Signals F₁ − F₀ at depth {depth} mm"),
        caption: format!(
            "What inclusions add to the force on the probe as it sweeps over the gel at depth {depth} mm: the \
             template of the matched filter (2), (4). The paper shows no such figure, but its “roughly 0.5 N” and \
             its 340 mN for 6.6 mm are peaks of such curves. The lateral force changes sign over an inclusion."
        ),
        alt: format!(
            "Two line charts of force against lateral position, one curve for each phantom. Peaks: {}.",
            each.join("; ")
        ),
    }
}

fn force_words(map: &ForceMap) -> Words {
    let name = name_of_map(map);
    let what = match map.phantom().map(|phantom| &phantom.inclusions[..]) {
        Some([]) => "no inclusion".into(),
        Some([one]) => format!("inclusion {} mm deep", millimetres(one.depth)),
        Some(several) => format!("{} inclusions", several.len()),
        None => "inclusion not known".into(),
    };
    let said = match map.phantom().and_then(paper::name_of) {
        Some("2.6") => {
            "This is the paper's Figure 5; its curves come from an element and mesh that it does not name, and its \
             numbers are not printed, so only the shapes can be compared."
        }
        _ => "As the paper's Figure 5, which shows the 2.6 mm phantom alone.",
    };
    let source = match map.certificate() {
        Some(certificate) => format!(
            "Computed by finite elements ({}, contact {}).",
            certificate.element, certificate.contact
        ),
        None => "Measured.".into(),
    };
    let forces = map.normal_force().values();
    let largest = forces.iter().copied().fold(0.0, f64::max);
    Words {
        title: format!("Figure 5. Forces, phantom “{name}”: {what}"),
        caption: format!(
            "Force on the whole probe against its lateral position, one curve for each depth of the probe, named at \
             the right. {source} Normal is positive out of the gel, lateral along +x. {said}"
        ),
        alt: format!(
            "Two line charts of normal and lateral force against lateral position, {} curves each. The largest \
             normal force is {} N.",
            map.depths().len(),
            fixed(largest, 3)
        ),
    }
}

fn measured_words(map: &ForceMap) -> Words {
    let name = name_of_map(map);
    let note = match map.source() {
        crate::force_map::Source::Measured { note, .. } if !note.is_empty() => {
            format!(" It came with the note: “{note}”.")
        }
        _ => String::new(),
    };
    Words {
        title: format!("Figure 7. Measured forces, “{name}”"),
        caption: format!(
            "A measured map that this run was given, at its own poses: force on the whole probe against its lateral \
             position, one curve for each depth, named at the right.{note} The paper's Figure 7 shows its own measurement \
             of the 2.6 mm gel; those data are not available."
        ),
        alt: format!(
            "Two line charts of measured normal and lateral force against lateral position, {} curves each.",
            map.depths().len()
        ),
    }
}
